"""Matrices of the two scenes of chapter 2 for their studies, assembled with numpy and scipy on the mesh
of a run: continuous linear displacements on straight triangles, consistent masses, exact integrals (the
variants `published`). The dofs are those that no boundary fixes; `contact` of them meet multipliers.
"""

import h5py
import numpy as np
import scipy.sparse as sparse

PAIRS = np.array([[2, 1, 1], [1, 2, 1], [1, 1, 2]]) / 12
# Six points of degree 4 on a triangle: barycentric coordinates, weights.
POINTS = np.array([np.roll([1 - 2 * a, a, a], k) for a in (0.445948490915965, 0.091576213509771)
                   for k in range(3)])
WEIGHTS = np.repeat([0.223381589678011, 0.109951743655322], 3)


def areas_and_gradients(points, cells):
    """Of each triangle: its area, and the gradients of its three hat functions (cells x 3 x 2)."""
    x = points[cells]
    sides = np.roll(x, -2, axis=1) - np.roll(x, -1, axis=1)  # opposite to each vertex
    area = 0.5 * (sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])
    assert area.min() > 0, "a cell is inverted"
    return area, np.stack([-sides[:, :, 1], sides[:, :, 0]], axis=2) / (2 * area[:, None, None])


def summed(cells, blocks, size):
    rows, columns = np.repeat(cells, cells.shape[1], axis=1), np.tile(cells, cells.shape[1])
    return sparse.csr_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), (size, size))


def mass(points, cells, size):
    area, _ = areas_and_gradients(points, cells)
    return summed(cells, area[:, None, None] * PAIRS, size)


def stiffness(points, cells):
    area, gradients = areas_and_gradients(points, cells)
    return summed(cells, area[:, None, None] * gradients @ gradients.transpose(0, 2, 1), len(points))


class Run:
    """Mesh, bases and snapshots of a run directory. Fields have the free dofs alone."""

    def __init__(self, run, free, contact_nodes):
        self.path, self.free = run, free
        with h5py.File(run / "model.h5") as model:
            self.generators = model["contact/dual_basis"][()]
            self.modes_count = int(model["size/modes"][()])
            self.training = model["training/mu"][()].T
        with h5py.File(run / "model.fields.h5") as fields:
            self.basis = fields["primal_basis"][()][free]
        self.contact_nodes = contact_nodes

    @property
    def modes(self):
        return self.basis[:, :self.modes_count]

    def snapshots(self, mus):
        """Columns u and lambda of the samples at these parameters."""
        found = {}
        for path in (self.path / "samples").glob("*.h5"):
            with h5py.File(path) as sample:
                found[tuple(sample["mu"][()])] = (sample["u"][()][self.free], sample["lambda"][()])
        return [np.column_stack(columns) for columns in zip(*(found[tuple(mu)] for mu in mus))]


def mesh_of(run):
    with h5py.File(run / "model.fields.h5") as fields:
        points, cells = fields["points"][()], fields["cells"][()].reshape(-1, 3)
    with h5py.File(run / "model.h5") as model:
        return points, cells, model["interfaces/0/nodes"][()]


class Membrane:
    """Over an obstacle (2.36)-(2.40), variant `published`. mu = (radius, center_x, center_y)."""

    def __init__(self, run, disc_map):
        self.points, self.cells, self.disc = mesh_of(run)
        self.disc_map = disc_map
        self.free = np.flatnonzero(np.abs(self.points).max(axis=1) < 0.5 - 1e-9)
        self.contact = np.searchsorted(self.free, self.disc)
        self.run = Run(run, self.free, self.disc)
        local = np.full(len(self.points), -1)
        local[self.disc] = np.arange(len(self.disc))
        inside = np.hypot(*self.points[self.cells].mean(axis=1).T) < 0.2
        self.disc_cells = local[self.cells[inside]]

    def mapped(self, mu):
        radius, *center = mu
        rho = np.hypot(*self.points.T)
        way = np.clip((rho - 0.2) / 0.3, 0, 1)
        fade = (1 - way)**2 * (1 + 2 * way)
        scale = radius / 0.2
        if self.disc_map == "graded":
            scale = scale * (1 + 0.05 * ((radius - 0.2) / 0.04 + self.points @ center / 0.01)
                             * (1 - (rho / 0.2)**2))
        outside = rho > 0.2 + 1e-12
        stretch = np.where(outside, 1 + fade * (radius - 0.2) / np.maximum(rho, 0.1), scale)
        return stretch[:, None] * self.points + np.where(outside, fade, 1)[:, None] * center

    def _points(self, mu):
        return self.points if mu is None else self.mapped(mu)

    def v(self, mu=None):
        """Product of V on the reference domain, or on that of mu."""
        at = self._points(mu)
        whole = mass(at, self.cells, len(at)) + stiffness(at, self.cells)
        return whole[self.free][:, self.free]

    def _mass(self, mu):
        return mass(self._points(mu)[self.disc], self.disc_cells, len(self.disc))

    def w(self, mu=None):
        return self._mass(mu).toarray()

    def covered(self, _):
        """The multipliers that face a partner everywhere."""
        return np.arange(len(self.disc))

    def a(self, mu):
        return stiffness(self.mapped(mu), self.cells)[self.free][:, self.free]

    def f(self, mu):
        area, _ = areas_and_gradients(self.mapped(mu), self.cells)
        return (-25 * np.bincount(self.cells.ravel(), np.repeat(area / 3, 3)))[self.free]

    def b(self, mu):
        """Rows: multipliers; columns: the dofs `contact`."""
        return -self._mass(mu)

    def g(self, mu):
        x = self.mapped(mu)[self.disc]
        at = np.einsum("qv,cvx->cqx", POINTS, x[self.disc_cells])
        psi = -1.25 * ((at - mu[1:])**2).sum(axis=2) / mu[0]**2
        area, _ = areas_and_gradients(x, self.disc_cells)
        parts = area[:, None] * np.einsum("q,cq,qv->cv", WEIGHTS, psi, POINTS)
        return -np.bincount(self.disc_cells.ravel(), parts.ravel(), len(self.disc))


