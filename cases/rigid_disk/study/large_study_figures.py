"""Figures of large_study.py."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from figure_tools import BLUE, GREEN, GREY, ORANGE, PURPLE, in_length, read_grid, table, use_units
from large_study import (CONES, DEPTHS, EDGES, INITIAL_GAP, KINDS, LEVELS, METHODS, OFFSETS,
                         deepest_nodes, error_map, penetration)
from panels import ZERO, Curve, Lines, save_panels
from study_panels import STABLE, above, over_disk, pale, share_decades

import numpy as np

STYLES = {"radial": ("undeformed body, radial normal", ORANGE, "s-"),
          "rigid": ("undeformed body, rigid normal", GREEN, "^-"),
          "large": ("deformed body", BLUE, "o-")}
SHOWN_PRESSURES = ("0.05", "0.13", "0.2")
SHALLOWEST = 1e-6  # of d: none is drawn there
CONSTANTS = {"hf": (r"$\beta_{HF}$", pale(ORANGE), "-", False, 5), "on": (r"$\beta_{on}$", GREEN, "o-"),
             "off": (r"$\beta_{off}$", BLUE, "x--"), "dec": (r"$\beta_{dec}$", GREY, "s-")}
COLOURS = (BLUE, GREEN, ORANGE, GREY)


def deformed(study, directory):
    """The body at d = 0.2, above the rigid disk and off its centre."""
    save_panels(directory, "deformed.png", [
        over_disk(f"d = {DEPTHS[-1]} m, offset {offset} m",
                  study.out / "solves" / f"newton_{DEPTHS[-1]}_{offset}.vtu", (float(offset), -2 - INITIAL_GAP),
                  ((-1.15, 1.15), (-1.45, 0))) for offset in OFFSETS])


def forces(study, answers, directory):
    """What contact of the undeformed body misses: in force, and by penetration."""
    d = np.array([float(depth) for depth in DEPTHS])
    large = np.array([answers["forces", "large", depth]["normal_force"] for depth in DEPTHS])
    of_force, differences, depths = [], [], []
    for kind in KINDS:
        name, colour, style = STYLES[kind]
        force = np.array([answers["forces", kind, depth]["normal_force"] for depth in DEPTHS])
        deepest = np.array([penetration(study, f"{kind}_{depth}") for depth in DEPTHS])
        of_force.append(Curve(d, force, name, colour, style))
        if kind != "large":
            differences.append(Curve(d, np.abs(force / large - 1), name, colour, style))
        depths.append(above(SHALLOWEST, Curve(d, deepest / d, name, colour, style)))
    x = "indentation d (m)"
    save_panels(directory, "forces.png", [
        Lines("normal force", x, "force (N/m)", of_force),
        Lines("normal force, against the deformed body", x, "relative difference (-)", differences, log=True),
        Lines(f"largest penetration over d, where above {SHALLOWEST:.0e}", x, "penetration (-)", depths, log=True,
              floor=SHALLOWEST),
        edge_order(answers)])


def edge_order(answers):
    """The largest penetration of a node beside the edge of contact, over the length of edges."""
    h, curves = np.pi / 2 / EDGES / 2.0**np.array(LEVELS), []
    for (first, deepest), style in zip(deepest_nodes(answers).items(), ("o-", "s--")):
        curves.append(Curve(h, np.array(deepest), f"deformed body, d from {first} m", PURPLE, style))
    curves.append(Curve(h, 0.7 * curves[0].y[0] * (h / h[0])**1.5, "slope 1.5", GREY, ":"))
    return Lines("deepest node at the edge of contact", "length of edges (m)", "largest penetration (m)", curves,
                 log=True, log_x=True)


def pressures(study, directory):
    """Pressures on the body along the middle of its arc, and Coulomb's shear."""
    parts = {"pressure; dotted: undeformed, radial normal": (("large", "pressure", "-"), ("radial", "pressure", ":")),
             "pressure, Coulomb 0.2": (("coulomb", "pressure", "-"),),
             "shear, Coulomb 0.2": (("coulomb", "tangential_stress", "-"),)}
    panels = []
    for title, kinds in parts.items():
        curves = []
        for d, colour in zip(SHOWN_PRESSURES, COLOURS):
            for kind, name, style in kinds:
                path = study.out / "solves" / f"{kind}_{d}_contact.vtu"
                if not path.is_file():
                    continue
                grid = read_grid(path)
                middle = np.abs(grid.points[:, 0]) <= 0.5
                curves.append(Curve(grid.points[middle, 0], grid.of_nodes[name][middle],
                                    f"d = {d} m" if style == "-" else "", colour, style))
        panels.append(Lines(title, in_length("x"), r"$\lambda_\tau$ (Pa)" if "shear" in title else r"$\lambda_n$ (Pa)",
                            curves))
    save_panels(directory, "pressures.png", panels)


