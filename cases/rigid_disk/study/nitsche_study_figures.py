"""Figures of nitsche_study.py."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from figure_tools import (BLUE, GREEN, GREY, ORANGE, PURPLE, Missing, history, in_length,
                          read_grid, use_units)
from nitsche_study import EIM_ERRORS, GAMMA0, GENERATORS, LAWS, RADII, RULES, SIZES, error_map
from panels import Curve, Lines, save_panels
from study_panels import along_size, level, over_disk, pale, share_decades
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
    panels = []
    for radius in (RADII[0], RADII[-1]):
        reach = 1.05 * float(radius)
        panels.append(over_disk(f"radius {radius} m", study.out / "solves" / f"none_{radius}.vtu",
                                (0, -float(radius) - INITIAL_GAP - 1), ((-reach, reach), (-1.4 * reach, 0.05 * reach))))
    save_panels(directory, "deformed.png", panels)


def normal_stress(study, directory):
    """Normal stress, its Alart-Curnier counterpart, and the gap (figure 4.3)."""
    panels = []
    for radius in RADII:
        found = curve(study, "none", radius)
        x, shown = in_length("x"), np.abs(found.x) <= SHOWN
        panels += [Lines(f"radius {radius} m", x, "stress (Pa)", [
            Curve(found.x[shown], found.contact[shown], r"$\min(P_n,0)$", pale(ORANGE), width=4),
            Curve(found.x[shown], found.sigma_n[shown], r"$\sigma_n(u)$", width=1)]),
            Lines(f"gap, radius {radius} m", x, r"$u_n - g$ (mm)",
                  [Curve(found.x[shown], -1e3 * found.gap[shown])], ylimits=(-10, 1))]
    save_panels(directory, "normal.png", panels)


def tangential_stress(study, directory):
    """Tangential stress and its Alart-Curnier counterpart, Tresca and Coulomb (figure 4.9)."""
    panels = []
    for radius in RADII:
        for law in ("tresca", "coulomb"):
            found = curve(study, law, radius)
            shown = np.abs(found.x) <= (SHOWN if law == "coulomb" else np.inf)
            panels.append(Lines(f"{LAWS[law].split(',')[0]}, radius {radius} m", in_length("x"), "stress (Pa)", [
                Curve(found.x[shown], found.friction[shown], r"$P_\tau$ within the bound", pale(ORANGE), width=4),
                Curve(found.x[shown], found.sigma_tau[shown], r"$\sigma_\tau(u)$", width=1)]))
    save_panels(directory, "tangential.png", panels)


def modes(runs, directory):
    """Projection errors over the training set (figures 4.4 and 4.10)."""
    kinds = {"without friction": ((("none", "full"), "61 radii", BLUE), (("none", "grid 201"), "201 radii", ORANGE),
                                  (("none", "grid 241"), "241 radii", GREEN)),
             "with friction, 61 radii": ((("tresca", "full"), "Tresca", PURPLE),
                                         (("coulomb", "full"), "Coulomb", GREY))}
    save_panels(directory, "pod.png", share_decades([
        Lines(title, "modes N", r"$e_{POD}$ (-)",
              [along_size(history(runs[key], "pod/error"), label, colour, least=1e-12)
               for key, label, colour in curves if key in runs], log=True) for title, curves in kinds.items()]))


def interpolation(runs, directory):
    """Errors of the empirical interpolation over (mu, Newton step): matrices and vectors; over the training
    set, other parameters, and the last steps there (figures 4.5, 4.11, 4.12)."""
    parts = (("matrix", "$B$"), ("vector", r"$\Theta$"))
    sets = (("", "training", "-"), ("_validation", "validation", ":"),
            ("_converged", "validation, last step", "--"))
    panels = []
    for law, name in LAWS.items():
        for kind, symbol in parts:
            curves = []
            for side, label, colour in (("contact", "normal", BLUE), ("friction", "tangential", ORANGE)):
                for suffix, title, style in sets:
                    try:
                        error = history(runs[law, EIM_ERRORS], f"curve/{side}_{kind}{suffix}")
                    except Missing:  # zero at all these steps, or without friction
                        continue
                    if np.any(error > 1e-9):
                        curves.append(along_size(error, f"{label}, {title}", colour, style, 1e-9))
            panels.append(Lines(f"{symbol}, friction: {name}", "terms", "largest relative error (-)", curves, log=True,
                                ylimits=(1e-7, 5)))
    save_panels(directory, "eim.png", panels)


def errors(runs, directory):
    """Errors of the reduced answers against N, three treatments of the curve and the projection
    (figures 4.6 and 4.13)."""
    panels = []
    for law, name in LAWS.items():
        stress = "lambda" if law == "none" else "tangential"
        for part, words in (("u", "displacement"), (stress, "normal stress" if law == "none" else "tangential stress")):
            rows, curves = error_map(runs[law, "full"]), []
            for rule in RULES:
                own, (colour, style) = error_map(runs[law, rule]), RULE_STYLES[rule]
                largest = np.where(column_of(own, "failed") == 0, column_of(own, part + "_max"), np.nan)
                curves.append(Curve(column_of(own, "N"), largest, rule, colour, style))
            curves.append(Curve(column_of(rows, "N"), column_of(rows, part + "_floor_max"), "projection", "black",
                                ".:"))
            panels.append(Lines(f"{words}, friction: {name}", "modes N", "largest relative error (-)", curves,
                                log=True))
    save_panels(directory, "errors.png", panels)


def column_of(rows, name):
    return np.array([row[name] for row in rows])


def mixed(runs, directory):
    """The mixed method on the same mesh: energy, errors of both unknowns (figures 4.7, 4.8)."""
    energies = []
    for key, label, colour, width in (("mixed", "energy, mixed", pale(ORANGE), 4),
                                      ("none", "energy, Nitsche", BLUE, 1)):
        rows = rows_of(runs[key, "default"] / "samples.csv")
        energies.append(Curve(column_of(rows, "radius"), column_of(rows, "energy"), label, colour, width=width))
    panels, nitsche = [], error_map(runs["none", "empirical"])
    for part, title in (("u_max", "displacement"), ("lambda_max", "normal stress")):
        curves = [Curve(column_of(nitsche, "N"), column_of(nitsche, part), "Nitsche", BLUE, "o-")]
        for r, colour in zip(GENERATORS, (PURPLE, GREEN, ORANGE)):
            rows = [summary(runs["pair", f"{r}, {n}"]) for n in SIZES]
            rows = [row for row in rows if row["failed"] == 0]
            if rows:
                curves.append(Curve(column_of(rows, "N") + column_of(rows, "S"), column_of(rows, part),
                                    f"mixed, R = {r}", colour, "s--"))
        least = summary(runs["mixed", "default"])[part]
        curves.append(level(least, curves, "mixed, condensed", "black", ":"))
        panels.append(Lines(title, "modes, with supremizers", "largest relative error (-)", curves, log=True,
                            floor=1e-15))
    save_panels(directory, "mixed.png", [*panels, Lines("energy", "R (m)", "J (N)", energies)])


def draw_all(study, runs, directory):
    use_units(next(iter(runs.values())))
    directory.mkdir(exist_ok=True)
    deformed(study, directory)
    normal_stress(study, directory)
    tangential_stress(study, directory)
    modes(runs, directory)
    interpolation(runs, directory)
    errors(runs, directory)
    mixed(runs, directory)
