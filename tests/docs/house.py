#!/usr/bin/env python3
"""house.py ROOT: measures the code: its lines, rooms, arrows, functions and types, and the places
that ask which mathematics runs. Nothing fails here; the table is for comparing two states of the code.

A room is one folder of src with that of include/rbvi; an arrow is a room that includes a header of
another one. A place is a line that asks one of QUESTIONS outside of the room that owns the answer.
The members of a type are its data, those of its bases not counted.
"""

import re
import statistics
import sys
from collections import defaultdict
from pathlib import Path

from layers import blocks, functions, included, room_of, sources, TYPE, without_namespaces

QUESTIONS = [  # of rooms: what is asked of them
    ({"contact"}, r"has_multipliers\(\w|has_friction\(|follows_state"),
    ({"model"}, r"\bmodel_?\.law\b|has_multipliers\(\)|online_enriched|evaluates_contact|a_change"),
    ({"model", "mor"}, r"reduction(_of\(.*\))? *(==|!=)"),
]
DECLARED_IN = {"core/scene.cpp", "core/scene.hpp", "core/contact_recipe.hpp"}  # of contact
LARGEST = 5


def lines_of(path):
    return path.read_text(encoding="utf-8").splitlines()


def arrows(root):
    """(rooms, pairs of rooms of which the first includes the second)."""
    rooms, pairs = set(), set()
    for path in sources(root, ["src", "include/rbvi"]):
        here = room_of(path, root)
        rooms.add(here)
        pairs |= {(here, room_of(target, root)) for _, target in included(path, root) if target}
    return rooms, {(here, there) for here, there in pairs if here != there}


def questions(root):
    """Number of places by file."""
    count = defaultdict(int)
    for path in sources(root, ["src", "include/rbvi"]):
        room = room_of(path, root).split("/")[0]
        asked = "|".join(question for owners, question in QUESTIONS if room not in owners)
        if f"{room}/{path.name}" not in DECLARED_IN:
            count[str(path.relative_to(root))] = sum(
                re.search(asked, line) is not None for line in lines_of(path))
    return {name: places for name, places in count.items() if places}


def all_functions(root):
    """(lines, file, heading) of every function of src and include."""
    return sorted((length, str(path.relative_to(root)), heading)
                  for path in sources(root, ["src", "include/rbvi"])
                  for heading, length, _ in functions(without_namespaces(lines_of(path))))


def members(lines):
    """Data members among the lines inside of a type."""
    code = [re.sub(r"//.*", "", line).rstrip() for line in lines]
    found, statement, depth = 0, "", 0
    for line in code:
        if depth == 0:
            statement += " " + line.strip()
        depth += line.count("{") - line.count("}")
        if depth == 0 and re.search(r"[;:}]$", line):
            data = re.sub(r"<[^;]*>|\{.*\}|=.*", "", statement)
            if not re.search(r"\(|\b(using|friend|static|enum|struct|class|public|private|protected)\b",
                             data) and re.search(r"\w+\W+\w+", data):
                found += data.count(",") + 1
            statement = ""
    return found


def types(root):
    """(members, name, file) of every type of src and include that stands in no other."""
    found = []
    for path in sources(root, ["src", "include/rbvi"]):
        lines = without_namespaces(lines_of(path))
        for heading, begin, end in blocks(lines, 0, len(lines), 0):
            if TYPE.match(heading) and not heading.startswith("enum"):
                name = re.search(r"(?:struct|class|union)\s+(\w+)", heading)
                found.append((members(lines[begin + 1:end]), name.group(1) if name else "?",
                              str(path.relative_to(root))))
    return sorted(found, reverse=True)


def main(root):
    for folder in ("src", "include", "tests"):
        code = sources(root, [folder])
        print(f"{folder}: {sum(len(lines_of(path)) for path in code)} lines in {len(code)} files")
    rooms, pairs = arrows(root)
    print(f"rooms: {len(rooms)}, arrows between them: {len(pairs)}")
    places = questions(root)
    print(f"places that ask another room which mathematics runs: {sum(places.values())} "
          f"in {len(places)} files")
    for name, count in sorted(places.items(), key=lambda item: -item[1])[:LARGEST]:
        print(f"  {count:3} {name}")
    sizes = all_functions(root)
    lengths = [length for length, _, _ in sizes]
    print(f"functions: {len(sizes)}, lines: median {statistics.median(lengths):g}, longest "
          f"{lengths[-1]}")
    for length, name, heading in sizes[:-LARGEST - 1:-1]:
        print(f"  {length:3} {name}: {heading[:70]}")
    print("types with the most members")
    for count, name, path in types(root)[:LARGEST]:
        print(f"  {count:3} {name} ({path})")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
