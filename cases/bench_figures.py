"""Error over run time: one mark for every row of bench/table.csv."""

import numpy as np

from figure_tools import (BLUE, FLOOR, GREEN, GREY, ORANGE, PURPLE, WIDTH, log_axis, plt, save, text_rows)

# Beginning of the method, or of what it includes: name in the legend, colour, mark.
KINDS = (("reduced", "reduced model (N + S, R)", BLUE, "o"),
         ("multilinear interpolation", "interpolation of snapshots", ORANGE, "D"),
         ("interpolation by cubic", "interpolation of snapshots", ORANGE, "D"),
         ("nearest snapshot", "nearest snapshot", ORANGE, "D"),
         ("active_set", "high-fidelity, active set", GREEN, "s"),
         ("nitsche", "high-fidelity, Nitsche", GREEN, "s"),
         ("uzawa", "high-fidelity, Uzawa", PURPLE, "^"),
         ("vi", "high-fidelity, SNES VI (lumped)", GREY, "v"))


def number(text):
    return float(text) if text else np.nan


def pareto(time, error):
    """Indices of the rows that no other beats in both, by increasing time."""
    front, best = [], np.inf
    for i in np.lexsort((error, time)):
        if error[i] < best:
            front.append(i)
            best = error[i]
    return front


def draw_front(axis, time, error, style, label):
    """Steps: what the best row up to each time reaches."""
    front = pareto(time, error)
    axis.plot(np.append(time[front], np.max(time)), np.append(error[front], error[front[-1]]),
              style, drawstyle="steps-post", color="black", linewidth=0.9, label=label, zorder=1)
    return front


def rows_of_kind(rows, start):
    return [i for i, row in enumerate(rows) if row["method"].startswith(start)]


def draw_marks(axis, rows, time, error, filled):
    """One mark for each row; returns a handle for each kind."""
    handles = {}
    for start, label, colour, mark in KINDS:
        chosen = [i for i in rows_of_kind(rows, start) if np.isfinite(error[i])]
        if chosen:
            handles[label], = axis.plot(time[chosen], error[chosen], mark, color=colour,
                                        markersize=6, label=label, linestyle="none",
                                        markerfacecolor=colour if filled else "white")
    return handles


def name_rows(axis, rows, time, error):
    """Words beside the marks: the sizes of a model, from where a solver starts. Of marks that lie
    together, and of those of one name, the last in the table is named."""
    named = []
    for row, t, e in reversed(list(zip(rows, np.log10(time), np.log10(error)))):
        words = row["method"].split(" ", 1)[-1].strip("()")
        together = any(words == other or (abs(t - at) < 1 and abs(e - high) < 2) for at, high, other in named)
        if not np.isfinite(e) or together or words in ("interpolation", "snapshot"):
            continue
        right_is_taken = any(0 < at - t < 0.9 and abs(e - high) < 0.5 for at, high, _ in named)
        named.append((t, e, words))
        axis.annotate(words, (10 ** t, 10 ** e), xytext=(-6 if right_is_taken else 6, 3),
                      ha="right" if right_is_taken else "left", textcoords="offset points",
                      color=GREY)


def bench(run):
    """Largest error over the validation set against the median time of a query: of u, and of the
    multipliers and the outputs; the step line is what can be had for that time."""
    path = run / "bench" / "table.csv"
    if not path.is_file():
        print("bench.png: left out, rbvi bench has not run")
        return []
    rows = [row for row in text_rows(path) if row["u_max"]]
    time = np.array([number(row["median_ms"]) for row in rows])
    figure, axes = plt.subplots(2, 1, figsize=(WIDTH, 6), constrained_layout=True, sharex=True)
    # The first row is the truth that errors are measured against: zero, at the floor.
    columns = {name: np.maximum([number(row.get(name)) for row in rows], FLOOR)
               for name in ("u_max", "lambda_max", "outputs_max")}
    handles = draw_marks(axes[0], rows, time, columns["u_max"], True)
    draw_front(axes[0], time, columns["u_max"], "-", "Pareto front")
    name_rows(axes[0], rows, time, columns["u_max"])
    draw_marks(axes[1], rows, time, columns["lambda_max"], True)
    draw_front(axes[1], time, columns["lambda_max"], "-", "Pareto front, multipliers (filled)")
    known = np.isfinite(columns["outputs_max"])
    if known.any():
        draw_marks(axes[1], rows, time, columns["outputs_max"], False)
        draw_front(axes[1], time[known], columns["outputs_max"][known], "--",
                   "Pareto front, outputs (open)")
    for axis, title in zip(axes, ("(a) displacement u", "(b) multipliers and outputs")):
        log_axis(axis, "median time of a query (ms)", "largest relative error (-)", title)
        axis.set_xscale("log")
        axis.margins(x=0.15)
        axis.label_outer()
    handles.update({line.get_label(): line for line in axes[1].lines
                    if line.get_label().startswith("Pareto")})
    figure.legend(handles=handles.values(), labels=handles.keys(), loc="upper center",
                  bbox_to_anchor=(0.5, 0), ncols=2)
    save(figure, run / "figures", "bench.png")
    return []
