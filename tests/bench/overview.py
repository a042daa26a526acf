#!/usr/bin/env python3
"""overview.py BIN WORK [NAME ...]: run time against error, of every scene and formulation.
overview.py draw: the pictures anew, of overview/points.csv.

Writes tests/bench/README.md, and into overview beside it a picture for each scene and the table of their
marks, from runs in WORK, where those that are there already are taken. With names: these alone, as tables
on the screen.

- full solves: each method of rbvi bench on the default mesh; the best one on this mesh and finer ones
  against the finest, by energy and normal force at three of the training parameters;
- models: every row of rbvi bench, of each reduction;
- interpolation of the snapshots, which enforces no constraint.
"""

import csv
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "tests/bench/overview"
sys.path.insert(0, str(ROOT / "cases"))

from bench_figures import KINDS, number, pareto
from figure_tools import BLUE, FLOOR, np, plt, whole_decades
from panels import Curve, Lines, figure_of

DISK = "rigid_disk"
NITSCHE = ("-variant", "nitsche")


@dataclass(frozen=True)
class Run:
    name: str
    scene: str  # picture that it belongs to
    case: str
    options: tuple = ()
    levels: int = 2  # the finest mesh that full solves are compared with


RUNS = (
    Run("membrane, hybrid cone", "membrane_obstacle", "membrane_obstacle"),
    Run("membrane, published cone", "membrane_obstacle", "membrane_obstacle", ("-variant", "published")),
    Run("two disks, condensed", "two_disks", "two_disks"),
    Run("two disks, cone", "two_disks", "two_disks", ("-variant", "cone")),
    Run("two disks, published", "two_disks", "two_disks", ("-variant", "published")),
    Run("two disks, large", "two_disks_large", "two_disks", ("-variant", "large")),
    Run("disk, no friction", "disk_none", DISK, ("-friction", "none")),
    Run("disk, no friction, Nitsche", "disk_none", DISK, (*NITSCHE, "-friction", "none")),
    Run("disk, no friction, Nitsche, published", "disk_none", DISK,
        ("-variant", "nitsche_published", "-friction", "none")),
    Run("disk, Tresca", "disk_tresca", DISK, ("-friction", "tresca")),
    Run("disk, Tresca, Nitsche", "disk_tresca", DISK, (*NITSCHE, "-friction", "tresca")),
    Run("disk, Coulomb, condensed", "disk_coulomb", DISK),
    Run("disk, Coulomb, collocated", "disk_coulomb", DISK, ("-multiplier_reduction", "collocated")),
    Run("disk, Coulomb, published", "disk_coulomb", DISK, ("-variant", "published")),
    Run("disk, Coulomb, Nitsche", "disk_coulomb", DISK, NITSCHE),
    Run("disk, large", "disk_large", DISK, ("-variant", "large")),
    Run("disk, large, Coulomb", "disk_large", DISK, ("-variant", "large", "-friction", "coulomb")),
    Run("disk, large, published", "disk_large", DISK, ("-variant", "published_large")),
    Run("disk, large, Nitsche", "disk_large", DISK, ("-variant", "large_nitsche")),
    Run("roller", "roller", "roller"),
    Run("roller, no friction, cone", "roller", "roller",
        ("-friction", "none", "-multiplier_reduction", "cone")),
    Run("roller, Nitsche", "roller", "roller", ("-formulation", "nitsche")),
    Run("patch", "patch", "patch"),
    Run("flange", "bolted_flange", "bolted_flange", levels=1),
    Run("seal", "seal", "seal", levels=1),
    Run("bracket", "bracket", "bracket"),
    Run("joint", "joint", "joint"),
)


def called(log, *command, allowed=(0,)):
    """What it prints; from the log of an earlier run where there is one."""
    if not log.is_file():
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True,
                              check=False)
        if done.returncode not in allowed:
            sys.exit(f"{' '.join(map(str, command))}\n{done.stderr}")
        log.write_text(done.stdout + done.stderr, encoding="utf-8")
    return log.read_text(encoding="utf-8")


def rows_of(path):
    with open(path, encoding="utf-8", newline="") as table:
        return list(csv.DictReader(table))


def folder_of(run):
    return run.name.replace(", ", "-").replace(" ", "_")


def measured(binaries, work, run):
    """Rows of rbvi bench, and seconds offline."""
    folder = work / folder_of(run)
    case = ["-case", ROOT / "cases" / run.case, *run.options]
    called(work / f"{folder.name}.offline.log", "mpirun", "-n", "2", binaries / "rbvi", "offline", *case,
           "-out", folder)
    told = called(work / f"{folder.name}.bench.log", binaries / "rbvi", "bench", "-out", folder,
                  allowed=(0, 1))  # 1: some row has no answer
    return rows_of(folder / "bench/table.csv"), told


