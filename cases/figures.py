#!/usr/bin/env python3
"""Figures of a run: figures.py RUN_DIR writes PNG files into RUN_DIR/figures.

Reads RUN_DIR/model.h5 (rbvi offline), RUN_DIR/verify/*.csv (rbvi verify) and RUN_DIR/u.vtu with
u_contact.vtu beside it (rbvi-online --vtu, or rbvi solve -vtu). What is missing is named and its
figure left out; the exit status is then 1.
"""

import sys
import xml.etree.ElementTree as xml
from collections import Counter
from pathlib import Path

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

# Okabe and Ito's palette: told apart with every kind of colour vision, and in grey.
BLUE, ORANGE, GREEN, PURPLE, GREY = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#666666"

plt.rcParams.update({
    "font.size": 9, "axes.titlesize": 10, "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.color": "#dddddd", "grid.linewidth": 0.6, "lines.linewidth": 1.6,
    "lines.markersize": 4, "legend.frameon": False, "savefig.dpi": 110,
})


class Missing(Exception):
    """A file or a quantity that this run does not have; the message says how to make it."""


def table(run, name):
    """Columns of a table of rbvi verify, by name."""
    path = run / "verify" / name
    if not path.is_file():
        raise Missing(f"{path} is missing: run rbvi verify -out {run} first")
    return np.atleast_1d(np.genfromtxt(path, delimiter=",", names=True))


def history(run, name):
    """A convergence history of the model, e.g. pod/error."""
    path = run / "model.h5"
    if not path.is_file():
        raise Missing(f"{path} is missing: run rbvi offline -out {run} first")
    try:
        with h5py.File(path, "r") as model:
            return model["histories/values/" + name][()].ravel()
    except (OSError, KeyError) as error:
        raise Missing(f"{path} cannot be read: {error}") from None


def read_vtu(path):
    """Points (n x 3), cells (m x nodes per cell) and fields by name of a VTU file in ASCII: one
    number per node or cell, or three per node."""
    if not path.is_file():
        raise Missing(f"{path} is missing: make it with rbvi-online {path.parent}/model.h5 "
                      f"--mu VALUES --vtu {path.parent}/u.vtu")
    try:
        arrays = {a.get("Name"): a for a in xml.parse(path).iter("DataArray")}
        points = next(iter(xml.parse(path).iter("Points"))).find("DataArray")
    except (xml.ParseError, StopIteration):
        raise Missing(f"{path} is not a VTU file in ASCII") from None
    numbers = {name: np.array(a.text.split(), float) for name, a in arrays.items()}
    cells = numbers.pop("connectivity").astype(int).reshape(-1, int(numbers.pop("offsets")[0]))
    if cells.shape[1] == 6:  # a quadratic triangle, drawn as four linear ones
        cells = cells[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]]].reshape(-1, 3)
    numbers.pop("types")
    coordinates = np.array(points.text.split(), float).reshape(-1, 3)
    fields = {name: v.reshape(-1, 3) if v.size == 3 * len(coordinates) else v
              for name, v in numbers.items() if name != "points"}
    return coordinates, cells, fields


def outline(points, cells):
    """Segments (k x 2 x 2) of the boundary of a triangulation: edges of one triangle only."""
    edges = np.sort(np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=1)
    single = [edge for edge, count in Counter(map(tuple, edges)).items() if count == 1]
    return points[np.array(single)][:, :, :2]


def whole_decades(axis):
    low, high = np.log10(np.maximum(axis.dataLim.intervaly, 1e-300))
    axis.set_ylim(10 ** np.floor(low), 10 ** np.ceil(high) * 1.3)


def save(figure, directory, name):
    """Logarithmic axes without limits of their own show whole decades."""
    directory.mkdir(exist_ok=True)
    for axis in figure.axes:
        if axis.get_yscale() == "log" and axis.get_autoscaley_on():
            whole_decades(axis)
    figure.savefig(directory / name, bbox_inches="tight")
    plt.close(figure)
    print(directory / name)


def log_axis(axis, xlabel, ylabel, title):
    axis.set_yscale("log")
    axis.set_xlabel(xlabel)
    axis.set_ylabel(ylabel)
    axis.set_title(title, loc="left")


