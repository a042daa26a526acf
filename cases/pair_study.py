"""Tables of the studies of chapter 2 that need matrices: reduced_pairs.py on the runs of a study. Keys of
runs begin with the variant; `scene_of` makes the matrices of a run of each."""

from resource import RUSAGE_CHILDREN

import numpy as np

from reduced_pairs import (DoubleGreedy, Problem, Space, cone_error, constants, enlarged_cone, factorised,
                           gram_condition, high_fidelity_constants, query_seconds, stability, user_seconds)
from study_tools import ENRICHMENTS, markdown, pair_options, short, table

NAMES = ("hf", "on", "off", "dec")
CLOSED = 1 + 1e-6  # an upper value this close to the lower one is the constant
RADII = (12, 25, 50)


def validation_of(run, parameters):
    """The mu of a run, of so many parameters, at which rbvi verify measured."""
    rows = table(run, "errors.csv")
    return np.column_stack([rows[name] for name in rows.dtype.names[:parameters]])


def constants_over(scenes, mus, of_domain):
    """For each of scenes that differ in their bases alone the constants at each mu, in V and W of the
    reference domain or of that of mu."""
    scene = scenes[0]
    w, space = scene.w(), None if of_domain else Space(scene.v(), scene.contact)
    found, starts = [[] for _ in scenes], [{} for _ in scenes]
    for mu in mus:
        b = scene.b(mu)
        if of_domain:
            w, space = scene.w(mu), Space(scene.v(mu), scene.contact)
        beta_hf, c_hf = high_fidelity_constants(space, b, w, scene.covered(mu))
        for one, start, values in zip(scenes, starts, found):
            run = one.run
            values.append({"hf": beta_hf, "c": c_hf,
                           **constants(space, b, w, run.modes, run.basis, run.generators, start)})
    return found


