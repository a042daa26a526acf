#!/usr/bin/env python3
"""stage_matrix.py RBVI OUT: what each scene needs of the stages of rbvi offline, counted.

    stage_matrix.py RBVI OUT            compares the matrix with that of README.md
    stage_matrix.py RBVI OUT --write    writes it there

Each row is a run of rbvi bench -bench_growth 0 on few parameters: its factorisations,
assemblies of sparse matrices and empirical interpolations are counted by PETSc's log, so that work
which is not needed, or a stage that was skipped once, is seen when it comes back.
"""

import csv
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "README.md"
BEGIN, END = "<!-- stage matrix -->\n", "<!-- end of the stage matrix -->\n"
DISK, SHORT = "rigid_disk", ["-arc_edges", "40"]
ROWS = {
    "membrane_obstacle": ("membrane_obstacle", []),
    "membrane_obstacle, graded map, mCPG": ("membrane_obstacle", [
        "-disc_map", "graded", "-variant", "published", "-cone_type", "mcpg"]),
    "two_disks": ("two_disks", []),
    "two_disks, cone": ("two_disks", ["-variant", "cone"]),
    "two_disks, large": ("two_disks", [*SHORT, "-variant", "large"]),
    "rigid_disk": (DISK, SHORT),
    "rigid_disk, Poisson's ratio free": (DISK, [*SHORT, "-parameters", "radius,poisson_ratio"]),
    "rigid_disk, collocated": (DISK, [*SHORT, "-multiplier_reduction", "collocated"]),
    "rigid_disk, large": (DISK, [*SHORT, "-variant", "large"]),
    "rigid_disk, Nitsche": (DISK, [*SHORT, "-variant", "nitsche"]),
    "rigid_disk, Nitsche, interpolated": (DISK, [
        *SHORT, "-variant", "nitsche", "-nitsche_quadrature", "interpolated",
        "-nitsche_eim_validation", "random:2:2"]),
    "roller": ("roller", []),
    "patch": ("patch", []),
    "bolted_flange": ("bolted_flange", []),
    "seal": ("seal", ["-set", "mesh.set.edges=40"]),
    "bracket": ("bracket", []),
    "joint": ("joint", ["-set", "mesh.set.edges=30"]),
    "rigid_ball": ("rigid_ball", ["-set", "mesh.set.size=3"]),
}
PARTS = ("bolted_flange", "seal", "bracket", "joint")  # of many parameters, from geometries that gmsh meshes
HEAD = ["scene", "samples", "full solves: factorisations", "assemblies", "interpolations", "POD",
        "condensation: factorisations", "cone", "supremizers", "assemblies behind the sweep"]


def stages_of(rbvi, out, case, options):
    """stage -> its row of growth.csv."""
    done = subprocess.run([rbvi, "bench", "-case", str(ROOT / "cases" / case), *options, "-train",
                           "random:6:1" if case in PARTS else "corners", "-out", str(out), "-bench_growth", "0"],
                          capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{case} {' '.join(options)}: {done.stderr}")
    with open(out / "bench/growth.csv", encoding="utf-8", newline="") as table:
        return {row["stage"]: row for row in csv.DictReader(table)}


def cells_of(stages):
    def count(stage, what):
        return int(float(stages[stage][what])) if stage in stages else 0

    def told(number):
        return str(number) if number else "-"

    def ran(stage):
        return "yes" if stage in stages else "-"

    return [stages["total"]["samples"], told(count("snapshots", "factorisations")), told(count("snapshots", "assemblies")),
            told(count("total", "interpolations")), ran("POD"),
            told(count("condensation", "factorisations")), ran("cone"), ran("PGA"),
            told(count("total", "assemblies") - count("snapshots", "assemblies"))]


def line_of(cells):
    return "| " + " | ".join(cells) + " |"


def matrix(rbvi, out, told):
    """All lines; of what gmsh would mesh, where it is missing, those that are told, without a run."""
    lines = [line_of(HEAD), line_of(["---"] * len(HEAD))]
    for number, (name, (case, options)) in enumerate(ROWS.items()):
        if case in PARTS and not shutil.which("gmsh"):
            lines += [line for line in told.splitlines() if line.startswith(f"| {name} |")]
        else:
            lines.append(line_of([name, *cells_of(stages_of(rbvi, out / str(number), case, options))]))
    return "\n".join(lines) + "\n"


def main(rbvi, out, *words):
    page = PAGE.read_text(encoding="utf-8")
    before, rest = page.split(BEGIN)
    told, after = rest.split(END)
    cases = {path.parent.name for path in ROOT.glob("cases/*/case.yaml")}
    if missing := cases - {case for case, _ in ROWS.values()}:
        sys.exit(f"no row for {', '.join(sorted(missing))}")
    made = matrix(rbvi, Path(out), told)
    if words == ("--write",):
        PAGE.write_text(before + BEGIN + made + END + after, encoding="utf-8")
    elif made != told:
        sys.exit(f"README.md has\n{told}\nand the runs give\n{made}")


if __name__ == "__main__":
    main(*sys.argv[1:])