def draw_membrane(axis, points, cells, u, circle):
    axis.plot_trisurf(points[:, 0], points[:, 1], u, triangles=cells, cmap="viridis", linewidth=0,
                      antialiased=False)
    floor = u.min() - 0.25 * np.ptp(u)
    for segment in circle:
        axis.plot(segment[:, 0], segment[:, 1], floor, color=ORANGE, linewidth=1.2)
    axis.set_zlim(floor, 0)
    axis.set_box_aspect((1, 1, 0.7), zoom=1.1)
    axis.view_init(elev=24, azim=-58)
    axis.set_xlabel("x")
    axis.set_ylabel("y")
    axis.set_zlabel("u", labelpad=0)
    axis.tick_params(labelsize=7, pad=0)
    axis.set_title("membrane u; below, the edge of the obstacle", loc="left")


def draw_pressure(figure, axis, points, cells, pressure, circle):
    levels = np.linspace(0, max(pressure.max(), 1e-300), 15)
    filled = axis.tricontourf(points[:, 0], points[:, 1], cells, pressure, levels=levels,
                              cmap="Blues")
    for segment in circle:
        axis.plot(segment[:, 0], segment[:, 1], color=ORANGE, linewidth=1.4)
    axis.set_aspect("equal")
    axis.use_sticky_edges = False
    axis.margins(0.05)
    axis.grid(False)
    axis.set_xlabel("x")
    axis.set_ylabel("y")
    axis.set_title("pressure on the obstacle", loc="left")
    figure.colorbar(filled, ax=axis, shrink=0.8, format="%.3g")


def draw_bodies(axis, path):
    """Deformed bodies in 2D."""
    points, cells, fields = read_vtu(path)
    moved = points + fields["u"]
    axis.tripcolor(moved[:, 0], moved[:, 1], cells, np.linalg.norm(fields["u"], axis=1),
                   shading="gouraud", cmap="Blues")
    axis.triplot(moved[:, 0], moved[:, 1], cells, color="black", linewidth=0.15)
    axis.set_aspect("equal")
    axis.grid(False)
    axis.set_xlabel("x")
    axis.set_ylabel("y")
    axis.set_title("deformed bodies, shade: |u|", loc="left")


def draw_pressure_curve(axis, path):
    """Pressure, and with friction the tangential stress, along the contact curve."""
    points, edges, fields = read_vtu(path)
    if len(fields["pressure"]) == len(edges):
        axis.stairs(fields["pressure"], points[:, 0], color=BLUE)
    else:
        axis.plot(points[:, 0], fields["pressure"], color=BLUE)
    axis.set_xlabel("x")
    axis.set_ylabel("pressure")
    if "tangential_stress" in fields:
        axis.plot(points[:, 0], fields["tangential_stress"], color=GREEN)
        axis.set_ylabel("pressure; green: tangential stress")
    gap = axis.twinx()
    gap.plot(points[:, 0], fields["gap"], color=ORANGE, linewidth=1)
    gap.set_ylabel("gap", color=ORANGE)
    gap.grid(False)
    axis.set_title("pressure and gap on the contact curve", loc="left")


def solution(run):
    """One answer: the membrane and its pressure (Niakh 2022, figure 2.4), or two bodies and the
    pressure between them (figure 2.10)."""
    points, cells, fields = read_vtu(run / "u.vtu")
    if fields["u"].ndim == 2:
        figure, axes = plt.subplots(1, 2, figsize=(9, 4), constrained_layout=True,
                                    gridspec_kw={"width_ratios": [1, 1.5]})
        draw_bodies(axes[0], run / "u.vtu")
        draw_pressure_curve(axes[1], run / "u_contact.vtu")
        save(figure, run / "figures", "solution.png")
        return
    contact, triangles, pressures = read_vtu(run / "u_contact.vtu")
    circle = outline(contact, triangles)
    figure = plt.figure(figsize=(9, 3.6))
    draw_membrane(figure.add_axes((0, 0.02, 0.47, 0.9), projection="3d"), points, cells, fields["u"], circle)
    draw_pressure(figure, figure.add_axes((0.58, 0.1, 0.42, 0.8)), contact, triangles,
                  pressures["pressure"], circle)
    save(figure, run / "figures", "solution.png")


def kind_of(run):
    """What the model reduces: a "pair" of bases, contact with a rigid "support" by multipliers, or
    by "nitsche"."""
    path = run / "model.h5"
    if not path.is_file():
        raise Missing(f"{path} is missing: run rbvi offline -out {run} first")
    with h5py.File(path, "r") as model:
        if model["nitsche/edges"].size > 0:
            return "nitsche"
        return "support" if int(np.ravel(model["support/vertices"][()])[0]) > 0 else "pair"


