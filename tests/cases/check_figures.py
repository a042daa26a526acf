#!/usr/bin/env python3
"""check_figures.py RUNS SCRATCH: the numbers that the panels of cases/figures.py are made of.

RUNS is of tests/docs/small_runs.py: every figure of every run, and the picture of an answer of every
scene and formulation. A damaged file leaves the other figures (in SCRATCH).
"""

import csv
import os
import re
import shutil
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "cases"), str(ROOT / "tests/docs"), str(ROOT / "tests")]

import figures
from case_figures import case_panels
from figure_tools import UNITS, Grid, is_solid, plt, read_grid, table, use_units
from model_figures import drawn_outputs, output_panels, places_of, stress_panels
from panels import Curve, Drawn, Lines, Triangles, figure_of, in_columns, shown, with_values
from small_runs import CHECKED, RUNS
from solid_figures import seen, skin_of, view_of
from solid_solution import tangential_of
from solution_figures import contact_grids, scale_of, solution_panels, turns_over

# Of the force. Nitsche's method has stresses at the ends of edges alone, which do not integrate the
# stress of elements of degree 2 exactly.
FORCE_TOLERANCE = {"multipliers": 1e-3, "nitsche": 0.05}


# Files of partners: the obstacle moves with its membrane, and the second plate of the roller is fixed.
PLACES = {"membrane_obstacle": 1, "two_disks": 3, "roller": 4, "rigid_ball": 3}
OF_SIZES = re.compile(r"\((m|Pa)\)$")  # units of lengths and stresses, where these runs declare some


class Checks:
    """Collects what does not hold."""

    def __init__(self):
        self.count, self.wrong, self.drawn = 0, [], set()

    def that(self, holds, words):
        self.count += 1
        if not holds:
            self.wrong.append(words)


def check_lines(check, panel, name):
    for curve in panel.curves:
        y = np.asarray(curve.y, float)
        check.that(np.shape(curve.x) == y.shape and y.size > 0, f"{name}: {curve.label} has no values")
        drawn, _ = shown(curve, panel)
        hidden = np.isfinite(y) & ~np.isfinite(drawn)
        check.that(not np.any(hidden & (y >= panel.floor)), f"{name}: {curve.label} is not drawn")
        check.that(not (panel.log and np.any(drawn < panel.floor)), f"{name}: zero is drawn")
    check.that(panel.ylabel.endswith(")") if UNITS["length"] else not OF_SIZES.search(panel.ylabel),
               f"{name}: a unit, or none, in {panel.ylabel}")
    check.that("(" not in panel.title or panel.title.endswith(")"), f"{name}: title")


def check_triangles(check, panel, name):
    x = panel.points[panel.cells]
    sides = x[:, 1:] - x[:, :1]
    area = np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]) / 2
    extent = np.prod(np.ptp(panel.points[np.unique(panel.cells)], axis=0))
    check.that(np.all(area > 0) and 0.3 * extent < area.sum() < extent,
               f"{name}: its triangles do not cover a region")
    check.that(len(panel.values) == len(panel.cells if panel.flat else panel.points),
               f"{name}: values do not fit")
    low, high = panel.limits
    check.that(low <= panel.values.min() + 1e-9 * high and high > low, f"{name}: limits")


def check_drawn(check, panels, name):
    """Every panel is drawn, over axes that do not end at round-off."""
    drawn, words = with_values(panels)
    check.that(len(panels) > 0 and (len(drawn) == len(panels) or words), f"{name}: panels are left out without a word")
    if not drawn:
        return
    figure, failed = figure_of(drawn)
    check.that(not failed, f"{name}: {'; '.join(failed)}")
    for axis in figure.axes:
        low, high = axis.get_ylim()
        check.that(axis.get_yscale() == "log" or high - low > 1e-8 * max(abs(low), abs(high)),
                   f"{name}: an axis from {low} to {high}")
    plt.close(figure)


def check_panels(check, panels, name, kind=""):
    """Of several figures of a kind with panels of the same titles and curves the first is drawn."""
    same = (kind, *((panel.title.split(",")[0], len(getattr(panel, "curves", "")))
                     for panel in panels))
    if same not in check.drawn:
        check.drawn.add(same)
        check_drawn(check, panels, name)
    for panel in panels:
        if isinstance(panel, Lines):
            check_lines(check, panel, f"{name}, {panel.title}")
        if isinstance(panel, Triangles):
            check_triangles(check, panel, f"{name}, {panel.title}")


