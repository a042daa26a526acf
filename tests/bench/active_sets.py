#!/usr/bin/env python3
"""active_sets.py RBVI_ONLINE RUN...: how often the first guess of contact and stick is right.

For each run with a condensed model, a row of the table in cases/CHOOSING.md: the same 200 random
queries from different starts. A query that takes one linear system had the right sets at once. Starts
are: what the samples around a query predict; the answer at the nearest sample, which a --warm query
just before it leaves; the query before; and rest, by a copy of the model without its starts. The path
goes from the least to the largest values of all parameters, in as many points. Where contact alone
holds a body, a query is several contact problems, and its steps are those of all.
"""

import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

COUNT, SEED = 200, 5
SEAL, FNV = 512, (14695981039346656037, 1099511628211)


def checksum(data):
    value = FNV[0]
    for byte in data:
        value = ((value ^ byte) * FNV[1]) % 2**64
    return value.to_bytes(8, "little")


def without_starts(model, folder):
    """A copy of a model that starts queries from rest, sealed anew (include/rbvi/io/h5.hpp)."""
    path = folder / "model.h5"
    path.write_bytes(model.read_bytes())
    with h5py.File(path, "r+") as file:
        for name in ("law/starts", "law/starts_mu"):
            rows = file[name].shape[0]
            del file[name]
            file[name] = np.zeros((rows, 0))
    data = bytearray(path.read_bytes())
    data[48:56] = len(data).to_bytes(8, "little")
    data[56:64] = checksum(data[SEAL:])
    data[64:72] = checksum(data[:64])
    path.write_bytes(data)
    (folder / "model.fields.h5").symlink_to(model.with_name("model.fields.h5").resolve())
    return path


class Model:
    def __init__(self, run):
        self.path = run / "model.h5"
        with h5py.File(self.path) as file:
            free = file["parameters/free"][()].ravel()
            self.names = [str(name, "utf-8") for name in file["parameters/names"][()][free]]
            self.lower, self.upper = (file["parameters/" + end][()][free] for end in ("lower", "upper"))
            self.samples = file["law/starts_mu"][()].T
            self.held_by_contact = file["springs/motions"].size > 0
            self.name = run.name

    def nearest(self, points):
        """Of the samples to each point, in parts of the box."""
        width = self.upper - self.lower
        return np.array([self.samples[np.argmin((((self.samples - x) / width) ** 2).sum(axis=1))]
                         for x in points])


def answers(online, model, queries, *options):
    text = ",".join(model.names) + "\n" + "".join(
        ",".join(map(repr, map(float, row))) + "\n" for row in queries)
    out = subprocess.run([online, str(model.path), "--queries", "-", "--precision", "16", *options],
                         input=text, capture_output=True, text=True, check=False)
    rows = list(csv.DictReader(out.stdout.splitlines()))
    if len(rows) != len(queries):
        raise SystemExit(f"active_sets.py: {model.path}: {out.stderr}")
    return rows


def random_queries(online, model):
    out = subprocess.run([online, str(model.path), "--queries", f"random:{COUNT}:{SEED}", "--precision",
                          "17"], capture_output=True, text=True, check=True)
    return np.array([[float(row[name]) for name in model.names]
                     for row in csv.DictReader(out.stdout.splitlines())])


def steps_of(rows, whole):
    """"93.5 %, 1.06": the share that took one step, and the steps in the mean; of several problems
    for each query the steps alone."""
    steps = np.array([int(row["iterations"]) for row in rows if row["status"] == "ok"])
    share = "" if whole else f"{100 * np.mean(steps <= 1):.1f} %, "
    missing = len(rows) - len(steps)
    return share + f"{steps.mean():.2f}" + (f" ({missing} without an answer)" if missing else "")


def differences(rows, others):
    """Of energies, relative."""
    return [abs(float(row["energy"]) / float(other["energy"]) - 1) for row, other in zip(rows, others)
            if row["status"] == other["status"] == "ok"]


def row_of(online, run):
    """Cells of the table, and the largest difference between answers from different starts."""
    model = Model(run)
    points = random_queries(online, model)
    pairs = np.stack([model.nearest(points), points], axis=1).reshape(-1, points.shape[1])
    path = np.linspace(model.lower, model.upper, COUNT)
    with tempfile.TemporaryDirectory() as folder:
        rest = Model(run)
        rest.path = without_starts(model.path, Path(folder))
        of_random = [answers(online, model, points), answers(online, model, pairs, "--warm")[1::2],
                     answers(online, model, points, "--warm"), answers(online, rest, points)]
    of_path = [answers(online, model, path), answers(online, model, path, "--warm")]
    apart = max(difference for of in (of_random, of_path) for rows in of[1:]
                for difference in differences(of[0], rows))
    cells = [steps_of(rows, model.held_by_contact) for rows in of_random + of_path]
    return [model.name, f"{len(model.names)}, {len(model.samples)}", *cells], apart


def main(arguments):
    if len(arguments) < 2:
        print(__doc__, file=sys.stderr)
        return 2
    heads = ("run", "free, samples", "samples around", "nearest sample", "query before", "rest",
             "path, samples around", "path, point before")
    print("| " + " | ".join(heads) + " |\n" + "|---" * len(heads) + "|")
    largest = 0
    for run in arguments[1:]:
        cells, apart = row_of(arguments[0], Path(run))
        print("| " + " | ".join(cells) + " |", flush=True)
        largest = max(largest, apart)
    print(f"\nEnergies from different starts differ by {largest:.0e} at most, relative.")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
