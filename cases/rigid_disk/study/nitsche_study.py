#!/usr/bin/env python3
"""The study of Nitsche's method for a half-disk on a rigid disk: the high-fidelity answers, the
reduced models with three treatments of the contact curve, and the mixed method on the same mesh.

    nitsche_study.py BIN OUT [OPTION...]   e.g. cases/rigid_disk/study/nitsche_study.py build/bin run/ns

Options go to every run (a smaller -train, fewer -arc_edges; runs with more training radii and other
meshes are then left out). Writes OUT/tables.md and OUT/figures/*.png. What is there is kept.
"""

import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from study_tools import (history, markdown, rows_of, short, stage_seconds, stored, study_main,
                         summary)

CASE = Path(__file__).resolve().parents[1] / "case.yaml"
RADII = ("0.7", "1", "1.3")
LAWS = {"none": "none", "tresca": "Tresca, 0.1", "coulomb": "Coulomb, 0.1"}
EDGES = {"5": "158", "2.5": "316", "1.25": "632"}  # of the arc, by their length in mm
MEASURED_FROM = ("edges", "arc")  # the gap
FACTORS = ("0.01", "0.1", "0.3", "0.5", "1", "2", "10", "100")
GAMMA0 = 11.54
BOUNDED = ["-nitsche_bounds", "nonpenetration"]
GENERATORS = (10, 30, 40)
SIZES = (5, 10, 15, 20, 30, 40)
ALL_SIZES = ["-pod_tolerance", "0", "-pod_max_size", "60"]  # the tables of errors go over N
RULES = ("empirical", "full", "interpolated")
VALIDATION = "random:30:1"  # as the case has it
EIM_ERRORS = "errors of the interpolation"  # a run of its own: it solves at other radii, too
SAME_MESH = ["-formulation", "mixed", "-arc_edges", EDGES["2.5"], "-eim_tolerance", "1e-10"]
VARIANTS = {
    **{law: ["-friction", law] for law in LAWS},
    "mixed": [*SAME_MESH, "-friction", "none"],
    "pair": [*SAME_MESH, "-friction", "none"],
}
PUBLISHED = {  # Niakh (2022), tables 4.1 and 4.2, in % for h = 5, 2.5, 1.25 mm
    "none": {"0.7": "1 / 0.52 / 0.28", "1": "1.45 / 0.72 / 0.33", "1.3": "1.17 / 1.1 / 0.43"},
    "tresca": {"0.7": "5.49 / 3.33 / 2.36", "1": "5.5 / 3.35 / 2.33", "1.3": "5.76 / 3.4 / 2.37"},
    "coulomb": {"0.7": "4.34 / 3.03 / 2.12", "1": "5.51 / 3.63 / 2.57",
                "1.3": "6.65 / 4.46 / 3.16"},
}
OTHER_LAW_ERRORS = {"0.7": "1.02 / 0.51 / 0.26", "1": "1.25 / 0.65 / 0.34",
                    "1.3": "1.53 / 0.84 / 0.43"}
QUANTITIES = ("energy", "normal_force", "tangential_force", "contact_half_width", "centre_pressure")
THRESHOLD = 0.1 * np.pi / 4  # Tresca's times the length of the arc of radius 1
OTHER = {  # computed with other software, without discretisation error
    "none": {"0.7": (0.0465717, 1.20705, 0, 0.205, 4.0388),
             "1": (0.0408828, 1.03483, 0, 0.2063, 3.3696),
             "1.3": (0.0374069, 0.93457, 0, 0.207, 3.0012)},
    "tresca": {"0.7": (0.0466105, 1.20317, 0.7 * THRESHOLD, 0.2046, 4.065),
               "1": (0.0409622, 1.03069, THRESHOLD, 0.2055, 3.400),
               "1.3": (0.0375414, 0.93020, 1.3 * THRESHOLD, 0.206, 3.034)},
    "coulomb": {"0.7": (0.0467368, 1.20068, 0.11605, 0.204, 4.164),
                "1": (0.0410045, 1.03176, 0.09983, 0.205, 3.494),
                "1.3": (0.0375063, 0.93301, 0.09033, 0.2058, 3.122)},
}


