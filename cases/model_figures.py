"""What a model answers: outputs along each parameter, stresses over the contacts."""

import re

import h5py
import numpy as np

from figure_tools import (BLUE, GREEN, GREY, ORANGE, PURPLE, Missing, contact_names, free_parameters,
                          in_length, in_stress, table, text_rows, wider, with_unit)
from panels import ROUND_OFF, Banded, Curve, Lines, Triangles, save_panels

PLACES = {"middle of the box": BLUE, "least normal force": GREEN, "largest normal force": ORANGE}
COLOURS = (BLUE, ORANGE, GREEN, PURPLE, GREY)
SAME = 0.03  # two outputs that differ by less are drawn once
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


def contact_cells(run):
    """Triangles between the vertices of a contact region; nothing for contact along curves."""
    with h5py.File(run / "model.h5", "r") as model:
        dimension, degree, _, nodes = model["interfaces/0/sizes"][()].ravel()
        of_cells = nodes == (3 if degree == 1 else 6) and dimension == 2
        region = of_cells and model["interfaces/0/edges"].size == 0
        cells = model["interfaces/0/entities"][()] if region else np.zeros(0, int)
        return cells.reshape(-1, nodes)[:, :3]


def output_panels(run):
    """A panel for each output: over the one free parameter, or a line for each over its range; the band
    of the largest error that was measured. And what to say: what lies on another one is left out."""
    data, parameters = table(run, "along.csv"), free_parameters(run)
    names = [name for name, _ in parameters]
    chosen, words = drawn_outputs(data, names), []
    if not chosen:
        raise Missing("along.csv has no outputs")
    if {"reaction", "normal_force"} <= set(chosen):
        apart = np.nanmax(np.abs(data["reaction"] - data["normal_force"])) / np.nanmax(np.abs(data["normal_force"]))
        if apart <= SAME:
            chosen.remove("reaction")
            words.append(f"reaction: within {100 * apart:.1g} % of the normal force")
    for output in list(chosen):
        if np.ptp(data[output]) <= ROUND_OFF * np.max(np.abs(data[output])):
            chosen.remove(output)
            words.append(f"{output.replace('_', ' ')}: {data[output][0]:.4g} everywhere")
    path = run / "verify/outputs.csv"
    facts = {re.sub(r"\W", "", row["output"].replace(" ", "_")): row  # as columns of tables are called
             for row in (text_rows(path) if path.is_file() else [])}
    steps, panels = len(data) // len(names), []
    for output in chosen:
        of, label = facts.get(output, {}), output.replace("_", " ")
        lines = []
        for k, (name, unit) in enumerate(parameters):
            line = data[k * steps:(k + 1) * steps]
            ends = with_unit(f"{name.replace('_', ' ')} {line[name][0]:.3g} to {line[name][-1]:.3g}", unit)
            x = line[name] if len(names) == 1 else (line[name] - line[name][0]) / np.ptp(line[name])
            lines.append(Curve(x, line[output], ends, COLOURS[k % len(COLOURS)]))
        panels.append(Banded(label, f"{label} ({of['unit']})" if of.get("unit") else label,
                             with_unit(names[0].replace("_", " "), parameters[0][1]) if len(names) == 1
                             else "part of the range", lines, float(of.get("max") or 0)))
    return panels, "; ".join(words)


def outputs(run):
    """Outputs along each free parameter, the others at the middle of the box."""
    panels, words = output_panels(run)
    if not panels:
        raise Missing(f"every output is the same everywhere: {words}")
    said = "along each parameter, the others at the middle of the box; bands: largest measured error"
    return save_panels(run / "figures", "outputs.png", panels, "\n".join(filter(None, (said, words))))


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


def training_pressures(run, rows):
    """Number of a contact along a curve -> pressures of the training samples, a row each; nothing where
    multipliers are not pressures at the places of stresses.csv, as by Nitsche's method."""
    place, found, start = next(iter(rows.values())), {}, 0
    samples = []
    for path in sorted((run / "samples").glob("*.h5")):
        with h5py.File(path, "r") as sample:
            samples.append(sample["lambda"][()].ravel())
    for number in np.unique(place["interface"]).astype(int):
        size = np.sum(place["interface"] == number)
        rubs = any(np.any(own["tangential"][own["interface"] == number]) for own in rows.values())
        found[number] = [sample[start:start + size] for sample in samples]
        start += size * (1 + rubs)
    fits = all(len(sample) == start for sample in samples) and all(
        pressure.min() >= -1e-6 * pressure.max() for pressures in found.values() for pressure in pressures)
    return found if fits else {}


def stress_panels(run, rows):
    """A panel for each contact along a curve; of a region one for each place."""
    cells, contacts, panels = contact_cells(run), contact_names(run), []
    if len(cells) > 0:
        return [Triangles(place, np.column_stack([own["x"], own["y"]]), cells, own["pressure"],
                          in_stress("pressure"), (0, own["pressure"].max() or 1))
                for place, own in rows.items()]
    training = training_pressures(run, rows)
    for number in np.unique(rows[next(iter(rows))]["interface"]).astype(int):
        curves, over, behind = [], "x", training.get(number, [])
        for place, of_place in rows.items():
            own = of_place[of_place["interface"] == number]
            x, over = wider(np.column_stack([own["x"], own["y"]]))
            order = np.argsort(x)
            curves += [Curve(x[order], pressure[order], "" if k else "training samples", "#cccccc", width=0.7)
                       for k, pressure in enumerate(behind)]
            behind = []
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
