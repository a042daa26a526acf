#!/usr/bin/env python3
"""High-fidelity answers of the membrane against the solution without a mesh (exact.py).

    accuracy.py BIN [-levels LEVELS] [OPTION...]
                    e.g. cases/membrane_obstacle/study/accuracy.py build/bin -lumped no

Solves at 22 parameters (two of the README and 20 random ones of the box) on the mesh as it is and
on its refinements (0, 1 and 2 times, or as many as LEVELS), with the options on every solve. Prints
relative errors, mean / largest: the pressure, read as the P1 function, in L2 and L1 of the disc, its
peak, contact area, energy (mean with its sign in brackets) and force; and seconds of one solve.
"""

import csv
import random
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from subprocess import run

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from exact import Exact
from figure_tools import read_grid

CASE = Path(__file__).resolve().parents[1] / "case.yaml"
DRAW = random.Random(1).uniform
PARAMETERS = [(0.2, 0, 0), (0.18, 0.025, -0.025)] + [
    (DRAW(0.16, 0.24), DRAW(-0.05, 0.05), DRAW(-0.05, 0.05)) for _ in range(20)]
PARTS = 16  # each side of a triangle, for the integrals of a pressure that jumps inside it
COLUMNS = ("lambda, L2", "lambda, L1", "peak", "area", "energy", "force")


def pressure_errors(grid, exact):
    """Of the P1 pressure over the disc, relative, in L2 and L1: by the middles of small triangles."""
    corners, pressure = grid.points[grid.cells], grid.of_nodes["pressure"][grid.cells]
    sides = (corners[:, 1:] - corners[:, :1])[:, :, :2]
    areas = np.abs(np.linalg.det(sides)) / 2
    squares = absolute = 0
    for i in range(PARTS):
        for j in range(PARTS - i):
            for part in (1, 2) if i + j < PARTS - 1 else (1,):
                second, third = (i + part / 3) / PARTS, (j + part / 3) / PARTS
                weights = np.array([1 - second - third, second, third])
                at = np.einsum("c,ncx->nx", weights, corners)
                true = exact.pressure * exact.contains(at[:, 0], at[:, 1])
                error = np.abs(pressure @ weights - true)
                squares += areas @ error**2 / PARTS**2
                absolute += areas @ error / PARTS**2
    return (np.sqrt(squares / exact.area) / exact.pressure, absolute / exact.force)


def errors_of(command, exact):
    """One row: COLUMNS, energy with its sign, and the seconds of the answer. `command`: of the field
    and the table that it is to write."""
    with tempfile.TemporaryDirectory() as folder:
        field, outputs = Path(folder) / "u.vtu", Path(folder) / "u.csv"
        done = run(list(map(str, command(field, outputs))), capture_output=True, text=True,
                   check=False)
        if done.returncode != 0:
            sys.exit(done.stderr)
        with open(outputs, newline="", encoding="utf-8") as file:
            row = next(csv.DictReader(file))
        l2, l1 = pressure_errors(read_grid(field.with_name("u_contact.vtu")), exact)
    relative = [float(row[name]) / value - 1 for name, value in (
        ("peak_pressure", exact.pressure), ("contact_measure", exact.area),
        ("energy", exact.energy), ("normal_force", exact.force))]
    return [l2, l1, *relative, float(row["seconds"])]


def errors_at(rbvi, options, mu, exact):
    """Of a high-fidelity solve."""
    return errors_of(lambda field, outputs: [
        rbvi, "solve", "-case", CASE, *options, "-mu", ",".join(map(repr, mu)), "-vtu", field,
        "-csv", outputs], exact)


def cells_of(rows):
    """The cells of a table: mean / largest of each column."""
    cells = [f"{np.mean(column):.2e} / {np.max(column):.1e}"
             for column in np.abs(rows[:, :len(COLUMNS)]).T]
    cells[4] += f" ({np.mean(rows[:, 4]):+.1e})"
    return cells


def main():
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    rbvi, options, levels = Path(sys.argv[1]) / "rbvi", sys.argv[2:], 3
    if options[:1] == ["-levels"]:
        levels, options = int(options[1]), options[2:]
    exact = [Exact(mu) for mu in PARAMETERS]
    print("| refined | " + " | ".join(COLUMNS) + " | one solve (s) |")
    print("|" + "---|" * (len(COLUMNS) + 2))
    for level in range(levels):
        given = [*options, "-mesh_refine", str(level)]
        with ThreadPoolExecutor(2) as pool:
            rows = list(pool.map(lambda pair: errors_at(rbvi, given, *pair),
                                 zip(PARAMETERS, exact)))
        rows = np.array(rows)
        print(f"| {level} | " + " | ".join(cells_of(rows)) +
              f" | {np.median(rows[:, -1]):.2f} |", flush=True)


if __name__ == "__main__":
    main()
