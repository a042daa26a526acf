#!/usr/bin/env python3
"""test_figures.py MODELS: maps and sensitivities of the package rbvi (on PYTHONPATH) on the small runs: against a
closed form, against single answers, and by the boxes of what is drawn."""

import sys
import unittest
from math import pi
from pathlib import Path

import numpy as np
from matplotlib.colors import to_rgb

import rbvi
from rbvi._drawing import PURPLE, STATES, grid_of, steps_between
from rbvi._sensitivity import indices

ROOT, MODELS = Path(__file__).resolve().parents[2], Path(sys.argv[1])
sys.path[:0] = [str(ROOT / "tests/cases")]

from check_print import problems  # noqa: E402

OUTPUTS = ["normal_force", "peak_pressure", "energy"]


def lines_of(axes, colour):
    """Points of the contour lines of this colour, of each level."""
    return [np.concatenate([path.vertices for path in one.get_paths()]) for one in axes.collections
            if len(one.get_facecolor()) == 0 and one.get_paths()
            and to_rgb(one.get_edgecolor()[0][:3]) == to_rgb(colour)]


class Sensitivities(unittest.TestCase):
    def test_of_ishigami(self):
        """sin x + 7 sin^2 y + z^4 sin(x)/10 on (-pi, pi)^3 has closed forms (Ishigami and Homma 1990)."""
        def of(rows):
            x, y, z = rows.T
            return (np.sin(x) + 7 * np.sin(y)**2 + 0.1 * z**4 * np.sin(x))[:, None]
        first, total, *errors = (found[:, 0] for found in indices(of, [-pi] * 3, [pi] * 3, 20000, 1))
        of_x, of_y, of_both = (1 + pi**4 / 50)**2 / 2, 49 / 8, pi**8 / 100 * (1 / 18 - 1 / 50)
        for found, error, want in ((first, errors[0], [of_x, of_y, 0]),
                                   (total, errors[1], [of_x + of_both, of_y, of_both])):
            off = np.abs(found - np.array(want) / (of_x + of_y + of_both))
            self.assertTrue(np.all(off < 4 * error + 1e-12), (found, error))
            self.assertLess(off.max(), 0.03)

    def test_of_a_sum_and_of_a_constant(self):
        def of(rows):
            return np.column_stack([rows @ [1, 2], np.ones(len(rows))])
        first, total, *_ = indices(of, [0, 0], [1, 1], 20000, 2)
        np.testing.assert_allclose(first[:, 0], [0.2, 0.8], atol=0.03)
        np.testing.assert_allclose(total[:, 0], [0.2, 0.8], atol=0.03)
        self.assertTrue(np.isnan(total[:, 1]).all())

    def test_of_a_model(self):
        model = rbvi.Model(MODELS / "disk_condensed/model.h5")
        found = model.sobol(OUTPUTS, count=256)
        for name in OUTPUTS:
            self.assertEqual(list(found.total[name]), list(model.parameters))
            self.assertGreater(sum(found.total[name].values()), 0.9)
            self.assertIn(name, repr(found))
        with self.assertRaises(rbvi.BadInput):
            model.sobol("normal_forces")


class Figures(unittest.TestCase):
    def check(self, axes, has_units=True, width=3.6):
        self.assertEqual(problems(axes.figure, has_units), [])
        axes.figure.draw_without_rendering()
        self.assertLess(axes.figure.get_tightbbox().width, width)

    def test_a_map_has_the_answers_and_the_samples(self):
        """Along a contour the output is the same, and rises from one to the next."""
        for run in ("disk_condensed", "membrane", "roller"):
            model = rbvi.Model(MODELS / run / "model.h5")
            x, y = list(model.parameters)[:2]
            axes = model.map("normal_force", count=25)
            self.check(axes, bool(model.outputs["normal_force"].unit))
            drawn = np.column_stack(axes.lines[-1].get_data())
            np.testing.assert_allclose(drawn, model.samples[:, :2])
            self.assertEqual(axes.get_xlim(), (model.parameters[x].lower, model.parameters[x].upper))
            contours = lines_of(axes, "black")
            forces = [model.table({x: at[:, 0], y: at[:, 1]})["normal_force"] for at in contours]
            self.assertGreater(len(forces), 3)
            step = np.diff([of.mean() for of in forces])
            self.assertTrue(np.all(step > 0), step)
            self.assertLess(max(np.ptp(of) for of in forces), 0.2 * step.min())

    def test_a_map_tells_where_nodes_touch_and_stick(self):
        """On both sides of a line the output is another one, and somewhere a node touches or lifts."""
        model = rbvi.Model(MODELS / "roller/model.h5")
        x, y = list(model.parameters)[:2]
        axes = model.map("normal_force", count=25, samples=False)
        lines = lines_of(axes, PURPLE)
        self.assertGreater(len(lines), 1)
        cell = np.array([np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())]) / 24
        for at in lines:
            around = np.concatenate([np.clip(at[:20] + way * cell, *np.array([axes.get_xlim(), axes.get_ylim()]).T)
                                     for way in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1))])
            table = model.table({x: around[:, 0], y: around[:, 1]})
            self.assertTrue(any(np.ptp(table[name]) > 0 for name in STATES))
        words = [text.get_text() for text in axes.get_legend().get_texts()]
        for name, line in zip(STATES, words):
            grid = model.table(dict(zip((x, y), grid_of([axes.get_xlim(), axes.get_ylim()], 25))))[name]
            self.assertIn(f"{name.replace('_', ' ')} {grid.min():.0f} to {grid.max():.0f}", line)

    def test_steps_between_whole_numbers(self):
        for low, high in ((0, 1), (3, 4), (0, 8), (5, 230), (0, 20), (7, 7.5)):
            levels, every = steps_between(low, high)
            self.assertTrue(np.all((levels > low) & (levels < high)) and len(levels) <= 10, levels)
            self.assertTrue(np.all(levels % 1 == 0.5) and (every > 1 or len(levels) == int(high - low)), levels)

    def test_what_is_no_map(self):
        model = rbvi.Model(MODELS / "disk_condensed/model.h5")
        first, second = list(model.parameters)[:2]
        for wrong in ({"x": first, "y": first}, {first: model.parameters[first].value}, {"x": "depths"}):
            with self.assertRaises(rbvi.BadInput):
                model.map("normal_force", **wrong)
        self.assertEqual(len(model.map("normal_force", y=second, samples=False, count=3).lines), 0)

    def test_bars(self):
        model = rbvi.Model(MODELS / "membrane/model.h5")
        found = model.sobol(OUTPUTS, count=64)
        axes = found.plot()
        self.check(axes)
        heights = [bar.get_height() for bar in axes.containers[0]]
        np.testing.assert_allclose(heights, [found.total[name][next(iter(model.parameters))] for name in OUTPUTS])


if __name__ == "__main__":
    import matplotlib
    matplotlib.use("Agg")
    unittest.main(argv=sys.argv[:1])
