#!/usr/bin/env python3
"""layers.py ROOT: the code keeps to the layers of src/README.md, and to its sizes.

A layer is a room, src/NAME with include/rbvi/NAME, without folders in it but for `published`: variants
that the programs enter in lists of the room.
- A layer includes itself and layers above it in the table "Layers" alone. What is published is included
  by what is published, and by the mains.
- No layer asks which kind of contact it has: outside of the layer contact and of that which makes
  scenes, no file includes the header of one or casts to one of its classes. Nitsche's method has files of that
  name; elsewhere no line asks for it, but for what contact has (has_multipliers, ...).
- A file of code has at most 400 lines, a function at most 60 unless it is a table of data. Functions are found by the indentation that clang-format gives them.
"""

import re
import sys
from pathlib import Path

MOST_OF_FILE, MOST_OF_FUNCTION = 400, 60
PUBLISHED = "published"
# A line that asks whether contact is by Nitsche's method; options of that method are data.
NITSCHE_LINE = re.compile(r"(?<!options)(?<!hf)[.>]nitsche\b|([=!]=|case) *Formulation::")
INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)
TYPE = re.compile(r"(template\s*<.*?>\s*)?(struct|class|union|enum)\b")
TABLE = re.compile(r"static const(expr)? .*\{|return \{")


def layers_of(root):
    """Layers in their order, and how many of them the online program has."""
    page = (root / "src/README.md").read_text(encoding="utf-8")
    section = page.split("\n## Layers\n")[1].split("\n## ")[0]
    names = re.findall(r"^\| \[`(\w+)`\]", section, re.MULTILINE)
    if "model" not in names or len(names) < 10:
        sys.exit("src/README.md: no table of layers")
    return names, names.index("model") + 1


def room_of(path, root):
    parts = path.relative_to(root).parent.parts
    parts = parts[2:] if parts[0] == "include" else parts[1:]
    return "/".join(parts[:-1] if parts[1:] == (PUBLISHED,) else parts)


def sources(root, folders, suffixes=(".cpp", ".hpp")):
    return sorted(path for folder in folders for path in (root / folder).rglob("*")
                  if path.suffix in suffixes)


def included(path, root):
    """The files of ours that a file includes."""
    for name in INCLUDE.findall(path.read_text(encoding="utf-8")):
        places = [path.parent / name, root / "include" / name]
        found = [place.resolve() for place in places if place.is_file()]
        yield name, found[0] if found else None


def check_includes(root):
    names, online = layers_of(root)
    wrong = []
    for path in sources(root, ["src", "include/rbvi"]):
        layer = room_of(path, root)
        if layer not in names:
            wrong.append(f"{path.relative_to(root)}: src/README.md has no layer {layer}")
            continue
        for name, target in included(path, root):
            if layer == "bin" and name in ("tests/catalogue.hpp", "rbvi.h"):
                continue
            if target is None:
                wrong.append(f"{path.relative_to(root)} includes {name}, which is nowhere")
                continue
            if room_of(target, root) not in names[:names.index(layer) + 1]:
                wrong.append(f"{path.relative_to(root)} includes {name}: {layer} is above it")
            if target.parent.name == PUBLISHED and path.parent.name != PUBLISHED and layer != "bin":
                wrong.append(f"{path.relative_to(root)} includes {name}, a published variant")
    for path in sources(root, [p for p in (root / "cases").iterdir() if p.is_dir()]):
        for name, target in included(path, root):
            if name.startswith("rbvi/") and name.split("/")[1] not in names[:online]:
                wrong.append(f"{path.relative_to(root)} includes {name}, which the online program "
                             "does not have")
    return wrong


