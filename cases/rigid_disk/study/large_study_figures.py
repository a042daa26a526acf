"""Figures of large_study.py."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from figure_tools import BLUE, GREEN, GREY, ORANGE, log_axis, plt, read_grid, save
from large_study import (CONES, DEPTHS, EDGES, INITIAL_GAP, KINDS, LEVELS, METHODS, OFFSETS,
                         deepest_nodes, error_map, penetration)
from solution_figures import draw_bodies
from study_tools import table

import numpy as np

STYLES = {"radial": ("undeformed body, radial normal", ORANGE, "s-"),
          "rigid": ("undeformed body, rigid normal", GREEN, "^-"),
          "large": ("deformed body", BLUE, "o-")}
SHOWN_PRESSURES = ("0.05", "0.13", "0.2")
SHALLOWEST = 1e-6  # of d: none is drawn there
CONSTANTS = {"hf": (r"$\beta_{HF}$", ORANGE, dict(linewidth=5, alpha=0.4)),
             "on": (r"$\beta_{on}$", GREEN, dict(marker="o")),
             "off": (r"$\beta_{off}$", BLUE, dict(linestyle="--", marker="x")),
             "dec": (r"$\beta_{dec}$", GREY, dict(marker="o"))}
COLOURS = (BLUE, GREEN, ORANGE, GREY)


def deformed(study, directory):
    """The body at d = 0.2, above the rigid disk and off its centre."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.2), constrained_layout=True, sharex=True,
                                sharey=True)
    for axis, offset in zip(axes, OFFSETS):
        angle = np.linspace(0, np.pi, 200)
        axis.fill(float(offset) + np.cos(angle), -2 - INITIAL_GAP + np.sin(angle), color=GREY,
                  alpha=0.4, linewidth=0)
        draw_bodies(figure, axis, study.out / "solves" / f"newton_{DEPTHS[-1]}_{offset}.vtu")
        axis.set_title(f"d = {DEPTHS[-1]} m, offset {offset} m", loc="left")
    axes[0].set_xlim(-1.15, 1.15)
    axes[0].set_ylim(-1.45, 0)
    save(figure, directory, "deformed.png")


def forces(study, answers, directory):
    """What contact of the undeformed body misses: in force, and by penetration."""
    figure, axes = plt.subplots(1, 4, figsize=(16, 3.6), constrained_layout=True)
    d = np.array([float(depth) for depth in DEPTHS])
    large = np.array([answers["forces", "large", depth]["normal_force"] for depth in DEPTHS])
    for kind in KINDS:
        name, colour, style = STYLES[kind]
        force = np.array([answers["forces", kind, depth]["normal_force"] for depth in DEPTHS])
        deepest = np.array([penetration(study, f"{kind}_{depth}") for depth in DEPTHS])
        axes[0].plot(d, force, style, color=colour, label=name)
        if kind != "large":
            axes[1].plot(d, np.abs(force / large - 1), style, color=colour)
        axes[2].plot(d, np.maximum(deepest / d, SHALLOWEST), style, color=colour)
    axes[0].set_xlabel("indentation d (m)")
    axes[0].set_title("normal force (N/m)", loc="left")
    axes[0].legend(fontsize=8)
    log_axis(axes[1], "indentation d (m)", "", "normal force, relative difference")
    log_axis(axes[2], "indentation d (m)", "", "largest penetration over d")
    axes[2].set_ylim(SHALLOWEST, 0.1)
    edge_order(answers, axes[3])
    save(figure, directory, "forces.png")


def edge_order(answers, axis):
    """The largest penetration of a node beside the edge of contact, over the length of edges."""
    h = np.pi / 2 / EDGES / 2.0**np.array(LEVELS)
    for (first, deepest), style in zip(deepest_nodes(answers).items(), ("o-", "s--")):
        axis.plot(h, deepest, style, color=BLUE, label=f"deformed body, d from {first} m")
    axis.plot(h, 0.7 * deepest[0] * (h / h[0])**1.5, ":", color=GREY, label="slope 1.5")
    log_axis(axis, "length of edges (m)", "", "largest penetration (m), over places of the edge")
    axis.set_xscale("log")
    axis.legend(fontsize=8)


