#!/usr/bin/env python3
"""bracket.py [CASE_DIR]: the bracket of cases/bracket by another program, on meshes of its own with the
hole where it is: no map. Without CASE_DIR it prints values, with it compares those of expected.csv.
"""

import sys

import numpy as np
import scipy.sparse as sparse

from plane_contact import Contact, Mesh, graded, lengths, main, plane_stress, stiffness

PLATE, PAD = 0, 1
CENTRE = np.array([45.0, 23.0])
AT = [(7, 300, 0, 0.2, 4), (4, 1000, -0.1, 0.5, 2), (10, 1000, 0.2, 0.1, 6), (10, 100, 0.1, 0.4, 5)]


def mesh_of(radius, n):
    mesh = Mesh()
    height = graded(8, 38, 3 * n, "both")
    foot = np.concatenate([graded(90, 100, 2 * n, "start"), graded(100, 110, n, "")[1:],
                           graded(110, 120, 2 * n, "end")[1:]])
    mesh.rectangle(graded(0, 30, 3 * n, "start"), height, PLATE)
    mesh.rectangle(graded(60, 90, 3 * n, "end"), height, PLATE)
    mesh.rectangle(foot, height, PLATE)
    mesh.rectangle(foot, graded(0, 8, 2 * n, "both"), PAD)
    along = {True: graded(30, 60, 3 * n, ""), False: height}
    out = np.linspace(0, 1, 4 * n + 1)
    for side in range(4):  # of the square 30..60 x 8..38 about the hole, counterclockwise from below
        s = along[side % 2 == 0]
        corner = side * np.pi / 2 - 3 * np.pi / 4
        share = (s - s[0]) / (s[-1] - s[0])
        if side >= 2:
            s, share = s[::-1], 1 - share[::-1]
        angle = corner + np.pi / 2 * share
        ring = CENTRE[:, None] + radius * np.array([np.cos(angle), np.sin(angle)])
        across = np.full_like(s, (8, 60, 38, 30)[side])
        square = np.array([s, across] if side % 2 == 0 else [across, s])
        x, y = ring[:, :, None] + (square - ring)[:, :, None] * out
        mesh.block(x, y, PLATE)
    return mesh.done()


def values_at(mu, n):
    radius, pad, height, friction, push = mu
    mesh = mesh_of(radius, n)
    matrix = stiffness(mesh, {PLATE: plane_stress(70e3, 0.33), PAD: plane_stress(pad, 0.4)})
    clamp = mesh.nodes(lambda x, y: abs(x) < 1e-9)
    top = mesh.nodes(lambda x, y: (abs(y - 38) < 1e-9) & (x > 60 - 1e-9))
    foot = mesh.nodes(lambda x, y: abs(y) < 1e-9)
    foot = foot[np.argsort(mesh.points[foot, 0])]
    load = np.zeros(matrix.shape[0])
    load[2 * top + 1] = -push * lengths(mesh, top)
    count = len(foot)
    rows = sparse.csr_matrix((np.repeat([-1.0, 1.0], count),
                              (np.arange(2 * count), np.concatenate([2 * foot + 1, 2 * foot]))),
                             (2 * count, matrix.shape[0]))
    contact = Contact(matrix, np.concatenate([2 * clamp, 2 * clamp + 1]), rows)
    p, q, u = contact.solve(load, np.full(count, -height), friction)
    x, share = mesh.points[foot, 0], lengths(mesh, foot)

    def mean(low, high):
        inside = np.flatnonzero((x > low - 1e-9) & (x < high + 1e-9))
        return lengths(mesh, foot[inside]) @ (p / share)[inside] / 10

    reaction = matrix[2 * clamp + 1] @ u
    assert abs(reaction.sum() + p.sum() - 60 * push) < 1e-6 * push
    return {"floor force": p.sum(), "friction force": q.sum(), "left third": mean(90, 100),
            "middle third": mean(100, 110), "right third": mean(110, 120), "lever": p @ (x - 105),
            "slide": share @ u[2 * foot] / 30, "tangential_force": abs(q).sum(),
            "energy": u @ (matrix @ u) / 2 - load @ u}


if __name__ == "__main__":
    sys.exit(main(sys.argv, values_at, AT, (4, 8, 16)))
