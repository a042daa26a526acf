#!/usr/bin/env python3
"""readme_numbers.py RBVI ROOT: numbers of the READMEs against the commands that print them.

readme_numbers.csv, one row per number: the README, the options of `rbvi solve` that print it (paths
from ROOT), the output, and the number as the README has it. It is |output - less| * times to the
digits that are printed; below 1e-12 it is round-off, and only that is checked. The README must hold the
number, not as a part of another one.
"""

import csv
import re
import subprocess
import sys
from decimal import Decimal
from pathlib import Path

ROUND_OFF = 1e-12


def outputs(rbvi, root, options):
    """The "name value" lines of a solve."""
    run = subprocess.run([rbvi, "solve", *options.split()], cwd=root, check=True, text=True,
                         stdout=subprocess.PIPE)
    lines = [line.split() for line in run.stdout.splitlines()]
    return {words[0]: words[1] for words in lines if len(words) == 2}


def agrees(value, printed):
    """Whether `printed` is `value` rounded to its digits (a half of the last one, and round-off)."""
    if abs(float(printed)) < ROUND_OFF:
        return abs(value) < ROUND_OFF
    last_digit = Decimal(1).scaleb(Decimal(printed).as_tuple().exponent)
    return abs(value - float(printed)) <= 0.501 * float(last_digit)


def stands_in(text, printed):
    return re.search(rf"(?<![\w.-]){re.escape(printed)}(?![\w.]*\d)", text) is not None


def check(rbvi, root, table):
    answers, wrong = {}, []
    for row in table:
        options, printed = row["options"], row["printed"]
        if options not in answers:
            answers[options] = outputs(rbvi, root, options)
        text = answers[options].get(row["output"])
        if text is None:
            wrong.append(f"{options}: no output {row['output']}")
            continue
        less, times = float(row["less"] or 0), float(row["times"] or 1)
        value = (float(text) - less) * times
        if less or printed[0] != "-":
            value = abs(value)
        if not agrees(value, printed):
            wrong.append(f"{row['readme']} has {printed}; {options}: {row['output']} = {value:.10g}")
        if not stands_in((root / row["readme"]).read_text(encoding="utf-8"), printed):
            wrong.append(f"{row['readme']} does not hold {printed} ({options}: {row['output']})")
    return wrong


def main(rbvi, root):
    with open(Path(__file__).with_suffix(".csv"), encoding="utf-8") as file:
        table = list(csv.DictReader(line for line in file if not line.startswith("#")))
    wrong = check(rbvi, root, table)
    print("\n".join(wrong) or f"{len(table)} numbers are what the commands print")
    return 1 if wrong or not table else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], Path(sys.argv[2])))
