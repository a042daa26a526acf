#!/usr/bin/env python3
"""Figures of a run: figures.py RUN_DIR writes PNG and PDF files into RUN_DIR/figures; figures.py
DIR/u.vtu draws that answer alone, into DIR/figures; figures.py RUN RUN ... draws the errors of
several runs that were verified over time and size, into figures beside them. Figures of answers that
rbvi-online gives, into RUN_DIR/figures:

figures.py RUN_DIR --map OUTPUT X Y [--at NAME=VALUE,...]   an output over two parameters, with lines
                              where contact states change, the others as given or in the middle
figures.py RUN_DIR --sobol OUTPUT ...                       Sobol's indices of outputs
figures.py RUN_DIR --at NAME=VALUE,... [--at ...]           stresses over the contacts there

Reads RUN_DIR/model.h5 and samples.csv (rbvi offline), RUN_DIR/verify/*.csv (rbvi verify),
RUN_DIR/u.vtu with the contact files beside it (rbvi-online --vtu, or rbvi solve -vtu; of rbvi check
-vtu also its mesh and the partners of its contacts), without it that of rbvi verify at the middle
of the box, and, if it is there, RUN_DIR/bench/table.csv (rbvi bench). What else is missing, and what
cannot be drawn, is named and left out; the exit status is then 1.
"""

import sys
from pathlib import Path

import h5py
import numpy as np

from asked_figures import asked, options_of
from bench_figures import bench
from case_figures import case
from compare_figures import compare
from figure_tools import (BLUE, GREEN, GREY, ORANGE, PURPLE, Missing, contact_names, free_parameters,
                          history, in_length, in_stress, model_of, plt, table, use_units, wider,
                          with_unit)
from model_figures import contact_regions, outputs, stresses
from panels import ROUND_OFF, ZERO, Curve, Lines, save_panels
from solution_figures import solution

COLLOCATED = 3  # of law/reduction in model.h5


def kind_of(run):
    """What the model reduces: a "pair" of bases, the "law" at nodes, or the curve of
    "nitsche"."""
    with h5py.File(model_of(run), "r") as model:
        if int(np.ravel(model["nitsche/rule"][()])[0]) >= 0:
            return "nitsche"
        return "law" if int(np.ravel(model["law/normal"][()])[0]) > 0 else "pair"


def convergence(title, xlabel, ylabel, *curves):
    """A logarithmic panel of (x, y, label, colour): marks where they are few."""
    return Lines(title, xlabel, ylabel,
                 [Curve(x, y, label, colour, ".-" if len(x) < 30 else "-")
                  for x, y, label, colour in curves], log=True)


def along_size(title, xlabel, ylabel, error):
    """Errors with 0, 1, ... functions, to round-off; nothing where there are none."""
    error = error[error > ZERO]
    return [convergence(title, xlabel, ylabel, (np.arange(len(error)), error, "", BLUE))
            ] if len(error) > 0 else []


def nitsche_panels(run):
    """How the integrals over the contact curve are reduced, if they are."""
    with h5py.File(run / "model.h5", "r") as model:
        curve = {name: error[()].ravel() for name, error in model["histories/values/curve"].items()}
    panels = []
    if len(curve["points"]) > 0:
        panels.append(convergence("integrals over the contact curve", "Gauss points that are kept",
                                  "error that they add to u (-)",
                                  (curve["points"], curve["error"], "", BLUE)))
    terms = []
    for name, label, colour in (("contact_matrix", "contact, tangent", BLUE),
                                ("contact_vector", "contact, residual", GREEN),
                                ("friction_matrix", "friction, tangent", ORANGE),
                                ("friction_vector", "friction, residual", PURPLE)):
        error = curve.get(name, np.zeros(0))
        error = error[error > ZERO]
        if len(error) > 0:
            terms.append((np.arange(len(error)), error, label, colour))
    if terms:
        panels.append(convergence("interpolated terms of Newton's method", "terms",
                                  "largest relative error (-)", *terms))
    return panels


def law_panels(run):
    """What a model with the law of contact at the nodes was made from, beside its modes."""
    with h5py.File(run / "model.h5", "r") as model:
        collocated = "gcns" in model["histories/values"]
    panels = [*along_size("normal stress in its cone", "functions of the cone",
                          "largest relative error (-)", history(run, "normal_cone/error")),
              *along_size("modes of the tangential stress", "modes", "relative error (-)",
                          history(run, "tangential/error"))]
    if collocated:
        panels.append(convergence("friction bound at chosen nodes (e_GCNS)", "nodes",
                                  "relative error (-)", (history(run, "gcns/nodes"),
                                                         history(run, "gcns/error"), "", BLUE)))
    return panels


