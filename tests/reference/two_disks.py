#!/usr/bin/env python3
"""two_disks.py [CASE_DIR]: the half-disks of cases/two_disks by another program. Without CASE_DIR it prints
values, with it compares those of expected.csv.

Half of each body, u_x = 0 on x = 0, on meshes with the arcs themselves and finer sides at the clamped
corners. Points that face each other have the same x, so that nodes of both arcs are put there: contact is
vertical and holds at each pair of them. Pressures are per length of the upper arc.
"""

import sys

import numpy as np
import scipy.sparse as sparse

from plane_contact import Contact, Mesh, graded, main, plane_strain, shares, stiffness

CLOSER, GAP, REACH = 0.18, 0.001, 0.4  # REACH: how far from the axis nodes face each other
AT = [(0.7,), (1.0,), (1.3,)]
UNCERTAIN = {"normal_force": 3e-4, "energy": 2.3e-5, "peak_pressure": 1.5e-3}  # in expected.csv


def values_at(mu, n):
    mesh = Mesh()
    facing = graded(0, REACH, 12 * n, "")
    for body, radius in enumerate((1, *mu)):
        sign = 1 - 2 * body
        low = np.arcsin(facing / radius)
        low = np.concatenate([low, graded(low[-1], np.pi / 4, 3 * n, "")[1:]])
        mesh.quarter_disk(radius, low, graded(np.pi / 4, np.pi / 2, 3 * n, "end"), graded(0, 1, 3 * n, "end"),
                          lambda x, y: (x, sign * (y + radius)), body)
    mesh.done()
    matrix = stiffness(mesh, {0: plane_strain(15, 0.35)})
    upper = np.arange(len(mesh.points)) < len(mesh.points) // 2

    def arc(radius, sign, of_body):
        nodes = mesh.nodes(lambda x, y: (abs(np.hypot(x, y - sign * radius) - radius) < 1e-9) & of_body
                           & (x < REACH + 1e-9))
        return nodes[np.argsort(mesh.points[nodes, 0])]

    one, other = arc(1, 1, upper), arc(*mu, -1, ~upper)
    assert np.allclose(mesh.points[one, 0], mesh.points[other, 0], atol=1e-12)
    count, angle = len(one), np.arcsin(facing)
    rows = sparse.csr_matrix((np.repeat([-1.0, 1.0], count), (np.tile(np.arange(count), 2), np.append(
        2 * one + 1, 2 * other + 1))), (2 * count, matrix.shape[0]))  # without friction: no second half
    flat = mesh.nodes(lambda x, y: (abs(y - 1) < 1e-9) | (abs(y + mu[0]) < 1e-9))
    axis = mesh.nodes(lambda x, y: abs(x) < 1e-9)
    contact = Contact(matrix, np.concatenate([2 * flat, 2 * flat + 1, 2 * axis]), rows)
    gap = mesh.points[one, 1] - mesh.points[other, 1] + GAP
    p, _, u = contact.solve(np.zeros(matrix.shape[0]), gap - CLOSER, 0.0)
    return {"normal_force": 2 * p.sum(), "energy": u @ (matrix @ u),
            "peak_pressure": (p / shares(angle)).max()}


if __name__ == "__main__":
    sys.exit(main(sys.argv, values_at, AT, (3, 6, 12), lambda mu, quantity, value: UNCERTAIN[quantity]))
