#!/usr/bin/env python3
"""The study of a half-disk on a rigid disk with friction: the published reduced model, the four
reductions of the multipliers, and more free parameters.

    study.py BIN OUT [OPTION...]     e.g. cases/rigid_disk/study/study.py build/bin run/rigid_disk_study

Options go to every run (a smaller -train; more free parameters and most benchmarks are then left
out). Runs rbvi offline and rbvi verify for each combination (two at a time, one rank each), then
the timed ones alone, and writes OUT/tables.md and OUT/figures/*.png. What is there is kept.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from study_tools import (first_at, history, markdown, pair_options, separation_errors, short,
                         stored, study_main, summary, table)

CASE = Path(__file__).resolve().parents[1] / "case.yaml"
VARIANTS = {  # radius: of the free parameter alone
    "radius": [],
    "rigid": ["-normal", "rigid"],
    "friction": ["-parameters", "radius,indentation,friction_coefficient"],
    "core": ["-parameters", "radius,core_stiffness"],
    "poisson": ["-parameters", "radius,poisson_ratio"],
}
RANDOM = "random:150:2"
FREE = {  # parameters, and a grid of about as many
    "friction": ("radius, indentation, friction coefficient", "grid:5,6,5"),
    "core": ("radius, core stiffness", "grid:12,12"),
    "poisson": ("radius, Poisson's ratio", "grid:12,12"),
}
BEST = ["-gcns_nodes", "best"]  # beyond the first rise of e_GCNS, where the variant stops
TEXT = [*pair_options((30, 20)), "-tangential_tolerance", "2e-4", *BEST]  # (30, 20, 20)
SEPARATED = ["-eim_tolerance", "1e-13", "-pga_tolerance", "1e-3", *BEST]
DEFAULT = ["-multiplier_reduction", "condensed", "-pod_tolerance", "1e-7"]
REDUCTIONS = {
    "condensed": ["-multiplier_reduction", "condensed"],
    "condensed, no responses": ["-multiplier_reduction", "condensed", "-response_tolerance", "0"],
    "collocated, made exact": ["-multiplier_exact", "yes", *BEST],
    "collocated": BEST,
}
COLLOCATED = {"text": "(30, 20, 20)", "published": "published tolerances"}


def largest_errors(run):
    """Of u, lambda_n and lambda_tau over the validation set."""
    kind = "enriched" if stored(run, "size/supremizers") > 0 else "decorrelated"
    return stored(run, "validation/" + kind)[2::2]


def sizes(runs):
    rows = []
    for variant, normal, forms in (("radius", "of the half-disk", ("b", "b", "g")),
                                   ("rigid", "of the rigid disk",
                                    ("b_normal", "b_tangential", "g"))):
        for count in (61, 150):
            run = runs[variant, f"grid {count}"]
            terms = [separation_errors(run, form)[0] for form in forms]
            rows.append([normal, len(stored(run, "law/starts_mu")[0]),
                         first_at(history(run, "pod/error"), 1e-6),
                         first_at(history(run, "normal_cone/error"), 1e-3),
                         first_at(history(run, "tangential/error"), 1e-4)] +
                        [first_at(error, t) for error in terms for t in (1e-3, 1e-6)])
    rows.append(["published", "61", "30", "20", "20", "41", "", "41", "", "", ""])
    return markdown("Sizes of the bases and terms of the operators",
                    ["normal", "training radii", "N at 1e-6", "R at 1e-3", "S at 1e-4",
                     "B^n at 1e-3", "1e-6", "B^tau at 1e-3", "1e-6", "gap at 1e-3", "1e-6"], rows)


def stability(runs):
    """The constants of the reduced pairs, the smallest over all radii, and the collocation nodes."""
    rows, exceptions, checked = [], 0, 0
    for key, name in COLLOCATED.items():
        run = runs["radius", key]
        steps, constants = table(run, "stability.csv"), table(run, "infsup.csv")
        for larger, smaller in (("beta_on", "beta_off"), ("beta_off", "beta_dec"),
                                ("beta_on", "beta_hf"), ("c_hf", "beta_on")):
            exceptions += int(np.sum(constants[smaller] > constants[larger] * (1 + 1e-9)))
            checked += len(constants)
        exceptions += int(np.sum(steps["exceptions"]))
        checked += len(steps)
        beta = steps["beta_min"]
        pairs = history(run, "gcns/nodes").astype(int)
        error = dict(zip(pairs, history(run, "gcns/error")))
        best = min(error, key=error.get)
        violation = dict(zip(pairs, history(run, "gcns/violation")))
        rows.append([name, f"{summary(run)['S']:.0f}", first_at(-beta, -1e-12)] +
                    [short(value) for value in (beta[len(beta) // 2], beta[-1])] +
                    [f"{history(run, 'pga/tolerance')[0]:.3f}",
                     short(error[20]) if 20 in error else "-", best, short(error[best]),
                     short(violation[best])])
    rows.append(["published", "40", "10", "", "", "0.072", "0.39", "20", "0.39", "1e-6"])
    text = markdown("Stability and collocation nodes",
                    ["sizes", "supremizers", "fewest with beta > 0", "beta with half of them",
                     "with all", "beta_HF / c_HF", "e_GCNS with 20 pairs", "best pairs", "e_GCNS",
                     "violation (3.63)"], rows)
    return text + f"\nOrder of the constants: {exceptions} exceptions in {checked} comparisons.\n"


def functions_of(run):
    """Sizes of the bases of the multipliers, and the pairs of collocation nodes."""
    normal, tangential = (stored(run, "law/basis/" + name) for name in ("normal", "tangential"))
    nodes = len(stored(run, "law/basis/nodes"))
    if normal.size == 0:
        return [f"{stored(run, 'size/generators')}", "all"]
    return [f"{normal.shape[1]} + {tangential.shape[1]}", f"{nodes}"]


def reductions(runs):
    rows = []
    for name in [*REDUCTIONS, "as published"]:
        run = runs["radius", name]
        s = summary(run)
        rows.append([name, f"{s['N']:.0f} + {s['S']:.0f}",
                     *functions_of(run), *(short(value) for value in largest_errors(run)),
                     f"{1e3 * s['seconds']:.2f}"])
    return markdown("Reductions of the multipliers: largest errors, ms per query",
                    ["reduction", "N + further", "functions of the multipliers",
                     "pairs of nodes", "u", "lambda_n", "lambda_tau", "ms"], rows)


def free_parameters(study, runs):
    lines = [("radius", "grid:61", "grid:61", ("radius", "default"), ("radius", "default"))]
    lines += [(names, RANDOM, grid, (variant, "random"), (variant, "grid"))
              for variant, (names, grid) in FREE.items()]
    rows = []
    for names, training, grid, key, compared in lines:
        s, benched = summary(runs[key]), study.bench(runs[compared])
        linear, solver = (next(row for (method, _), row in benched.items() if method == wanted)
                          for wanted in ("multilinear interpolation", "active_set from the answer before"))
        rows.append([names, training, f"{s['N']:.0f} + {s['S']:.0f}",
                     stored(runs[key], "law/terms").shape[1],
                     *(short(value) for value in largest_errors(runs[key])),
                     f"{1e3 * s['seconds']:.2f}", f"{float(solver['median_ms']):.1f}", grid,
                     *(short(float(linear[name])) for name in ("u_max", "lambda_max"))])
    return markdown("Free parameters: the default reduction, and linear interpolation on a grid",
                    ["free", "training", "N + responses", "terms of H", "u", "lambda_n",
                     "lambda_tau", "ms", "high-fidelity ms", "grid", "interpolation: u",
                     "both multipliers"], rows)


def by_uzawa(study, run, queries):
    """As a row of bench: the reduced Uzawa's method (3.55) over the validation set, without the
    field; and how many steps it takes."""
    path = run / "uzawa.csv"
    study.call(run / "model.h5", "--queries", f"random:{queries}:1", "--method", "uzawa", "--out",
               path, program="rbvi-online")
    answers = np.genfromtxt(path, delimiter=",", names=True)
    return {"median_ms": 1e3 * np.median(answers["seconds"])}, np.median(answers["iterations"])


def costs(study, runs):
    """Table 3.1; a query of a reduced model includes its outputs and the field."""
    names = {"default": "condensed", "published": "published tolerances",
             "as published": "(30, 20, 20), 20 pairs of nodes"}
    timed = ["default"] if study.options else list(names)
    benched = {key: study.bench(runs["radius", key]) for key in timed}
    queries = len(table(runs["radius", "default"], "errors.csv"))
    baseline = benched["default"]
    lines = [(key[0], row) for key, row in baseline.items()
             if key[1] in ("assembly, field, outputs", "field; constraints not enforced")]
    lines += [(f"reduced: {names[key]}", row) for key, rows in benched.items()
              for (_, includes), row in rows.items() if includes == "outputs, field"]
    for key in timed[1:]:
        row, steps = by_uzawa(study, runs["radius", key], queries)
        lines.append((f"reduced: {names[key]}, Uzawa's method in {steps:.0f} steps", row))
    times = {name: float(row["median_ms"]) for name, row in lines}
    solvers = ("uzawa fixed step", "active_set from the answer before")
    rows = [[name, f"{ms:.3g}", f"{queries * ms / 1e3:.3g}"] +
            [f"{times[solver] / ms:.3g}" for solver in solvers] for name, ms in times.items()]
    rows += [["published: high-fidelity", "", "450", "", ""],
             ["published: reduced, (30, 20, 20)", "", "35", "13", ""]]
    return markdown(f"Table 3.1 with our times: {queries} queries at the median of one",
                    ["method", "ms per query", "seconds for all", "times faster than Uzawa",
                     "than active_set from the answer before"], rows)


def jobs_of(study):
    """What runs two at a time."""
    jobs = {("radius", "text"): TEXT,
            ("radius", "as published"): [*TEXT, "-gcns_max_nodes", "20"],
            ("radius", "generators"): ["-cone_tolerance", "1e-10", *BEST]}
    for variant in ("radius", "rigid"):
        for count in (61, 150):
            train = [] if study.options else ["-train", f"grid:{count}"]
            jobs[variant, f"grid {count}"] = [*SEPARATED, *train]
    if not study.options:
        for variant, (_, grid) in FREE.items():
            jobs[variant, "random"] = [*DEFAULT, "-train", RANDOM]
            jobs[variant, "grid"] = [*DEFAULT, "-train", grid]
    return {key: (key[1], options, key[1] in COLLOCATED) for key, options in jobs.items()}


def all_runs(study):
    """Every run directory by what it is; the reductions alone, to be timed."""
    runs = study.run_all(jobs_of(study))
    for name, options in REDUCTIONS.items():
        runs["radius", name] = study.run("radius", name, options, name == "collocated")
    runs["radius", "default"] = study.run("radius", "default", DEFAULT)
    runs["radius", "published"] = runs["radius", "collocated"]
    return runs


def work(study):
    runs = all_runs(study)
    tables = [sizes(runs), stability(runs), reductions(runs)]
    if not study.options:
        tables.append(free_parameters(study, runs))
    tables.append(costs(study, runs))
    from study_figures import draw_all
    return tables, lambda directory: draw_all(study, runs, directory)


if __name__ == "__main__":
    sys.exit(study_main(__doc__, [CASE, "-variant", "published", "-online_method", "exact"], VARIANTS,
                        work))
