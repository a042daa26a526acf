#!/usr/bin/env python3
"""Figures of a run: figures.py RUN_DIR writes PNG and PDF files into RUN_DIR/figures.

Reads RUN_DIR/model.h5 (rbvi offline), RUN_DIR/verify/*.csv (rbvi verify), RUN_DIR/u.vtu with
u_contact.vtu beside it (rbvi-online --vtu, or rbvi solve -vtu) and, if it is there,
RUN_DIR/bench/table.csv (rbvi bench). What else is missing is named and its figure left out; the exit
status is then 1. Logarithmic axes end at 1e-16: what is below is drawn there.
"""

import sys
from pathlib import Path

import h5py
import numpy as np

from bench_figures import bench
from figure_tools import (BLUE, GREEN, GREY, ORANGE, PURPLE, Missing, free_parameters, history,
                          log_axis, model_of, plt, save, table, with_unit)
from solution_figures import label_plane, solution


def kind_of(run):
    """What the model reduces: a "pair" of bases, the "law" at nodes, or the curve of
    "nitsche"."""
    with h5py.File(model_of(run), "r") as model:
        if int(np.ravel(model["nitsche/rule"][()])[0]) >= 0:
            return "nitsche"
        return "law" if int(np.ravel(model["law/normal"][()])[0]) > 0 else "pair"


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


def law_panels(run):
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
        panels.append((history(run, "gcns/nodes"), history(run, "gcns/error"), "collocation nodes",
                       "relative error", "e_GCNS"))
    return panels


def pair_panels(run):
    """The dual basis of a reduced pair."""
    size, error = history(run, "cone/size"), history(run, "cone/error")
    orthogonality, condition = history(run, "cone/e_orth"), history(run, "cone/gram_condition")
    panels = [(size, error, "dual functions R", "largest relative error", "multiplier")]
    if len(orthogonality) > 0:
        panels.append((size[1:], orthogonality, "dual functions R", "distance to the cone before",
                       "new generator, e_orth"))
    panels.append((size[1:], condition, "dual functions R", "condition number (-)", "Gram matrix"))
    return panels


def bases(run):
    """How fast the two bases converge, and how well conditioned the dual one is."""
    pod = history(run, "pod/error")
    pod = pod[pod > 1e-14]
    panels = [(np.arange(len(pod)), pod, "modes N", "relative error", "displacement, POD"),
              *{"nitsche": nitsche_panels, "law": law_panels,
                "pair": pair_panels}[kind_of(run)](run)]
    figure, axes = plt.subplots(1, len(panels), figsize=(3.2 * len(panels), 3), squeeze=False,
                                constrained_layout=True)
    for axis, (x, y, xlabel, ylabel, title) in zip(axes[0], panels):
        axis.plot(x, y, "." if len(x) < 30 else "-", color=BLUE)
        log_axis(axis, xlabel, ylabel, title)
    save(figure, run / "figures", "bases.png")


def draw_contact_field(figure, axis, points, cells, values, colours, limits, title, label):
    filled = axis.tripcolor(points[:, 0], points[:, 1], cells, values, shading="gouraud",
                            cmap=colours, vmin=limits[0], vmax=limits[1], rasterized=True)
    label_plane(axis)
    axis.set_title(title, loc="left")
    figure.colorbar(filled, ax=axis, shrink=0.8, format="%.3g", label=label)


def contact_cells(run):
    """Triangles of the contact region; nothing for contact along curves."""
    with h5py.File(run / "model.h5", "r") as model:
        region = model["interfaces/0/sizes"][3] == 3 and model["interfaces/0/edges"].size == 0
        cells = model["interfaces/0/entities"][()] if region else np.zeros(0, int)
        return cells.reshape(-1, 3)


def worst_parameters(run, data):
    """"radius = 0.85 m, ..." of a table with one mu."""
    return ", ".join(f"{name.replace('_', ' ')} {data[name][0]:.4g} {unit}".strip()
                     for name, unit in free_parameters(run))


def pressure_curve(data):
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), constrained_layout=True)
    parts = [("", "pressure", BLUE)]
    if "reduced_tangential" in data.dtype.names:
        parts.append(("_tangential", "tangential stress", GREEN))
    for suffix, name, colour in parts:
        truth, reduced = data["high_fidelity" + suffix], data["reduced" + suffix]
        axes[0].plot(data["x"], truth, color=GREY, linewidth=3, alpha=0.6,
                     label=None if suffix else "high-fidelity")
        axes[0].plot(data["x"], reduced, color=colour, label="reduced " + name)
        axes[1].plot(data["x"], reduced - truth, color=colour, label=name)
    axes[0].set_title("worst of the validation set", loc="left")
    axes[1].set_title("reduced minus high-fidelity", loc="left")
    for axis, label in zip(axes, ("stress (Pa)", "error (Pa)")):
        axis.set_xlabel("x, reference domain (m)")
        axis.set_ylabel(label)
        axis.legend(loc="upper right")
    return figure


