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
from figure_tools import BLUE, GREY, ORANGE, plt, read_grid  # noqa: E402


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


def draw(axis, title, x, found, formula, reach, colour=BLUE):
    """Nodes of the answer, and the formula between them; x and stresses as they are."""
    fine = np.linspace(x.min(), x.max(), 4001)
    axis.plot(fine, formula(fine), color=GREY, linewidth=1, label="formula")
    axis.plot(x, found, "o", color=colour, markersize=2.5, label="rbvi")
    axis.set(title=title, xlim=reach, xlabel="x [m]")


def main(program, png):
    figure, axes = plt.subplots(1, 5, figsize=(13, 2.7), layout="constrained")
    a = 2 * np.sqrt(0.01 / np.pi)
    peak = np.sqrt(0.01 / np.pi)
    with tempfile.TemporaryDirectory() as folder:
        x, stress = answer(program, "hertz_line", "force=0.01", folder)
        draw(axes[0], "cylinder: pressure", x, stress["pressure"], lambda s: peak * ellipse(s, a), (-0.15, 0.15))
        x, stress = answer(program, "partial_slip", f"force={np.pi / 4000},share=0.5", folder)
        draw(axes[1], "partial slip: shear", x, np.abs(stress["tangential_stress"]),
             lambda s: 0.00015 * (ellipse(s, 1) - np.sqrt(0.5) * ellipse(s, np.sqrt(0.5))), (-1.3, 1.3), ORANGE)
        x, stress = answer(program, "hertz_point", f"force={4 / 3 * 0.1**3}", folder)
        draw(axes[2], "ball: pressure", x, stress["pressure"], lambda s: 0.2 / np.pi * ellipse(s, 0.1), (0, 0.15))
        x, stress = answer(program, "cone", f"force={0.005 * np.pi}", folder)
        draw(axes[3], "cone: pressure", x, stress["pressure"], lambda s: 0.005 * spike(s, 1), (0, 1.3))
        x, stress = answer(program, "wedge", "force=0.01", folder)
        draw(axes[4], "wedge: pressure", x, stress["pressure"], lambda s: 0.01 / np.pi * spike(s, 1), (0, 1.3))
    axes[3].set_ylim(0, 0.035)
    axes[4].set_ylim(0, 0.025)
    axes[0].set_ylabel("stress [Pa]")
    axes[0].legend(loc="lower center")
    figure.savefig(png, dpi=110)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
