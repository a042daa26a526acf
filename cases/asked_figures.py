"""Figures of answers that the model of a run is asked for: an output over two parameters, Sobol's indices of
outputs, stresses over the contacts at chosen parameters."""

import argparse
import importlib.util
import json
import os
import shutil
import subprocess
import tempfile
from functools import partial
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np

from figure_tools import BLUE, GREEN, GREY, ORANGE, PURPLE, Missing, model_of, text_rows, texts_in, with_unit, wider
from model_figures import behind, has_areas, profile, profile_panel
from panels import Drawn, colour_bar, legend_below, save_panels
from solution_figures import solution_panels

HERE = Path(__file__).resolve().parent
POINTS = 41     # of a map, along each of its parameters
RANDOM = 4096   # points for each parameter, and twice more, of Sobol's indices
MOST = 100      # samples whose stresses are drawn
COLOURS = (BLUE, GREEN, ORANGE, PURPLE, GREY)


def of_package(name):
    """A module of the Python package that needs nothing of the rest, which loads the library."""
    folders = (HERE.parent / "src/python/rbvi", HERE.parents[2] / "lib/python3/dist-packages/rbvi")
    file = next((folder / f"{name}.py" for folder in folders if folder.is_dir()), None)
    if file is None:
        raise Missing(f"the Python package is in none of {', '.join(map(str, folders))}")
    spec = importlib.util.spec_from_file_location(f"rbvi{name}", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def program():
    """The file of rbvi-online: that of a variable, of a build or an install that this file is in, of PATH."""
    known = os.environ.get("RBVI_ONLINE") or next(
        (str(file) for file in (HERE.parent / "build/bin/rbvi-online", HERE.parents[2] / "bin/rbvi-online")
         if file.is_file()), shutil.which("rbvi-online"))
    if known is None:
        raise Missing("rbvi-online is not found: put it on PATH, or set RBVI_ONLINE to its file")
    return known


class Parameter(NamedTuple):
    unit: str
    lower: float
    upper: float


def box_of(run):
    """The free parameters of a model by name."""
    with h5py.File(model_of(run), "r") as model:
        names, units = (texts_in(model, "parameters/" + what) for what in ("names", "units"))
        lower, upper, free = (np.ravel(model["parameters/" + what][()]) for what in ("lower", "upper", "free"))
        return {names[i]: Parameter(units[i], float(lower[i]), float(upper[i])) for i in free.astype(int)}


def training_of(run):
    """The samples of the training set, rows of the free parameters."""
    with h5py.File(model_of(run), "r") as model:
        return model["training/mu"][()].T


def ask(run, *options):
    """What rbvi-online prints; what it refuses is Missing. Queries without an answer are no failure."""
    done = subprocess.run([program(), str(model_of(run)), *map(str, options)], capture_output=True, text=True,
                          check=False)
    if done.returncode not in (0, 1) or (done.returncode == 1 and "column status" not in done.stderr):
        raise Missing(done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "rbvi-online failed")
    return done.stdout


def answers(run, rows, *options):
    """Rows of the table of answers at these rows of the free parameters, as text by column."""
    with tempfile.TemporaryDirectory() as folder:
        queries, table = Path(folder) / "mu.csv", Path(folder) / "answers.csv"
        np.savetxt(queries, rows, "%.17g", ",", header=",".join(box_of(run)), comments="")
        ask(run, "--queries", queries, "--out", table, "--precision", 17, "--threads", os.cpu_count(), *options)
        return text_rows(table)


def column(table, name):
    return np.array([float(row[name] or "nan") for row in table])


def units_of(run, box):
    """Output -> its unit."""
    middle = ",".join(f"{name}={(one.lower + one.upper) / 2!r}" for name, one in box.items())
    return {name: of["unit"] for name, of in json.loads(ask(run, "--mu", middle, "--json"))["outputs"].items()}


def refuse_unknown(name, known, what):
    if name not in known:
        raise Missing(f"the model has no {what} {name}; it has {', '.join(known)}")


def values_of(text, box):
    """Values of all parameters from "radius=0.8,friction=0.2": those that are left out are in the middle."""
    values = {name: (one.lower + one.upper) / 2 for name, one in box.items()}
    for part in filter(None, text.split(",")):
        name, is_one, number = part.partition("=")
        refuse_unknown(name.strip(), box, "free parameter")
        try:
            values[name.strip()] = float(number)
        except ValueError:
            raise Missing(f"'{part}' has no number behind '='" if is_one else f"'{part}' is not NAME=VALUE") from None
    return values


def said(values, box):
    return ",  ".join(f"{name.replace('_', ' ')} {value:.4g} {box[name].unit}".strip()
                      for name, value in values.items())


def map_panel(run, output, over, fixed):
    """A panel of an output over two parameters, `fixed` all values, and what to say beside it."""
    drawing, box = of_package("_drawing"), box_of(run)
    for name in over:
        refuse_unknown(name, box, "free parameter")
    if over[0] == over[1]:
        raise Missing("a map is over two parameters")
    units = units_of(run, box)
    refuse_unknown(output, units, "output")
    right, up = drawing.grid_of([box[name][1:] for name in over], POINTS)
    rows = np.tile([fixed[name] for name in box], (len(right), 1))
    for name, values in zip(over, (right, up)):
        rows[:, list(box).index(name)] = values
    states = [name for name in drawing.STATES if name in units]
    table = answers(run, rows, "--only", ",".join(dict.fromkeys((output, *states))))
    missing = np.count_nonzero([row["status"] != "ok" for row in table])
    if missing == len(table):
        raise Missing(f"there is no answer on this map: {table[0]['status']}")
    others = {name: value for name, value in fixed.items() if name not in over}
    at = training_of(run)[:, [list(box).index(name) for name in over]]

    def draw(figure, axis):
        filled = drawing.draw_map(axis, right, up, column(table, output))
        handles = drawing.draw_states(axis, right, up, {name: column(table, name) for name in states})
        handles += drawing.draw_samples(axis, at, ", ".join(others).replace("_", " "))
        axis.grid(False)
        axis.locator_params(nbins=4)
        axis.set(**{label: with_unit(name.replace("_", " "), box[name].unit) for label, name in
                    zip(("xlabel", "ylabel"), over)})
        label = output.replace("_", " ")
        colour_bar(figure, axis, filled, f"{label} ({units[output]})" if units[output] else label, 1)
        legend_below(axis, handles + drawing.blank(missing, len(table)))

    return Drawn(output.replace("_", " "), draw, ratio=0.9), said(others, box)


def output_map(output, over, at, run):
    """An output over two parameters, the others as given or in the middle of the box."""
    panel, words = map_panel(run, output, over, values_of(at, box_of(run)))
    return save_panels(run / "figures", f"map_{output}.png", [panel], words)


def sensitivity_of(run, outputs):
    box = box_of(run)
    units = units_of(run, box)
    for name in outputs:
        refuse_unknown(name, units, "output")

    def evaluate(rows):
        table = answers(run, rows, "--only", ",".join(outputs))
        wrong = [row["status"] for row in table if row["status"] != "ok"]
        if wrong:
            raise Missing(f"{len(wrong)} of {len(table)} points have no answer; the first: {wrong[0]}")
        return np.column_stack([column(table, name) for name in outputs])

    return of_package("_sensitivity").Sensitivity(evaluate, {name: one[1:] for name, one in box.items()}, outputs,
                                                  RANDOM, 1)


def index_panel(of):
    """A panel of bars of both indices of each output."""
    def draw(_, axis):
        handles = of_package("_drawing").draw_bars(axis, of)
        axis.set_axisbelow(True)
        axis.grid(False, axis="x")
        legend_below(axis, handles)

    return Drawn("Sobol's indices", draw, ratio=0.75)


def sobol(outputs, run):
    """Sobol's indices of outputs: the share of their variance that goes with each parameter."""
    of = sensitivity_of(run, outputs)
    print(of)
    return save_panels(run / "figures", "sobol.png", [index_panel(of)],
                       "dark: of the parameter alone; light: in total; lines: two standard deviations")


def traces(run, rows):
    """The table of answers along the contacts, and that of the answers."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "contact.csv"
        table = answers(run, rows, "--contact", file)
        return text_rows(file), table


def curve_panels(run, chosen):
    """A panel for each contact along a curve: stresses at the chosen parameters, words -> values, before those
    at training samples."""
    training = training_of(run)
    training = training[np.linspace(0, len(training) - 1, min(MOST, len(training))).astype(int)]
    along, table = traces(run, np.vstack([*(list(values.values()) for values in chosen.values()), training]))
    for words, row in zip(chosen, table):
        if row["status"] != "ok":
            raise Missing(f"at {words}: {row['status']}")
    parts = {}
    for row in along:
        parts.setdefault(row["contact"], {}).setdefault(int(row["row"]) - 1, []).append(row)
    panels = []
    for name, of_rows in parts.items():
        curves, before = [], []
        for k, part in sorted(of_rows.items()):
            x, over = wider(np.column_stack([column(part, "x"), column(part, "y")]))
            if k >= len(chosen):
                before.append((x, column(part, "pressure")))
                continue
            tangential = np.nan_to_num(column(part, "tangential_stress")) if "tangential_stress" in part[0] else 0 * x
            curves += profile(x, column(part, "pressure"), tangential, list(chosen)[k], COLOURS[k % len(COLOURS)])
        panels.append(profile_panel(name, over + ", undeformed", [*behind(before), *curves]))
    return panels


def area_panels(run, chosen):
    """A panel for each contact over an area and each of the chosen parameters, in the same colours."""
    panels = []
    for k, values in enumerate(chosen.values(), 1):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "u.vtu"
            ask(run, "--mu", ",".join(f"{name}={value!r}" for name, value in values.items()), "--vtu", path)
            for panel in solution_panels(path)[1:]:
                panel.title = f"at {k}: {panel.title}"
                panels.append(panel)
    top = max(panel.limits[1] for panel in panels)
    for panel in panels:
        panel.limits = (0, top)
    return panels


def profiles(at, run):
    """Stresses over each contact at chosen parameters; those that a choice leaves out are in the middle."""
    box = box_of(run)
    chosen = {said(values, box): values for values in (values_of(text, box) for text in at)}
    areas = has_areas(run)
    panels = (area_panels if areas else curve_panels)(run, chosen)
    words = [f"{k}: {words}" for k, words in enumerate(chosen, 1)] if areas else []
    return save_panels(run / "figures", "stresses_at.png", panels, "\n".join(words))


def options_of(arguments):
    """Of the program figures.py."""
    parser = argparse.ArgumentParser("figures.py", usage=(
        "figures.py RUN_DIR [--map OUTPUT X Y] [--sobol OUTPUT ...] [--at NAME=VALUE,... ...] | DIR/u.vtu | "
        "RUN_DIR RUN_DIR ..."))
    parser.add_argument("runs", nargs="+", type=Path)
    parser.add_argument("--map", nargs=3)
    parser.add_argument("--sobol", nargs="+", default=[])
    parser.add_argument("--at", action="append", default=[])
    given = parser.parse_args(arguments)
    asks = given.map or given.sobol or given.at
    if asks and (len(given.runs) > 1 or given.runs[0].suffix == ".vtu"):
        parser.error("one run directory is asked")
    if given.map and len(given.at) > 1:
        parser.error("a map has its other parameters at one place")
    return given


def asked(given):
    """The figures that options ask for, functions of a run."""
    drawn = [partial(output_map, given.map[0], given.map[1:], "".join(given.at))] if given.map else []
    drawn += [partial(sobol, list(dict.fromkeys(given.sobol)))] if given.sobol else []
    return drawn + ([partial(profiles, given.at)] if given.at and not given.map else [])
