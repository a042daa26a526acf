"""Figures of a model over two parameters, and of its sensitivities, for a column of 88 mm."""

from contextlib import nullcontext

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from ._library import NoAnswer

COLUMN = 3.46  # inches
STYLE = {"font.size": 8, "axes.titlesize": 8, "legend.fontsize": 7, "legend.frameon": False}
ORANGE, COLOURS = "#D55E00", ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#666666")
BARS = 0.8     # of the way from one group of bars to the next


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
    grid = [np.linspace(one.lower, one.upper, count) for one in (x, y)]
    right, up = np.meshgrid(*grid)
    table = model.table({**others, x.name: right.ravel(), y.name: up.ravel()})
    if not table.ok.any():
        raise NoAnswer(f"there is no answer on this map: {table.status[0]}")
    values = np.ma.masked_invalid(table[output].reshape(right.shape))
    style, make = new_axes(axes, 3.1)
    with style:
        axes = make()
        # An output that is the same everywhere has no levels of its own.
        flat = np.ptp(values) <= 1e-9 * np.abs(values).max()
        levels = [values.min() - 1, values.max() + 1] if flat else 9
        filled = axes.contourf(right, up, values, levels=levels, cmap="YlGnBu")
        axes.contour(right, up, values, levels=filled.levels, colors="black", linewidths=0.4)
        bar = axes.figure.colorbar(filled, ax=axes, location="right", label=said(output, model.outputs[output].unit))
        bar.locator = MaxNLocator(5)
        bar.update_ticks()
        names, handles = list(model.parameters), []
        hidden = ", ".join(said(name) for name in names if name not in over)
        if samples is not None and len(samples):
            at = np.asarray(samples, float)[:, [names.index(one.name) for one in (x, y)]]
            handles += axes.plot(*at.T, "o", markersize=3.5, color=ORANGE, clip_on=False, markeredgecolor="white",
                                 markeredgewidth=0.4,
                                 label=f"{len(at)} samples" + (", of any " + hidden if hidden else ""))
        if not table.ok.all():
            handles.append(Patch(facecolor="white", edgecolor="grey", label="no answer at "
                                 f"{np.count_nonzero(~table.ok)} of {len(table)} points"))
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
    """Bars of the total indices of the outputs, in them those of the first order, with two standard deviations."""
    names = list(next(iter(of.first.values())))
    place, style_of = np.arange(len(of.first)), new_axes(axes, 2.6)
    with style_of[0]:
        axes = style_of[1]()
        width = BARS / len(names)
        for k, name in enumerate(names):
            at = place + (k - (len(names) - 1) / 2) * width
            first, total, error = (np.array([own[name] for own in kind.values()])
                                   for kind in (of.first, of.total, of.total_error))
            colour = COLOURS[k % len(COLOURS)]
            axes.bar(at, total, 0.9 * width, color=colour, alpha=0.35, linewidth=0)
            axes.bar(at, np.maximum(first, 0), 0.9 * width, color=colour, linewidth=0, label=said(name))
            axes.errorbar(at, total, 2 * error, fmt="none", ecolor="black", elinewidth=0.7, capsize=1.5)
        axes.set_xticks(place, [said(name).replace(" ", "\n") for name in of.first])
        axes.set(ylabel="Sobol index (-)", ylim=(0, None))
        axes.set_title("dark: alone; light: in total, +- 2 deviations", loc="left")
        axes.legend(loc="upper left", bbox_to_anchor=(0, -0.24), borderaxespad=0, ncols=min(3, len(names)),
                    frameon=False)
    return axes
