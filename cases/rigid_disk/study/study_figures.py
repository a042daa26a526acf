"""Figures of study.py."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from figure_tools import (BLUE, GREEN, GREY, ORANGE, PURPLE, history, log_axis, plt, read_grid,
                          save)
from solution_figures import draw_bodies, draw_mesh
from study_tools import rows_of, separation_errors, stored, table

import numpy as np

RADII = ("0.7", "1", "1.3")
FRICTION = 0.2
INITIAL_GAP = 0.001  # m, to the rigid disk of radius 1
SHOWN = 0.25  # of the arc: a little more than is ever in contact
SIZES = {"text": ("(30, 20, 20)", ORANGE), "published": ("published tolerances", BLUE)}
MODELS = {  # of the tangential stress
    "as published": ("(30, 20, 20), 20 pairs", ORANGE, "--"),
    "published": ("published tolerances", BLUE, "-"),
    "default": ("condensed", GREEN, "-"),
}


def contact_curve(path):
    """x, pressure and tangential stress."""
    curve = read_grid(path)
    return curve.points[:, 0], *(curve.of_nodes[name] for name in ("pressure", "tangential_stress"))


def as_published(axis, x, y, text="published"):
    axis.plot(x, y, "x", color="black", markersize=7, label=text)


def laws(directory):
    """Multipliers at three radii, and Coulomb's law (figure 3.3)."""
    figure, axes = plt.subplots(1, 3, figsize=(13, 3.6), constrained_layout=True)
    for radius, colour in zip(RADII, (BLUE, GREEN, ORANGE)):
        x, pressure, stress = contact_curve(directory / f"truth_{radius}_contact.vtu")
        axes[0].plot(x, pressure, color=colour, label=f"radius {radius} m")
        axes[1].plot(x, stress, color=colour)
        axes[2].plot(x, FRICTION * pressure, color=colour, alpha=0.4, linewidth=3)
        axes[2].plot(x, np.abs(stress), color=colour, linewidth=1)
    for axis, title in zip(axes, (r"$\lambda_n$ (Pa)", r"$\lambda_\tau$ (Pa)",
                                  r"$|\lambda_\tau|$; thick: $\nu_F \lambda_n$ (Pa)")):
        axis.set_title(title, loc="left")
        axis.set_xlabel("x (m)")
        axis.set_xlim(-SHOWN, SHOWN)
    axes[0].legend(fontsize=8)
    save(figure, directory, "laws.png")


def bases(runs, directory):
    """Projection errors over the training set (figure 3.4)."""
    figure, axes = plt.subplots(1, 3, figsize=(13, 3.4), constrained_layout=True)
    floor = 1e-15
    for axis, run, name in ((axes[0], "text", "pod/error"),
                            (axes[1], "generators", "normal_cone/error"),
                            (axes[2], "text", "tangential/error")):
        error = history(runs["radius", run], name)
        error = error[error > floor]
        axis.plot(np.arange(len(error)), error, color=BLUE)
    for axis, size, error in zip(axes, (30, 20, 20), (1e-6, 1e-3, 1e-4)):
        as_published(axis, size, error)
    log_axis(axes[0], "modes N", "relative error", "displacement, POD")
    log_axis(axes[1], "generators R", "largest relative error", r"$\lambda_n$, mCPG")
    log_axis(axes[2], "modes S", "relative error", r"$\lambda_\tau$, POD")
    axes[0].legend(fontsize=8)
    save(figure, directory, "bases.png")