def cone_constants(runs, keys, scene_of, most):
    """Over the cone and over its span, at up to `most` validation mu, in both norms. `keys`: (variant,
    pair, tolerance)."""
    rows, opened, compared, disorder, apart = [], 0, 0, 0, 0
    for variant in dict.fromkeys(key[0] for key in keys):
        own = [key for key in keys if key[0] == variant]
        scenes = [scene_of(runs[key], variant) for key in own]
        mus = validation_of(runs[own[0]], len(scenes[0].run.training[0]))
        every = -(-len(mus) // most)
        for of_domain in (False, True):
            for key, values in zip(own, constants_over(scenes, mus[::every], of_domain)):
                c = np.array([value["c"] for value in values])
                cells = [", ".join(map(short, c.max(axis=0)))]
                disorder += int((c[:, 0] > c[:, 1] * CLOSED).sum())
                for larger, smaller in (("on", "off"), ("off", "dec"), ("on", "hf")):
                    disorder += sum(value[larger][0] * CLOSED < value[smaller][1] for value in values)
                verified = table(runs[key], "infsup.csv")[::every]
                for name in NAMES:
                    upper, lower, span = np.array([value[name] for value in values]).T
                    opened += int((upper > lower * CLOSED).sum())
                    compared += len(upper)
                    disorder += int((upper * CLOSED < span).sum())
                    cells.append(f"{short(upper.min())}, {short(span.min())}")
                    if not of_domain:
                        gap = np.abs(span - verified["beta_" + name]) / verified["beta_on"]
                        apart = max(apart, gap.max())
                rows.append([variant, f"({key[1][0]}, {key[1][1]})", "of mu" if of_domain else "reference",
                             *cells])
    text = markdown(f"Over the cone, over its span: largest c_HF and smallest beta of {len(mus[::every])} "
                    "validation mu", ["variant", "(N, R)", "norms", "c_HF", *("beta_" + name.replace(
                        "hf", "HF") for name in NAMES)], rows)
    return text + (f"\nUpper values over the cone that no lower one meets: {opened} of {compared}; "
                   f"exceptions from the order: {disorder}. Over the span rbvi verify has the same to "
                   f"{short(apart)} of beta_on.\n")


def errors_over(problems, truths, basis, x):
    """Mean and largest error of u and of lambda."""
    errors = np.array([problem.errors(basis, x, u, lam)
                       for problem, u, lam in zip(problems, truths[0].T, truths[1].T)])
    return [f"{short(column.mean())} / {short(column.max())}" for column in errors.T]


def enlarged_cones(runs, keys, scene_of):
    """CPG, the same enlarged, and mCPG: accuracy and conditioning of the first R generators, then of
    all, with what the models reach there. `keys`: (variant, key of CPG, key of mCPG)."""
    rows = []
    for variant, cpg, mcpg in keys:
        scenes = {"cpg": scene_of(runs[cpg], variant), "mcpg": scene_of(runs[mcpg], variant)}
        scene = scenes["cpg"]
        space, w = Space(scene.v(), scene.contact), scene.w()
        mus = validation_of(runs[cpg], len(scene.run.training[0]))
        problems, truths = [Problem(scene, space, mu) for mu in mus], scene.run.snapshots(mus)
        _, training = scene.run.snapshots(scene.run.training)
        for name in ("cpg", "cpg, enlarged", "mcpg", "mcpg, enlarged"):
            run = scenes[name.split(",")[0]].run
            enlarge = enlarged_cone if "enlarged" in name else lambda _, x: x
            cells = []
            for count in (*RADII, run.generators.shape[1]):
                if count > run.generators.shape[1]:
                    cells.append("")
                    continue
                x = enlarge(w, run.generators[:, :count])
                cells.append(f"{short(cone_error(w, x, training))}, {short(gram_condition(w, x))}")
            rows.append([variant, name, *cells[:-1], f"{run.generators.shape[1]}: {cells[-1]}",
                         *errors_over(problems, truths, run.basis, x)])
    return markdown("Enlarged cones: e(R) over the training set, Gram condition; errors of models with all R",
                    ["variant", "cone", *(f"R = {count}" for count in RADII), "all R", "u mean / max",
                     "lambda mean / max"], rows)


def double_greedy(runs, keys, scene_of):
    """Against POD + mCPG + PGA at the same tolerance: at its surrogate, and at its R. `keys`: (key of
    the run, delta)."""
    rows = []
    for key, delta in keys:
        scene = scene_of(runs[key], key[0])
        space, w, run = Space(scene.v(), scene.contact), scene.w(), scene.run
        mus = validation_of(runs[key], len(run.training[0]))
        problems = [Problem(scene, space, mu) for mu in run.training]
        unseen, truths = [Problem(scene, space, mu) for mu in mus], run.snapshots(mus)

        def row(method, sizes, surrogate, basis, x):
            rows.append([key[0], method, delta, *sizes, short(surrogate),
                         f"{stability(problems, w, basis, x)[0].min():.3f}, "
                         f"{stability(unseen, w, basis, x)[0].min():.3f}",
                         *errors_over(unseen, truths, basis, x)])

        modes, x = run.modes.shape[1], run.generators
        least = max(problem.surrogate(run.basis, x) for problem in problems)
        row("POD, mCPG, PGA", (modes, x.shape[1], run.basis.shape[1] - modes), least, run.basis, x)
        greedy, passed = DoubleGreedy(problems, w, run.snapshots(run.training), float(delta)), False
        for surrogate, _ in greedy.run(0, x.shape[1]):
            count = len(greedy.chosen)
            if (surrogate <= least and not passed) or count == x.shape[1]:
                row("double greedy", (greedy.basis.shape[1] - greedy.supremizers, count, greedy.supremizers),
                    surrogate, greedy.basis, greedy.x)
            passed = passed or surrogate <= least
    return markdown("Double greedy against POD, mCPG and PGA",
                    ["variant", "method", "delta", "N", "R", "S", "largest surrogate",
                     "smallest beta_off / beta_on: training, validation", "u mean / max",
                     "lambda mean / max"], rows)


def timed_run(study, variant):
    """A run directory on the samples of a variant."""
    out = study.out / variant / "timed"
    out.mkdir(exist_ok=True)
    if not (out / "samples").exists():
        (out / "samples").symlink_to("../samples")
    return out


def program_seconds(study, *arguments, **program):
    """User CPU seconds of a call of rbvi or rbvi-online."""
    before = user_seconds(RUSAGE_CHILDREN)
    study.call(*arguments, **program)
    return user_seconds(RUSAGE_CHILDREN) - before


def solving_costs(study, runs, keys, scene_of, tolerance, published):
    """Queries that solve for their supremizers (2.17) against PGA, in CPU seconds of one core. Offline they
    have a factor of V in place of PGA. `keys`: (variant, pair); `published`: the number of queries of the
    text, and its thresholds."""
    rows, (count, thresholds) = [], published
    for variant, pair in keys:
        run = runs[variant, pair, "tight"]
        scene = scene_of(run, variant)
        before = user_seconds()
        solve = factorised(scene.v())
        factor = user_seconds() - before
        mus = np.resize(scene.run.training, (count, scene.run.training.shape[1]))
        each = query_seconds(scene, solve, scene.run.modes, scene.run.generators, mus)
        out = timed_run(study, variant)
        on, off = (program_seconds(
            study, "offline", "-case", *study.case, *study.variants[variant], "-out", out,
            *pair_options(pair), "-pga_tolerance", tolerance, *ENRICHMENTS[how], *study.options)
                   for how in ("decorrelated", "offline"))
        on += factor
        np.savetxt(out / "queries.csv", mus, delimiter=",", comments="",
                   header=",".join(table(run, "errors.csv").dtype.names[:mus.shape[1]]))
        less = program_seconds(study, out / "model.h5", "--queries", out / "queries.csv", "--out",
                               out / "answers.csv", program="rbvi-online")
        threshold = max(0, int(np.ceil((off - on) / (each - less) * count))) if each > less else "-"
        rows.append([variant, f"({pair[0]}, {pair[1]})", f"{on:.2f}", f"{off:.2f}", f"{each:.2f}",
                     f"{less:.2f}", threshold, thresholds[pair]])
    return markdown("Supremizers solved for by each query: CPU seconds offline without the sweep, and of "
                    f"{count} queries",
                    ["variant", "(N, R)", "offline, on", "offline, off", "queries, on", "queries, off",
                     "benefit threshold", "published"], rows)
