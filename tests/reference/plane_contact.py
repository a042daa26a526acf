"""Elasticity, plane or about an axis, with contact and friction at nodes, for the programs of this folder.

Quadratic triangles with curved sides on meshes of mapped squares; contact holds at every node of the
boundary, those amid the sides as well, with the whole force on the node as unknown (on a side of three
nodes these forces are 1/6, 4/6 and 1/6 of its length times the pressure). It shares nothing with rbvi.
"""

import csv
import functools
from pathlib import Path

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

# On a side with the coordinate 0..1: Gauss points of degree 5; Simpson's weights of its three nodes.
SIMPSON = np.array([1, 4, 1]) / 6
# Of a triangle: seven points of degree 5.
_A, _B = (6 - np.sqrt(15)) / 21, (6 + np.sqrt(15)) / 21
POINTS = np.array([[1 / 3, 1 / 3], [_A, _A], [1 - 2 * _A, _A], [_A, 1 - 2 * _A],
                   [_B, _B], [1 - 2 * _B, _B], [_B, 1 - 2 * _B]])
WEIGHTS = np.array([9 / 80] + 3 * [(155 - np.sqrt(15)) / 2400] + 3 * [(155 + np.sqrt(15)) / 2400])


def graded(start, end, count, towards):
    """2 count + 1 nodes from start to end, those between vertices in their middle; finer towards
    'start', 'end', 'both' or nothing by the cube of the distance."""
    t = np.linspace(0, 1, count + 1)
    if towards == "start":
        t = t**3
    elif towards == "end":
        t = 1 - (1 - t)**3
    elif towards == "both":
        t = np.where(t < 0.5, 4 * t**3, 1 - 4 * (1 - t)**3)
    vertices = start + (end - start) * t
    nodes = np.empty(2 * count + 1)
    nodes[::2], nodes[1::2] = vertices, (vertices[1:] + vertices[:-1]) / 2
    return nodes


class Mesh:
    """Blocks of squares, each cut into two triangles of six nodes; nodes at one place are one node,
    but for those of different bodies."""

    def __init__(self):
        self.points, self.triangles, self.regions, self._at = [], [], [], {}

    def _node(self, x, y, body):
        key = (round(x * 1e7), round(y * 1e7), body)
        if key not in self._at:
            self._at[key] = len(self.points)
            self.points.append((x, y))
        return self._at[key]

    def block(self, x, y, region, body=0):
        """x, y: places of the nodes, (2 n + 1) x (2 m + 1)."""
        n = np.array([[self._node(x[i, j], y[i, j], body) for j in range(x.shape[1])]
                      for i in range(x.shape[0])])
        for i in range(0, x.shape[0] - 2, 2):
            for j in range(0, x.shape[1] - 2, 2):
                a, b, c, d = n[i, j], n[i + 2, j], n[i + 2, j + 2], n[i, j + 2]
                mid = n[i + 1, j + 1]
                self.triangles.append((a, b, c, n[i + 1, j], n[i + 2, j + 1], mid))
                self.triangles.append((a, c, d, mid, n[i + 1, j + 2], n[i, j + 1]))
                self.regions += [region, region]

    def rectangle(self, x, y, region, body=0):
        self.block(*np.meshgrid(x, y, indexing="ij"), region, body)

    def between(self, inner, outer, share, region, body=0):
        """Nodes from the line `inner` to the line `outer`, both 2 x (2 n + 1), at these shares of the way."""
        self.block(*(inner[:, :, None] + (outer - inner)[:, :, None] * share), region, body)

    def quarter_disk(self, radius, low, high, out, place, body=0, region=0):
        """From its lowest point, at angles `low` up to 45 degrees and `high` from there to the flat side;
        out: from the square amid it (0) to the arc (1); place: where of (x, y) about its centre."""
        side = radius / 2
        across, up = side * low / (np.pi / 4), side * (high / (np.pi / 4) - 2)
        self.block(*place(*np.meshgrid(across, up, indexing="ij")), region, body)
        sides = (low, (across, np.full_like(low, -side))), (high, (np.full_like(high, side), up))
        for angle, inner in sides:
            arc = radius * np.array([np.sin(angle), -np.cos(angle)])
            self.between(np.array(place(*inner)), np.array(place(*arc)), out, region, body)

    def done(self):
        self.points = np.array(self.points)
        self.triangles = np.array(self.triangles)
        self.regions = np.array(self.regions)
        return self

    def nodes(self, where):
        return np.flatnonzero(where(self.points[:, 0], self.points[:, 1]))


def shapes(r, s):
    """Values and derivatives of the six quadratic functions at a point of the reference triangle."""
    t = 1 - r - s
    values = np.array([t * (2 * t - 1), r * (2 * r - 1), s * (2 * s - 1), 4 * r * t, 4 * r * s, 4 * s * t])
    by_r = np.array([1 - 4 * t, 4 * r - 1, 0, 4 * (t - r), 4 * s, -4 * s])
    by_s = np.array([1 - 4 * t, 0, 4 * s - 1, -4 * r, 4 * r, 4 * (t - s)])
    return values, np.array([by_r, by_s])


