#!/usr/bin/env python3
"""Every column of every scene and formulation against baseline.csv beside this file.

    baseline.py BIN            compares; BIN is the folder of the programs
    baseline.py BIN --write    writes baseline.csv anew, after a change that is meant to change answers
    baseline.py BIN --write NAME...    of these formulations alone

baseline.csv has ten digits: the high-fidelity answers at a few parameters on the default mesh, and
those of a reduced model with a small training set. A number is the same if it differs by one in its
tenth digit, or by 1e-10 of the largest of its column. Processors round differently, so that some
columns have a tolerance of their own: see differs(). Seconds are left out, and the contraction of
iterations, whose last change is next to round-off.
"""

import csv
import os
import shutil
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from at_once import run_program
from every_scene import every_scene, every_term, parts

TABLE = Path(__file__).resolve().parent / "baseline.csv"
COLUMNS = ["formulation", "model", "mu", "output", "value"]
# Absolute, of what is zero but for round-off: residuals, lengths in m, or in mm: what is left of gaps
# of some mm has a round-off of 1e-12 and more.
ROUND_OFF = {"kkt_residual": 1e-9, "friction_violation": 1e-9, "max_penetration": 5e-12,
             "horizontal_reaction": 1e-9, "reaction": 1e-10, "law_error_normal": 1e-11, "law_error_tangential": 1e-9, "law_error_tau_over_n": 1e-9}
# Newton's steps of the nested loop differ from the first rounding on, and so do the states that are
# interpolated: the answers are the same within the model's own error.
WITHIN_THEIR_ERROR = {("nitsche_coulomb_interpolated", "reduced"): 1e-3}


def call(*command):
    done = run_program(command)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stderr}")


def rows_of(formulation, model, mu, path):
    with open(path, encoding="utf-8", newline="") as file:
        for at, row in zip(mu, csv.DictReader(file), strict=True):
            for output, value in list(row.items())[len(at.split(",")):]:
                if output not in ("seconds", "status", "contraction") and value:
                    yield (formulation.name, model, at, output), float(value)


def answers(formulation, binaries, work):
    """(formulation, model, mu, output) -> value."""
    found, case, mu = {}, ["-case", formulation.case, *formulation.scene], formulation.mu
    table = work / f"{formulation.name}.csv"
    for at in mu if not formulation.reduction else []:
        call(binaries / "rbvi", "solve", *case, "-mu", at, "-csv", table)
        found.update(rows_of(formulation, "full", [at], table))
    if formulation.few is None:
        return found
    run = work / formulation.name
    call(binaries / "rbvi", "offline", *case, *formulation.reduction, *formulation.few, "-out", run)
    queries = work / f"{formulation.name}.mu.csv"
    names = Path(run / "samples.csv").read_text(encoding="utf-8").split("\n")[0].split(",")
    queries.write_text("\n".join([",".join(names[:len(mu[0].split(","))]), *mu]), encoding="utf-8")
    call(binaries / "rbvi-online", run / "model.h5", "--queries", queries, "--out", table)
    found.update(rows_of(formulation, "reduced", mu, table))
    return found


def all_answers(binaries, names):
    found = {}
    scenes = [*every_scene(), *every_term(), *(parts() if shutil.which("gmsh") else [])]
    scenes = [one for one in scenes if not names or one.name in names]
    with tempfile.TemporaryDirectory() as work, ThreadPoolExecutor(2) as pool:
        for part in pool.map(lambda one: answers(one, binaries, Path(work)), scenes):
            found.update(part)
    return found


def differs(key, value, expected, scale):
    formulation, model, _, output = key
    difference = abs(value - expected)
    if output == "iterations":  # round-off may decide about the last, and about the order of pivots
        # Loops of Nitsche's method with Coulomb's law converge linearly: the roller took 21 steps by one
        # processor and 23 by another, to answers that agree in all digits.
        few = 2 if "nitsche" in formulation else 1
        return not difference <= (few if model == "full" else max(1, expected))
    own_error = WITHIN_THEIR_ERROR.get((formulation, model), 0)
    if output == "quadrature_residual":  # an estimate of an error, of which the first digits count
        return not difference <= (1e-2 if own_error else max(1e-8, 1e-2 * expected))
    round_off = max(ROUND_OFF.get(output, 0), max(1e-10, own_error) * scale)
    return not difference <= max(1.1e-9 * abs(expected), round_off)  # nor is NaN within it


def compare(found):
    with open(TABLE, encoding="utf-8", newline="") as file:
        expected = {(r["formulation"], r["model"], r["mu"], r["output"]): float(r["value"])
                    for r in csv.DictReader(file)}
    if not shutil.which("gmsh"):
        meshed = {one.name for one in parts()}
        expected = {key: value for key, value in expected.items() if key[0] not in meshed}
    scale = {}
    for (formulation, _, _, output), value in expected.items():
        key = formulation, output
        scale[key] = max(scale.get(key, 0), abs(value))
    wrong = [f"{' '.join(key)} is {'only here' if key in found else 'missing'}"
             for key in sorted(found.keys() ^ expected.keys())]
    for key in sorted(found.keys() & expected.keys()):
        if differs(key, found[key], expected[key], scale[key[0], key[3]]):
            wrong.append(f"{' '.join(key)} is {found[key]:.10g}, was {expected[key]:.10g}")
    print("\n".join([*wrong, f"{len(expected)} numbers, {len(wrong)} differ"]))
    return 1 if wrong or not expected else 0


def main():
    arguments = sys.argv[1:]
    if not arguments or arguments[1:2] not in ([], ["--write"]):
        sys.exit(__doc__)
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    names = arguments[2:]
    found = all_answers(Path(arguments[0]), names)
    if len(arguments) == 1:
        return compare(found)
    with open(TABLE, encoding="utf-8", newline="") as file:
        others = [list(row.values()) for row in csv.DictReader(file) if names and row["formulation"] not in names]
    with open(TABLE, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        table.writerows(others)
        table.writerows([*key, f"{value:.10g}"] for key, value in found.items())
    print(f"wrote {TABLE}: {len(found)} numbers")
    return 0


if __name__ == "__main__":
    sys.exit(main())
