"""The picture of one answer: a membrane over its obstacle, or bodies in contact."""

from collections import Counter
from functools import partial

import numpy as np
from matplotlib.patches import Rectangle
from matplotlib.transforms import ScaledTranslation

from figure_tools import (GREEN, ORANGE, Missing, in_length, in_stress, parameters_of, read_grid,
                          wider)
from panels import Curve, Drawn, Lines, Triangles, save_panels

SHADES = "YlGnBu"
WIDTHS = 5  # of the edges of a mesh; those that round to zero are left out
GAP_ROUND_OFF = 1e-12  # m: a gap below is closed


def outline(points, cells):
    """Segments (k x 2 x 2) of the boundary of a triangulation: edges of one triangle only."""
    edges = np.sort(np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=1)
    single = [edge for edge, count in Counter(map(tuple, edges)).items() if count == 1]
    return points[np.array(single)][:, :, :2]


def contact_grids(path, grid):
    """The contact files beside u.vtu, of the interfaces of which some part can touch, by their names:
    u_contact, or u_contact_NAME of several."""
    if "contacts" not in grid.of_all:
        raise Missing(f"{path} does not name its contacts: write it again")
    of_name = {}
    for file in path.parent.glob(f"{path.stem}_contact*.vtu"):
        contact = read_grid(file)
        name = contact.of_all.get("contacts", [""])[0]
        if name in grid.of_all["contacts"]:
            of_name[name] = contact
        if name not in grid.of_all["contacts"] or parameters_of(contact) != parameters_of(grid):
            raise Missing(f"{file} is of another answer than {path}: remove it")
    return {name: of_name[name] for name in grid.of_all["contacts"] if name in of_name}


def draw_membrane(circle, grid, figure, axis):
    u = grid.of_nodes["u"]
    surface = axis.plot_trisurf(grid.points[:, 0], grid.points[:, 1], u, triangles=grid.cells,
                                cmap="viridis", linewidth=0, antialiased=False, rasterized=True)
    floor = u.min() - 0.25 * np.ptp(u)
    for segment in circle:
        axis.plot(segment[:, 0], segment[:, 1], floor, color=ORANGE, linewidth=1.2)
    axis.set_zlim(floor, max(0, u.max()))
    axis.set_box_aspect((1, 1, 0.7), zoom=1.0)
    axis.view_init(elev=24, azim=-58)
    axis.set_xlabel(in_length("x"))
    axis.set_ylabel(in_length("y"))
    axis.set_zlabel(in_length("u"), labelpad=0)
    axis.tick_params(labelsize=7, pad=0)
    figure.colorbar(surface, ax=axis, shrink=0.6, pad=0.1, label=in_length("u"))


def membrane_panels(grid, contacts):
    contact = next(iter(contacts.values()))
    circle = outline(contact.points, contact.cells)
    pressure = contact.of_nodes["pressure"]
    return [Drawn("membrane, below it the rim of the obstacle", partial(draw_membrane, circle, grid),
                  "3d"),
            Triangles("pressure on the obstacle", contact.points[:, :2], contact.cells, pressure,
                      in_stress("pressure"), (0, pressure.max() or 1))]


def draw_segments(axis, segments, width, alpha):
    """k x 2 x 2, as one line that is interrupted."""
    gaps = np.full((len(segments), 1, 2), np.nan)
    x, y = np.concatenate([segments, gaps], axis=1).reshape(-1, 2).T
    axis.plot(x, y, color="black", linewidth=width, alpha=alpha)


def draw_mesh(axis, positions, grid, size):
    """Edges as thin as they are short, those below a pixel left out; `size`: of the picture in the
    units of the positions. The outline is drawn whole."""
    segments = positions[grid.edges]
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    step = np.round(WIDTHS * np.minimum(1, length / (0.03 * size)))
    for k in range(1, WIDTHS + 1):
        draw_segments(axis, segments[step == k], 0.35 * k / WIDTHS, 0.6)
    draw_segments(axis, outline(positions, grid.cells), 0.7, 1)


def positions_of(grid):
    return (grid.points + grid.of_nodes["u"])[:, :2]


def draw_deformed(frames, grid, figure, axis):
    """Deformed bodies in 2D, shaded by |u|; the frames of other panels."""
    positions, u = positions_of(grid), np.linalg.norm(grid.of_nodes["u"], axis=1)
    Triangles("", positions, grid.cells, u, in_length("|u|"), (0, u.max() or 1), SHADES).draw(figure, axis)
    draw_mesh(axis, positions, grid, np.ptp(positions, axis=0).max())
    for low, high in frames:
        axis.add_patch(Rectangle(low, *(high - low), fill=False, edgecolor=ORANGE, linewidth=1))


def draw_bodies(figure, axis, path):
    draw_deformed([], read_grid(path), figure, axis)
    axis.set_title("deformed bodies", loc="left")