def check_kinds(root):
    """Branches on the kind of contact outside of its layer: its header makes a recipe, or has a class
    of interfaces."""
    kind = re.compile(r"\bContactRecipe \w+\(|: public (ContactInterface|EntitySum)\b")
    kinds = {path for path in sources(root, ["include/rbvi/contact"])
             if path.stem not in ("entity_sum", "registry") and kind.search(path.read_text(encoding="utf-8"))}
    if len(kinds) < 4:
        return ["src/contact has no kinds"]
    casts = re.compile(r"dynamic_(pointer_)?cast<[^>]*(Interface|EntitySum|NitscheCurve)")
    wrong = []
    for path in sources(root, ["src", "include/rbvi"]):
        if room_of(path, root) in ("contact", "scene"):
            continue
        own = "nitsche" in path.name
        wrong += [f"{path.relative_to(root)} includes the kind {target.stem}"
                  for _, target in included(path, root)
                  if target and (target in kinds or target.stem.startswith("nitsche"))
                  and room_of(target, root) == "contact" and not own]
        wrong += [f"{path.relative_to(root)} casts to a kind: {found.group()}"
                  for found in casts.finditer(path.read_text(encoding="utf-8"))]
    return wrong


def check_nitsche(root):
    """Lines of code that ask for Nitsche's method where they should ask for what contact has."""
    wrong = []
    for path in sources(root, ["src", "include/rbvi"]):
        name = str(path.relative_to(root))
        if ("nitsche" in name or room_of(path, root) == "contact"
                or name == "src/core/scene.cpp"):  # which says what contact has
            continue
        code = [line.split("//")[0] for line in path.read_text(encoding="utf-8").splitlines()]
        wrong += [f"{path.relative_to(root)}:{number} asks for Nitsche's method: ask for what contact "
                  "has (has_multipliers, follows_state, ...), or do it in a file of that name"
                  for number, line in enumerate(code, 1) if NITSCHE_LINE.search(line)]
    return wrong


def blocks(lines, first, last, indent):
    """(heading, first line, last line) of every { } whose heading begins at `indent`."""
    line, margin = first, " " * indent
    while line < last:
        text = lines[line]
        if not text.startswith(margin) or not re.match(r"[A-Za-z_~:\[(]", text[indent:]):
            line += 1
            continue
        end = line
        while end < last and not re.search(r"[{};]\s*(//.*)?$|:$|^#", lines[end]):
            end += 1
        heading = " ".join(part.strip() for part in lines[line:end + 1])
        if end < last and heading.split("//")[0].rstrip().endswith("{"):
            inside = range(end + 1, last)
            close = next((i for i in inside if lines[i].startswith(margin + "}")), last)
            yield heading, line, close
            end = close
        line = end + 1


def functions(lines, first=0, last=None, indent=0):
    """(name, lines from its heading to its brace, those lines) of functions and members."""
    last = len(lines) if last is None else last
    for heading, begin, end in blocks(lines, first, last, indent):
        if heading.startswith("namespace") or heading.startswith("extern"):
            if indent == 0:  # its contents are not indented: look at them line by line
                continue
        elif TYPE.match(heading):
            yield from functions(lines, begin + 1, end, indent + 2)
        elif "(" in heading:
            yield heading, end - begin + 1, lines[begin:end + 1]


def without_namespaces(lines):
    return ["" if re.match(r"(inline )?namespace\b.*\{$|\} // namespace|extern \"C\" \{$", line)
            else line for line in lines]


def is_table(body):
    """Whether all that a function does is to hold, or return, a table."""
    statements = [line for line in body[1:-1] if re.match(r"  (?!using )[^ }/#]", line)]
    return bool(statements) and TABLE.match(statements[0].strip()) is not None and all(
        line.strip().startswith("return ") for line in statements[1:])


def check_sizes(root):
    wrong = []
    for path in sources(root, ["src", "include", "cases"], (".cpp", ".hpp", ".py")):
        lines = path.read_text(encoding="utf-8").splitlines()
        name = path.relative_to(root)
        if len(lines) > MOST_OF_FILE:
            wrong.append(f"{name} has {len(lines)} lines, more than {MOST_OF_FILE}")
        if path.suffix == ".py":
            continue
        for heading, length, body in functions(without_namespaces(lines)):
            if length > MOST_OF_FUNCTION and not is_table(body):
                wrong.append(f"{name}: a function of {length} lines, more than {MOST_OF_FUNCTION}: "
                             f"{heading[:60]}")
    return wrong


def main(root):
    wrong = check_includes(root) + check_kinds(root) + check_nitsche(root) + check_sizes(root)
    print("\n".join(wrong) or "the layers, rooms and sizes are those of src/README.md")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
