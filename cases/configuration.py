#!/usr/bin/env python3
"""The configuration of a case, before anything is deformed: configuration.py RBVI CASE PNG [OPTIONS]

Runs `RBVI check CASE -vtu FILE OPTIONS` and draws what that writes, at the middle of the box: the
bodies in grey, boundaries in contact, what they face, and what holds and loads the bodies. Names and
expressions are those of the case file without variants and choices, which OPTIONS may have; a
boundary that the mesh does not have is left out. A solid is drawn from two sides, its surface in
colours; what is not drawn of it is told.
"""

import subprocess
import sys
import tempfile
import textwrap
from pathlib import Path

import numpy as np
try:
    import yaml
except ImportError:
    sys.exit("configuration.py: needs PyYAML (Debian: python3-yaml)")
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from PIL import Image

from configuration_case import (Bodies, Boundary, boundary_of, values_of, words_of_contact,
                                words_of_imposed, words_of_load)
from configuration_marks import (ARROW, HELD, SPRING, Labels, Mark, draw_held, draw_load, draw_mirrored,
                                 draw_regions, draw_rigid, draw_spring, draw_ticks, filled,
                                 mark_dimensions)
from configuration_solid import Solid, not_drawn, read_solid, solid_figure
from figure_tools import (BLUE, GREEN, ORANGE, PURPLE, in_length, is_solid, parameters_of, plt, read_grid,
                          use_declared)
from panels import inches_from
from solution_figures import outline

CONTACT = (BLUE, GREEN, PURPLE)
LOADS = (ORANGE, "#B8860B", "#8B1A1A")
CONTACT_AREA = "#9cc7e4"
BODY = 4.8  # inches: width of the picture of bodies
COLOURS = 256  # of a picture
THIN = 0.03  # of the size of the bodies: a thinner one is shown beside them, larger


def draw_contact(axis, contact, boundary, bodies, grid, colour, size):
    axis.plot(*boundary.lines(), color=colour, linewidth=2.8, zorder=5)
    against = contact.get("against", {})
    if isinstance(against, str):
        axis.plot(*bodies.boundary(against).lines(), color="black", linewidth=1.4,
                  linestyle=(0, (4, 3)), zorder=7)
    else:
        draw_rigid(axis, against, grid, size, bodies.size, colour)


def draw_body(axis, bodies, case, size):
    """Handles of a legend, and marks. `size`: of what is shown."""
    values = values_of(case, bodies.answer)
    if case.get("mirror_images") == 2 or case.get("mirror") == {"x": 0}:
        draw_mirrored(axis, bodies)
    handles, marks = draw_regions(axis, bodies), []

    def mark(text, boundary, colour, distance, label, inside=False, **style):
        marks.append(Mark(text, boundary, colour, distance, inside))
        handles.append(Line2D([], [], color=colour, label=label, **style))

    for (name, grids), colour in zip(bodies.contacts.items(), CONTACT):
        contact = case["contact"].get(name, {})
        boundary = bodies.boundary(contact.get("at", [])) or boundary_of(
            bodies.curves[name], grids["middle"])
        draw_contact(axis, contact, boundary, bodies, grids["middle"], colour, size)
        mark(name, boundary, colour, 0.02, f"contact {name}: {words_of_contact(contact)}", inside=True,
             linewidth=2.8)
    handles.append(Line2D([], [], color="black", linestyle="--", linewidth=1.4,
                          label="what it faces (a rigid one in its colour)"))
    for name, what in case.get("imposed", {}).items():
        boundary = bodies.boundary(what["at"])
        if boundary is not None:
            draw_held(axis, boundary, what, size)
            mark(name, boundary, HELD, 0.04, f"imposed, {name}: {words_of_imposed(what)}", linewidth=1.8)
    loads = [(name, load) for name, load in case.get("loads", {}).items() if "force" not in load]
    for (name, load), colour in zip(loads, LOADS):
        boundary = bodies.boundary(load["at"])
        if boundary is not None:
            draw_load(axis, boundary, load, values, size, colour)
            mark(name, boundary, colour, 0.08, f"load, {name}: {words_of_load(load)}", linewidth=1.8,
                 marker=">", markersize=5)
    for name, spring in case.get("springs", {}).items():
        draw_spring(axis, [bodies.boundary(end) for end in spring["between"]], size)
    if case.get("springs"):
        handles.append(Line2D([], [], color=SPRING, linewidth=0.9,
                              label="springs: " + ", ".join(case["springs"])))
    return handles, marks


