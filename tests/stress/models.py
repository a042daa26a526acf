"""Rows of the stress table that make reduced models: of snapshots of every kind, in other units."""

import copy
import csv
import shutil
import subprocess

import case_tree
from lab import (ENERGY, FORCES, WIDTHS, Refused, check_residual, deviation, fields, judge, read_table, shape_deviation,
                 sizes)

# Numbers to which loads and imposed displacements can be scaled: what is zero or scaled by t.
DATA = {"membrane_obstacle": ("load", "frame_height", "frame_tilt"), "two_disks": ("indentation", "initial_gap"),
        "rigid_disk": ("indentation",), "patch": ("indentation", "shear"), "roller": ("top", "bottom"),
        "seal": ("squeeze", "fluid"), "bracket": ("push", "height"), "joint": ("pretension", "pull", "shear"),
        "bolted_flange": ("bolt_force", "gas", "clearance")}
COUNT = 8
UNDISTURBED, PUBLISHED = 0.06, 0.3  # errors of energies and forces with so few samples; by the published method
STARVED = 1  # of peaks and widths: a cone of so few samples may miss them


class Models:
    """The models of one scene: its samples are shared by all of them."""

    def __init__(self, lab, scene):
        self.lab, self.scene = lab, scene
        # Without supremizers the multipliers are not determined, but u is.
        decorrelated = "decorrelated" in scene.name
        self.of, self.looked_at = ((ENERGY,), ("u",)) if decorrelated else ((ENERGY, *FORCES), None)
        self.folder = lab.work / scene.name.replace(" ", "_")
        self.folder.mkdir(parents=True)
        tree = case_tree.load(scene.path(), scene.variant, **scene.choices)
        for where, value in scene.mesh.items():
            case_tree.put(tree, where, value)
        if scene.free:
            tree["free"] = list(scene.free)
        self.tree = tree
        self.case = case_tree.save(tree, self.folder / "case.yaml")

    def model(self, name, train, *options, case=None, samples="base"):
        """A run directory NAME with its model, of these rows of parameters or this set."""
        run = self.folder / name
        if isinstance(train, list):
            train = self.table(f"{name}.csv", train)
        if (self.folder / samples / "samples").is_dir() and samples != name:
            shutil.copytree(self.folder / samples / "samples", run / "samples")
        self.lab.answer(self.lab.rbvi, "offline", "-case", case or self.case, "-out", run, "-train", train,
                        *self.scene.reduction, *options)
        return run

    def table(self, name, rows):
        path = self.folder / name
        with open(path, "w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, rows[0])
            writer.writeheader()
            writer.writerows([{key: repr(value) for key, value in row.items()} for row in rows])
        return path

    def ask(self, run, queries, *options):
        """The answers of a model, all of them, the first with its fields."""
        asked, answers = self.table("queries.csv", queries), self.folder / "answers.csv"
        ended = self.lab.run(self.lab.online, run / "model.h5", "--queries", asked, "--out", answers, *options)
        if ended.status not in (0, 1):
            raise Refused(f"{ended.err.strip()}")
        rows = read_table(answers)
        for row in rows:
            if row["status"] != "ok":
                raise Refused(row["status"])
        picture = self.folder / "first.vtu"
        self.lab.answer(self.lab.online, run / "model.h5", "--mu", mu(queries[0]), "--vtu", picture)
        rows[0] |= fields(picture)
        return rows

    def prepare(self):
        """The undisturbed model; parameters that it is of, queries, their high-fidelity answers."""
        base = self.model("base", f"random:{COUNT}:3")
        names = next(csv.reader(open(base / "samples.csv", encoding="utf-8")))
        names = names[:names.index(ENERGY)]
        self.train = [{name: row[name] for name in names} for row in read_table(base / "samples.csv")]
        middle = [{name: (a[name] + b[name]) / 2 for name in names}
                  for a, b in zip(self.train[:2], self.train[2:4])]
        self.queries = [self.train[0], self.train[-1], *middle]
        self.lab.answer(self.lab.rbvi, "verify", "-out", base, "-valid", self.table("valid.csv", self.queries),
                        "-verify_stability", "no")
        self.truth = read_table(base / "verify/samples.csv")
        self.truth[0] |= {name: value for name, value in self.lab.solve(self.case, mu(self.queries[0])).items()
                          if not isinstance(value, (str, float))}
        answers, told = self.ask(base, self.queries), read_table(base / "verify/summary.csv")[0]
        self.apart = deviation(answers, self.truth, of=self.of)
        # What the model prints of a width that counts nodes is a node: one at each end.
        self.steps = {name: 2 * max(answer[name + "_error"] for answer in answers)
                      for name in WIDTHS if isinstance(answers[0].get(name + "_error", ""), float)}
        self.shape = max(shape_deviation(answers, self.truth, self.looked_at), (told["u_max"], "u over V"),
                         (told.get("lambda_max", 0) if self.looked_at is None else 0, "multipliers over W"))

    def scaled_mesh(self, geometry, numbers, factor):
        """The mesh of a geometry, coordinates `factor` times as large."""
        mesh = self.folder / f"mesh_{factor:g}.msh"
        given = [word for name, value in numbers.items() for word in ("-setnumber", name, value)]
        subprocess.run(["gmsh", "-v", "0", "-2", "-format", "msh22", *given, geometry, "-o", mesh], check=True)
        lines = mesh.read_text(encoding="ascii").splitlines()
        begin = lines.index("$Nodes") + 2
        for k in range(begin, begin + int(lines[begin - 1])):
            number, *place = lines[k].split()
            lines[k] = " ".join([number, *(repr(float(x) * factor) for x in place)])
        mesh.write_text("\n".join(lines) + "\n", encoding="ascii")
        return str(mesh)

    def compared(self, run, queries=None, truth=None, tolerance=None):
        """How far the answers of a run are from the truth, and how far they may be."""
        queries, truth = queries or self.queries, truth or self.truth
        scale, answers = sizes([*self.truth, *truth]), self.ask(run, queries)
        return (deviation(answers, truth, scale, self.of), tolerance or max(3 * self.apart, 1e-6),
                shape_deviation(answers, truth, self.looked_at, self.steps), max(3 * self.shape[0], tolerance or 1e-6))

    def honest(self, run, queries, truth, scale):
        """Of a model that must err: by how much, and by how much verify says."""
        self.lab.answer(self.lab.rbvi, "verify", "-out", run, "-valid", "random:8:9", "-verify_stability", "no")
        apart, said = 0.0, 0.0
        for answer, right in zip(self.ask(run, queries), truth, strict=True):
            check_residual(answer)
            for name in self.of:
                if name in right:
                    apart = max(apart, abs(answer[name] - right[name]) / scale[name])
                    said = max(said, answer[name + "_error"] / scale[name])
        return apart, 3 * said + 1e-6


def disturbed(models):
    """(what, work) of every kind of snapshots."""
    train, first = models.train, models.train[0]
    near = [{name: value * (1 + 1e-14) + 1e-18 for name, value in row.items()} for row in train]
    near_first = [{name: value * (1 + k * 1e-14) for name, value in first.items()} for k in range(4)]
    exact = {"-pod_tolerance": 0, "-eim_tolerance": 0}
    most = [str(word) for pair in exact.items() for word in pair]
    if "nitsche" not in models.scene.name and not models.scene.name.endswith(("condensed", "large")):
        most += ["-cone_tolerance", "0"]

    def alone(name, rows, *options):
        return lambda: models.compared(models.model(name, rows, *options), [first], models.truth[:1],
                                       max(1e-3, 3 * models.apart))

    yield "each sample twice", lambda: models.compared(models.model("twice", train + train))
    yield "each sample again, collinear to 1e-14", lambda: models.compared(models.model("collinear", train + near))
    yield "bases above the rank: tolerances 0", lambda: models.compared(models.model("rank", train, *most))
    yield "one sample, asked there", alone("single", [first])
    yield "five equal samples, asked there", alone("equal", [first] * 5)
    yield "four samples equal to 1e-14, asked there", alone("near", near_first)
    yield "one mode (N = 1), errors as verify measures them", lambda: honest(models, "-pod_max_size", "1")
    if "cone" in models.scene.name or models.scene.name.startswith("membrane"):
        yield ("one mode, one function (N = R = 1), errors as verify measures them",
               lambda: honest(models, "-pod_max_size", "1", "-cone_max_size", "1"))
    yield "zero among the samples", lambda: with_zero(models)
    yield "zero samples alone", lambda: of_zero(models)
    yield "samples scaled by 1e-12 to 1e12 (where Young's modulus scales from 1e-7)", lambda: scaled(models)
    for length, stress, name in ((1e3, 1e-6, "mm, MPa"), (1e-3, 1e6, "km, uPa")):
        yield f"other units ({name} where the case has m, Pa)", lambda a=length, b=stress: in_units(models, a, b)


def honest(models, *options):
    """A starved model errs by what verify says."""
    run = models.model("starved" + str(len(options)), models.train, *options)
    return models.honest(run, models.queries, models.truth, sizes(models.truth))


def with_data(models, at):
    """The case with the data free from 0 on, and the training parameters, and those with all data 0."""
    tree = copy.deepcopy(models.tree)
    plain = case_tree.Units(tree, 1, 1)
    unused = ("shear",) if models.scene.choices.get("bodies") is None else ()
    names = [name for name in DATA[models.scene.case] if name in tree["parameters"] and name not in
             (unused if models.scene.case == "patch" else ())]
    free = list(models.train[0])
    for value in tree["parameters"].values():
        value.pop("limits", None)
    for name in names:
        value = tree["parameters"][name]
        low, high = (plain.text(text) for text in value.get("range", [value["default"]] * 2))
        value["range"] = [f"min(0, {low})", f"max(0, {high})"]
        if name not in free:
            free.append(name)
    tree["free"] = free
    rows = [{name: row.get(name, float(plain.text(tree["parameters"][name]["default"]))) for name in free}
            for row in models.train]
    zero = {name: 0.0 if name in (*names, "tilt") else value for name, value in rows[0].items()}
    return case_tree.save(tree, models.folder / f"{at}.yaml"), rows, zero


def mu(row):
    return ",".join(f"{name}={value!r}" for name, value in row.items())


def with_zero(models):
    case, rows, zero = with_data(models, "with_zero")
    queries = [zero, *rows[:3]]
    truth = [models.lab.solve(case, mu(row)) for row in queries]
    run = models.model("with_zero", [zero, *rows], case=case, samples="none")
    return models.compared(run, queries, truth, max(3 * models.apart, 1e-4))


def of_zero(models):
    case, _, zero = with_data(models, "of_zero")
    truth = models.lab.solve(case, mu(zero))
    return models.compared(models.model("of_zero", [zero], case=case, samples="none"), [zero], [truth], 1e-9)


def scaled(models):
    """One sample and its multiples: loads that are scaled, or Young's modulus."""
    tree, plain = copy.deepcopy(models.tree), case_tree.Units(models.tree, 1, 1)
    names = {"membrane_obstacle": ["load"], "bracket": ["push", "height"], "joint": ["pretension", "pull", "shear"],
             "bolted_flange": ["bolt_force", "gas", "clearance"], "seal": ["fluid", "young"]}.get(
                 models.scene.case, ["young"])
    if models.scene.case == "seal":
        tree["parameters"]["young"] = {"default": "6"}
        tree["materials"]["rubber"]["E"] = "young"
    for value in tree["parameters"].values():
        value.pop("limits", None)
    first = models.train[0]
    values = {name: first.get(name, None) for name in names}
    for name in names:
        value = tree["parameters"][name]
        if values[name] is None:
            values[name] = float(plain.text(value["default"]))
        value["range"] = [repr(-abs(values[name]) * 1e12), repr(abs(values[name]) * 1e12)]
        if name == "young":
            value.update(range=["1e-6", "1e15"], spacing="log")
        if values[name] == 0:
            value["range"] = ["-1", "1"]
    tree.pop("require", None)
    tree["free"] = [*first, *(name for name in names if name not in first)]
    rows = [{**first, **{name: value * t for name, value in values.items()}}
            for t in ((1e-12, 1e-6, 1.0, 1e6, 1e12) if "young" not in names else (1e-7, 1e-4, 1.0, 1e6, 1e12))]
    case = case_tree.save(tree, models.folder / "scaled.yaml")
    run = models.model("scaled", rows, case=case, samples="none")
    truth = [models.lab.solve(case, mu(row)) for row in rows]
    if models.scene.case == "membrane_obstacle":  # its obstacle is not scaled: small ones among large
        return models.compared(run, rows, truth)
    apart = [deviation([answer], [right]) for answer, right in zip(models.ask(run, rows), truth)]
    return max(apart), max(1e-3, 3 * models.apart)


def in_units(models, length, stress):
    units = case_tree.Units(models.tree, length, stress)
    name = f"units_{length:g}"
    case = case_tree.save(units.turn(models.tree, models.scaled_mesh), models.folder / f"{name}.yaml")
    run = models.model(name, units.parameters(models.train), case=case, samples="none")
    answers = [{key: value / units.of_output(key) if key in (ENERGY, *FORCES) else value
                for key, value in answer.items()} for answer in models.ask(run, units.parameters(models.queries))]
    reference = models.ask(models.folder / "base", models.queries)
    # Nitsche's gamma is measured on the mesh, which stays as it is.
    return deviation(answers, reference), 0.05 if "nitsche" in models.scene.name else 1e-6


def rows(lab, scene):
    models = Models(lab, scene)
    def undisturbed():
        models.prepare()
        return models.apart, PUBLISHED if scene.variant == "published" else UNDISTURBED, models.shape, STARVED
    made = judge(scene.name, "undisturbed, against high-fidelity answers", undisturbed)
    if made[0].outcome == "same":
        made += [row for what, work in disturbed(models) for row in judge(scene.name, what, work)]
    shutil.rmtree(models.folder)
    return made
