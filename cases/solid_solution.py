"""The picture of an answer in space: the deformed body, what presses and rubs on its contact surfaces."""

from functools import partial

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D

from figure_tools import GREEN, ORANGE, PURPLE, SHADES, amount, in_stress, von_mises
from panels import Drawn, Triangles, colour_bar, legend_below
from solid_figures import draw_lines, draw_skin, edge_of, plan_of, skin_of, view_of, zone_of

ARROWS = 12   # along each side of a plan, at most
LONGEST = 0.13  # of the size of a plan
BOUND = 1e-4  # of the largest: tangential stresses nearer to it are at the bound of friction
STILL = 1e-12  # of the size of a surface: what slips less is held
EDGE = {"colors": ORANGE, "linewidths": 1.6}
RIM = {"colors": "black", "linewidths": 0.9, "linestyles": (0, (4, 2))}
LINES = (Line2D([], [], color=ORANGE, linewidth=1.6, label="edge of contact"),
         Line2D([], [], color="black", linewidth=0.9, linestyle=(0, (4, 2)), label="edge of the contact surface"))


def edges_of(surface, points):
    """Segments around the contact and around the surface: at `points` of its nodes."""
    pressed = surface.of_nodes["pressure"] > 0
    return (edge_of(points, surface.corners, pressed),
            edge_of(points, surface.corners, np.ones(len(points), bool)))


def is_slipping(pressure, sizes, slips):
    """Nodes where the tangential stress is at its bound, a share of the pressure or a constant: several
    reach it, and move."""
    for bound in (pressure, np.ones(len(sizes))):
        share = np.divide(sizes, bound, out=np.zeros(len(sizes)), where=pressure > 0)
        at_bound = slips & (share > (1 - BOUND) * share.max(initial=0))
        if at_bound.sum() > 1:
            return at_bound
    return np.zeros(len(sizes), bool)


def thinned(nodes, x, step):
    """One node of each square of a raster, the nearest to its middle."""
    squares = np.floor(x[nodes] / step)
    away = np.linalg.norm(x[nodes] / step - squares - 0.5, axis=1)
    order = np.argsort(away)
    return nodes[order[np.unique(squares[order], axis=0, return_index=True)[1]]]


def tangential_of(surface):
    """Vertices in contact that slip, those that stick, and the tangential stress at nodes."""
    tractions = surface.of_nodes.get("tangential_stress", np.zeros((len(surface.points), 3)))
    sizes, pressure = np.linalg.norm(tractions, axis=1), surface.of_nodes["pressure"]
    vertices = np.unique(surface.corners)
    vertices = vertices[(sizes[vertices] > 0) & (pressure[vertices] > 0)]
    moves = np.linalg.norm(surface.of_nodes["slip"], axis=1)[vertices] > STILL * np.ptp(surface.points)
    slipping = is_slipping(pressure[vertices], sizes[vertices], moves)
    return vertices[slipping], vertices[~slipping], tractions


def draw_tractions(surface, plan, size, axis):
    """Arrows at nodes in contact; handles of a legend."""
    slipping, sticking, tractions = tangential_of(surface)
    x, ways = plan.flat(surface.points), plan.flat(tractions)
    longest = np.linalg.norm(tractions, axis=1).max()
    said, handles = f"tangential stress, the longest {amount(longest, 'stress')}", []
    for some, what, colour, marker in ((slipping, "slips", PURPLE, ">"), (sticking, "sticks", GREEN, "o")):
        nodes = thinned(some, x, size / ARROWS)
        if len(nodes) == 0:
            continue
        axis.quiver(*x[nodes].T, *ways[nodes].T, angles="xy", scale_units="xy", units="inches", width=0.022, zorder=4,
                    scale=longest / (LONGEST * size), color=colour, edgecolor="white", linewidth=0.5)
        if marker == "o":
            axis.plot(*x[nodes].T, marker, color=colour, markersize=3.5, markeredgecolor="white", zorder=5)
        handles.append(Line2D([], [], color=colour, marker=marker, label=f"{what}: {said}"))
        said = "likewise"
    return handles


def draw_over(surface, plan, size, axis):
    for segments, style in zip(edges_of(surface, plan.flat(surface.points)), (EDGE, RIM)):
        axis.add_collection(LineCollection(segments, zorder=3, **style))
    return [*draw_tractions(surface, plan, size, axis), *LINES]


def contact_panel(surface, name):
    """Pressure on a contact surface in plan, its edge, and where it slips and sticks."""
    pressure = surface.of_nodes["pressure"]
    plan = plan_of(surface.points, surface.corners, pressure[surface.corners].mean(axis=1))
    x = plan.flat(surface.points)
    zone = zone_of(x, pressure > 0)
    size = np.max(zone[1] - zone[0])
    peak = f"peak {amount(pressure.max(), 'stress')}" if pressure.max() > 0 else "open"
    return Triangles(", ".join(filter(None, (name or "contact", f"seen along {plan.along}", peak))), x,
                     surface.corners, pressure, in_stress("pressure"), (0, pressure.max() or 1), frame=zone,
                     axes=plan.names, over=partial(draw_over, surface, plan, size))


def facing_of(contacts):
    """Where contact surfaces face that are pressed; all of them where none is."""
    for power in (1, 0):
        direction = sum(surface.of_nodes["pressure"] ** power @ surface.of_nodes["normal"]
                        for surface in contacts.values())
        if np.linalg.norm(direction) > 0:
            return direction / np.linalg.norm(direction)
    return np.array([0.0, 0, 1])


def draw_body(grid, contacts, scale, view, figure, axis):
    """The deformed body in the colours of its stress, with the edges of contact."""
    points, skin = grid.points + scale * grid.of_nodes["u"], skin_of(grid.cells)
    inside = np.zeros(len(grid.cells), bool)
    inside[skin.cells[skin.normals(points) @ view.towards > 0]] = True
    label, limits = von_mises(grid, inside)
    filled = draw_skin(axis, points, skin, view, array=grid.of_cells["von_mises"][skin.cells], cmap=SHADES, clim=limits)
    for surface in contacts.values():
        moved = surface.points + scale * surface.of_nodes["u"]
        for segments, style in zip(edges_of(surface, moved), (EDGE, RIM)):
            draw_lines(axis, segments, points, skin, view, **style)
    colour_bar(figure, axis, filled, label, 0.5, 0.12)
    legend_below(axis, list(LINES))


def solid_panels(grid, contacts, scale, title):
    view = view_of(facing_of(contacts))
    plans = [contact_panel(surface, name if len(contacts) > 1 else "") for name, surface in contacts.items()]
    beside = max([0.5, *(plan.ratio for plan in plans[:1])])  # a plan, with its bar of colours
    ratio = 1.3 * beside + (0.5 if len(plans) > 1 else 0.3)
    return [Drawn(title, partial(draw_body, grid, contacts, scale, view), ratio=ratio), *plans]