def pair_panels(run):
    """The dual basis of a reduced pair."""
    size, error = history(run, "cone/size"), history(run, "cone/error")
    orthogonality, condition = history(run, "cone/e_orth"), history(run, "cone/gram_condition")
    functions = "functions of the dual basis R"
    panels = [convergence("pressure in the dual basis", functions, "largest relative error (-)",
                          (size, error, "", BLUE))]
    if len(orthogonality) > 0:
        panels.append(convergence("new functions of the dual basis (e_orth)", functions,
                                  "distance to those before (-)",
                                  (size[1:], orthogonality, "", BLUE)))
    panels.append(convergence("condition of the dual basis", functions,
                              "of its Gram matrix (-)", (size[1:], condition, "", BLUE)))
    return panels


def bases_panels(run):
    return [*along_size("displacement in its modes", "modes N", "relative error, POD (-)",
                        history(run, "pod/error")),
            *{"nitsche": nitsche_panels, "law": law_panels, "pair": pair_panels}[kind_of(run)](run)]


def bases(run):
    """How fast the two bases converge, and how well conditioned the dual one is."""
    return save_panels(run / "figures", "bases.png", bases_panels(run))


def worst_parameters(run, data):
    """"radius = 0.85 m, ..." of a table with one mu."""
    return ", ".join(f"{name.replace('_', ' ')} {data[column][0]:.4g} {unit}".strip()
                     for (name, unit), column in zip(free_parameters(run), data.dtype.names))


def of_peak(error, data):
    """"..., at most 1e-5 of the peak" for the title of an error."""
    peak = np.abs(data["high_fidelity"]).max()
    return f", at most {np.abs(error).max() / peak:.0e} of the peak" if peak > 0 else ""


def pressure_curves(data, which):
    """Stresses along one contact curve, and their errors."""
    over, name = wider(np.column_stack([data["x"], data["y"]]))
    data, over = data[np.argsort(over)], np.sort(over)
    parts, errors, marks = [("", "pressure", BLUE)], [], []
    if "reduced_tangential" in data.dtype.names and np.any(data["high_fidelity_tangential"]):
        parts.append(("_tangential", "tangential stress", GREEN))
    for suffix, what, colour in parts:
        truth, reduced = data["high_fidelity" + suffix], data["reduced" + suffix]
        marks += [Curve(over, truth, "" if suffix else "high-fidelity", "#bbbbbb", width=5),
                  Curve(over, reduced, "reduced " + what, colour)]
        errors.append(Curve(over, reduced - truth, what, colour))
    largest = of_peak(np.concatenate([curve.y for curve in errors]), data)
    least = ZERO * np.abs(data["high_fidelity"]).max()
    x = in_length(name + ", reference domain")
    return [Lines("stress along the contact curve" + which, x, in_stress("stress"), marks),
            Lines("error" + which + largest, x, in_stress("reduced less high-fidelity"), errors,
                  least=least)]


def region_panels(region, data):
    """Stresses over an area, and their errors."""
    panels, pressed = [], data["high_fidelity"] > 0
    for suffix, what in (("", "pressure"), ("_tangential", "tangential stress")):
        if "reduced" + suffix not in data.dtype.names or not np.any(data["high_fidelity" + suffix]):
            continue
        truth, reduced = data["high_fidelity" + suffix], data["reduced" + suffix]
        error = reduced - truth
        bound = np.abs(error[region.rows]).max() or 1
        panels += [region.panel("reduced, reference domain", reduced, in_stress(what), (0, truth.max() or 1), pressed),
                   region.panel("error" + of_peak(error, data), error, in_stress("reduced less high-fidelity"),
                                (-bound, bound), pressed, colours="RdBu_r", least=ZERO * data["high_fidelity"].max())]
    return panels


def pressure_panels(run, data):
    regions = contact_regions(run, data)
    if not regions:
        numbers = np.unique(data["interface"]).astype(int)
        names = contact_names(run)
        return [panel for number in numbers for panel in pressure_curves(
            data[data["interface"] == number],
            ", " + names.get(number, f"contact {number}") if len(numbers) > 1 else "")]
    return [panel for region in regions for panel in region_panels(region, data)]


def pressure(run):
    """Pressure and its error at the validation parameter where the error is largest."""
    data = table(run, "worst_pressure.csv")
    return save_panels(run / "figures", "pressure.png", pressure_panels(run, data),
                       f"where the error over the validation set is largest: "
                       f"{worst_parameters(run, data)}")


