#!/usr/bin/env python3
"""check_expected.py RBVI CASE_DIR: high-fidelity answers against CASE_DIR/expected.csv.

expected.csv: one row per number, with the free parameters first, then quantity (a column of the
tables of rbvi), value and relative tolerance, and where they differ from those of the case the options
of the solve. Lines that start with # say where the values are from.
"""

import csv
import subprocess
import sys
import tempfile
from pathlib import Path


def solve(rbvi, case, mu, options, directory):
    """The table row of one high-fidelity solve."""
    out = Path(directory) / "row.csv"
    subprocess.run([rbvi, "solve", "-case", case / "case.yaml", "-mu", ",".join(mu), "-csv", out,
                    *options.split()], check=True, stdout=subprocess.DEVNULL)
    with open(out, encoding="utf-8") as file:
        return next(csv.DictReader(file))


def main(rbvi, case):
    with open(case / "expected.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    answers, wrong = {}, 0
    with tempfile.TemporaryDirectory() as directory:
        for row in rows:
            quantity, value = row.pop("quantity"), float(row.pop("value"))
            tolerance, options = float(row.pop("tolerance")), row.pop("options", None) or ""
            mu = tuple(row.values())
            if (mu, options) not in answers:
                answers[mu, options] = solve(rbvi, case, mu, options, directory)
            got = float(answers[mu, options][quantity])
            error = abs(got - value) / abs(value)
            verdict = "ok" if error <= tolerance else "WRONG"
            wrong += verdict != "ok"
            print(f"{verdict:5} mu = {','.join(mu):18} {quantity:16} {got:12.6f} expected "
                  f"{value:12.6f}, off by {error:.1e} of {tolerance:.1e} {options}")
    if not rows:
        print("expected.csv has no rows")
    return 1 if wrong or not rows else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], Path(sys.argv[2])))
