"""Figures of study.py."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from figure_tools import (BLUE, GREEN, GREY, ORANGE, PURPLE, draw_constants, draw_greedy,
                          draw_tolerances, end_tolerances, history, log_axis, plt, save, table)
from figures import contact_regions, mesh_quality_panels
from panels import Triangles, save_panels

import numpy as np

STYLES = {"cpg": (ORANGE, "--"), "mcpg": (BLUE, "-"), "mcpg, tolerance 0.001": (BLUE, ":"),
          "angle_greedy": (PURPLE, "--"), "nmf": (GREY, "-"), "nodal": ("black", ":"),
          "hybrid": (GREEN, "-")}
PAIRS = ((19, 50), (51, 70), (89, 50))


def same_decades(axes):
    """One range for all, in whole decades."""
    values = np.concatenate([line.get_ydata() for axis in axes for line in axis.lines])
    low, high = np.log10(np.min(values)), np.log10(np.max(values))
    for axis in axes:
        axis.set_ylim(10 ** np.floor(low), 10 ** np.ceil(high))


def bases(runs, directory):
    """Convergence on the training set, similarity map."""
    figure, axes = plt.subplots(1, 4, figsize=(13, 3.2), constrained_layout=True)
    pod = history(runs["similarity", "mcpg", "offline"], "pod/error")
    pod = pod[pod > 1e-14]
    axes[0].plot(np.arange(len(pod)), pod, color=GREY)
    log_axis(axes[0], "modes N", "relative error", "displacement, e_POD")
    for name, (colour, style) in STYLES.items():
        run = runs.get(("similarity", "fine " + name))
        if run is None:
            continue
        size, error = history(run, "cone/size"), history(run, "cone/error")
        first = 1 if name in ("nmf", "hybrid") else 0  # no size in between
        marks = "." if first else ""
        axes[1].plot(size[first:], np.maximum(error[first:], 1e-8), style + marks, color=colour,
                     label=name)
        axes[3].plot(size[1:], history(run, "cone/gram_condition"), style, color=colour)
        if name in ("cpg", "mcpg"):
            axes[2].plot(size[1:], history(run, "cone/e_orth"), style, color=colour)
    log_axis(axes[1], "dual functions R", "largest relative error", "multiplier, training set")
    log_axis(axes[2], "generators R", "distance to the cone before", "e_orth")
    log_axis(axes[3], "dual functions R", "condition number", "Gram matrix")
    axes[1].legend(fontsize=7)
    save(figure, directory, "bases.png")


def floors(runs, rows_of, directory):
    """What each dual basis allows and what its model reaches, over the validation set."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.4), constrained_layout=True)
    for axis, disc_map in zip(axes, ("similarity", "graded")):
        for k, name in enumerate(STYLES):
            s = rows_of(runs[disc_map, name, "offline"])
            axis.plot([k, k], [max(s["lambda_floor_max"], 1e-7), s["lambda_max"]], color="#bbbbbb")
            axis.plot(k, max(s["lambda_floor_max"], 1e-7), "o", color=ORANGE,
                      label="floor: projection alone" if k == 0 else None)
            axis.plot(k, s["lambda_max"], "s", color=BLUE, label="reached" if k == 0 else None)
            axis.plot(k, s["u_max"], "^", color=GREEN, label="displacement" if k == 0 else None)
        log_axis(axis, "", "largest relative error", f"{disc_map} map, 64 validation mu")
        axis.set_xticks(range(len(STYLES)), [f"{name.replace(', ', chr(10))}\nR = "
                        f"{rows_of(runs[disc_map, name, 'offline'])['R']:.0f}" for name in STYLES],
                        fontsize=7)
    axes[0].legend(fontsize=8)
    same_decades(axes)
    save(figure, directory, "floors.png")


def greedy(runs, rows_of, directory):
    """sigma and beta along the projected greedy; the two bounds; beta_off at both tolerances."""
    figure, axes = plt.subplots(2, 4, figsize=(17, 6), constrained_layout=True)
    for row, disc_map in zip(axes, ("similarity", "graded")):
        for pair, colour in zip(PAIRS, (BLUE, ORANGE, GREEN)):
            steps = table(runs[disc_map, pair, "tight"], "stability.csv")
            loose = table(runs[disc_map, pair, "loose"], "stability.csv")
            draw_greedy(row[:2], steps, loose, colour, f"({pair[0]}, {pair[1]})", 1e-16)
            row[2].plot(steps["S"], steps["ratio_min"], color=colour)
            row[2].plot(steps["S"], steps["bound_min"], "--", color=colour)
            holds = steps["classic_min"] > 0
            row[2].plot(steps["S"][holds], steps["classic_min"][holds], ":", color=colour)
            draw_tolerances(row[3], pair, {
                tolerance: (runs[disc_map, pair, tolerance], rows_of(runs[disc_map, pair, tolerance]))
                for tolerance in ("tight", "loose")}, colour)
        end_tolerances(row[3], "validation parameters, sorted")
        log_axis(row[0], "supremizers", r"largest $\sigma$", f"{disc_map}; dots: loose tolerance")
        log_axis(row[1], "supremizers", r"smallest $\beta_{off}$", "inf-sup constant")
        row[2].set_ylim(0, 1.05)
        row[2].set_xlabel("supremizers")
        row[2].set_title(r"$\beta_{off}/\beta_{on}$; -- $\sqrt{1-\sigma^2}$; ... (2.24)", loc="left")
        row[0].legend(title="(N, R)")
    save(figure, directory, "pga.png")


