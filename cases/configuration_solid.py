"""The configuration of a solid: its surface from two sides, in the colours of what it is in contact
with, what holds it and what loads it."""

import textwrap
from typing import NamedTuple

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.patches import Patch

from case_figures import FREE
from configuration_case import words_of_contact, words_of_imposed, words_of_load
from figure_tools import Grid, beside, plt, read_grid
from solid_figures import Skin, draw_painted, rows_of, skin_of, view_behind, view_of

CONTACT = ("#0072B2", "#56B4E9", "#009E73")
LOADS = ("#D55E00", "#E69F00", "#8B1A1A")
HELD = ("#777777", "#555555", "#999999")
FREE_FACES = "#e8e8e8"
WIDTH = 4.8  # inches


class Solid(NamedTuple):
    """A solid at the middle of the box, and rows of its skin by the names of its surfaces."""
    answer: Grid
    points: np.ndarray
    skin: Skin
    groups: dict


def read_solid(path):
    """What rbvi check -vtu wrote."""
    mesh, surface = (read_grid(beside(path, name)) for name in ("_mesh", "_surface"))
    skin = skin_of(mesh.cells)
    rows = rows_of(skin, surface.cells)
    groups = {name: rows[(values > 0) & (rows >= 0)] for name, values in surface.of_cells.items() if name != FREE}
    answer = read_grid(path)
    return Solid(answer, answer.points[:len(mesh.points)], skin, groups)


def conditions_of(case):
    """(name, surfaces, words, colour) of what is drawn, what covers others last."""
    found = []
    for kind, colours, words in (("imposed", HELD, words_of_imposed), ("loads", LOADS, words_of_load),
                                 ("contact", CONTACT, words_of_contact)):
        title = {"imposed": "imposed, ", "loads": "load, ", "contact": "contact "}[kind]
        for k, (name, what) in enumerate(case.get(kind, {}).items()):
            at = what.get("at", [])
            if at and "force" not in what:
                found.append((name, [at] if isinstance(at, str) else at, f"{title}{name}: {words(what)}",
                              colours[k % len(colours)]))
    return found


def not_drawn(case):
    """What a solid has and its picture does not show, in words."""
    words = [f"spring {name}" for name in case.get("springs", {})]
    words += [f"load {name}" for name, load in case.get("loads", {}).items() if "force" in load]
    return words + ["what planes of symmetry mirror"] * ("mirror" in case)


def painted(solid, case):
    """Colours of the skin, k x 3, and handles of a legend."""
    colours, handles = np.tile(to_rgb(FREE_FACES), (len(solid.skin.faces), 1)), []
    for _, at, words, colour in conditions_of(case):
        rows = [solid.groups[name] for name in at if name in solid.groups]
        if rows:
            colours[np.concatenate(rows)] = to_rgb(colour)
            handles.append(Patch(facecolor=colour, label=textwrap.fill(f"{words} ({', '.join(at)})", 60)))
    return colours, handles


def solid_figure(solid, case, title):
    figure, axes = plt.subplots(1, 2, figsize=(WIDTH, 0.42 * WIDTH))
    figure.subplots_adjust(left=0, right=1, bottom=0, top=0.84, wspace=0.02)
    colours, handles = painted(solid, case)
    view = view_of(np.array([0.0, 0, 1]))
    for axis, seen, words in zip(axes, (view, view_behind(view)), ("(a) from above", "(b) from the other side")):
        draw_painted(axis, solid.points, solid.skin, seen, colours)
        axis.set_title(words, loc="left")
    figure.legend(handles=handles, loc="upper left", bbox_to_anchor=(0, 0))
    figure.text(0.02, 1, title, va="bottom")
    return figure
