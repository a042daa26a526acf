#!/usr/bin/env python3
"""seal.py [CASE_DIR]: the ring in its groove of cases/seal by another program. Without CASE_DIR it prints
values, with it compares those of expected.csv.

The disk on a mesh with the circle itself, finer towards it. Contact holds at the nodes where it can be:
within 30 degrees of where bottom and lid, 20 of where the wall would touch. What nothing holds, two
translations and a turn, is solved for beside the forces; it begins with
the ring pressed into all three.
"""

import functools
import sys

import numpy as np
import scipy.sparse as sparse

from plane_contact import Contact, Mesh, graded, main, plane_strain, shares, stiffness

RADIUS, YOUNG = 2.665, 6
# Of each plane: where it would touch, within how many degrees; its normal;
# and the tangent along which its friction acts.
PLANES = {"bottom": (-90, 30, (0, -1), (1, 0)), "lid": (90, 30, (0, 1), (1, 0)),
          "wall": (180, 20, (-1, 0), (0, 1))}
AT = [(0.4, 0, 0.2, 0.45), (0.8, 0.2, 0.3, 0.45), (0.6, 0.3, 0, 0.45), (0.8, 0.15, 0.4, 0.49)]

@functools.lru_cache
def body(nu, n):
    """About its middle: mesh, contact, its rigid motions, the nodes of each side and their shares."""
    def side(start, fine, finer, end, count):
        """Angles from start to end, with this many sides between `fine` and `finer`, where contact is."""
        return np.radians(np.concatenate([graded(start, fine, n, ""), graded(fine, finer, count * n, "")[1:],
                                          graded(finer, end, n, "")[1:]]))

    def shift(angle):
        return 2 * (angle - angle[0]) / (angle[-1] - angle[0]) - 1

    mesh = Mesh()
    right, top, wall = side(-40, -20, 20, 40, 4), side(40, 60, 120, 140, 6), side(140, 160, 200, 220, 4)
    half = RADIUS / 2 * np.array([np.cos(right[-1]), np.sin(right[-1])])
    mesh.rectangle(half[0] * shift(top), half[1] * shift(right), 0)
    for angle, x, y in ((right, 1, shift(right)), (top, -shift(top), 1), (wall, -1, -shift(wall)),
                        (top + np.pi, shift(top), -1)):
        inner = np.array(np.broadcast_arrays(half[0] * x, half[1] * y))
        arc = RADIUS * np.array([np.cos(angle), np.sin(angle)])
        mesh.between(inner, arc, graded(0, 1, 3 * n, "end"), 0)
    mesh.done()
    x, y = mesh.points.T
    matrix = stiffness(mesh, {0: plane_strain(YOUNG, nu)})
    circle = mesh.nodes(lambda x, y: abs(np.hypot(x, y) - RADIUS) < 1e-9)
    at = np.degrees(np.arctan2(y[circle], x[circle]))
    order = np.argsort((at + 40 + 1e-6) % 360)
    circle, at = circle[order], at[order]  # from -40 degrees round
    around = RADIUS * shares(np.radians(np.append((at + 40 + 1e-6) % 360, 360)))
    around[0] += around[-1]
    wet = slice(0, 2 * 6 * n + 1)
    sides, normals, tangents = {"right": (circle[wet], RADIUS * shares(np.radians(at[wet])))}, [], []
    for name, (middle, reach, normal, tangent) in PLANES.items():
        from_middle = (at - middle + 180) % 360 - 180
        near = np.flatnonzero(abs(from_middle) < reach + 1e-6)
        sides[name] = circle[near], around[near]
        normals += len(near) * [normal]
        tangents += len(near) * [tangent]
    nodes = np.concatenate([side[0] for name, side in sides.items() if name in PLANES])
    values, columns = np.array(normals + tangents), np.tile(nodes, 2)
    rows = sparse.csr_matrix((values.ravel(), np.stack([2 * columns, 2 * columns + 1], 1).ravel(),
                              np.arange(0, values.size + 1, 2)), (len(columns), matrix.shape[0]))
    motions = np.zeros((matrix.shape[0], 3))
    motions[::2, 0], motions[1::2, 1], motions[::2, 2], motions[1::2, 2] = 1, 1, -y, x
    middle, beside = (np.argmin(np.hypot(x - a, y)) for a in (0, half[0] / 2))
    contact = Contact(matrix, np.array([2 * middle, 2 * middle + 1, 2 * beside + 1]), rows)
    return mesh, matrix, contact, motions, sides


def width(place, force, share):
    """Of the zone around the largest pressure, between both its ends. The zone beyond a node has force F and
    moment M about it; of p like sqrt(z (2a - z)), z from the end, its length is 5 M / (2 F) / (1 + 0.043
    length / a)."""
    order = np.argsort(place)
    place, force, share = place[order], force[order], share[order]
    first = last = np.argmax(force / share)
    while force[first - 1] > 0:
        first -= 1
    while force[last + 1] > 0:
        last += 1
    corners = np.flatnonzero(share < np.roll(share, 1))  # no middles of sides
    half = (place[last] - place[first]) / 2

    def end(node, way):
        cut = corners[np.argmin(abs((place[node] - place[corners]) * way - 0.35 * half))]
        away = (place - place[cut]) * way
        beyond = np.where((away > 0) & (place >= place[first]) & (place <= place[last]), force, 0)
        total = beyond.sum() + force[cut] / 2
        length = 2.5 * (beyond * away).sum() / total
        return place[cut] + way * length / (1 + 0.043 * length / half)

    return end(last, 1) - end(first, -1)


def values_at(mu, n):
    squeeze, friction, fluid, nu = mu
    mesh, matrix, contact, motions, sides = body(nu, n)
    load = np.zeros(matrix.shape[0])
    nodes, share = sides["right"]
    for i in (0, 1):
        load[2 * nodes + i] = -fluid * share * mesh.points[nodes, i] / RADIUS
    away = np.concatenate([RADIUS - mesh.points[sides[name][0]] @ PLANES[name][2] for name in PLANES])
    gap = away - squeeze * np.concatenate([np.full(len(sides[name][0]), name == "lid") for name in PLANES])
    p, q, u = contact.solve(load, gap, friction, motions, guess=(away < squeeze / 3, 0 * away))
    ends = np.cumsum([0] + [len(sides[name][0]) for name in PLANES])
    parts = {name: slice(*ends[i:i + 2]) for i, name in enumerate(PLANES)}
    found = {"energy": u @ (matrix @ u) / 2}
    for name, part in parts.items():
        found |= {name + " force": p[part].sum(), name + " friction": -q[part].sum(),
                  name + " peak": (p[part] / sides[name][1]).max()}
        x, (normal, tangent) = mesh.points[sides[name][0]], np.array(PLANES[name][2:])
        found[name + " width"] = width(RADIUS * np.arctan2(x @ tangent, x @ normal), p[part], sides[name][1])
    pushed = found["wall force"] + found["bottom friction"] + found["lid friction"]
    assert abs(pushed - 2 * RADIUS * fluid * np.sin(np.radians(40))) < 1e-5
    return found


def stated(mu, quantity, value):
    """The uncertainty of a value of expected.csv."""
    return {"force": 2e-5 * value, "friction": 2e-5, "peak": 5e-4 * value, "width": 3e-3 * value}[quantity.split()[1]]


if __name__ == "__main__":
    sys.exit(main(sys.argv, values_at, AT, (4, 8, 16), stated))
