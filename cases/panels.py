"""Panels of figures: what they show is plain data, which tests look at, and is drawn here."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from matplotlib.ticker import MaxNLocator

from figure_tools import BLUE, GREY, label_plane, log_axis, plt, save

ROUND_OFF = 1e-9  # of the size of values: what differs by less is a constant
ZERO = 1e-15      # relative errors below are round-off


@dataclass
class Curve:
    """y over x, NaN where there is no answer; `style` is that of matplotlib."""

    x: np.ndarray
    y: np.ndarray
    label: str = ""
    colour: str = BLUE
    style: str = "-"
    right: bool = False  # on the axis at the right
    width: float = 1.6


@dataclass
class Lines:
    """Curves over axes with units. On a logarithmic axis values below `floor` are zero but for
    round-off: the legend says so, and they are not drawn."""

    title: str
    xlabel: str
    ylabel: str
    curves: list = field(default_factory=list)
    log: bool = False
    floor: float = ZERO
    right: str = ""  # label of the axis at the right
    projection = None

    def draw(self, _, axis):
        axes = {False: axis, True: axis.twinx() if self.right else axis}
        handles = []
        for curve in self.curves:
            y, label = shown(curve, self)
            handles += axes[curve.right].plot(curve.x, y, curve.style, color=curve.colour,
                                              label=label, linewidth=curve.width)
        if self.log:
            log_axis(axis, "", "", "")
        else:
            show_constants(axis)
        axis.set_xlabel(self.xlabel)
        axis.set_ylabel(self.ylabel)
        if self.right:
            show_constants(axes[True])
            axes[True].set_ylabel(self.right, color=self.curves[-1].colour)
            axes[True].spines["right"].set_visible(True)
            axes[True].grid(False)
        if all(np.array_equal(curve.x, np.round(curve.x)) for curve in self.curves):
            axis.xaxis.set_major_locator(MaxNLocator(integer=True))
        handles = [handle for handle in handles if handle.get_label()[:1] not in ("", "_")]
        if handles:
            legend_below(axis, handles)


@dataclass
class Banded:
    """Curves with a band of an error, absolute, around each."""

    title: str
    ylabel: str
    xlabel: str
    curves: list
    error: float

    def draw(self, _, axis):
        for curve in self.curves:
            axis.plot(curve.x, curve.y, color=curve.colour, label=curve.label, linewidth=curve.width)
            axis.fill_between(curve.x, curve.y - self.error, curve.y + self.error, color=curve.colour,
                              alpha=0.25, linewidth=0)
        show_constants(axis)
        axis.xaxis.set_major_locator(MaxNLocator(4))
        axis.yaxis.set_major_locator(MaxNLocator(4))
        axis.set_xlabel(self.xlabel)
        axis.set_ylabel(self.ylabel)


@dataclass
class Triangles:
    """Values of nodes, or `flat` those of the triangles, as colours between the limits."""

    title: str
    points: np.ndarray
    cells: np.ndarray
    values: np.ndarray
    label: str
    limits: tuple
    colours: str = "Blues"
    flat: bool = False
    projection = None

    def draw(self, figure, axis):
        shading = {"facecolors": self.values} if self.flat else {"shading": "gouraud"}
        filled = axis.tripcolor(self.points[:, 0], self.points[:, 1], self.cells,
                                *(() if self.flat else (self.values,)), cmap=self.colours,
                                rasterized=True, **shading)
        filled.set_clim(*self.limits)
        label_plane(axis)
        figure.colorbar(filled, ax=axis, shrink=0.75, label=self.label, format="%.3g")


@dataclass
class Drawn:
    """A panel that is drawn by a function of figure and axis."""

    title: str
    draw: Callable
    projection: str | None = None


def shown(curve, panel):
    """What is drawn of a curve, and its label with what is not."""
    y = np.array(curve.y, float)
    missing = ~np.isfinite(y)
    low = ~missing & (y < panel.floor) if panel.log else np.zeros(y.shape, bool)
    words = [curve.label] if curve.label else []
    for left_out, why in ((missing, "no answer"), (low, f"below {panel.floor:.0e}")):
        if left_out.any():
            words.append(why + ("" if left_out.all() else f" at {left_out.sum()} of {y.size}"))
    y[missing | low] = np.nan
    return y, ", ".join(words)


def legend_below(axis, handles):
    """One line for each curve below the axis, where it hides none."""
    axis.legend(handles=handles, loc="upper left", bbox_to_anchor=(-0.1, -0.16), borderpad=0)


def show_constants(axis):
    """Numbers at the axis have no offset. Values that differ by round-off alone are drawn as the
    constant that they are, over an axis that holds zero."""
    axis.ticklabel_format(axis="y", useOffset=False)
    low, high = axis.dataLim.intervaly
    size = max(abs(low), abs(high))
    if np.isfinite(size) and high - low <= ROUND_OFF * size:
        least = 0.1 * size or 1
        axis.set_ylim(min(1.2 * low, -least), max(1.2 * high, least))


def figure_of(panels, subtitle=""):
    """A figure, its panels marked (a), (b), ..., and a line for each that could not be drawn: the
    others do not wait for it."""
    columns = len(panels) if len(panels) <= 3 else (len(panels) + 1) // 2
    rows = -(-len(panels) // columns)
    figure = plt.figure(figsize=(4.2 * columns, 4.2 * rows), constrained_layout=True)
    failed = []
    for k, panel in enumerate(panels):
        axis = figure.add_subplot(rows, columns, k + 1, projection=panel.projection)
        try:
            panel.draw(figure, axis)
        except Exception as error:  # whatever its data is: the reason is told
            failed.append(f"{panel.title}: {error or type(error).__name__}")
            axis.clear()
            axis.text(0.5, 0.5, "cannot be drawn", ha="center", transform=axis.transAxes)
        axis.set_title((f"({chr(ord('a') + k)}) " if len(panels) > 1 else "") + panel.title,
                       loc="left")
    figure.suptitle(subtitle, fontsize=8, color=GREY)
    return figure, failed


def save_panels(directory, name, panels, subtitle=""):
    """Writes the figure; returns a line for each panel that could not be drawn."""
    figure, failed = figure_of(panels, subtitle)
    save(figure, directory, name)
    return failed
