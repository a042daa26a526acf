"""What the configuration of a case is drawn from: its boundaries on the mesh that rbvi check writes,
and what its case file says of them."""

import re

import numpy as np

from case_figures import FREE, partners
from figure_tools import PREFIXES, beside, read_grid
from solution_figures import contact_grids

FUNCTIONS = {name: getattr(np, name) for name in ("hypot", "sqrt", "sin", "cos", "tan", "exp", "pi")}


class Boundary:
    """Facets of some groups: their ends k x 2 x 2, chained, and normals out of the body."""

    def __init__(self, segments, normals):
        self.segments, self.normals = segments, normals
        apart = np.linalg.norm(segments[1:, 0] - segments[:-1, 1], axis=1)
        lengths = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
        self.begins = np.concatenate([[0], np.flatnonzero(apart > 1e-6 * lengths.sum()) + 1])

    def pieces(self):
        """Its connected parts."""
        ends = np.append(self.begins[1:], len(self.segments))
        return [Boundary(self.segments[begin:end], self.normals[begin:end])
                for begin, end in zip(self.begins, ends)]

    def lines(self):
        """One line, interrupted between the parts."""
        parts = [np.vstack([piece.segments[:, 0], piece.segments[-1:, 1], [[np.nan, np.nan]]])
                 for piece in self.pieces()]
        return np.concatenate(parts).T

    def length(self):
        return np.linalg.norm(self.segments[:, 1] - self.segments[:, 0], axis=1).sum()

    def middle(self):
        """Of the longest part, and the normal there."""
        longest = max(self.pieces(), key=lambda piece: round(piece.length(), 9))
        points, normals = longest.places(longest.length())
        return points[0], normals[0]

    def places(self, step):
        """Points about a step apart, and the normals there: of each facet those that fall on it."""
        lengths = np.linalg.norm(self.segments[:, 1] - self.segments[:, 0], axis=1)
        ends = np.cumsum(lengths)
        count = max(1, round(ends[-1] / step))
        along = (np.arange(count) + 0.5) * ends[-1] / count
        which = np.minimum(np.searchsorted(ends, along), len(ends) - 1)
        part = 1 - (ends[which] - along) / lengths[which]
        first, last = self.segments[which, 0], self.segments[which, 1]
        return first + part[:, None] * (last - first), self.normals[which]


def chained(segments):
    """(order of the facets, whether each is turned round) so that they follow each other, as far as
    they do."""
    of_point = {}
    for k, segment in enumerate(segments):
        for point in segment:
            of_point.setdefault(key_of(point), []).append(k)
    left, found = set(range(len(segments))), []
    starts = [(facets[0], point) for point, facets in of_point.items() if len(facets) == 1]
    while left:
        k, point = next(((k, point) for k, point in starts if k in left),
                        (min(left), key_of(segments[min(left)][0])))
        while k is not None:
            left.discard(k)
            turned = key_of(segments[k][0]) != point
            found.append((k, turned))
            point = key_of(segments[k][0 if turned else 1])
            k = next((other for other in of_point[point] if other in left), None)
    order, turned = map(np.array, zip(*found))
    return order, turned


def key_of(point):
    return tuple(np.round(point, 9))


def boundary_of(curve, partner):
    """A contact boundary that the case does not tell; its normals are those in the mean."""
    normal = partner.of_nodes["normal"][:, :2].mean(axis=0)
    return Boundary(curve.points[curve.cells, :2], np.tile(normal, (len(curve.cells), 1)))


class Bodies:
    """The mesh of a case at the middle of the box, its parameters and its boundaries by name."""

    def __init__(self, path):
        self.answer = read_grid(path)
        self.mesh, surface = (read_grid(beside(path, name)) for name in ("_mesh", "_surface"))
        self.points = self.answer.points[:len(self.mesh.points), :2]  # mapped; then middles of edges
        self.size = np.ptp(self.points, axis=0).max()
        self.groups = {name: values > 0 for name, values in surface.of_cells.items() if name != FREE}
        self.facets = surface.cells
        self.contacts, self.curves = partners(path), contact_grids(path, self.answer)
        self.planar = self.answer.of_nodes["u"].ndim == 2

    def boundary(self, names):
        names = [name for name in ([names] if isinstance(names, str) else names)
                 if name in self.groups]
        if not names:
            return None
        facets = self.facets[np.any([self.groups[name] for name in names], axis=0)]
        corner = {}
        for cell in self.mesh.cells:
            for i in range(3):
                corner[tuple(sorted((cell[i], cell[i - 2])))] = cell[i - 1]
        segments = self.points[facets]
        inside = self.points[[corner[tuple(sorted(facet))] for facet in facets]]
        tangents = segments[:, 1] - segments[:, 0]
        normals = np.column_stack([tangents[:, 1], -tangents[:, 0]])
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        normals *= -np.sign(np.sum(normals * (inside - segments[:, 0]), axis=1))[:, None]
        order, turned = chained(segments)
        segments = segments[order]
        segments[turned] = segments[turned, ::-1]
        return Boundary(segments, normals[order])

    def holds(self, point):
        """Whether a point is inside of a body."""
        corners = self.points[self.mesh.cells]
        a, b, c = (corners[:, i] - corners[:, i - 1] for i in range(3))
        turns = [way[:, 0] * (point - corners[:, i - 1])[:, 1] - way[:, 1] * (point - corners[:, i - 1])[:, 0]
                 for i, way in enumerate((a, b, c))]
        return bool(np.any(np.all(np.array(turns) > 0, axis=0) | np.all(np.array(turns) < 0, axis=0)))


