"""The programs on a case file: new, check, solve, offline, verify. Their options are keywords."""

import csv
import tempfile
from pathlib import Path

from . import _library as library
from .model import Model, Values


def options(values):
    """{"pod_tol": 1e-4, "parameters": ["radius", "depth"]} as words of a command."""
    words = []
    for name, value in values.items():
        if isinstance(value, (list, tuple)):
            value = ",".join(map(str, value))
        elif isinstance(value, bool):
            value = "yes" if value else "no"
        words += [f"-{name}", str(value)]
    return words


def rbvi(command, ranks, quiet, values):
    launch = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
    return library.run([*launch, library.program("rbvi"), command, *options(values)], quiet)


def new(name, *, quiet=False):
    """`rbvi new`: a case to begin with, in a folder of this name."""
    library.run([library.program("rbvi"), "new", name], quiet)
    return f"{name}/case.yaml"


def check(case, *, quiet=False, **values):
    """`rbvi check`: what is wrong in a case file raises BadInput. Returns its lines."""
    return rbvi("check", 1, quiet, {"case": case, **values})


def solve(case, mu, *, ranks=1, quiet=True, **values):
    """`rbvi solve`: the outputs of one full solve by name; `mu`: parameters by name."""
    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder) / "answer.csv"
        at = ",".join(f"{name}={value if isinstance(value, str) else repr(float(value))}" for name, value in mu.items())
        rbvi("solve", ranks, quiet, {"case": case, "mu": at, "csv": table, **values})
        with open(table, encoding="utf-8", newline="") as file:
            row = next(csv.DictReader(file))
    return Values({name: float(value) for name, value in row.items() if value})


def offline(case, out, *, ranks=1, quiet=False, **values):
    """`rbvi offline`: full solves over `ranks` ranks of MPI, and the model of them, in `out`."""
    rbvi("offline", ranks, quiet, {"case": case, "out": out, **values})
    return Model(f"{out}/model.h5")


def verify(out, *, ranks=1, quiet=False, **values):
    """`rbvi verify`: measures the errors of the model in `out`, which its answers then tell."""
    rbvi("verify", ranks, quiet, {"out": out, **values})
    return Model(f"{out}/model.h5")
