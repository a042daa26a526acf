#!/usr/bin/env python3
"""Runs the study of a case on few parameters: every figure is there and can be printed, the numbers of
every table are those of studies/NAME.md, the constants come in their order, and what is recommended is
more accurate than what was published.

    check_study.py BIN CASE_DIR OUT [SCRIPT] [--write]     SCRIPT: of CASE_DIR/study, else study.py

--write: writes studies/NAME.md, after a change that is meant. Cells of a column that is a time are not
compared, nor those at round-off; the others are to a digit of two.
"""

import csv
import re
import runpy
import shutil
import sys
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "cases"))

import figure_tools
from check_print import problems

FEW = {"membrane_obstacle": ["-train", "grid:3,2,2", "-valid", "random:2:1"],
       "two_disks": ["-train", "grid:5", "-valid", "random:1:1"],
       "rigid_disk": ["-train", "grid:5", "-valid", "random:2:1"],
       "rigid_disk/nitsche_study": ["-arc_edges", "40", "-train", "grid:5", "-valid", "random:3:1"],
       "rigid_disk/large_study": ["-arc_edges", "60", "-train", "random:20:1",
                                  "-valid", "random:3:1"]}
TABLES = {"membrane_obstacle": 12, "two_disks": 8, "rigid_disk": 4, "rigid_disk/nitsche_study": 8,
          "rigid_disk/large_study": 6}
FIGURES = {"membrane_obstacle": ("bases", "floors", "pga", "infsup", "modes", "pairs", "pressure",
                                 "mesh_quality"),
           "two_disks": ("solution", "bases", "pga", "infsup"),
           "rigid_disk": ("configurations", "laws", "bases", "pga", "eim", "nodes", "gcns", "tangential"),
           "rigid_disk/nitsche_study": ("deformed", "normal", "tangential", "pod", "eim", "errors",
                                        "mixed"),
           "rigid_disk/large_study": ("deformed", "forces", "pressures", "steps", "infsup",
                                      "errors")}
RUNS = {  # more accurate, less accurate
    "membrane_obstacle": [(f"{disc_map}/hybrid.offline", f"{disc_map}/mcpg.offline")
                          for disc_map in ("similarity", "graded")],
    "two_disks": [("intersection/hybrid_1e-3_energy", "intersection/mcpg_1e-2")],
    "rigid_disk": [("radius/default", "radius/collocated")],
    "rigid_disk/nitsche_study": [("mixed/default", "none/default"), ("none/default", "pair/10_5")],
    "rigid_disk/large_study": [("none/default", "none/published")]}
STORED = Path(__file__).parent / "studies"
CLOSE, ROUND_OFF = 0.11, 1e-8  # of two digits the last one may change
NUMBER = r"\d[\d.]*(?:e[-+]?\d+)?"
TIMES = re.compile(r"\bms\b|\bs\b|second|time|threshold|faster|benefit|pays")


def tables_of(text):
    """Title -> lines of cells."""
    found = {}
    for part in text.split("### ")[1:]:
        title, *lines = part.splitlines()
        rows = [[cell.strip() for cell in line.strip("| ").split("|")]
                for line in lines if line.startswith("|") and not line.startswith("|--")]
        found[title] = rows
    return found


def numbers_in(cell):
    return [float(number) for number in re.findall(NUMBER, cell)]


def same(new, old):
    """Whether two cells say the same: words, and numbers."""
    return re.sub(NUMBER, "#", new) == re.sub(NUMBER, "#", old) and all(
        max(a, b) < ROUND_OFF or abs(a - b) <= CLOSE * max(a, b)
        for a, b in zip(numbers_in(new), numbers_in(old)))


def check_tables(made, stored):
    assert list(made) == list(stored), (list(made), list(stored))
    for title, rows in made.items():
        assert len(rows) == len(stored[title]), title
        timed = [bool(TIMES.search(cell)) for cell in rows[0]]
        for row, before in zip(rows, stored[title]):
            for column, cell, old in zip(rows[0], row, before):
                if not TIMES.search(title) and not timed[rows[0].index(column)]:
                    assert same(cell, old), f"{title}: {row[0]}, {column}: {cell}, stored {old}"