class Disks:
    """Two half-disks (2.43)-(2.52), variant `published`; `intersected`: exact integrals, else by the
    Gauss points of the upper edges. mu = (radius of the lower one). Displacements are measured from
    the rigid motion of each body. Dofs: x and y of each node."""

    CLOSER, GAP, YOUNG, POISSON = 0.09, 0.001, 15, 0.35

    def __init__(self, run, intersected):
        self.points, self.cells, nodes = mesh_of(run)
        self.intersected = intersected
        x, y = self.points.T
        flat = np.abs(np.abs(y) - 1.5) < 1e-9
        fixed = np.column_stack([flat | (x < 1e-9), flat]).ravel()
        self.free = np.flatnonzero(~fixed)
        half = len(nodes) // 2
        self.arcs = nodes[:half], nodes[half:]  # upper, lower; by x
        dofs = 2 * nodes + 1
        self.contact = np.searchsorted(self.free, dofs)
        self.run = Run(run, self.free, nodes)

    def mapped(self, mu):
        x, y = self.points.T
        upper = y > 0
        return np.column_stack([np.where(upper, x, mu[0] * x),
                                np.where(upper, y - 0.5 + self.GAP, mu[0] * (y + 0.5))])

    def _both(self, matrix):
        return sparse.kron(matrix, sparse.identity(2)).tocsr()[self.free][:, self.free]

    def v(self, mu=None):
        at = self.points if mu is None else self.mapped(mu)
        return self._both(mass(at, self.cells, len(at)) + stiffness(at, self.cells))

    def w(self, mu=None):  # the upper body does not depend on mu
        return np.diag(self._lengths().reshape(-1, 2).sum(axis=1))

    def _lengths(self):
        return np.hypot(*np.diff(self.points[self.arcs[0]], axis=0).T)

    def a(self, _):  # a disk in the plane has the stiffness of every other
        area, gradients = areas_and_gradients(self.points, self.cells)
        strain = np.zeros((len(area), 3, 6))
        strain[:, 0, 0::2] = strain[:, 2, 1::2] = gradients[:, :, 0]
        strain[:, 1, 1::2] = strain[:, 2, 0::2] = gradients[:, :, 1]
        e, nu = self.YOUNG, self.POISSON
        first, shear = e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))
        law = np.array([[first + 2 * shear, first, 0], [first, first + 2 * shear, 0], [0, 0, shear]])
        blocks = area[:, None, None] * strain.transpose(0, 2, 1) @ law @ strain
        dofs = (2 * self.cells[:, :, None] + np.arange(2)).reshape(len(area), 6)
        return summed(dofs, blocks, 2 * len(self.points))[self.free][:, self.free]

    def f(self, _):
        return np.zeros(len(self.free))

    def _rule(self, mu):
        """Upper edge, place along it, weight of each integration point with a partner."""
        at = self.mapped(mu)
        upper, lower = at[self.arcs[0], 0], at[self.arcs[1], 0]
        ends = upper
        if self.intersected:
            ends = np.unique(np.concatenate([upper, lower[lower < upper[-1]]]))
        ends = ends[ends <= lower[-1] + 1e-14] if self.intersected else ends
        gauss = (np.array([-1, 1]) / np.sqrt(3) + 1) / 2
        x = (ends[:-1, None] + np.diff(ends)[:, None] * gauss).ravel()
        edge = np.clip(np.searchsorted(upper, x) - 1, 0, len(upper) - 2)
        slope = self._lengths() / np.diff(upper)
        weight = np.repeat(np.diff(ends) / 2, 2) * slope[edge]
        with_partner = x <= lower[-1] + 1e-14
        return edge[with_partner], x[with_partner], weight[with_partner]

    def covered(self, mu):
        at = self.mapped(mu)
        return np.flatnonzero(at[self.arcs[0][2::2], 0] <= at[self.arcs[1][-1], 0] + 1e-9)

    def _values(self, mu):
        """Rule, and the hat functions of both arcs at its points: rows for `contact`, upper - lower."""
        at, (edge, x, weight) = self.mapped(mu), self._rule(mu)
        rows = np.arange(len(x))
        parts = []
        for arc in self.arcs:
            along = at[arc, 0]
            left = np.clip(np.searchsorted(along, x) - 1, 0, len(along) - 2)
            share = (x - along[left]) / (along[left + 1] - along[left])
            parts.append(sparse.csr_matrix((np.concatenate([1 - share, share]),
                                            (np.tile(rows, 2), np.concatenate([left, left + 1]))),
                                           (len(x), len(arc))))
        return edge // 2, weight, sparse.hstack([parts[0], -parts[1]]).tocsr()

    def _integrals(self, macro, weight):
        return sparse.csr_matrix((weight, (macro, np.arange(len(macro)))),
                                 (len(self.arcs[0]) // 2, len(macro)))

    def b(self, mu):
        macro, weight, jump = self._values(mu)
        return -self._integrals(macro, weight) @ jump

    def g(self, mu):
        macro, weight, jump = self._values(mu)
        y = self.mapped(mu)[np.concatenate(self.arcs), 1]
        y = y + np.repeat([-self.CLOSER, self.CLOSER], len(self.arcs[0]))
        return self._integrals(macro, weight) @ (jump @ y)
