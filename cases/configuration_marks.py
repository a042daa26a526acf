"""How the configuration of a case is drawn: supports, loads, rigid surfaces, names and dimensions."""

from typing import NamedTuple

import numpy as np
from matplotlib.collections import LineCollection, PatchCollection, PolyCollection
from matplotlib.patches import Circle, Patch
from matplotlib.patheffects import withStroke

from configuration_case import Boundary, key_of, load_at
from solution_figures import outline

HELD = "black"
SPRING = "#8B1A1A"
MIRRORED = "#f4f4f4"
ARROW = {"arrowstyle": "-|>,head_width=0.16,head_length=0.3", "linewidth": 0.9, "shrinkA": 0, "shrinkB": 0}
REACH = 0.35  # of the size of the bodies: how far a rigid surface is drawn beyond what faces it


class Labels:
    """Names beside boundaries, moved on until they cover no other name."""

    def __init__(self, axis, size):
        self.axis, self.size = axis, size
        self.boxes = [arrow.get_window_extent() for arrow in axis.texts]

    def add(self, mark, bodies):
        place, normal = mark.boundary.middle()
        if not self.axis.viewLim.contains(*place):
            return
        label = self.axis.text(*place, mark.text, color=mark.colour, ha="center",
                               va="center", zorder=9,
                               path_effects=[withStroke(linewidth=2, foreground="white")])
        renderer = self.axis.figure.canvas.get_renderer()
        box, back = label.get_window_extent(renderer), self.axis.transData.inverted()
        half = (back.transform((box.x1, box.y1)) - back.transform((box.x0, box.y0))) / 2

        def at(direction, k):
            way = mark.distance * self.size + 0.02 * k * self.size
            return place + direction * (way + abs(direction) @ half)

        direction = normal
        if mark.inside and (bodies.holds(at(-normal, 0)) or not bodies.holds(at(normal, 0))):
            direction = -normal
        for k in range(40):
            label.set_position(at(direction, k))
            box = label.get_window_extent(renderer).expanded(1.05, 1.15)
            if not any(box.overlaps(other) for other in self.boxes):
                break
        self.boxes.append(box)
        if k > 0:
            self.axis.annotate("", place + 0.6 * mark.distance * self.size * direction, at(direction, k),
                               arrowprops={"arrowstyle": "-", "color": mark.colour, "linewidth": 0.6,
                                           "shrinkA": 5})


def draw_ticks(axis, points, normals, size, colour):
    """Short strokes that lean: a support."""
    tangents = np.column_stack([-normals[:, 1], normals[:, 0]])
    ends = points + 0.018 * size * (normals + 0.8 * tangents)
    axis.add_collection(LineCollection(np.stack([points, ends], axis=1), colors=colour, linewidths=0.8))


def draw_held(axis, boundary, what, size):
    """Hatched where all components are imposed, on rollers where one is."""
    axis.plot(*boundary.lines(), color=HELD, linewidth=1.8, zorder=4)
    if "u" in what or {"ux", "uy"} <= set(what):
        draw_ticks(axis, *boundary.places(0.022 * size), size, HELD)
        return
    points, normals = boundary.places(0.045 * size)
    radius = 0.009 * size
    axis.add_collection(PatchCollection([Circle(point, radius) for point in
                                         points + 1.6 * radius * normals],
                                        facecolor="white", edgecolor=HELD, linewidth=0.8, zorder=4))


def draw_load(axis, boundary, load, values, size, colour):
    axis.plot(*boundary.lines(), color=colour, linewidth=1.8, zorder=4)
    points, normals = boundary.places(0.05 * size)
    forces = load_at(load, values, points, normals)
    if forces is None or not np.any(forces):
        return
    ways = 0.06 * size * forces / np.linalg.norm(forces, axis=1).max()
    pushes = np.sum(ways * normals, axis=1) < 0
    tips = np.where(pushes[:, None], points, points + ways)
    for tip, way in zip(tips, ways):
        axis.annotate("", tip, tip - way, zorder=5, arrowprops=ARROW | {"color": colour},
                      annotation_clip=True)


def circle_through(points):
    """Centre and radius by least squares."""
    system = np.column_stack([2 * points, np.ones(len(points))])
    x = np.linalg.lstsq(system, (points ** 2).sum(axis=1), rcond=None)[0]
    return x[:2], np.sqrt(x[2] + x[:2] @ x[:2])


def rigid_surface(against, points, size):
    """What is drawn of it: points along it, beyond those that are faced."""
    if "disk" in against:
        centre, radius = circle_through(points)
        angles = np.unwrap(np.arctan2(*(points - centre).T[::-1]))
        more = REACH * size / radius
        angles = np.linspace(angles.min() - more, angles.max() + more, 400)
        return centre + radius * np.column_stack([np.cos(angles), np.sin(angles)])
    if "plane" in against:
        way = points[-1] - points[0]
        way /= np.linalg.norm(way)
        middle, half = points.mean(axis=0), np.ptp(points @ way) / 2
        return middle + np.linspace(-half - 0.4 * REACH * size, half + 0.4 * REACH * size, 200)[:, None] * way
    return points


