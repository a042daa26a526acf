#!/usr/bin/env python3
"""case_schema.py ROOT: every case.yaml of cases and cases/known is valid by cases/case.schema.json, and what is
wrong in one of them is found. Without python3-jsonschema and python3-yaml the exit status is 77: skipped.
"""

import copy
import json
import sys
from pathlib import Path

try:
    import jsonschema
    import yaml
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)


class Loader(yaml.SafeLoader):
    """As editors read YAML (1.2): yes and no are texts."""


Loader.yaml_implicit_resolvers = {
    letter: [(tag, pattern) for tag, pattern in resolvers
             if tag != "tag:yaml.org,2002:bool" or letter in "tTfF"]
    for letter, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()}


def by_text(node):
    """Names of entries are texts in JSON."""
    if isinstance(node, dict):
        return {str(name): by_text(value) for name, value in node.items()}
    return [by_text(item) for item in node] if isinstance(node, list) else node


def changed(case, path, value):
    """The case with another value at a path; none: without it."""
    case = copy.deepcopy(case)
    *tables, last = path.split("/")
    at = case
    for name in tables:
        at = at.setdefault(name, {})
    if value is None:
        del at[last]
    else:
        at[last] = value
    return case


RIGHT = [("materials/rubber/E", "15 GPa"), ("motion", ["0", "-depth"]), ("mesh/degree", 1),
         ("materials/rubber", {"at": "all", "lambda": "young", "mu": 4}), ("tests/strain/at", {}),
         ("springs", {"foot": {"at": "bottom", "stiffness": "1 N/m"}}), ("free", ["indentation"]),
         ("options/nonlinear_method", "kacanov"), ("options/indentation", [0.02, 0.05])]
WRONG = [("rbvi", None), ("rbvi", 2), ("contact", None), ("physics", "plane_strian"), ("spring", {}),
         ("springs", {"foot": {"at": "bottom", "stifness": 1}}),
         ("mesh/built_in", "two_blokcs"), ("mesh/degree", 3), ("mesh/set", {"size": []}),
         ("parameters/shear/range", [0]), ("parameters/shear/range", 0.2), ("parameters/shear/default", None),
         ("parameters/depth", 0.1), ("materials/rubber/at", None), ("materials/rubber/rho", 1),
         ("imposed/top/ut", 0), ("contact/blocks/at", None), ("contact/blocks/friction", 0.3),
         ("contact/blocks/against", {"wall": {}}), ("contact/blocks/kinematics", "finite"),
         ("contact/blocks/against", {"disk": {"center": [0, 0]}}), ("tests/strain/expect", None),
         ("tests/strain/expect/energy", [1]), ("tests/strain/mesh", {}), ("train", ["grid:5"])]


def main(root):
    schema = json.loads((root / "cases/case.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft7Validator.check_schema(schema)
    valid = jsonschema.Draft7Validator(schema)
    cases = {path.parent.name: by_text(yaml.load(path.read_text(encoding="utf-8"), Loader))
             for path in sorted([*root.glob("cases/*/case.yaml"), *root.glob("cases/known/*/case.yaml")])}
    wrong = [f"{name}: {error.message} at {'/'.join(map(str, error.path))}"
             for name, case in cases.items() for error in valid.iter_errors(case)]
    patch = cases["patch"]
    wrong += [f"{value!r} at {path} is refused" for path, value in RIGHT
              if not valid.is_valid(changed(patch, path, value))]
    wrong += [f"{value!r} at {path} is not found" for path, value in WRONG
              if valid.is_valid(changed(patch, path, value))]
    print("\n".join(wrong) or f"{len(cases)} cases are valid, {len(WRONG)} mistakes are found")
    return 1 if wrong or not cases else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
