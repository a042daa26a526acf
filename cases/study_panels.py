"""Panels that the studies of the cases share."""

from functools import partial

import numpy as np

from figure_tools import BLUE, GREEN, GREY, ORANGE, in_length, read_grid
from panels import Curve, Drawn, Lines
from solution_figures import contact_grids, draw_deformed

BAR = 0.55  # of the width of a picture: height of its colour bar
UNSTABLE = 1e-12  # along the greedy algorithm, likewise
STABLE = 1e-9  # constants below are zero but for round-off
CONSTANTS = (("beta_hf", r"$\beta_{HF}$", GREY, "-"), ("beta_on", r"$\beta_{on}$", GREEN, "-"),
             ("beta_off", r"$\beta_{off}$", BLUE, "--"), ("beta_dec", r"$\beta_{dec}$", ORANGE, ":"))


def pale(colour):
    """Of lines that others lie on."""
    return colour + "66"


def published(x, y, label="published"):
    """The mark of a number that was published."""
    return Curve(np.array([x]), np.array([y]), label, "black", "x")


def level(value, like, label, colour, style):
    """A number along the axis of x of these curves."""
    x = np.concatenate([curve.x for curve in like])
    return Curve(np.array([x.min(), x.max()]), np.full(2, value), label, colour, style)


def along_size(error, label="", colour=BLUE, style="-", least=0):
    """Errors with 0, 1, ... functions, those above `least`."""
    error = error[error > least]
    return Curve(np.arange(len(error)), error, label, colour, style)


def above(least, curve):
    """The points of a curve that are not zero but for round-off."""
    seen = curve.y >= least
    curve.x, curve.y = curve.x[seen], curve.y[seen]
    return curve


def mark_of(x):
    """Few points are marked."""
    return "." if len(x) < 30 else ""


def share_decades(panels):
    """One range of y for all, in whole decades."""
    seen = np.concatenate([curve.y[np.isfinite(curve.y) & (curve.y >= panel.floor)]
                           for panel in panels for curve in panel.curves])
    if len(seen) > 0:
        limits = 10 ** np.floor(np.log10(seen.min())), 10 ** np.ceil(np.log10(seen.max()))
        for panel in panels:
            panel.ylimits = limits
    return panels


def constants_panel(title, xlabel, x, beta):
    """The four constants against x, in its order."""
    order = np.argsort(x)
    return Lines(title, xlabel, "inf-sup constant (-)",
                 [Curve(x[order], beta[column][order], label, colour, mark_of(x) + style)
                  for column, label, colour, style in CONSTANTS], log=True, floor=STABLE)


def greedy_panels(which, runs, log_sigma=True):
    """Largest sigma and smallest beta_off along the supremizers; a dot where a looser run ends. `runs`: label,
    colour, tables of the tight and the loose tolerance."""
    sigma, beta, zeros = [], [], ""
    for label, colour, tight, loose in runs:
        for curves, column, least in ((sigma, "sigma_max", 0), (beta, "beta_min", UNSTABLE)):
            seen = tight[column] >= least
            zeros = zeros if seen.all() else "; before: 0"
            curves.append(Curve(tight["S"][seen], tight[column][seen], label, colour))
            curves.append(Curve(loose["S"][-1:], loose[column][-1:], "", colour, "o"))
    return [Lines(rf"largest $\sigma$, {which}; dots: loose tolerance", "supremizers S", r"$\sigma$ (-)", sigma,
                  log=log_sigma, floor=STABLE),
            Lines(rf"smallest $\beta_{{off}}$, {which}{zeros}", "supremizers S", "inf-sup constant (-)", beta,
                  log=True, floor=UNSTABLE)]


def tolerance_panel(which, xlabel, runs):
    """beta_off at the validation parameters with the supremizers of a tight and of a loose tolerance. `runs`:
    colour, x and beta_off of both."""
    curves = [Curve(x[order], beta[order], "", colour, mark_of(x) + style) for colour, *both in runs
              for (x, beta), style in zip(both, ("-", "--")) for order in [np.argsort(x)]]
    return Lines(rf"$\beta_{{off}}$, {which}; dashed: loose tolerance", xlabel, "inf-sup constant (-)", curves)


def sorted_places(values):
    """The place of each number among all, from 1."""
    return np.argsort(np.argsort(values)) + 1.0


def draw_over_disk(path, centre, frame, figure, axis):
    """Deformed bodies as they are, above the rigid disk of radius 1 about `centre`."""
    grid = read_grid(path)
    draw_deformed([], contact_grids(path, grid), 1, grid, figure, axis)
    angle = np.linspace(0, np.pi, 200)
    axis.fill(centre[0] + np.cos(angle), centre[1] + np.sin(angle), color=GREY, alpha=0.4, linewidth=0)
    axis.set(xlim=frame[0], ylim=frame[1], xlabel=in_length("x"), ylabel=in_length("y"))


def room_of(frame):
    """Height over width of the picture of a frame with its colour bar below."""
    return float(np.ptp(frame[1]) / np.ptp(frame[0])) + BAR


def over_disk(title, path, centre, frame):
    return Drawn(title, partial(draw_over_disk, path, centre, frame), ratio=room_of(frame))


