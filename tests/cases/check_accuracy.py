#!/usr/bin/env python3
"""check_accuracy.py RBVI CASE_DIR: the membrane's errors against the solution without a mesh.

That solution must be the one of expected.csv, to its digits; the answers on the default mesh must have
the accuracy that the README of the case promises, at a few parameters.
"""

import csv
import sys
from pathlib import Path

NAMES = {"energy": "energy", "normal_force": "force", "contact_measure": "area",
         "peak_pressure": "pressure"}
MOST = {"lambda, L2": 0.19, "lambda, L1": 0.105, "peak": 1e-3, "area": 1e-3, "energy": 5e-4,
        "force": 1e-3}


def main(rbvi, case):
    sys.path.insert(0, str(case / "study"))
    import accuracy

    wrong = []
    with open(case / "expected.csv", encoding="utf-8") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            if row["quantity"] not in NAMES:
                continue
            mu = tuple(float(row[name]) for name in ("radius", "center_x", "center_y"))
            value = getattr(accuracy.Exact(mu), NAMES[row["quantity"]])
            if not abs(value - float(row["value"])) <= 0.51e-6:
                wrong.append(f"mu = {mu}: {row['quantity']} is {value:.9g}, not {row['value']}")
    for mu in accuracy.PARAMETERS[:5]:
        errors = accuracy.errors_at(rbvi, [], mu, accuracy.Exact(mu))
        for (name, most), error in zip(MOST.items(), errors):
            if not abs(error) <= most:
                wrong.append(f"mu = {mu}: {name} is off by {error:.2e}, more than {most}")
    print("\n".join(wrong) or "all as accurate as promised")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], Path(sys.argv[2])))
