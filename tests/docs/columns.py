#!/usr/bin/env python3
"""columns.py OUT: the columns of every table that the programs write, against columns.txt.

    columns.py OUT             compares; OUT: the runs of small_runs.py
    columns.py OUT --write     writes columns.txt anew, after a change that is meant

In columns.txt a line has a table, the runs that it is from (all: every run), and its columns.
Programs read tables by these names: a commit that changes them says so. Each table of a run directory
is listed in cases/OUTPUTS.md. Skipped (77) without gmsh, which some runs need.
"""

import difflib
import sys
from pathlib import Path

from small_runs import HAS_SOLIDS, RUNS

SNAPSHOT = Path(__file__).with_suffix(".txt")
PAGE = Path(__file__).resolve().parents[2] / "cases/OUTPUTS.md"
ASKED_FOR = ("online_before.csv", "online_after.csv", "solve.csv")  # named by who asks


def header_of(path):
    """The names of a CSV table, or of each table of a Markdown page."""
    lines = path.read_text(encoding="utf-8").splitlines()
    if path.suffix == ".csv":
        return lines[0]
    heads = [above for above, below in zip(lines, lines[1:]) if below.startswith("|--")]
    return "; ".join(",".join(cell.strip() for cell in head.strip("| ").split("|"))
                     for head in heads)


def columns_of(out):
    found = {}
    for run in RUNS:
        if not (out / run / "solve.csv").is_file():
            sys.exit(f"{out / run} is no run of small_runs.py")
        for path in sorted((out / run).rglob("*")):
            if path.suffix in (".csv", ".md"):
                name = str(path.relative_to(out / run))
                found.setdefault((name, header_of(path)), []).append(run)
    lines = []
    for (name, header), runs in sorted(found.items()):
        lines.append(f"{name} ({'all' if len(runs) == len(RUNS) else ' '.join(runs)}): {header}")
    return lines


def main(out, write):
    if not HAS_SOLIDS:
        print("skipped: gmsh is not installed")
        return 77
    lines = columns_of(out)
    if write:
        SNAPSHOT.write_text("\n".join(lines) + "\n", encoding="utf-8")
        print(f"wrote {SNAPSHOT}")
        return 0
    known = SNAPSHOT.read_text(encoding="utf-8").splitlines()
    page = PAGE.read_text(encoding="utf-8")
    missing = {line.split(" (")[0] for line in lines} - set(ASKED_FOR)
    missing = [f"{PAGE.name} has no {name}" for name in sorted(missing) if f"`{name}`" not in page]
    changes = list(difflib.unified_diff(known, lines, "columns.txt", "now", lineterm="", n=0))
    if changes:
        changes.append(f"If that is meant: {' '.join(sys.argv)} --write, and say so in the commit.")
    changes += missing
    print("\n".join(changes) or f"{len(lines)} tables have the columns of columns.txt")
    return 1 if changes or not lines else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2:] == ["--write"]))
