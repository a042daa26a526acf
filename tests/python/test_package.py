#!/usr/bin/env python3
"""test_package.py MODELS BIN: the package rbvi (on PYTHONPATH) on the small runs."""

import contextlib
import csv
import importlib.util
import io
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

import rbvi
from rbvi import _progress

MODELS, BIN = Path(sys.argv[1]), Path(sys.argv[2])


CHOICE = """\
rbvi: 1
physics: plane_strain
mesh: {built_in: half_disc, edges: 20, degree: 1}
parameters:
  indentation: {range: [0.02, 0.09], default: 0.05}
  metal: {values: [steel, brass], default: steel}
materials: {body: {at: all, E: 'metal == steel ? 21 : 10', nu: 0.3}}
imposed: {flat side: {at: top, ux: 0, uy: -indentation}}
contact: {support: {at: contact, against: {disk: {center: [0, -2.001], radius: 1}}}}
train: grid:3,2
"""


class Choices(unittest.TestCase):
    def test_are_given_by_name(self):
        with tempfile.TemporaryDirectory() as folder:
            case = Path(folder) / "case.yaml"
            case.write_text(CHOICE, encoding="utf-8")
            full = rbvi.solve(case, {"metal": "brass"})
            rbvi.offline(case, Path(folder) / "run", quiet=True)
            model = rbvi.Model(Path(folder) / "run/model.h5")
            forces = [model(metal=metal)["normal_force"] for metal in ("steel", "brass", 0, 1)]
            self.assertEqual(forces[:2], forces[2:])
            self.assertAlmostEqual(forces[0] / forces[1], 2.1, 9)
            self.assertAlmostEqual(forces[1] / full["normal_force"], 1, 9)
            table = model.table({"metal": ["brass", "steel"], "indentation": 0.05})
            self.assertEqual(list(table["normal_force"]), [forces[1], forces[0]])
            self.assertIn("steel, brass are 0, 1", model.parameters["metal"].says)
            with self.assertRaisesRegex(rbvi.BadInput, "one of steel, brass"):
                model(metal="gold")
            self.assertTrue(np.isnan(model.gradient(metal="brass")["normal_force"]["metal"]))


