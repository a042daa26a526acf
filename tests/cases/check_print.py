#!/usr/bin/env python3
"""check_print.py RUNS: what figures look like in a column of 88 mm, by matplotlib's own boxes.

RUNS is of tests/docs/small_runs.py. Text has 6 points or more, no two texts overlap, none is cut, no
axes are empty, and labels of physical quantities have their unit. One run of each kind is drawn,
and all of them side by side, and the picture of the bench page of one.
"""

import sys
from itertools import combinations
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "cases"), str(ROOT / "tests/docs"), str(ROOT / "tests/bench")]

import figure_tools
import figures
import overview
from matplotlib.text import Text
from figure_tools import declared_units
from panels import figure_of
from small_runs import CHECKED, HAS_SOLIDS

COLUMN = 88 / 25.4  # inches
LEAST = 6           # points
TOUCH = 1           # pixels that boxes of letters may share
RUNS = ("membrane", "two_disks", "disk_condensed", "disk_large_cone", "nitsche_interpolated", "roller", "free_block",
        *(["solid"] if HAS_SOLIDS else []))
COUNTS = ("number", "part of the range", "modes", "functions", "nodes", "points", "terms", "supremizers",
          "contact measure")


def tick_texts(axis):
    """Labels of ticks that are drawn, and all that can be."""
    drawn, all_of = [], []
    for line in (axis.xaxis, axis.yaxis, *([axis.zaxis] if axis.name == "3d" else [])):
        low, high = sorted(line.get_view_interval())
        margin = 1e-9 * abs(low)
        for tick in line.get_major_ticks() + line.get_minor_ticks():
            all_of += [tick.label1, tick.label2]
            if low - margin <= tick.get_loc() <= high + margin:
                drawn += [tick.label1, tick.label2]
    return drawn, all_of


def texts_of(figure):
    left_out = set()
    for axis in figure.findobj(figure_tools.plt.Axes):
        drawn, all_of = tick_texts(axis)
        left_out |= {id(text) for text in all_of} - {id(text) for text in drawn}
    return [text for text in figure.findobj(Text)
            if text.get_visible() and text.get_text().strip() and id(text) not in left_out]


def overlaps(one, other):
    wide = min(one.x1, other.x1) - max(one.x0, other.x0)
    high = min(one.y1, other.y1) - max(one.y0, other.y0)
    return wide > TOUCH and high > TOUCH


def has_data(axis):
    return bool(axis.lines or axis.collections or axis.images or axis.patches)


def wrong_units(axis):
    """Labels without "(unit)" but for numbers of things."""
    labels = (axis.get_xlabel(), axis.get_ylabel())
    return [label for label in labels if label and not label.replace("\n", " ").endswith(")")
            and not any(count in label for count in COUNTS)]


def declares_units(run):
    """Of the case of a model; of rbvi check all cases here do."""
    return not (run / "model.h5").is_file() or bool(declared_units(run))


def problems(figure, units):
    """A line for each thing that a printed page would show."""
    figure.draw_without_rendering()
    renderer = figure.canvas.get_renderer()
    width = figure.get_tightbbox(renderer).width
    texts = texts_of(figure)
    found = [f"{text.get_text()!r} has {text.get_fontsize() * COLUMN / width:.1f} points" for text in texts
             if text.get_fontsize() * min(1, COLUMN / width) < LEAST - 0.05]
    boxes = [Text.get_window_extent(text, renderer) for text in texts]
    found += [f"{texts[i].get_text()!r} lies over {texts[j].get_text()!r}"
              for i, j in combinations(range(len(texts)), 2) if overlaps(boxes[i], boxes[j])]
    whole = figure.get_tightbbox(renderer)
    found += [f"{texts[k].get_text()!r} is cut" for k, box in enumerate(boxes)
              if box.x0 < figure.dpi * whole.x0 - TOUCH or box.x1 > figure.dpi * whole.x1 + TOUCH]
    found += [f"axes without data: {axis.get_title(loc='left')!r}" for axis in figure.axes if not has_data(axis)]
    return found + [f"no unit: {label!r}" for axis in figure.axes for label in wrong_units(axis) if units]


def overview_of(run):
    """The picture of the bench page, of a run that rbvi bench measured; and what its marks lack."""
    rows = [row for row in overview.rows_of(run / "bench/table.csv") if row["outputs_max"]]
    which = next(one for one in overview.RUNS if one.scene == run.name)
    points = overview.points_of({which: (rows, "", [(1, 1e-3), (8, 1e-4)])})
    panel = overview.panel(run.name, points)
    marks = sum(len(curve.y) for curve in panel.curves if curve.style not in ("-", "x:"))
    front = panel.curves[-1].y
    lacks = [] if marks == len(rows) > 5 and all(later <= before for before, later in zip(front, front[1:])) else [
        f"overview of {run.name}: {marks} marks of {len(rows)} rows, front {front}"]
    return figure_of([panel])[0], lacks


def main(runs):
    wrong, count = [], 0

    def measure(figure, path):
        nonlocal count
        count += 1
        run = path.parent.parent
        wrong.extend(f"{run.name}/{path.name}: {line}" for line in problems(figure, declares_units(run)))

    figure_tools.write = measure
    for run in [*(runs / name for name in RUNS), *(runs / "checks" / name / "u.vtu" for name in CHECKED)]:
        figures.main([str(run)])
    figures.main([str(runs / name) for name in RUNS])
    figure, lacks = overview_of(runs / "two_disks")
    measure(figure, runs / "two_disks/figures/overview.png")
    wrong += lacks
    print("\n".join(wrong) or f"{count} figures can be printed")
    return 1 if wrong or count < 40 else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
