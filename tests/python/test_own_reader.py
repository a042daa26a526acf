#!/usr/bin/env python3
"""test_own_reader.py MODELS BIN LAYOUT: answers of own_reader.py, which is written by the page LAYOUT,
against those of rbvi-online."""

import csv
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

import own_reader

MODELS, BIN, LAYOUT = map(Path, sys.argv[1:4])
AGREE = 1e-10


def told(model, folder):
    """Rows of rbvi-online: corners of the box and random parameters."""
    rows = []
    for queries in ("corners", "random:6:5"):
        table = Path(folder) / "answers.csv"
        subprocess.run([BIN / "rbvi-online", model, "--queries", queries, "--out", table,
                        "--precision", "17"], check=True, capture_output=True)
        with open(table, encoding="utf-8", newline="") as file:
            rows += list(csv.DictReader(file))
    return rows


class OwnReader(unittest.TestCase):
    def compare(self, path, outputs):
        model = own_reader.Model(path)
        free = [model.names[i] for i in model.data["parameters/free"]]
        with tempfile.TemporaryDirectory() as folder:
            rows = told(path, folder)
        self.assertGreaterEqual(len(rows), 8)
        for row in rows:
            mine = model.at({name: float(row[name]) for name in free})
            self.assertEqual(sorted(mine), sorted(outputs))
            for name, value in mine.items():
                theirs = float(row[name])
                self.assertLessEqual(abs(value - theirs), AGREE * abs(theirs),
                                     f"{name} of {path} at {[row[one] for one in free]}")

    def test_law_at_the_nodes_of_a_plane(self):
        with tempfile.TemporaryDirectory() as folder:
            for words in (["new", "block"],
                          ["offline", "-case", "block", "-out", "run", "-train", "grid:3,3,3"]):
                subprocess.run([BIN / "rbvi", *words], cwd=folder, check=True, capture_output=True)
            self.compare(Path(folder) / "run/model.h5",
                         ["energy", "normal_force", "peak_pressure", "tangential_force"])

    def test_law_at_the_nodes_of_a_disk(self):
        self.compare(MODELS / "disk_none/model.h5", ["energy", "normal_force", "peak_pressure"])

    def test_law_whose_operator_changes_with_a_modulus(self):
        self.assertGreater(len(own_reader.Model(MODELS / "disk_condensed/model.h5").data["law/axes"]), 0)
        self.compare(MODELS / "disk_condensed/model.h5",
                     ["energy", "normal_force", "peak_pressure", "tangential_force"])

    def test_cone(self):
        self.assertGreater(own_reader.Model(MODELS / "membrane/model.h5").data["size/free_modes"], 0)
        self.compare(MODELS / "membrane/model.h5", ["energy", "normal_force", "peak_pressure"])

    def test_schemas_of_the_page(self):
        page = LAYOUT.read_text(encoding="utf-8")
        for title, path in (("model.h5", MODELS / "disk_none/model.h5"),
                            ("model.fields.h5", MODELS / "disk_none/model.fields.h5"),
                            ("samples/HASH.h5", next((MODELS / "disk_none/samples").glob("*.h5")))):
            schema = re.search(rf"^## {re.escape(title)}, schema (\d+)$", page, re.MULTILINE)
            self.assertEqual(int(schema[1]), own_reader.schema_of(path), title)


class Expressions(unittest.TestCase):
    def test_choices(self):
        for text, value in [("1 ? 2 : 3", 2), ("0 ? 2 : 1 ? 4 : 5", 4), ("0 ? 2 : 0 ? 4 : 5", 5),
                            ("1 ? 0 ? 6 : 7 : 8", 7), ("2^3 * max(1, (0 ? 9 : 2))", 16),
                            ("3 * hypot(3, 0 ? 1 : 4)^2", 75)]:
            self.assertEqual(eval(own_reader.expression(text), {}, own_reader.NAMES), value, text)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