def force_on_curve(curve, grid):
    """Integral of the pressure of a panel over the contact curve."""
    length = np.linalg.norm(np.diff(grid.points, axis=0), axis=1)
    if len(curve.y) == 2 * len(length):
        return curve.y[::2] @ length
    return (curve.y[1:] + curve.y[:-1]) / 2 @ length


def force_on_region(panel):
    x = panel.points[panel.cells]
    sides = x[:, 1:] - x[:, :1]
    area = np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]) / 2
    return area @ panel.values[panel.cells].mean(axis=1)


def force_on_surface(panel, grid):
    """Integral of the pressure of a panel over a contact surface in space."""
    x = grid.points[panel.cells]
    area = np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1) / 2
    return area @ panel.values[panel.cells].mean(axis=1)


def check_partners(check, grid, name):
    """The way from a node to its partner has the gap along the normal."""
    along = np.sum(grid.of_nodes["to_partner"] * grid.of_nodes["normal"], axis=1)
    gap = grid.of_nodes["gap"]
    check.that(np.allclose(along, gap, rtol=0, atol=1e-12), f"{name}: partners are not a gap away")


def check_case(check, path):
    """What rbvi check draws: the surface has its groups, contacts their partners."""
    use_units(path)
    name, (panels, words) = path.parent.name, case_panels(path)
    check_panels(check, panels, f"{name}, case")
    files = list(path.parent.glob("u_partners*.vtu"))
    check.that(len(files) == PLACES[name] and len(words.splitlines()) == min(3, len(files)),
               f"{name}: {len(files)} places, {words}")
    size = np.ptp(read_grid(path.parent / "u_mesh.vtu").points, axis=0).max()
    for file in files:
        grid = read_grid(file)
        check_partners(check, grid, file)
        check.that(np.ptp(grid.points, axis=0).max() < 1.5 * size, f"{file}: is larger than the mesh")
    surface = read_grid(path.parent / "u_surface.vtu")
    free = surface.of_cells["(free)"]
    check.that(np.any(free > 0) == (name != "membrane_obstacle"), f"{name}: what is free")


def check_skin(check, grid, name):
    """The outer faces of tetrahedra enclose them, with normals to the outside."""
    skin, x = skin_of(grid.cells), grid.points
    of_cells = np.linalg.det(x[grid.cells[:, 1:]] - x[grid.cells[:, :1]]).sum() / 6
    enclosed = np.linalg.det(x[skin.faces]).sum() / 6
    check.that(abs(enclosed - of_cells) < 1e-9 * of_cells, f"{name}: the skin encloses {enclosed}, not {of_cells}")
    view = view_of(np.array([0.0, 0, 1]))
    front = skin.normals(x) @ view.towards > 0
    shown = seen(x[skin.faces].mean(axis=1), x, skin, view, np.ptp(x, axis=0).max())
    check.that(np.mean(shown[front]) > 0.9 and not np.any(shown[~front]), f"{name}: what is seen of a half-ball")


def check_answer(check, run):
    """Pressures that are drawn, over all interfaces, have the normal force of the answer as their
    integral; gaps are closed below them."""
    use_units(run / "u.vtu")
    grid, panels = read_grid(run / "u.vtu"), solution_panels(run / "u.vtu")
    check_panels(check, panels, f"{run.name}, solution", run.name.split("_")[0])
    with open(run / "solve.csv", encoding="utf-8", newline="") as file:
        answer = next(csv.DictReader(file))
    expected = float(answer["normal_force"])
    if grid.of_nodes["u"].ndim == 1:
        force = force_on_region(panels[1])
    elif is_solid(grid):
        surface = contact_grids(run / "u.vtu", grid)["support"]
        force = force_on_surface(panels[1], surface)
        counts = [int(answer[name]) for name in ("contact_nodes", "stick_nodes")]
        slipping, sticking, _ = tangential_of(surface)
        check.that([len(slipping) + len(sticking), len(sticking)] == counts, f"{run.name}: nodes are not {counts}")
        check_skin(check, grid, run.name)
    else:
        contacts = contact_grids(run / "u.vtu", grid)
        check.that(not turns_over(grid, scale_of(grid, contacts)), f"{run.name}: a triangle is turned over")
        lines = [panel for panel in panels if isinstance(panel, Lines)]
        check.that(len(lines) == len(contacts) == len(list(run.glob("u_contact*.vtu"))),
                   f"{run.name}: {len(lines)} panels of {len(contacts)} interfaces")
        force = sum(force_on_curve(panel.curves[0], contact)
                    for panel, contact in zip(lines, contacts.values()))
        half = "two_disks" in run.name  # a quarter of each disk is solved
        force *= 2 if half else 1
        for panel in lines:
            steps = np.diff(panel.curves[-1].x)  # zero where a pressure is constant on edges
            check.that(np.any(steps) and (np.all(steps >= 0) or np.all(steps <= 0)), f"{run.name}: x goes back")
    for contact in contact_grids(run / "u.vtu", grid).values():
        check_partners(check, contact, run.name)
    tolerance = FORCE_TOLERANCE["nitsche" if "nitsche" in run.name else "multipliers"]
    check.that(abs(force - expected) <= tolerance * abs(expected),
               f"{run.name}: the pressure that is drawn has the force {force:.6g}, not {expected:.6g}")


