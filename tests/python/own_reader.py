"""A reader of model.h5 in numpy and h5py, written by src/model/LAYOUT.md, which shares nothing with rbvi.

It answers models of one contact with a plane, a disk or an obstacle at rest, by the law at the nodes
(condensed) or by a cone. Not two bodies, whose B is integrated between two curves for each mu; nor
Nitsche's method and the published collocated law, which are nonlinear systems of their own.
"""

import re

import h5py
import numpy as np
from scipy.optimize import nnls

GAUSS = np.polynomial.legendre.leggauss(4)
FLAT = r"^(.*[?:,])?([^?:,]+)\?([^?:,]+):([^?:,]+)"  # the last choice of a text without parentheses


def expression(text):
    """An expression of a case in the words of Python."""
    parts = []

    def keep(part):
        parts.append(part)
        return f"@{len(parts) - 1}@"

    def flat(part):
        while "?" in part:
            part = re.sub(FLAT, lambda m: (m[1] or "") + keep(f"where({m[2]}, {m[3]}, {m[4]})"), part)
        return part

    while "(" in text:
        text = re.sub(r"\(([^()]*)\)", lambda m: keep(f"({flat(m[1])})"), text)
    text = flat(text)
    while "@" in text:
        text = re.sub(r"@(\d+)@", lambda m: parts[int(m[1])], text)
    return text.replace("^", "**").strip()


NAMES = {"hypot": np.hypot, "max": np.maximum, "min": np.minimum, "abs": np.abs, "sqrt": np.sqrt,
         "sin": np.sin, "cos": np.cos, "exp": np.exp, "log": np.log, "pi": np.pi, "where": np.where}


class Scene:
    """The case in scene/tree at one mu."""

    def __init__(self, tree, mu):
        self.tree = dict(line.split(": ", 1) for line in tree.splitlines() if ": " in line)
        self.names = dict(NAMES)
        for path, text in self.tree.items():
            if match := re.fullmatch(r"parameters\.(\w+)\.default", path):
                self.names[match[1]] = float(text)
        self.names.update(mu)
        self.contact = next(re.match(r"contact\.[^.]+", path)[0] for path in self.tree
                            if path.startswith("contact."))

    def value(self, path, points=np.zeros((1, 2))):
        """Of the expression there, at points."""
        names = {**self.names, "x": points[:, 0], "y": points[:, 1]}
        with np.errstate(all="ignore"):
            for one, text in self.tree.items():
                if one.startswith("let."):
                    names[one[4:]] = eval(expression(text), {}, names)
            return eval(expression(self.tree[path]), {}, names) + np.zeros(len(points))

    def vector(self, path, points, components=("[0]", "[1]")):
        return np.column_stack([self.value(path + end, points) for end in components])

    def mapped(self, points):
        if "map.scale" in self.tree:
            return points * self.value("map.scale")
        return self.vector("map", points) if "map[0]" in self.tree else points

    def facing(self, points):
        """(normal, gap, slip) of something rigid at points of the reference boundary."""
        against = f"{self.contact}.against"
        if f"{against}.plane.position" in self.tree:
            normal = self.vector(f"{against}.plane.normal", points)
            gap = (self.value(f"{against}.plane.position")
                   - np.sum(normal * self.mapped(points), axis=1))
        else:  # the boundary is on the unit circle, the normal is that of the body
            normal = points / np.linalg.norm(points, axis=1)[:, None]
            way = self.mapped(normal) - self.vector(f"{against}.disk.center", points)
            distance = np.linalg.norm(way, axis=1)
            gap = -np.sum(normal * way, axis=1) * (1 - self.value(f"{against}.disk.radius") / distance)
        imposed = next(path[:-3] for path in self.tree if re.fullmatch(r"imposed\..*\.ux", path))
        motion = self.vector(imposed, points, (".ux", ".uy"))
        return (normal, gap - np.sum(normal * motion, axis=1),
                normal[:, 0] * motion[:, 1] - normal[:, 1] * motion[:, 0])