def pressure_field(data, cells):
    points = np.column_stack([data["x"], data["y"]])
    error = data["reduced"] - data["high_fidelity"]
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), constrained_layout=True)
    top, bound = data["high_fidelity"].max(), max(np.abs(error).max(), 1e-16)
    draw_contact_field(figure, axes[0], points, cells, data["reduced"], "Blues", (0, top),
                       "reduced, on the reference domain", "pressure (Pa)")
    draw_contact_field(figure, axes[1], points, cells, error, "RdBu_r", (-bound, bound),
                       "error, worst of the validation set", "error of the pressure (Pa)")
    return figure


def pressure(run):
    """Pressure and its error at the validation parameter where the error is largest."""
    data, cells = table(run, "worst_pressure.csv"), contact_cells(run)
    figure = pressure_field(data, cells) if len(cells) else pressure_curve(data)
    figure.suptitle(worst_parameters(run, data), fontsize=8, color=GREY)
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
    if kind_of(run) != "pair" and not (run / "verify" / "infsup.csv").is_file():
        return  # of a support verify makes them for the collocated reduction alone
    beta, steps = table(run, "infsup.csv"), table(run, "stability.csv")
    x, xlabel = validation_axis(run, beta)
    order = np.argsort(beta["beta_on"] if x is None else x)
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), constrained_layout=True)
    curves = (("beta_hf", r"$\beta_{HF}$ high-fidelity", GREY, "-"),
              ("beta_on", r"$\beta_{on}$ online-enriched", GREEN, "-"),
              ("beta_off", r"$\beta_{off}$ offline-enriched", BLUE, "--"),
              ("beta_dec", r"$\beta_{dec}$ decorrelated", ORANGE, ":"))
    for column, label, colour, style in curves:
        axes[0].plot(np.arange(len(order)) if x is None else x[order], beta[column][order], style,
                     color=colour, label=label)
    log_axis(axes[0], xlabel, "inf-sup constant over the span (-)",
             "stability over the validation set")
    axes[0].legend()
    mark = "." if len(steps) < 30 else ""
    for column, label, colour, style in (
            ("sigma_max", r"largest $\sigma$", ORANGE, "-"),
            ("ratio_min", r"smallest $\beta_{off}/\beta_{on}$", BLUE, "-"),
            ("bound_min", r"bound $\sqrt{1-\sigma^2}$", GREEN, "--")):
        axes[1].plot(steps["S"], steps[column], style, marker=mark, color=colour, label=label)
    positive = steps["classic_min"] > 0
    axes[1].plot(steps["S"][positive], steps["classic_min"][positive], "x", color=PURPLE,
                 label="bound (2.24), where positive")
    log_axis(axes[1], "supremizers S'", "sigma, ratios of inf-sup constants (-)",
             "along the supremizers")
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
    if len(np.unique(data["R"])) == 1:
        dual = "normal stress" if kind_of(run) == "nitsche" else "multiplier"
        for axis, field, title in zip(axes, ("u", "lambda"), ("displacement u", dual)):
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
    axis.set_ylabel("largest aspect ratio (-)")
    axis.set_title("quality of the mapped mesh", loc="left")
    axis.legend()
    save(figure, run / "figures", "mesh_quality.png")


def validation_axis(run, data):
    """Where each validation parameter is drawn, and the label: the free parameter where there is
    one; None, for sorted errors, where there are several."""
    parameters = free_parameters(run)
    if len(parameters) > 1:
        return None, "validation parameters, sorted"
    name, unit = parameters[0]
    return data[name], with_unit(name.replace("_", " "), unit)


def draw_errors(axis, x, values, label, colour, style):
    """Against x in its order, or sorted; how many are missing is said."""
    known = np.isfinite(values)
    label += f", {np.sum(~known)} without an answer" if np.any(~known) else ""
    if x is None:
        axis.plot(np.sort(values[known]), style, color=colour, label=label)
    else:
        order = np.argsort(x[known])
        axis.plot(x[known][order], values[known][order], style, marker=".", color=colour,
                  label=label)


def errors(run):
    """Errors of the reduced answers over the validation set."""
    data = table(run, "errors.csv")
    x, xlabel = validation_axis(run, data)
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), constrained_layout=True)
    kind = kind_of(run)
    curves = [("_enriched", "with supremizers" if kind == "pair" else "reduced answers", BLUE, "-"),
              ("_floor", "projection on the basis", "black", ":")]
    if kind == "pair":
        curves.insert(0, ("_decorrelated", "without supremizers", ORANGE, "--"))
    dual = "normal stress" if kind == "nitsche" else "multiplier"
    for axis, field, title in zip(axes, ("u", "lambda"), ("displacement u", dual)):
        for suffix, label, colour, style in curves:
            draw_errors(axis, x, data[field + suffix], label, colour, style)
        log_axis(axis, xlabel, "relative error", title)
    if "tangential_enriched" in data.dtype.names:
        draw_errors(axes[1], x, data["tangential_enriched"], "tangential part", GREEN, "-")
    for axis in axes:
        axis.legend()
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
    for draw in (solution, bases, pressure, infsup, error_map, mesh_quality, errors, bench):
        try:
            draw(run)
        except Missing as missing:
            print(f"figures.py: {draw.__name__}: {missing}", file=sys.stderr)
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