def thin_part(bodies):
    """Corners of the body that is too thin to be seen; None where there is none."""
    body = bodies.answer.of_cells["body"]
    for k in np.unique(body):
        points = bodies.answer.points[np.unique(bodies.answer.cells[body == k]), :2]
        low, high = points.min(axis=0), points.max(axis=0)
        if (high - low).min() < THIN * bodies.size:
            return low, high
    return None


def frame(axis, margin, view=None):
    axis.set_aspect("equal")
    axis.grid(False)
    axis.autoscale_view()
    low, high = axis.viewLim.get_points() if view is None else view
    axis.set_xlim(low[0] - margin, high[0] + margin)
    axis.set_ylim(low[1] - margin, high[1] + margin)


def title_of(case, grid, width=66):
    values = parameters_of(grid).split(",  ")
    words = ", ".join(value.replace(" ", "\u00a0") for value in values)
    return textwrap.fill(f"{case['name']}: undeformed, at {words}", width)


def draw_view(axis, bodies, case, view=None):
    """The whole, or the part between two corners. Handles of a legend."""
    size = bodies.size if view is None else np.ptp(view, axis=0).max()
    handles, marks = draw_body(axis, bodies, case, size)
    frame(axis, (0.17 if view is None else 0.13) * size, view)
    axis.figure.canvas.draw()
    labels = Labels(axis, size)
    for mark in marks:
        labels.add(mark, bodies)
    round_axis = case["physics"] == "axisymmetric"
    axis.set_xlabel(in_length("x, from the axis" if round_axis else "x"))
    axis.set_ylabel(in_length("y"))
    mark_dimensions(axis, bodies, [mark.boundary for mark in marks])
    return handles


def body_figure(bodies, case):
    extent, thin = np.ptp(bodies.points, axis=0), thin_part(bodies)
    height = float(np.clip(BODY * extent[1] / extent[0], 2.2, 5))
    if thin is None:
        figure, axis = plt.subplots(figsize=(BODY, height))
        figure.subplots_adjust(top=0.98)
    else:
        figure, (axis, part) = plt.subplots(2, 1, figsize=(BODY, height + 2.2), height_ratios=(height, 1.6))
        draw_view(part, bodies, case, thin)
        part.set_title("(b) the thin part", loc="left")
    handles = draw_view(axis, bodies, case)
    add_legend(figure, figure.axes[-1], handles)
    figure.text(0.02, 1, title_of(case, bodies.answer), va="bottom")
    if thin is not None:
        axis.set_title("(a)", loc="left")
    return figure


def add_legend(figure, axis, handles):
    """Below the axis, one line for each."""
    for handle in handles:
        handle.set_label(textwrap.fill(handle.get_label(), 56))
    figure.legend(handles=handles, loc="upper left", bbox_to_anchor=(-0.5, -0.5),
                  bbox_transform=inches_from(axis), borderpad=0)


def membrane_figure(bodies, case):
    """From above, and a cut through the middle of the obstacle."""
    figure, (above, cut) = plt.subplots(1, 2, figsize=(BODY, 2.6), gridspec_kw={"wspace": 0.45})
    (name, grids), = bodies.contacts.items()
    grid = grids["middle"]
    handles = [Patch(facecolor=CONTACT_AREA, edgecolor=BLUE, label=f"contact {name}: above an obstacle"),
               Line2D([], [], color=BLUE, linestyle="--", label="what it faces"),
               Line2D([], [], color="#555555", linewidth=2.2, label="membrane, u = 0")]
    held, what = next(iter(case["imposed"].items()))
    handles.append(Line2D([], [], color=HELD, linewidth=1.8,
                          label=f"imposed, {held}: {words_of_imposed(what)}"))
    handles += [Line2D([], [], color=ORANGE, marker=">", markersize=5,
                       label=f"load, {load}: {words_of_load(force)} per area")
                for load, force in case["loads"].items()]
    draw_from_above(above, bodies, grid, name, bodies.boundary(what["at"]), held, what)
    draw_cut(cut, bodies, grid)
    add_legend(figure, above, handles)
    figure.text(0.02, 1, title_of(case, bodies.answer), va="bottom")
    return figure