def contact_zone(curve):
    """Centre and half width of the part of the deformed contact curve that carries pressure; of the
    whole curve where none does. By Nitsche's method there is some stress everywhere."""
    positions = positions_of(curve)
    pressure = curve.of_nodes["pressure"]
    pressed = pressure > 0.05 * pressure.max()
    zone = positions[pressed] if pressed.sum() > 1 else positions
    low, high = zone.min(axis=0), zone.max(axis=0)
    return (low + high) / 2, (high - low).max() / 2


def frame_of(grid, curve):
    """Corners of the part of the bodies that is shown around the contact on a curve."""
    positions = positions_of(grid)
    centre, half = contact_zone(curve)
    margin = 0.02 * np.ptp(positions, axis=0).max()
    low = np.maximum(centre - (2 * half, 1.8 * half), positions.min(axis=0) - (margin, 3 * margin))
    high = np.minimum(centre + (2 * half, 1.8 * half), positions.max(axis=0) + (margin, 3 * margin))
    return low, high


def support_line(grid, curve, reach):
    """The rigid support of the one body, within `reach` of the middle of the contact: the deformed
    contact curve, moved along the normal by the gap that is left."""
    tangent = np.gradient(curve.points[:, :2], axis=0)
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    inwards = grid.points[:, :2].mean(axis=0) - curve.points[:, :2].mean(axis=0)
    normal *= -np.sign(normal.mean(axis=0) @ inwards)
    line = positions_of(curve) + curve.of_nodes["gap"][:, None] * normal
    return line[np.linalg.norm(line - contact_zone(curve)[0], axis=1) < reach]


def draw_zoom(frame, curve, grid, figure, axis):
    """Von Mises stress on the deformed bodies, in the frame; of one body its rigid support."""
    positions, stress = positions_of(grid), grid.of_cells["von_mises"]
    (low, high), (_, half) = frame, contact_zone(curve)
    middles = positions[grid.cells].mean(axis=1)
    inside = np.all((low < middles) & (middles < high), axis=1)
    top = stress[inside].max() if inside.any() else stress.max()
    Triangles("", positions, grid.cells, stress, in_stress("von Mises stress"), (0, top or 1),
              SHADES, flat=True).draw(figure, axis)
    draw_mesh(axis, positions, grid, 4 * half)
    if grid.of_cells["body"].max() == 1:
        line = support_line(grid, curve, 1.6 * half)
        handles = axis.plot(line[:, 0], line[:, 1], color=ORANGE, linewidth=1.6, label="rigid support")
        below = axis.transAxes + ScaledTranslation(0, -0.5, figure.dpi_scale_trans)  # inches
        axis.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0),
                    bbox_transform=below)
    axis.set_xlim(low[0], high[0])
    axis.set_ylim(low[1], high[1])


def along(grid, name):
    """A coordinate and a field along a contact curve: by steps where it is constant on the edges."""
    x = wider(grid.points)[0]
    if name in grid.of_cells:
        return np.repeat(x, 2)[1:-1], np.repeat(grid.of_cells[name], 2)
    return x, grid.of_nodes[name]


def contact_panel(curve, title):
    """Pressure, with friction the tangential stress, and the gap along a contact curve."""
    curves = [Curve(*along(curve, "pressure"), "pressure")]
    if "tangential_stress" in curve.of_nodes:
        curves.append(Curve(*along(curve, "tangential_stress"), "tangential stress", GREEN))
    x, gap = along(curve, "gap")
    closed = np.abs(gap) < GAP_ROUND_OFF
    curves.append(Curve(x, np.where(closed, 0, gap), "gap (right)", ORANGE, right=True))
    return Lines(title, in_length(wider(curve.points)[1] + ", undeformed"), in_stress("stress"), curves,
                 right=in_length("gap"))


def body_panels(grid, contacts):
    frames = [frame_of(grid, curve) for curve in contacts.values()]
    panels = [Drawn("deformed bodies" if grid.of_cells["body"].max() > 1 else "deformed body",
                    partial(draw_deformed, frames, grid))]
    several = len(contacts) > 1
    for frame, (name, curve) in zip(frames, contacts.items()):
        panels.append(Drawn(f"stress, {name}" if several else "stress at the contact",
                            partial(draw_zoom, frame, curve, grid)))
    return panels + [contact_panel(curve, f"stress and gap, {name}" if several else
                                   "stress and gap along the contact curve")
                     for name, curve in contacts.items()]


def solution_panels(path):
    grid = read_grid(path)
    contacts = contact_grids(path, grid)
    return (body_panels if grid.of_nodes["u"].ndim == 2 else membrane_panels)(grid, contacts)


def solution(path):
    """One answer, of the file u.vtu: the membrane and its pressure (Niakh 2022, figure 2.4), or
    bodies, their stress and the pressure between them (figure 2.10)."""
    run = path.parent.parent if path.parent.name == "verify" else path.parent
    return save_panels(run / "figures", "solution.png", solution_panels(path),
                       parameters_of(read_grid(path)))
