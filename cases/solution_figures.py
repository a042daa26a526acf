"""The picture of one answer: a membrane over its obstacle, or bodies in contact."""

from collections import Counter

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.patches import Rectangle

from figure_tools import BLUE, GREEN, GREY, ORANGE, plt, read_grid, save, step_values, with_unit

SHADES = "YlGnBu"


def outline(points, cells):
    """Segments (k x 2 x 2) of the boundary of a triangulation: edges of one triangle only."""
    edges = np.sort(np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=1)
    single = [edge for edge, count in Counter(map(tuple, edges)).items() if count == 1]
    return points[np.array(single)][:, :, :2]


def label_plane(axis):
    axis.set_aspect("equal")
    axis.grid(False)
    axis.set_xlabel("x (m)")
    axis.set_ylabel("y (m)")


def parameters_of(grid):
    """"radius = 0.85 m, ..." of a VTU file."""
    values = [(name[3:].replace("_", " "), numbers[0], grid.units[name])
              for name, numbers in grid.of_all.items() if name.startswith("mu_")]
    return ",  ".join(f"{name} {value:.4g}{'' if unit == '-' else ' ' + unit}"
                      for name, value, unit in values)


def draw_membrane(figure, axis, grid, circle):
    u = grid.of_nodes["u"]
    surface = axis.plot_trisurf(grid.points[:, 0], grid.points[:, 1], u, triangles=grid.cells,
                                cmap="viridis", linewidth=0, antialiased=False, rasterized=True)
    floor = u.min() - 0.25 * np.ptp(u)
    for segment in circle:
        axis.plot(segment[:, 0], segment[:, 1], floor, color=ORANGE, linewidth=1.2)
    axis.set_zlim(floor, max(0, u.max()))
    axis.set_box_aspect((1, 1, 0.7), zoom=1.0)
    axis.view_init(elev=24, azim=-58)
    axis.set_xlabel("x (m)")
    axis.set_ylabel("y (m)")
    axis.set_zlabel("u (m)", labelpad=0)
    axis.tick_params(labelsize=7, pad=0)
    axis.set_title("membrane, and below it the obstacle", loc="left")
    figure.colorbar(surface, ax=axis, shrink=0.6, pad=0.1, label="u (m)")


def draw_pressure(figure, axis, grid, circle):
    pressure = grid.of_nodes["pressure"]
    top = pressure.max()
    filled = axis.tricontourf(grid.points[:, 0], grid.points[:, 1], grid.cells, pressure,
                              levels=np.linspace(0, top if top > 0 else 1, 15), cmap="Blues")
    for segment in circle:
        axis.plot(segment[:, 0], segment[:, 1], color=ORANGE, linewidth=1.4)
    axis.use_sticky_edges = False
    axis.margins(0.05)
    label_plane(axis)
    axis.set_title("pressure on the obstacle", loc="left")
    figure.colorbar(filled, ax=axis, shrink=0.8, format="%.3g", label="pressure (Pa)")


def draw_mesh(axis, positions, grid, size):
    """Edges as thin as they are short, those below a pixel left out; `size`: of the picture in the
    units of the positions. The outline is drawn whole."""
    segments = positions[grid.edges]
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    width = 0.35 * np.minimum(1, length / (0.03 * size))
    shown = width > 0.06
    axis.add_collection(LineCollection(segments[shown], linewidths=width[shown], colors="black",
                                       alpha=0.6))
    axis.add_collection(LineCollection(outline(positions, grid.cells), linewidths=0.7,
                                       colors="black"))


def draw_field(figure, axis, grid, values, label):
    """A field of the nodes or of the cells on the deformed bodies, its colour bar beside it."""
    positions = (grid.points + grid.of_nodes["u"])[:, :2]
    shading = "gouraud" if len(values) == len(positions) else "flat"
    filled = axis.tripcolor(positions[:, 0], positions[:, 1], grid.cells, values, shading=shading,
                            cmap=SHADES, rasterized=True)
    label_plane(axis)
    figure.colorbar(filled, ax=axis, shrink=0.75, label=label, format="%.3g")
    return positions, filled


def draw_bodies(figure, axis, path):
    """Deformed bodies in 2D, shaded by |u|."""
    grid = read_grid(path)
    positions, _ = draw_field(figure, axis, grid, np.linalg.norm(grid.of_nodes["u"], axis=1),
                              "|u| (m)")
    draw_mesh(axis, positions, grid, np.ptp(positions, axis=0).max())
    axis.set_title("deformed bodies", loc="left")


def contact_zone(curve):
    """Centre and half width of the part of the deformed contact curve that carries pressure; of the
    whole curve where none does."""
    positions = (curve.points + curve.of_nodes["u"])[:, :2]
    pressure = curve.of_nodes["pressure"]
    pressed = pressure > 1e-3 * pressure.max()
    zone = positions[pressed] if pressed.sum() > 1 else positions
    low, high = zone.min(axis=0), zone.max(axis=0)
    return (low + high) / 2, (high - low).max() / 2


