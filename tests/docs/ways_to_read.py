#!/usr/bin/env python3
"""ways_to_read.py ROOT: words that each reader of cases/README.md needs, from README.md to an answer.

Counted are README.md, cases/README.md and what a row of "ways to read" links to: a page whole, of a
heading its section. A word is what blanks end and a letter or digit is in; of tables, cases and output, too.
"""

import re
import sys
from pathlib import Path

MOST = 8000
TABLE = re.compile(r"<!-- ways to read -->\n(.*?)<!-- end of the ways -->", re.DOTALL)


def words(text):
    return sum(1 for word in text.split() if re.search(r"\w", word))


def anchor_of(heading):
    return re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-")


def section(text, anchor):
    """From the heading of this anchor to the next one that is not below it."""
    parts = re.split(r"^(#+) (.*)$", text, flags=re.MULTILINE)
    taken, depth = [], 0
    for marks, heading, body in zip(parts[1::3], parts[2::3], parts[3::3]):
        if depth and len(marks) <= depth:
            break
        if anchor_of(heading) == anchor:
            depth = len(marks)
        if depth:
            taken += [heading, body]
    return "\n".join(taken)


def linked(folder, link):
    name, _, anchor = link.partition("#")
    text = (folder / name).read_text(encoding="utf-8")
    return section(text, anchor) if anchor else text


def main(root):
    cases = root / "cases"
    page = (cases / "README.md").read_text(encoding="utf-8")
    before = words((root / "README.md").read_text(encoding="utf-8")) + words(page)
    rows = [line for line in TABLE.search(page).group(1).splitlines()[2:] if "](" in line]
    counts = {row.strip("|").split("|")[0].strip():
              before + sum(words(linked(cases, link)) for link in re.findall(r"\]\(([^)]+)\)", row))
              for row in rows}
    print("\n".join(f"{count} words: {reader}" for reader, count in counts.items()))
    return int(len(counts) < 3 or max(counts.values()) > MOST)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