def draw_from_above(axis, bodies, grid, name, boundary, held, what):
    filled(axis, bodies.points, bodies.mesh.cells, "#e6e6e6")
    filled(axis, grid.points[:, :2], grid.cells, CONTACT_AREA)
    rim = outline(grid.points, grid.cells)
    axis.add_collection(LineCollection(rim, colors=BLUE, linewidths=1.8, zorder=3))
    draw_held(axis, boundary, what, bodies.size)
    frame(axis, 0.1 * bodies.size)
    axis.figure.canvas.draw()
    axis.text(grid.points[:, 0].mean(), grid.points[:, 1].min() - 0.03 * bodies.size, name, color=BLUE, ha="center",
              va="top", zorder=9)
    axis.text(0, bodies.points[:, 1].max() + 0.05 * bodies.size, held, color=HELD,
              ha="center")
    axis.set(xlabel=in_length("x"), ylabel=in_length("y"))
    mark_dimensions(axis, bodies, [Boundary(rim, rim[:, 0])])
    axis.set_title("(a) from above", loc="left")


def draw_cut(axis, bodies, grid):
    size, height = bodies.size, grid.of_nodes["to_partner"][:, 2]
    near = np.abs(grid.points[:, 1] - grid.points[:, 1].mean()) < 0.01 * size
    order = np.argsort(grid.points[near, 0])
    axis.plot(grid.points[near, 0][order], height[near][order], color=BLUE, linestyle=(0, (5, 2)),
              linewidth=1.5)
    low, high = bodies.points[:, 0].min(), bodies.points[:, 0].max()
    axis.plot([low, high], [0, 0], color="#555555", linewidth=2.2)
    for end, side in ((low, -1), (high, 1)):
        draw_ticks(axis, np.column_stack([np.full(5, end), np.linspace(-0.06, 0.06, 5) * size]),
                   np.tile([side, 0.0], (5, 1)), size, HELD)
        axis.plot([end, end], [-0.07 * size, 0.07 * size], color=HELD, linewidth=1.8)
    for place in np.linspace(low, high, 13)[1:-1]:
        axis.annotate("", (place, 0.01 * size), (place, 0.11 * size), arrowprops=ARROW | {"color": ORANGE})
    frame(axis, 0.05 * size)
    axis.set(xlabel=in_length("x"), ylabel=in_length("u"))
    axis.set_xticks([low, 0, high])
    axis.set_title("(b) cut through its middle", loc="left")


def figure_of(bodies, case):
    if isinstance(bodies, Solid):
        return solid_figure(bodies, case, title_of(case, bodies.answer))
    return (body_figure if bodies.planar else membrane_figure)(bodies, case)


def read_bodies(path):
    return (read_solid if is_solid(read_grid(path)) else Bodies)(path)


def draw(path, case, png):
    use_declared(case.get("units"))
    bodies = read_bodies(path)
    figure = figure_of(bodies, case)
    figure.savefig(png, dpi=150, bbox_inches="tight", pad_inches=0.02)
    plt.close(figure)
    Image.open(png).convert("RGB").quantize(COLOURS).save(png, optimize=True)
    if isinstance(bodies, Solid) and not_drawn(case):
        print(f"not drawn: {', '.join(not_drawn(case))}")
    print(f"wrote {png}")


def main(arguments):
    if len(arguments) < 3 or arguments[0].startswith("-"):
        print("usage: configuration.py RBVI CASE PNG [OPTIONS]", file=sys.stderr)
        return 2
    rbvi, folder, png, *options = arguments
    file = Path(folder) if Path(folder).is_file() else Path(folder) / "case.yaml"
    case = {"name": file.resolve().parent.name, **yaml.safe_load(file.read_text(encoding="utf-8"))}
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "u.vtu"
        done = subprocess.run([rbvi, "check", folder, "-vtu", str(path), *options], check=False,
                              stdout=subprocess.DEVNULL)
        if done.returncode != 0:
            return done.returncode  # rbvi says why
        draw(path, case, png)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
