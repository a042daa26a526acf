#!/usr/bin/env python3
"""bolted_flange.py [CASE_DIR]: the flange, gasket and stop of cases/bolted_flange by another program. Without
CASE_DIR it prints values, with it compares those of expected.csv.

Axisymmetric; forces are those of the whole circumference. Flange and gasket have nodes at the same places
of the face, and finer sides where the gasket ends. What nothing holds, the flange along the axis, is
solved for beside the forces.
"""

import sys

import numpy as np
import scipy.sparse as sparse

from plane_contact import Contact, Mesh, about_axis, graded, lengths, main, stiffness

GASKET, FLANGE = 0, 1
AT = [(1000, 0.15, 8e5, 0, 0.4), (1500, 0.15, 1e6, 5, 0.2), (3000, 0, 8e5, 6, 0.3),
      (500, 0.3, 1.5e6, 2, 0.25)]


def line(*parts):
    """Nodes through (end, sides, finer towards) from where the first part ends."""
    nodes = [np.array(parts[:1])]
    for end, sides, towards in parts[1:]:
        nodes.append(graded(nodes[-1][-1], end, sides, towards)[1:])
    return np.concatenate(nodes)


def mesh_of(n):
    """The mesh, and how many of its nodes are the gasket's, its first ones."""
    mesh = Mesh()
    gasket = line(112, (114, 2 * n, "start"), (122, 3 * n, ""), (132, 4 * n, ""), (140, 3 * n, ""),
                  (142, 2 * n, "end"))
    inside = line(101.5, (112, 3 * n, "end"))
    outside = line(142, (145, 2 * n, "start"), (172, 5 * n, ""), (175, n, ""), (187.5, 3 * n, ""))
    mesh.rectangle(gasket, line(0, (2, 3 * n, "end")), GASKET, GASKET)
    count = len(mesh.points)
    for r in inside, gasket, outside:
        mesh.rectangle(r, line(2, (36, 6 * n, "both")), FLANGE, FLANGE)
    below = np.append(inside, gasket[1:10 * n + 1])  # up to 122
    above = 101.5 + (below - 101.5) * 8 / 20.5
    mesh.between(np.array([below, 0 * below + 36]), np.array([above, 0 * above + 90]),
                 line(0, (1, 5 * n, "both")), FLANGE, FLANGE)
    mesh.rectangle(above, line(90, (202, 5 * n, "start")), FLANGE, FLANGE)
    return mesh.done(), count


def values_at(mu, n):
    modulus, friction, bolts, gas, clearance = mu
    mesh, count = mesh_of(n)
    matrix = stiffness(mesh, {GASKET: about_axis(modulus, 0.3), FLANGE: about_axis(200e3, 0.3)})
    size, radius = matrix.shape[0], mesh.points[:, 0]

    def on(body, low, high):
        """The nodes of a body in this box, and their shares of its area."""
        nodes = mesh.nodes(lambda x, y: (x > low[0] - 1e-9) & (x < high[0] + 1e-9) & (y > low[1] - 1e-9)
                           & (y < high[1] + 1e-9))
        nodes = nodes[(nodes < count) == (body == GASKET)]
        nodes = nodes[np.lexsort(mesh.points[nodes].T)]
        return nodes, 2 * np.pi * radius[nodes] * lengths(mesh, nodes, int(low[0] == high[0]))

    load = np.zeros(size)
    thrust = gas * 101.5**2 / (109.5**2 - 101.5**2)
    for along, traction, (nodes, share) in (
            (1, -bolts / (np.pi * (175**2 - 145**2)), on(FLANGE, (145, 36), (175, 36))),
            (0, gas, on(FLANGE, (101.5, 2), (101.5, 202))), (1, gas, on(FLANGE, (101.5, 2), (112, 2))),
            (0, gas, on(GASKET, (112, 0), (112, 2))), (1, thrust, on(FLANGE, (101.5, 202), (109.5, 202)))):
        load[2 * nodes + along] += traction * share
    top, share = on(GASKET, (112, 2), (142, 2))
    face, stop = on(FLANGE, (112, 2), (142, 2))[0], on(FLANGE, (172, 2), (187.5, 2))[0]
    seat, every = len(top), len(top) + len(stop)
    at, beside = np.arange(seat), np.arange(seat, every)
    signs = np.repeat([1.0, -1.0, -1.0, 1.0, -1.0], [seat, seat, every - seat, seat, seat])
    rows = sparse.csr_matrix((signs, (
        np.concatenate([at, at, beside, every + at, every + at]),
        np.concatenate([2 * top + 1, 2 * face + 1, 2 * stop + 1, 2 * top, 2 * face]))), (2 * every, size))
    motion = np.zeros(size)
    motion[2 * count + 1::2] = 1
    middle, corner = on(GASKET, (112, 0), (142, 0))[0], on(FLANGE, (187.5, 36), (187.5, 36))[0]
    contact = Contact(matrix, np.append(2 * middle + 1, 2 * corner + 1), rows)
    seated = np.arange(every) < seat
    p, q, u = contact.solve(load, np.where(seated, 0, clearance), friction * seated, motion,
                            guess=(seated, np.zeros(every)))
    assert abs(p.sum() - (bolts - gas * np.pi * 112**2)) < 1e-7 * bolts
    pressure, r = p[:seat] / share, radius[top]

    def mean(low, high):
        nodes, part = on(GASKET, (low, 2), (high, 2))
        return pressure[np.isin(top, nodes)] @ part / part.sum()

    inner = (r > 114 - 1e-9) & (r < 140 + 1e-9)
    return {"gasket force": p[:seat].sum(), "stop force": p[seat:].sum(), "inner": mean(112, 122),
            "middle third": mean(122, 132), "outer": mean(132, 142), "greatest": pressure[inner].max(),
            "opening": u[2 * face[0] + 1] - u[2 * top[0] + 1], "abs_friction": abs(q).sum()}


def stated(mu, quantity, value):
    """The uncertainty of a value of expected.csv."""
    return {"greatest": 3e-4, "opening": 2e-4}.get(quantity, 1e-4) * value


if __name__ == "__main__":
    sys.exit(main(sys.argv, values_at, AT, (3, 6, 12), stated))
