"""The picture of one answer: a membrane over its obstacle, or bodies in contact."""

from collections import Counter
from functools import partial

import numpy as np
from matplotlib.patches import Rectangle

from figure_tools import (GREEN, ORANGE, PURPLE, SHADES, Missing, amount, in_length, in_stress, is_solid,
                          parameters_of, read_grid, run_of, von_mises, wider)
from panels import (Curve, Drawn, Lines, Triangles, in_columns, in_rows, legend_below, ratio_of,
                    save_panels)
from solid_figures import round_length
from solid_solution import solid_panels

WIDTHS = 5  # of the edges of a mesh; those that round to zero are left out
CLOSED = 1e-9  # of the largest displacement: a smaller gap is closed
VISIBLE = 0.05  # of the size of the bodies: displacements are drawn no smaller
LEAST_ZONE = 0.12  # of the length of a contact curve: half of a zoom is no less


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
    axis.plot_trisurf(grid.points[:, 0], grid.points[:, 1], u, triangles=grid.cells, cmap="viridis", linewidth=0,
                      antialiased=False, rasterized=True)
    floor = u.min() - 0.25 * np.ptp(u)
    for segment in circle:
        axis.plot(segment[:, 0], segment[:, 1], floor, color=ORANGE, linewidth=1.2)
    axis.set_zlim(floor, max(0, u.max()))
    axis.set_box_aspect((1, 1, 0.7), zoom=1.05)
    axis.view_init(elev=24, azim=-58)
    axis.set_xlabel(in_length("x"))
    axis.set_ylabel(in_length("y"))
    axis.set_zlabel(in_length("u"), labelpad=-1)
    axis.tick_params(pad=0)
    axis.locator_params(nbins=3)


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


def turns_over(grid, scale):
    """Whether a triangle of the mesh is turned over where displacements are drawn at this scale."""
    def areas(x):
        sides = x[grid.cells[:, 1:]] - x[grid.cells[:, :1]]
        return sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    return np.any(areas(grid.points) * areas(positions_of(grid, scale)) <= 0)


def scale_of(grid, contacts):
    """What displacements are multiplied by where they are drawn: 1 where they can be seen, else 1, 2 or 5
    times a power of ten, so that bodies with a gap at rest do not overlap and no triangle is turned over."""
    size, largest = np.ptp(grid.points, axis=0).max(), np.linalg.norm(grid.of_nodes["u"], axis=1).max()
    gaps = [] if is_solid(grid) else [gap_at_rest(grid, curve) for curve in contacts.values()]
    wanted = min([VISIBLE * size / (largest or size), *(1 + 0.01 * size / max(gap, 1e-9 * size) for gap in gaps)])
    scale = 1 if wanted < 2 else int(round_length(wanted))
    while scale > 1 and not is_solid(grid) and turns_over(grid, scale):
        scale = int(round_length(0.9 * scale))
    return scale


def positions_of(grid, scale):
    return (grid.points + scale * grid.of_nodes["u"])[:, :2]


def faced(curve, scale):
    """The points that face those of a contact curve: what is closed is drawn closed."""
    return positions_of(curve, scale) + scale * curve.of_nodes["to_partner"][:, :2]


def partners_of(grid, curve):
    """Nodes of other bodies that face those of a contact curve; none where a rigid surface does."""
    body = np.zeros(len(grid.points), int)
    body[grid.cells] = grid.of_cells["body"].astype(int)[:, None]
    own = body[np.argmin(np.sum((grid.points - curve.points[0]) ** 2, axis=1))]
    others = np.flatnonzero(body != own)
    if len(others) == 0:
        return others
    away = np.linalg.norm(faced(curve, 1)[:, None] - positions_of(grid, 1)[others], axis=2)
    near = others[np.argmin(away, axis=1)]
    spacing = np.linalg.norm(np.ptp(curve.points, axis=0)) / len(curve.points)
    return near if np.median(away.min(axis=1)) < 4 * spacing else others[:0]