def check_errors(check, run):
    """Errors are those of the tables, at their parameters."""
    data = table(run, "errors.csv")
    for panel, error in zip(figures.errors_panels(run), ("u", "lambda")):
        reduced = next(curve for curve in panel.curves
                       if curve.label in ("reduced answers", "with supremizers"))
        check.that(np.array_equal(np.sort(reduced.y), np.sort(data[error + "_enriched"])),
                   f"{run.name}: errors of {error} are not those of the table")
    worst = table(run, "worst_pressure.csv")
    panels = figures.pressure_panels(run, worst)
    check_panels(check, panels, f"{run.name}, pressure")
    if isinstance(panels[0], Triangles):
        shown_errors = [panels[1].values]
        check.that(len(panels) == (4 if run.name == "solid" else 2), f"{run.name}: {len(panels)} panels of stresses")
    else:
        check.that(len(panels) == 2 * len(np.unique(worst["interface"])),
                   f"{run.name}: an interface has no pressure")
        shown_errors = [panel.curves[0].y for panel in panels[1::2]]
    error = np.concatenate(shown_errors)
    check.that(np.array_equal(np.sort(error), np.sort(worst["reduced"] - worst["high_fidelity"])),
               f"{run.name}: errors of the pressure are not those of the table")


def check_model(check, run):
    """Each parameter goes through its range, the others stay; stresses are those of the table."""
    along, names = table(run, "along.csv"), [name for name, _ in figures.free_parameters(run)]
    steps = len(along) // len(names)
    for k, name in enumerate(names):
        block = along[k * steps:(k + 1) * steps]
        check.that(np.all(np.diff(block[name]) > 0) and
                   all(np.ptp(block[other]) == 0 for other in names if other != name),
                   f"{run.name}: along.csv does not go along {name}")
        check.that(np.all(np.isfinite(block["energy"])), f"{run.name}: no answers along {name}")
    check.that("normal_force" in drawn_outputs(along, names), f"{run.name}: no output is drawn")
    panels, words = output_panels(run)
    titles = [panel.title for panel in panels]
    check.that("normal force" in titles and not ("reaction" in titles and "reaction" in words),
               f"{run.name}: {titles} {words}")
    for panel in panels:
        check.that(len(panel.curves) == len(names) and panel.error >= 0, f"{run.name}: {panel.title}")
        check.that(all(np.all(np.isfinite(curve.y)) and np.ptp(curve.x) > 0 for curve in panel.curves),
                   f"{run.name}: {panel.title} has gaps")
    check.that(any(panel.error > 0 for panel in panels), f"{run.name}: no band")
    rows, words = places_of(run)
    panels = stress_panels(run, rows)
    check_panels(check, panels, f"{run.name}, stresses")
    check.that(len(rows) == len(words.splitlines()) > 1, f"{run.name}: {words}")
    peaks = [own["pressure"].max() for own in rows.values()]
    drawn = [panel.values if isinstance(panel, Triangles) else
             np.concatenate([curve.y for curve in panel.curves if curve.width > 1]) for panel in panels]
    if run.name in ("two_disks", "disk_none", "roller"):
        check.that(all("training samples" in [curve.label for curve in panel.curves] for panel in panels),
                   f"{run.name}: no training samples behind the pressures")
    check.that(max(peaks) == np.max(np.concatenate(drawn)) > 0, f"{run.name}: pressures {peaks}")


