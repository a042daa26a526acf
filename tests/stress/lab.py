"""What the stress table needs: runs of the programs, how they end, how far answers are apart."""

import csv
import subprocess
from dataclasses import dataclass
from pathlib import Path

ENERGY, FORCES = "energy", ("normal_force", "tangential_force", "reaction")


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

    def solve(self, case, mu, *options, residual=1e-6):
        """Outputs of a high-fidelity solve, whose KKT residual is at most `residual`."""
        table = self.work / "solve.csv"
        table.unlink(missing_ok=True)
        self.answer(self.rbvi, "solve", "-case", case, "-mu", mu, "-csv", table, *options)
        answer = read_table(table)[0]
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


def judge(scene, what, work):
    """The row of `work`, a function that returns (deviation, tolerance), or raises Refused or Wrong."""
    try:
        apart, tolerance = work()
    except Refused as said:
        return Row(scene, what, "refused", said=str(said))
    except Wrong as said:
        return Row(scene, what, "WRONG", said=str(said))
    outcome = "same" if apart <= tolerance else "WRONG"
    return Row(scene, what, outcome, apart, tolerance)