def gap_at_rest(grid, curve):
    """Largest along the normal between bodies where they now press on each other; of a rigid surface
    how much it varies, which would bend what is drawn of it."""
    partners, pressure = partners_of(grid, curve), curve.of_nodes["pressure"]
    if len(partners) == 0:
        return np.ptp(np.sum((curve.of_nodes["u"] + curve.of_nodes["to_partner"]) * curve.of_nodes["normal"], axis=1))
    gap = np.sum((grid.points[partners] - curve.points) * curve.of_nodes["normal"], axis=1)
    return np.abs(gap[pressure >= 0.05 * pressure.max()]).max()


def draw_rigid(grid, contacts, scale, axis):
    """Rigid surfaces where they are at these parameters: handles of a legend."""
    lines = [axis.plot(*faced(curve, scale).T, color=ORANGE, linewidth=1.8, label="rigid surface")[0]
             for curve in contacts.values() if len(partners_of(grid, curve)) == 0]
    return lines[:1]


def draw_deformed(frames, contacts, scale, grid, figure, axis):
    """Deformed bodies in 2D, shaded by |u|, by the stress where no other panel has it; the frames of
    other panels."""
    positions = positions_of(grid, scale)
    if frames:
        u = np.linalg.norm(grid.of_nodes["u"], axis=1)
        filled = Triangles("", positions, grid.cells, u, in_length("|u|"), (0, u.max() or 1), SHADES)
    else:
        filled = Triangles("", positions, grid.cells, grid.of_cells["von_mises"],
                           *von_mises(grid, np.ones(len(grid.cells), bool)), SHADES, flat=True)
    filled.draw(figure, axis)
    draw_mesh(axis, positions, grid, np.ptp(positions, axis=0).max())
    for low, high in frames:
        axis.add_patch(Rectangle(low, *(high - low), fill=False, edgecolor=PURPLE, linewidth=1.2, zorder=5))
    handles = draw_rigid(grid, contacts, scale, axis)
    if handles:
        legend_below(axis, handles)


def draw_bodies(figure, axis, path):
    grid = read_grid(path)
    contacts = contact_grids(path, grid)
    scale = scale_of(grid, contacts)
    draw_deformed([], contacts, scale, grid, figure, axis)
    axis.set_title(title_of(grid, scale), loc="left")


def title_of(grid, scale):
    words = "deformed bodies" if grid.of_cells["body"].max() > 1 else "deformed body"
    return f"{words}, displacements x {scale:g}"


def contact_zone(curve, scale):
    """Centre and half width of the part of the deformed contact curve that carries pressure; of the
    whole curve where none does. By Nitsche's method there is some stress everywhere."""
    positions, pressure = positions_of(curve, scale), curve.of_nodes["pressure"]
    pressed = pressure > 0.05 * pressure.max()
    zone = positions[pressed] if pressed.any() else positions
    low, high = zone.min(axis=0), zone.max(axis=0)
    return (low + high) / 2, max((high - low).max() / 2, LEAST_ZONE * np.ptp(positions, axis=0).max())


def frame_of(grid, curve, scale):
    """Corners of what is shown around the contact on a curve: of the bodies and what they face."""
    positions = np.concatenate([positions_of(grid, scale), faced(curve, scale)])
    centre, half = contact_zone(curve, scale)
    low, high = centre - (1.6 * half, 1.3 * half), centre + (1.6 * half, 1.3 * half)
    inside = positions[np.all((low <= positions) & (positions <= high), axis=1)]
    return np.maximum(low, inside.min(axis=0) - 0.15 * half), np.minimum(high, inside.max(axis=0) + 0.15 * half)


def is_part(frame, grid, scale):
    """A zoom shows less than half of the bodies."""
    return np.prod(frame[1] - frame[0]) < 0.5 * np.prod(np.ptp(positions_of(grid, scale), axis=0))


