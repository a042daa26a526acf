"""Figures of study.py."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from figure_tools import (BLUE, GREEN, GREY, ORANGE, PURPLE, draw_constants, draw_greedy,
                          draw_tolerances, end_tolerances, history, log_axis, plt, read_grid, save,
                          step_values, table)
from solution_figures import draw_bodies
from study_tools import summary

import numpy as np

PAIRS = ((3, 12), (46, 70), (46, 12))
RADII = ("0.7", "0.8", "1.0", "1.1", "1.3")
COLOURS = (BLUE, GREEN, GREY, ORANGE, PURPLE)


def draw_pressures(axis, directory, variant, radii, colours):
    for radius, colour in zip(radii, colours):
        curve = read_grid(directory / f"{variant}_{radius}_contact.vtu")
        step_values(axis, curve, "pressure", color=colour, linewidth=1, label=f"radius {radius} m")
    axis.set_xlabel("x (m)")
    axis.set_ylabel("pressure (Pa)")
    axis.legend(fontsize=8)


def solution(study, directory):
    """Deformed bodies at radius 0.9; pressures at five radii with both ways to integrate."""
    for variant in ("intersection", "direct"):
        for radius in (*RADII, "0.9"):
            study.call("solve", "-case", *study.case, *study.variants[variant], "-mu", radius,
                       "-vtu", directory / f"{variant}_{radius}.vtu")
    figure, axes = plt.subplots(1, 4, figsize=(15, 4), constrained_layout=True,
                                gridspec_kw={"width_ratios": [0.9, 1.2, 1.2, 1.2]})
    draw_bodies(figure, axes[0], directory / "intersection_0.9.vtu")
    axes[0].set_title("deformed, radius 0.9 m", loc="left")
    for variant, axis in (("intersection", axes[1]), ("direct", axes[2])):
        draw_pressures(axis, directory, variant, RADII, COLOURS)
        axis.set_xlim(0, 0.35)
        axis.set_title(f"pressure, {variant}", loc="left")
    peaks = []
    for variant, colour in (("direct", ORANGE), ("intersection", BLUE)):
        curve = read_grid(directory / f"{variant}_1.1_contact.vtu")
        step_values(axes[3], curve, "pressure", color=colour, label=variant)
        peaks.append(curve.of_cells.get("pressure", curve.of_nodes["pressure"]).max())
    axes[3].set_xlim(0, 0.1)
    axes[3].set_ylim(0.93 * min(peaks), 1.01 * max(peaks))
    axes[3].set_xlabel("x (m)")
    axes[3].set_title("radius 1.1 m, enlarged", loc="left")
    axes[3].legend(fontsize=8)
    save(figure, directory, "solution.png")


def bases(runs, directory):
    figure, axes = plt.subplots(1, 4, figsize=(14, 3.2), constrained_layout=True)
    styles = {"intersection": (BLUE, "-"), "direct": (ORANGE, "-"), "p1 multipliers": (GREEN, ":")}
    for variant, (colour, style) in styles.items():
        pod = history(runs[variant, "mcpg"], "pod/error")
        pod = pod[pod > 1e-13]
        axes[0].plot(np.arange(len(pod)), pod, style, color=colour, label=variant)
        for axis, name in ((axes[1], "cpg"), (axes[2], "mcpg")):
            run = runs[variant, name]
            axis.plot(history(run, "cone/size"), history(run, "cone/error"), style, color=colour)
    for name, colour in (("cpg", ORANGE), ("mcpg", BLUE)):
        run = runs["intersection", name]
        axes[3].plot(history(run, "cone/size")[1:], history(run, "cone/e_orth"), color=colour,
                     label=name)
    log_axis(axes[0], "modes N", "relative error", "displacement, e_POD")
    log_axis(axes[1], "generators R", "largest relative error", "multiplier, CPG")
    log_axis(axes[2], "generators R", "largest relative error", "multiplier, mCPG")
    log_axis(axes[3], "generators R", "distance to the cone before", "e_orth, intersection")
    axes[0].legend(fontsize=8)
    axes[3].legend(fontsize=8)
    save(figure, directory, "bases.png")


def greedy(runs, directory):
    figure, axes = plt.subplots(2, 3, figsize=(14, 6), constrained_layout=True)
    for row, variant in zip(axes, ("intersection", "direct")):
        for pair, colour in zip(PAIRS, (BLUE, ORANGE, GREEN)):
            steps = table(runs[variant, pair, "tight"], "stability.csv")
            loose = table(runs[variant, pair, "loose"], "stability.csv")
            draw_greedy(row[:2], steps, loose, colour, f"({pair[0]}, {pair[1]})", 1e-6)
            draw_tolerances(row[2], pair, {
                tolerance: (runs[variant, pair, tolerance], summary(runs[variant, pair, tolerance]))
                for tolerance in ("tight", "loose")}, colour, "radius")
        end_tolerances(row[2], "radius (m)")
        row[0].set_ylim(0, 1.05)
        row[0].set_xlabel("supremizers")
        row[0].set_title(rf"largest $\sigma$, {variant}; dots: loose tolerance", loc="left")
        log_axis(row[1], "supremizers", r"smallest $\beta_{off}$", "inf-sup constant")
        row[0].legend(title="(N, R)")
    save(figure, directory, "pga.png")


def constants(runs, directory):
    figure, axes = plt.subplots(1, 3, figsize=(13, 3.4), constrained_layout=True)
    for axis, pair in zip(axes, PAIRS):
        beta = table(runs["intersection", pair, "loose"], "infsup.csv")
        draw_constants(axis, beta["radius"], beta)
        log_axis(axis, "radius (m)", "inf-sup constant (-)", f"(N, R) = {pair}, loose tolerance")
    axes[2].legend(fontsize=8)
    save(figure, directory, "infsup.png")


def draw_all(study, runs, directory):
    directory.mkdir(exist_ok=True)
    solution(study, directory)
    bases(runs, directory)
    greedy(runs, directory)
    constants(runs, directory)