def pressures(study, directory):
    """Pressures on the body along the middle of its arc, and Coulomb's shear."""
    half = 0.5
    figure, axes = plt.subplots(1, 3, figsize=(13, 3.6), constrained_layout=True, sharex=True)
    for d, colour in zip(SHOWN_PRESSURES, COLOURS):
        for axis, kind, style in ((axes[0], "large", "-"), (axes[0], "radial", ":"),
                                  (axes[1], "coulomb", "-"), (axes[2], "coulomb", "-")):
            path = study.out / "solves" / f"{kind}_{d}_contact.vtu"
            if not path.is_file():
                continue
            curve = read_grid(path)
            name = "tangential_stress" if axis is axes[2] else "pressure"
            label = f"d = {d} m" if style == "-" else None
            middle = np.abs(curve.points[:, 0]) <= half
            axis.plot(curve.points[middle, 0], curve.of_nodes[name][middle], style, color=colour,
                      label=label)
    for axis, title in zip(axes, ("pressure (Pa); dotted: undeformed, radial normal",
                                  "pressure (Pa), Coulomb 0.2", r"$\lambda_\tau$ (Pa)")):
        axis.set_title(title, loc="left")
        axis.set_xlabel("x (m)")
        axis.set_xlim(-half, half)
    axes[0].legend(fontsize=8)
    save(figure, directory, "pressures.png")


def steps(answers, directory):
    """Steps of every iteration, and the rate of Kacanov's."""
    figure, axes = plt.subplots(1, 3, figsize=(13, 3.4), constrained_layout=True)
    d = np.array([float(depth) for depth in DEPTHS])
    for axis, offset in zip(axes, OFFSETS):
        for method, colour in zip(METHODS, COLOURS):
            count = [answers["steps", method, depth, offset]["iterations"] for depth in DEPTHS]
            axis.plot(d, count, "o-", color=colour, label=method)
        axis.set_title(f"steps to 1e-8, offset {offset} m", loc="left")
        axis.set_ylim(bottom=0)
    for offset, colour in zip(OFFSETS, (BLUE, ORANGE)):
        rate = [answers["steps", "kacanov", depth, offset]["contraction"] for depth in DEPTHS]
        axes[2].plot(d, rate, "o-", color=colour, label=f"offset {offset} m")
    axes[2].set_title("contraction of Kacanov's iteration", loc="left")
    for axis in axes:
        axis.set_xlabel("indentation d (m)")
    axes[0].legend(fontsize=8)
    axes[2].legend(fontsize=8)
    save(figure, directory, "steps.png")


def constants(runs, directory):
    """Inf-sup constants over the steps of the iteration, and along the supremizers."""
    figure, axes = plt.subplots(1, 3, figsize=(13, 3.6), constrained_layout=True)
    for axis, cone in zip(axes, CONES):
        found = table(runs["small", cone, "offline"], "infsup.csv")
        step = found["step"].astype(int)
        at = np.unique(step)
        for kind, (name, colour, style) in CONSTANTS.items():
            low = [found["beta_" + kind][step == k].min() for k in at]
            axis.plot(at, np.maximum(low, 1e-9), color=colour, label=name, **style)
        log_axis(axis, "step k", "smallest over validation", f"cone: {cone}")
    axes[0].legend(fontsize=8)
    for cone, colour in zip(CONES, (BLUE, ORANGE)):
        along = table(runs["small", cone, "offline"], "stability.csv")
        along = along[along["beta_min"] > 1e-9]
        axes[2].plot(along["S"], along["beta_min"], ".-", color=colour, label=cone)
    log_axis(axes[2], "supremizers S", r"smallest $\beta_{off}$", "along the greedy algorithm")
    axes[2].legend(fontsize=8)
    save(figure, directory, "infsup.png")


def errors(runs, directory):
    """Errors of the published way over N and R."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), constrained_layout=True, sharey=True)
    rows = error_map(runs)
    sizes = sorted({row["R"] for row in rows})
    for axis, part, title in zip(axes, ("u", "lambda"), ("u", r"$\lambda$")):
        for generators, colour in zip(sizes, COLOURS):
            line = [row for row in rows if row["R"] == generators]
            axis.plot([row["N"] for row in line], [row[part + "_max"] for row in line], "o-",
                      color=colour, label=f"R = {generators:.0f}")
            axis.plot([row["N"] for row in line], [row[part + "_floor_max"] for row in line], ":",
                      color=colour)
        log_axis(axis, "modes N", "", f"largest relative error of {title}; dotted: projection")
    axes[0].legend(fontsize=8)
    save(figure, directory, "errors.png")


def draw_all(study, answers, runs, directory):
    deformed(study, directory)
    forces(study, answers, directory)
    pressures(study, directory)
    steps(answers, directory)
    constants(runs, directory)
    errors(runs, directory)
