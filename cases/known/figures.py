#!/usr/bin/env python3
"""figures.py RBVI PNG: pressures of five cases beside this file against their formulas, as one picture.

RBVI is the program, which solves each case once on its own mesh (gmsh meshes three of them).
"""

import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

import numpy as np  # noqa: E402
from figure_tools import BLUE, GREY, read_grid  # noqa: E402
from panels import Curve, Lines, figure_of  # noqa: E402


def answer(program, case, mu, folder):
    """Points along the contact and their stresses, of one solve."""
    path = Path(folder) / f"{case}.vtu"
    subprocess.run([program, "solve", "-case", str(HERE / case), "-mu", mu, "-vtu", str(path)], check=True,
                   stdout=subprocess.DEVNULL)
    grid = read_grid(path.with_name(f"{case}_contact.vtu"))
    order = np.argsort(grid.points[:, 0])
    return grid.points[order, 0], {name: np.ravel(values)[order] for name, values in grid.of_nodes.items()
                                   if np.size(values) == len(order)}


def ellipse(x, a):
    return np.sqrt(np.maximum(0, 1 - (x / a)**2))


def spike(x, a):
    return np.arccosh(np.maximum(1, a / np.maximum(np.abs(x), 1e-9)))


def panel(title, x, found, formula, reach):
    """Nodes of the answer between the limits of x, and the formula between them."""
    fine, inside = np.linspace(max(x.min(), reach[0]), min(x.max(), reach[1]), 4001), (reach[0] <= x) & (x <= reach[1])
    return Lines(title, "x (m)", "stress (Pa)", [Curve(fine, formula(fine), "formula", GREY, width=1),
                                                 Curve(x[inside], found[inside], "rbvi, at nodes", BLUE, ".")])


def main(program, png):
    a, peak = 2 * np.sqrt(0.01 / np.pi), np.sqrt(0.01 / np.pi)

    def spike_of(slope):
        return lambda s: np.where(np.abs(s) < 0.01, np.nan, slope * spike(s, 1))

    with tempfile.TemporaryDirectory() as folder:
        def pressure(title, case, mu, formula, reach):
            x, stress = answer(program, case, mu, folder)
            return panel(title, x, stress["pressure"], formula, reach)

        x, stress = answer(program, "partial_slip", f"force={np.pi / 4000},share=0.5", folder)
        panels = [
            pressure("cylinder: pressure", "hertz_line", "force=0.01", lambda s: peak * ellipse(s, a), (-0.15, 0.15)),
            panel("partial slip: shear", x, np.abs(stress["tangential_stress"]), lambda s: 0.00015 * (
                ellipse(s, 1) - np.sqrt(0.5) * ellipse(s, np.sqrt(0.5))), (-1.3, 1.3)),
            pressure("ball: pressure", "hertz_point", f"force={4 / 3 * 0.1**3}",
                     lambda s: 0.2 / np.pi * ellipse(s, 0.1), (0, 0.15)),
            pressure("cone: pressure", "cone", f"force={0.005 * np.pi}", spike_of(0.005), (0, 1.3)),
            pressure("wedge: pressure", "wedge", "force=0.01", spike_of(0.01 / np.pi), (0, 1.3))]
    panels[3].ylimits, panels[4].ylimits = (0, 0.035), (0, 0.025)
    for one in panels[3:]:
        one.curves[0].x, one.curves[0].y = (values[np.isfinite(one.curves[0].y)] for values in
                                            (one.curves[0].x, one.curves[0].y))
    figure, failed = figure_of(panels)
    figure.savefig(png, dpi=150, bbox_inches="tight", pad_inches=0.02)
    return "\n".join(failed)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2]))
