#!/usr/bin/env python3
"""quoted_numbers.py ROOT [--write]: numbers and tables that a page quotes from another page are those there.

A table below a mark "<!-- table of PAGE: HEADING -->" is the first one below that heading of that page.

quoted_numbers.csv, one row per number: the page, the words before the number on it (* is any word), the page
of the table, the first cells of its row (joined by a bar), its column, which number of the cell. With --write
what differs is written as the table has it.
"""

import csv
import re
import sys
from pathlib import Path

TABLE = re.compile(r"(<!-- table of (\S+): (.*?) -->\n)((?:\|.*\n)+)")
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def tables(text):
    """Head and rows of each table, as lists of cells."""
    for block in re.findall(r"(?:^\|.*\n)+", text + "\n", re.MULTILINE):
        rows = [[cell.strip().replace("`", "") for cell in line.strip().strip("|").split("|")]
                for line in block.splitlines()]
        if len(rows) > 2:
            yield rows[0], rows[2:]


def quoted(text, row, column, which):
    """That number of the cell in the first table that has the row and the column; nothing if none has."""
    for head, rows in tables(text):
        for cells in rows:
            if column in head and "|".join(cells).startswith(row):
                numbers = NUMBER.findall(cells[head.index(column)])
                return numbers[int(which) - 1].lstrip("+") if len(numbers) >= int(which) else None
    return None


def with_tables(root, text):
    """The page with the tables of others as they are there."""
    def table_there(mark):
        page = (root / mark[2]).read_text(encoding="utf-8")
        below = re.search(rf"^#+ {re.escape(mark[3])}\n(?:(?!#).*\n)*?((?:\|.*\n)+)", page, re.MULTILINE)
        if below is None:
            sys.exit(f"{mark[2]} has no table below '{mark[3]}'")
        return mark[1] + below[1]
    return TABLE.sub(table_there, text)


def quoted_tables(root, pages):
    """What is another table, by page; `pages` has them as they should be."""
    for path in sorted(root.glob("cases/**/*.md")):
        page, text = str(path.relative_to(root)), path.read_text(encoding="utf-8")
        pages[page] = with_tables(root, text)
        found = TABLE.findall(text)
        wrong = sum(old != new for old, new in zip(found, TABLE.findall(pages[page])))
        if len(found) < text.count("<!-- table of "):
            yield f"{page}: a mark has no table below it"
        if wrong:
            yield f"{page}: {wrong} tables are not those that they name"


def main(root, *words):
    pages = {}
    wrong = list(quoted_tables(root, pages))
    with open(Path(__file__).with_suffix(".csv"), encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(line for line in file if not line.startswith("#")))
    for quote in table:
        page, source = quote["page"], pages.get(quote["source"]) or (root / quote["source"]).read_text(encoding="utf-8")
        text = pages.setdefault(page, (root / page).read_text(encoding="utf-8"))
        number = quoted(source, quote["row"], quote["column"], quote["which"])
        before = r"\s+".join(r"\S+" if word == "*" else re.escape(word) for word in quote["before"].split())
        told = re.search(rf"{before}\s+({NUMBER.pattern})", text)
        if number is None or told is None:
            wrong.append(f"{page}: '{quote['before']}': " + ("no such words" if number else
                         f"{quote['source']} has no {quote['column']} of {quote['row']}"))
        elif told.group(1) != number:
            wrong.append(f"{page}: '{quote['before']}' {told.group(1)}: {quote['source']} has {number}")
            pages[page] = text[:told.start(1)] + number + text[told.end(1):]
    if words == ("--write",):
        for page, text in pages.items():
            (root / page).write_text(text, encoding="utf-8")
    elif wrong:
        wrong.append("written by tests/docs/quoted_numbers.py . --write, where the words are there")
    print("\n".join(wrong) or f"{len(table)} quoted numbers are those of their tables")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve(), *sys.argv[2:]))
