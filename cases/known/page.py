#!/usr/bin/env python3
"""page.py RBVI [CASE ...]: the table of README.md beside this file against `rbvi check CASE -run`.

Without cases it runs those of all folders, and writes the table; with cases it compares their rows:
the exit status is 1 where a number on the page is not the program's.
"""

import re
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
PAGE = HERE / "README.md"
LINE = re.compile(r"^  (\S.*?)  +(\S.*?)  +(\S+) expected +(\S+), off by (\S+) of (\S+): passed$")
HEAD = "| case | test | output | rbvi | formula | off by | tolerance |\n|---|---|---|---|---|---|---|\n"
ROUND_OFF = 1e-9


def rows(program, case):
    """Rows of a case: its tests, as the program prints them."""
    run = subprocess.run([program, "check", str(HERE / case), "-run"], capture_output=True, text=True, check=False)
    found = [match.groups() for match in map(LINE.match, run.stdout.splitlines()) if match]
    if run.returncode or not found:
        sys.exit(f"{case}: {run.stdout[-800:]}{run.stderr}")
    for test, output, value, formula, off, tolerance in found:
        small = float(off) < ROUND_OFF
        value = f"{float(formula) if small else float(value):.6g}"
        yield f"| {case} | {test} | {output} | {value} | {float(formula):.6g} | " \
              f"{'round-off' if small else off} | {tolerance} |"


def same(one, other):
    """Rows whose texts are equal and whose numbers agree to 1e-4, errors to a tenth."""
    cells, others = ([cell.strip() for cell in row.split("|")] for row in (one, other))
    if len(cells) != len(others):
        return False
    for column, (a, b) in enumerate(zip(cells, others)):
        if a == b:
            continue
        if column < 4 or "round-off" in (a, b) or column == 7:
            return False
        if abs(float(a) - float(b)) > (0.1 if column == 6 else 1e-4) * abs(float(b)):
            return False
    return True


def main(program, cases):
    text = PAGE.read_text(encoding="utf-8")
    if not cases:
        table = "\n".join(row for path in sorted(HERE.glob("*/case.yaml")) for row in rows(program, path.parent.name))
        start = text.index(HEAD) + len(HEAD)
        end = text.index("\n\n", start)
        PAGE.write_text(text[:start] + table + text[end:], encoding="utf-8")
        return 0
    for case in cases:
        printed = [row for row in text.splitlines() if row.startswith(f"| {case} |")]
        now = list(rows(program, case))
        if len(printed) != len(now) or not all(map(same, printed, now)):
            print(f"README.md has other numbers of {case}: now\n" + "\n".join(now))
            return 1
    return 0


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2:]))