def constants(runs, directory):
    figure, axes = plt.subplots(2, 3, figsize=(12, 6), constrained_layout=True)
    for row, disc_map in zip(axes, ("similarity", "graded")):
        for axis, pair in zip(row, PAIRS):
            beta = table(runs[disc_map, pair, "loose"], "infsup.csv")
            rank = np.argsort(np.argsort(beta["beta_on"])).astype(float)
            draw_constants(axis, rank, beta)
            log_axis(axis, "validation parameters, sorted", "inf-sup constant",
                     f"{disc_map}, (N, R) = {pair}")
    axes[0, 0].legend()
    same_decades(axes.ravel())
    save(figure, directory, "infsup.png")


def modes(runs, rows_of, directory):
    """Error of u and lambda over N."""
    figure, axes = plt.subplots(1, 4, figsize=(13, 3.2), constrained_layout=True)
    for pair, disc_map in ((axes[:2], "similarity"), (axes[2:], "graded")):
        for axis, field in zip(pair, ("u", "lambda")):
            for name, (colour, style) in STYLES.items():
                rows = [rows_of(runs[disc_map, name, key]) for key in (19, 51, "offline")]
                axis.plot([row["N"] for row in rows], [row[field + "_max"] for row in rows],
                          style, marker="o", color=colour, label=name)
            log_axis(axis, "modes N", "largest relative error", f"{field}, {disc_map}")
    axes[3].legend(fontsize=7)
    same_decades(axes)
    save(figure, directory, "modes.png")


def pairs(runs, directory):
    """Error of lambda over (N, R): decorrelated and online-enriched, similarity map."""
    names = ("cpg", "mcpg", "angle_greedy", "hybrid")
    figure, axes = plt.subplots(2, len(names), figsize=(13, 6), constrained_layout=True)
    for column, name in zip(axes.T, names):
        data = table(runs["similarity", name, "offline"], "error_map.csv")
        for axis, kind, title in zip(column, (0, 1), ("decorrelated", "online-enriched")):
            rows = data[(data["enriched"] == kind) & np.isfinite(data["lambda_max"])]
            for n, colour in zip(np.unique(data["N"]), (GREY, ORANGE, GREEN, BLUE)):
                part = rows[rows["N"] == n]
                axis.plot(part["R"], part["lambda_max"], "o-", color=colour, label=f"N = {n:.0f}")
                axis.plot(part["R"], part["u_max"], "^:", color=colour)
            if len(rows) == 0:
                axis.text(0.5, 0.5, "no answer somewhere\nfor every pair", ha="center",
                          transform=axis.transAxes)
            log_axis(axis, "dual functions R", "largest relative error", f"{name}, {title}")
    axes[1, 0].legend(title="o lambda, ^ u", fontsize=7)
    same_decades(axes.ravel())
    save(figure, directory, "pairs.png")


def pressures(runs, directory):
    """Pressure and its error at the worst validation parameter, mCPG and hybrid."""
    figure, axes = plt.subplots(2, 3, figsize=(12, 6.4), constrained_layout=True)
    for row, name in zip(axes, ("mcpg", "hybrid")):
        run = runs["similarity", name, "offline"]
        data = table(run, "worst_pressure.csv")
        (region,) = contact_regions(run, data)
        error = data["reduced"] - data["high_fidelity"]
        top, bound = data["high_fidelity"].max(), np.abs(error).max()
        panels = [Triangles(f"{name}: {column.replace('_', '-')}", region.points, region.cells,
                            region.at_nodes(data[column]), "pressure (Pa)", (0, top)) for column in ("high_fidelity", "reduced")]
        panels.append(Triangles(f"{name}: error", region.points, region.cells, region.at_nodes(error),
                                "error of the pressure (Pa)", (-bound, bound), "RdBu_r"))
        for axis, panel in zip(row, panels):
            panel.draw(figure, axis)
            axis.set_title(panel.title, loc="left")
    save(figure, directory, "pressure.png")


def draw_all(runs, summary, directory):
    bases(runs, directory)
    floors(runs, summary, directory)
    greedy(runs, summary, directory)
    constants(runs, directory)
    modes(runs, summary, directory)
    pairs(runs, directory)
    pressures(runs, directory)
    save_panels(directory, "mesh_quality.png",
                mesh_quality_panels(runs["similarity", "mcpg", "offline"]))
