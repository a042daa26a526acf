#!/usr/bin/env python3
"""Random case files: random_cases.py BIN COUNT [SEED] [--keep DIR].

Each case has a random body, material, load, spring, contact, law, kinematics, formulation and outputs. It is reduced on a small
training set, verified at corners, faces and as many random parameters as `rbvi new` writes, and asked at corners and centres of
faces of its box and at other random parameters, where full solves answer too. One line a case:

    same     every output of the model within three times the error that it prints (or 1e-7 of its scale)
    loose    an output beyond that, but within 1 %
    WARNED   an output off by more than 1 %, and a line of offline, verify or the query warns
    WRONG    the same, and nothing is said
    CRASH    a program ended by a signal, or a model that offline wrote cannot be read
    refused  offline says why it makes no model, or verify why it measures none

Then how many there are of each, and full solves that were refused, by their reason. The exit status is 1 where a case is WRONG or a
CRASH, or where fewer than 95 % of the models are the same.
"""

import csv
import itertools
import math
import random
import re
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from at_once import run_program

FLOOR = "{plane: {normal: [0, -1], position: %s}}"


class Case:
    """A random case: its text, and the box of its free parameters."""

    def __init__(self, seed):
        self.draw = random.Random(seed)
        self.box = {}
        self.sections = {}
        self.contacts = {}
        self.body()
        self.material()
        self.loads()
        self.outputs()

    def free(self, name, low, high):
        self.box[name] = (low, high)
        return name

    def chance(self, share):
        return self.draw.random() < share

    def number(self, low, high):
        return f"{self.draw.uniform(low, high):.3g}"

    def body(self):
        shape = self.draw.choice(["one_block", "half_disc", "annulus", "two_blocks", "square_with_disc"])
        degree = self.draw.choice([1, 2])
        edges = f", edges: {self.draw.choice([16, 24, 32])}" if shape in ("half_disc", "annulus") else ""
        angle = ", angle: 45" if shape == "half_disc" and self.chance(0.5) else ""
        self.sections["physics"] = self.draw.choice(["plane_strain", "plane_stress"])
        self.nitsche = shape in ("one_block", "half_disc", "annulus") and self.chance(0.25)
        getattr(self, shape)()
        self.sections["mesh"] = f"{{built_in: {shape}, degree: {degree}{edges}{angle}}}"

    def friction(self, share=0.6):
        if not self.chance(share):
            return ""
        law = self.draw.choice(["coulomb", "coulomb", "tresca"])
        value = self.free("friction", 0.1, 0.6) if self.chance(0.4) else self.number(0.1, 0.5)
        bound = ", bound: contact" if law == "tresca" and self.chance(0.4) else ""
        return f", friction: {{{law}: {value}{bound}}}"

    def way(self):
        return ", formulation: nitsche" if self.nitsche else ""

    def pushed(self, boundary, depth):
        """What holds a boundary that is pushed down."""
        down = self.free("depth", 0.2 * depth, depth)
        kind = self.draw.choice(["fixed", "fixed", "shifted", "force"])
        across = self.free("shift", -0.5 * depth, 0.5 * depth) if kind == "shifted" else "0"
        if kind == "force" and not self.nitsche:
            return f"{{at: {boundary}, ux: 0, force_y: -10*{down}}}"
        return f"{{at: {boundary}, ux: {across}, uy: -{down}}}"

    def one_block(self):
        self.sections["imposed"] = {"top": self.pushed("top", 0.05)}
        against = FLOOR % 0 if self.chance(0.5) else "{level_set: 'y + 0.01 - 0.01*cos(3*x)'}"
        self.contacts["floor"] = f"{{at: contact, against: {against}{self.friction()}{self.way()}}}"
        self.region, self.side = "all", "sides"

    def half_disc(self):
        self.sections["imposed"] = {"top": self.pushed("top", 0.06)}
        kind = self.draw.choice(["plane", "disk", "disk"])
        large = ", kinematics: large" if kind == "disk" and not self.nitsche and self.chance(0.3) else ""
        across = self.free("offset", -0.1, 0.1) if kind == "disk" and self.chance(0.3) else "0"
        against = FLOOR % 1 if kind == "plane" else f"{{disk: {{center: [{across}, -2.001], radius: 1}}}}"
        self.contacts["support"] = f"{{at: contact, against: {against}{self.friction()}{large}{self.way()}}}"
        self.region, self.side = "core", "top"
        if self.chance(0.25):
            self.sections["map"] = f"{{scale: {self.free('radius', 0.8, 1.2)}}}"
            self.contacts["support"] = self.contacts["support"].replace("position: 1}", "position: radius}").replace(
                "-2.001", "-radius - 1.001")

    def annulus(self):
        x, y = self.free("hub_x", -0.02, 0.03), self.free("hub_y", -0.03, 0.02)
        self.sections["imposed"] = {"hub": f"{{at: hub, ux: {x}, uy: {y}}}"}
        for name, boundary, normal in (("lower", "bottom", -1), ("upper", "top", 1)):
            plane = f"{{plane: {{normal: [0, {normal}], position: 0.9725}}}}"
            self.contacts[name] = f"{{at: {boundary}, against: {plane}{self.friction()}{self.way()}}}"
        self.region, self.side = "all", "rim"

    def two_blocks(self):
        self.sections["map"] = "[x, 'y > 0 ? y - 0.25 : y + 0.25']"
        self.sections["imposed"] = {"top": self.pushed("top", 0.05), "base": "{at: bottom, ux: 0, uy: 0}"}
        large = ", kinematics: large" if self.chance(0.25) else ""
        law = "" if large else self.friction()
        multiplier = self.draw.choice([", multiplier: p0", ", multiplier: p1", ""])
        self.contacts["faces"] = f"{{at: slave, against: master{law}{large}{multiplier}}}"
        self.region, self.side = "upper", "sides"

    def square_with_disc(self):
        self.sections["physics"] = "membrane"
        self.sections["imposed"] = {"rim": "{at: boundary, u: 0}"}
        height = self.free("height", -0.3, 0.1)
        self.contacts["obstacle"] = f"{{at: obstacle, above: '{height} - {self.number(1, 8)}*(x^2 + y^2)'}}"
        self.region, self.side = "obstacle", "boundary"

    def material(self):
        if self.sections["physics"] == "membrane":
            return
        young = self.draw.choice(["20", "20", "stiffness", "20 * (1 + 0.35*y)", "20 * exp(grade*y)"])
        if young == "stiffness":
            self.free("stiffness", 5, 40)
        elif "grade" in young:
            self.free("grade", -0.5, 0.5)
        poisson = self.free("poisson", 0.1, 0.4) if self.chance(0.25) else self.number(0, 0.45)
        heat = ""
        if not self.nitsche and self.chance(0.15):
            heat = f", expansion: 1e-3, temperature: {self.free('heat', 0, 10)}"
        self.sections["materials"] = {"rubber": f"{{at: all, E: '{young}', nu: {poisson}{heat}}}"}

    def loads(self):
        if self.sections["physics"] == "membrane":
            self.sections["loads"] = {"weight": f"{{at: all, force: -{self.free('weight', 10, 30)}}}"}
        elif self.chance(0.4):
            self.sections["loads"] = {"weight": f"{{at: all, force: [0, -{self.free('weight', 0, 0.5)}]}}"}
        blocks = self.sections["mesh"].startswith("{built_in: one_block")
        if blocks and not self.nitsche and "force_y" not in self.sections["imposed"]["top"] and self.chance(0.2):
            self.sections["springs"] = {"side": "{at: sides, stiffness: 2, direction: [1, 0]}"}

    def outputs(self):
        own = {"mean deflection": f"{{mean: {'u' if self.sections['physics'] == 'membrane' else 'uy'}, in: {self.region}}}",
               }
        if self.sections["physics"] != "membrane":
            own["pressed"], own["lever"] = "{integral: pressure}", "{integral: pressure*x}"
            own["store"] = f"{{integral: strain_energy, in: {self.region}}}"
        self.sections["outputs"] = own

    def text(self):
        lines = ["rbvi: 1", "parameters:"]
        lines += [f"  {name}: {{range: [{low:.6g}, {high:.6g}], default: {(low + high) / 2:.6g}}}"
                  for name, (low, high) in self.box.items()]
        for name, value in {**self.sections, "contact": self.contacts}.items():
            if isinstance(value, dict):
                lines += [f"{name}:", *(f"  {key}: {entry}" for key, entry in value.items())]
            else:
                lines.append(f"{name}: {value}")
        count = 20 * len(self.box)
        lines += [f"train: 'corners + random:{count}:1'", "validate: random:20:2"]
        return "\n".join(lines) + "\n"

    def points(self):
        corners = [dict(zip(self.box, at)) for at in itertools.product(*self.box.values())]
        middle = {name: sum(ends) / 2 for name, ends in self.box.items()}
        faces = [{**middle, name: end} for name, ends in self.box.items() for end in ends]
        inside = [{name: self.draw.uniform(*ends) for name, ends in self.box.items()} for _ in range(4)]
        return self.draw.sample(corners, min(3, len(corners))) + self.draw.sample(faces, min(2, len(faces))) + inside