def solve_all(study):
    """By what they are for. Those of the first kind are timed: one at a time."""
    answers = {}
    for law in LAWS:
        for radius in RADII:
            answers["cold", law, radius] = study.solve(f"{law}_{radius}",
                                                       [*VARIANTS[law], "-mu", radius], True)
    for radius in RADII:
        answers["mixed", radius] = study.solve(f"mixed_{radius}",
                                               [*VARIANTS["mixed"], "-mu", radius])
    jobs = {("gamma0", factor, radius): (f"gamma0_{factor}_{radius}", [
        *VARIANTS["none"], "-mu", radius, "-nitsche_gamma0", str(float(factor) * GAMMA0)])
            for factor in FACTORS for radius in RADII}
    for law in LAWS:
        for factor in FACTORS[4:] if law == "none" else ("1",):
            for radius in RADII:
                jobs["bounded", law, factor, radius] = (f"bounded_{law}_{factor}_{radius}", [
                    *VARIANTS[law], "-mu", radius, *BOUNDED, "-nitsche_gamma0",
                    str(float(factor) * GAMMA0)])
        for start in MEASURED_FROM:
            for h in sizes_of_edges(study):
                for radius in RADII:
                    jobs["law", law, start, h, radius] = (f"{law}_{start}_{h}_{radius}", [
                        *VARIANTS[law], "-gap_from", start, "-arc_edges", EDGES[h], "-mu", radius])
    with ThreadPoolExecutor(2) as pool:
        started = {key: pool.submit(study.solve, *job) for key, job in jobs.items()}
        answers.update({key: future.result() for key, future in started.items()})
    return answers


def sizes_of_edges(study):
    return ["2.5"] if study.options else list(EDGES)


def values(answers):
    rows = []
    for law, name in LAWS.items():
        for radius in RADII:
            outputs = answers["cold", law, radius]
            row = [name, radius]
            for quantity, other in zip(QUANTITIES, OTHER[law][radius]):
                digits = 7 if quantity == "energy" else 5
                row += [f"{outputs[quantity]:.{digits}f}" if quantity in outputs else "-",
                        f"{other:.{digits}f}" if other else "-"]
            rows.append(row)
    header = ["friction", "R"]
    for title in ("J", "F_n", "integral of abs(sigma_tau)", "half-width", "centre pressure"):
        header += [title, "elsewhere"]
    return markdown("Values, and those computed with other software", header, rows)


def law_errors(study, answers):
    """Tables 4.1 and 4.2 in %."""
    kinds = [("none", "law_error_normal", "e_n, none"),
             ("tresca", "law_error_normal", "e_n, Tresca"),
             ("tresca", "law_error_tangential", "e_tau, Tresca"),
             ("tresca", "law_error_tau_over_n", "e_tau/n, Tresca"),
             ("coulomb", "law_error_normal", "e_n, Coulomb"),
             ("coulomb", "law_error_tangential", "e_tau, Coulomb"),
             ("coulomb", "law_error_tau_over_n", "e_tau/n, Coulomb")]
    rows = []
    for law, column, title in kinds:
        for radius in RADII:
            shown = [" / ".join(f"{100 * answers['law', law, start, h, radius][column]:.2f}"
                                for h in sizes_of_edges(study)) for start in MEASURED_FROM]
            compared = (law == "none") == (column == "law_error_normal")
            rows.append([title, radius, *shown, PUBLISHED[law][radius] if compared else "",
                         OTHER_LAW_ERRORS[radius] if law == "none" else ""])
    return markdown("Errors of the laws at the nodes, in %, for h = 5 / 2.5 / 1.25 mm",
                    ["error", "R", "gap from the edges", "gap from the arc", "published",
                     "computed with other software"], rows)


def gamma_study(answers):
    rows = []
    for factor in FACTORS:
        for radius in RADII:
            found = answers["gamma0", factor, radius]
            if isinstance(found, str):
                rows.append([factor, radius, found.split(", while")[0], "", "", ""])
                continue
            rows.append([factor, radius, f"{found['iterations']:.0f}", f"{found['energy']:.9f}",
                         f"{found['centre_pressure']:.4f}",
                         f"{100 * found['law_error_normal']:.3f}"])
    return markdown(f"gamma0 / {GAMMA0}, without friction",
                    ["factor", "R", "Newton steps", "J", "centre pressure", "e_n in %"], rows)


