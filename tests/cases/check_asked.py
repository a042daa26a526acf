#!/usr/bin/env python3
"""check_asked.py RUNS ONLINE: the figures of answers of cases/figures.py (--map, --sobol, --at), by the numbers
of their panels, and by the boxes of what is drawn.

RUNS is of tests/docs/small_runs.py, ONLINE the file of rbvi-online.
"""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "cases"), str(ROOT / "tests/docs"), str(ROOT / "tests")]

import asked_figures
import figure_tools
import figures
from check_figures import Checks, check_panels
from check_print import declares_units, problems
from figure_tools import use_units
from model_figures import has_areas, places_of
from small_runs import HAS_SOLIDS

RUNS = ("membrane", "two_disks", "disk_condensed", "disk_large", "nitsche_interpolated", "roller", "free_block",
        *(["solid"] if HAS_SOLIDS else []))


def check_map(check, run):
    """Colours and states are those of single answers."""
    box = asked_figures.box_of(run)
    over = list(box)[:2]
    fixed = asked_figures.values_of(f"{list(box)[-1]}={box[list(box)[-1]].lower}" if len(box) > 2 else "", box)
    panel, words = asked_figures.map_panel(run, "peak_pressure", over, fixed)
    check.that((len(box) > 2) == bool(words) and not any(name.replace("_", " ") in words for name in over),
               f"{run.name}: {words}")
    figure, axis = figure_tools.plt.subplots()
    panel.draw(figure, axis)
    ends = [(box[name].lower, box[name].upper) for name in over]
    check.that(np.allclose([axis.get_xlim(), axis.get_ylim()], ends), f"{run.name}: the map is not over the box")
    check.that(np.array_equal(np.column_stack(axis.lines[-1].get_data()), asked_figures.training_of(run)[:, :2]),
               f"{run.name}: samples on the map")
    black = [one for one in axis.collections if len(one.get_facecolor()) == 0 and one.get_paths()
             and np.allclose(one.get_edgecolor()[0][:3], 0)]
    means = []
    for one in black:
        at = np.concatenate([path.vertices for path in one.get_paths()])
        rows = np.column_stack([*at.T, *np.tile(list(fixed.values())[2:], (len(at), 1)).T])
        value = asked_figures.column(asked_figures.answers(run, rows), "peak_pressure")
        means.append((value.mean(), np.ptp(value)))
    steps = np.diff([mean for mean, _ in means])
    check.that(len(means) > 2 and np.all(steps > 0), f"{run.name}: contours {means}")
    figure_tools.plt.close(figure)


def check_indices(check, run):
    """The normal force of the block is press, whatever else is."""
    of = asked_figures.sensitivity_of(run, ["normal_force", "peak_pressure"])
    first, total, error = (kind["normal_force"] for kind in (of.first, of.total, of.total_error))
    check.that(abs(total["press"] - 1) < 5 * error["press"] < 0.1 and abs(first["press"] - 1) < 0.1, f"indices: {of}")
    check.that(all(abs(total[name]) < 1e-9 for name in ("pull", "friction")), f"indices: {of}")


def check_profiles(check, run):
    """Stresses in the middle of the box are those of rbvi verify; they stand before those of the samples."""
    box = asked_figures.box_of(run)
    name = list(box)[0]
    at = [asked_figures.values_of(text, box) for text in ("", f"{name}={box[name].lower}")]
    chosen = {asked_figures.said(values, box): values for values in at}
    middle = next(iter(places_of(run)[0].values()))
    if has_areas(run):
        panels = asked_figures.area_panels(run, chosen)
        values = panels[0].values
        check.that(len({panel.limits for panel in panels}) == 1, f"{run.name}: colours of different stresses")
    else:
        panels = asked_figures.curve_panels(run, chosen)
        values = np.concatenate([curve.y for panel in panels for curve in panel.curves if curve.label == list(chosen)[0]])
        for panel in panels:
            grey = [curve for curve in panel.curves if curve.width < 1]
            check.that(len(grey) == len(asked_figures.training_of(run)) and panel.curves[:len(grey)] == grey,
                       f"{run.name}: {len(grey)} samples behind")
    check.that(len(panels) == 2 * len(set(middle["interface"])) if has_areas(run) else
               len(panels) == len(set(middle["interface"])), f"{run.name}: {len(panels)} panels")
    check.that(np.isclose(values.max(), middle["pressure"].max(), rtol=1e-6), f"{run.name}: the pressure in the middle")
    check_panels(check, panels, f"{run.name}, stresses_at")


def check_commands(check, runs):
    """Each command writes its picture, which can be printed; what is wrong is told in a line."""
    wrong, drawn = [], []

    def measure(figure, path):
        drawn.append(path.name)
        run = path.parent.parent
        wrong.extend(f"{run.name}/{path.name}: {line}" for line in problems(figure, declares_units(run)))

    figure_tools.write, asked_figures.RANDOM = measure, 64
    for name in RUNS:
        box = asked_figures.box_of(runs / name)
        one, *more = [f"{own}={at.lower}" for own, at in box.items()]
        asks = [["--sobol", "normal_force", "peak_pressure"], ["--at", one, "--at", ",".join(more)]]
        asks += [["--map", "normal_force", *list(box)[:2], "--at", ",".join(more[1:])]] * (len(box) > 1)
        for ask in asks:
            check.that(figures.main([str(runs / name), *ask]) == 0, f"{name}: {ask}")
    for line in wrong:
        check.that(False, line)
    check.that(len(drawn) == 3 * len(RUNS) - 2, f"drawn: {drawn}")


def check_refusals(check, run):
    for words, status, told in (
            (["--map", "normal_forces", "top", "tilt"], 1, "output_map: the model has no output normal_forces"),
            (["--map", "energy", "top", "tip"], 1, "the model has no free parameter tip; it has top, tilt"),
            (["--map", "energy", "top", "top"], 1, "a map is over two parameters"),
            (["--map", "energy", "top", "tilt", "--at", "top=0.03", "--at", "top=0.04"], 2, "at one place"),
            (["--sobol", "force"], 1, "sobol: the model has no output force"),
            (["--at", "top"], 1, "'top' is not NAME=VALUE"), (["--at", "top=deep"], 1, "'top=deep' has no number"),
            (["--at", "top=9"], 1, "top = 9 is outside [0.02, 0.05]"), (["--depth", "1"], 2, "usage: figures.py RUN_DIR")):
        done = subprocess.run(["/usr/bin/python3", ROOT / "cases/figures.py", run, *words], capture_output=True,
                              text=True, check=False)
        check.that(done.returncode == status and told in done.stderr and "Traceback" not in done.stderr,
                   f"{words}: {done.returncode} {done.stderr}")


def main(runs, online):
    os.environ["RBVI_ONLINE"] = online
    check = Checks()
    for name in RUNS:
        use_units(runs / name)
        if len(asked_figures.box_of(runs / name)) > 1:
            check_map(check, runs / name)
        check_profiles(check, runs / name)
    check_indices(check, runs / "free_block")
    check_refusals(check, runs / "roller")
    check_commands(check, runs)
    print("\n".join(check.wrong) or f"{check.count} checks of {len(RUNS)} runs hold")
    return 1 if check.wrong else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2]))
