#!/usr/bin/env python3
"""scaling.py TABLE COMMAND COMMIT CORES MACHINE: the page of scaling.csv, on standard output.

TABLE holds rows of `rbvi bench -bench_growth` (cases/OUTPUTS.md) of several scenes and numbers of
ranks. Times count up to as many ranks as there are cores; counts and memory count for all of them.
"""

import csv
import sys

import numpy as np

OF_SOLVES = ("mesh", "snapshots")  # stages that the ranks of one solve share, others all ranks
SHORT = 0.02  # seconds below which a time says nothing
MOST_GROWTH = 1.2


def read(path):
    with open(path, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        for name, value in row.items():
            if name not in ("scene", "stage"):
                row[name] = float(value)
        row["used_mb"] = max(row["memory_max_mb"] - row["resident_mb"], 0)
        row["shared_by"] = row["ranks_per_solve" if row["stage"] in OF_SOLVES else "ranks"]
    return rows


def pick(rows, **values):
    return [row for row in rows if all(row[name] == value for name, value in values.items())]


def names(rows, column):
    return list(dict.fromkeys(row[column] for row in rows))


def column(rows, name):
    return np.array([row[name] for row in rows])


def power_law(x, y):
    """(c, p) of y = c x^p by least squares of the logarithms; None below two points."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    good = (x > 0) & (y > 0)
    if len(set(x[good])) < 2:
        return None
    p, logc = np.polyfit(np.log(x[good]), np.log(y[good]), 1)
    return np.exp(logc), p


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows]) + "\n"


def number(value, digits=3):
    if value is None or not np.isfinite(value):
        return ""
    if 1000 <= abs(value) < 1e7:
        return f"{value:.0f}"
    return f"{value:.{digits}g}"


def over(rows, name, digits=3):
    return " / ".join(number(value, digits) for value in column(rows, name))


def exponent(rows, values):
    law = power_law(column(rows, "dofs"), values)
    return None if law is None else law[1]


# Growth


def growth(rows):
    text = ("## Growth with the mesh, 1 rank\n\nExponents p of dofs^p by least squares over the "
            f"meshes, for stages of {SHORT} s and more on the finest one. The target is {MOST_GROWTH} "
            "without factorisations, which have their own: 1.5 in flops in the plane. Memory is that "
            "above what the program holds before.\n\n")
    lines = []
    for scene in names(rows, "scene"):
        for stage in names(rows, "stage"):
            found = sorted(pick(rows, scene=scene, stage=stage, ranks=1), key=lambda r: r["dofs"])
            if len(found) < 2 or found[-1]["seconds"] < SHORT:
                continue
            seconds, factor = column(found, "seconds"), column(found, "factor_seconds")
            without = exponent(found, seconds - factor)
            memory = exponent(found, column(found, "used_mb"))
            worst = max(x for x in (without, memory, 0) if x is not None)
            lines.append([scene, stage, over(found, "dofs"), over(found, "seconds"),
                          number(exponent(found, seconds)), number(without),
                          over(found, "factorisations"), number(exponent(found, factor)),
                          over(found, "used_mb"), number(memory),
                          "met" if worst <= MOST_GROWTH else "NOT MET"])
    sizes = [[scene, *(over(sorted(pick(rows, scene=scene, stage="total", ranks=1),
                                   key=lambda r: r["dofs"]), name)
                       for name in ("dofs", "multipliers", "contact_nodes", "modes", "iterations",
                                    "model_mb", "fields_mb"))] for scene in names(rows, "scene")]
    text += table(["scene", "dofs", "multipliers", "in contact", "modes", "iterations of a solve",
                   "model.h5 (MB)", "its fields (MB)"], sizes) + "\n"
    return text + table(["scene", "stage", "dofs", "seconds", "p", "p without factorisations",
                         "factorisations", "p of their seconds", "MB", "p of MB",
                         f"<= {MOST_GROWTH}"], lines)


# Scaling over ranks


def strong(rows, cores):
    text = ("## Strong scaling: one mesh, 1 and 2 ranks\n\nSeconds on 1 rank over those on 2: each "
            "rank solves its own samples (1 per solve), or both share every solve (2 per solve). A "
            "solve: median of the samples, where both ranks share it.\n\n")
    if cores < 2:
        return text + "Not measured: this machine has one core.\n"
    lines = []
    for scene in names(rows, "scene"):
        for refine in sorted(set(column(pick(rows, scene=scene), "refine"))):
            for stage in names(rows, "stage"):
                here = pick(rows, scene=scene, refine=refine, stage=stage)
                one, two, shared = (pick(here, ranks=r, ranks_per_solve=s)
                                    for r, s in ((1, 1), (2, 1), (2, 2)))
                if not (one and two and shared) or one[0]["seconds"] < SHORT:
                    continue
                solve = one[0]["sample_seconds"] / shared[0]["sample_seconds"]
                lines.append([scene, number(one[0]["dofs"], 4), stage, number(one[0]["seconds"]),
                              number(one[0]["seconds"] / two[0]["seconds"]),
                              number(one[0]["seconds"] / shared[0]["seconds"]),
                              number(solve) if stage == "snapshots" else ""])
    return text + table(["scene", "dofs", "stage", "seconds, 1 rank", "2 ranks, 1 per solve",
                         "2 ranks, 2 per solve", "a solve"], lines)


def weak(rows, cores):
    text = ("## Weak scaling\n\nOne refinement is 4 times the dofs. Comparable at equal dofs per rank "
            "are memory and counts: 1 rank against 4 on the next finer mesh, all of them sharing every "
            "solve. Times are measured up to "
            f"{cores} ranks: 2 ranks have twice the dofs each then, and a perfect ratio of seconds "
            "would be 2, of a stage whose work grows like the dofs.\n\n")
    lines = []
    for scene in names(rows, "scene"):
        for stage in names(rows, "stage"):
            here = pick(rows, scene=scene, stage=stage)
            for one in sorted(pick(here, ranks=1), key=lambda r: r["refine"]):
                two, four = (pick(here, refine=one["refine"] + 1, ranks=r, ranks_per_solve=r)
                             for r in (2, 4))
                if not four or one["seconds"] < SHORT:
                    continue
                times = cores >= 2 and two
                lines.append([scene, stage, f"{one['dofs']:.0f} to {four[0]['dofs']:.0f}",
                              number(one["used_mb"]), number(four[0]["used_mb"]),
                              number(four[0]["used_mb"] / one["used_mb"] if one["used_mb"] else None),
                              number(four[0]["reductions"], 4), number(four[0]["messages"] / 4, 4),
                              number(two[0]["seconds"] / one["seconds"]) if times else ""])
    return text + table(["scene", "stage", "dofs", "MB, 1 rank", "MB per rank, 4 ranks", "ratio",
                         "reductions", "messages per rank", "seconds, 2 ranks over 1"], lines)


def memory(rows):
    text = ("## Peak memory per rank\n\nLargest of a rank over the stage, with what the program holds "
            "before it begins (`resident`), all ranks sharing every solve. The target for the membrane "
            "at 230 000 nodes is <= 0.4 for 4 ranks against 1.\n\n")
    lines = []
    for scene in names(rows, "scene"):
        refine = max(column(pick(rows, scene=scene), "refine"))
        for stage in names(rows, "stage"):
            found = [row for row in pick(rows, scene=scene, refine=refine, stage=stage)
                     if row["ranks"] == row["ranks_per_solve"]]
            of = {row["ranks"]: row for row in found}
            if 1 not in of or 4 not in of:
                continue
            used = of[1]["used_mb"]
            lines.append([scene, number(of[1]["dofs"], 4), stage, number(of[1]["resident_mb"])] +
                         [number(of[r]["memory_max_mb"]) if r in of else "" for r in (1, 2, 4, 8)] +
                         [number(of[4]["memory_max_mb"] / of[1]["memory_max_mb"]),
                          number(of[4]["used_mb"] / used if used else None)])
    return text + table(["scene", "dofs", "stage", "resident", "1 rank", "2", "4", "8",
                         "4 against 1", "the same without resident"], lines)


def made_by(rows, command, commit, cores, machine):
    samples = " or ".join(number(n) for n in sorted(set(column(rows, "samples"))))
    return (f"Command `{command}`, commit {commit}, {cores} cores ({machine}), {samples} samples.")


def read_measured(path, cores):
    """The rows, those on more ranks than cores without times."""
    rows = read(path)
    for row in rows:
        if row["ranks"] > cores:
            row["seconds"] = row["cpu_max"] = row["cpu_sum"] = row["sample_seconds"] = np.nan
    return rows


def main(path, command, commit, cores, machine):
    cores = int(cores)
    rows = read_measured(path, cores)
    print("# Measured: growth with the mesh, and ranks\n")
    print(made_by(rows, command, commit, cores, machine) + " Runs on more ranks than cores give counts "
          "and memory, no times. All rows: [scaling.csv](scaling.csv). What a model makes of them: "
          "[extrapolation.md](extrapolation.md).\n")
    print("\n".join([growth(rows), strong(rows, cores), weak(rows, cores), memory(rows)]).rstrip())


if __name__ == "__main__":
    main(*sys.argv[1:])
