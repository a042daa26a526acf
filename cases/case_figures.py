"""The picture of a case, from the files of rbvi check -vtu: its mesh with the groups of its surface,
and what its contacts face before anything is deformed."""

from functools import partial

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from figure_tools import (BLUE, GREEN, ORANGE, PURPLE, beside, in_length, is_solid, label_plane,
                          parameters_of, plt, read_grid, wider)
from panels import ROUND_OFF, Curve, Drawn, Lines, Triangles, legend_below, ratio_of, save_panels
from solid_figures import FROM_ABOVE, draw_painted, plan_of, rows_of, skin_of, view_behind, view_of

# Places in the box by the names of their files.
PLACES = {"middle": ("middle of the box", BLUE), "least": ("where the gap is least", ORANGE),
          "largest": ("where the gap is largest", GREEN)}
HUES = (BLUE, GREEN, PURPLE, "#E69F00", "#56B4E9", ORANGE, "#8B1A1A", "#B8B000", "#4B0082", "#A0522D")
FLAT = 0.1  # of the length of a boundary: smaller gaps are drawn larger than they are
CLOSED = 1e-9  # of the length of a boundary
MOST_WAYS = 40  # from points to their partners that are drawn
FREE = "(free)"
NO_GROUP, PALE = "#dddddd", 0.35  # of faces of solids: without a name, and what is left of a colour
HIGH = 0.7  # a panel of a body, for its width


def draw_regions(mesh, axis):
    """Handles of a legend, one for each."""
    x, count = mesh.points, len(mesh.of_cells)
    shade = sum(((k + 1) * values for k, values in enumerate(mesh.of_cells.values())),
                np.zeros(len(mesh.cells)))
    top = max(6, 2 * count * (count + 1))
    axis.tripcolor(x[:, 0], x[:, 1], mesh.cells, facecolors=shade, cmap="Greys", vmin=-0.5, vmax=top,
                   edgecolors="#999999", linewidth=0.2, rasterized=True)
    return [Patch(color=plt.get_cmap("Greys")((k + 1.5) / (top + 0.5)), label=name)
            for k, name in enumerate(mesh.of_cells)]


def draw_groups(mesh, surface, _, axis):
    """The mesh, its regions in shades, the groups of its surface in colours, the largest below; what
    is free is dotted."""
    handles = draw_regions(mesh, axis)

    def draw(which, label, **style):
        segments = mesh.points[surface.cells[which], :2]
        handles.append(axis.add_collection(LineCollection(segments, label=label, **style)))

    groups = {name: values > 0 for name, values in surface.of_cells.items() if name != FREE}
    order = sorted(groups, key=lambda name: -groups[name].sum())
    for k, name in enumerate(order):
        inside = any(np.all(groups[other] >= groups[name]) for other in order[:k])
        draw(groups[name], name, colors=HUES[k % len(HUES)], linewidths=2 if inside else 4)
    free = surface.of_cells[FREE] > 0
    if free.any():
        draw(free, "free of conditions and contact", colors="black", linewidths=1.2,
             linestyles=":")
    label_plane(axis)
    axis.xaxis.set_major_locator(MaxNLocator(2 if ratio_of(mesh.points) > 1 else 4))
    legend_below(axis, handles)