def infsup_panels(run):
    """Inf-sup constants over the validation set, and what each supremizer brings."""
    beta, steps = table(run, "infsup.csv"), table(run, "stability.csv")
    x, xlabel = validation_axis(run, beta)
    order = np.argsort(beta["beta_on"] if x is None else x)
    place = np.arange(len(order)) + 1 if x is None else x[order]
    constants = [Curve(place, beta[column][order], label, colour, style)
                 for column, label, colour, style in (
                     ("beta_hf", r"$\beta_{HF}$, all functions", GREY, "-"),
                     ("beta_on", r"$\beta_{on}$, supremizers of each parameter", GREEN, "-"),
                     ("beta_off", r"$\beta_{off}$, supremizers of the model", BLUE, "--"),
                     ("beta_dec", r"$\beta_{dec}$, modes alone", ORANGE, ":"))]
    mark = "." if len(steps) < 30 else ""
    ratios = [Curve(steps["S"], steps[column], label, colour, mark + style)
              for column, label, colour, style in (
                  ("sigma_max", r"largest $\sigma$", ORANGE, "-"),
                  ("ratio_min", r"smallest $\beta_{off}/\beta_{on}$", BLUE, "-"),
                  ("bound_min", r"its bound $\sqrt{1-\sigma^2}$", GREEN, "--"))]
    if np.any(steps["classic_min"] > 0):
        ratios.append(Curve(steps["S"], np.where(steps["classic_min"] > 0, steps["classic_min"],
                                                 np.nan), "its bound (2.24)", PURPLE, "x"))
    return [Lines("stability over the validation set", xlabel, "inf-sup constant (-)", constants,
                  log=True, floor=1e-9 * beta["beta_hf"].max()),
            Lines("with more supremizers", "supremizers S", r"$\sigma$, ratios of constants (-)",
                  ratios, log=True, floor=1e-9)]


def infsup(run):
    if not (run / "verify" / "infsup.csv").is_file() and (kind_of(run) != "pair" or
                                                          (run / "verify" / "errors.csv").is_file()):
        return []  # without a pair of spaces there is no such constant; -verify_stability no
    return save_panels(run / "figures", "infsup.png", infsup_panels(run))


def family(data, error, along, across):
    """Mean error against `along`, one curve per value of `across`, over what the basis allows."""
    values = np.unique(data[across])
    shades = plt.get_cmap("viridis")(np.linspace(0, 0.85, len(values)))
    curves = []
    for value, shade in zip(values, shades):
        rows = np.sort(data[data[across] == value], order=along)
        curves.append(Curve(rows[along], rows[error + "_mean"], f"{across} = {value:.0f}", shade,
                            "o-"))
    sizes = np.unique(data[along])
    floor = [data[data[along] == size][error + "_floor_mean"].min() for size in sizes]
    return [*curves, Curve(sizes, floor, "projection on the basis", "black", ".:")]


def reduction_of(run):
    with h5py.File(model_of(run), "r") as model:
        return int(np.ravel(model["law/reduction"][()])[0])


def error_map_panels(run, data):
    """Error over (N, R), with what the bases alone would allow: of leading parts of the model, with
    all supremizers of each pair where b(mu) is a multiple of one form, else the modes alone; and of
    the whole model."""
    whole, kind = np.atleast_1d(table(run, "summary.csv"))[0], kind_of(run)
    beside = {"law": "displacements under unit loads", "pair": "supremizers", "nitsche": ""}[kind]
    if kind == "law" and reduction_of(run) == COLLOCATED:
        beside = "supremizers"
    if data["enriched"].max() > 0:
        how = f", with {beside}"
    else:
        how = f", without {beside}" if beside and whole["S"] > 0 else ""
    dual = {"nitsche": "normal stress"}.get(kind, "multipliers")
    panels = []
    for error, words, along, across in (("u", "displacement", "N", "R"),
                                        ("lambda", dual, "R", "N")):
        if len(np.unique(data["R"])) == 1:
            along, across = "N", "R"
        curves = family(data, error, along, across)
        if across == "R" and len(curves) == 2:
            curves[0].label = "first N modes"
        size = whole["R"] if along == "R" else whole["N"] + whole["S"]
        curves.append(Curve([size], [whole[error + "_mean"]], "the whole model", ORANGE, "D"))
        xlabel = {"N": "functions of the displacement", "R": "functions of the dual basis R"}[along]
        panels.append(Lines(words + how, xlabel, "mean relative error (-)", curves, log=True))
    return panels


