"""Figures of nitsche_study.py."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from figure_tools import (BLUE, GREEN, GREY, ORANGE, PURPLE, Missing, history, log_axis, plt,
                          read_grid, save)
from nitsche_study import EIM_ERRORS, GAMMA0, GENERATORS, LAWS, RADII, RULES, SIZES, error_map
from solution_figures import draw_bodies
from study_tools import rows_of, summary

import numpy as np

SHOWN = 0.25  # of the arc: a little more than is ever in contact
INITIAL_GAP, BOUND = 0.001, 0.1  # BOUND: Tresca's threshold, Coulomb's coefficient
MODULUS = 15 * (1 - 0.35) / ((1 + 0.35) * (1 - 2 * 0.35))  # lambda + 2 mu
RULE_STYLES = {"empirical": (BLUE, "o-"), "full": (GREEN, "x-"), "interpolated": (ORANGE, "s:")}


class ContactCurve:
    """The stresses along the curve, and what the laws make of them."""

    def __init__(self, path, law):
        curve = read_grid(path)
        points, fields = curve.points, curve.of_nodes
        self.x, self.gap = points[:, 0], fields["gap"]
        normal = points[:, :2] / np.linalg.norm(points[:, :2], axis=1)[:, None]
        # gamma is over the length of an edge in the reference domain.
        gamma = GAMMA0 * MODULUS / (2 * np.sin(np.pi / 8 / len(curve.cells)))
        self.sigma_n = -fields["pressure"]
        p_n = self.sigma_n + gamma * self.gap
        self.contact = np.minimum(p_n, 0)
        if law == "none":
            return
        self.sigma_tau = -fields["tangential_stress"]
        along = normal[:, 0] * fields["u"][:, 1] - normal[:, 1] * fields["u"][:, 0]
        bound = BOUND if law == "tresca" else -BOUND * self.contact
        self.friction = np.clip(self.sigma_tau - gamma * along, -bound, bound)


def curve(study, law, radius):
    return ContactCurve(study.out / "solves" / f"{law}_{radius}_contact.vtu", law)


def deformed(study, directory):
    """Deformed half-disks on the rigid disk (figure 4.2)."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.2), constrained_layout=True, sharex=True,
                                sharey=True)
    for axis, radius in zip(axes, (RADII[0], RADII[-1])):
        angle = np.linspace(0, np.pi, 200)
        bottom = -float(radius) - INITIAL_GAP - 1
        axis.fill(np.cos(angle), bottom + np.sin(angle), color=GREY, alpha=0.4, linewidth=0)
        draw_bodies(figure, axis, study.out / "solves" / f"none_{radius}.vtu")
        axis.set_title(f"radius {radius} m", loc="left")
    axes[0].set_xlim(-1.35, 1.35)
    axes[0].set_ylim(-1.9, 0)
    save(figure, directory, "deformed.png")


def normal_stress(study, directory):
    """Normal stress, its Alart-Curnier counterpart, and the gap (figure 4.3)."""
    figure, axes = plt.subplots(2, 3, figsize=(13, 5.4), constrained_layout=True, sharex=True,
                                sharey="row")
    for (top, bottom), radius in zip(axes.T, RADII):
        found = curve(study, "none", radius)
        top.plot(found.x, found.contact, color=ORANGE, linewidth=4, alpha=0.5,
                 label=r"$\min(P_n, 0)$")
        top.plot(found.x, found.sigma_n, color=BLUE, linewidth=1, label=r"$\sigma_n(u)$")
        bottom.plot(found.x, -1e3 * found.gap, color=BLUE)
        top.set_title(f"stresses (Pa), radius {radius} m", loc="left")
        bottom.set_title(r"$u_n - g$ (mm)", loc="left")
        bottom.set_xlabel("x (m)")
        bottom.set_xlim(-SHOWN, SHOWN)
        bottom.set_ylim(-10, 1)
    axes[0, 0].legend(fontsize=8)
    save(figure, directory, "normal.png")


def tangential_stress(study, directory):
    """Tangential stress and its Alart-Curnier counterpart, Tresca and Coulomb (figure 4.9)."""
    figure, axes = plt.subplots(2, 3, figsize=(13, 5.4), constrained_layout=True, sharey="row",
                                sharex="row")
    for row, law in zip(axes, ("tresca", "coulomb")):
        for axis, radius in zip(row, RADII):
            found = curve(study, law, radius)
            axis.plot(found.x, found.friction, color=ORANGE, linewidth=4, alpha=0.5,
                      label=r"$P_\tau$ within the bound")
            axis.plot(found.x, found.sigma_tau, color=BLUE, linewidth=1,
                      label=r"$\sigma_\tau(u)$")
            axis.set_title(f"{LAWS[law].split(',')[0]}, radius {radius} m", loc="left")
            axis.set_xlabel("x (m)")
        row[0].set_ylabel("stress (Pa)")
    axes[1, 0].set_xlim(-SHOWN, SHOWN)
    axes[0, 0].legend(fontsize=8)
    save(figure, directory, "tangential.png")