def draw_zoom(frame, curve, scale, grid, figure, axis):
    """Von Mises stress on the deformed bodies, in the frame, and the rigid surface there."""
    positions, (low, high) = positions_of(grid, scale), frame
    middles = positions[grid.cells].mean(axis=1)
    inside = np.all((low < middles) & (middles < high), axis=1)
    label, limits = von_mises(grid, inside)
    shown = np.any(np.all((low < positions[grid.cells]) & (positions[grid.cells] < high), axis=2), axis=1) | inside
    Triangles("", positions, grid.cells[shown], grid.of_cells["von_mises"][shown], label, limits, SHADES, flat=True,
              frame=frame).draw(figure, axis)
    draw_mesh(axis, positions, grid, 2 * (high - low).max())
    draw_rigid(grid, {"": curve}, scale, axis)


def along(grid, name):
    """A coordinate and a field along a contact curve: by steps where it is constant on the edges."""
    x = wider(grid.points)[0]
    if name in grid.of_cells:
        return np.repeat(x, 2)[1:-1], np.repeat(grid.of_cells[name], 2)
    return x, grid.of_nodes[name]


def contact_panel(curve, title, displacement):
    """Pressure, with friction the tangential stress, and the gap along a contact curve."""
    where = "on edges" if "pressure" in curve.of_cells else "at nodes"
    x, y = along(curve, "pressure")
    title += f", peak {amount(y.max(), 'stress')}"
    curves = [Curve(x, y, f"pressure {where}")]
    if "tangential_stress" in curve.of_nodes:
        curves.append(Curve(*along(curve, "tangential_stress"), "tangential stress", GREEN))
    x, gap = along(curve, "gap")
    closed = np.abs(gap) < CLOSED * displacement
    if closed.all():
        title += ", gap closed everywhere"
    else:
        curves.append(Curve(x, np.where(closed, 0, gap), "gap (right)" + ", 0 where closed" * closed.any(), ORANGE,
                            "--", right=True))
    return Lines(title, in_length(wider(curve.points)[1] + ", undeformed"), in_stress("stress"), curves,
                 right="" if closed.all() else in_length("gap"))


def body_panels(grid, contacts):
    scale, several = scale_of(grid, contacts), len(contacts) > 1
    largest = np.linalg.norm(grid.of_nodes["u"], axis=1).max()
    frames = {name: frame_of(grid, curve, scale) for name, curve in contacts.items()}
    frames = {name: frame for name, frame in frames.items() if is_part(frame, grid, scale)}
    whole = partial(draw_deformed, frames.values(), contacts, scale, grid)
    zooms = [Drawn(f"stress, {name}" if several else "stress at the contact",
                   partial(draw_zoom, frame, contacts[name], scale, grid), ratio=ratio_of(np.array(frame)))
             for name, frame in frames.items()]
    return [Drawn(title_of(grid, scale), whole, ratio=ratio_of(positions_of(grid, scale))), *zooms,
            *(contact_panel(curve, f"stress and gap, {name}" if several else
                            "stress and gap", largest) for name, curve in contacts.items())]


def solution_panels(path):
    grid = read_grid(path)
    contacts = contact_grids(path, grid)
    if is_solid(grid):
        scale = scale_of(grid, contacts)
        return solid_panels(grid, contacts, scale, title_of(grid, scale))
    return (body_panels if grid.of_nodes["u"].ndim == 2 else membrane_panels)(grid, contacts)


def solution(path):
    """One answer, of the file u.vtu: the membrane and its pressure (Niakh 2022, figure 2.4), or
    bodies, their stress and the pressure between them (figure 2.10)."""
    panels = solution_panels(path)
    mixed = len(panels) > 3 and not is_solid(read_grid(path))  # pictures of many shapes
    return save_panels(run_of(path) / "figures", "solution.png", panels, parameters_of(read_grid(path)),
                       in_columns if mixed else in_rows)
