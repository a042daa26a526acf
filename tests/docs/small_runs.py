#!/usr/bin/env python3
"""small_runs.py BIN OUT: a run of every kind on few parameters, for the tests layout, columns, figures
and vtu.

Each run OUT/NAME is made, asked and verified, some are measured: model.h5, samples, every table of
rbvi, online_before.csv and online_after.csv (rbvi-online before and after rbvi verify), solve.csv,
u.vtu of that solve and online.vtu of rbvi-online at the same mu. OUT/answers/NAME has solve.csv and
u.vtu of every scene and formulation, OUT/checks/NAME what rbvi check draws of some cases. Solids are
there where gmsh is, which meshes them.
"""

import shutil
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from at_once import run_program
from every_scene import CASES, every_scene

DISK = ["-case", CASES / "rigid_disk/case.yaml", "-arc_edges", "40"]
TWO = ["-case", CASES / "two_disks/case.yaml", "-arc_edges", "40"]
NITSCHE = [*DISK, "-formulation", "nitsche", "-train", "grid:5"]
REDUCED = "-multiplier_reduction"
RUNS = {
    "membrane": ["-case", CASES / "membrane_obstacle/case.yaml", "-train", "grid:3,2,2"],
    "membrane_mcpg": ["-case", CASES / "membrane_obstacle/case.yaml", "-variant", "published", "-train", "grid:3,2,2",
                      "-cone_type", "mcpg", "-pga_tolerance", "infsup"],
    "membrane_frame": ["-case", CASES / "membrane_obstacle/case.yaml", "-train", "grid:3,3",
                       "-parameters", "radius,frame_height"],
    "membrane_degree_2": ["-case", CASES / "membrane_obstacle/case.yaml", "-train", "grid:3,2,2",
                          "-degree", "2", "-lumped", "no"],
    "two_disks": [*TWO, "-train", "grid:9"],
    "two_disks_cone": [*TWO, "-variant", "cone", "-train", "grid:9"],
    "disk_none": [*DISK, "-train", "grid:9", "-friction", "none", "-certify"],
    "disk_condensed": [*DISK, "-train", "grid:3,3", "-parameters", "radius,core_stiffness", "-certify"],
    "disk_collocated": [*DISK, "-train", "grid:15", "-normal", "rigid", REDUCED, "collocated"],
    "disk_large": ["-case", CASES / "rigid_disk/case.yaml", "-variant", "large", "-train", "random:8:1"],
    "disk_large_cone": [*DISK, "-variant", "large", "-train", "random:8:1", REDUCED, "cone"],
    "nitsche_empirical": NITSCHE,
    "nitsche_interpolated": [*NITSCHE, "-nitsche_quadrature", "interpolated",
                             "-nitsche_eim_validation", "random:2:2"],
    "free_block": ["-case", CASES.parent / "tests/cases/free_block/case.yaml"],
    "roller": ["-case", CASES / "roller/case.yaml", "-train", "grid:3,3"],
    "roller_nitsche": ["-case", CASES / "roller/case.yaml", "-train", "grid:3,3", "-arc_edges", "24",
                       "-formulation", "nitsche"],
}
COARSE = {"rigid_ball": ["-set", "mesh.set.size=3"]}  # options of rbvi check
CHECKED = ("membrane_obstacle", "two_disks", "roller")
HAS_SOLIDS = shutil.which("gmsh") is not None
if HAS_SOLIDS:
    RUNS["solid"] = ["-case", CASES / "rigid_ball/case.yaml", *COARSE["rigid_ball"], "-train", "grid:3,3"]
    CHECKED += ("rigid_ball",)
MEASURED = ("two_disks", "nitsche_empirical")  # by rbvi bench, which takes longest
GROWN = "disk_none"  # by rbvi bench -bench_growth


def call(*command):
    done = run_program(command)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, command))}\n{done.stderr}")


def make(binaries, out, options):
    rbvi, online, few = binaries / "rbvi", binaries / "rbvi-online", ["-valid", "random:2:1"]
    ask = [online, out / "model.h5", "--queries", "random:2:3", "--out"]
    call(rbvi, "offline", *options, "-out", out)
    call(*ask, out / "online_before.csv")
    call(rbvi, "verify", "-out", out, *few)
    call(*ask, out / "online_after.csv")
    if out.name in MEASURED:
        call(rbvi, "bench", "-out", out, *few)
    if out.name == GROWN:
        call(rbvi, "bench", "-out", out, "-bench_growth", "0", "-train", "grid:2")
    table = (out / "samples.csv").read_text(encoding="utf-8").splitlines()
    mu = ",".join(table[1].split(",")[:table[0].split(",").index("energy")])
    call(online, out / "model.h5", "--mu", mu, "--vtu", out / "online.vtu")
    answer(rbvi, out, ["-case", out / "case.yaml"], mu)


def answer(rbvi, out, options, mu):
    out.mkdir(parents=True, exist_ok=True)
    call(rbvi, "solve", *options, "-mu", mu, "-csv", out / "solve.csv", "-vtu", out / "u.vtu")


def check(rbvi, out, case):
    out.mkdir(parents=True)
    call(rbvi, "check", case, "-vtu", out / "u.vtu", *COARSE.get(case.name, []))


def main(binaries, out):
    shutil.rmtree(out, ignore_errors=True)
    with ThreadPoolExecutor(2) as pool:
        jobs = [pool.submit(make, binaries, out / name, options) for name, options in RUNS.items()]
        jobs += [pool.submit(answer, binaries / "rbvi", out / "answers" / one.name,
                             ["-case", one.case, *one.scene], one.mu[-1])
                 for one in every_scene() if not one.reduction]
        jobs += [pool.submit(check, binaries / "rbvi", out / "checks" / name, CASES / name)
                 for name in CHECKED]
        for done in jobs:
            done.result()
    print(f"{len(RUNS)} runs in {out}")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve())