def modes(runs, directory):
    """Projection errors over the training set (figures 4.4 and 4.10)."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.6), constrained_layout=True, sharey=True)
    curves = [(axes[0], ("none", "full"), "61 radii", BLUE),
              (axes[0], ("none", "grid 201"), "201 radii", ORANGE),
              (axes[0], ("none", "grid 241"), "241 radii", GREEN),
              (axes[1], ("tresca", "full"), "Tresca, 61 radii", BLUE),
              (axes[1], ("coulomb", "full"), "Coulomb, 61 radii", ORANGE)]
    for axis, key, label, colour in curves:
        if key not in runs:
            continue
        error = history(runs[key], "pod/error")
        error = error[error > 1e-12]
        axis.plot(np.arange(len(error)), error, color=colour, label=label)
    log_axis(axes[0], "modes N", r"$e_{POD}$", "without friction")
    log_axis(axes[1], "modes N", "", "with friction")
    for axis in axes:
        axis.legend(fontsize=8)
    save(figure, directory, "pod.png")


def interpolation(runs, directory):
    """Errors of the empirical interpolation over (mu, Newton step): matrices above, vectors below;
    over the training set, other parameters, and the last steps there (figures 4.5, 4.11, 4.12)."""
    parts = (("matrix", "$B^n$", r"$B^\tau$"), ("vector", r"$\Theta^n$", r"$\Theta^\tau$"))
    sets = (("", "training", "-"), ("_validation", "validation", ":"),
            ("_converged", "validation, last step", "--"))
    figure, axes = plt.subplots(2, 3, figsize=(13, 6.2), constrained_layout=True, sharey=True)
    for row, (kind, *labels) in zip(axes, parts):
        for axis, (law, name) in zip(row, LAWS.items()):
            sides = ("contact",) if law == "none" else ("contact", "friction")
            for side, label, colour in zip(sides, labels, (BLUE, ORANGE)):
                for suffix, title, style in sets:
                    try:
                        error = history(runs[law, EIM_ERRORS], f"curve/{side}_{kind}{suffix}")
                    except Missing:  # zero at all these steps
                        continue
                    error = error[error > 1e-9]
                    if len(error) > 0:
                        axis.plot(np.arange(len(error)), error, style, color=colour,
                                  label=f"{label}, {title}")
            log_axis(axis, "terms", "largest relative error" if law == "none" else "",
                     f"friction: {name}" if kind == "matrix" else "")
            axis.legend(fontsize=7)
    axes[0, 0].set_ylim(1e-7, 5)
    save(figure, directory, "eim.png")


def errors(runs, directory):
    """Errors of the reduced answers against N, three treatments of the curve and the projection
    (figures 4.6 and 4.13)."""
    figure, axes = plt.subplots(2, 3, figsize=(13, 6.2), constrained_layout=True, sharex=True,
                                sharey="row")
    for (top, bottom), (law, name) in zip(axes.T, LAWS.items()):
        stress = "lambda_max" if law == "none" else "tangential_max"
        for rule in RULES:
            rows = error_map(runs[law, rule])
            colour, style = RULE_STYLES[rule]
            for axis, column in ((top, "u_max"), (bottom, stress)):
                axis.plot([row["N"] for row in rows],
                          [row[column] if row["failed"] == 0 else np.nan for row in rows], style,
                          color=colour, label=rule, markerfacecolor="none")
        rows = error_map(runs[law, "full"])
        top.plot([row["N"] for row in rows], [row["u_floor_max"] for row in rows], ":",
                 color="black", label="projection")
        floor = stress.replace("_max", "_floor_max")
        bottom.plot([row["N"] for row in rows], [row[floor] for row in rows], ":", color="black",
                    label="projection")
        log_axis(top, "", "largest relative error" if law == "none" else "",
                 f"displacement, friction: {name}")
        log_axis(bottom, "modes N", "largest relative error" if law == "none" else "",
                 "normal stress" if law == "none" else "tangential stress")
    axes[0, 0].legend(fontsize=8)
    save(figure, directory, "errors.png")


def mixed(runs, directory):
    """The mixed method on the same mesh: energy, errors of both unknowns (figures 4.7, 4.8)."""
    figure, axes = plt.subplots(1, 3, figsize=(13, 3.8), constrained_layout=True)
    for key, label, style in (("none", "Nitsche", "-"), ("mixed", "mixed", ":")):
        rows = rows_of(runs[key, "default"] / "samples.csv")
        axes[0].plot([row["radius"] for row in rows], [row["energy"] for row in rows], style,
                     color=BLUE if key == "none" else ORANGE, label=label,
                     linewidth=1.6 if key == "none" else 4)
    axes[0].set_xlabel("R (m)")
    axes[0].set_title("energy J (N)", loc="left")
    nitsche = error_map(runs["none", "empirical"])
    for axis, column in zip(axes[1:], ("u_max", "lambda_max")):
        axis.plot([row["N"] for row in nitsche], [row[column] for row in nitsche], "o-", color=BLUE,
                  label="Nitsche")
        for r, colour in zip(GENERATORS, (PURPLE, GREEN, ORANGE)):
            rows = [summary(runs["pair", f"{r}, {n}"]) for n in SIZES]
            rows = [row for row in rows if row["failed"] == 0]
            axis.plot([row["N"] + row["S"] for row in rows], [row[column] for row in rows], "s--",
                      color=colour, label=f"mixed, R = {r}", markerfacecolor="none")
        condensed = summary(runs["mixed", "default"])
        axis.axhline(condensed[column], color="black", linestyle=":", label="mixed, condensed")
    log_axis(axes[1], "modes, with supremizers", "largest relative error", "displacement")
    log_axis(axes[2], "modes, with supremizers", "", "normal stress")
    axes[0].legend(fontsize=8)
    axes[1].legend(fontsize=7, loc="center right")
    save(figure, directory, "mixed.png")


def draw_all(study, runs, directory):
    directory.mkdir(exist_ok=True)
    deformed(study, directory)
    normal_stress(study, directory)
    tangential_stress(study, directory)
    modes(runs, directory)
    interpolation(runs, directory)
    errors(runs, directory)
    mixed(runs, directory)