def nitsche_panels(run):
    """How the integrals over the contact curve are reduced, if they are."""
    with h5py.File(run / "model.h5", "r") as model:
        curve = {name: error[()].ravel() for name, error in model["histories/values/curve"].items()}
    panels = []
    if len(curve["points"]) > 0:
        panels.append((curve["points"], curve["error"], "Gauss points", "error added to u",
                       "contact curve"))
    for name, title in (("contact_matrix", "$B^n$"), ("contact_vector", r"$\Theta^n$"),
                        ("friction_matrix", r"$B^\tau$"), ("friction_vector", r"$\Theta^\tau$")):
        error = curve.get(name, np.zeros(0))
        error = error[error > 1e-14]
        if len(error) > 0:
            panels.append((np.arange(len(error)), error, "terms", "largest relative error",
                           f"interpolation of {title}"))
    return panels


def support_panels(run):
    """What a model of contact with a rigid support was made from, beside its modes."""
    with h5py.File(run / "model.h5", "r") as model:
        collocated = "gcns" in model["histories/values"]
    tangential = history(run, "tangential/error")
    panels = []
    for name, title in (("normal_cone", "cone of the pressure"),
                        ("bound_cone", "cone of what is left to the bound")):
        error = history(run, name + "/error")
        if len(error) > 0:
            panels.append((np.arange(len(error)), error, "generators", "largest relative error",
                           title))
    tangential = tangential[tangential > 1e-14]
    if len(tangential) > 0:
        panels.append((np.arange(len(tangential)), tangential, "modes", "relative error",
                       "modes of the multipliers"))
    if collocated:
        panels.append((history(run, "gcns/nodes"), history(run, "gcns/error"), "collocation nodes", "relative error",
                       "e_GCNS"))
    return panels


def pair_panels(run):
    """The dual basis of a reduced pair."""
    size, error = history(run, "cone/size"), history(run, "cone/error")
    orthogonality, condition = history(run, "cone/e_orth"), history(run, "cone/gram_condition")
    panels = [(size, error, "dual functions R", "largest relative error", "multiplier")]
    if len(orthogonality) > 0:
        panels.append((size[1:], orthogonality, "dual functions R", "distance to the cone before",
                       "new generator, e_orth"))
    panels.append((size[1:], condition, "dual functions R", "condition number", "Gram matrix"))
    return panels


def bases(run):
    """How fast the two bases converge, and how well conditioned the dual one is."""
    pod = history(run, "pod/error")
    pod = pod[pod > 1e-14]
    panels = [(np.arange(len(pod)), pod, "modes N", "relative error", "displacement, POD"),
              *{"nitsche": nitsche_panels, "support": support_panels,
                "pair": pair_panels}[kind_of(run)](run)]
    figure, axes = plt.subplots(1, len(panels), figsize=(3.2 * len(panels), 3), squeeze=False,
                                constrained_layout=True)
    for axis, (x, y, xlabel, ylabel, title) in zip(axes[0], panels):
        axis.plot(x, y, "." if len(x) < 30 else "-", color=BLUE)
        log_axis(axis, xlabel, ylabel, title)
    save(figure, run / "figures", "bases.png")


def draw_contact_field(figure, axis, points, cells, values, colours, limits, title):
    filled = axis.tripcolor(points[:, 0], points[:, 1], cells, values, shading="gouraud",
                            cmap=colours, vmin=limits[0], vmax=limits[1])
    axis.set_aspect("equal")
    axis.grid(False)
    axis.set_title(title, loc="left")
    figure.colorbar(filled, ax=axis, shrink=0.8, format="%.3g")


def contact_cells(run):
    """Triangles of the contact region; nothing for two bodies."""
    with h5py.File(run / "model.h5", "r") as model:
        return model["fields/contact_cells"][()].reshape(-1, 3)


def pressure_curve(run, data):
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), constrained_layout=True)
    axes[0].plot(data["x"], data["high_fidelity"], color=GREY, linewidth=3, label="high-fidelity")
    axes[0].plot(data["x"], data["reduced"], color=BLUE, label="reduced")
    axes[0].set_title("pressure, worst of the validation set", loc="left")
    axes[0].legend()
    axes[1].plot(data["x"], data["reduced"] - data["high_fidelity"], color=ORANGE)
    axes[1].set_title("its error", loc="left")
    if "reduced_tangential" in data.dtype.names:
        axes[0].plot(data["x"], data["high_fidelity_tangential"], color=GREY, linewidth=3)
        axes[0].plot(data["x"], data["reduced_tangential"], color=GREEN,
                     label="reduced, tangential")
        axes[0].legend()
        axes[1].plot(data["x"], data["reduced_tangential"] - data["high_fidelity_tangential"],
                     color=GREEN)
    for axis in axes:
        axis.set_xlabel("x")
    save(figure, run / "figures", "pressure.png")