def support_line(grid, curve, reach):
    """The rigid support of the one body, within `reach` of the middle of the contact: the deformed
    contact curve, moved along the normal by the gap that is left."""
    tangent = np.gradient(curve.points[:, :2], axis=0)
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    inwards = grid.points[:, :2].mean(axis=0) - curve.points[:, :2].mean(axis=0)
    normal *= -np.sign(normal.mean(axis=0) @ inwards)
    line = (curve.points + curve.of_nodes["u"])[:, :2] + curve.of_nodes["gap"][:, None] * normal
    return line[np.linalg.norm(line - contact_zone(curve)[0], axis=1) < reach]


def draw_zoom(figure, axis, whole, grid, curve):
    """Von Mises stress where the bodies meet; the frame of the picture in `whole`."""
    centre, half = contact_zone(curve)
    one_body = grid.of_cells["body"].max() == 1
    low, high = centre - (2 * half, (0.5 if one_body else 1.6) * half), centre + (2 * half, 1.8 * half)
    positions, filled = draw_field(figure, axis, grid, grid.of_cells["von_mises"],
                                   with_unit("von Mises stress", "Pa"))
    margin = 0.02 * np.ptp(positions, axis=0).max()
    low = np.maximum(low, positions.min(axis=0) - (margin, 3 * margin))
    high = np.minimum(high, positions.max(axis=0) + margin)
    middles = positions[grid.cells].mean(axis=1)
    inside = np.all((low < middles) & (middles < high), axis=1)
    filled.set_clim(0, grid.of_cells["von_mises"][inside].max())
    draw_mesh(axis, positions, grid, 4 * half)
    if one_body:
        line = support_line(grid, curve, 1.25 * half)
        axis.plot(line[:, 0], line[:, 1], color=ORANGE, linewidth=1.6, label="rigid support")
        axis.legend(loc="lower right")
    axis.set_xlim(low[0], high[0])
    axis.set_ylim(low[1], high[1])
    axis.set_title("where they meet", loc="left")
    whole.add_patch(Rectangle(low, *(high - low), fill=False, edgecolor=ORANGE, linewidth=1))


def draw_pressure_curve(axis, curve):
    """Pressure, with friction the tangential stress, and the gap along the contact curve."""
    lines = [step_values(axis, curve, "pressure", color=BLUE, label="pressure")]
    axis.set_xlabel("x, undeformed (m)")
    axis.set_ylabel("stress (Pa)")
    if "tangential_stress" in curve.of_nodes:
        lines.append(step_values(axis, curve, "tangential_stress", color=GREEN,
                                 label="tangential stress"))
    gap = axis.twinx()
    gap.spines["right"].set_visible(True)
    lines += gap.plot(curve.points[:, 0], curve.of_nodes["gap"], color=ORANGE, linewidth=1,
                      label="gap")
    if np.abs(curve.of_nodes["gap"]).max() < 1e-12:  # round-off: drawn as the zero that it is
        gap.set_ylim(-1e-9, 1e-9)
    gap.set_ylabel("gap (m)", color=ORANGE)
    gap.grid(False)
    axis.legend(handles=lines, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=3)
    axis.set_title("on the contact curve", loc="left")


def body_solution(run, grid):
    curve = read_grid(run / "u_contact.vtu")
    figure, axes = plt.subplots(1, 3, figsize=(12.5, 3.6), constrained_layout=True,
                                gridspec_kw={"width_ratios": [1, 1.15, 1.15]})
    draw_bodies(figure, axes[0], run / "u.vtu")
    draw_zoom(figure, axes[1], axes[0], grid, curve)
    draw_pressure_curve(axes[2], curve)
    return figure


def membrane_solution(run, grid):
    contact = read_grid(run / "u_contact.vtu")
    circle = outline(contact.points, contact.cells)
    figure = plt.figure(figsize=(9.5, 3.6))
    draw_membrane(figure, figure.add_axes((0, 0.02, 0.5, 0.9), projection="3d"), grid, circle)
    draw_pressure(figure, figure.add_axes((0.6, 0.1, 0.4, 0.8)), contact, circle)
    return figure


def solution(run):
    """One answer: the membrane and its pressure (Niakh 2022, figure 2.4), or bodies, their stress
    and the pressure between them (figure 2.10)."""
    grid = read_grid(run / "u.vtu")
    draw = body_solution if grid.of_nodes["u"].ndim == 2 else membrane_solution
    figure = draw(run, grid)
    figure.suptitle(parameters_of(grid), fontsize=8, color=GREY, y=1.04)
    save(figure, run / "figures", "solution.png")