def draw_partners(grids, _, axis):
    """A contact boundary in black, what it faces at each place in its colour, and the ways between."""
    handles = []
    for place, grid in grids.items():
        label, colour = PLACES[place]
        x, way = grid.points[:, :2], grid.of_nodes["to_partner"][:, :2]
        some = slice(None, None, max(1, len(x) // MOST_WAYS))
        axis.add_collection(LineCollection(np.stack([x, x + way], axis=1)[some], colors=colour,
                                           linewidths=0.5, alpha=0.7))
        boundary = axis.plot(x[:, 0], x[:, 1], color="black", linewidth=2.2, label="contact boundary")
        handles += axis.plot(*(x + way).T, color=colour, label=label)
    legend_below(axis, [*boundary, *handles])
    label_plane(axis)
    gap = max(np.abs(grid.of_nodes["gap"]).max() for grid in grids.values())
    axis.set_aspect("auto" if gap < FLAT * np.ptp(x, axis=0).max() else "equal", adjustable="datalim")


def surface_colours(mesh, surface):
    """The skin of a solid, colours of its faces by their groups, the smallest last, pale where the
    surface is free, and handles of a legend."""
    skin = skin_of(mesh.cells)
    rows = rows_of(skin, surface.cells)
    outside, rows = rows >= 0, rows[rows >= 0]
    colours, handles = np.tile(to_rgb(NO_GROUP), (len(skin.faces), 1)), []
    groups = {name: values[outside] > 0 for name, values in surface.of_cells.items()}
    free = groups.pop(FREE)
    for name, colour in zip(sorted(groups, key=lambda name: -groups[name].sum()), HUES):
        colours[rows[groups[name]]] = to_rgb(colour)
        handles.append(Patch(facecolor=colour, label=name))
    colours[rows[free]] = 1 - PALE * (1 - colours[rows[free]])
    if free.any():
        handles.append(Patch(facecolor=NO_GROUP, label="pale: free of conditions and contact"))
    return skin, colours, handles


def draw_surface(points, painted, view, _, axis):
    skin, colours, handles = painted
    draw_painted(axis, points, skin, view, colours)
    legend_below(axis, handles)


def surface_panels(mesh, surface):
    """The groups of the surface of a solid, from two sides."""
    painted, view = surface_colours(mesh, surface), view_of(np.array([0.0, 0, 1]))
    return [Drawn(title, partial(draw_surface, mesh.points, painted, seen), ratio=HIGH) for title, seen in
            (("surface, from above", view), ("from the other side", view_behind(view)))]


def contact_panels(grids, which, solid):
    middle = next(iter(grids.values()))
    if middle.cells.shape[1] > 2:
        gaps = {place: grid.of_nodes["gap"] for place, grid in grids.items()}
        plan = plan_of(middle.points, middle.cells) if solid else FROM_ABOVE
        return [Triangles(f"gap of {which}, {PLACES[place][0]}", plan.flat(grid.points), grid.cells, gaps[place],
                          in_length("gap, overlap below 0" if solid else "height above the obstacle"),
                          limits_of(gaps[place]), axes=plan.names)
                for place, grid in grids.items()]
    curves = [Curve(wider(grid.points)[0], grid.of_nodes["gap"], *PLACES[place])
              for place, grid in grids.items()]
    return [Drawn(f"what {which} faces", partial(draw_partners, grids), ratio=0.75),
            Lines(f"gap along {which}", in_length(wider(middle.points)[1]),
                  in_length("gap, overlap below 0"), curves)]


def limits_of(values):
    """Of colours; those of a constant with round-off are around it."""
    low, high = values.min(), values.max()
    size = max(abs(low), abs(high))
    return (low, high) if high - low > ROUND_OFF * size else (low - (0.1 * size or 1), high + (0.1 * size or 1))


def is_closed(grids):
    return all(np.abs(grid.of_nodes["gap"]).max() < CLOSED * np.ptp(grid.points) for grid in grids.values())


def partners(path):
    """By the name of each contact and by place, those that were written."""
    of_name = {}
    for place in PLACES:
        for file in sorted(path.parent.glob(f"{path.stem}_partners*_{place}{path.suffix}")):
            grid = read_grid(file)
            of_name.setdefault(grid.of_all["contacts"][0], {})[place] = grid
    names = read_grid(path).of_all["contacts"]
    return {name: of_name[name] for name in names if name in of_name}


def case_panels(path):
    """Panels, and the parameters of the places in the box."""
    mesh, surface = (read_grid(beside(path, name)) for name in ("_mesh", "_surface"))
    contacts = partners(path)
    panels = surface_panels(mesh, surface) if is_solid(mesh) else [
        Drawn("mesh and its groups", partial(draw_groups, mesh, surface), ratio=ratio_of(mesh.points))]
    words = {}
    for name, grids in contacts.items():
        which = name if len(contacts) > 1 else "contact"
        if is_closed(grids):
            words[f"{which}, gap"] = "closed everywhere"
        else:
            panels += contact_panels(grids, which, is_solid(mesh))
        for place, grid in grids.items():
            label = PLACES[place][0] if place == "middle" else f"{which}, {PLACES[place][0]}"
            words[label] = parameters_of(grid)
    return panels, "\n".join(f"{label}: {numbers}" for label, numbers in words.items())


def case(path):
    """Nothing where rbvi check did not write its files."""
    if not beside(path, "_mesh").is_file():
        return []
    panels, words = case_panels(path)
    return save_panels(path.parent / "figures", "case.png", panels, words)