def greedy(runs, directory):
    """Smallest beta and sigma along the supremizers (figure 3.5)."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), constrained_layout=True)
    for key, (name, colour) in SIZES.items():
        run = runs["radius", key]
        steps = table(run, "stability.csv")
        steps = steps[steps["beta_min"] > 1e-12]
        axes[0].plot(steps["S"], steps["beta_min"], ".-", color=colour, label=name)
        sigma = history(run, "pga/sigma")
        axes[1].plot(np.arange(len(sigma)), sigma, ".-", color=colour, label=name)
    tolerance = history(runs["radius", "published"], "pga/tolerance")[0]
    axes[1].axhline(tolerance, color="black", linestyle=":", label=f"tolerance {tolerance:.3f}")
    axes[1].axhline(0.072, color=GREY, linestyle="--", label="tolerance published, 0.072")
    log_axis(axes[0], "supremizers", r"smallest $\beta$", "inf-sup constant; before: 0")
    axes[0].set_xlim(left=0)
    axes[1].set_xlabel("supremizers")
    axes[1].set_title(r"$\sigma$", loc="left")
    axes[1].legend(fontsize=8)
    save(figure, directory, "pga.png")


def interpolation(runs, directory):
    """Errors of the empirical interpolation of B^n, of B^tau and of the gap over the training and
    the validation set (figure 3.6)."""
    figure, axes = plt.subplots(2, 3, figsize=(13, 6), constrained_layout=True, sharex="col",
                                sharey="row")
    operators = {"radius": ("b", "b", "g"), "rigid": ("b_normal", "b_tangential", "g")}
    for row, count in zip(axes, (61, 150)):
        for variant, normal, colour in (("radius", "of the half-disk", BLUE),
                                        ("rigid", "of the rigid disk", ORANGE)):
            for axis, operator in zip(row, operators[variant]):
                errors = separation_errors(runs[variant, f"grid {count}"], operator)
                for error, style, name in zip(errors, (dict(marker="o"), dict(marker="+", ls="")),
                                              ("training", "validation")):
                    axis.plot(np.arange(len(error)), np.maximum(error, 1e-16), color=colour,
                              markersize=8, markerfacecolor="none", label=f"normal {normal}, "
                              f"{name} set", **style)
        for axis, title in zip(row, ("$B^n$", r"$B^\tau$", "gap")):
            log_axis(axis, "terms", "", f"{title}, {count} training radii")
            axis.set_ylim(1e-16, 3)
        for axis in row[:2]:
            as_published(axis, 41, 1e-3)
        row[0].set_ylabel("largest relative error")
    axes[0, 0].legend(fontsize=8)
    save(figure, directory, "eim.png")


def nodes(runs, directory):
    """Where the collocation nodes are, and when each was taken (figure 3.7)."""
    figure, axes = plt.subplots(1, 2, figsize=(11, 3.4), constrained_layout=True, sharey=True)
    for axis, (key, (name, colour)) in zip(axes, SIZES.items()):
        run = runs["radius", key]
        chosen, per_edge = stored(run, "law/basis/nodes"), stored(run, "interfaces/0/sizes")[3]
        vertices = len(stored(run, "interfaces/0/entities")) // per_edge + 1
        x = stored(run, "interfaces/0/points")[:vertices, 0]
        right = x[::-1][:vertices // 2 + 1]  # of pair 0, 1, ...: mirror images
        rows = rows_of(run / "samples.csv")
        for column, shade, label in (("contact_half_width", GREY, "edge of contact"),
                                     ("stick_half_width", PURPLE, "edge of stick")):
            edges = np.sin([row[column] / row["radius"] for row in rows])
            axis.axvspan(edges.min(), edges.max(), color=shade, alpha=0.25, linewidth=0,
                         label=label)
        axis.plot(right, np.zeros_like(right), "|", color=GREY)
        axis.plot(right[chosen], np.arange(1, len(chosen) + 1), "o", color=colour)
        axis.set_xlabel("x of the node at radius 1 (m)")
        axis.set_title(f"{name}: {len(chosen)} of {len(right)} pairs", loc="left")
    axes[0].set_ylabel("step at which it is taken")
    axes[1].legend(fontsize=8)
    save(figure, directory, "nodes.png")


def collocation(runs, directory):
    """Errors along the greedy selection of nodes (figure 3.8)."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), constrained_layout=True)
    for key, (name, colour) in SIZES.items():
        run = runs["radius", key]
        pairs = history(run, "gcns/nodes")
        for axis, column in zip(axes, ("error", "violation")):
            axis.plot(pairs, np.maximum(history(run, "gcns/" + column), 1e-16), ".-",
                      color=colour, label=name)
    as_published(axes[0], 20, 0.39)
    as_published(axes[1], 20, 1e-6)
    log_axis(axes[0], "pairs of nodes", "largest relative error", r"$e_{GCNS}$")
    log_axis(axes[1], "pairs of nodes", "", "violation of the bound (3.63), Pa")
    axes[0].legend(fontsize=8)
    save(figure, directory, "gcns.png")