def largest_error(run):
    with open(run / "verify" / "summary.csv", newline="", encoding="utf-8") as file:
        return float(next(csv.DictReader(file))["lambda_max"])


def table_of(tables, title):
    """Rows of one table as {column: cell}."""
    head, *rows = next(rows for name, rows in tables_of(tables).items() if name.startswith(title))
    return [dict(zip(head, row)) for row in rows]


def check_pairs(tables):
    """Over the cone the constants are known, in their order and above those of the span; the enlarged
    cone is as accurate as its own; the double greedy is stable; queries that solve are dearer."""
    found = re.search(r"no lower one meets: (\d+) of \d+; exceptions from the order: (\d+)\. Over the span "
                      r"rbvi verify has the same to (\S+) of", tables)
    assert found.group(1) == found.group(2) == "0" and float(found.group(3)) < 1e-9, found.group()
    for row in table_of(tables, "Over the cone"):
        for name in ("beta_HF", "beta_on", "beta_off", "beta_dec"):
            cone, span = numbers_in(row[name])
            assert cone > 1.5 * span >= 0, row
    cones = table_of(tables, "Enlarged cones")
    for own, enlarged in zip(cones[0::2], cones[1::2]):
        assert enlarged["cone"] == own["cone"] + ", enlarged"
        (_, before, _), (_, after, _) = numbers_in(own["all R"]), numbers_in(enlarged["all R"])
        assert after <= before * 1.01 + 1e-9, (own, enlarged)
    for row in table_of(tables, "Double greedy"):
        if row["method"] == "double greedy":
            least, _ = numbers_in(row["smallest beta_off / beta_on: training, validation"])
            assert least >= (1 - float(row["delta"])**2)**0.5 - 1e-3, row
            assert row["N"] == row["R"] and int(row["S"]) > 0, row
    for row in table_of(tables, "Supremizers solved for"):
        assert float(row["queries, on"]) > float(row["queries, off"]), row


def run_study(script, *arguments):
    """Runs it here, so that figures can be measured: a line for each thing that a printed page would show."""
    wrong, write = [], figure_tools.write

    def measured(figure, path):
        wrong.extend(f"{path.name}: {line}" for line in problems(figure, True))
        write(figure, path)

    figure_tools.write = measured
    sys.path.insert(0, str(script.parent))
    sys.argv = [str(script), *map(str, arguments)]
    with redirect_stdout(StringIO()):
        try:
            runpy.run_path(str(script), run_name="__main__")
        except SystemExit as stopped:
            if stopped.code:
                raise
    return wrong


def main(binaries, case, out, script="study.py", *words):
    if script == "--write":
        script, words = "study.py", (script,)
    name = case.name if script == "study.py" else f"{case.name}/{Path(script).stem}"
    shutil.rmtree(out, ignore_errors=True)
    assert not (wrong := run_study(case / "study" / script, binaries, out, *FEW[name])), "\n".join(wrong)
    tables = (out / "tables.md").read_text()
    if script == "study.py":
        assert "Order of the constants: 0 exceptions" in tables, tables
    if name in ("membrane_obstacle", "two_disks"):
        check_pairs(tables)
    assert tables.count("### ") == TABLES[name], tables
    stored = STORED / f"{name.replace('/', '_')}.md"
    if words == ("--write",):
        stored.parent.mkdir(exist_ok=True)
        stored.write_text(tables, encoding="utf-8")
    check_tables(tables_of(tables), tables_of(stored.read_text(encoding="utf-8")))
    for figure in FIGURES[name]:
        assert (out / "figures" / f"{figure}.png").is_file(), figure
    for better, worse in RUNS[name]:
        errors = largest_error(out / better), largest_error(out / worse)
        assert errors[0] < errors[1], (better, worse, errors)


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]), *sys.argv[4:])
