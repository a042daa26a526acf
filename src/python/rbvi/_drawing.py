"""What maps over two parameters and bars of Sobol's indices are drawn of: axes, numbers and names alone. The
figures of cases/ draw by these functions, too, without the rest of this package."""

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

ORANGE, PURPLE = "#D55E00", "#CC79A7"
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#666666")
BARS = 0.8                               # of the way from one group of bars to the next
STATES = ("contact_nodes", "stick_nodes")  # outputs that change where a node touches, lifts, sticks or slips
STEPS = 8                                # lines of an output at most, about


def grid_of(box, count):
    """Rows of points of a grid over two (lower, upper), the first the fastest."""
    right, up = np.meshgrid(*(np.linspace(*ends, count) for ends in box))
    return right.ravel(), up.ravel()


def square(values):
    """Values at the rows of a grid; those without an answer are masked."""
    values = np.ma.masked_invalid(values)
    return values.reshape((round(len(values)**0.5), -1))


def draw_map(axes, right, up, values):
    """Colours of an output over a grid, and its contours; returns what a bar of colours is made of."""
    right, up, values = square(right), square(up), square(values)
    # An output that is the same everywhere has no levels of its own.
    flat = np.ptp(values) <= 1e-9 * np.abs(values).max()
    filled = axes.contourf(right, up, values, levels=[values.min() - 1, values.max() + 1] if flat else 9, cmap="YlGnBu")
    axes.contour(right, up, values, levels=filled.levels, colors="black", linewidths=0.4)
    return filled


def steps_between(low, high):
    """Levels between whole numbers: of each step, or of every second, fifth, ... of many; and which."""
    every = next(size * 10**power for power in range(20) for size in (1, 2, 5)
                 if high - low <= STEPS * size * 10**power)
    levels = np.arange(np.floor(low / every), np.ceil(high / every) + 1) * every - 0.5
    if low == 0:
        levels = np.union1d(levels, [0.5])  # where the first one comes
    return levels[(levels > low) & (levels < high)], every


def draw_states(axes, right, up, counts):
    """Lines where numbers of nodes in contact, or of those that stick, change; handles of a legend. `counts`:
    the numbers at the rows of a grid by the name of their output."""
    right, up, handles = square(right), square(up), []
    for (name, values), style in zip(counts.items(), ("solid", "dashed")):
        values = square(values)
        low, high = values.min(), values.max()
        if not high > low:
            continue
        levels, every = steps_between(low, high)
        axes.contour(right, up, values, levels=levels, colors=PURPLE, linewidths=0.7, linestyles=style)
        handles.append(Line2D([], [], color=PURPLE, linewidth=0.7, linestyle=style,
                              label=f"{name.replace('_', ' ')} {low:.0f} to {high:.0f}, by {every}"))
    return handles


def draw_samples(axes, points, others):
    """Training samples as points; `others`: the parameters that a map does not show. Handles of a legend."""
    return axes.plot(*points.T, "o", markersize=3.5, color=ORANGE, clip_on=False, markeredgecolor="white",
                     markeredgewidth=0.4, label=f"{len(points)} samples" + (f", of any {others}" if others else ""))


def blank(missing, count):
    """The handle of what is left white."""
    if not missing:
        return []
    return [Patch(facecolor="white", edgecolor="grey", label=f"no answer at {missing} of {count} points")]


def draw_bars(axes, of):
    """Bars of the total indices of the outputs of a Sensitivity, in them those of the first order, with two
    standard deviations; handles of a legend."""
    names, handles = list(next(iter(of.first.values()))), []
    place, width = np.arange(len(of.first)), BARS / len(names)
    for k, name in enumerate(names):
        at = place + (k - (len(names) - 1) / 2) * width
        first, total, error = (np.array([own[name] for own in kind.values()])
                               for kind in (of.first, of.total, of.total_error))
        colour = COLOURS[k % len(COLOURS)]
        axes.bar(at, total, 0.9 * width, color=colour, alpha=0.35, linewidth=0)
        handles.append(axes.bar(at, np.maximum(first, 0), 0.9 * width, color=colour, linewidth=0,
                                label=name.replace("_", " ")))
        axes.errorbar(at, total, 2 * error, fmt="none", ecolor="black", elinewidth=0.7, capsize=1.5)
    axes.set_xticks(place, [name.replace("_", "\n") for name in of.first])
    axes.set(ylabel="Sobol index (-)", ylim=(0, None))
    return handles