def error_map(run):
    data = table(run, "error_map.csv")
    data = data[(data["enriched"] == data["enriched"].max()) & np.isfinite(data["u_mean"])]
    if len(data) < 2:
        print("error_map.png: left out, fewer than two pairs have all their answers")
        return []
    return save_panels(run / "figures", "error_map.png", error_map_panels(run, data))


def mesh_quality_panels(run):
    """Largest aspect ratio of the mapped mesh (Niakh 2022, figure 2.3)."""
    data = table(run, "mesh_quality.csv")
    curves = []
    for flag, label, colour, style in ((1, "training", BLUE, "-"), (0, "validation", ORANGE, "--")):
        values = np.sort(data["max_aspect_ratio"][data["training"] == flag])
        curves.append(Curve(np.linspace(0, 100, len(values)), values,
                            f"{label}, {len(values)} parameters", colour, style))
    with h5py.File(model_of(run), "r") as model:
        cell = "tetrahedron" if model["interfaces/0/points"].shape[1] == 3 else "triangle"
    return [Lines(f"worst {cell} of the mapped mesh", "share of the parameters, sorted (%)",
                  "largest aspect ratio (-)", curves)]


def mesh_quality(run):
    worst = table(run, "mesh_quality.csv")["max_aspect_ratio"]
    if np.ptp(worst) <= ROUND_OFF * worst.max():
        print(f"mesh_quality.png: left out, the largest aspect ratio is {worst.max():.3g} everywhere")
        return []
    return save_panels(run / "figures", "mesh_quality.png", mesh_quality_panels(run))


def validation_axis(run, data):
    """Where each validation parameter is drawn, and the label: the free parameter where there is
    one; None, for sorted errors, where there are several."""
    parameters = free_parameters(run)
    if len(parameters) > 1:
        return None, "validation parameters, sorted (number)"
    name, unit = parameters[0]
    return data[name], with_unit(name.replace("_", " "), unit)


def error_curve(x, values, label, colour, style):
    """Against x in its order, or sorted, those without an answer last."""
    if x is None:
        return Curve(np.arange(len(values)) + 1, np.sort(values), label, colour, style)
    order = np.argsort(x)
    return Curve(x[order], values[order], label, colour, "." + style)


def errors_panels(run):
    """Errors of the reduced answers over the validation set."""
    data, kind = table(run, "errors.csv"), kind_of(run)
    x, xlabel = validation_axis(run, data)
    curves = [("_enriched", "with supremizers" if kind == "pair" else "reduced answers", BLUE, "-"),
              ("_floor", "projection on the basis", "black", ":")]
    if kind == "pair":
        curves.insert(0, ("_decorrelated", "without supremizers", ORANGE, "--"))
    dual = "normal stress" if kind == "nitsche" else "multipliers"
    panels = [Lines(title, xlabel, "relative error (-)",
                    [error_curve(x, data[error + suffix], label, colour, style)
                     for suffix, label, colour, style in curves], log=True)
              for error, title in (("u", "displacement"), ("lambda", dual))]
    if "tangential_enriched" in data.dtype.names:
        panels[1].curves.append(error_curve(x, data["tangential_enriched"], "tangential part",
                                            GREEN, "-"))
    return panels


def errors(run):
    return save_panels(run / "figures", "errors.png", errors_panels(run))


def draw_all(figures, source):
    """The exit status: 1 if some cannot be drawn."""
    status = 0
    for draw in figures:
        try:
            problems = draw(source)
        except Missing as missing:
            problems = [str(missing)]
        except Exception as error:  # a file that is damaged does not keep the others from being drawn
            problems = [f"cannot be drawn: {error or type(error).__name__}"]
        for problem in problems:
            print(f"figures.py: {getattr(draw, 'func', draw).__name__}: {problem}", file=sys.stderr)
            status = 1
    return status


def main(arguments):
    given = options_of(arguments)
    if len(given.runs) > 1:
        return draw_all((compare,), given.runs)
    run = given.runs[0]
    if run.suffix == ".vtu":
        use_units(run)
        return draw_all((case, solution), run)
    if not run.is_dir():
        print(f"figures.py: there is no run directory {run}", file=sys.stderr)
        return 2
    use_units(run)
    if asked(given):
        return draw_all(asked(given), run)
    of_answer = draw_all((case, solution), next((run / place for place in ("u.vtu", "verify/u.vtu")
                                                 if (run / place).is_file()), run / "u.vtu"))
    return max(of_answer, draw_all((bases, outputs, stresses, pressure, infsup, error_map,
                                    mesh_quality, errors, bench), run))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
