"""What a model answers: outputs along each parameter, stresses over the contacts."""

import h5py
import numpy as np

from figure_tools import (BLUE, GREEN, GREY, ORANGE, Missing, contact_names, free_parameters,
                          in_length, in_stress, plt, save, table, wider, with_unit)
from panels import Curve, Lines, Triangles, save_panels

PLACES = {"middle of the box": BLUE, "least normal force": GREEN, "largest normal force": ORANGE}
MOST = 10  # outputs that are drawn: those of the case before the others
STANDARD = ("normal_force", "tangential_force", "reaction", "peak_pressure", "contact_measure",
            "energy")


def drawn_outputs(data, parameters):
    """Those of the case, which stand behind the standard ones, then the best known of these."""
    columns = [name for name in data.dtype.names if name not in parameters]
    last = max((columns.index(name) for name in ("iterations", "load_steps", "contraction", "seconds")
                if name in columns), default=len(columns))
    chosen = columns[last + 1:] + [name for name in STANDARD if name in columns]
    return chosen[:MOST]


def samples_of(run):
    """The training samples; nothing where they are not there."""
    path = run / "samples.csv"
    return np.atleast_1d(np.genfromtxt(path, delimiter=",", names=True)) if path.is_file() else None


def contact_cells(run):
    """Triangles between the vertices of a contact region; nothing for contact along curves."""
    with h5py.File(run / "model.h5", "r") as model:
        dimension, degree, _, nodes = model["interfaces/0/sizes"][()].ravel()
        of_cells = nodes == (3 if degree == 1 else 6) and dimension == 2
        region = of_cells and model["interfaces/0/edges"].size == 0
        cells = model["interfaces/0/entities"][()] if region else np.zeros(0, int)
        return cells.reshape(-1, nodes)[:, :3]


def outputs(run):
    """Outputs along each free parameter through the middle of the box, and the training samples."""
    data, parameters = table(run, "along.csv"), free_parameters(run)
    names = [name for name, _ in parameters]
    shown, samples = drawn_outputs(data, names), samples_of(run)
    if not shown:
        raise Missing("along.csv has no outputs")
    steps = len(data) // len(names)
    figure, axes = plt.subplots(len(shown), len(names), sharex="col", sharey="row", squeeze=False,
                                figsize=(1 + 2.3 * len(names), 0.6 + 1.6 * len(shown)))
    for row, output in zip(axes, shown):
        for k, ((name, unit), axis) in enumerate(zip(parameters, row)):
            if samples is not None and output in samples.dtype.names:
                axis.plot(samples[name], samples[output], ".", color="#bbbbbb", markersize=3)
            line = data[k * steps:(k + 1) * steps]
            axis.plot(line[name], line[output], color=BLUE)
            if output == shown[-1]:
                axis.set_xlabel(with_unit(name.replace("_", " "), unit))
        row[0].set_ylabel(output.replace("_", " "))
    figure.align_ylabels(axes[:, 0])
    figure.suptitle("outputs along each parameter, the others at the middle of the box; grey: training "
                    "samples", fontsize=9, color=GREY)
    figure.tight_layout()
    return save(figure, run / "figures", "outputs.png") or []


def places_of(run):
    """Rows of stresses.csv by the place that they are of, and the parameters there in words."""
    data, parameters = table(run, "stresses.csv"), free_parameters(run)
    columns = data.dtype.names[:len(parameters)]  # of one that is called like another column: mu_NAME
    at = np.column_stack([data[name] for name in columns])
    first = np.sort(np.unique(at, axis=0, return_index=True)[1])
    rows = {place: data[np.all(at == at[start], axis=1)] for place, start in zip(PLACES, first)}
    words = [f"{place}: " + ",  ".join(f"{name.replace('_', ' ')} {own[column][0]:.4g} {unit}".strip()
                                       for (name, unit), column in zip(parameters, columns)) for place, own in rows.items()]
    return rows, "\n".join(words)


def stress_panels(run, rows):
    """A panel for each contact along a curve; of a region one for each place."""
    cells, contacts, panels = contact_cells(run), contact_names(run), []
    if len(cells) > 0:
        return [Triangles(place, np.column_stack([own["x"], own["y"]]), cells, own["pressure"],
                          in_stress("pressure"), (0, own["pressure"].max() or 1))
                for place, own in rows.items()]
    for number in np.unique(rows[next(iter(rows))]["interface"]).astype(int):
        curves, over = [], "x"
        for place, of_place in rows.items():
            own = of_place[of_place["interface"] == number]
            x, over = wider(np.column_stack([own["x"], own["y"]]))
            order = np.argsort(x)
            curves.append(Curve(x[order], own["pressure"][order], place, PLACES[place]))
            if np.any(own["tangential"]):
                curves.append(Curve(x[order], own["tangential"][order], "", PLACES[place], "--"))
        panels.append(Lines(contacts.get(number, f"contact {number}"),
                            in_length(over + ", reference domain"),
                            in_stress("pressure; dashed: tangential stress"), curves))
    return panels


def stresses(run):
    """Pressure and tangential stress over each contact at up to three parameters."""
    rows, words = places_of(run)
    return save_panels(run / "figures", "stresses.png", stress_panels(run, rows), words)