def pressure(run):
    """Pressure and its error at the validation parameter where the error is largest."""
    data, cells = table(run, "worst_pressure.csv"), contact_cells(run)
    if len(cells) == 0:
        pressure_curve(run, data)
        return
    points = np.column_stack([data["x"], data["y"]])
    error = data["reduced"] - data["high_fidelity"]
    figure, axes = plt.subplots(1, 2, figsize=(8, 3.4), constrained_layout=True)
    top, bound = data["high_fidelity"].max(), np.abs(error).max()
    draw_contact_field(figure, axes[0], points, cells, data["reduced"], "Blues", (0, top),
                       "reduced pressure, reference disc")
    draw_contact_field(figure, axes[1], points, cells, error, "RdBu_r", (-bound, bound),
                       "its error, worst of the validation set")
    save(figure, run / "figures", "pressure.png")


def draw_constants(axis, x, beta):
    """The four constants against x; one that vanishes is named instead."""
    curves = (("beta_hf", r"$\beta_{HF}$", GREY, "-"), ("beta_on", r"$\beta_{on}$", GREEN, "-"),
              ("beta_off", r"$\beta_{off}$", BLUE, "--"),
              ("beta_dec", r"$\beta_{dec}$", ORANGE, ":"))
    order = np.argsort(x)
    for column, label, colour, style in curves:
        if beta[column].max() > 1e-9:
            axis.plot(x[order], np.maximum(beta[column][order], 1e-9), style, color=colour,
                      label=label)
        else:
            axis.text(0.97, 0.03, label + " below 1e-9", color=colour, ha="right",
                      transform=axis.transAxes)


def draw_greedy(axes, tight, loose, colour, label, floor):
    """Largest sigma and smallest beta_off along the supremizers; a dot where a looser run ends.
    Values of beta below `floor` are drawn there."""
    for axis, column, least in zip(axes, ("sigma_max", "beta_min"), (1e-8, floor)):
        axis.plot(tight["S"], np.maximum(tight[column], least), color=colour, label=label)
        axis.plot(loose["S"][-1], loose[column][-1], "o", color=colour)


def infsup(run):
    """Inf-sup constants over the validation set, and what each supremizer brings."""
    if kind_of(run) != "pair":
        return  # verify does not make them
    beta, steps = table(run, "infsup.csv"), table(run, "stability.csv")
    order = np.argsort(beta["beta_on"])
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), constrained_layout=True)
    curves = (("beta_hf", r"$\beta_{HF}$ high-fidelity", GREY, "-"),
              ("beta_on", r"$\beta_{on}$ online-enriched", GREEN, "-"),
              ("beta_off", r"$\beta_{off}$ offline-enriched", BLUE, "--"),
              ("beta_dec", r"$\beta_{dec}$ decorrelated", ORANGE, ":"))
    for column, label, colour, style in curves:
        axes[0].plot(beta[column][order], style, color=colour, label=label)
    log_axis(axes[0], "validation parameters, sorted", "inf-sup constant over the span",
             "stability over the validation set")
    axes[0].legend()
    axes[1].plot(steps["S"], steps["sigma_max"], color=ORANGE, label=r"largest $\sigma$")
    axes[1].plot(steps["S"], steps["ratio_min"], color=BLUE,
                 label=r"smallest $\beta_{off}/\beta_{on}$")
    axes[1].plot(steps["S"], steps["bound_min"], "--", color=GREEN,
                 label=r"bound $\sqrt{1-\sigma^2}$")
    positive = steps["classic_min"] > 0
    axes[1].plot(steps["S"][positive], steps["classic_min"][positive], ".", color=PURPLE,
                 label="bound (2.24), where positive")
    log_axis(axes[1], "supremizers S'", "", "along the supremizers")
    axes[1].legend()
    save(figure, run / "figures", "infsup.png")


