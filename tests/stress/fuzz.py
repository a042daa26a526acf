#!/usr/bin/env python3
"""Damaged case files, CSV tables and meshes: fuzz.py BIN SECONDS [SEED].

Mutates good files and gives them to both programs of the directory BIN, which may be built with
sanitizers. Every run must end with status 0, 1 or 2 within a minute, say why in one line where it is
not 0, and report nothing of a sanitizer. Damaged inputs of runs that do not are kept in the current
directory; the exit status is then 1.
"""

import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CASES = Path(__file__).resolve().parents[2] / "cases"
NUMBERS = ["nan", "inf", "-1", "0", "1e308", "-1e308", "1e-320", "4294967296", "99999999999999999999",
           "0x10", "1,2", "", "1e", "--1", "3.5"]


def block_mesh(version, binary=False):
    """The unit square in eight triangles with the boundaries of scene patch, one body."""
    n = 3
    nodes = [(i / (n - 1), 0.5 * j / (n - 1)) for j in range(n) for i in range(n)]
    at = lambda i, j: j * n + i + 1
    edges = [("contact", at(i, 0), at(i + 1, 0)) for i in range(n - 1)]
    edges += [("top", at(i, n - 1), at(i + 1, n - 1)) for i in range(n - 1)]
    edges += [("sides", at(k, j), at(k, j + 1)) for k in (0, n - 1) for j in range(n - 1)]
    cells = []
    for j in range(n - 1):
        for i in range(n - 1):
            cells += [(at(i, j), at(i + 1, j), at(i + 1, j + 1)),
                      (at(i, j), at(i + 1, j + 1), at(i, j + 1))]
    names = {"sides": 1, "top": 2, "contact": 3}
    text = f"$MeshFormat\n{version} 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n"
    text += "".join(f'1 {number} "{name}"\n' for name, number in names.items())
    text += '2 4 "body"\n$EndPhysicalNames\n'
    if version == "2.2":
        text += f"$Nodes\n{len(nodes)}\n"
        text += "".join(f"{k + 1} {x:.17g} {y:.17g} 0\n" for k, (x, y) in enumerate(nodes))
        text += f"$EndNodes\n$Elements\n{len(edges) + len(cells)}\n"
        rows = [f"1 2 {names[name]} {names[name]} {a} {b}" for name, a, b in edges]
        rows += ["2 2 4 1 " + " ".join(map(str, cell)) for cell in cells]
        text += "".join(f"{k + 1} {row}\n" for k, row in enumerate(rows)) + "$EndElements\n"
        return text.encode()
    text += "$Entities\n0 3 1 0\n"
    text += "".join(f"{number} 0 0 0 1 1 0 1 {number} 0\n" for number in names.values())
    text += "1 0 0 0 1 1 0 1 4 0\n$EndEntities\n"
    text += f"$Nodes\n1 {len(nodes)} 1 {len(nodes)}\n2 1 0 {len(nodes)}\n"
    text += "".join(f"{k + 1}\n" for k in range(len(nodes)))
    text += "".join(f"{x:.17g} {y:.17g} 0\n" for x, y in nodes)
    text += f"$EndNodes\n$Elements\n4 {len(edges) + len(cells)} 1 {len(edges) + len(cells)}\n"
    number = 0
    for name, tag in names.items():
        rows = [(a, b) for own, a, b in edges if own == name]
        text += f"1 {tag} 1 {len(rows)}\n"
        for a, b in rows:
            number += 1
            text += f"{number} {a} {b}\n"
    text += f"2 1 2 {len(cells)}\n"
    for cell in cells:
        number += 1
        text += f"{number} {cell[0]} {cell[1]} {cell[2]}\n"
    return (text + "$EndElements\n").encode()