def stiffness(mesh, elasticity):
    """elasticity[region]: 3 x 3, of (e_xx, e_yy, 2 e_xy); or 4 x 4 with the strain about the axis x = 0 as
    the last: then of the whole circumference."""
    xy = mesh.points[mesh.triangles]
    matrix = np.zeros((len(xy), 12, 12))
    law = np.array([elasticity[region] for region in range(1 + max(mesh.regions))])[mesh.regions]
    sides = []
    for (r, s), weight in zip(POINTS, WEIGHTS):
        values, by = shapes(r, s)
        jacobian = np.einsum("da,eax->edx", by, xy)
        determinant = np.linalg.det(jacobian)
        sides.append(np.sign(determinant))
        gradient = np.linalg.solve(jacobian, np.broadcast_to(by, (len(xy), 2, 6)))
        b = np.zeros((len(xy), law.shape[1], 12))
        b[:, 0, 0::2], b[:, 1, 1::2] = gradient[:, 0], gradient[:, 1]
        b[:, 2, 0::2], b[:, 2, 1::2] = gradient[:, 1], gradient[:, 0]
        volume = weight * np.abs(determinant)
        if law.shape[1] == 4:
            radius = xy[:, :, 0] @ values
            b[:, 3, 0::2] = values / radius[:, None]
            volume *= 2 * np.pi * radius
        matrix += volume[:, None, None] * np.einsum("eki,ekl,elj->eij", b, law, b, optimize=True)
    assert (np.array(sides) == sides[0]).all(), "a triangle is turned over"
    dofs = np.stack([2 * mesh.triangles, 2 * mesh.triangles + 1], 2).reshape(len(xy), 12)
    rows, columns = np.repeat(dofs, 12, 1).ravel(), np.tile(dofs, (1, 12)).ravel()
    size = 2 * len(mesh.points)
    return sparse.csc_matrix((matrix.ravel(), (rows, columns)), (size, size))


def plane_stress(young, nu):
    return young / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])


def plane_strain(young, nu):
    return plane_stress(young / (1 - nu**2), nu / (1 - nu))


def about_axis(young, nu):
    shear, first = young / (2 * (1 + nu)), young * nu / ((1 + nu) * (1 - 2 * nu))
    return np.diag([2 * shear, 2 * shear, shear, 2 * shear]) + first * np.outer([1, 1, 0, 1], [1, 1, 0, 1])


def shares(at):
    """Of each node in the line on which they are `at`, in order: Simpson's weights."""
    share = np.zeros(len(at))
    for i in range(0, len(at) - 2, 2):
        share[i:i + 3] += (at[i + 2] - at[i]) * SIMPSON
    return share


def lengths(mesh, nodes, along=0):
    """The share of each node of a straight boundary, given in any order."""
    order = np.argsort(mesh.points[nodes, along])
    share = np.zeros(len(nodes))
    share[order] = shares(mesh.points[nodes, along][order])
    return share


def newton(compliance, at_rest, friction, threshold, state, border):
    """Semismooth Newton from nodes that touch and the sides to which they slide; None in circles."""
    touches, slides = state
    n, (motions, load) = len(at_rest) // 2, border
    rough, always = friction + threshold > 0, threshold > 0
    matrix_of_all = np.block([[compliance, -motions], [motions.T, np.zeros((len(load), len(load)))]])
    for _ in range(40):
        matrix, right = np.eye(2 * n + len(load)), np.append(np.zeros(2 * n), load)
        rubs = (touches | always) & rough
        stick = rubs & (slides == 0)
        rows = np.concatenate([np.flatnonzero(touches), n + np.flatnonzero(stick)])
        right[rows] = at_rest[rows]
        rows = np.append(rows, np.arange(2 * n, len(right)))
        matrix[rows] = matrix_of_all[rows]
        slip = np.flatnonzero(rubs & ~stick)
        matrix[n + slip, slip] = -friction[slip] * slides[slip]
        right[n + slip] = threshold[slip] * slides[slip]
        found = np.linalg.solve(matrix, right)
        w = at_rest - matrix_of_all[:2 * n] @ found
        p, q, w_n, w_t = found[:n], found[n:2 * n], w[:n], w[n:]
        small, short = 1e-11 * abs(p).max(initial=0), 1e-11 * abs(at_rest).max()
        now = np.where(touches, p > -small, w_n > short)
        side = np.where(stick, np.where(abs(q) > friction * p + threshold + small, np.sign(q), 0),
                        np.where(slides * w_t > -short, slides, 0))
        side = np.where(touches | always, side, np.sign(w_t)) * ((now | always) & rough)
        if (now == touches).all() and (side == slides).all():
            return p, q, found[2 * n:], (touches, slides)
        touches, slides = now, side
    return None


