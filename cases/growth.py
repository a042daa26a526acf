#!/usr/bin/env python3
"""growth.py TABLE: the page of a table that `rbvi bench -bench_growth` wrote, on standard output.

    python3 cases/growth.py run/NAME/bench/growth.csv > growth.md

For each number of ranks per solve a table: each stage over the meshes, and its exponents in dofs.
"""

import csv
import math
import sys

# Heading, column, format, whether its exponent is told.
SHOWN = [("seconds", "seconds", ".3g", True), ("CPU seconds", "cpu_sum", ".3g", True),
         ("MB per rank", "memory_max_mb", ".0f", True), ("messages", "messages", ".0f", False),
         ("reductions", "reductions", ".0f", False), ("factorisations", "factorisations", ".0f", False),
         ("solves", "solves", ".0f", False), ("CG steps", "cg_steps", ".0f", False)]


def read(path):
    with open(path, encoding="utf-8") as file:
        return [{name: value if name in ("scene", "stage") else float(value)
                 for name, value in row.items()} for row in csv.DictReader(file)]


def exponent(x, y):
    """p of y = c x^p by least squares of the logarithms; None where fewer than two different x have
    positive values."""
    points = [(math.log(a), math.log(b)) for a, b in zip(x, y) if a > 0 and b > 0]
    if len({a for a, _ in points}) < 2:
        return None
    mean_x, mean_y = (sum(values) / len(points) for values in zip(*points))
    return (sum((a - mean_x) * (b - mean_y) for a, b in points)
            / sum((a - mean_x) ** 2 for a, _ in points))


def counted(count, what):
    return f"{count:.0f} {what}" + ("" if count == 1 else "s")


def line(cells):
    return "| " + " | ".join(cells) + " |\n"


def cells_of(stage, meshes, held):
    """`stage`: mesh -> row. `held`: MB of a rank before the first run, which no growth counts."""
    cells = []
    rows = [stage[mesh] for mesh in meshes if mesh in stage]
    for _, column, form, grows in SHOWN:
        cells.append(" / ".join(format(stage[mesh][column], form) if mesh in stage else "-"
                                for mesh in meshes))
        if grows:
            zero = held if column == "memory_max_mb" else 0
            power = exponent([row["dofs"] for row in rows], [row[column] - zero for row in rows])
            cells.append("" if power is None else f"{power:.2f}")
    return cells


def table(rows, held):
    header = ["stage"]
    for name, _, _, grows in SHOWN:
        header += [name, "exponent"] if grows else [name]
    meshes = list(dict.fromkeys(row["refine"] for row in rows))
    text = line(header) + "|" + "---|" * len(header) + "\n"
    names = list(dict.fromkeys(row["stage"] for row in rows if row["stage"] != "total"))
    for name in names + ["total"]:
        stage = {row["refine"]: row for row in rows if row["stage"] == name}
        text += line([name] + cells_of(stage, meshes, held))
    return text


def facts(rows):
    """The line above a table: what else the runs were."""
    runs = [row for row in rows if row["stage"] == "total"]

    def over(column, form, scale=1):
        return " / ".join(format(scale * run[column], form) for run in runs)

    return (f"dofs {over('dofs', '.0f')}, multipliers {over('multipliers', '.0f')}, modes "
            f"{over('modes', '.0f')}; a solve takes {over('sample_seconds', '.3g', 1e3)} ms and "
            f"{over('iterations', '.3g')} iterations (medians of {over('samples', '.0f')} samples); "
            f"model.h5 {over('model_mb', '.2f')} MB, its fields {over('fields_mb', '.2f')} MB.\n\n")


def page(rows):
    first = rows[0]
    text = (f"# Growth with the mesh: {first['scene']}, {counted(first['ranks'], 'rank')}\n\n"
            f"Exponents are those of dofs, of memory without the {first['resident_mb']:.0f} MB that a "
            "rank held before the first run. Seconds, MB, reductions, factorisations, solves and CG "
            "steps are the largest of a rank, CPU seconds and messages those of all ranks.\n")
    for per_solve in sorted({row["ranks_per_solve"] for row in rows}):
        group = [row for row in rows if row["ranks_per_solve"] == per_solve]
        text += (f"\n## {counted(per_solve, 'rank')} per solve\n\n" + facts(group)
                 + table(group, first["resident_mb"]))
    return text


if __name__ == "__main__":
    sys.stdout.write(page(read(sys.argv[1])))
