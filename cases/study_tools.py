"""What the studies of the cases share: runs of rbvi for every combination, their tables."""

import csv
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np

ENRICHMENTS = {
    "decorrelated": ["-pga_enrichment", "decorrelated"],
    "online": ["-pga_enrichment", "online"],
    "offline": ["-pga_enrichment", "offline"],
    "offline, energy": ["-pga_enrichment", "offline", "-pga_product", "energy"],
}


def last_of_each(words):
    """The words of a command line, where an option that is given again takes the place of the former."""
    taken, name = {"": []}, ""
    for word in map(str, words):
        if re.match("-[a-z]", word):
            name = word
            taken[name] = []
        else:
            taken[name].append(word)
    return [word for name, values in taken.items() for word in ([name] if name else []) + values]


class Study:
    """Runs of one case, in variants (options that change the high-fidelity answers)."""

    def __init__(self, case, variants, binaries, out, *options):
        self.case, self.variants = case, variants
        self.binaries, self.out, self.options = Path(binaries), Path(out), options
        self.out.mkdir(parents=True, exist_ok=True)
        self.environment = {
            **os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
            "OMPI_MCA_rmaps_base_oversubscribe": "1",
            "OMPI_MCA_hwloc_base_binding_policy": "none", "OPENBLAS_NUM_THREADS": "1",
            "OMP_NUM_THREADS": "1"}

    def call(self, *arguments, program="rbvi"):
        done = subprocess.run([self.binaries / program, *last_of_each(arguments)], env=self.environment,
                              capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"study: {program} {' '.join(map(str, arguments))}\n{done.stderr}")
        return done.stdout

    def solve(self, name, options, vtu=False):
        """Outputs of one high-fidelity solve, kept in OUT/solves; or why there are none, as text."""
        folder = self.out / "solves"
        folder.mkdir(exist_ok=True)
        path = folder / f"{name}.csv"
        if not path.is_file():
            files = ["-csv", path, *(["-vtu", path.with_suffix(".vtu")] if vtu else [])]
            try:
                self.call("solve", "-case", *self.case, *options, *self.options, *files)
            except SystemExit as stopped:
                return str(stopped).strip().splitlines()[-1].removeprefix("rbvi: ")
        return rows_of(path)[0]

    def run(self, variant, name, options, stability=False):
        """A run directory, made and verified unless it is there; a variant shares its samples."""
        run = self.out / variant / name.replace(", ", "_").replace(" ", "_")
        if (run / "verify" / "summary.csv").is_file():
            return run
        run.mkdir(parents=True, exist_ok=True)
        samples = self.out / variant / "samples"
        samples.mkdir(exist_ok=True)
        if not (run / "samples").is_symlink():
            (run / "samples").symlink_to("../samples")
        self.call("offline", "-case", *self.case, *self.variants[variant], "-out", run, *options,
                  *self.options)
        self.call("verify", "-out", run, "-verify_stability", "yes" if stability else "no")
        return run

    def run_all(self, jobs):
        """Every run directory by its key (variant, ...), from the arguments of run behind the
        variant: one run of each variant first, for the samples, then two at a time."""
        first = {key[0]: key for key in reversed(jobs)}
        runs = {key: self.run(key[0], *jobs[key]) for key in first.values()}
        with ThreadPoolExecutor(2) as pool:
            started = {key: pool.submit(self.run, key[0], *job) for key, job in jobs.items()}
            for key, future in started.items():
                runs[key] = future.result()
                if len(runs) % 10 == 0:
                    print(f"{len(runs)} of {len(jobs)} runs", flush=True)
        return runs

    def bench(self, run):
        """Rows of rbvi bench on a run by method and what they include, made unless there."""
        path = run / "bench" / "table.csv"
        if not path.is_file():
            self.call("bench", "-out", run)
        with open(path, newline="") as file:
            return {(row["method"], row["includes"]): row for row in csv.DictReader(file)}


