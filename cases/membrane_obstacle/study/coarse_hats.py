#!/usr/bin/env python3
"""Models of the membrane with the hat functions of coarser meshes, against the exact solution.

    coarse_hats.py BIN [OPTION...]
                    e.g. cases/membrane_obstacle/study/coarse_hats.py build/bin -mesh_refine 2

Makes models on one mesh with -cone_level 0 (the hat functions of that mesh) to as many as
-mesh_refine says (2 where it is not given), by 2 ranks, and asks each at the parameters of
accuracy.py. Prints the high-fidelity solver's errors and theirs (accuracy.py), the sizes and the
file of each model, and seconds: of the whole offline stage, and of one answer.
"""

import re
import sys
import tempfile
from pathlib import Path
from subprocess import run

import numpy as np

from accuracy import CASE, COLUMNS, PARAMETERS, cells_of, errors_at, errors_of
from exact import Exact


def offline(programs, options, out):
    """(n, R), megabytes of the model and seconds."""
    done = run(list(map(str, ["mpirun", "-n", "2", programs / "rbvi", "offline", "-case", CASE,
                              "-out", out, *options])), capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(done.stderr)
    modes, supremizers, hats, free = (int(re.search(pattern, done.stdout).group(1)) for pattern in (
        r"N = (\d+)", r"S = (\d+)", r"R = (\d+) functions >= 0", r"\+ (\d+) of either sign"))
    seconds = float(re.search(r"^  total +([\d.]+)", done.stdout, re.MULTILINE).group(1))
    return (modes + supremizers, hats + free), (out / "model.h5").stat().st_size / 1e6, seconds


def main():
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    programs, options = Path(sys.argv[1]), sys.argv[2:]
    if "-mesh_refine" not in options:
        options += ["-mesh_refine", "2"]
    exact = [Exact(mu) for mu in PARAMETERS]
    truth = np.array([errors_at(programs / "rbvi", options, mu, at)
                      for mu, at in zip(PARAMETERS, exact)])
    print("| hats of | n | R | model.h5 (MB) | offline (s) | one answer (ms) | " +
          " | ".join(COLUMNS) + " |")
    print("|" + "---|" * (len(COLUMNS) + 6))
    print(f"| high-fidelity | | | | | {1e3 * np.median(truth[:, -1]):.0f} | " +
          " | ".join(cells_of(truth)) + " |", flush=True)
    for level in range(int(options[options.index("-mesh_refine") + 1]) + 1):
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "run"
            sizes, megabytes, seconds = offline(
                programs, [*options, "-cone_level", str(level)], out)
            rows = np.array([errors_of(lambda field, outputs, at=mu: [
                programs / "rbvi-online", out / "model.h5", "--mu", ",".join(map(repr, at)),
                "--vtu", field, "--out", outputs], solution)
                for mu, solution in zip(PARAMETERS, exact)])
        print(f"| {level} levels below | {sizes[0]} | {sizes[1]} | {megabytes:.1f} | {seconds:.1f} | "
              f"{1e3 * np.median(rows[:, -1]):.1f} | " + " | ".join(cells_of(rows)) + " |",
              flush=True)


if __name__ == "__main__":
    main()
