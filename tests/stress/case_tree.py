"""Case files as trees of texts: choices made, values replaced, other units."""

import re

import yaml

FACTORS = {"mm": 1, "um": 1e-3, "MPa": 1, "GPa": 1e3, "N": 1, "N/mm": 1}
DIMENSIONS = {"m": (1, 0), "mm": (1, 0), "Pa": (0, 1), "MPa": (0, 1), "N": (2, 1), "N/mm": (1, 1)}


def load(path, variant=None, **choices):
    """The tree of a case with its variant and choices."""
    with open(path, encoding="utf-8") as file:
        tree = yaml.load(file, yaml.BaseLoader)
    for where, value in (tree.pop("variants", {}).get(variant, {}) if variant else {}).items():
        put(tree, where, value)
    for name, choice in tree.pop("choices", {}).items():
        given = choices.pop(name, choice.get("default"))
        if "sets" in choice:
            if given is not None:
                put(tree, choice["sets"], str(given))
            continue
        for where, value in choice[given].items():
            put(tree, where, value)
    assert not choices, choices
    tree.pop("tests", None)
    tree.pop("says", None)
    if tree["mesh"].get("file"):
        tree["mesh"]["file"] = str(path.parent / tree["mesh"]["file"])
    return tree


def put(tree, where, value):
    """A value at a path; an empty one takes away what is there."""
    *way, last = where.split(".")
    for name in way:
        tree = tree.setdefault(name, {})
    if value in ("", None):
        tree.pop(last, None)
    else:
        tree[last] = value


def save(tree, path):
    path.write_text(yaml.safe_dump(tree, sort_keys=False, width=10000), encoding="utf-8")
    return path


class Units:
    """A case in other units: lengths are `length` times larger numbers, stresses `stress` times."""

    def __init__(self, tree, length, stress):
        self.length, self.stress = length, stress
        self.membrane = tree["physics"] == "membrane"
        self.thick = 1 if tree["physics"] == "axisymmetric" else 0
        self.factors = {name: self.factor(name, value) for name, value in tree["parameters"].items()}

    def factor(self, name, value):
        if self.membrane and name == "load":
            return 1 / self.length
        texts = [value.get("unit", ""), *value.get("range", []), value["default"]]
        unit = next((unit for text in texts for unit in DIMENSIONS if text.split(" ")[-1] == unit), None)
        length, stress = DIMENSIONS.get(unit, (0, 0))
        return self.length**length * self.stress**stress

    def of_output(self, name):
        if self.membrane:
            return self.length**2 if name == "energy" else self.length
        return self.stress * self.length**(self.thick + (2 if name == "energy" else 1))

    def parameters(self, rows):
        return [{name: value * self.factors[name] for name, value in row.items()} for row in rows]

    def text(self, text, factor=1.0, place=1.0):
        """An expression in the old units as one in the new; x and y are `place` times as large."""
        text = re.sub(r"(?<![\w.])([\d.]+(?:[eE][-+]?\d+)?) (mm|um|MPa|GPa|N/mm|N)(?![\w/])",
                      lambda found: repr(float(found[1]) * FACTORS[found[2]]), text)
        for name in ("x", "y"):
            if place != 1:
                text = re.sub(rf"\b{name}\b", f"({name}/{place!r})", text)
        for name, size in self.factors.items():
            if size != 1:
                text = re.sub(rf"\b{name}\b", f"({name}/{size!r})", text)
        return text if factor == 1 else f"{factor!r}*({text})"

    def turn(self, old, scale_mesh):
        """The tree in the new units; `scale_mesh(file, numbers)` gives the scaled mesh."""
        tree = {name: old[name] for name in ("rbvi", "name", "physics", "free", "symmetric", "mirror_images",
                                             "train", "validate", "options") if name in old}
        tree["mesh"] = dict(old["mesh"])
        if "file" in tree["mesh"]:
            tree["mesh"]["file"] = scale_mesh(tree["mesh"]["file"], tree["mesh"].pop("set", {}), self.length)
        on_mesh = self.length if "file" in tree["mesh"] else 1.0
        if "v_length" in old:
            tree["v_length"] = self.text(old["v_length"], on_mesh)
        self.parts(old, tree, on_mesh)
        self.contacts(old, tree)
        return tree

    def parts(self, old, tree, on_mesh):
        length, stress = self.length, self.stress
        tree["parameters"] = {}
        for name, value in old["parameters"].items():
            turned = {key: value[key] for key in ("spacing",) if key in value}
            for key in ("range", "limits"):
                if key in value:
                    turned[key] = [self.text(text, self.factors[name]) for text in value[key]]
            turned["default"] = self.text(value["default"], self.factors[name])
            tree["parameters"][name] = turned
        if "let" in old:
            tree["let"] = {name: self.text(text, 1, on_mesh) for name, text in old["let"].items()}
        way = old.get("map", ["x", "y"] if on_mesh == 1 else None)
        if isinstance(way, dict):
            tree["map"] = {"scale": self.text(way["scale"], length / on_mesh)}
        elif way:
            tree["map"] = [self.text(text, length, on_mesh) for text in way]
        if "motion" in old:
            tree["motion"] = [self.text(text, length, on_mesh) for text in old["motion"]]
        moduli = {"E": stress, "lambda": stress, "mu": stress, "nu": 1}
        self.section(old, tree, "materials", moduli, on_mesh)
        self.section(old, tree, "imposed", {"u": length, "ux": length, "uy": length}, on_mesh)
        force = 1 / length if self.membrane else stress / length
        self.section(old, tree, "loads", {"force": force, "pressure": stress, "traction": stress}, length)
        self.section(old, tree, "springs", {"stiffness": stress * length**self.thick, "settled": length,
                                            "pretension": stress * length**(1 + self.thick)}, on_mesh)
        if "curves" in old:
            tree["curves"] = {name: {**value, "circle": [self.text(text, on_mesh) for text in value["circle"]]}
                              for name, value in old["curves"].items()}
        if "require" in old:
            tree["require"] = {name: {"that": self.text(value["that"]), "says": f"{name} does not fit"}
                               for name, value in old["require"].items()}

    def section(self, old, tree, name, factors, place):
        def turned(key, value):
            if key not in factors or value == "motion":
                return value
            if isinstance(value, list):
                return [self.text(text, factors[key], place) for text in value]
            return self.text(value, factors[key], place)
        if name in old:
            tree[name] = {entry: {key: turned(key, value) for key, value in values.items()}
                          for entry, values in old[name].items()}

    def contacts(self, old, tree):
        length, tree["contact"] = self.length, {}
        for name, old_one in old["contact"].items():
            one = tree["contact"][name] = dict(old_one)
            if "above" in one:
                one["above"] = self.text(one["above"], length, length)
            if "friction" in one:
                one["friction"] = {key: value if key == "bound" else
                                   self.text(value, self.stress if key == "tresca" else 1)
                                   for key, value in one["friction"].items()}
            against = one.get("against")
            if not isinstance(against, dict):
                continue
            kind, value = next(iter(against.items()))
            lengths = ("center", "radius", "position")
            one["against"] = {kind: {
                key: [self.text(t, length) for t in part] if key == "center" else
                self.text(part, length if key in lengths else 1) if isinstance(part, str) else part
                for key, part in value.items()}}