def solve_laws(compliance, at_rest, friction, border=None, threshold=0.0, guess=None):
    """Forces p >= 0 and q with |q| <= friction p + threshold on n nodes: w = at_rest - compliance [p, q] +
    motions beta has w_n <= 0, p w_n = 0, and w_t along q where |q| is at its bound, else 0; motions that
    nothing else holds have motions^T [p, q] = load (`border`: motions, load). guess: which nodes touch, and
    the sides to which they slide. Returns p, q, beta. Friction grows from 0, or falls from where all
    sticks, where Newton's method goes in circles otherwise."""
    n = len(at_rest) // 2
    if border is None:
        border = np.zeros((2 * n, 0)), np.zeros(0)
    friction, threshold = np.broadcast_to(friction, n), np.broadcast_to(threshold, n)
    held = border[0].shape[1] == 0
    for steps in (1, 4, 16, 64, 256):
        state = at_rest[:n] > 0, np.sign(at_rest[n:]) * (friction + threshold > 0) if held else np.zeros(n)
        state = state if guess is None else guess
        for k in range(steps):
            share = (k + 1) / steps if held else 10 ** (1 - (k + 1) / steps)
            found = newton(compliance, at_rest, friction * share, threshold * share, state, border)
            if found is None:
                break
            state = found[3]
        if found is not None:
            return found[:3]
    raise RuntimeError("contact was not found")


class Contact:
    """Bodies with u = 0 at the dofs `held`, and what they give along the directions `rows`, sparse
    rows of dofs: first those out of the body, as many along the boundary behind them."""

    def __init__(self, matrix, held, rows):
        free = np.setdiff1d(np.arange(matrix.shape[0]), held)
        at = np.isin(free, rows.indices)
        inner, at = free[~at], free[at]
        factor = functools.partial(splu, diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        order = np.argsort(factor(matrix[inner][:, inner], permc_spec="MMD_AT_PLUS_A").perm_c)
        self.free = np.concatenate([inner[order], at])  # contact last: the end of the factors is its own
        self.factors = factor(matrix[self.free][:, self.free], permc_spec="NATURAL")
        end = self.factors.perm_c[len(inner):]
        assert (self.factors.perm_r[len(inner):] == end).all()
        schur = (self.factors.L[end][:, end] @ self.factors.U[end][:, end]).toarray()
        self.rows = rows[:, self.free].tocsr()
        ends = rows[:, at].toarray()
        self.compliance = ends @ np.linalg.solve(schur, ends.T)

    def solve(self, load, gap, friction, motion=None, threshold=0.0, guess=None):
        """Forces of contact p, q, and u, of loads and of the gaps along the first rows, or along all.
        `motion`, a column or several, is rigid and held by what is to carry nothing: springs in `matrix`, or
        dofs away from contact."""
        at_rest = self.rows @ self.factors.solve(load[self.free])
        at_rest[:len(gap)] -= gap
        border = None
        if motion is not None:
            motion = motion.reshape(len(load), -1)
            border = self.rows @ motion[self.free], motion.T @ load
        p, q, beta = solve_laws(self.compliance, at_rest, friction, border, threshold, guess)
        u = np.zeros(len(load))
        u[self.free] = self.factors.solve(load[self.free] - self.rows.T @ np.append(p, q))
        if motion is not None:
            u += motion @ beta
        return p, q, u


def extrapolated(values):
    """Of three meshes, each twice as fine as the one before: the limit, and how far it is uncertain."""
    a, b, c = values
    ratio = (c - b) / (b - a) if b != a else 0
    limit = c + (c - b) * ratio / (1 - ratio) if 0 < ratio < 0.7 else c
    return limit, max(abs(limit - c), abs(c - b) / 4)


def main(arguments, values_at, places, meshes, stated=None, law=None):
    """The program of a case: values_at(mu, n) of meshes that are each twice as fine as the one before.
    Prints them with their uncertainty, or compares those of expected.csv of the folder in arguments, which
    are uncertain by stated(mu, quantity, value); law: what of mu is in its column of options,
    or None for a row that is another program's.
    Returns the exit status."""
    def answers(mu):
        of_meshes = [values_at(mu, n) for n in meshes]
        return {name: extrapolated([values[name] for values in of_meshes]) for name in of_meshes[0]}

    if len(arguments) < 2:
        for mu in places:
            for quantity, (value, error) in answers(mu).items():
                print(*mu, quantity, f"{value:.7g}", f"{error:.1e}", sep=",")
        return 0
    with open(Path(arguments[1]) / "expected.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    found, wrong = {}, False
    for row in rows:
        mu = tuple(map(float, list(row.values())[:list(row).index("quantity")]))
        of_options = law(row["options"]) if law else ()
        if of_options is None:
            continue
        mu += of_options
        if mu not in found:
            found[mu] = answers(mu)
        expected, (value, error) = float(row["value"]), found[mu][row["quantity"]]
        allowed = stated(mu, row["quantity"], expected) if stated else 0
        ok = abs(expected - value) <= allowed + error + 1e-6 * abs(value)  # and the digits that are written
        wrong |= not ok
        print(f"{'ok' if ok else 'WRONG':5} {mu} {row['quantity']:18} {expected:.7g} within {allowed:.1e}, "
              f"here {value:.7g} within {error:.1e}", flush=True)
    return int(wrong or not found)
