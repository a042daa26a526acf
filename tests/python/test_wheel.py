#!/usr/bin/env python3
"""test_wheel.py LIBRARY SOURCE MODEL BIN: a wheel of the package, made without a network, is unpacked
into an empty folder, where it has its library with it and answers with the digits of rbvi-online.

Skipped (77) where pip, setuptools or wheel are not there.
"""

import csv
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

ASKS = """
import json, pathlib, sys, rbvi
from rbvi import _library
here = pathlib.Path(sys.argv[1])
for path in (rbvi.__file__, _library.LIBRARY._name):
    if here not in pathlib.Path(path).parents:
        sys.exit(f"{path} is not that of the wheel")
m = rbvi.Model("model.rbvi")
print(json.dumps([m(**mu).outputs for mu in json.loads(sys.argv[2])]))
"""


def run(*command, **how):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **how)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: status {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def wheel_of(source, library, work):
    """Of a copy of the source, which nothing is left of from before."""
    shutil.copytree(source / "src/python", work / "source/src/python",
                    ignore=shutil.ignore_patterns("build", "*.egg-info", "__pycache__"))
    shutil.copyfile(source / "CMakeLists.txt", work / "source/CMakeLists.txt")
    run(sys.executable, "-m", "pip", "wheel", "--no-build-isolation", "--no-deps", "--no-index",
        "--disable-pip-version-check", "-w", work / "wheels", work / "source/src/python",
        env={**os.environ, "RBVI_LIBRARY": str(library)})
    return next((work / "wheels").glob("rbvi-*.whl"))


def main(library, source, model, binaries):
    for name in ("pip", "setuptools", "wheel"):
        if importlib.util.find_spec(name) is None:
            print(f"skipped: {name} is not installed")
            return 77
    with tempfile.TemporaryDirectory() as folder:
        work, online = Path(folder).resolve(), binaries / "rbvi-online"
        with zipfile.ZipFile(wheel_of(source, library, work)) as wheel:
            wheel.extractall(work / "unpacked")
        modules = {path.name for path in (source / "src/python/rbvi").glob("*.py")}
        there = {path.name for path in (work / "unpacked/rbvi").iterdir()}
        if there != modules | {"librbvi.so.1"}:
            sys.exit(f"the wheel has {sorted(there)}")
        empty = work / "empty"
        empty.mkdir()
        run(online, model, "--pack", empty / "model.rbvi")
        run(online, model, "--queries", "random:5:1", "--precision", "17", "--out", work / "told.csv")
        with open(work / "told.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        names = list(rows[0])[:list(rows[0]).index("energy")]
        mu = [{name: float(row[name]) for name in names} for row in rows]
        alone = {name: value for name, value in os.environ.items()
                 if not name.startswith(("RBVI", "PYTHON", "LD_LIBRARY"))}
        answers = json.loads(run(sys.executable, "-c", ASKS, work / "unpacked", json.dumps(mu), cwd=empty,
                                 env={**alone, "PYTHONPATH": str(work / "unpacked")}))
        for row, answer in zip(rows, answers, strict=True):
            for name in ("energy", "normal_force", "tangential_force", "peak_pressure"):
                if answer[name] != float(row[name]):
                    sys.exit(f"{name} is {answer[name]!r} by the wheel, {row[name]} by rbvi-online")
    print("the wheel has its library, and the digits of rbvi-online")
    return 0


if __name__ == "__main__":
    sys.exit(main(*(Path(word).resolve() for word in sys.argv[1:])))