# What a case file says

POWERS = {prefix: power for power, prefix in PREFIXES.items()}
DIMENSIONS = {"m": (1, 0), "N": (0, 1), "Pa": (-2, 1)}  # powers of length and force


def size_of(unit, units):
    """How many of the units of the case one of "um", "N/mm", "deg" is."""
    size = 1.0
    for sign, name, power in re.findall(r"([*/]?)\s*([A-Za-z]+)(?:\^(-?\d+))?", unit):
        own = np.pi / 180 if name == "deg" else 1.0
        for end, powers in DIMENSIONS.items():
            if name.endswith(end) and name[:-len(end)] in POWERS:
                own = 10.0 ** (POWERS[name[:-len(end)]] - sum(
                    times * POWERS[units[of][:-1]] for times, of in zip(powers, ("length", "force"))))
        size *= own ** ((-1 if sign == "/" else 1) * int(power or 1))
    return size


def number_of(text):
    """Value and unit of "50 um", of an expression without one; None for what is not simple."""
    value, _, unit = str(text).partition(" ")
    try:
        return float(value), unit.strip()
    except ValueError:
        return evaluated(text, FUNCTIONS), ""


def numbers_of(parameter):
    """Value and unit, "" without one, of the default and the bounds of a range, where they are there."""
    given = ([parameter["default"]] if "default" in parameter else []) + list(parameter.get("range", []))
    return [number_of(one) for one in given]


def unit_of(parameter):
    """That of its numbers without one."""
    units = [unit for _, unit in numbers_of(parameter) if unit]
    return parameter.get("unit", units[0] if units else "")


def values_of(case, answer):
    """Parameters and what is let, in the units of the case, as far as it can be told."""
    values = dict(FUNCTIONS)
    parameters, units = case.get("parameters", {}), case.get("units")

    def seen(value, unit):
        return value * size_of(unit, units) if units else value

    for name, parameter in parameters.items():
        value, unit = numbers_of(parameter)[0]
        if value is not None:
            values[name] = seen(value, unit or unit_of(parameter))
    values |= {name[3:]: seen(numbers[0], unit_of(parameters.get(name[3:], {})))
               for name, numbers in answer.of_all.items() if name.startswith("mu_")}
    for name, expression in case.get("let", {}).items():
        value = evaluated(expression, values)
        if value is not None:
            values[name] = value
    return values


def evaluated(expression, values):
    """None for what is not simple."""
    try:
        return eval(str(expression).replace("^", "**"), {"__builtins__": {}}, values)
    except (SyntaxError, NameError, TypeError):
        return None


def load_at(load, values, points, normals):
    """Forces at points of a boundary; None where they cannot be told."""
    values = values | {"x": points[:, 0], "y": points[:, 1]}
    if "pressure" in load:
        value = evaluated(load["pressure"], values)
        return None if value is None else -value * normals
    components = [evaluated(part, values) for part in load["traction"]]
    if any(part is None for part in components):
        return None
    return np.column_stack([np.broadcast_to(part, len(points)) for part in components])


def spoken(expression):
    return re.sub(r"\s+", " ", str(expression)).replace("**", "^")


def words_of_imposed(what):
    parts = [f"{name} = {spoken(value)}" for name, value in what.items() if name != "at"]
    return "ux = uy = 0" if parts == ["ux = 0", "uy = 0"] else ", ".join(parts)


def words_of_load(load):
    kind = next(name for name in ("pressure", "traction", "force") if name in load)
    value = load[kind]
    inner = ", ".join(map(spoken, value)) if isinstance(value, list) else spoken(value)
    return f"{kind} = ({inner})" if isinstance(value, list) else f"{kind} = {inner}"


def words_of_contact(contact):
    against = contact.get("against", {})
    words = f"with {against}" if isinstance(against, str) else f"on a rigid {next(iter(against), 'surface')}"
    friction = contact.get("friction") or {}
    return words + ", with friction" * bool(friction)
