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
    """Points (n x 3), triangles (m x 3) and fields by name of a VTU file in ASCII."""
    if not path.is_file():
        raise Missing(f"{path} is missing: make it with rbvi-online {path.parent}/model.h5 "
                      f"--mu VALUES --vtu {path.parent}/u.vtu")
    try:
        arrays = {a.get("Name"): a for a in xml.parse(path).iter("DataArray")}
        points = next(iter(xml.parse(path).iter("Points"))).find("DataArray")
    except (xml.ParseError, StopIteration):
        raise Missing(f"{path} is not a VTU file in ASCII") from None
    numbers = {name: np.array(a.text.split(), float) for name, a in arrays.items()}
    cells = numbers.pop("connectivity").astype(int).reshape(-1, 3)
    coordinates = np.array(points.text.split(), float).reshape(-1, 3)
    fields = {name: v for name, v in numbers.items() if v.size == len(coordinates)}
    return coordinates, cells, fields


def outline(points, cells):
    """Segments (k x 2 x 2) of the boundary of a triangulation: edges of one triangle only."""
    edges = np.sort(np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=1)
    single = [edge for edge, count in Counter(map(tuple, edges)).items() if count == 1]
    return points[np.array(single)][:, :, :2]


def whole_decades(axis):
    low, high = np.log10(np.maximum(axis.dataLim.intervaly, 1e-300))
    axis.set_ylim(10 ** np.floor(low), 10 ** np.ceil(high) * 1.3)


def save(figure, run, name):
    directory = run / "figures"
    directory.mkdir(exist_ok=True)
    for axis in figure.axes:
        if axis.get_yscale() == "log":
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


def solution(run):
    """The membrane and the pressure of one answer (Niakh 2022, figure 2.4)."""
    points, cells, fields = read_vtu(run / "u.vtu")
    contact, triangles, pressures = read_vtu(run / "u_contact.vtu")
    circle = outline(contact, triangles)
    figure = plt.figure(figsize=(9, 3.6))
    draw_membrane(figure.add_axes((0, 0.02, 0.47, 0.9), projection="3d"), points, cells, fields["u"], circle)
    draw_pressure(figure, figure.add_axes((0.58, 0.1, 0.42, 0.8)), contact, triangles,
                  pressures["pressure"], circle)
    save(figure, run, "solution.png")


def bases(run):
    """How fast the two bases converge, and how well conditioned the cone is."""
    cones = table(run, "cones.csv")
    pod = history(run, "pod/error")
    figure, axes = plt.subplots(1, 4, figsize=(12.5, 3), constrained_layout=True)
    pod = pod[pod > 1e-14]
    axes[0].plot(np.arange(len(pod)), pod, color=GREY)
    log_axis(axes[0], "modes N", "relative error", "displacement, POD")
    panels = (("error", "largest relative error", "multiplier, projection on the cone"),
              ("e_orth", "distance to the cone before", "new generator, e_orth"),
              ("gram_condition", "condition number", "Gram matrix of the generators"))
    for axis, (column, ylabel, title) in zip(axes[1:], panels):
        for flag, label, colour, style in ((0, "CPG", ORANGE, "--"), (1, "mCPG", BLUE, "-")):
            rows = cones[cones["mcpg"] == flag]
            axis.plot(rows["R"], rows[column], style, color=colour, label=label)
        log_axis(axis, "generators R", ylabel, title)
        axis.legend()
    save(figure, run, "bases.png")


def infsup(run):
    """Inf-sup constants over the validation set, and what each supremizer brings."""
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
    log_axis(axes[1], "supremizers S'", "", "along the supremizers")
    axes[1].legend()
    save(figure, run, "infsup.png")


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
    """Error of the enriched models over (N, R), with what the bases alone would allow. Where b
    depends on mu by more than a factor the supremizers of sub-models are not known, and verify
    writes no such table."""
    if len(history(run, "eim/b")) > 2 and not (run / "verify" / "error_map.csv").is_file():
        print("error_map.png: left out, b(mu) is not a multiple of one form")
        return
    data = table(run, "error_map.csv")
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), constrained_layout=True)
    draw_family(axes[0], data, "u", "N", "R")
    log_axis(axes[0], "modes N", "mean relative error", "displacement u")
    draw_family(axes[1], data, "lambda", "R", "N")
    log_axis(axes[1], "generators R", "mean relative error", "multiplier")
    save(figure, run, "error_map.png")


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
    save(figure, run, "mesh_quality.png")


def errors(run):
    """Errors of the reduced answers over the validation set, each curve sorted."""
    data = table(run, "errors.csv")
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), constrained_layout=True)
    curves = (("_decorrelated", "without supremizers", ORANGE, "--"),
              ("_enriched", "with supremizers", BLUE, "-"),
              ("_floor", "projection on the basis", "black", ":"))
    for axis, field, title in zip(axes, ("u", "lambda"), ("displacement u", "multiplier")):
        for suffix, label, colour, style in curves:
            axis.plot(np.sort(data[field + suffix]), style, color=colour, label=label)
        log_axis(axis, "validation parameters, sorted", "relative error", title)
    axes[0].legend()
    save(figure, run, "errors.png")


def main(arguments):
    if len(arguments) != 1 or arguments[0].startswith("-"):
        print("usage: figures.py RUN_DIR", file=sys.stderr)
        return 2
    run = Path(arguments[0])
    if not run.is_dir():
        print(f"figures.py: there is no run directory {run}", file=sys.stderr)
        return 2
    status = 0
    for draw in (solution, bases, infsup, error_map, mesh_quality, errors):
        try:
            draw(run)
        except Missing as missing:
            print(f"figures.py: {draw.__name__}: {missing}", file=sys.stderr)
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
