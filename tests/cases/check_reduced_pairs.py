#!/usr/bin/env python3
"""Cones, constants and the double greedy algorithm of cases/reduced_pairs.py: closed forms, all faces of
a cone one by one, and a string over an obstacle; masses and stiffnesses of cases/study_matrices.py.

    check_reduced_pairs.py ROOT
"""

import sys
from itertools import combinations
from pathlib import Path

import numpy as np
import scipy.linalg as dense
import scipy.sparse as sparse

sys.path.insert(0, str(Path(sys.argv[1]) / "cases"))

from reduced_pairs import (DoubleGreedy, Problem, Space, cone_constant, cone_error, constants, descend,
                           enlarged_cone, high_fidelity_constants, orthonormal,
                           orthonormal_combinations, pairwise_bound, quotient, stability)
from study_matrices import mass, stiffness

RNG = np.random.default_rng(7)


def root_of(gram):
    return np.linalg.cholesky(gram).T


def two_dimensions():
    """|S a|^2 = 1 + 2 c a_1 a_2 for |a| = 1: sqrt(1 - |c|) over the plane. Over the quadrant 1 at its
    ends for c > 0; for c < 0 the minimiser of the plane, (1, 1), lies in it."""
    for c in (0.6, -0.6):
        s = root_of(np.array([[1, c], [c, 1]]))
        upper, lower, span, a = cone_constant(s, np.eye(2))
        assert np.isclose(span, np.sqrt(1 - abs(c)))
        assert np.isclose(upper, 1 if c > 0 else span), (c, upper)
        assert np.isclose(lower, upper), (c, lower)
        assert np.isclose(quotient(s, np.eye(2), a), upper) and a.min() >= 0


def dependent():
    """A generator in the span of those before is left out, one that is nearly there is not."""
    c = RNG.normal(size=(8, 3))
    c = np.column_stack([c, c @ [1, 2, 3], c @ [1, 1, 0] + 1e-4 * RNG.normal(size=8)])
    back = orthonormal_combinations(c)
    assert back.shape == (5, 4) and not back[3].any()
    assert np.allclose((c @ back).T @ (c @ back), np.eye(4))


def least_of_faces(s, c):
    """The minimum over a >= 0: in the face where it is taken it is an eigenvector without zeros."""
    least = np.inf
    for size in range(1, s.shape[1] + 1):
        for face in map(list, combinations(range(s.shape[1]), size)):
            for a in dense.eigh(s[:, face].T @ s[:, face], c[:, face].T @ c[:, face])[1].T:
                if (a >= 0).all() or (a <= 0).all():
                    least = min(least, quotient(s[:, face], c[:, face], a))
    return least


def faces():
    """Descents end at the minimum over all faces; the lower value is below it, and that of the span is
    below both. Here entries have both signs, so that the bound by pairs says nothing; with entries
    >= 0 alone it holds."""
    inside = searched = 0
    for k in range(30):
        s, c = RNG.normal(size=(5 + k % 3, 6)), root_of(np.eye(6) + 0.3 * RNG.random() * np.ones((6, 6)))
        if k % 2:
            s = np.abs(s)
        upper, lower, span, a = cone_constant(s, c)
        exact = least_of_faces(s, c)
        assert a.min() >= 0 and np.isclose(quotient(s, c, a), upper)
        assert span <= lower * (1 + 1e-12) and lower <= exact * (1 + 1e-12)
        assert exact * (1 - 1e-9) <= upper <= exact * (1 + 1e-6), (k, upper, exact)
        inside += pairwise_bound(s, c) > span
        searched += (a > 0).sum() > 1
    assert inside > 5 and searched > 5, "both kinds are tested"
    start = RNG.random(6)
    assert descend(s, c, start)[0] <= quotient(s, c, start)


def enlarged():
    """The generators (2, 1) and (1, 2) become the axes; any cone is held by the enlarged one."""
    axes = enlarged_cone(np.eye(2), np.array([[2.0, 1], [1, 2]]))
    assert np.allclose(axes, np.eye(2)), axes
    for _ in range(5):
        x = RNG.random((12, 5)) + 0.2
        gram = np.diag(RNG.random(12) + 0.5)
        wide = enlarged_cone(gram, x)
        assert wide.min() >= 0 and wide.shape == x.shape
        snapshots = x @ RNG.random((5, 20))
        assert cone_error(gram, wide, snapshots) < 1e-10
        assert cone_error(gram, x, wide) > 1e-3, "it is larger"


