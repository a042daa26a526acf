#!/usr/bin/env python3
"""layout.py OUT ROOT: the data sets of files against src/model/LAYOUT.md.

OUT has the runs of small_runs.py. Every data set of every model and sample is in the tables, with
its type and shape, and every one that they list is in some file.
"""

import re
import sys
from pathlib import Path

import h5py

from small_runs import RUNS

PLACEHOLDERS = {
    "I": ("0", "1"),
    "R": ("0", "1", "2"),
    "T": ("consistency", "contact_matrix", "contact_vector", "friction_matrix", "friction_vector"),
    "OPERATOR": ("a", "b", "f", "g", "b_normal", "b_tangential"),
    "TERM": ("contact_matrix", "contact_vector", "friction_matrix", "friction_vector"),
}
KINDS = ("model.h5", "model.fields.h5")
TYPES = {"O": "text", "i": "integers", "f": "numbers"}
OF_A_GROUP, OF_A_DATA_SET = "Jot", "s"


def concrete(name):
    for placeholder, values in PLACEHOLDERS.items():
        if re.search(rf"/{placeholder}(?=[/_]|$)", name):
            return [re.sub(rf"/{placeholder}(?=[/_]|$)", f"/{value}", name) for value in values]
    return [name]


def tables_of(page):
    """Kind of file -> name -> (type, shape)."""
    tables = {}
    for section in page.split("\n## ")[1:]:
        kind = re.match(r"[\w.]*", section).group()
        rows = tables.setdefault(kind if kind in KINDS else "samples", {})
        for line in re.findall(r"^\| (`.*) \|$", section, re.MULTILINE):
            names, types, shapes, _ = re.split(r" \| ?", line)
            names = re.findall(r"`([^`]+)`", names)
            columns = [column.split(", ") for column in (types, shapes)]
            for i, name in enumerate(names):
                what = tuple(column[i if len(column) > 1 else 0] for column in columns)
                rows.update({one: what for one in concrete(name)})
    return tables


def value_of(expression, known):
    """Of "n (n + 1) / 2", with the letters that are known, and the others."""
    text = re.sub(r"(?<=[\w)]) (?=[\w(])", " * ", expression)
    unknown = set(re.findall(r"[A-Za-z]\w*", text)) - known.keys()
    return eval(text, {}, {**known, **dict.fromkeys(unknown, 1)}), unknown


def fits(shape, expressions, known):
    """Whether a shape is that of "c x R"; letters not known before are then known."""
    found = dict(known)
    if len(shape) != len(expressions):
        return False
    for size, expression in zip(shape, expressions):
        value, unknown = value_of(expression, found)
        if len(unknown) == 1 and value and size % value == 0:
            found[unknown.pop()] = int(size // value)
        elif unknown or value != size:
            return False
    known.update(found)
    return True


def known_sizes(file):
    modes, supremizers, generators = (int(file[f"size/{name}"][()])
                                      for name in ("modes", "supremizers", "generators"))
    return {"n": modes + supremizers, "R": generators,
            "P": len(file["parameters/names"]), "p": len(file["parameters/free"]),
            "d": file["interfaces/0/points"].shape[1], "k": int(file["contact/dofs"][()]),
            "l": len(file["law/dofs"]) if "law/dofs" in file else 0,
            "H": sum(b * (b + 1) // 2 for b in file["law/blocks"]) if "law/blocks" in file else 0,
            "c": file["contact/dual_basis"].shape[0]}


def check_shapes(file, table, known, where):
    """What is wrong with one file."""
    items, wrong = [], []
    file.visititems(lambda name, item: items.append((name, item)))
    names = [name for name, item in items if isinstance(item, h5py.Dataset)]
    for name in names:
        if name not in table:
            wrong.append(f"LAYOUT.md has no {name}, which {where} has")
            continue
        kind, shape = table[name]
        data, group = file[name], name.rpartition("/")[0]
        if TYPES.get(data.dtype.kind) != kind:
            wrong.append(f"{where}: {name} holds {data.dtype}, not {kind}")
        if data.size == 0:
            continue
        letters = {letter: f"{letter}_{group.replace('/', '_')}" for letter in OF_A_GROUP}
        shapes = [[re.sub(r"\b[A-Za-z]\b", lambda m: letters.get(m.group(), m.group()), size)
                   for size in one.split(" x ")] for one in shape.split(" or ")]
        if not any(fits(data.shape or (1,), one, known) for one in shapes):
            wrong.append(f"{where}: {name} is {data.shape}, not {shape}")
        for letter in OF_A_DATA_SET:
            known.pop(letter, None)
    return names, wrong


def main(out, root):
    tables = tables_of((root / "src/model/LAYOUT.md").read_text(encoding="utf-8"))
    seen, wrong, files = {kind: set() for kind in tables}, [], 0
    for run in RUNS:
        with h5py.File(out / run / KINDS[0], "r") as file:
            known = known_sizes(file)
        for kind, paths in (*((kind, [out / run / kind]) for kind in KINDS),
                            ("samples", sorted((out / run / "samples").glob("*.h5"))[:1])):
            for path in paths:
                with h5py.File(path, "r") as file:
                    names, complaints = check_shapes(
                        file, tables[kind], {} if kind == "samples" else dict(known),
                        f"{kind} of {run}")
                seen[kind].update(names)
                wrong += complaints
                files += 1
    for kind, table in tables.items():
        wrong += [f"LAYOUT.md has {name}, which no {kind} has"  # the first interface has them all
                  for name in table.keys() - seen[kind] if "/1/" not in name]
    print("\n".join(sorted(wrong)) or f"{files} files are as LAYOUT.md says")
    return 1 if wrong or files < 3 * len(RUNS) else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