def reason(text):
    """The last line of an error, without its numbers."""
    lines = [line for line in text.splitlines() if line.startswith("rbvi")] or text.splitlines() or ["nothing"]
    return re.sub(r"[-+]?\d[\d.e+-]*", "#", lines[-1].split("rbvi:")[-1].strip())[:150]


class Run:
    """A case that was reduced, and what its answers are beside full solves."""

    def __init__(self, binaries, seed, work):
        self.binaries, self.work, self.refusals = binaries, work, Counter()
        self.case, self.solves, self.worst = Case(seed), 0, ("", 0.0)
        work.mkdir(parents=True, exist_ok=True)
        self.file = work / "case.yaml"
        self.file.write_text(self.case.text(), encoding="utf-8")

    def program(self, name, *arguments):
        return run_program([self.binaries / name, *arguments])

    def verdict(self):
        run = self.work / "run"
        made = self.program("rbvi", "offline", "-case", self.file, "-out", run)
        if made.returncode < 0 or made.returncode > 2 or "SEGV" in made.stderr:
            return "CRASH", f"offline: {made.returncode}"
        for line in set(re.findall(r"failed at .*", made.stdout + made.stderr)):
            self.refusals[reason(line.partition(": ")[2] or line)] += 1
        if not (run / "model.h5").exists():
            return "refused", reason(made.stderr or made.stdout)
        checked = self.program("rbvi", "verify", "-out", run)
        if "samples failed, more than" in checked.stderr:
            return "refused", "verify: " + reason(checked.stderr)
        if checked.returncode and "measured over the others" not in checked.stderr:
            return "CRASH", "verify: " + reason(checked.stderr)
        points = self.case.points()
        table = self.work / "points.csv"
        with open(table, "w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows([list(self.case.box), *([repr(v) for v in at.values()] for at in points)])
        asked = self.program("rbvi-online", run / "model.h5", "--queries", table, "--out", self.work / "online.csv")
        if not (self.work / "online.csv").exists():
            return "CRASH", "query: " + reason(asked.stderr)
        said = "arning" in made.stdout + made.stderr + checked.stdout + checked.stderr + asked.stdout + asked.stderr
        with open(self.work / "online.csv", encoding="utf-8", newline="") as file:
            return self.compare(points, list(csv.DictReader(file)), said)

    def compare(self, points, reduced, said):
        full = []
        for at in points:
            self.solves += 1
            mu = ",".join(f"{name}={value!r}" for name, value in at.items())
            path = self.work / "full.csv"
            path.unlink(missing_ok=True)
            done = self.program("rbvi", "solve", "-case", self.file, "-mu", mu, "-csv", path)
            if done.returncode:
                self.refusals[reason(done.stderr)] += 1
                full.append(None)
            else:
                with open(path, encoding="utf-8", newline="") as file:
                    full.append(next(csv.DictReader(file)))
        within, rough = True, 0.0
        errors = [name for name in reduced[0] if name.endswith("_error") and name[:-6] in reduced[0]]
        for error in errors:
            name = error[:-6]
            pairs = [(float(a[name]), float(b[name]), float(a[error] or 0)) for a, b in zip(reduced, full)
                     if b and a.get("status", "ok") in ("ok", "", "0", "done") and a[name] and b.get(name)]
            scale = max((abs(b) for _, b, _ in pairs), default=0)
            for a, b, printed in pairs:
                off = abs(a - b)
                within = within and not off > max(3 * printed, 1e-7 * scale + 1e-10)
                if scale > 1e-9 and off > rough * scale and not off <= 3 * printed:
                    rough, self.worst = off / scale, (name, off / scale)
        if within:
            return "same", ""
        kind = "loose" if rough <= 1e-2 else "WARNED" if said else "WRONG"
        return kind, f"{self.worst[0]} {self.worst[1]:.1e}"


def one(binaries, seed, work):
    run = Run(binaries, seed, work / str(seed))
    kind, why = run.verdict()
    return seed, kind, why, run


def main(arguments):
    keep = Path(arguments.pop(arguments.index("--keep") + 1)) if "--keep" in arguments else None
    arguments = [argument for argument in arguments if argument != "--keep"]
    binaries, count = Path(arguments[0]).resolve(), int(arguments[1])
    first = int(arguments[2]) if len(arguments) > 2 else 1
    kinds, refusals, solves = Counter(), Counter(), 0
    with tempfile.TemporaryDirectory() as temporary, ThreadPoolExecutor(2) as pool:
        work = keep or Path(temporary)
        for seed, kind, why, run in pool.map(lambda seed: one(binaries, seed, work), range(first, first + count)):
            kinds[kind] += 1
            refusals.update(run.refusals)
            solves += run.solves
            if kind != "same":
                print(f"{seed}: {kind} {why}", flush=True)
    print(", ".join(f"{number} {kind}" for kind, number in kinds.most_common()))
    for why, number in refusals.most_common():
        print(f"  {number} full solves: {why}")
    models = sum(kinds.values()) - kinds["refused"]
    return int(kinds["WRONG"] + kinds["CRASH"] > 0 or kinds["same"] < 0.95 * models)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
