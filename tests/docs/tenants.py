#!/usr/bin/env python3
"""tenants.py ROOT: the files that src/README.md lists for something new are those of one that is there."""

import re
import sys
from pathlib import Path


def rows(page):
    section = page.split("## What something new touches")[1].split("\n## ")[0]
    for line in section.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) == 4 and "](" in cells[3]:
            yield cells[0], re.findall(r"`([^`]+)`", cells[2]), re.findall(r"\]\(([^)]+)\)", cells[3])


def main(root):
    code = {path: path.read_text(encoding="utf-8")
            for folder in ("src", "include") for path in (root / folder).rglob("*.[ch]pp")}
    wrong, kinds = [], 0
    for kind, patterns, links in rows((root / "src/README.md").read_text(encoding="utf-8")):
        kinds += 1
        listed = {(root / "src" / link).resolve() for link in links}
        found = {path for path, text in code.items() if any(pattern in text for pattern in patterns)}
        wrong += [f"{kind}: {path.relative_to(root)} has it and is not listed" for path in sorted(found - listed)]
        wrong += [f"{kind}: {path.relative_to(root)} is listed and has it not" for path in sorted(listed - found)]
    if kinds < 3:
        wrong.append("src/README.md has no table of what something new touches")
    print("\n".join(wrong) or f"the files of {kinds} kinds are those that are listed")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