def steps(answers, directory):
    """Steps of every iteration, and the rate of Kacanov's."""
    d = np.array([float(depth) for depth in DEPTHS])

    def found(method, offset, output):
        return np.array([answers["steps", method, depth, offset][output] for depth in DEPTHS])

    x = "indentation d (m)"
    save_panels(directory, "steps.png", [
        *(Lines(f"steps to 1e-8, offset {offset} m", x, "steps (number)",
                [Curve(d, found(method, offset, "iterations"), method, colour, "o-")
                 for method, colour in zip(METHODS, COLOURS)]) for offset in OFFSETS),
        Lines("contraction of Kacanov's iteration", x, "contraction (-)",
              [Curve(d, found("kacanov", offset, "contraction"), f"offset {offset} m", PURPLE, style)
               for offset, style in zip(OFFSETS, ("s-", "^--"))])])


def constants(runs, directory):
    """Inf-sup constants over the steps of the iteration, and along the supremizers."""
    panels, along = [], []
    for cone, colour in zip(CONES, (PURPLE, "black")):
        found = table(runs["small", cone, "offline"], "infsup.csv")
        step = found["step"].astype(int)
        at = np.unique(step)
        curves = [Curve(at, np.array([found["beta_" + kind][step == k].min() for k in at]), *look)
                  for kind, look in CONSTANTS.items()]
        panels.append(Lines(f"smallest over validation, cone: {cone}", "step k (number)", "inf-sup constant (-)",
                            curves, log=True, floor=STABLE))
        greedy = table(runs["small", cone, "offline"], "stability.csv")
        along.append(above(STABLE, Curve(greedy["S"], greedy["beta_min"], f"cone: {cone}", colour, ".-")))
    panels.append(Lines(r"smallest $\beta_{off}$ along the greedy algorithm; before: 0", "supremizers S",
                        "inf-sup constant (-)", along, log=True, floor=STABLE))
    save_panels(directory, "infsup.png", panels)


def errors(runs, directory):
    """Errors of the published way over N and R."""
    rows, panels = error_map(runs), []
    for part, words in (("u", "displacement"), ("lambda", "multiplier")):
        curves = []
        for size, colour in zip(sorted({row["R"] for row in rows}), COLOURS):
            line = [row for row in rows if row["R"] == size]
            n = np.array([row["N"] for row in line])
            curves += [above(ZERO, Curve(n, np.array([row[part + column] for row in line]), label, colour, style))
                       for column, label, style in (("_max", f"R = {size:.0f}", "o-"), ("_floor_max", "", ":"))]
        panels.append(Lines(f"{words}; dotted: projection", "modes N", "largest relative error (-)", curves, log=True))
    save_panels(directory, "errors.png", share_decades(panels))


def draw_all(study, answers, runs, directory):
    use_units(next(iter(runs.values())))
    deformed(study, directory)
    forces(study, answers, directory)
    pressures(study, directory)
    steps(answers, directory)
    constants(runs, directory)
    errors(runs, directory)
