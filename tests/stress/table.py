"""The stress table: stress.csv, and stress.md made of it."""

import csv
import fcntl
import re
import subprocess
from pathlib import Path

HERE = Path(__file__).resolve().parent
COLUMNS = ["section", "scene", "what", "outcome", "deviation", "tolerance", "said", "commit"]
SECTIONS = {"models": "Reduced models", "solves": "High-fidelity answers", "files": "Files and processes",
            "queries": "Many queries"}
OUTCOMES = ("same", "refused", "WRONG")
# A row may be so much farther off than the committed one; below round-off how far tells nothing.
FARTHER, ROUND_OFF = 4, 1e-7


def number(value):
    return "" if value is None else f"{value:.1e}"


def worse(section, rows, chosen):
    """What the committed table has as `same` in the scenes that are `chosen`, and these rows have not: refused, not
    made, or several times as far off, each a sentence."""
    made = {(row.scene, row.what): row for row in rows}
    found = []
    with open(HERE / "stress.csv", encoding="utf-8", newline="") as file:
        for told in csv.DictReader(file):
            if told["section"] != section or not chosen(told["scene"]) or told["outcome"] != "same":
                continue
            row = made.get((told["scene"], told["what"]))
            name = f"{told['scene']}: {told['what']}"
            if row is None:
                found.append(f"{name}: no such row any more")
            elif row.outcome == "refused":
                found.append(f"{name}: is refused, and was answered: {row.said}")
            elif row.outcome == "same" and row.deviation > max(FARTHER * float(told["deviation"]), ROUND_OFF):
                found.append(f"{name}: {row.deviation:.1e} off, and was {told['deviation']}")
    return found


def commit():
    def git(*words):
        return subprocess.run(["git", "-C", str(HERE), *words], capture_output=True, text=True,
                              check=True).stdout.strip()
    changed = git("status", "--porcelain", "--untracked-files=no", "--", "../../src", "../../include",
                  "../../cases/*.yaml")
    return git("log", "-1", "--format=%h", "--", "../../src", "../../include", "../../cases/*.yaml") + (
        "-dirty" if changed else "")


def put(section, rows, work):
    """These rows in place of all others of their scenes."""
    made_of = commit()
    with open(HERE / "stress.csv", "a+", encoding="utf-8", newline="") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        file.seek(0)
        scenes = {(section, row.scene) for row in rows}
        table = [row for row in csv.DictReader(file) if (row["section"], row["scene"]) not in scenes]
        table += [dict(zip(COLUMNS, [section, row.scene, row.what, row.outcome, number(row.deviation),
                                     number(row.tolerance), row.said.replace(f"{work}/", ""), made_of]))
                  for row in rows]
        table.sort(key=lambda row: list(SECTIONS).index(row["section"]))
        file.truncate(0)
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
        (HERE / "stress.md").write_text(page(table), encoding="utf-8")


def summary(rows):
    """One line for each disturbance: the scenes it left the same, refused, and how near the tolerance."""
    lines = ["| what | same | refused | WRONG | largest deviation over its tolerance |", "|---|---|---|---|---|"]
    for what in dict.fromkeys(row["what"] for row in rows):
        of_it = [row for row in rows if row["what"] == what]
        shares = [float(row["deviation"]) / float(row["tolerance"]) for row in of_it
                  if row["outcome"] == "same" and row["deviation"] and row["tolerance"]]
        counts = [str(sum(row["outcome"] == one for row in of_it)) for one in OUTCOMES]
        lines.append(f"| {what} | {' | '.join(counts)} | {max(shares):.1g} |" if shares else
                     f"| {what} | {' | '.join(counts)} | |")
    return lines


def sentences(rows):
    """What is said where it is refused, numbers and places left out, with the scenes."""
    found = {}
    for row in rows:
        if row["outcome"] != "same":
            words = re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "#", row["said"].split(", while")[0])
            found.setdefault(words, []).append(row["scene"])
    lines = ["| said | rows | scenes |", "|---|---|---|"]
    for words, scenes in sorted(found.items(), key=lambda item: -len(item[1])):
        names = list(dict.fromkeys(scenes))
        more = f" and {len(names) - 3} more" if len(names) > 3 else ""
        lines.append(f"| {words.replace('|', chr(92) + '|')} | {len(scenes)} | {', '.join(names[:3])}{more} |")
    return lines


def page(table):
    count = ", ".join(f"{sum(row['outcome'] == one for row in table)} {one}" for one in OUTCOMES)
    commits = ", ".join(sorted({row["commit"] for row in table}))
    lines = ["# Stress table", "",
             f"Made by `tests/stress/stress.py build/bin WORK --write`, each program on one core, at commit {commits}. "
             f"{len(table)} rows in [stress.csv](stress.csv): {count}. What the columns mean stands in "
             "[tests/README.md](../README.md#stress).", ""]
    for section, title in SECTIONS.items():
        rows = [row for row in table if row["section"] == section]
        lines += [f"## {title}", "", *summary(rows), "", *sentences(rows), ""]
    return "\n".join(lines)
