#!/usr/bin/env python3
"""thesis_map.py ROOT: cases/THESIS.md has a row for every number of Niakh (2022).

The numbers are those of thesis_numbers.txt. Each stands in the first cell of a row, itself or within
a range ("(2.31)-(2.33)", "Figures 2.5 to 2.7"); a letter, (3.12a), belongs to its number. The last
cell of such a row begins with how the project has it, and the row links to a file unless that is "not
there". Each number of the row then stands in one of these files, itself or within a range; a picture's
in a page that shows it; the perspectives have no names elsewhere. Neither that page nor cases/ERRATA.md
names a number that the list does not have, and every file that they link to is there.
"""

import re
import sys
from collections import Counter
from pathlib import Path

HOW = ("as printed", "beyond", "different", "not there")
EQUATION = r"\(([1-4AB])\.(\d+)[a-z]?\)"
EQUATIONS = re.compile(rf"{EQUATION}(?:(?:-| to ){EQUATION})?")
KINDS = "Algorithm|Figure|Table|Theorem|Proposition|Lemma|Remark|Perspective"
NUMBER = r"(?:\d+(?:\.\d+)*)"
NAMED = re.compile(rf"\b({KINDS})s? ({NUMBER}[a-z]?(?:(?:, | and | to |-){NUMBER}[a-z]?)*)")
LINK = re.compile(r"\]\(([^)\s]+)\)")


def between(first, last):
    """Numbers from a first to a last one, which differ in their last part alone."""
    *chapter, begin = first.split(".")
    *other, end = last.split(".")
    if chapter != other or int(end) <= int(begin):
        return [first, f"{last} (no range from {first})"]
    return [".".join([*chapter, str(k)]) for k in range(int(begin), int(end) + 1)]


def numbers_in(text):
    """All that a text names, ranges spelt out."""
    found = []
    for chapter, number, last_chapter, last in EQUATIONS.findall(text):
        first = f"{chapter}.{number}"
        numbers = between(first, f"{last_chapter}.{last}") if last else [first]
        found += [f"({number})" for number in numbers]
    for kind, listed in NAMED.findall(text):
        for part in re.split(r", | and ", listed):
            ends = [end.rstrip("abcdefghi") for end in re.split(r" to |-", part)]
            numbers = between(*ends) if len(ends) == 2 else ends
            found += [f"{kind} {number}" for number in numbers]
    return found


def rows_of(page):
    """Cells of the rows of the tables whose first column is headed "number"."""
    for table in re.findall(r"^\| number \|.*\n\|[-|]*\n((?:\|.*\n?)*)", page, re.MULTILINE):
        for line in table.splitlines():
            yield [cell.strip() for cell in line.strip().strip("|").split("|")]


def texts_of(folder, link):
    """What is read where a row links to: the file, or the pages beside a picture or above it that show it."""
    path = (folder / link.partition("#")[0]).resolve()
    if path.suffix != ".png":
        return [path.read_text(encoding="utf-8")] if path.is_file() else []
    pages = [page for at in list(path.parents)[:3] for page in at.glob("*.md")]
    texts = [page.read_text(encoding="utf-8") for page in pages if page.name != "THESIS.md"]
    return [text for text in texts if path.name in text]


def not_named(folder, cells, numbers):
    """Of the numbers of a row, those that no file that it links to names."""
    links = [link for link in LINK.findall(" | ".join(cells)) if "://" not in link and not link.startswith("#")]
    named = {number for link in links for text in texts_of(folder, link) for number in numbers_in(text)}
    return [number for number in numbers if number not in named and not number.startswith("Perspective")]


def check_map(page, known, folder):
    """What is wrong with the rows, and how many there are of each kind."""
    wrong, count, found = [], Counter(), set()
    for cells in rows_of(page):
        numbers = numbers_in(cells[0])
        if not numbers:
            wrong.append(f"{cells[0]}: a row without a number")
        found.update(numbers)
        how = next((how for how in HOW if cells[-1].startswith(how)), None)
        if how is None:
            wrong.append(f"{cells[0]}: the last cell begins with none of {', '.join(HOW)}")
        elif how != "not there" and not LINK.search(" | ".join(cells)):
            wrong.append(f"{cells[0]}: no link to a file")
        elif how != "not there":
            wrong += [f"{number}: no file that its row links to names it" for number in not_named(folder, cells, numbers)]
        count[how] += 1
    wrong += [f"cases/THESIS.md: no row for {number}" for number in known if number not in found]
    return wrong, count


def main(root):
    listed = (root / "tests/docs/thesis_numbers.txt").read_text(encoding="utf-8").splitlines()
    known = [line for line in listed if line and not line.startswith("#")]
    wrong = []
    for name in ("THESIS.md", "ERRATA.md"):
        path = root / "cases" / name
        page = path.read_text(encoding="utf-8")
        strangers = set(numbers_in(LINK.sub("]", page))) - set(known)
        wrong += [f"cases/{name}: the text has no {number}" for number in sorted(strangers)]
        wrong += [f"cases/{name}: {link} is not there" for link in LINK.findall(page)
                  if "://" not in link and not (path.parent / link.partition("#")[0]).exists()]
    missing, count = check_map((root / "cases/THESIS.md").read_text(encoding="utf-8"), known, root / "cases")
    wrong += missing
    print("\n".join(wrong) or f"{len(known)} numbers of the text are on the map; rows: " +
          ", ".join(f"{count[how]} {how}" for how in HOW))
    return 1 if wrong or not known else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
