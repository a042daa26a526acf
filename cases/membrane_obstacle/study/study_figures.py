"""Figures of study.py."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from figure_tools import BLUE, GREEN, GREY, ORANGE, PURPLE, history, table, use_units
from figures import contact_regions, mesh_quality_panels
from panels import Curve, Drawn, Lines, Triangles, legend_below, save_panels
from study_panels import (above, along_size, constants_panel, greedy_panels, share_decades, sorted_places,
                          tolerance_panel)

import numpy as np

STYLES = {"cpg": (ORANGE, "--"), "mcpg": (BLUE, "-"), "mcpg, tolerance 0.001": (BLUE, ":"),
          "angle_greedy": (PURPLE, "--"), "nmf": (GREY, "-"), "nodal": ("black", ":"),
          "hybrid": (GREEN, "-")}
PAIRS = ((19, 50), (51, 70), (89, 50))
MAPS = {"similarity": True, "graded": False}  # whether marks are filled
FLOOR = 1e-8


def bases(runs, directory):
    """Convergence on the training set, similarity map."""
    errors, orthogonality, condition = [], [], []
    for name, (colour, style) in STYLES.items():
        run = runs.get(("similarity", "fine " + name))
        if run is None:
            continue
        size, error = history(run, "cone/size"), history(run, "cone/error")
        first = 1 if name in ("nmf", "hybrid") else 0  # no size in between
        errors.append(above(FLOOR, Curve(size[first:], error[first:], name, colour, ("." if first else "") + style)))
        condition.append(Curve(size[1:], history(run, "cone/gram_condition"), name, colour, style))
        if name in ("cpg", "mcpg"):
            orthogonality.append(Curve(size[1:], history(run, "cone/e_orth"), name, colour, style))
    pod = along_size(history(runs["similarity", "mcpg", "offline"], "pod/error"), "", GREY, least=1e-14)
    functions, error = "functions of the dual basis R", "largest relative error (-)"
    save_panels(directory, "bases.png", [
        Lines("displacement in its modes, POD", "modes N", "relative error (-)", [pod], log=True, floor=1e-14),
        Lines("multiplier, training set", functions, error, errors, log=True, floor=FLOOR),
        Lines("new functions (e_orth)", functions, "distance to the cone before (-)", orthogonality, log=True),
        Lines("condition of the dual basis", functions, "of its Gram matrix (-)", condition, log=True)],
        "similarity map")


def draw_floors(found, _, axis):
    """A row for each dual basis: marks of three errors on each map. `found`: (map, basis) -> summary."""
    kinds = (("lambda_floor_max", ORANGE, "o", "best of the basis"),
             ("lambda_max", BLUE, "s", "multiplier"), ("u_max", GREEN, "^", "displacement"))
    handles = {}
    for row, name in enumerate(STYLES):
        for (disc_map, filled), shift in zip(MAPS.items(), (-0.17, 0.17)):
            own = found[disc_map, name]
            axis.plot([max(own["lambda_floor_max"], FLOOR), own["lambda_max"]], [row + shift] * 2, color="#bbbbbb")
            for column, colour, mark, words in kinds:
                handles[f"{words}, {disc_map}"], = axis.plot(
                    max(own[column], FLOOR), row + shift, mark, color=colour, label=f"{words}, {disc_map}",
                    fillstyle="full" if filled else "none")
    axis.set_xscale("log")
    axis.set_xlabel("largest relative error (-)")
    sizes = [" and ".join(f"{found[disc_map, name]['R']:.0f}" for disc_map in MAPS) for name in STYLES]
    axis.set_yticks(range(len(STYLES)), [f"{name.replace(', ', chr(10))}\nR = {size}" for name, size in
                                         zip(STYLES, sizes)])
    axis.invert_yaxis()
    legend_below(axis, list(handles.values()))


def floors(runs, rows_of, directory):
    """What each dual basis allows and what its model reaches, over the validation set."""
    found = {(disc_map, name): rows_of(runs[disc_map, name, "offline"]) for disc_map in MAPS for name in STYLES}
    low = [" and ".join(name for name in STYLES if found[disc_map, name]["lambda_floor_max"] < FLOOR)
           for disc_map in MAPS]
    words = [f"{disc_map}: the best of {names} is below {FLOOR:.0e}, drawn there" for disc_map, names in
             zip(MAPS, low) if names]
    save_panels(directory, "floors.png", [Drawn("validation set; R on both maps", lambda *at: draw_floors(found, *at),
                                                ratio=1.7)], "\n".join(words))


def bounds_panel(disc_map, runs):
    """beta_off / beta_on and its two bounds along the supremizers."""
    curves = []
    for pair, colour in zip(PAIRS, (BLUE, ORANGE, GREEN)):
        steps = table(runs[disc_map, pair, "tight"], "stability.csv")
        curves += [Curve(steps["S"], steps["ratio_min"], "", colour),
                   Curve(steps["S"], steps["bound_min"], "", colour, "--"),
                   Curve(steps["S"], np.where(steps["classic_min"] > 0, steps["classic_min"], np.nan), "", colour, ":")]
    curves = [curve for curve in curves if np.any(np.isfinite(curve.y))]
    for curve in curves:  # a bound that does not hold yet is no answer that is missing
        held = np.isfinite(curve.y)
        curve.x, curve.y = curve.x[held], curve.y[held]
    return Lines(rf"$\beta_{{off}}/\beta_{{on}}$, {disc_map}; dashed: $\sqrt{{1-\sigma^2}}$; dotted: (2.24)",
                 "supremizers S", "ratio (-)", curves, ylimits=(0, 1.05))


def greedy(runs, directory):
    """sigma and beta along the projected greedy; the two bounds; beta_off at both tolerances."""
    panels = []
    for disc_map in MAPS:
        along, beside = [], []
        for pair, colour in zip(PAIRS, (BLUE, ORANGE, GREEN)):
            own = {kind: runs[disc_map, pair, kind] for kind in ("tight", "loose")}
            along.append((f"N = {pair[0]}, R = {pair[1]}", colour,
                          *(table(run, "stability.csv") for run in own.values())))
            beta = [table(run, "infsup.csv")["beta_off"] for run in own.values()]
            beside.append((colour, *((sorted_places(values), values) for values in beta)))
        panels += [*greedy_panels(disc_map, along), bounds_panel(disc_map, runs),
                   tolerance_panel(disc_map, "validation parameters, sorted (number)", beside)]
    save_panels(directory, "pga.png", panels)


def constants(runs, directory):
    panels = []
    for disc_map in MAPS:
        for pair in PAIRS:
            beta = table(runs[disc_map, pair, "loose"], "infsup.csv")
            panels.append(constants_panel(f"{disc_map}, N = {pair[0]}, R = {pair[1]}",
                                          "validation parameters, sorted (number)",
                                          sorted_places(beta["beta_on"]), beta))
    save_panels(directory, "infsup.png", share_decades(panels))


def modes(runs, rows_of, directory):
    """Error of u and lambda over N."""
    panels = []
    for disc_map in MAPS:
        for field, words in (("u", "displacement"), ("lambda", "multiplier")):
            curves = []
            for name, (colour, style) in STYLES.items():
                rows = [rows_of(runs[disc_map, name, key]) for key in (19, 51, "offline")]
                curves.append(Curve(np.array([row["N"] for row in rows]),
                                    np.array([row[field + "_max"] for row in rows]), name, colour, "o" + style))
            panels.append(Lines(f"{words}, {disc_map}", "modes N", "largest relative error (-)", curves, log=True))
    save_panels(directory, "modes.png", share_decades(panels))


def pairs(runs, directory):
    """Errors over (N, R): the modes alone and with the supremizers of each pair, similarity map."""
    panels, words = [], ["similarity map; circles: multiplier, triangles: displacement"]
    for name in ("cpg", "mcpg", "angle_greedy", "hybrid"):
        data = table(runs["similarity", name, "offline"], "error_map.csv")
        for kind, title in ((0, f"{name}, modes alone"), (1, f"{name}, with supremizers")):
            rows = data[(data["enriched"] == kind) & np.isfinite(data["lambda_max"])]
            curves = []
            for n, colour in zip(np.unique(data["N"]), (GREY, ORANGE, GREEN, BLUE)):
                part = rows[rows["N"] == n]
                if len(part) > 0:
                    curves += [Curve(part["R"], part["lambda_max"], f"N = {n:.0f}", colour, "o-"),
                               Curve(part["R"], part["u_max"], "", colour, "^:")]
            if curves:
                panels.append(Lines(title, "functions of the dual basis R", "largest relative error (-)", curves,
                                    log=True))
            else:
                words.append(f"{title}: left out, no pair has all its answers")
    save_panels(directory, "pairs.png", share_decades(panels), "\n".join(words))


def pressures(runs, directory):
    """Pressure and its error at the worst validation parameter, mCPG and hybrid."""
    panels = []
    for name in ("mcpg", "hybrid"):
        run = runs["similarity", name, "offline"]
        data = table(run, "worst_pressure.csv")
        (region,) = contact_regions(run, data)
        error = data["reduced"] - data["high_fidelity"]
        top, bound = data["high_fidelity"].max(), np.abs(error).max()
        panels += [Triangles(f"{name}: reduced", region.points, region.cells, region.at_nodes(data["reduced"]),
                             "pressure (Pa)", (0, top)),
                   Triangles(f"{name}: error, at most {bound / top:.0e} of the peak", region.points, region.cells,
                             region.at_nodes(error), "reduced less high-fidelity (Pa)", (-bound, bound), "RdBu_r")]
    save_panels(directory, "pressure.png", panels)


def draw_all(runs, summary, directory):
    use_units(next(iter(runs.values())))
    bases(runs, directory)
    floors(runs, summary, directory)
    greedy(runs, directory)
    constants(runs, directory)
    modes(runs, summary, directory)
    pairs(runs, directory)
    pressures(runs, directory)
    save_panels(directory, "mesh_quality.png", mesh_quality_panels(runs["similarity", "mcpg", "offline"]))
