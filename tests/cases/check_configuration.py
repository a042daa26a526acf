#!/usr/bin/env python3
"""check_configuration.py RBVI ROOT CASE...: cases/configuration.py draws the cases of ROOT/cases.

What a case has in contact, imposes and loads is named in the picture, no name covers another one,
and the committed picture is there and small. Skipped (77) without PyYAML.
"""

import subprocess
import sys
import tempfile
from itertools import combinations
from pathlib import Path

try:
    import yaml
except ImportError:
    sys.exit(77)

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "docs"))

from small_runs import COARSE

LARGEST = 120_000  # bytes


def drawn(configuration, rbvi, folder, case):
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "u.vtu"
        subprocess.run([rbvi, "check", str(folder), "-vtu", str(path), *COARSE.get(folder.name, [])], check=True,
                       stdout=subprocess.DEVNULL)
        configuration.use_declared(case.get("units"))
        bodies = configuration.read_bodies(path)
        return bodies, configuration.figure_of(bodies, case)


def expected(bodies, case):
    """Names of contacts, and of conditions and loads on boundaries that the mesh has."""
    names = set(case["contact"])
    for kind in ("imposed", "loads"):
        names |= {name for name, what in case.get(kind, {}).items()
                  if "force" not in what and bodies.boundary(what["at"]) is not None}
    return names


def wrong_with_solid(solid, figure, case, picture):
    """Each of its conditions has a line in the legend, each of its surfaces faces."""
    (legend,) = figure.legends
    lines = [text.get_text().replace("\n", " ") for text in legend.get_texts()]
    names = [*case["contact"], *case.get("imposed", {}), *case.get("loads", {})]
    wrong = [f"'{name}' is not in the legend" for name in names if sum(f"{name}: " in line for line in lines) != 1]
    if any(len(solid.groups[name]) == 0 for name in solid.groups):
        wrong.append("a surface has no faces")
    return wrong + wrong_size(picture)


def wrong_size(picture):
    if picture.is_file() and picture.stat().st_size <= LARGEST:
        return []
    return [f"{picture.name} is missing or larger than {LARGEST} bytes"]


def wrong_with(bodies, figure, case, picture):
    wrong, found = [], set()
    figure.canvas.draw()
    for axis in figure.axes:
        texts = [text for text in axis.texts if text.get_text()]
        found |= {text.get_text() for text in texts}
        for one, other in combinations(texts, 2):
            if one.get_window_extent().overlaps(other.get_window_extent()):
                wrong.append(f"'{one.get_text()}' covers '{other.get_text()}'")
        if axis.get_xlabel().endswith(")") != ("units" in case):
            wrong.append(f"'{axis.get_xlabel()}' has a unit, or none, and the case declares none, or some")
    wrong += [f"'{name}' is not in the picture" for name in expected(bodies, case) - found]
    return wrong + wrong_size(picture)


def main(rbvi, root, names):
    sys.path.insert(0, str(root / "cases"))
    import configuration
    folders = [root / "cases" / name for name in names]
    status = 0
    for folder in folders:
        case = {"name": folder.name, **yaml.safe_load((folder / "case.yaml").read_text(encoding="utf-8"))}
        bodies, figure = drawn(configuration, rbvi, folder, case)
        wrong = wrong_with_solid if case["physics"] == "solid" else wrong_with
        for line in wrong(bodies, figure, case, folder / "configuration.png"):
            print(f"{folder.name}: {line}")
            status = 1
        configuration.plt.close(figure)
    with tempfile.TemporaryDirectory() as scratch:  # a case that says no name, as those of rbvi new
        subprocess.run([rbvi, "new", "block"], cwd=scratch, check=True, stdout=subprocess.DEVNULL)
        block = Path(scratch) / "block"
        for place in (block, block / "case.yaml"):
            picture = Path(scratch) / "block.png"
            status |= configuration.main([rbvi, str(place), str(picture)])
            picture.unlink()
    print(f"{len(folders)} configurations")
    return status if folders else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], Path(sys.argv[2]).resolve(), sys.argv[3:]))