def pair_options(pair):
    """N and R as given, whatever the errors."""
    return ["-pod_tolerance", "0", "-pod_max_size", str(pair[0]), "-cone_type", "mcpg",
            "-cone_tolerance", "0", "-cone_max_size", str(pair[1])]


def rows_of(path):
    with open(path, newline="") as file:
        return [{key: value if key in ("model", "operator") else float(value)
                 for key, value in row.items()}
                for row in csv.DictReader(file)]


def summary(run):
    """The row of the whole model in verify/summary.csv."""
    return rows_of(run / "verify" / "summary.csv")[0]


def table(run, name):
    return np.atleast_1d(np.genfromtxt(run / "verify" / name, delimiter=",", names=True))


def stored(run, name):
    """A number or an array of the model."""
    with h5py.File(run / "model.h5", "r") as model:
        return np.asarray(model[name][()])


def history(run, name):
    return stored(run, "histories/values/" + name).ravel()


def separation_errors(run, operator):
    """Errors of an interpolated operator with 0, 1, ... terms: training set, validation set."""
    rows = [row for row in rows_of(run / "verify" / "eim.csv") if row["operator"] == operator]
    return tuple(np.array([row[name] for row in rows])
                 for name in ("training_error", "validation_error"))


def first_at(values, tolerance):
    """Index of the first value at or below the tolerance, as text."""
    below = np.flatnonzero(np.asarray(values) <= tolerance)
    return str(below[0]) if len(below) else "-"


def stage_seconds(run):
    with h5py.File(run / "model.h5", "r") as model:
        names = [name.decode() if isinstance(name, bytes) else name
                 for name in model["stages/names"][()]]
        return dict(zip(names, model["stages/seconds"][()].ravel()))


def short(value):
    if not np.isfinite(value):
        return "no answer"
    return f"{value:.1e}".replace("e-0", "e-").replace("e+0", "e+")


def markdown(title, header, rows):
    lines = [f"### {title}", "", "| " + " | ".join(header) + " |",
             "|" + "|".join(["---"] * len(header)) + "|"]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def enrichment_costs(title, names, runs, keys, queries):
    """Seconds offline (snapshots by their own solve times), ms of all validation queries, and the
    number of queries from which the dearer offline stage pays, one row per key."""
    rows = []
    for key in keys:
        seconds, query = {}, {}
        for enrichment in ("online", "offline"):
            run = runs[(*key, enrichment)]
            stages = stage_seconds(run)
            stages.pop("snapshots", None)
            solves = np.genfromtxt(run / "samples.csv", delimiter=",", names=True)["seconds"]
            seconds[enrichment] = sum(stages.values()) + solves.sum()
            query[enrichment] = summary(run)["seconds"]
        more, less = (seconds["offline"] - seconds["online"], query["online"] - query["offline"])
        threshold = "-" if less <= 0 else max(0, int(np.ceil(more / less)))
        rows.append([*names(key)] +
                    [f"{seconds[e]:.2f}" for e in ("online", "offline")] +
                    [f"{1e3 * queries * query[e]:.1f}" for e in ("online", "offline")] +
                    [threshold])
    return markdown(title, ["variant", "(N, R)", "offline, on", "offline, off",
                            f"{queries} queries, on", f"{queries} queries, off",
                            "benefit threshold"], rows)


def study_main(documentation, case, variants, work):
    """study.py BIN OUT [OPTION...]. `work` makes the tables of a study, and a function that draws
    its figures into a folder. Returns the exit status."""
    arguments = sys.argv[1:]
    if len(arguments) < 2 or arguments[0].startswith("-"):
        print(documentation, file=sys.stderr)
        return 2
    study = Study(case, variants, *arguments)
    tables, draw = work(study)
    (study.out / "tables.md").write_text("\n".join(tables))
    print((study.out / "tables.md").read_text())
    draw(study.out / "figures")
    return 0