def triangles(columns, blocks):
    """Symmetric matrices, the columns the lower triangles of their diagonal blocks: n x n x terms."""
    result, row, first = np.zeros((sum(blocks), sum(blocks), columns.shape[1])), 0, 0
    for end in np.cumsum(blocks):
        for j in range(first, end):
            result[j:end, j] = result[j, j:end] = columns[row:row + end - j]
            row += end - j
        first = end
    return result


def size(corners):
    """Length of a line, area of a triangle."""
    sides = corners[1:] - corners[0]
    return np.linalg.norm(sides) if len(sides) == 1 else abs(np.linalg.det(sides)) / 2


def schema_of(path):
    with open(path, "rb") as file:
        return int.from_bytes(file.read(48)[40:], "little")


class Model:
    def __init__(self, path):
        self.data = {}
        with h5py.File(path, "r") as file:
            file.visititems(lambda name, item: self.data.update({name: item[()]})
                            if isinstance(item, h5py.Dataset) else None)
        self.names = [name.decode() for name in self.data["parameters/names"]]
        self.dual = self.data["contact/dual_basis"]
        self.per_entity = self.data["interfaces/0/sizes"][3]
        self.entities = self.data["interfaces/0/entities"].reshape(-1, self.per_entity)

    def at(self, mu):
        """Outputs by name; mu: free parameters by name."""
        self.mu = {**dict(zip(self.names, self.data["parameters/value"])), **mu}
        self.scene = Scene(self.data["scene/tree"].decode(), self.mu)
        return self.by_law() if self.data["law/normal"] else self.by_cone()

    def sum_of(self, operator, kernel):
        """Of the terms, with the theta of interpolation; kernel: reference corners -> the entries of
        a cell."""
        data, at = self.data, f"{operator}/0"
        values = [np.ravel(kernel(cell)) for cell in
                  data[f"{at}/vertices"].reshape(-1, data[f"{at}/corners"], 2)]
        entries = np.zeros(len(data[f"{operator}/interpolation"]))
        for entry, cell, local in data[f"{at}/contributions"].reshape(-1, 3):
            entries[entry] += values[cell][local]
        theta = np.linalg.solve(data[f"{operator}/interpolation"], entries)
        return data[f"{operator}/reduced"] @ theta, theta

    def on_edge(self, ends):
        """(b, g) of an edge of a support: rows its two normal multipliers, then the tangential."""
        b, g = np.zeros((4, self.per_entity, 2)), np.zeros(4)
        for s, weight in zip((1 + GAUSS[0]) / 2, GAUSS[1] / 2 * size(self.scene.mapped(ends))):
            normal, gap, slip = (of[0] for of in self.scene.facing(
                ((1 - s) * ends[0] + s * ends[1])[None]))
            phi = ([1 - s, s] if self.per_entity == 2 else
                   [(1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s)])
            for a, eta in enumerate((1 - s, s)):
                b[a] += weight * eta * np.outer(phi, normal)
                b[2 + a] += weight * eta * np.outer(phi, [-normal[1], normal[0]])
                g[[a, 2 + a]] += weight * eta * np.array([gap, -slip])
        return b, g

    def pressure_outputs(self, corners, pressure):
        points, weights = self.scene.mapped(self.data["interfaces/0/points"]), np.zeros(len(pressure))
        for nodes in self.entities[:, :corners]:
            weights[nodes] += size(points[nodes]) / corners
        return {"normal_force": weights @ pressure, "peak_pressure": pressure.max()}

    def condensed(self, theta):
        """H = B A^-1 B^T."""
        data = self.data
        weights = np.ones(data["law/shape"].shape[1])
        axes, z = data["law/axes"].reshape(-1, 3), data["law/abscissae"]
        for (axis, lower, upper), numbers in zip(axes, data["law/points"].reshape(len(weights), -1).T):
            value = self.mu[self.names[int(axis)]]
            if 0 < 3 * data["parameters/lower"][int(axis)] < data["parameters/upper"][int(axis)]:
                value = np.log(value)
            x = (2 * value - lower - upper) / (upper - lower)
            weights *= [np.prod((x - z[:k]) / (z[k] - z[:k])) for k in numbers]
        of_block = data["law/shape"] @ weights
        coefficients = [theta[p] * theta[q] * of_block
                        for p in range(len(theta)) for q in range(p, len(theta))]
        return triangles(data["law/terms"], data["law/blocks"]) @ np.concatenate(coefficients)

    def by_law(self):
        count, law = self.data["law/normal"], f"{self.scene.contact}.friction.coulomb"
        h = self.condensed(self.sum_of("b", lambda ends: self.on_edge(ends)[0])[1])
        g = self.sum_of("g", lambda ends: self.on_edge(ends)[1])[0]
        friction = len(g) > count
        x = law_at_nodes(h, g, count, self.scene.value(law)[0] if friction else 0)
        pressure, shear = np.split(self.dual @ x, [len(self.dual) // (2 if friction else 1)])
        outputs = {"energy": x @ h @ x / 2, **self.pressure_outputs(2, pressure)}
        points, force = self.scene.mapped(self.data["interfaces/0/points"]), 0
        for edge in self.entities[:, :2] if friction else ():
            s, t = shear[edge]
            mean = (abs(s + t) if s * t >= 0 else (s * s + t * t) / abs(s - t)) / 2
            force += size(points[edge]) * mean
        return {**outputs, "tangential_force": force} if friction else outputs

    def by_cone(self):
        scene, n = self.scene, len(self.data["f/reduced"])
        load = scene.value(next(path for path in scene.tree if re.match(r"loads\..*\.force", path)))

        def stiffness(cell):
            gradients = np.linalg.inv(np.column_stack([np.ones(3), scene.mapped(cell)]))[1:]
            return size(scene.mapped(cell)) * gradients.T @ gradients

        def share(cell):
            return size(scene.mapped(cell)) / 3

        a = triangles(self.sum_of("a", stiffness)[0][:, None], [n])[:, :, 0]
        f = self.sum_of("f", lambda cell: np.full(3, load * share(cell)))[0]
        b = self.sum_of("b", lambda cell: -share(cell) * np.eye(3))[0].reshape(n, -1).T
        g = self.sum_of("g", lambda cell: -share(cell) * scene.value(f"{scene.contact}.above",
                                                                     scene.mapped(cell)))[0]
        x = cone(a, b, f, g, self.data["size/free_modes"])
        u = np.linalg.solve(a, f - b.T @ x)
        return {"energy": u @ a @ u / 2 - f @ u, **self.pressure_outputs(3, self.dual @ x)}


def law_at_nodes(h, g, count, coefficient):
    """x and w = H x + g: x_n, w_n >= 0 with x_n w_n = 0, and Coulomb's law on the rest, by active
    sets, the coefficient of friction rising to its value from the answer without."""
    x, unit = np.zeros(len(g)), np.eye(len(g))
    for bound in coefficient * np.linspace(0, 1, 21 if coefficient else 1):
        for _ in range(200):
            trial = x - (h @ x + g) / np.diag(h)
            matrix, rest = h.copy(), -g
            for row in range(len(g)):
                node = row % count
                touches = trial[node] > 0
                if touches and (row < count or abs(trial[row]) < bound * x[node]):
                    continue  # w is zero there
                matrix[row], rest[row] = unit[row], 0
                if touches:  # it slips
                    matrix[row, node] = -bound * np.sign(trial[row])
            before, x = x, np.linalg.solve(matrix, rest)
            if np.abs(x - before).max() <= 1e-13 * np.abs(x).max():
                break
        else:
            raise ArithmeticError("active sets do not settle")
    return x


def cone(a, b, f, g, free_modes):
    """x of min x . B A^-1 B^T x / 2 + (g - B A^-1 f) . x, x >= 0 but for the last ones."""
    root, held = np.linalg.cholesky(a), len(g) - free_modes
    y, load = np.linalg.solve(root, b.T), np.linalg.solve(root, f)
    target = load - np.linalg.lstsq(y.T, g, rcond=None)[0]
    found = nnls(np.column_stack([y, -y[:, held:]]), target, maxiter=100 * len(g))[0]
    which = np.append(np.flatnonzero(found[:held]), np.arange(held, len(g)))
    x = np.zeros(len(g))
    x[which] = np.linalg.lstsq(y[:, which], target, rcond=None)[0]
    return x