def some_parameters(work, run):
    """Three samples of the training set, as -mu takes them."""
    rows = rows_of(work / folder_of(run) / "samples.csv")
    names = list(rows[0])[:list(rows[0]).index("energy")]
    return [",".join(f"{name}={row[name]}" for name in names)
            for row in (rows[len(rows) * k // 4] for k in (1, 2, 3))]


def meshes(binaries, work, run):
    """(milliseconds, error) of full solves on meshes refined 0, 1, ... times."""
    answers = []
    for level in range(run.levels + 1):
        answers.append([])
        for k, mu in enumerate(some_parameters(work, run)):
            stem = work / f"{folder_of(run)}.mesh{level}.{k}"
            called(stem.with_suffix(f".{k}.log"), binaries / "rbvi", "solve", "-case",
                   ROOT / "cases" / run.case, *run.options, "-mu", mu, "-mesh_refine", level,
                   "-csv", f"{stem}.csv")
            answers[-1] += rows_of(f"{stem}.csv")
    names = [name for name in ("energy", "normal_force") if name in answers[0][0]]
    scale = {name: max(abs(number(row[name])) for row in answers[-1]) for name in names}
    return [(1e3 * float(np.median([number(row["seconds"]) for row in rows])),
             max(abs(number(a[name]) - number(b[name])) / scale[name]
                 for a, b in zip(rows, answers[-1]) for name in names))
            for rows in answers[:-1]]


def first(rows, start, includes=""):
    """The last row whose method begins so: of a model, the whole one."""
    found = [row for row in rows if row["method"].startswith(start) and row["u_max"]
             and (not includes or row["includes"] == includes)]
    return found[-1] if found else None


def pays(full, row, field):
    """A sentence on whether the reduction wins, by the row that does what the full solve does."""
    if row is None:
        return "no answer of the model at some parameter"
    best, quick, whole = (number(r["median_ms"]) for r in (full, row, field))
    if whole < best:
        return f"from {field['benefit_from']} queries on, with its field"
    if quick < best:
        return f"from {row['benefit_from']} queries on without the field; with it the full solve is faster"
    return "the full solve is faster"


def table(results):
    head = ["", "dofs", "mesh error", "full solve, warm (ms)", "interpolation (ms)", "its error",
            "outputs (ms)", "with field (ms)", "u, largest", "multipliers", "outputs",
            "full solve / outputs, / with field", "reduction pays"]
    lines = [head, ["---"] * len(head)]
    for run, (rows, told, levels) in results.items():
        full, between = rows[0], next((r for r in rows if "interpolation" in r["method"]
                                       or "nearest" in r["method"]), None)
        row, field = first(rows, "reduced", "outputs"), first(rows, "reduced", "outputs, field")
        best = number(full["median_ms"])
        ratio = "" if row is None else (f"{best / number(row['median_ms']):.3g}, "
                                        f"{best / number(field['median_ms']):.3g}")
        nodes = told.split(" nodes")[0].split()[-1]
        lines.append([run.name, nodes, f"{levels[0][1]:.1e}", full["median_ms"],
                      between["median_ms"] if between else "", between["u_max"] if between else "",
                      *([row["median_ms"], field["median_ms"], row["u_max"], row["lambda_max"],
                         row["outputs_max"]] if row else [""] * 5), ratio, pays(full, row, field)])
    lines[0][1] = "nodes"
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


MARKS = ("o", "P", "*", "h", "X")  # of the models of a scene, one for each run


@dataclass(frozen=True)
class Point:
    """A mark of a picture."""
    scene: str
    run: str
    method: str  # as rbvi bench calls it; MESH of a full solve against a finer mesh
    ms: float
    error: float


MESH = "mesh"


def points_of(results):
    found = []
    for run, (rows, _, levels) in results.items():
        found += [Point(run.scene, run.name, row["method"], number(row["median_ms"]), number(row["outputs_max"]))
                  for row in rows if row["outputs_max"]]
        found += [Point(run.scene, run.name, MESH, ms, error) for ms, error in levels]
    return found


def curve_of(points, label, colour, style):
    return Curve(np.array([point.ms for point in points]), np.array([max(point.error, FLOOR) for point in points]),
                 label, colour, style, width=0.9)


def kind_of(point):
    """The beginning of a method that bench_figures knows, its words, colour and mark."""
    return next(kind for kind in KINDS if point.method.startswith(kind[0]))


def panel(scene, points):
    """Errors of the outputs over time: the answers of all runs of a scene, the Pareto front, and the error of the
    mesh."""
    answers = [point for point in points if point.method != MESH]
    models = [point for point in answers if kind_of(point)[0] == "reduced"]
    curves = []
    for label, colour, mark in dict.fromkeys(kind_of(point)[1:] for point in answers if point not in models):
        curves.append(curve_of([point for point in answers if kind_of(point)[1] == label], label, colour, mark))
    runs = list(dict.fromkeys(point.run for point in models))
    for run, mark in zip(runs, MARKS):
        curves.append(curve_of([point for point in models if point.run == run], f"model: {run}", BLUE, mark))
    for k, run in enumerate(dict.fromkeys(point.run for point in points)):
        curves.append(curve_of([point for point in points if (point.run, point.method) == (run, MESH)],
                               "" if k else "full solves over meshes", "black", "x:"))
    front = [answers[k] for k in pareto(*np.array([(point.ms, point.error) for point in answers]).T)]
    steps = [Point(scene, "", "", later.ms, before.error) for before, later in zip(front, front[1:])]
    curves.append(curve_of([point for pair in zip(front, [*steps, None]) for point in pair if point],
                           "Pareto front", "black", "-"))
    return Lines(scene.replace("_", " "), "median time of an answer (ms)", "largest error of the outputs (-)", curves,
                 log=True, log_x=True, floor=FLOOR)


def draw(scene, points, path):
    figure, failed = figure_of([panel(scene, points)])
    whole_decades(figure.axes[0])
    figure.savefig(path, dpi=150, bbox_inches="tight", pad_inches=0.02)
    plt.close(figure)
    if failed:
        sys.exit("\n".join(failed))


def draw_all(points, folder):
    for scene in dict.fromkeys(point.scene for point in points):
        draw(scene, [point for point in points if point.scene == scene], folder / f"{scene}.png")


def stored(path):
    return [Point(row["scene"], row["run"], row["method"], number(row["ms"]), number(row["error"]))
            for row in rows_of(path)]


def store(points, path):
    with open(path, "w", encoding="utf-8", newline="") as table:
        writer = csv.writer(table, lineterminator="\n")
        writer.writerow(["scene", "run", "method", "ms", "error"])
        writer.writerows([point.scene, point.run, point.method, f"{point.ms:.4g}", f"{point.error:.3g}"]
                         for point in points)


PAGE = """# Run time against error, of every scene and formulation

Command `tests/bench/all overview`, commit {commit}, {cores} cores. One page for what the pages beside it measure
scene by scene ([tests](../README.md#benchmarks)).

- *full solve, warm*: the best high-fidelity solver, started from the answer at the parameter before, with its field.
- *interpolation*: of the snapshots, multilinear on grids, else by cubic radial functions; it enforces no constraint.
- *outputs*, *with field*: an answer of the model with its outputs; with the displacement of every node as well.
- errors: of the model against full solves on the same mesh, largest over the validation set; outputs over the range
  of each. *mesh error*: of energy and normal force on this mesh against the mesh refined twice, of flange and seal
  once.
- *reduction pays*: offline seconds, the full solves among them, over what a query saves.

{table}
Where the error of a model is below that of its mesh, a finer mesh improves the answer and a larger model does not:
crosses in the pictures are full solves on the default mesh and finer ones, against the finest. The marks of the
pictures are in `overview/points.csv`; `overview.py draw` draws them anew.

{pictures}
"""


def main(binaries, work, *names):
    work = Path(work)
    work.mkdir(parents=True, exist_ok=True)
    chosen = [run for run in RUNS if not names or run.name in names]
    results = {}
    for run in chosen:
        print(run.name, flush=True)
        results[run] = (*measured(Path(binaries).resolve(), work, run),
                        meshes(Path(binaries).resolve(), work, run))
    made = table(results)
    if names:
        print(made)
        return
    FOLDER.mkdir(exist_ok=True)
    store(points_of(results), FOLDER / "points.csv")
    draw_all(stored(FOLDER / "points.csv"), FOLDER)
    scenes = list(dict.fromkeys(run.scene for run in chosen))
    commit = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True,
                            text=True, check=True).stdout.strip()
    (ROOT / "tests/bench/README.md").write_text(
        PAGE.format(commit=commit, cores=len(os.sched_getaffinity(0)), table=made,
                    pictures="\n".join(f"![{scene}](overview/{scene}.png)" for scene in scenes)),
        encoding="utf-8")


if __name__ == "__main__":
    if sys.argv[1:] == ["draw"]:
        draw_all(stored(FOLDER / "points.csv"), FOLDER)
    else:
        main(*sys.argv[1:])
