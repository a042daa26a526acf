"""Panels of figures: what they show is plain data, which tests look at, and is drawn here."""

import textwrap
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from matplotlib.ticker import MaxNLocator, NullFormatter
from matplotlib.transforms import ScaledTranslation, blended_transform_factory

from figure_tools import BLUE, COLUMN, GREY, LINE, WIDTH, label_plane, log_axis, plt, save

ROUND_OFF = 1e-9  # of the size of values: what differs by less is a constant
ZERO = 1e-12      # relative errors below are round-off
LETTERS = 30      # of a line in a panel


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
    round-off: the legend says so, and they are not drawn. On another one a panel of values that are all
    below `least` is left out."""

    title: str
    xlabel: str
    ylabel: str
    curves: list = field(default_factory=list)
    log: bool = False
    log_x: bool = False
    floor: float = ZERO
    right: str = ""  # label of the axis at the right
    ylimits: tuple = ()  # of the axis at the left, where they are not those of the curves
    least: float = 0
    projection = None
    ratio = 0.75

    def spent(self):
        """Labels of curves of which nothing is drawn."""
        return [curve.label for curve in self.curves if not np.any(np.isfinite(shown(curve, self)[0]))]

    def empty(self):
        sizes = [np.max(np.abs(curve.y), where=np.isfinite(curve.y), initial=0) for curve in self.curves]
        return len(self.spent()) == len(self.curves) or max(sizes) < self.least

    def draw(self, _, axis):
        axes = {False: axis, True: axis.twinx() if self.right else axis}
        handles = []
        for curve in self.curves:
            y, label = shown(curve, self)
            if not np.any(np.isfinite(y)):
                continue
            handles += axes[curve.right].plot(curve.x, y, curve.style, color=curve.colour,
                                              label=label, linewidth=curve.width)
        if self.log:
            log_axis(axis, "", "", "")
        else:
            show_constants(axis)
            axis.yaxis.set_major_locator(MaxNLocator(4))
        axis.set_xlabel(fitting(self.xlabel))
        axis.set_ylabel(fitting(self.ylabel, 26))
        if self.right:
            show_constants(axes[True])
            axes[True].yaxis.set_major_locator(MaxNLocator(4))
            axes[True].set_ylabel(self.right, color=self.curves[-1].colour)
            axes[True].spines["right"].set_visible(True)
            axes[True].grid(False)
        whole = all(np.array_equal(curve.x, np.round(curve.x)) for curve in self.curves)
        if self.ylimits:
            axis.set_ylim(*self.ylimits)
        if self.log_x:
            decades(axis)
        else:
            axis.xaxis.set_major_locator(MaxNLocator(4, integer=whole))
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
    projection = None
    ratio = 0.7

    def empty(self):
        return False

    def draw(self, _, axis):
        handles = []
        for curve in self.curves:
            handles += axis.plot(curve.x, curve.y, color=curve.colour, label=curve.label, linewidth=curve.width)
            axis.fill_between(curve.x, curve.y - self.error, curve.y + self.error, color=curve.colour,
                              alpha=0.25, linewidth=0)
        show_constants(axis)
        axis.xaxis.set_major_locator(MaxNLocator(4))
        axis.yaxis.set_major_locator(MaxNLocator(4))
        axis.set_xlabel(self.xlabel)
        axis.set_ylabel(fitting(self.ylabel, 24))
        if len(handles) > 1:
            legend_below(axis, handles)


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
    least: float = 0
    frame: tuple = None  # corners of what is shown, where that is not all
    axes: tuple = ("x", "y")
    over: Callable = None  # draws on an axis what lies over the colours; handles of a legend
    projection = None

    @property
    def ratio(self):
        return ratio_of(self.points if self.frame is None else np.array(self.frame))

    def empty(self):
        return np.abs(self.values).max() < self.least

    def draw(self, figure, axis):
        shading = {"facecolors": self.values} if self.flat else {"shading": "gouraud"}
        filled = axis.tripcolor(self.points[:, 0], self.points[:, 1], self.cells,
                                *(() if self.flat else (self.values,)), cmap=self.colours,
                                rasterized=True, **shading)
        filled.set_clim(*self.limits)
        label_plane(axis, self.axes)
        axis.set_anchor("NW")
        if self.frame is not None:
            (left, low), (right, high) = self.frame
            axis.set(xlim=(left, right), ylim=(low, high))
        if self.ratio > 1.1:
            axis.locator_params(axis="x", nbins=2)
        if self.ratio < 0.6:
            axis.yaxis.set_major_locator(MaxNLocator(2, min_n_ticks=1))
        colour_bar(figure, axis, filled, self.label, self.ratio)
        handles = self.over(axis) if self.over else []
        if handles:
            legend_below(axis, handles)


@dataclass
class Drawn:
    """A panel that is drawn by a function of figure and axis."""

    title: str
    draw: Callable
    projection: str | None = None
    ratio: float = 1  # of its height to its width

    def empty(self):
        return False


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


def fitting(text, letters=LETTERS):
    return "\n".join(textwrap.wrap(text, letters, break_long_words=False))


def decades(axis):
    """A logarithmic axis of x, of whole decades."""
    low, high = axis.dataLim.intervalx
    axis.set_xscale("log")
    axis.set_xlim(10 ** np.floor(np.log10(low) - 0.1), 10 ** np.ceil(np.log10(high) + 0.1))
    axis.xaxis.set_minor_formatter(NullFormatter())


def ratio_of(points):
    """Height over width of a picture of the points, within what a page has room for."""
    wide, high = np.ptp(points[:, :2], axis=0)
    return float(np.clip(high / wide, 0.3, 1.6))


def inches_from(axis):
    """Inches from the lower left corner of the axis."""
    return axis.figure.dpi_scale_trans + ScaledTranslation(0, 0, axis.transAxes)


def colour_bar(figure, axis, filled, label, ratio, start=0):
    """Below what is wide, as wide but for a share `start` at both ends, at the right of what is high."""
    below = ratio < 1.5
    place = (axis.inset_axes((start, -0.62, 1 - 2 * start, 0.09),
                             transform=blended_transform_factory(axis.transAxes, inches_from(axis))) if below else
             axis.inset_axes((1.08, 0.05, 0.1, 0.9)))
    bar = figure.colorbar(filled, cax=place, orientation="horizontal" if below else "vertical", format="%.3g")
    bar.locator = MaxNLocator(3 if below else 4)
    bar.update_ticks()
    if below:  # a text, which the layout makes room for, as it does not for a wide label
        place.annotate(fitting(label, 27), (0, 0), (0, -19), "axes fraction", "offset points", va="top")
    else:
        bar.set_label(fitting(label, 24))
    place.grid(False)


def legend_below(axis, handles):
    """One line for each curve below the axis, where it hides none."""
    for handle in handles:
        handle.set_label(fitting(handle.get_label()))
    labels = [handle.get_label() for handle in handles]
    ticks = max((text.get_text().count("\n") for text in axis.get_xticklabels()), default=0)
    lines = bool(axis.get_xlabel()) + axis.get_xlabel().count("\n") + ticks + 4 * len(axis.child_axes)  # a colour bar
    axis.legend(handles=handles, loc="upper left", bbox_to_anchor=(-0.3, -0.36 - LINE * lines),
                bbox_transform=inches_from(axis), borderpad=0, borderaxespad=0,
                ncols=2 if len(labels) > 3 and max(map(len, labels)) < 13 else 1)


def show_constants(axis):
    """Numbers at the axis have no offset and no common factor. Values that differ by round-off alone are
    drawn as the constant that they are, over an axis that holds zero."""
    low, high = axis.dataLim.intervaly
    size = max(abs(low), abs(high))
    if 1e-3 <= size < 1e6:
        axis.ticklabel_format(axis="y", useOffset=False)
    else:
        axis.yaxis.set_major_formatter(lambda number, _: f"{number:.6g}")
    if np.isfinite(size) and high - low <= ROUND_OFF * size:
        least = 0.1 * size or 1
        axis.set_ylim(min(1.2 * low, -least), max(1.2 * high, least))


def legend_height(labels, columns):
    """Inches, of its longest column."""
    rows = -(-len(labels) // columns)
    return max(sum(0.05 + LINE * (1 + label.count("\n")) for label in labels[k:k + rows])
               for k in range(0, len(labels), rows))


def looks(handle):
    return tuple(str(getattr(handle, "get_" + what, str)()) for what in
                 ("color", "linestyle", "marker", "linewidth", "facecolor"))


def share_legend(figure, axes):
    """One legend of all panels, where no two of its entries look the same; returns its height in
    inches."""
    legends = [axis.get_legend() for axis in axes if axis.get_legend()]
    handles = {text.get_text(): handle for legend in legends
               for handle, text in zip(legend.legendHandles, legend.get_texts())}
    if len(axes) < 2 or not handles or len(set(map(looks, handles.values()))) < len(handles):
        return 0
    for legend in legends:
        legend.remove()
    columns = min(2, len(handles))
    figure.legend(handles=list(handles.values()), labels=list(handles), loc="lower left", ncols=columns,
                  borderaxespad=0.2)
    return legend_height(list(handles), columns) + 0.1


class Stack(NamedTuple):
    """Rows of panels, one above another: a grid, and the numbers of the panels of each row."""
    grid: object
    rows: list


def height_of(panel, width, legend=None):
    """In inches: what is drawn, the text around it and its legend."""
    below = legend_height([text.get_text() for text in legend.get_texts()], legend._ncols) if legend else 0
    return 0.9 + 0.68 * width * panel.ratio + below + 0.2 * (panel.ratio < 0.6)


def in_rows(figure, panels):
    """Two in a row; the last of an odd number has a row of its own."""
    columns = min(2, len(panels))
    rows = [list(range(k, min(k + columns, len(panels)))) for k in range(0, len(panels), columns)]
    grid = figure.add_gridspec(len(rows), columns)
    places = [grid[k, slice(None) if len(row) == 1 else which] for k, row in enumerate(rows)
              for which in range(len(row))]
    return [Stack(grid, rows)], places


def in_columns(figure, panels):
    """Each below what is the least high of two columns, which have no rows in common."""
    rows, heights = ([], []), [0, 0]
    for k, panel in enumerate(panels):
        shorter = int(heights[1] < heights[0])
        rows[shorter].append([k])
        heights[shorter] += height_of(panel, WIDTH / 2)
    outer = figure.add_gridspec(1, 2)
    stacks = [Stack(outer[0, k].subgridspec(len(own), 1), own) for k, own in enumerate(rows)]
    places = {row[0]: stack.grid[k] for stack in stacks for k, row in enumerate(stack.rows)}
    return stacks, [places[k] for k in range(len(panels))]


def set_heights(stacks, panels, axes, width):
    """Heights of all rows; what one column is shorter by, its panels of curves take. Returns the height of all."""
    heights = [[max(height_of(panels[k], width, axes[k].get_legend()) for k in row) for row in stack.rows]
               for stack in stacks]
    most = max(map(sum, heights))
    for stack, own in zip(stacks, heights):
        free = [k for k, row in enumerate(stack.rows) if all(isinstance(panels[one], Lines) for one in row)]
        more = (most - sum(own)) / max(1, len(free))
        stack.grid.set_height_ratios([height + more * (k in free) for k, height in enumerate(own)])
    return most


def figure_of(panels, subtitle="", arrange=in_rows):
    """A figure, its panels marked (a), (b), ..., and a line for each that could not be drawn: the
    others do not wait for it."""
    figure, failed = plt.figure(constrained_layout=True), []
    width = WIDTH if len(panels) > 1 else COLUMN
    stacks, places = arrange(figure, panels)
    axes = [figure.add_subplot(place, projection=panel.projection) for place, panel in zip(places, panels)]
    for k, (panel, axis) in enumerate(zip(panels, axes)):
        try:
            panel.draw(figure, axis)
        except Exception as error:  # whatever its data is: the reason is told
            failed.append(f"{panel.title}: {error or type(error).__name__}")
            axis.clear()
            axis.text(0.5, 0.5, "cannot be drawn", ha="center", transform=axis.transAxes)
        letters = 2 * LETTERS if axis.get_subplotspec().colspan == range(2) else (
            LETTERS if isinstance(panel, (Lines, Banded)) else 24)
        axis.set_title(fitting((f"({chr(ord('a') + k)}) " if len(panels) > 1 else "") + panel.title, letters),
                       loc="left")
    words = "\n".join(fitting(line, int(width * 13)) for line in subtitle.splitlines())
    below, above = share_legend(figure, axes), LINE * (1 + words.count("\n")) + 0.05 if words else 0
    height = set_heights(stacks, panels, axes, width / min(2, len(panels))) + below + above
    figure.set_size_inches(width, height)
    figure.get_layout_engine().set(rect=(0, below / height, 1, 1 - (below + above) / height), h_pad=0.07)
    figure.text(0.01, 1 - 0.04 / height, words, color=GREY, ha="left", va="top")
    return figure, failed


def with_values(panels):
    """Panels that are not empty, and what is said of the others and of curves that are not drawn."""
    words = {}
    for panel in panels:
        if panel.empty():
            words[f"{panel.title}: left out, round-off"] = None
        elif isinstance(panel, Lines):
            words.update({f"{', '.join(filter(None, [panel.title, label]))}: left out, below {panel.floor:.0e}": None
                          for label in filter(None, panel.spent())})
    return [panel for panel in panels if not panel.empty()], list(words)


def save_panels(directory, name, panels, subtitle="", arrange=in_rows):
    """Writes the figure; returns a line for each panel that could not be drawn."""
    panels, words = with_values(panels)
    if not panels:
        print(f"{name}: left out, {'; '.join(words) or 'it has no panels'}")
        return []
    figure, failed = figure_of(panels, "\n".join(filter(None, [subtitle, *words])), arrange)
    save(figure, directory, name)
    return failed
