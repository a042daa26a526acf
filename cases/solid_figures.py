"""Bodies in space as they are drawn: their skin in a parallel projection, contact surfaces in plan."""

from typing import NamedTuple

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection

from figure_tools import amount

FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])  # of a tetrahedron, anticlockwise from outside
VIEWS = [(azimuth, elevation) for elevation in (35, -35) for azimuth in (-60, 30, 120, -150)]  # degrees
SHARP = np.cos(np.radians(40))  # edges where the skin turns by more are drawn
ALIGNED = 0.95  # a normal that is nearer to an axis is seen along it
ARM = 0.2  # of the size of a picture: the axes that are drawn beside it
ARROW = {"arrowstyle": "-|>,head_width=0.12,head_length=0.25", "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0,
         "color": "black"}
ZOOM = 1.35  # of the size of what is pressed: what is shown around it
DARK = 0.7  # light of a face that is seen from its side
CHUNK = 64  # points that are compared with all triangles at a time


class Skin(NamedTuple):
    """Outer faces of tetrahedra."""
    faces: np.ndarray  # k x 3 nodes, anticlockwise from outside
    cells: np.ndarray  # the cell of each

    def normals(self, points):
        """k x 3, of length 1."""
        x = points[self.faces]
        normals = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
        return normals / np.linalg.norm(normals, axis=1)[:, None]


def skin_of(cells):
    faces = cells[:, FACES].reshape(-1, 3)
    _, first, counts = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    single = np.sort(first[counts == 1])
    return Skin(faces[single], single // len(FACES))


class View(NamedTuple):
    """Directions of a picture, of length 1."""
    right: np.ndarray
    up: np.ndarray
    towards: np.ndarray  # the eye

    def flat(self, points):
        return points @ np.column_stack([self.right, self.up])


def view_from(azimuth, elevation):
    """With z up."""
    turn, rise = np.radians((azimuth, elevation))
    towards = np.array([np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise)])
    right = np.array([-np.sin(turn), np.cos(turn), 0])
    return View(right, np.cross(towards, right), towards)


def view_of(direction):
    """The view from the side that a direction points to."""
    views = [view_from(*view) for view in VIEWS]
    return max(views, key=lambda view: round(view.towards @ direction, 1))


def view_behind(view):
    """From the opposite side, with z up."""
    return View(-view.right, view.up, -view.towards)


