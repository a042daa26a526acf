"""What the stress table needs: runs of the programs, how they end, how far answers are apart."""

import csv
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "cases"))
from figure_tools import beside, read_grid

ENERGY, FORCES = "energy", ("normal_force", "tangential_force", "reaction")
PEAKS, WIDTHS = ("peak_pressure", "centre_pressure"), ("contact_measure", "stick_half_width")
MULTIPLIERS = ("pressure", "tangential_stress")
SHAPE = ": u, multipliers, peaks, widths"  # behind the name of the row that compares them
ROUND_OFF = 1e-13  # of the extent of a body: what a displacement that is zero may be


@dataclass
class Row:
    scene: str
    what: str
    outcome: str  # same, refused, WRONG
    deviation: float | None = None
    tolerance: float | None = None
    said: str = ""


@dataclass
class Ended:
    command: str
    status: int | None  # None: killed after the time that it was given
    out: str
    err: str


class Wrong(Exception):
    """What a row is WRONG for."""


class Refused(Exception):
    """The sentence that a program refused with."""


class Lab:
    """The programs, and the folder in which they work."""

    def __init__(self, binaries, work):
        binaries = Path(binaries).resolve()
        self.rbvi, self.online = binaries / "rbvi", binaries / "rbvi-online"
        self.work = Path(work).resolve()

    def run(self, *command, seconds=300, **how):
        command = [str(word) for word in command]
        try:
            done = subprocess.run(command, capture_output=True, timeout=seconds, check=False,
                                  cwd=self.work, errors="replace", text=True, **how)
            return Ended(" ".join(command), done.returncode, done.stdout, done.stderr)
        except subprocess.TimeoutExpired:
            return Ended(" ".join(command), None, "", "")

    def answer(self, *command, **how):
        """A run that must succeed or refuse in one line."""
        ended = self.run(*command, **how)
        if ended.status == 0:
            return ended
        raise Refused(refusal(ended))

    def solve(self, case, mu, *options, residual=1e-6, ranks=1):
        """Outputs of a high-fidelity solve, whose KKT residual is at most `residual`, and its fields."""
        table, picture = self.work / "solve.csv", self.work / "solve.vtu"
        table.unlink(missing_ok=True)
        launched = ("mpirun", "-n", str(ranks)) if ranks > 1 else ()
        self.answer(*launched, self.rbvi, "solve", "-case", case, "-mu", mu, "-csv", table, "-vtu", picture, *options)
        answer = {**read_table(table)[0], **fields(picture)}
        check_residual(answer, residual)
        return answer


def refusal(ended):
    """The one line of a run that refused; anything else is wrong."""
    if ended.status is None:
        raise Wrong(f"no end: {ended.command}")
    lines = [line for line in ended.err.splitlines() if line.strip() and not line.startswith("warning: ")]
    if ended.status not in (1, 2):
        raise Wrong(f"status {ended.status}: {ended.command}: {' '.join(lines)[-200:]}")
    if len(lines) != 1:
        raise Wrong(f"{len(lines)} lines say why: {ended.command}: {' / '.join(lines)[:400]}")
    return lines[0].partition(": ")[2]


def read_table(path):
    """Rows of a table, numbers where they are numbers."""
    def value(text):
        try:
            return float(text)
        except ValueError:
            return text
    with open(path, encoding="utf-8", newline="") as file:
        return [{name: value(text) for name, text in row.items()} for row in csv.DictReader(file)]


def fields(picture):
    """u of the file of an answer, and the multipliers of the files of its contacts beside it."""
    grid = read_grid(picture)
    floor = ROUND_OFF * np.ptp(grid.points, axis=0).max()
    found = {"u": np.where(abs(grid.of_nodes["u"]) < floor, 0, grid.of_nodes["u"])}
    files = [beside(picture, "_contact")]
    if not files[0].exists():
        files = sorted(picture.parent.glob(f"{picture.stem}_contact_*.vtu"))
    for file in files:
        grid = read_grid(file)
        found |= {name + file.stem.removeprefix(picture.stem): grid.of_nodes[name] for name in MULTIPLIERS
                  if name in grid.of_nodes}
        file.unlink()
    return found


def check_residual(answer, largest=1e-6):
    if not answer.get("kkt_residual", 0) <= largest:
        raise Wrong(f"an answer with the residual {answer['kkt_residual']:.1e}")


def deviation(answers, references, scale=None, of=(ENERGY, *FORCES), residual=1e-6):
    """Largest difference of energies and forces, relative to the largest of all references."""
    scale = scale or sizes(references)
    worst = 0.0
    for answer, reference in zip(answers, references, strict=True):
        check_residual(answer, residual)
        for name in of:
            if name not in reference:
                continue
            size = scale[name]
            apart = abs(answer[name] - reference[name])
            worst = max(worst, apart / size if size > 0 else (0.0 if apart == 0 else float("inf")))
            if not apart >= 0:
                raise Wrong(f"{name} is {answer[name]}")
    return worst


def sizes(references):
    force = max(abs(row[name]) for row in references for name in FORCES if name in row)
    return {ENERGY: max(abs(row[ENERGY]) for row in references), **{name: force for name in FORCES}}


def shape_deviation(answers, references, of=None, steps=()):
    """Largest difference of u, of multipliers, of peaks and of widths, each relative to its largest value of all
    references, and which of them it is of. `of`: of these alone. `steps`: by how much widths may be off, that
    count nodes."""
    kinds = [("u", "u"), *(("multipliers", name) for name in references[0] if name.startswith(MULTIPLIERS)),
             *(("peaks", name) for name in PEAKS), *(("widths", name) for name in WIDTHS)]
    size, apart, worst = {}, {}, (0.0, "")
    for kind, name in kinds:
        if name not in references[0] or (of and kind not in of):
            continue
        for answer, reference in zip(answers, references, strict=True):
            if isinstance(reference.get(name, ""), str):
                continue  # an empty cell
            size[kind] = max(size.get(kind, 0), np.max(np.abs(reference[name]), initial=0))
            if isinstance(answer.get(name, ""), str):
                continue
            off = np.max(np.abs(answer[name] - reference[name]), initial=0)
            apart[name] = kind, np.maximum(apart.get(name, (kind, 0))[1],
                                           np.maximum(off - dict(steps).get(name, 0), 0))
    for name, (kind, most) in apart.items():
        share = most / size[kind] if size[kind] > 0 else (0.0 if most == 0 else float("inf"))
        if not share <= worst[0]:
            worst = share, name
    return worst


def judge(scene, what, work):
    """The rows of `work`, a function that returns (deviation, tolerance) of energies and forces, and behind them, if
    it has looked at them, the same of the shape; or raises Refused or Wrong."""
    try:
        apart, tolerance, *shape = work()
    except Refused as said:
        return [Row(scene, what, "refused", said=str(said))]
    except Wrong as said:
        return [Row(scene, what, "WRONG", said=str(said))]
    rows = [Row(scene, what, "same" if apart <= tolerance else "WRONG", apart, tolerance)]
    if shape:
        (apart, name), tolerance = shape
        rows.append(Row(scene, what + SHAPE, "same" if apart <= tolerance else "WRONG", apart, tolerance,
                        "" if apart <= tolerance else name))
    return rows
