#!/usr/bin/env python3
"""readme_lists_formulas.py ROOT: the index of src/README.md has every numbered formula of the code.

A number in parentheses in a comment or in a text of src, include/rbvi and cases, "(2.27)", "(3.12a,
3.17)", "(B.32)", stands in the index, and every file that the index names for a number holds it. Lines
"Niakh (2022): ..." are those of cases/THESIS.md, which thesis_map.py compares.
"""

import re
import sys
from pathlib import Path

NUMBER = r"(?:B|[2-4])\.[1-9][0-9]*[a-z]?"
GROUP = re.compile(rf"\(({NUMBER}(?:, {NUMBER})*)\)")
NO_FORMULAS = re.compile(r"Gmsh|Niakh \(2022\): ")  # versions of its files; lines of the map


def numbers_in(text):
    """Without the letters of their parts."""
    found = set()
    for line in text.splitlines():
        if NO_FORMULAS.search(line) or not re.search(r'//|"', line):
            continue
        for group in GROUP.findall(line[re.search(r'//|"', line).start():]):
            found.update(number.rstrip("abcdefgh") for number in group.split(", "))
    return found


def index_of(root):
    """number -> files, from lines "| (2.21), (2.22) | what | [file](path), ... |"."""
    section = (root / "src/README.md").read_text(encoding="utf-8").split("\n## Formulas\n")[1]
    index = {}
    for row in re.findall(r"^\| (\(.*) \|$", section.split("\n## ")[0], re.MULTILINE):
        cells = row.split(" | ")
        files = [(root / "src" / path).resolve()
                 for path in re.findall(r"\]\(([^)]+)\)", cells[-1])]
        for number in re.findall(r"\((B\.\d+|\d\.\d+)\)", cells[0]):
            index.setdefault(number, []).extend(files)
    return index


def main(root):
    root = root.resolve()
    index, wrong, total = index_of(root), [], set()
    for path in sorted(path for folder in ("src", "include/rbvi", "cases")
                       for path in (root / folder).rglob("*") if path.suffix in (".cpp", ".hpp")):
        numbers = numbers_in(path.read_text(encoding="utf-8"))
        total |= numbers
        wrong += [f"src/README.md: no ({number}), which {path.relative_to(root)} has"
                  for number in sorted(numbers - index.keys())]
    for number, files in index.items():
        for path in files:
            text = path.read_text(encoding="utf-8") if path.is_file() else ""
            if number not in numbers_in(text.replace("#", "//") if path.suffix == ".yaml" else text):
                wrong.append(f"src/README.md: ({number}) does not stand in {path}")
    print("\n".join(wrong) or f"{len(total)} numbered formulas are in the index")
    return 1 if wrong or not total else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
