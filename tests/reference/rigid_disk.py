#!/usr/bin/env python3
"""rigid_disk.py [CASE_DIR]: the half-disk of cases/rigid_disk on its rigid disk by another program: without
friction, with Tresca's and with Coulomb's, and with a core of another stiffness. Without CASE_DIR it prints values, with it compares those of
expected.csv.

Half of the body, u_x = 0 on x = 0, on a mesh with the lowest point and the clamped corner in finer sides
and with the arc itself. It is as high as its radius; a plane stiffness does not know by how much. Contact:
u . n <= gap at each node within 22.5 degrees, with the normal n of the body and
the gap to the closest point of the rigid disk, times n.
"""

import functools
import sys

import numpy as np
import scipy.sparse as sparse

from plane_contact import Contact, Mesh, graded, main, plane_strain, shares, stiffness

INDENTATION, GAP, CORE = 0.09, 0.001, 0.6
LAWS = {  # law, its bound, stiffness of the core
    "": ("coulomb", 0.2, 1), "-friction_coefficient 0.1": ("coulomb", 0.1, 1),
    "-friction none": ("none", 0, 1), "-friction tresca": ("tresca", 0.1, 1),
    "-friction none -core_stiffness 0.2": ("none", 0, 0.2), "-friction none -core_stiffness 5": ("none", 0, 5)}
AT = [(radius, *law) for law in LAWS.values() for radius in ((0.7, 1.0, 1.3) if law[2] == 1 else (1.0,))]
RELATIVE = {"energy": 1.5e-5, "normal_force": 2e-5, "tangential_force": 5e-4, "peak_pressure": 1e-3}


def stated(mu, quantity, value):
    """The uncertainty of a value of expected.csv; of stick one edge of 801 nodes."""
    if quantity == "contact_half_width":
        return 5e-5
    return RELATIVE[quantity] * value if quantity in RELATIVE else np.pi / 4 / 800 * mu[0]


@functools.lru_cache
def body(n, core):
    """Of radius 1, with a core of radius CORE: the contact, its angles from the lowest point, and the share of its nodes in the arc."""
    mesh = Mesh()
    low = np.concatenate([graded(0, np.pi / 8, 12 * n, ""), graded(np.pi / 8, np.pi / 4, 2 * n, "")[1:]])
    high = graded(np.pi / 4, np.pi / 2, 3 * n, "end")
    mesh.quarter_disk(CORE, low, high, graded(0, 1, 2 * n, "end"), lambda x, y: (x, y), region=1)
    for angle in (low, high):
        arc = np.array([np.sin(angle), -np.cos(angle)])
        mesh.between(CORE * arc, arc, graded(0, 1, 4 * n, "both"), 0)
    mesh.done()
    matrix = stiffness(mesh, {0: plane_strain(15, 0.35), 1: plane_strain(15 * core, 0.35)})
    flat, axis = mesh.nodes(lambda x, y: abs(y) < 1e-9), mesh.nodes(lambda x, y: abs(x) < 1e-9)
    arc = mesh.nodes(lambda x, y: (abs(np.hypot(x, y) - 1) < 1e-9) & (x < np.sin(np.pi / 8) + 1e-9))
    angle = np.arcsin(mesh.points[arc, 0])
    arc, angle = arc[np.argsort(angle)], np.sort(angle)
    count = len(arc)
    sine, cosine, at = np.sin(angle), np.cos(angle), np.arange(count)
    rows = sparse.csr_matrix(
        (np.concatenate([sine, -cosine, cosine, sine]),
         (np.concatenate([at, at, count + at, count + at]), np.tile(np.append(2 * arc, 2 * arc + 1), 2))),
        (2 * count, matrix.shape[0]))
    contact = Contact(matrix, np.concatenate([2 * flat, 2 * flat + 1, 2 * axis]), rows)
    contact.compliance[count, count] = 1  # q = 0 at the lowest point, which the axis holds
    return matrix, contact, angle, shares(angle)


def values_at(mu, n):
    radius, law, bound, core = mu
    matrix, contact, angle, share = body(n, core)
    x, y = radius * np.sin(angle), -radius * np.cos(angle)
    from_middle = np.array([x, y + radius + GAP + 1])
    to_closest = (1 / np.hypot(*from_middle) - 1) * from_middle
    normal, tangent = np.array([[np.sin(angle), -np.cos(angle)], [np.cos(angle), np.sin(angle)]])
    # u = (0, -d) + what the forces do
    at_rest = np.append(-INDENTATION * normal[1] - (to_closest * normal).sum(0), -INDENTATION * tangent[1])
    share = radius * share
    p, q, u = contact.solve(np.zeros(matrix.shape[0]), -at_rest, bound if law == "coulomb" else 0.0,
                            threshold=bound * share if law == "tresca" else 0.0)
    pressure = p / share
    slip = (at_rest - contact.compliance @ np.append(p, q))[len(p):]
    inside = (pressure > 0.1 * pressure.max()) & (pressure < 0.6 * pressure.max())
    width = np.sqrt(np.polyfit(pressure[inside]**2, angle[inside]**2, 2)[-1])  # p^2 is linear in Hertz's
    slips = np.flatnonzero((p > 0) & (abs(slip) > 1e-10))[:1]
    return {"energy": u @ (matrix @ u), "normal_force": 2 * p.sum(), "tangential_force": 2 * abs(q).sum(),
            "peak_pressure": pressure.max(), "centre": pressure[0], "contact_half_width": radius * width,
            "stick_half_width": radius * (angle[slips] + angle[slips - 1]).sum() / 2}


if __name__ == "__main__":
    sys.exit(main(sys.argv, values_at, AT, (4, 8, 16), stated, LAWS.get))
