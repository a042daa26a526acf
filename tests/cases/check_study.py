#!/usr/bin/env python3
"""Runs the study of the membrane on few parameters: every table and figure is there, the constants
come in their order, and the hybrid basis is more accurate than mCPG.

    check_study.py BIN STUDY OUT
"""

import csv
import shutil
import subprocess
import sys
from pathlib import Path

binaries, study, out = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
shutil.rmtree(out, ignore_errors=True)
subprocess.run([sys.executable, study, binaries, out, "-train", "grid:3,2,2", "-valid",
                "random:4:1"], check=True, stdout=subprocess.DEVNULL)

tables = (out / "tables.md").read_text()
assert "Order of the constants: 0 exceptions" in tables, tables
assert tables.count("### ") == 8, tables
for name in ("bases", "floors", "pga", "infsup", "modes", "pairs", "pressure"):
    assert (out / "figures" / f"{name}.png").stat().st_size > 10000, name


def largest_error(disc_map, run):
    with open(out / disc_map / run / "verify" / "summary.csv", newline="") as file:
        return float(next(csv.DictReader(file))["lambda_max"])


for disc_map in ("similarity", "graded"):
    hybrid, mcpg = (largest_error(disc_map, f"{name}.offline") for name in ("hybrid", "mcpg"))
    assert hybrid < mcpg, (disc_map, hybrid, mcpg)