def draw_family(axis, data, field, along, across):
    """Mean error against `along`, one line per value of `across`, over the floor of the basis."""
    values = np.unique(data[across])
    shades = plt.get_cmap("viridis")(np.linspace(0, 0.85, len(values)))
    for value, shade in zip(values, shades):
        rows = np.sort(data[data[across] == value], order=along)
        axis.plot(rows[along], rows[field + "_mean"], "o-", color=shade, label=f"{value:.0f}")
    floor = [data[data[along] == x][field + "_floor_mean"].min() for x in np.unique(data[along])]
    axis.plot(np.unique(data[along]), floor, ":", color="black", label="projection")
    axis.legend(title=across, fontsize=7, title_fontsize=8)


def error_map(run):
    """Error over (N, R), with what the bases alone would allow: enriched by all supremizers of the
    pair where b(mu) is a multiple of one form, decorrelated elsewhere."""
    data = table(run, "error_map.csv")
    data = data[(data["enriched"] == data["enriched"].max()) & np.isfinite(data["u_mean"])]
    if len(data) == 0:
        print("error_map.png: left out, no pair has all its answers")
        return
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), constrained_layout=True)
    if kind_of(run) == "nitsche":
        for axis, field, title in zip(axes, ("u", "lambda"), ("displacement u", "normal stress")):
            axis.plot(data["N"], data[field + "_mean"], "o-", color=BLUE, label="reduced answers")
            axis.plot(data["N"], data[field + "_floor_mean"], ":", color="black",
                      label="projection on the basis")
            log_axis(axis, "modes N", "mean relative error", title)
            axis.legend()
        save(figure, run / "figures", "error_map.png")
        return
    draw_family(axes[0], data, "u", "N", "R")
    log_axis(axes[0], "modes N", "mean relative error", "displacement u")
    draw_family(axes[1], data, "lambda", "R", "N")
    log_axis(axes[1], "dual functions R", "mean relative error", "multiplier")
    save(figure, run / "figures", "error_map.png")


def mesh_quality(run):
    """Largest aspect ratio of the mapped mesh (Niakh 2022, figure 2.3)."""
    data = table(run, "mesh_quality.csv")
    figure, axis = plt.subplots(figsize=(4.8, 3.2), constrained_layout=True)
    for flag, label, colour, style in ((1, "training", BLUE, "-"), (0, "validation", ORANGE, "--")):
        values = np.sort(data["max_aspect_ratio"][data["training"] == flag])
        axis.plot(np.linspace(0, 100, len(values)), values, style, color=colour,
                  label=f"{label}, {len(values)} parameters")
    axis.set_ylim(bottom=1)
    axis.set_xlabel("share of the parameters, sorted (%)")
    axis.set_ylabel("largest aspect ratio")
    axis.set_title("quality of the mapped mesh", loc="left")
    axis.legend()
    save(figure, run / "figures", "mesh_quality.png")


def errors(run):
    """Errors of the reduced answers over the validation set, each curve sorted."""
    data = table(run, "errors.csv")
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), constrained_layout=True)
    curves = [("_enriched", "with supremizers", BLUE, "-"),
              ("_floor", "projection on the basis", "black", ":")]
    kind = kind_of(run)
    if kind == "pair":
        curves.insert(0, ("_decorrelated", "without supremizers", ORANGE, "--"))
    else:
        curves[0] = ("_enriched", "reduced answers", BLUE, "-")
    dual = "normal stress" if kind == "nitsche" else "multiplier"
    for axis, field, title in zip(axes, ("u", "lambda"), ("displacement u", dual)):
        for suffix, label, colour, style in curves:
            values = np.sort(data[field + suffix])
            missing = np.sum(~np.isfinite(values))
            label += f", {missing} without an answer" if missing else ""
            axis.plot(values[np.isfinite(values)], style, color=colour, label=label)
        log_axis(axis, "validation parameters, sorted", "relative error", title)
    if "tangential_enriched" in data.dtype.names:
        axes[1].plot(np.sort(data["tangential_enriched"]), color=GREEN, label="tangential part")
        axes[1].legend()
    axes[0].legend()
    save(figure, run / "figures", "errors.png")


def main(arguments):
    if len(arguments) != 1 or arguments[0].startswith("-"):
        print("usage: figures.py RUN_DIR", file=sys.stderr)
        return 2
    run = Path(arguments[0])
    if not run.is_dir():
        print(f"figures.py: there is no run directory {run}", file=sys.stderr)
        return 2
    status = 0
    for draw in (solution, bases, pressure, infsup, error_map, mesh_quality, errors):
        try:
            draw(run)
        except Missing as missing:
            print(f"figures.py: {draw.__name__}: {missing}", file=sys.stderr)
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
