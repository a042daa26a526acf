"""Figures of a model over two parameters, and of its sensitivities, for a column of 88 mm."""

from contextlib import nullcontext

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import MaxNLocator

from ._drawing import STATES, blank, draw_bars, draw_map, draw_samples, draw_states, grid_of
from ._library import NoAnswer

COLUMN = 3.46  # inches
STYLE = {"font.size": 8, "axes.titlesize": 8, "legend.fontsize": 7, "legend.frameon": False}


def said(name, unit=""):
    """A name as a label."""
    words = name.replace("_", " ")
    return f"{words} ({unit})" if unit else words


def new_axes(axes, height):
    """The style and the axes of a figure of its own, or these ones with theirs."""
    if axes is not None:
        return nullcontext(), lambda: axes
    return plt.rc_context(STYLE), lambda: plt.subplots(figsize=(COLUMN, height), layout="constrained")[1]


def parameter_map(model, output, over, samples, count, axes, others):
    """Colours and contours of an output over two parameters, the others as given; `samples`: points as
    rows of all parameters."""
    x, y = (model.parameters[name] for name in over)
    right, up = grid_of([(one.lower, one.upper) for one in (x, y)], count)
    table = model.table({**others, x.name: right, y.name: up})
    if not table.ok.any():
        raise NoAnswer(f"there is no answer on this map: {table.status[0]}")
    style, make = new_axes(axes, 3.1)
    with style:
        axes = make()
        filled = draw_map(axes, right, up, table[output])
        handles = draw_states(axes, right, up, {name: table[name] for name in STATES if name in model.outputs})
        bar = axes.figure.colorbar(filled, ax=axes, location="right", label=said(output, model.outputs[output].unit))
        bar.locator = MaxNLocator(5)
        bar.update_ticks()
        names = list(model.parameters)
        hidden = ", ".join(said(name) for name in names if name not in over)
        if samples is not None and len(samples):
            at = np.asarray(samples, float)[:, [names.index(one.name) for one in (x, y)]]
            handles += draw_samples(axes, at, hidden)
        handles += blank(np.count_nonzero(~table.ok), len(table))
        axes.set(xlabel=said(x.name, x.unit or "-"), ylabel=said(y.name, y.unit or "-"))
        axes.xaxis.set_major_locator(MaxNLocator(5))
        axes.yaxis.set_major_locator(MaxNLocator(5))
        fixed = [f"{said(name)} {float(others.get(name, one.value)):.3g} {one.unit}".strip()
                 for name, one in model.parameters.items() if name not in over]
        axes.set_title(", ".join(fixed), loc="left")
        if handles:
            axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(0, -0.22), borderaxespad=0, frameon=False)
    return axes


def bars(of, axes):
    """Bars of the indices of a Sensitivity."""
    style, make = new_axes(axes, 2.6)
    with style:
        axes = make()
        handles = draw_bars(axes, of)
        axes.set_title("dark: alone; light: in total, +- 2 deviations", loc="left")
        axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(0, -0.24), borderaxespad=0,
                    ncols=min(3, len(handles)), frameon=False)
    return axes