def draw_rigid(axis, against, grid, size, whole, colour):
    x = grid.points[:, :2]
    line = rigid_surface(against, x + grid.of_nodes["to_partner"][:, :2], whole)
    axis.plot(*line.T, color=colour, linestyle=(0, (5, 2)), linewidth=1.5)
    tangents = np.gradient(line, axis=0)
    normals = np.column_stack([tangents[:, 1], -tangents[:, 0]])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    normals *= np.sign(np.sum(normals @ grid.of_nodes["normal"][:, :2].mean(axis=0)))
    steps = Boundary(np.stack([line[:-1], line[1:]], axis=1), normals[:-1])
    draw_ticks(axis, *steps.places(0.03 * size), size, colour)


def draw_spring(axis, ends, size):
    first, last = (end.segments.reshape(-1, 2).mean(axis=0) for end in ends)
    way = last - first
    across = 0.012 * size * np.array([-way[1], way[0]]) / np.linalg.norm(way)
    part = np.linspace(0, 1, 31)
    swing = np.where(np.arange(31) % 2, 1, -1) * ((part > 0.1) & (part < 0.9))
    line = first + part[:, None] * way + swing[:, None] * across
    axis.plot(*line.T, color=SPRING, linewidth=0.9, zorder=6)


def filled(axis, points, cells, colour):
    axis.add_collection(PolyCollection(points[cells], facecolors=colour, edgecolors=colour,
                                       linewidths=0.8, rasterized=True, zorder=1))


def draw_regions(axis, bodies):
    """Handles of a legend. What no region has is lightest."""
    cells, points = bodies.mesh.cells, bodies.points
    shade = np.full(len(cells), "#e6e6e6", dtype="<U7")
    handles = []
    for colour, (name, inside) in zip(("#d9d9d9", "#bdbdbd", "#a6a6a6", "#cccccc"),
                                      bodies.mesh.of_cells.items()):
        shade[inside > 0] = colour
        handles.append(Patch(facecolor=colour, edgecolor="none", label=name))
    for colour in np.unique(shade):
        filled(axis, points, cells[shade == colour], colour)
        axis.add_collection(LineCollection(outline(points, cells[shade == colour]), colors="#555555",
                                           linewidths=0.8, zorder=2))
    return handles


def corners(segments):
    """Ends of facets where the outline turns by more than 30 degrees."""
    at = {}
    for first, last in segments:
        for here, other in ((first, last), (last, first)):
            at.setdefault(key_of(here), []).append((other - here) / np.linalg.norm(other - here))
    return np.array([point for point, ways in at.items()
                     if len(ways) == 2 and ways[0] @ ways[1] > -np.cos(np.radians(30))]).reshape(-1, 2)


def mark_dimensions(axis, bodies, boundaries):
    """Ticks at the ends of bodies, then at their corners and at the ends of boundaries, where there
    is room."""
    size, places = bodies.size, corners(outline(bodies.points, bodies.mesh.cells))
    ends = np.array([end for boundary in boundaries for end in
                     (boundary.segments.min(axis=(0, 1)), boundary.segments.max(axis=(0, 1)))])
    scale = (axis.transData.transform((1, 1)) - axis.transData.transform((0, 0))) / axis.figure.dpi
    for k, which in enumerate((axis.xaxis, axis.yaxis)):
        low, high = axis.viewLim.get_points()[:, k]
        wanted = [bodies.points[:, k].min(), bodies.points[:, k].max(), *sorted(places[:, k]), 0,
                  *sorted(ends[:, k])]
        kept = {}
        for value in wanted:
            value = 0 if abs(value) < 1e-3 * size else value
            text = f"{round(value, 3):.4g}"
            room = [0.1 + 0.04 * (len(text) + len(other)) if k == 0 else 0.17 for other in kept.values()]
            if low <= value <= high and all(scale[k] * abs(value - other) > least
                                            for other, least in zip(kept, room)):
                kept[value] = text
        which.set_ticks(list(kept), list(kept.values()))


class Mark(NamedTuple):
    """A boundary and its name."""
    text: str
    boundary: Boundary
    colour: str
    distance: float       # of the name, in sizes of the picture
    inside: bool = False  # the name, where there is room


def draw_mirrored(axis, bodies):
    points, cells = bodies.points * (-1, 1), bodies.mesh.cells
    filled(axis, points, cells, MIRRORED)
    axis.add_collection(LineCollection(outline(points, cells), colors="#bbbbbb", linewidths=0.8,
                                       linestyles=":"))
