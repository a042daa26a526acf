#!/usr/bin/env python3
"""The study of large deformations of a half-disk on a rigid disk: against contact of the undeformed
body, the steps of every iteration, the stability of reduced pairs at every step, reduced models.

    large_study.py BIN OUT [OPTION...]     e.g. cases/rigid_disk/study/large_study.py build/bin run/ls

Options go to every run (a smaller -train, fewer -arc_edges). Writes OUT/tables.md and
OUT/figures/*.png. What is there is kept.
"""

import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from figure_tools import read_grid
from study_tools import markdown, rows_of, short, study_main, summary, table

CASE = Path(__file__).resolve().parents[1] / "case.yaml"
DEPTHS = ("0.01", "0.03", "0.05", "0.07", "0.09", "0.11", "0.13", "0.15", "0.175", "0.2")
OFFSETS = ("0", "0.1")
INITIAL_GAP = 0.001
UNDEFORMED = ["-kinematics", "small", "-contact_arc", "wide"]  # on the same mesh
KINDS = {
    "radial": [*UNDEFORMED, "-normal", "radial"],
    "rigid": [*UNDEFORMED, "-normal", "rigid"],
    "large": [],
}
EDGE_DEPTHS = (0.06, 0.17)  # from there on, until the edge of contact has passed one edge of the arc
EDGES, LEVELS = 100, (0, 1, 2)  # of the arc, and meshes refined as often
PLACES = 12  # of the edge of contact in an edge of the arc
METHODS = ("newton", "kacanov", "anderson", "nodal")
VARIANTS = {"none": ["-friction", "none"], "coulomb": ["-friction", "coulomb"],
            "small": ["-friction", "none", "-arc_edges", "100"]}
CONES = {  # of pressures, for the study of stability: the smaller mesh
    "hats": ["-cone_type", "hybrid"],
    "snapshots, mCPG": ["-cone_type", "mcpg"],
}
ENRICHMENTS = ("offline", "online")
PUBLISHED = ["-multiplier_reduction", "cone", "-cone_type", "mcpg", "-pga_product", "v"]
SAMPLES = ["-train", "random:60:1"]


def at(d, offset="0", friction="none"):
    return ["-parameters", "radius", "-radius", "1,1.3", "-mu", "1", "-indentation", d,
            "-offset", offset, "-friction", friction]


def penetration(study, name, offset=0.0):
    """The largest at a node, the body where it now is."""
    curve = read_grid(study.out / "solves" / f"{name}_contact.vtu")
    place = curve.points[:, :2] + curve.of_nodes["u"][:, :2]
    return np.max(1 - np.linalg.norm(place - [offset, -2 - INITIAL_GAP], axis=1), initial=0)


def solve_all(study):
    """By what they are for."""
    jobs = {}
    for d in DEPTHS:
        for kind, options in KINDS.items():
            jobs["forces", kind, d] = (f"{kind}_{d}", [*at(d), *options], True)
        jobs["coulomb", d] = (f"coulomb_{d}", at(d, "0", "coulomb"), True)
        for offset in OFFSETS:
            for method in METHODS:
                jobs["steps", method, d, offset] = (
                    f"{method}_{d}_{offset}", [*at(d, offset), "-nonlinear_method", method,
                                               "-nonlinear_tolerance", "1e-8"], method == "newton")
    for first in EDGE_DEPTHS:
        for level in LEVELS:
            for place in range(PLACES):
                d = f"{first + np.pi / 2 / EDGES / 2**level * place / PLACES:.6g}"
                jobs["edge", first, level, place] = (f"edge_{level}_{d}", [
                    *at(d), "-arc_edges", f"{EDGES}", "-mesh_refine", f"{level}"])
    with ThreadPoolExecutor(2) as pool:
        started = {key: pool.submit(study.solve, *job) for key, job in jobs.items()}
        return {key: future.result() for key, future in started.items()}


def forces(study, answers):
    rows = []
    for d in DEPTHS:
        large = answers["forces", "large", d]
        row = [d, f"{large['energy']:.6g}", f"{large['normal_force']:.6f}",
               short(penetration(study, f"large_{d}") / float(d))]
        for kind in ("radial", "rigid"):
            force = answers["forces", kind, d]["normal_force"]
            row += [f"{force:.6f}, {100 * (force / large['normal_force'] - 1):+.2f} %",
                    short(penetration(study, f"{kind}_{d}") / float(d))]
        rows.append(row)
    return markdown("Contact of the deformed and of the undeformed body, R = 1, without friction",
                    ["d", "energy, deformed", "normal force", "penetration over d",
                     "normal force, radial normal", "penetration over d",
                     "normal force, rigid normal", "penetration over d"], rows)


def deepest_nodes(answers):
    """The largest penetration of a node over all places of the edge of contact in an edge of the
    arc: by level, for each of EDGE_DEPTHS."""
    return {first: [max(answers["edge", first, level, place]["max_penetration"]
                        for place in range(PLACES)) for level in LEVELS]
            for first in EDGE_DEPTHS}