def bounded(answers):
    """What SNES's bounds change: each pair of values without and with them."""
    rows = []
    for key, found in answers.items():
        if key[0] != "bounded":
            continue
        _, law, factor, radius = key
        free = answers["gamma0", factor, radius] if law == "none" else answers["cold", law, radius]
        if isinstance(found, str) or isinstance(free, str):
            rows.append([LAWS[law], factor, radius, "no answer", *[""] * 5])
            continue
        rows.append([LAWS[law], factor, radius,
                     f"{free['iterations']:.0f} / {found['iterations']:.0f}",
                     " / ".join(short(x["max_penetration"]) for x in (free, found)),
                     f"{free['normal_force']:.6f}",
                     short(found["normal_force"] / free["normal_force"] - 1),
                     short(found["energy"] / free["energy"] - 1),
                     " / ".join(f"{100 * x['law_error_normal']:.3f}" for x in (free, found))])
    return markdown("Without / with -nitsche_bounds nonpenetration",
                    ["friction", f"gamma0 / {GAMMA0}", "R", "Newton steps", "u_n - g at a node in m",
                     "F_n without", "F_n changes by", "J changes by", "e_n in %"], rows)


def newton_steps(runs, answers):
    rows = []
    lines = [(law, name, [answers["cold", law, radius] for radius in RADII])
             for law, name in LAWS.items()]
    lines.append(("mixed", "none, mixed method", [answers["mixed", radius] for radius in RADII]))
    for key, name, cold in lines:
        warm = rows_of(runs[key, "default"] / "samples.csv")
        warm_steps, warm_seconds = ([row[column] for row in warm]
                                    for column in ("iterations", "seconds"))
        rows.append([name, " / ".join(f"{row['iterations']:.0f}" for row in cold),
                     " / ".join(f"{row['seconds']:.2f}" for row in cold),
                     f"{np.median(warm_steps):.0f}", f"{max(warm_steps):.0f}",
                     f"{np.median(warm_seconds):.3f}"])
    return markdown("Newton steps and seconds of a solve: alone at R = 0.7 / 1 / 1.3; in a sweep",
                    ["friction", "steps, alone", "seconds", "median steps, in a sweep", "most",
                     "median seconds"], rows)


def interpolated_terms(runs):
    names = ("contact_matrix", "contact_vector", "friction_matrix", "friction_vector")
    published = {"none": ["897", "619", "281", "", ""], "tresca": ["898", "630", "291", "", "3"],
                 "coulomb": ["407", "126", "214", "4", "191"]}
    rows = []
    for law, name in LAWS.items():
        run = runs[law, "interpolated"]
        terms = []
        for part in names:
            try:
                terms.append(len(history(run, "curve/" + part)) - 1)
            except KeyError:
                terms.append("")
        rows += [[name, f"{history(run, 'curve/states')[0]:.0f}", *terms],
                 [name + ", published", *published[law]]]
    return markdown("Terms of the interpolated operators at 1e-6",
                    ["friction", "pairs (mu, k)", "B^n", "Theta^n", "B^tau", "Theta^tau"], rows)


def error_map(run):
    """Errors over N, the sizes of the model as they are."""
    return [row for row in rows_of(run / "verify" / "error_map.csv") if row["enriched"] == 0]