def check_units(check, run):
    """Axes have units where the case declares some, and nowhere else: of the block it declares none."""
    use_units(run)
    declares = "units:" in (run / "scene.yaml").read_text(encoding="utf-8")
    check.that(declares == (run.name != "free_block"), f"{run.name}: whether its case declares units")
    check.that(UNITS == ({"length": "m", "stress": "Pa"} if declares else {"length": "", "stress": ""}),
               f"{run.name}: units {UNITS}")


def check_run(check, run):
    check_units(check, run)
    check_answer(check, run)
    check_errors(check, run)
    check_model(check, run)
    check_panels(check, figures.bases_panels(run), f"{run.name}, bases")
    check_panels(check, figures.errors_panels(run), f"{run.name}, errors")
    check_panels(check, figures.mesh_quality_panels(run), f"{run.name}, mesh_quality")
    if (run / "verify/infsup.csv").is_file():
        check_panels(check, figures.infsup_panels(run), f"{run.name}, infsup")
    data = table(run, "error_map.csv")
    data = data[np.isfinite(data["u_mean"])]
    if len(data) > 0:
        panels = figures.error_map_panels(run, data[data["enriched"] == data["enriched"].max()])
        check_panels(check, panels, f"{run.name}, error_map")
        whole = np.atleast_1d(table(run, "summary.csv"))["u_mean"][0]
        check.that(panels[0].curves[-1].y[0] == whole, f"{run.name}: the whole model is not drawn")


def check_damage(check, run, scratch):
    """A table that cannot be drawn is named; the other figures are there."""
    copy = scratch / "damaged"
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(run, copy, ignore=shutil.ignore_patterns("samples", "figures"))
    (copy / "verify/worst_pressure.csv").write_text("radius,x\nno,numbers\n", encoding="utf-8")
    drawn = os.popen(f"/usr/bin/python3 {ROOT}/cases/figures.py {copy} 2>&1")
    output = drawn.read()
    check.that(drawn.close() is not None, "figures.py succeeds with a damaged table")
    check.that("figures.py: pressure: cannot be drawn" in output and "Traceback" not in output, output)
    names = {path.stem for path in (copy / "figures").glob("*.png")}
    check.that(names == {"solution", "bases", "outputs", "stresses", "errors"}, str(names))


def check_scale(check):
    """Of a square whose upper triangle is turned over from 20 times its displacement on."""
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    u = np.zeros((4, 3))
    u[3, 1] = -0.05
    body = Grid(square, np.array([[0, 1, 2], [0, 2, 3]]), None, np.array([[0, 1, 2], [0, 2, 3]]), {"u": u}, {}, {}, {})
    check.that(not turns_over(body, 19) and turns_over(body, 21), "what is turned over")
    u[:] = 0
    u[2, 0], u[3, 0], u[3, 1] = 1e-3, 1e-3, -1.5e-3
    small = body._replace(points=square * [1, 0.01, 1])
    check.that(scale_of(body, {}) == 20 and scale_of(small, {}) == 5, "the scale of displacements")


def check_columns(check):
    """Two columns, of which the shorter one's curves fill what is left."""
    picture = Drawn("", lambda *_: None, ratio=1.5)
    curves = Lines("", "x", "y", [Curve(np.arange(3.0), np.arange(3.0))])
    panels = [picture, curves, curves, picture, curves]
    figure, _ = figure_of(panels, arrange=in_columns)
    figure.draw_without_rendering()
    left, right = ([axis for axis in figure.axes if (axis.get_position().x0 > 0.5) == side] for side in (0, 1))
    check.that([len(left), len(right)] == [2, 3], f"columns of {len(left)} and {len(right)} panels")
    ends = [min(axis.get_position().y0 for axis in side) for side in (left, right)]
    check.that(abs(ends[0] - ends[1]) < 0.05, f"columns end at {ends}")
    plt.close(figure)


def main(runs, scratch):
    check = Checks()
    check_scale(check)
    check_columns(check)
    for name in RUNS:
        check_run(check, runs / name)
    for run in sorted((runs / "answers").iterdir()):
        check_answer(check, run)
    for name in CHECKED:
        check_case(check, runs / "checks" / name / "u.vtu")
    check_damage(check, runs / "disk_none", scratch)
    print("\n".join(check.wrong) or f"{check.count} checks of {len(RUNS)} runs hold")
    return 1 if check.wrong else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
