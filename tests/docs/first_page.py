#!/usr/bin/env python3
"""first_page.py ROOT [BIN SCRATCH]: the first lines of README.md are a picture, a case, two commands and
what they print.

With the programs in BIN the case is written as the file that the page names, both commands are run in
SCRATCH, and what the page prints below each must stand in its output, as tutorial.py compares it. Of lines
that begin with a blank, those of the table of stages, only the words are compared: they hold times.
"""

import os
import re
import shutil
import sys
from pathlib import Path

from tutorial import NUMBER, blocks_of, is_like, run

FIRST, COMMANDS = 60, 2


def is_like_but_times(printed, shown):
    if not shown.startswith(" "):
        return is_like(printed, shown)
    words = [NUMBER.sub("#", line).split() for line in (shown, printed)]
    return words[0] == words[1][:len(words[0])]


def defects(root, lines):
    text = "\n".join(lines) + "\n"
    pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", text)
    if not pictures or not all((root / picture).is_file() for picture in pictures):
        yield "no picture that is there"
    blocks = blocks_of(text)
    cases = [block for kind, block in blocks if kind == "yaml"]
    if len(cases) != 1 or "rbvi: 1" not in cases[0]:
        yield "not one case file"
    shells = [block for kind, block in blocks if kind == "" and any(line.startswith("$ ") for line in block)]
    printed = [line.startswith("$ ") for block in shells for line in block]
    if sum(printed) != COMMANDS:
        yield f"{sum(printed)} commands in place of {COMMANDS}"
    if any(a and b for a, b in zip(printed, printed[1:] + [True])):
        yield "a command without its output"


def main(root, *places):
    page = (root / "README.md").read_text(encoding="utf-8")
    lines = page.splitlines()[:FIRST]
    wrong = list(defects(root, lines))
    if wrong:
        print("\n".join(f"the first {FIRST} lines of README.md: {one}" for one in wrong))
        return 1
    print(f"the first {FIRST} lines of README.md are a picture, a case, {COMMANDS} commands and their output")
    if not places:
        return 0
    programs, scratch = Path(places[0]).resolve(), Path(places[1])
    shutil.rmtree(scratch, ignore_errors=True)
    text = "\n".join(lines) + "\n"
    case = scratch / re.search(r"`([\w/]+/case\.yaml)`", text).group(1)
    case.parent.mkdir(parents=True)
    environment = dict(os.environ, PATH=f"{programs}:{os.environ['PATH']}")
    for kind, block in blocks_of(text):
        if kind == "yaml":
            case.write_text("\n".join(block) + "\n", encoding="utf-8")
        elif run(block, scratch, environment, is_like_but_times) is None:
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve(), *sys.argv[2:]))
