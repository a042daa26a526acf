"""Errors of several verified runs over the time of a query and over the size of their models."""

import os
from pathlib import Path

import numpy as np

from figure_tools import BLUE, GREEN, GREY, ORANGE, PURPLE, Missing, table, text_rows
from panels import Curve, Lines, save_panels

MARKS = [colour + mark for mark in "os^Dv" for colour in (BLUE, ORANGE, GREEN, PURPLE, GREY)]
KINDS = {"u_max": "displacement", "lambda_max": "multipliers", "outputs": "outputs, of their range"}


def numbers_of(run):
    """The largest errors of the whole model, the time of a query in ms and the functions of u."""
    whole = np.atleast_1d(table(run, "summary.csv"))[0]
    outputs = [float(row["max_of_range"]) for row in text_rows(run / "verify" / "outputs.csv")
               if row["kind"] == "quantity"]
    if "seconds_with_outputs" not in whole.dtype.names:
        raise Missing(f"{run}/verify is of an earlier version: run rbvi verify -out {run} again")
    return {"u_max": whole["u_max"], "lambda_max": whole["lambda_max"],
            "outputs": max(outputs, default=np.nan),
            "time": 1e3 * whole["seconds_with_outputs"], "size": whole["N"] + whole["S"]}


def names_of(runs):
    """As short as they differ."""
    paths = [Path(os.path.abspath(run)) for run in runs]
    common = os.path.commonpath([path.parent for path in paths])
    return Path(common), [str(path.relative_to(common)) for path in paths]


def compare_panels(runs):
    """A row for each kind of error, over time and over size; a mark for each run."""
    _, names = names_of(runs)
    numbers = [numbers_of(run) for run in runs]
    panels = []
    for kind, title in KINDS.items():
        if all(np.isnan(of[kind]) for of in numbers):
            continue
        for axis, label in (("time", "time of a query (ms)"), ("size", "functions of u (number)")):
            marks = [Curve(np.array([of[axis]]), np.array([of[kind]]), name, mark[:-1], mark[-1])
                     for of, name, mark in zip(numbers, names, MARKS)]
            panels.append(Lines(title, label, "largest relative error (-)", marks, log=True,
                                log_x=True, floor=0))
    return panels


def compare(runs):
    if len(runs) > len(MARKS):
        raise Missing(f"{len(runs)} runs are more than {len(MARKS)} marks can tell apart")
    folder, _ = names_of(runs)
    return save_panels(folder / "figures", "compare.png", compare_panels(runs))