def orders(deepest):
    """By how much it falls where edges are half as long, and over all levels."""
    return [*(np.log2(a / b) for a, b in zip(deepest, deepest[1:])),
            np.log2(deepest[0] / deepest[-1]) / (len(deepest) - 1)]


def penetration_orders(answers):
    rows = [[f"{first}", *(short(value) for value in deepest),
             *(f"{order:.2f}" for order in orders(deepest))]
            for first, deepest in deepest_nodes(answers).items()]
    steps = [f"order {a} to {b}" for a, b in zip(LEVELS, LEVELS[1:])]
    return markdown("Largest penetration of a node where the body now is, while the edge of contact "
                    "passes one edge of the arc, R = 1, without friction",
                    ["d from", *(f"refined {level} times (m)" for level in LEVELS), *steps,
                     "order over all"], rows)


def steps(answers):
    rows = []
    for offset in OFFSETS:
        for d in DEPTHS:
            found = [answers["steps", method, d, offset] for method in METHODS]
            kacanov = found[METHODS.index("kacanov")]
            rows.append([offset, d, *(f"{outputs['iterations']:.0f}" for outputs in found),
                         f"{kacanov['contraction']:.3f}"])
    return markdown("Steps from the undeformed body to 1e-8, R = 1",
                    ["offset", "d", *METHODS, "contraction of Kacanov's"], rows)


def smallest(run, column):
    return np.min(table(run, "infsup.csv")[column])


def stability(runs):
    rows = []
    for cone in CONES:
        for enrichment in ENRICHMENTS:
            run = runs["small", cone, enrichment]
            s, constants = summary(run), table(run, "infsup.csv")
            rows.append([cone, enrichment, f"{s['N']:.0f}", f"{s['R']:.0f}", f"{s['S']:.0f}",
                         f"{len(constants)}", short(smallest(run, "beta_hf")),
                         *(short(smallest(run, "beta_" + kind)) for kind in ("dec", "on", "off")),
                         f"{np.min(constants['beta_off'] / constants['beta_on']):.3f}",
                         short(s["u_max"]), short(s["lambda_max"]), f"{1e3 * s['seconds']:.2f}"])
    return markdown("Reduced pairs: the smallest constants over the pairs (mu, k) of validation",
                    ["cone", "enrichment", "N", "R", "S", "pairs (mu, k)", "beta_HF", "beta_dec",
                     "beta_on", "beta_off", "beta_off / beta_on", "u", "lambda", "ms"], rows)


def models(runs):
    rows = []
    for title, key in (("law at every node", ("none", "default")),
                       ("law at every node, Coulomb", ("coulomb", "default")),
                       ("cone of hats, supremizers in energy", ("none", "hats energy")),
                       ("cone of hats, 60 samples", ("none", "hats")),
                       ("published way, 60 samples", ("none", "published")),
                       ("published way, online-enriched", ("none", "published online"))):
        s = summary(runs[key])
        rows.append([title, f"{s['N']:.0f} + {s['S']:.0f}", f"{s['R']:.0f}", short(s["u_max"]),
                     short(s["lambda_max"]), short(s["u_floor_max"]), short(s["lambda_floor_max"]),
                     f"{1e3 * s['seconds']:.2f}"])
    return markdown("Reduced models, largest errors over 30 validation parameters",
                    ["model", "N + S", "R", "u", "lambda", "u, projection", "lambda, projection",
                     "ms per query"], rows)


def error_map(runs):
    """Of the published way."""
    return rows_of(runs["none", "published"] / "verify" / "error_map.csv")


def sizes(runs):
    rows = [[f"{row['N']:.0f}", f"{row['R']:.0f}", short(row["u_max"]), short(row["u_floor_max"]),
             short(row["lambda_max"]), short(row["lambda_floor_max"])]
            for row in error_map(runs)]
    return markdown("The published way over N and R, without supremizers",
                    ["N", "R", "u", "u, projection", "lambda", "lambda, projection"], rows)


def all_runs(study):
    jobs = {("none", "default"): ("default", [], False),
            ("coulomb", "default"): ("default", [], False),
            ("none", "hats energy"): ("hats energy", ["-multiplier_reduction", "cone",
                                                      "-pga_product", "energy"], False),
            ("none", "hats"): ("hats", ["-multiplier_reduction", "cone", *SAMPLES], False),
            ("none", "published"): ("published", [*PUBLISHED, *SAMPLES], False),
            ("none", "published online"): (
                "published online", [*PUBLISHED, *SAMPLES, "-pga_enrichment", "online"], False)}
    for cone, options in CONES.items():
        for enrichment in ENRICHMENTS:
            jobs["small", cone, enrichment] = (f"{cone}, {enrichment}", [
                "-multiplier_reduction", "cone", *options, "-pga_enrichment", enrichment, *SAMPLES],
                True)
    return study.run_all(jobs)


def work(study):
    answers, runs = solve_all(study), all_runs(study)
    from large_study_figures import draw_all
    return ([forces(study, answers), penetration_orders(answers), steps(answers),
             stability(runs), models(runs), sizes(runs)],
            lambda directory: draw_all(study, answers, runs, directory))


if __name__ == "__main__":
    sys.exit(study_main(__doc__, [CASE, "-variant", "large"], VARIANTS, work))