class Answers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.model = rbvi.Model(MODELS / "disk_condensed/model.h5")

    def middle(self):
        return {name: (one.lower + one.upper) / 2 for name, one in self.model.parameters.items()}

    def test_digits_are_those_of_rbvi_online(self):
        points = rbvi.Model(MODELS / "disk_condensed/model.h5")
        rows = [[one.lower + t * (one.upper - one.lower) for one in points.parameters.values()]
                for t in (0.1, 0.37, 0.9)]
        with tempfile.TemporaryDirectory() as folder:
            queries, out = Path(folder) / "mu.csv", Path(folder) / "out.csv"
            queries.write_text(",".join(points.parameters) + "\n" + "\n".join(
                ",".join(map(repr, row)) for row in rows) + "\n", encoding="utf-8")
            subprocess.run([BIN / "rbvi-online", MODELS / "disk_condensed/model.h5", "--queries",
                            queries, "--out", out, "--precision", "17"], check=True,
                           capture_output=True)
            with open(out, encoding="utf-8", newline="") as file:
                told = list(csv.DictReader(file))
        table = points.table(rows)
        for k, row in enumerate(rows):
            answer = points(**dict(zip(points.parameters, row)))
            for name in points.outputs:
                if told[k][name]:
                    self.assertEqual(answer[name], float(told[k][name]), name)
                    self.assertEqual(table[name][k], answer[name], name)

    def test_an_answer_knows_its_errors(self):
        answer = self.model(**self.middle())
        self.assertTrue(answer.inside)
        self.assertLess(answer.residual, 1e-8)
        self.assertGreaterEqual(answer.error["normal_force"], 0)
        self.assertTrue(np.isnan(answer.bound["normal_force"]))
        self.assertIn("normal_force", repr(answer))

    def test_left_out_parameters_keep_their_values(self):
        name = next(iter(self.model.parameters))
        self.assertEqual(self.model().mu[name], self.model.parameters[name].value)

    def test_tables_of_each_kind(self):
        middle = self.middle()
        first = next(iter(middle))
        columns = {first: [middle[first]] * 3, **{name: value for name, value in middle.items()
                                                  if name != first}}
        from_dict = self.model.table(columns)
        from_array = self.model.table([list(middle.values())] * 3, threads=2)
        self.assertTrue(from_dict.ok.all())
        np.testing.assert_array_equal(from_dict["normal_force"], from_array["normal_force"])
        outside = self.model.table({first: [1e9, middle[first]]})
        self.assertEqual(list(outside.ok), [False, True])
        self.assertIn(first, outside.status[0])
        self.assertTrue(np.isnan(outside["normal_force"][0]))

    def test_gradients(self):
        middle = self.middle()
        of = self.model.gradient(**middle)
        self.assertEqual(of.answer["normal_force"], self.model(**middle)["normal_force"])
        for name, one in self.model.parameters.items():
            step = 1e-3 * (one.upper - one.lower)
            sides = [self.model(**{**middle, name: middle[name] + k * step})["normal_force"]
                     for k in (-2, -1, 1, 2)]
            expected = (sides[0] - 8 * sides[1] + 8 * sides[2] - sides[3]) / (12 * step)
            self.assertAlmostEqual(of["normal_force"][name], expected, delta=1e-6 * abs(expected))
            self.assertIs(of.kinked[name], False)
        self.assertTrue(np.isnan(of["iterations"][name]))
        self.assertIn("normal_force", repr(of))
        with self.assertRaisesRegex(rbvi.BadInput, "nearest one is 'normal_force'"):
            of["normal_forse"]

    def test_gradients_of_rbvi_online_have_the_same_digits(self):
        middle = self.middle()
        of = self.model.gradient(**middle)
        program = [BIN / "rbvi-online", MODELS / "disk_condensed/model.h5", "--gradient"]
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "out.csv"
            subprocess.run([*program, "--mu", ",".join(map(repr, middle.values())), "--out", out,
                            "--precision", "17"], check=True, capture_output=True)
            with open(out, encoding="utf-8", newline="") as file:
                row, = csv.DictReader(file)
        told = {name: float(value) for name, value in row.items()
                if name.startswith("d_") and name in {f"d_normal_force_d_{p}" for p in middle}}
        self.assertEqual(told, {f"d_normal_force_d_{p}": of["normal_force"][p] for p in middle})
        refused = subprocess.run(program, capture_output=True, text=True, check=False)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("--gradient needs --mu or --queries", refused.stderr)

    def test_the_trace_carries_the_force(self):
        answer = self.model(**self.middle())
        trace = self.model.contact(**self.middle())
        order = np.argsort(trace.points[:, 0])
        x, pressure = trace.points[order, 0], trace["pressure"][order]
        force = np.sum((pressure[1:] + pressure[:-1]) / 2 * np.diff(x))
        self.assertAlmostEqual(force / answer["normal_force"], 1, delta=0.05)
        self.assertEqual(len(trace.arc), len(trace.points))

    def test_fields(self):
        field = self.model.field(**self.middle())
        self.assertEqual(len(field["u"]), len(field.points))
        self.assertEqual(len(field["von_mises"]), len(field.cells))
        self.assertEqual(field.units["von_mises"], "Pa")

    def test_help_tells_parameters_and_outputs(self):
        text = type(self.model).__doc__
        for name in [*self.model.parameters, *self.model.outputs]:
            self.assertIn(name, text)

    def test_refusals(self):
        for wrong in [lambda: self.model(radios=1), lambda: self.model(radius=1e9),
                      lambda: self.model()["normal_forse"],
                      lambda: self.model.table([[1, 2, 3, 4, 5]]),
                      lambda: self.model.table({"radios": [1]}),
                      lambda: self.model.contact("nowhere"), lambda: rbvi.check("nowhere.yaml", quiet=True)]:
            with self.assertRaises(rbvi.RbviError) as caught:
                wrong()
            self.assertNotIn("\n", str(caught.exception))
        with self.assertRaisesRegex(rbvi.BadInput, "'radius'"):
            self.model(radios=1)
        with self.assertRaises(FileNotFoundError):
            rbvi.Model("nowhere.h5")

    def test_threads_give_the_same_digits(self):
        some = np.column_stack([np.linspace(one.lower, one.upper, 300)
                                for one in self.model.parameters.values()])
        one, two = (self.model.table(some, threads=threads) for threads in (1, 2))
        for name in self.model.outputs:
            np.testing.assert_array_equal(one[name], two[name])

    def test_progress_changes_nothing(self):
        some = {next(iter(self.model.parameters)): np.linspace(0.8, 1.2, 500)}
        every, _progress.EVERY = _progress.EVERY, 1e-4
        self.addCleanup(setattr, _progress, "EVERY", every)
        quiet, told = io.StringIO(), io.StringIO()
        with contextlib.redirect_stderr(quiet):
            without = self.model.table(some)
        with contextlib.redirect_stderr(told):
            shown = self.model.table(some, progress=True)
        self.assertEqual(quiet.getvalue(), "")
        self.assertRegex(told.getvalue(), r"\d+ of 500 answers, \d+ s left")
        np.testing.assert_array_equal(without["energy"], shown["energy"])
        with self.assertRaises(ZeroDivisionError):
            _progress.shown_while(lambda: 1 / 0, lambda: 0, 1, True)


@unittest.skipUnless(importlib.util.find_spec("openturns"), "openturns is not installed")
class OfOpenTurns(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.model = rbvi.Model(MODELS / "disk_condensed/model.h5")

    def test_a_sample_is_a_table(self):
        names = ["tangential_force", "normal_force"]
        force, box = self.model.openturns(names), self.model.distribution()
        self.assertEqual(list(force.getInputDescription()), list(self.model.parameters))
        self.assertEqual(list(force.getOutputDescription()), names)
        sample = box.getSample(100)
        table = self.model.table(np.asarray(sample))
        np.testing.assert_array_equal(np.asarray(force(sample)),
                                      np.column_stack([table[name] for name in names]))
        np.testing.assert_array_equal(np.asarray(force(sample[0])), np.asarray(force(sample))[0])
        self.assertEqual(self.model.openturns().getOutputDimension(), len(self.model.outputs))
        self.assertEqual(self.model.openturns("energy").getOutputDimension(), 1)

    def test_the_box_is_the_distribution(self):
        box = self.model.distribution()
        self.assertEqual(list(box.getDescription()), list(self.model.parameters))
        for i, one in enumerate(self.model.parameters.values()):
            bounds = box.getMarginal(i).getRange()
            self.assertEqual([bounds.getLowerBound()[0], bounds.getUpperBound()[0]],
                             [one.lower, one.upper])

    def test_no_answer_raises_with_its_reason(self):
        force, outside = self.model.openturns("energy"), [1e9, 1.0]
        for wrong in (lambda: force(outside), lambda: force([[1.0, 1.0], outside])):
            with self.assertRaisesRegex(RuntimeError, "radius"):
                wrong()
        with self.assertRaises(rbvi.BadInput):
            self.model.openturns("enrgy")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
