#!/usr/bin/python3
"""stress.py BIN WORK [--write] [--only models|solves|files|queries] [NAME...]: the stress table.

Every scene, formulation and reduction on small meshes, with snapshots, meshes, materials, contact, parameters,
files and processes that are as bad as they come. A row ends in `same` (the answer agrees with the undisturbed
one, or with that of another method, within the tolerance that it shows), `refused` (one line that says why, exit
status 1 or 2), or `WRONG`, which makes this program fail. So does a row that is worse than in stress.csv beside this
file: refused or not made where it was `same`, or several times as far off. NAME: part of the name of a scene.
--write: the rows go to stress.csv and stress.md, whatever they were. Without python3-yaml, h5py or matplotlib the
exit status is 77: skipped.
"""

import shutil
import sys
from pathlib import Path

try:
    import h5py  # noqa: F401
    import matplotlib  # noqa: F401
    import yaml  # noqa: F401
except ImportError:
    sys.exit(77)

import models
import processes
import queries
import solves
from lab import Lab
from scenes import scenes
from table import OUTCOMES, SECTIONS, number, put, worse


def choice_of(names):
    return lambda name: not names or any(part in name for part in names)


def by_scene(lab, section, names):
    """The rows, scene by scene."""
    chosen = choice_of(names)
    if section == "models":
        yield from (models.rows(lab, scene) for scene in scenes() if chosen(scene.name))
    elif section == "solves":
        yield from (solves.rows(lab, scene) for scene in solves.solved() if chosen(scene.name))
    elif section == "files":
        yield from (processes.rows(lab, scene) for scene in processes.SCENES if chosen(scene.name))
    else:
        asked = (scene for scene in scenes() if scene.name in queries.ASKED and chosen(scene.name))
        yield from (queries.rows(lab, scene) for scene in asked)


def main():
    words = sys.argv[1:]
    only = words[words.index("--only") + 1] if "--only" in words else None
    plain = [word for word in words if not word.startswith("--") and word != only]
    if len(plain) < 2:
        sys.exit(__doc__)
    work = Path(plain[1]).resolve()
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    lab, all_rows, fallen = Lab(plain[0], work), [], []
    for section in [only] if only else SECTIONS:
        of_section = []
        for of_scene in by_scene(lab, section, plain[2:]):
            rows = []
            for row in of_scene:
                rows.append(row)
                print(f"{row.outcome:8} {row.scene:30} {row.what:60} {number(row.deviation):8} "
                      f"{number(row.tolerance):8} {row.said}", flush=True)
            if "--write" in words:
                put(section, rows, work)
            of_section += rows
        all_rows += of_section
        if "--write" not in words:
            fallen += worse(section, of_section, choice_of(plain[2:]))
    count = {outcome: sum(row.outcome == outcome for row in all_rows) for outcome in OUTCOMES}
    print(f"{len(all_rows)} rows: " + ", ".join(f"{many} {outcome}" for outcome, many in count.items()))
    for sentence in fallen:
        print(f"worse than in stress.csv: {sentence}")
    sys.exit(1 if count["WRONG"] or fallen or not all_rows else 0)


if __name__ == "__main__":
    main()