def matrices():
    """Masses sum up to the area, a linear function has the energy |grad|^2 area, and a mesh twice as large
    has four times the masses and the same stiffness: what the norms of the domain of mu rest on."""
    points = np.array([[0.0, 0], [2, 0], [2, 1], [0, 1], [0.7, 0.4]])
    cells = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    weights, energy = mass(points, cells, 5), stiffness(points, cells)
    assert np.isclose(weights.sum(), 2) and np.isclose(points[:, 0] @ weights @ points[:, 0], 8 / 3)
    linear = points @ [3, -1]
    assert np.isclose(linear @ energy @ linear, 10 * 2) and np.allclose(energy @ np.ones(5), 0)
    assert np.allclose(mass(2 * points, cells, 5).toarray(), 4 * weights.toarray())
    assert np.allclose(stiffness(2 * points, cells).toarray(), energy.toarray())


class String:
    """-u'' = -1 on (0, 1), u = 0 at its ends, u >= psi(mu); b is a mass matrix that mu weights."""

    def __init__(self, nodes=31):
        self.h, self.x = 1 / (nodes + 1), np.arange(1, nodes + 1) / (nodes + 1)
        self.contact = np.arange(nodes)

    def three(self, middle, side):
        n = len(self.x)
        return sparse.diags([side, middle, side], [-1, 0, 1], (n, n)).tocsr()

    def a(self, _):
        return self.three(2 / self.h, -1 / self.h)

    v = a

    def w(self, _=None):
        return self.three(2 * self.h / 3, self.h / 6).toarray()

    def f(self, _):
        return np.full(len(self.x), -self.h)

    def weights(self, mu):
        return sparse.diags(1 + mu[0] * self.x)

    def b(self, mu):
        return -(self.weights(mu) @ self.w() @ self.weights(mu))

    def g(self, mu):
        return self.b(mu) @ (-0.05 - 0.4 * (self.x - mu[0])**2)


def greedy():
    """Stable after every step, at all mu; exact where its snapshots are; the order of the constants."""
    string, every = String(), np.eye(31)
    mus = [np.array([place]) for place in np.linspace(0.3, 0.7, 9)]
    space = Space(string.v(None), string.contact)
    problems, w = [Problem(string, space, mu) for mu in mus], string.w()
    truths = [np.column_stack(fields)
              for fields in zip(*(problem.answer(every, every) for problem in problems))]
    assert truths[1].min() >= 0 and (truths[1].max(axis=0) > 0).all()
    for delta in (0.3, 0.8):
        double, seen = DoubleGreedy(problems, w, truths, delta), []
        for surrogate, least in double.run(1e-9, len(mus)):
            seen.append(surrogate)
            assert least >= np.sqrt(1 - delta**2)
            assert np.isclose(least, stability(problems, w, double.basis, double.x)[0].min())
            k = double.chosen[-1]
            assert problems[k].errors(double.basis, double.x, *(t[:, k] for t in truths)).max() < 1e-7
        assert seen[-1] < 1e-9 < seen[0] and len(double.chosen) == double.x.shape[1]
    modes = orthonormal(space.product, np.empty((31, 0)), truths[0][:, :3])
    found = constants(space, problems[4].b, w, modes, double.basis, double.x, {})
    found["hf"], (above, c) = high_fidelity_constants(space, problems[4].b, w, np.arange(31))
    assert found["hf"][0] <= above <= c * (1 + 1e-12) and np.isclose(above, c), "the largest a is positive"
    for upper, lower, span in found.values():
        assert upper >= lower * (1 - 1e-9) >= span * (1 - 2e-9)
    for larger, smaller in (("on", "off"), ("off", "dec"), ("on", "hf")):
        assert found[larger][0] >= found[smaller][1] * (1 - 1e-9)
        assert found[larger][2] >= found[smaller][2] * (1 - 1e-9)
    assert found["dec"][2] == 0, "fewer modes than generators"


if __name__ == "__main__":
    for check in (two_dimensions, dependent, faces, enlarged, matrices, greedy):
        check()