def reduced_errors(runs):
    rows = []
    for law, name in LAWS.items():
        maps = {rule: error_map(runs[law, rule]) for rule in RULES}
        for k, floor in enumerate(maps["full"]):
            shown = [short(maps[rule][k][column]) if column in floor else "-"
                     for column in ("u_max", "lambda_max", "tangential_max") for rule in RULES]
            floors = [short(floor[part + "_floor_max"]) if part + "_floor_max" in floor else "-"
                      for part in ("u", "lambda", "tangential")]
            rows.append([name, f"{floor['N']:.0f}", floors[0], *shown[:3], floors[1], *shown[3:6],
                         floors[2], *shown[6:],
                         *(f"{1e3 * maps[rule][k]['seconds']:.2f}" for rule in RULES)])
    header = ["friction", "N", "u, projection", *(f"u, {rule}" for rule in RULES),
              "sigma_n, projection", *(f"sigma_n, {rule}" for rule in RULES),
              "sigma_tau, projection", *(f"sigma_tau, {rule}" for rule in RULES),
              *(f"ms, {rule}" for rule in RULES)]
    return markdown("Largest relative errors over the validation set, and ms per query", header,
                    rows)


def offline_seconds(run):
    stages = stage_seconds(run)
    solves = sum(row["seconds"] for row in rows_of(run / "samples.csv"))
    stages.pop("snapshots", None)
    return solves, sum(stages.values())


def methods(runs):
    lines = [("Nitsche, empirical", ("none", "default")),
             ("Nitsche, full", ("none", "full")),
             ("Nitsche, interpolated", ("none", "interpolated")),
             ("Nitsche, empirical, 201 radii", ("none", "grid 201")),
             ("Nitsche, empirical, 241 radii", ("none", "grid 241")),
             ("mixed, condensed", ("mixed", "default")),
             *((f"mixed, cone of {r}, N = 30", ("pair", f"{r}, 30")) for r in GENERATORS)]
    rows = []
    for name, key in lines:
        if key not in runs:
            continue
        run = runs[key]
        s = summary(run)
        solves, rest = offline_seconds(run)
        each = np.median([row["seconds"] for row in rows_of(run / "samples.csv")])
        rows.append([name, f"{s['N']:.0f} + {s['S']:.0f}", short(s["u_max"]),
                     short(s["lambda_max"]), short(s["u_floor_max"]),
                     f"{1e3 * s['seconds']:.2f}", f"{1e3 * each:.0f}", f"{solves:.1f}",
                     f"{rest:.1f}"])
    return markdown("Methods on one mesh, without friction",
                    ["method", "N + further", "u", "normal stress", "u, projection",
                     "ms per query", "ms per solve in a sweep", "s, all solves",
                     "s, rest of the offline stage"], rows)


def jobs_of(study):
    jobs = {(law, rule): ["-nitsche_quadrature", rule, *ALL_SIZES]
            for rule in ("full", "interpolated", "empirical") for law in LAWS}
    for law in LAWS:
        jobs[law, EIM_ERRORS] = ["-nitsche_quadrature", "interpolated", "-nitsche_eim_validation",
                                 VALIDATION, "-pod_max_size", "5"]
    if not study.options:
        for count in (201, 241):
            jobs["none", f"grid {count}"] = ["-train", f"grid:{count}", "-pod_tolerance", "1e-6"]
    for r in GENERATORS:
        for n in SIZES:
            jobs["pair", f"{r}, {n}"] = [
                "-multiplier_reduction", "collocated", "-multiplier_exact", "no", "-pod_tolerance",
                "0", "-pod_max_size", str(n), "-cone_type", "mcpg", "-cone_tolerance", "0",
                "-cone_max_size", str(r), "-pga_tolerance", "0.047"]
    return {key: (key[1], options, False) for key, options in jobs.items()}


def all_runs(study):
    """Those whose high-fidelity solves are timed first, one at a time."""
    runs = {(law, "default"): study.run(law, "default", []) for law in LAWS}
    runs["mixed", "default"] = study.run("mixed", "default", ["-pod_tolerance", "1e-7"])
    runs.update(study.run_all(jobs_of(study)))
    return runs


def work(study):
    answers = solve_all(study)
    runs = all_runs(study)
    tables = [values(answers), law_errors(study, answers), newton_steps(runs, answers),
              gamma_study(answers), bounded(answers), interpolated_terms(runs),
              reduced_errors(runs), methods(runs)]
    from nitsche_study_figures import draw_all
    return tables, lambda directory: draw_all(study, runs, directory)


if __name__ == "__main__":
    sys.exit(study_main(__doc__, [CASE, "-variant", "nitsche"], VARIANTS, work))
