#!/usr/bin/env python3
"""solids.py BIN OUT: a solid from its geometry to a model, at 1 and 2 ranks, and what is asked of it.

A coarse half-ball with friction and four free parameters: the model answers at points that it has not
seen as full solves do, forces and all; two ranks make the same one; the files for ParaView have the
fields of bodies and surfaces in space. Bounds and indicators are the errors of a model of few functions. The case that rbvi new writes of a geometry has no defect.
"""

import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

CASES = Path(__file__).resolve().parents[2] / "cases"
BLOCK = ["-case", Path(__file__).parent / "solid_block/case.yaml"]
CASE = ["-case", CASES / "rigid_ball/case.yaml", "-set", "mesh.set.size=2"]
FREE = ["-parameters", "radius,indentation,offset_x,shear"]
UNSEEN = ("0.83,0.07,-0.04,0.02", "1.21,0.045,0.08,0.005")
BENT = ["-parameters", "indentation,offset_x,shear"]
ACCURATE = 1e-6  # of each output; measured at 5 random points: 2e-7 at most
SHARP = 2  # of a bound over the error; 1 where the law tells it, else 1.6 at most


def called(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


OUTPUTS = ("energy", "normal_force", "tangential_force", "force_x", "force_y", "force_z", "peak_pressure")


def numbers(text, names=OUTPUTS):
    """These outputs of one answer."""
    found = {}
    for line in text.splitlines():
        for name in names:
            if line.startswith(name + " "):
                found[name] = float(line[len(name):].split()[0])
    return found


def compare(one, other, tolerance, what):
    if set(one) != set(other) or not set(OUTPUTS) <= set(one):
        sys.exit(f"{what}: outputs {sorted(one)} and {sorted(other)}")
    scale = abs(one["normal_force"])
    for name, value in one.items():
        size = scale if name.startswith("force") or name == "stuck" else abs(value)
        if not abs(value - other[name]) <= tolerance * size:
            sys.exit(f"{what}: {name} is {other[name]}, not {value}")


def bounds(tool, out, kind):
    """verify fails where a bound is below the error; what it says is sharp."""
    said = called(tool, "verify", "-out", out)
    for line in said.splitlines():
        if line.startswith(f"{kind} of u: "):
            least, largest = (float(word) for word in (line.split()[3], line.split()[5]))
            if not 1 - 1e-3 <= least <= largest <= SHARP:
                sys.exit(f"{out.name}: {line}")
            return
    sys.exit(f"{out.name}: no {kind} of u in\n{said}")


def bent_ball(folder):
    """The half-ball whose flat side is bent, which no rigid motion carries: a load that is an exact sum."""
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(CASES / "rigid_ball/half_ball.geo", folder)
    text = (CASES / "rigid_ball/case.yaml").read_text(encoding="utf-8")
    rigid, bent = "ux: shear, uy: 0, uz: -indentation", "ux: shear*(1 + x/1), uy: 0.5*shear*y/1, uz: -indentation*(1 + 0.3*x)"
    if rigid not in text:
        sys.exit("the flat side of rigid_ball is imposed in other words")
    (folder / "case.yaml").write_text(text.replace(rigid, bent), encoding="utf-8")
    return ["-case", folder / "case.yaml", *CASE[2:]]


def modes_are_bounded(tool, run, case, free, friction, kind):
    """Of modes alone, 3e-2 to 3e-1 off."""
    called(tool, "offline", *case, *free, "-friction", friction, "-train", "random:8:1", "-valid", "random:2:2",
           "-response_tolerance", "0", "-certify", "-out", run)
    bounds(tool, run, kind)


def energy_is_bounded(tool, bent, folder):
    """Without friction verify compares high-fidelity energies with the interval that each answer tells."""
    case = Path(bent[1])
    text, friction = case.read_text(encoding="utf-8"), "    friction: {coulomb: friction}\n"
    if friction not in text:
        sys.exit("the friction of rigid_ball is given in other words")
    smooth = case.with_name("smooth.yaml")
    smooth.write_text(text.replace(friction, ""), encoding="utf-8")
    called(tool, "offline", "-case", smooth, *bent[2:], *BENT, "-train", "random:8:1", "-valid", "random:2:2",
           "-response_tolerance", "0", "-certify", "-out", folder)
    said = called(tool, "verify", "-out", folder)
    width = re.search(r"Intervals of energy: at most (\S+) of the largest", said)
    if not width or not float(width.group(1)) <= 1e-10:
        sys.exit(f"{folder.name}: intervals of the energy\n{said}")


def main(programs, out):
    tool, online = programs / "rbvi", programs / "rbvi-online"
    shutil.rmtree(out, ignore_errors=True)
    for ranks in (1, 2):
        called("mpirun", "-n", ranks, tool, "offline", *CASE, *FREE, "-train", "random:60:1", "-valid",
               "random:2:2", "-out", out / f"np{ranks}")
    called(tool, "verify", "-out", out / "np2")
    bent = bent_ball(out / "bent")
    with ThreadPoolExecutor(2) as pool:
        runs = [pool.submit(energy_is_bounded, tool, bent, out / "smooth")]
        for friction, kind in ((0, "Bounds"), (0.2, "Indicators")):
            for name, case, free in (("modes", CASE, FREE), ("bent", bent, BENT)):
                runs.append(pool.submit(modes_are_bounded, tool, out / f"{name}_{friction}", case, free, friction, kind))
        for run in runs:
            run.result()
    for mu in UNSEEN:
        full = numbers(called(tool, "solve", *CASE, *FREE, "-mu", mu))
        one, two = (numbers(called(online, out / f"np{ranks}/model.h5", "--mu", mu)) for ranks in (1, 2))
        compare(full, two, ACCURATE, f"reduced at {mu}")
        compare(one, two, 1e-8, f"one and two ranks at {mu}")
    # Outputs of the block's own, over its foot, its body and contact.
    called(tool, "offline", *BLOCK, "-out", out / "block")
    names = (*OUTPUTS, "stuck", "peak", "mean stress", "turn", "tilt")
    compare(numbers(called(tool, "solve", *BLOCK, "-mu", "0.013,0.004"), names),
            numbers(called(online, out / "block/model.h5", "--mu", "0.013,0.004"), names), ACCURATE, "the block")
    called(online, out / "np2/model.h5", "--mu", UNSEEN[0], "--vtu", out / "u.vtu", "--contact",
           out / "contact.csv")
    for name, fields in (("u", ("von_mises", "sigma_xz")), ("u_contact", ("pressure", "tangential_stress"))):
        text = (out / f"{name}.vtu").read_text(encoding="utf-8")
        for field in fields:
            if f'Name="{field}"' not in text:
                sys.exit(f"{name}.vtu has no field {field}")
    called(tool, "new", out / "own", "-mesh", Path(__file__).parent / "solid_block/block.geo")
    if "no defect was found" not in called(tool, "check", out / "own"):
        sys.exit("the case that rbvi new writes of a geometry in space has defects")
    header = (out / "contact.csv").read_text(encoding="utf-8").splitlines()[0]
    for column in ("z", "pressure", "tangential_stress_z", "slip_x"):
        if column not in header.split(","):
            sys.exit(f"contact.csv has no column {column}")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