def mutate(data, rng):
    """One to four damages."""
    data = bytearray(data)
    for _ in range(rng.randint(1, 4)):
        kind = rng.randrange(7)
        at = rng.randrange(len(data) + 1) if data else 0
        if kind == 0 and data:
            data[at % len(data)] ^= 1 << rng.randrange(8)
        elif kind == 1:
            del data[at:at + rng.randint(1, 40)]
        elif kind == 2:
            data[at:at] = rng.randbytes(rng.randint(1, 8))
        elif kind == 3:
            del data[at:]
        else:
            lines = bytes(data).split(b"\n")
            k = rng.randrange(len(lines))
            words = lines[k].split(b" ")
            if kind == 4:
                lines.insert(k, lines[rng.randrange(len(lines))])
            elif kind == 5:
                del lines[k]
            else:
                words[rng.randrange(len(words))] = rng.choice(NUMBERS).encode()
                lines[k] = b" ".join(words)
            data = bytearray(b"\n".join(lines))
    return bytes(data)


def verdict(command):
    """What is wrong with the end of this run; "" if nothing is."""
    try:
        run = subprocess.run(command, capture_output=True, timeout=60)
    except subprocess.TimeoutExpired:
        return "no end within a minute"
    error = run.stderr.decode(errors="replace")
    if "Sanitizer" in error or "runtime error" in error:
        return "a sanitizer reports"
    if run.returncode not in (0, 1, 2):
        return f"status {run.returncode}"
    said = [line for line in error.splitlines() if line.startswith("rbvi")]
    if run.returncode != 0 and len(said) != 1:
        return f"{len(said)} lines say why"
    return ""


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    binaries, seconds = Path(sys.argv[1]), float(sys.argv[2])
    rng = random.Random(int(sys.argv[3]) if len(sys.argv) == 4 else 1)
    tool, online = str(binaries / "rbvi"), str(binaries / "rbvi-online")
    os.environ.setdefault("ASAN_OPTIONS", "detect_leaks=0")
    with tempfile.TemporaryDirectory() as scratch:
        scratch = Path(scratch)
        subprocess.run([tool, "offline", "-case", str(CASES / "patch/case.yaml"), "-out",
                        str(scratch / "run")], check=True, stdout=subprocess.DEVNULL)
        model = scratch / "run/model.h5"
        table = b"indentation,energy,status\n" + b"".join(
            b"%.17g,1.5,ok\n" % (0.01 + 0.09 * k / 20) for k in range(21))
        case = ["solve", "-case", str(CASES / "patch/case.yaml"), "-bodies", "one", "-mu", "0.05"]
        seeds = [("case", path.read_bytes(), lambda f: [tool, "offline", "-plan", "-case", f])
                 for path in sorted(CASES.glob("*/*.yaml"))]
        seeds += [("csv", table, lambda f: [online, str(model), "--queries", f]),
                  ("csv", table, lambda f: [tool, "offline", "-plan", "-case",
                                            str(CASES / "patch/case.yaml"), "-train", f]),
                  ("model", model.read_bytes(), lambda f: [online, f, "--mu", "0.05"])]
        seeds += [("mesh", block_mesh(version), lambda f: [tool, *case, "-mesh", f])
                  for version in ("2.2", "4.1")] * 4
        for name, data, command in seeds:  # as they are, none is refused
            (scratch / name).write_bytes(data)
            if subprocess.run(command(str(scratch / name)), capture_output=True).returncode != 0:
                sys.exit(f"the undamaged {name} is refused")
        runs, wrong, end = 0, 0, time.monotonic() + seconds
        while time.monotonic() < end:
            name, data, command = rng.choice(seeds)
            (scratch / name).write_bytes(mutate(data, rng))
            reason = verdict(command(str(scratch / name)))
            runs += 1
            if reason:
                wrong += 1
                kept = Path(f"fuzz_{wrong}.{name}")
                kept.write_bytes((scratch / name).read_bytes())
                print(f"{kept}: {reason}: {' '.join(command(str(kept)))}", flush=True)
    print(f"{runs} runs, {wrong} wrong")
    sys.exit(1 if wrong or runs == 0 else 0)


if __name__ == "__main__":
    main()
