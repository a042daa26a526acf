#!/usr/bin/env python3
"""cones.py PNG: the first two steps of CPG and mCPG on three vectors of the plane (Niakh 2022,
Figure 2.1), those of the test ExactExampleInThePlane."""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from figure_tools import BLUE, GREEN, ORANGE
from panels import Drawn, figure_of

SNAPSHOTS = np.array([[3, 0], [np.sqrt(0.75), 0.5], [1, 2 * np.sqrt(0.75)]])


def distance_to_ray(vector, ray):
    return np.linalg.norm(vector - max(0, vector @ ray) * ray)


def taken_off(vector, generator):
    """The largest part of mCPG: of a multiple of the generator what leaves no negative entry."""
    least = min(v / g for v, g in zip(vector, generator) if g > 0)
    return np.clip(vector @ generator, 0, least) * generator


def steps(modified):
    """Generators, the snapshot of the second step, and what is taken off it."""
    first = SNAPSHOTS[np.argmax(np.linalg.norm(SNAPSHOTS, axis=1))]
    generators = [first / np.linalg.norm(first)]
    second = max(SNAPSHOTS, key=lambda snapshot: distance_to_ray(snapshot, generators[0]))
    part = taken_off(second, generators[0]) if modified else np.zeros(2)
    generators.append((second - part) / np.linalg.norm(second - part))
    return generators, second, part


def arrow(axis, start, end, colour, width):
    axis.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": width,
                                              "shrinkA": 0, "shrinkB": 0})


def draw(axis, modified):
    (first, second), snapshot, part = steps(modified)
    reach = 10  # beyond the axes
    axis.fill(*np.transpose([(0, 0), reach * first, reach * (first + second), reach * second]),
              color=BLUE, alpha=0.12, linewidth=0)
    for vector, name in zip(SNAPSHOTS, ("1", "2", "3")):
        arrow(axis, (0, 0), vector, "#666666", 1)
        axis.annotate(rf"$\theta_{name}$", vector, (4, 4), textcoords="offset points")
    if np.any(part):
        arrow(axis, snapshot, snapshot - part, ORANGE, 1.6)
        axis.annotate(r"$-\Upsilon_2$", snapshot - part / 2, (0, 5), textcoords="offset points",
                      color=ORANGE, ha="center")
    for vector, name, way in ((first, "1", (2, 5)), (second, "2", (10, -3) if modified else (-10, 4))):
        arrow(axis, (0, 0), vector, GREEN, 2.4)
        axis.annotate(rf"$\nu_{name}$", vector, way, textcoords="offset points", color=GREEN, ha="center")
    axis.set(xlim=(-0.35, 3.4), ylim=(-0.35, 2.2), aspect="equal", xlabel="first entry (-)",
             ylabel="second entry (-)")


def condition(modified):
    (first, second), *_ = steps(modified)
    return (1 + first @ second) / (1 - first @ second)


def main(png):
    figure, _ = figure_of([Drawn(f"{name}: condition {condition(modified):.0f}",
                                 lambda _, axis, modified=modified: draw(axis, modified), ratio=0.9)
                           for name, modified in (("CPG", False), ("mCPG", True))],
                          "condition: of the Gram matrix of both generators")
    figure.savefig(png, dpi=150, bbox_inches="tight", pad_inches=0.02)
    print(f"wrote {png}")


if __name__ == "__main__":
    main(sys.argv[1])
