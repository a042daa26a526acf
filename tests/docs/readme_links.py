#!/usr/bin/env python3
"""readme_links.py ROOT: every file, and every heading, that a page links to is there."""

import re
import sys
from pathlib import Path

FOLDERS = ("", "cases", "src", "include", "tests", "mpi-scripts")
CODE = re.compile(r"^```.*?^```|`[^`\n]*`", re.DOTALL | re.MULTILINE)


def pages(root):
    found = set(root.glob("*.md"))
    for folder in FOLDERS[1:]:
        found.update((root / folder).rglob("*.md"))
    return sorted(found)


def anchors_of(path):
    text = CODE.sub(lambda code: code.group().strip("`") if "\n" not in code.group() else "",
                    path.read_text(encoding="utf-8"))
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-")
            for heading in re.findall(r"^#+ (.*)$", text, re.MULTILINE)}


def main(root):
    wrong, count = [], 0
    for page in pages(root):
        text = CODE.sub("", page.read_text(encoding="utf-8"))
        for link in re.findall(r"\]\(([^)\s]+)\)", text):
            if "://" in link:
                continue
            count += 1
            name, _, anchor = link.partition("#")
            target = (page.parent / name).resolve() if name else page
            if not target.exists():
                wrong.append(f"{page.relative_to(root)}: {link} is not there")
            elif anchor and anchor not in anchors_of(target):
                wrong.append(f"{page.relative_to(root)}: {link}: no such heading")
    print("\n".join(wrong) or f"{count} links lead to something")
    return 1 if wrong or not count else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