def sharp_edges(points, skin, view):
    """Segments k x 2 x 3 where the skin ends for the eye, or is sharp."""
    sides = np.sort(skin.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    order = np.lexsort(sides.T[::-1])
    pairs = order[:len(order) // 2 * 2].reshape(-1, 2)  # of a closed skin each edge has two faces
    normals = skin.normals(points)
    one, other = (normals[pairs[:, k] // 3] for k in (0, 1))
    front = np.column_stack([one @ view.towards > 0, other @ view.towards > 0])
    sharp = front.any(axis=1) & (~front.all(axis=1) | (np.sum(one * other, axis=1) < SHARP))
    return points[sides[pairs[sharp, 0]]]


def seen(places, points, skin, view, size):
    """Whether no face lies before each of the places."""
    front = skin.faces[skin.normals(points) @ view.towards > 0]
    a, b, c = (view.flat(points[front[:, i]]) for i in range(3))
    depth = points[front] @ view.towards
    twice = cross(b - a, c - a)
    result = np.ones(len(places), bool)
    for start in range(0, len(places), CHUNK):
        some = places[start:start + CHUNK]
        x = view.flat(some)[:, None]
        weights = np.stack([cross(b - x, c - x), cross(c - x, a - x), cross(a - x, b - x)], axis=2) / twice[:, None]
        before = np.sum(weights * depth, axis=2) - (some @ view.towards)[:, None] > 2e-3 * size
        result[start:start + CHUNK] = ~np.any(before & np.all(weights > 1e-6, axis=2), axis=1)
    return result


def cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def draw_lines(axis, segments, points, skin, view, **style):
    """Those of k x 2 x 3 that no face hides."""
    size = np.ptp(points, axis=0).max()
    shown = segments[seen(segments.mean(axis=1), points, skin, view, size)] if len(segments) else segments
    axis.add_collection(LineCollection(view.flat(shown), capstyle="round", **style))


def draw_skin(axis, points, skin, view, **colours):
    """Faces from the farthest to the nearest with their edges, and sharp ones; `colours`: of
    PolyCollection, rows of the skin. Returns what is drawn."""
    front = np.flatnonzero(skin.normals(points) @ view.towards > 0)
    corners = points[skin.faces[front]]
    order = np.argsort(corners.mean(axis=1) @ view.towards)
    size, sides = np.ptp(points, axis=0).max(), np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    width = 0.3 * min(1, sides.mean() / (0.03 * size))
    rows = {name: value[front[order]] if name in ("array", "facecolors") else value for name, value in colours.items()}
    filled = axis.add_collection(PolyCollection(view.flat(corners[order]), edgecolors=(0, 0, 0, 0.55), linewidths=width,
                                                rasterized=True, **rows))
    draw_lines(axis, sharp_edges(points, skin, view), points, skin, view, colors="black", linewidths=0.8)
    sides = corners[:, :, None] + np.linspace(0, 1, 6)[:, None] * (np.roll(corners, 1, axis=1) - corners)[:, :, None]
    draw_axes(axis, view, view.flat(sides.reshape(-1, 3)), size)
    return filled


def draw_painted(axis, points, skin, view, colours):
    """A skin in the colours of its faces, k x 3, darker where it is turned away."""
    light = DARK + (1 - DARK) * np.clip(skin.normals(points) @ view.towards, 0, 1)
    draw_skin(axis, points, skin, view, facecolors=colours * light[:, None])


def rows_of(skin, faces):
    """Of the skin for faces k x 3, -1 for those that are inside of a body."""
    row_of = {face: k for k, face in enumerate(map(tuple, np.sort(skin.faces, axis=1)))}
    return np.array([row_of.get(face, -1) for face in map(tuple, np.sort(faces, axis=1))], int)


def round_length(length):
    """1, 2 or 5 times a power of ten, not longer."""
    power = 10.0 ** np.floor(np.log10(length))
    return power * max(lead for lead in (1, 2, 5) if lead * power <= 1.001 * length)


def place_of_axes(drawn, room):
    """The lower left corner of the axes: in a corner of the picture that is free, else beside it."""
    low, high = drawn.min(axis=0), drawn.max(axis=0)
    for left in (low[0], high[0] - room[0]):
        corner = np.array([left, low[1]])
        if not np.any(np.all((corner <= drawn) & (drawn <= corner + room), axis=1)):
            return corner
    return low - (room[0], 0)


def draw_axes(axis, view, drawn, size):
    """The directions of the coordinates, as long as is said, and the limits of the picture."""
    arm = round_length(ARM * size)
    ways = view.flat(arm * np.eye(3))
    least, most = (end(1.4 * ways, axis=0) for end in (np.min, np.max))
    wide = np.ptp(drawn, axis=0).max()
    margin, line = 0.04 * wide, 0.16 * wide
    room = most - least + (2 * margin, margin + line)
    corner = place_of_axes(drawn, room)
    start = corner - least + (margin, line)
    for name, way in zip("xyz", ways):
        axis.annotate("", start + way, start, arrowprops=ARROW)
        axis.text(*(start + 1.35 * way), name, ha="center", va="center")
    axis.text(corner[0] + room[0] / 2, corner[1], amount(arm, "length"), ha="center", va="bottom")
    low, high = np.minimum(drawn.min(axis=0), corner), np.maximum(drawn.max(axis=0), corner + room)
    axis.set(xlim=(low[0] - margin / 2, high[0] + margin / 2), ylim=(low[1] - margin / 2, high[1] + margin / 2),
             xticks=[], yticks=[], aspect="equal", anchor="N")
    axis.grid(False)
    axis.spines[:].set_visible(False)


class Plan(NamedTuple):
    """Two directions across a third, and the names of coordinates along them."""
    across: np.ndarray  # 2 x 3
    names: tuple
    along: str          # where one looks

    def flat(self, points):
        return points @ self.across[:, :points.shape[1]].T


FROM_ABOVE = Plan(np.eye(3)[:2], ("x", "y"), "z")


def words_of(direction):
    return "(" + ", ".join(f"{part + 0.0:.2g}" for part in np.round(direction, 2)) + ")"


def plan_of(points, cells, weights=None):
    """The plan of triangles across the mean of their normals, of triangles with weights by these; of
    normals near an axis across that one."""
    x = points[cells]
    areas = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    if weights is not None and np.any(weights > 0):
        areas = areas * weights[:, None]
    normal = np.linalg.eigh(areas.T @ areas)[1][:, -1]
    axis = np.argmax(np.abs(normal))
    if np.abs(normal[axis]) > ALIGNED:
        others = [k for k in range(3) if k != axis]
        return Plan(np.eye(3)[others], tuple("xyz"[k] for k in others), "xyz"[axis])
    first = np.eye(3)[np.argmin(np.abs(normal))]
    first = first - (first @ normal) * normal
    across = np.array([first / np.linalg.norm(first), np.cross(normal, first / np.linalg.norm(first))])
    across *= np.sign(across[np.arange(2), np.argmax(np.abs(across), axis=1)])[:, None]
    return Plan(across, tuple("along " + words_of(way) for way in across), words_of(normal))


def edge_of(points, cells, inside):
    """Segments k x 2 x d around the nodes that are inside: halfway to those that are not, and sides of
    a surface that end there."""
    some = inside[cells]
    cut = some.any(axis=1) & ~some.all(axis=1)
    odd = np.argmax(some[cut] != (some[cut].sum(axis=1) > 1)[:, None], axis=1)  # alone on its side
    x, k = points[cells[cut]], np.arange(cut.sum())
    halves = np.stack([(x[k, odd] + x[k, (odd + step) % 3]) / 2 for step in (1, 2)], axis=1)
    sides = np.sort(cells[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    sides, counts = np.unique(sides, axis=0, return_counts=True)
    x, held = points[sides[counts == 1]], inside[sides[counts == 1]]
    middles = x.mean(axis=1, keepdims=True)
    x = np.where(held[:, :, None], x, middles)
    return np.concatenate([halves, x[held.any(axis=1)]])


def zone_of(x, pressed):
    """Corners of what is shown of places in a plan: around those that are pressed."""
    low, high = x.min(axis=0), x.max(axis=0)
    if pressed.any():
        ends = x[pressed].min(axis=0), x[pressed].max(axis=0)
        middle, half = (ends[0] + ends[1]) / 2, ZOOM * np.max(ends[1] - ends[0]) / 2
        low, high = np.maximum(low, middle - half), np.minimum(high, middle + half)
    margin = 0.02 * (high - low).max()
    return low - margin, high + margin