def tangential(study, runs, directory):
    """Reduced and high-fidelity tangential stress, and the difference (figure 3.9)."""
    figure, axes = plt.subplots(2, 3, figsize=(13, 6), constrained_layout=True, sharex="col",
                                sharey="row")
    for (top, bottom), radius in zip(axes.T, RADII):
        x, _, truth = contact_curve(directory / f"truth_{radius}_contact.vtu")
        top.plot(x, truth, color=GREY, linewidth=4, alpha=0.5, label="high-fidelity")
        for key, (name, colour, style) in MODELS.items():
            path = directory / f"{key.replace(' ', '_')}_{radius}.vtu"
            study.call(runs["radius", key] / "model.h5", "--mu", radius, "--vtu", path,
                       program="rbvi-online")
            _, _, stress = contact_curve(path.with_name(path.stem + "_contact.vtu"))
            top.plot(x, stress, style, color=colour, linewidth=1.2, label=name)
            bottom.plot(x, np.maximum(np.abs(stress - truth), 1e-16), style, color=colour,
                        linewidth=1.2)
        top.set_title(rf"$\lambda_\tau$ (Pa), radius {radius} m", loc="left")
        log_axis(bottom, "x (m)", "", "its error (Pa)")
        bottom.set_xlim(-SHOWN, SHOWN)
        bottom.set_ylim(1e-14, 10)
    axes[0, 0].legend(fontsize=8)
    save(figure, directory, "tangential.png")


def configurations(directory, radius="0.7"):
    """The body at rest, and deformed by the full and by the reduced answer (figure 3.2)."""
    figure, axes = plt.subplots(1, 3, figsize=(13, 3.6), constrained_layout=True, sharex=True,
                                sharey=True)
    angle = np.linspace(0, np.pi, 200)
    for axis, title, name in zip(axes, ("at rest", "high-fidelity", "reduced, published tolerances"),
                                 ("truth", "truth", "published")):
        axis.fill(np.cos(angle), np.sin(angle) - float(radius) - INITIAL_GAP - 1, color=GREY,
                  alpha=0.4, linewidth=0)
        path = directory / f"{name}_{radius}.vtu"
        if title == "at rest":
            grid = read_grid(path)
            draw_mesh(axis, grid.points[:, :2], grid, 2 * float(radius))
        else:
            draw_bodies(figure, axis, path)
        axis.set_title(f"{title}, radius {radius} m", loc="left")
        axis.set_aspect("equal")
        axis.set_xlabel("x (m)")
    axes[0].set_ylabel("y (m)")
    axes[0].set_xlim(-0.8, 0.8)
    axes[0].set_ylim(-1, 0.05)
    save(figure, directory, "configurations.png")


def draw_all(study, runs, directory):
    directory.mkdir(exist_ok=True)
    for radius in RADII:
        study.call("solve", "-case", *study.case, "-mu", radius, "-vtu",
                   directory / f"truth_{radius}.vtu")
    laws(directory)
    bases(runs, directory)
    greedy(runs, directory)
    interpolation(runs, directory)
    nodes(runs, directory)
    collocation(runs, directory)
    tangential(study, runs, directory)
    configurations(directory)
