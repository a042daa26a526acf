#!/usr/bin/env python3
"""rigid_disk_large.py [CASE_DIR]: the half-disk of cases/rigid_disk with contact where it now is, its rigid
disk below or beside it, without friction and with Coulomb's, by another program. Without CASE_DIR it prints
values, with it compares those of expected.csv.

The whole body, of radius 1, on a mesh with the arc itself. At each node x within 22.5 degrees, now at
y = x + (0, -d) + u, the distance to the rigid disk is not negative, pressures act along its normal at y and
friction against the whole displacement along its tangent there. Normals are those of the step before,
again and again.
"""

import functools
import sys

import numpy as np
import scipy.sparse as sparse

from plane_contact import Contact, Mesh, graded, main, plane_strain, shares, solve_laws, stiffness

GAP = 0.001
PLACES = (0.01, 0), (0.05, 0), (0.09, 0), (0.15, 0), (0.2, 0), (0.1, 0.1)
AT = [(1, d, offset, friction) for d, offset in PLACES for friction in (0, 0.2)]


@functools.lru_cache
def body(n):
    """What forces at the nodes of the arc do there, the nodes' angles and shares."""
    mesh = Mesh()
    low = np.concatenate([graded(0, np.pi / 8, 12 * n, ""), graded(np.pi / 8, np.pi / 4, 2 * n, "")[1:]])
    for side in (1, -1):
        mesh.quarter_disk(1, low, graded(np.pi / 4, np.pi / 2, 3 * n, "end"), graded(0, 1, 3 * n, "end"),
                          lambda x, y, side=side: (side * x, y))
    mesh.done()
    matrix = stiffness(mesh, {0: plane_strain(15, 0.35)})
    flat = mesh.nodes(lambda x, y: abs(y) < 1e-9)
    arc = mesh.nodes(lambda x, y: (abs(np.hypot(x, y) - 1) < 1e-9) & (abs(x) < np.sin(np.pi / 8) + 1e-9))
    arc = arc[np.argsort(mesh.points[arc, 0])]
    dofs = np.append(2 * arc, 2 * arc + 1)
    rows = sparse.csr_matrix((np.ones(len(dofs)), (np.arange(len(dofs)), dofs)), (len(dofs), matrix.shape[0]))
    angle = np.arcsin(mesh.points[arc, 0])
    return Contact(matrix, np.append(2 * flat, 2 * flat + 1), rows).compliance, angle, shares(angle)


def values_at(mu, n):
    _, depth, offset, friction = mu
    compliance, angle, share = body(n)
    count = len(angle)
    x = np.array([np.sin(angle), -np.cos(angle)])
    down, middle = np.array([[0], [-depth]]), np.array([[offset], [-2 - GAP]])
    u, guess = np.zeros((2, count)), None
    for _ in range(60):
        out = x + down + u - middle
        distance = np.hypot(*out)
        normal = out / distance
        tangent = np.array([normal[1], -normal[0]])
        turn = np.block([list(map(np.diag, -normal)), list(map(np.diag, tangent))])
        at_rest = np.append((normal * u).sum(0) - (distance - 1), (tangent * down).sum(0))
        p, q, _ = solve_laws(turn @ compliance @ turn.T, at_rest, friction, guess=guess)
        guess = p > 0, np.sign(q) * (abs(q) > (friction - 1e-9) * p)
        force = p * normal - q * tangent
        before, u = u, (compliance @ force.ravel()).reshape(2, count)
        if abs(u - before).max() < 1e-11:
            break
    else:
        raise RuntimeError("the normals do not settle")
    assert p[0] == 0 and p[-1] == 0, "contact comes to the end of its arc"
    return {"energy": (u * force).sum() / 2, "normal_force": p.sum(), "reaction": force[1].sum(),
            "horizontal_reaction": force[0].sum(), "tangential_force": abs(q).sum(),
            "peak_pressure": (p / share).max()}


def law(options):
    """(d, offset, coefficient), where contact is that of the deformed body."""
    given = dict(zip(options.split()[::2], options.split()[1::2]))
    if given.get("-kinematics") != "large":
        return None
    return (float(given["-indentation"]), float(given.get("-offset", 0)),
            0.0 if given.get("-friction") == "none" else 0.2)


def stated(mu, quantity, value):
    """The uncertainty of a value of expected.csv."""
    _, depth, offset, _ = mu
    if quantity == "horizontal_reaction":
        return 2e-5 * 1.15
    force = 2e-5 if offset else 1e-5 if depth >= 0.09 else 1e-4
    return {"energy": 3e-6, "peak_pressure": 3e-4, "tangential_force": 5e-4}.get(quantity, force) * value


if __name__ == "__main__":
    sys.exit(main(sys.argv, values_at, AT, (4, 8, 16), stated, law))
