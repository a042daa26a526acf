#!/usr/bin/env python3
"""joint.py [CASE_DIR]: the flanges of cases/joint by another program, on meshes of its own. Without
CASE_DIR it prints values, with it compares those of expected.csv.
"""

import sys

import numpy as np
import scipy.sparse as sparse

from plane_contact import Contact, Mesh, graded, lengths, main, plane_strain, stiffness

COMPLIANCE = 9.411445453e-6  # as in the case: where its springs are settled
AT = [(900, 600, 30, 0.2, 7000), (600, 800, 20, 0.4, 20000), (1200, 1000, 60, 0.15, 2000)]


def mesh_of(n):
    mesh = Mesh()
    x = [graded(24, 36, 6 * n, ""), graded(36, 45, 4 * n, ""), graded(6, 24, 7 * n, "start")]
    x += [-part[::-1] for part in x]
    for side in (0, 1):
        sign = 1 - 2 * side
        thick = sign * graded(0, 20, 6 * n, "both")
        for part in x + [graded(-6, 6, 5 * n, "both")]:
            mesh.rectangle(part, thick, 0, side)
        mesh.rectangle(graded(-6, 6, 5 * n, "both"), sign * graded(20, 60, 6 * n, "start"), 0, side)
    return mesh.done()


def values_at(mu, n):
    pretension, pull, shear, friction, bolt = mu
    mesh = mesh_of(n)
    matrix = stiffness(mesh, {0: plane_strain(210e3, 0.3)})
    size = matrix.shape[0]

    def on(height, low, high):
        return mesh.nodes(lambda x, y: (abs(y - height) < 1e-9) & (x > low - 1e-9) & (x < high + 1e-9))

    load = np.zeros(size)
    web, side = on(60, -6, 6), mesh.nodes(lambda x, y: (abs(x + 45) < 1e-9) & (y > -1e-9))
    side = side[[node in set(mesh.triangles[: len(mesh.triangles) // 2].ravel()) for node in side]]
    load[2 * web + 1] = pull / 12 * lengths(mesh, web)
    load[2 * side] = shear / 20 * lengths(mesh, side, 1)
    springs = []
    for middle in (-30, 30):
        spring = np.zeros(size)
        for height, sign in ((20, 1), (-20, -1)):
            nodes = on(height, middle - 6, middle + 6)
            spring[2 * nodes + 1] = sign * lengths(mesh, nodes) / 12
        springs.append(spring)
        load += (-pretension - bolt * COMPLIANCE * pretension) * spring
    stretch = sparse.csc_matrix(np.array(springs))
    hold = sparse.csc_matrix(([1.0], ([0], [2 * web[0]])), (1, size))
    held = on(-60, -6, 6)
    face = on(0, -45, 45)
    upper = np.isin(face, mesh.triangles[: len(mesh.triangles) // 2])
    one, other = face[upper], face[~upper]
    one, other = (nodes[np.argsort(mesh.points[nodes, 0])] for nodes in (one, other))
    count = len(one)
    counted = np.tile(np.arange(2 * count), 2)
    rows = sparse.csr_matrix((np.repeat([-1.0, 1.0, 1.0, -1.0], count), (counted, np.concatenate(
        [2 * one + 1, 2 * one, 2 * other + 1, 2 * other]))), (2 * count, size))
    motion = np.zeros(size)
    motion[2 * np.unique(mesh.triangles[: len(mesh.triangles) // 2])] = 1
    whole = (matrix + bolt * stretch.T @ stretch).tocsc()
    contact = Contact(whole + 1e5 * hold.T @ hold, np.concatenate([2 * held, 2 * held + 1]), rows)
    p, q, u = contact.solve(load, np.zeros(count), friction, motion)
    x, gap = mesh.points[one, 0], u[2 * one + 1] - u[2 * other + 1]
    forces = [pretension + bolt * (spring @ u + COMPLIANCE * pretension) for spring in springs]
    assert abs(sum(forces) - pull - p.sum()) < 1e-7 * pretension
    middle = abs(x) < 6 + 1e-9
    return {"contact force": p.sum(), "friction force": q.sum(), "tilt": p @ x, "opening": gap.max(),
            "at the web": lengths(mesh, one[middle]) @ gap[middle] / 12,
            "energy": u @ (whole @ u) / 2 - load @ u}


if __name__ == "__main__":
    sys.exit(main(sys.argv, values_at, AT, (1, 2, 4)))
