"""Figures of study.py."""

import sys
from functools import partial
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from figure_tools import (BLUE, GREEN, GREY, ORANGE, PURPLE, SHADES, history, in_length, read_grid, table,
                          use_units)
from panels import ZERO, Curve, Drawn, Lines, Triangles, ratio_of, save_panels
from solution_figures import along, contact_grids, draw_mesh, positions_of, scale_of
from study_panels import above, along_size, constants_panel, greedy_panels, share_decades, tolerance_panel

import numpy as np

PAIRS = ((3, 12), (46, 70), (46, 12))
RADII = ("0.7", "0.8", "1.0", "1.1", "1.3")
PALE = "#aaaaaa"
COLOURS = (BLUE, GREEN, GREY, ORANGE, PURPLE)


def pressure_curve(path, reach, label, colour):
    """Pressure up to x = reach."""
    x, y = along(read_grid(path), "pressure")
    shown = (x >= 0) & (x <= reach)
    return Curve(x[shown], y[shown], label, colour, width=1.2)


def draw_displaced(grid, scale, figure, axis):
    positions, u = positions_of(grid, scale), np.linalg.norm(grid.of_nodes["u"], axis=1)
    Triangles("", positions, grid.cells, u, in_length("|u|"), (0, u.max()), SHADES).draw(figure, axis)
    draw_mesh(axis, positions, grid, np.ptp(positions, axis=0).max())


def bodies_panel(path):
    grid = read_grid(path)
    scale = scale_of(grid, contact_grids(path, grid))
    return Drawn("deformed, radius 0.9 m" + f", displacements x {scale:g}" * (scale != 1),
                 partial(draw_displaced, grid, scale), ratio=ratio_of(positions_of(grid, scale)))


def solution(study, directory):
    """Deformed bodies at radius 0.9; pressures at five radii with both ways to integrate."""
    for variant in ("intersection", "direct"):
        for radius in (*RADII, "0.9"):
            study.call("solve", "-case", *study.case, *study.variants[variant], "-mu", radius,
                       "-vtu", directory / f"{variant}_{radius}.vtu")
    x, y = in_length("x"), "pressure (Pa)"
    pressures = [Lines(f"pressure, {variant}", x, y,
                       [pressure_curve(directory / f"{variant}_{radius}_contact.vtu", 0.35, f"radius {radius} m",
                                       colour) for radius, colour in zip(RADII, COLOURS)])
                 for variant in ("intersection", "direct")]
    peaks = [peaks_panel(directory, radius) for radius in ("0.7", "1.1")]
    save_panels(directory, "solution.png", [*pressures, *peaks,
                                            bodies_panel(directory / "intersection_0.9.vtu")])


def peaks_panel(directory, radius):
    """The pressure in the middle by both ways to integrate."""
    peaks = [pressure_curve(directory / f"{variant}_{radius}_contact.vtu", 0.1, f"{variant}, enlarged", colour)
             for variant, colour in (("direct", PALE), ("intersection", "black"))]
    tops = [curve.y.max() for curve in peaks]
    return Lines(f"radius {radius} m, enlarged", in_length("x"), "pressure (Pa)", peaks,
                 ylimits=(0.93 * min(tops), 1.01 * max(tops)))


def bases(runs, directory):
    """Convergence on the training set."""
    pod, errors = [], {"cpg": [], "mcpg": []}
    for variant, colour, style in (("intersection", BLUE, "-"), ("direct", ORANGE, "-"),
                                   ("p1 multipliers", GREEN, ":")):
        pod.append(along_size(history(runs[variant, "mcpg"], "pod/error"), variant, colour, style, 1e-13))
        for name, curves in errors.items():
            run = runs[variant, name]
            curves.append(above(ZERO, Curve(history(run, "cone/size"), history(run, "cone/error"), variant, colour,
                                            style)))
    orthogonality = [Curve(history(runs["intersection", name], "cone/size")[1:],
                           history(runs["intersection", name], "cone/e_orth"), words, colour, style)
                     for name, words, colour, style in (("cpg", "CPG", PURPLE, "-"), ("mcpg", "mCPG", GREY, "--"))]
    functions = "functions of the dual basis R"
    save_panels(directory, "bases.png", [
        Lines("displacement in its modes, POD", "modes N", "relative error (-)", pod, log=True, floor=1e-13),
        *(Lines(f"multiplier, {words}", functions, "largest relative error (-)", errors[name], log=True)
          for name, words in (("cpg", "CPG"), ("mcpg", "mCPG"))),
        Lines("new functions (e_orth), intersection", functions, "distance to the cone before (-)", orthogonality,
              log=True)])


def greedy(runs, directory):
    """sigma and beta along the projected greedy; beta_off at both tolerances."""
    panels = []
    for variant in ("intersection", "direct"):
        steps, beside = [], []
        for pair, colour in zip(PAIRS, (BLUE, ORANGE, GREEN)):
            own = {kind: runs[variant, pair, kind] for kind in ("tight", "loose")}
            steps.append((f"N = {pair[0]}, R = {pair[1]}", colour,
                          *(table(run, "stability.csv") for run in own.values())))
            beta = [table(run, "infsup.csv") for run in own.values()]
            beside.append((colour, *((values["radius"], values["beta_off"]) for values in beta)))
        panels += [*greedy_panels(variant, steps, log_sigma=False),
                   tolerance_panel(variant, "radius (m)", beside)]
    save_panels(directory, "pga.png", panels)


def constants(runs, directory):
    panels = []
    for pair in PAIRS:
        beta = table(runs["intersection", pair, "loose"], "infsup.csv")
        panels.append(constants_panel(f"N = {pair[0]}, R = {pair[1]}, loose tolerance", "radius (m)",
                                      beta["radius"], beta))
    save_panels(directory, "infsup.png", share_decades(panels))


def draw_all(study, runs, directory):
    use_units(next(iter(runs.values())))
    directory.mkdir(exist_ok=True)
    solution(study, directory)
    bases(runs, directory)
    greedy(runs, directory)
    constants(runs, directory)
