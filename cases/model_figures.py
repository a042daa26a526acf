"""What a model answers: outputs along each parameter, stresses over the contacts."""

import re
from typing import NamedTuple

import h5py
import numpy as np

from figure_tools import (BLUE, GREEN, GREY, ORANGE, PURPLE, Missing, contact_names, free_parameters,
                          in_length, in_stress, table, text_rows, wider, with_unit)
from panels import ROUND_OFF, Banded, Curve, Lines, Triangles, save_panels
from solid_figures import FROM_ABOVE, Plan, plan_of, zone_of

PLACES = {"middle of the box": BLUE, "least normal force": GREEN, "largest normal force": ORANGE}
COLOURS = (BLUE, ORANGE, GREEN, PURPLE, GREY)
SPOKEN = {"pressure": "pressure", "tangential": "tangential stress"}  # columns of stresses
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


class Region(NamedTuple):
    """A contact over an area: its rows of a table, a node each, in plan."""
    name: str           # "" of the only one
    whole: bool         # whether all of it is drawn: else what is pressed
    rows: np.ndarray    # of the table
    owner: np.ndarray   # row of each node of the triangles, of its own rows
    plan: Plan
    points: np.ndarray  # n x 2, of the nodes
    cells: np.ndarray   # k x 3

    def at_nodes(self, values):
        """Of a column of the table."""
        return values[self.rows][self.owner]

    def panel(self, title, values, label, limits, pressed, **more):
        """A field of the table; `pressed`: rows of the table."""
        frame = None if self.whole else zone_of(self.points, self.at_nodes(pressed))
        return Triangles(", ".join(filter(None, (title, self.name))), self.points, self.cells, self.at_nodes(values),
                         label, limits, frame=frame, axes=self.plan.names, **more)


def is_area(mesh):
    """Whether an interface of a model has triangles."""
    _, degree, _, nodes = mesh["sizes"][()].ravel()
    return nodes == (3 if degree == 1 else 6) and mesh["edges"].size == 0


def has_areas(run):
    """Whether contact is over areas."""
    with h5py.File(run / "model.h5", "r") as model:
        return is_area(model["interfaces/0"])


def contact_regions(run, data):
    """The contacts over areas in a table; none where contact is along curves."""
    names, regions = contact_names(run), []
    with h5py.File(run / "model.h5", "r") as model:
        for number in np.unique(data["interface"]).astype(int):
            mesh = model[f"interfaces/{number - 1}"]
            if not is_area(mesh):
                continue
            x, cells = mesh["points"][()], mesh["entities"][()].reshape(-1, mesh["sizes"][()].ravel()[3])[:, :3]
            solid = x.shape[1] == 3
            plan = plan_of(x, cells) if solid else FROM_ABOVE
            rows = np.flatnonzero(data["interface"] == number)
            own = np.column_stack([data[name][rows] for name in "xyz"[:x.shape[1]]])
            row_of = {place: k for k, place in enumerate(places_in(own, x))}
            x = x[:cells.max() + 1]
            owner = owners(x, cells, np.array([row_of.get(place, -1) for place in places_in(x, x)]))
            name = names.get(number, f"contact {number}")
            regions.append(Region(name, not solid, rows, owner, plan, plan.flat(x), cells))
    return regions if len(regions) > 1 else [region._replace(name="") for region in regions]


def places_in(x, points):
    """Coordinates in parts of the size of the points, to be compared."""
    return map(tuple, np.round(x / np.ptp(points, axis=0).max(), 9) + 0.0)


def owners(x, cells, rows):
    """Rows of nodes: of those without one, which cannot move, that of the nearest beside them."""
    sides = cells[:, [[0, 1], [1, 2], [2, 0], [1, 0], [2, 1], [0, 2]]].reshape(-1, 2)
    sides = sides[np.argsort(-np.linalg.norm(x[sides[:, 0]] - x[sides[:, 1]], axis=1), kind="stable")]
    while np.any(rows < 0):
        found = sides[(rows[sides[:, 0]] < 0) & (rows[sides[:, 1]] >= 0)]
        if len(found) == 0:
            raise Missing("the places of the table are not nodes of the contact")
        rows[found[:, 0]] = rows[found[:, 1]]  # the last one is the nearest
    return rows


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


def profile(x, pressure, tangential, label, colour):
    """Curves of the pressure and, dashed, of a tangential stress along a contact."""
    order = np.argsort(x)
    curves = [Curve(x[order], pressure[order], label, colour)]
    return curves + [Curve(x[order], tangential[order], "", colour, "--")] * bool(np.any(tangential))


def behind(samples):
    """Curves of the pressures of training samples, (x, pressure) each."""
    return [Curve(np.sort(x), pressure[np.argsort(x)], "" if k else "training samples", "#cccccc", width=0.7)
            for k, (x, pressure) in enumerate(samples)]


def profile_panel(title, over, curves):
    rubs = any(curve.style == "--" for curve in curves)
    return Lines(title, in_length(over), in_stress("pressure" + "; dashed: tangential stress" * rubs), curves)


def stress_panels(run, rows):
    """A panel for each contact along a curve; of a region one for each place, two with friction."""
    contacts, panels = contact_names(run), []
    regions = contact_regions(run, next(iter(rows.values())))
    if regions:
        pressed = np.any([own["pressure"] > 0 for own in rows.values()], axis=0)
        kinds = ["pressure", *(["tangential"] if any(np.any(own["tangential"]) for own in rows.values()) else [])]
        return [region.panel(place, own[kind], in_stress(SPOKEN[kind]), (0, own[kind].max() or 1), pressed)
                for region in regions for place, own in rows.items() for kind in kinds]
    training = training_pressures(run, rows)
    for number in np.unique(rows[next(iter(rows))]["interface"]).astype(int):
        own = {place: of_place[of_place["interface"] == number] for place, of_place in rows.items()}
        x, over = wider(np.column_stack([next(iter(own.values()))[name] for name in "xy"]))
        curves = behind([(x, pressure) for pressure in training.get(number, [])])
        for place, of_place in own.items():
            curves += profile(x, of_place["pressure"], of_place["tangential"], place, PLACES[place])
        panels.append(profile_panel(contacts.get(number, f"contact {number}"), over + ", reference domain", curves))
    return panels


def stresses(run):
    """Pressure and tangential stress over each contact at up to three parameters."""
    rows, words = places_of(run)
    return save_panels(run / "figures", "stresses.png", stress_panels(run, rows), words)
