"""Rows of the stress table about high-fidelity answers: geometry, materials, gaps, friction, Nitsche's gamma.

Each answer is compared with one that is found in another way: by elimination in place of the condensed
problem (where that refuses by Uzawa's method), at large deformations by another iteration, by Nitsche's method
with multipliers."""

import case_tree
from lab import ENERGY, FORCES, Refused, deviation, judge, shape_deviation
from scenes import COARSE, Scene

RATIO = "1e-3"  # of the heights of cells to their widths, times those of the mesh
MIXED, CONTRAST = 0.01, 0.1  # how far Nitsche's method and multipliers may be apart on these meshes, with two materials
RANKS, KRYLOV = 1e-9, 1e-7  # two ranks against one, iterative solvers against factors
# Meshes on which they are: on 24 edges displacements of the roller are 0.026 apart, on 48 edges 0.008.
FINE = {"rigid_disk": {"mesh.edges": "80"}, "roller": {"mesh.edges": "48"}}
FREED = {"patch one": {"motion": "", "imposed.top": ""}, "disk": {"imposed.flat side": ""}}  # what contact alone holds
BASE = {"membrane_obstacle": "radius=0.2,center_x=0.01,center_y=-0.02", "two_disks": "radius=0.9",
        "rigid_disk": "radius=0.9", "patch": "indentation=0.05", "roller": "top=0.04,tilt=0.05",
        "seal": "squeeze=0.6,friction=0.2,fluid=0.3,poisson_ratio=0.45",
        "bracket": "radius=6,pad_modulus=300,height=0,friction=0.2,push=4",
        "joint": "pretension=900,pull=600,shear=30,friction=0.2,stiffness=7000",
        "bolted_flange": "gasket_modulus=1500,friction=0.15,bolt_force=1e6,gas=5,clearance=0.2"}

# (what, values at paths, parameters) of each case. FREE takes away the limits of all parameters first.
FREE = "FREE"
NO_LIMITS = {FREE: ""}
DISK = "contact.support.against.disk.center"


def flat(tree):
    """The map with heights RATIO times as large, and planes at heights, too."""
    way = tree.get("map", ["x", "y"])
    if isinstance(way, dict):
        way = [f"({way['scale']})*x", f"({way['scale']})*y"]
    tree["map"] = [way[0], f"{RATIO}*({way[1]})"]
    for one in tree["contact"].values():
        plane = one["against"].get("plane") if isinstance(one.get("against"), dict) else None
        if plane and plane["normal"][0] == "0":
            plane["position"] = f"{RATIO}*({plane['position']})"


def extremes(case):
    """(what, values at paths, parameters): what is done to the tree of a case."""
    heights = {"flat": ""}
    if case == "membrane_obstacle":
        obstacle = "-1.25 * ((x - center_x)^2 + (y - center_y)^2) / radius^2"
        squeezed = obstacle.replace("(y - center_y)", f"(y/{RATIO} - center_y)")
        yield "cells of aspect ratio 1e3", {**heights, **NO_LIMITS, "contact.obstacle.above": squeezed,
                                            "parameters.load.default": "-25e6"}, ""
        for lower in ("1", "1e6"):
            yield f"no contact: obstacle {lower} below", {"contact.obstacle.above": f"{obstacle} - {lower}"}, ""
        yield "full contact: load -1e6", {"parameters.load.default": "-1e6"}, ""
        yield "touching: no load", {"parameters.load.default": "0"}, ""
        yield "a load of 1e-12", {"parameters.load.default": "-1e-12"}, ""
        yield "obstacle 0.5 above the frame", {"contact.obstacle.above": f"{obstacle} + 0.5"}, ""
    elif case == "two_disks":
        yield "cells of aspect ratio 1e3", {**heights, **NO_LIMITS}, "indentation=1e-5,initial_gap=1e-6"
        yield from stiffness("materials.rubber.E", "young * (y > 0 ? 1 : {})")
        yield from ratios("poisson_ratio")
        for gap in ("0", "-0.01", "1"):
            yield f"gap {gap}", {}, f"initial_gap={gap}"
        yield "gap 1e6", NO_LIMITS, "initial_gap=1e6"
        yield "touching: gap 0, indentation 0", NO_LIMITS, "initial_gap=0,indentation=0"
        yield "touching: gap 0.1, indentation 0.05", NO_LIMITS, "initial_gap=0.1,indentation=0.05"
        yield "full contact: indentation 0.18", {**NO_LIMITS}, "indentation=0.18"
    elif case == "rigid_disk":
        yield "cells of aspect ratio 1e3", {**heights, **NO_LIMITS, "require": "",
            DISK: ["offset", f"-{RATIO}*radius - 1"]}, "indentation=1e-4"
        yield from stiffness("materials.rubber.E", "young * (hypot(x, y) < 0.6 ? {} : 1)")
        yield from ratios("poisson_ratio")
        for gap in ("0", "-0.01", "0.5", "1e6"):
            yield f"gap {gap}", {"let.initial_gap": gap}, ""
        yield "touching: gap 0, indentation 0", {"let.initial_gap": "0", **NO_LIMITS}, "indentation=0"
        yield "touching: gap and indentation 0.05", {"let.initial_gap": "0.05"}, "indentation=0.05"
        yield "full contact: indentation 0.3", {**NO_LIMITS, "require": ""}, "indentation=0.3"
    elif case == "patch":
        yield "cells of aspect ratio 1e3", {**heights, **NO_LIMITS}, "indentation=5e-5"
        yield from stiffness("materials.rubber.E", "young * (y > 0.25 ? {} : 1)")
        yield from ratios("poisson_ratio")
        yield "touching: indentation 0", NO_LIMITS, "indentation=0"
        yield "no contact: lifted by 0.05", NO_LIMITS, "indentation=-0.05"
        yield "an indentation of 1e-12", NO_LIMITS, "indentation=1e-12"
    elif case == "roller":
        yield "cells of aspect ratio 1e3", {**heights, **NO_LIMITS}, "top=4e-5,tilt=0,bottom=3e-5"
        yield from stiffness("materials.rubber.E", "young * (x > 0 ? {} : 1)")
        yield from ratios("poisson_ratio")
        yield "touching: both plates", {}, "top=0,tilt=0,bottom=0"
        yield "no contact: gaps 0.1", {}, "top=-0.1,tilt=0,bottom=-0.1"
        yield "no contact: gaps 1e6", NO_LIMITS, "top=-1e6,tilt=0,bottom=-1e6"
        yield "full contact: pushed in by 0.35", NO_LIMITS, "top=0.35,tilt=0,bottom=0.35"
    elif case == "seal":
        yield "cells of aspect ratio 1e3", heights, "squeeze=0.5e-3,fluid=1e-6"
        yield from stiffness("materials.rubber.E", "6 * (x > R ? {} : 1)")
        yield from ratios("poisson_ratio")
        yield "touching: no squeeze, no fluid", {}, "squeeze=0,fluid=0"
        yield "no contact of the lid: 1 above", {}, "squeeze=-1"
        yield "no contact of the lid: 1e6 above", {}, "squeeze=-1e6"
        yield "squeeze 4 of 5.33", {}, "squeeze=4"
    elif case == "bracket":
        yield "cells of aspect ratio 1e3", heights, "push=4e-9"
        yield from stiffness("materials.pad.E", "70000 * {}")
        yield "Poisson's ratio 0.4999", {"materials.pad.nu": "0.4999"}, ""
        yield "touching: no load", {}, "push=0"
        yield "no contact: floor 1e6 below", {}, "height=-1e6"
        yield "no contact: lifted", {}, "push=-4"
        yield "full contact: floor 5 above", {}, "height=5"
    elif case == "joint":
        yield "cells of aspect ratio 1e3", heights, ""
        yield from stiffness("materials.steel.E", "210000 * (y > 0 ? {} : 1)")
        yield "Poisson's ratio 0.4999", {"materials.steel.nu": "0.4999"}, ""
        yield "touching: no load at all", {}, "pretension=0,pull=0,shear=0"
        yield "no contact: pulled apart by 1e5", {}, "pull=1e5,shear=0"
        yield "full contact: pretension 1e6", {}, "pretension=1e6"
    else:
        yield "cells of aspect ratio 1e3", heights, ""
        yield from stiffness("materials.gasket.E", "200000 * {}")
        yield "Poisson's ratio 0.4999", {"materials.steel.nu": "0.4999", "materials.gasket.nu": "0.4999"}, ""
        yield "touching: no load", {}, "bolt_force=0,gas=0"
        yield "no contact: the gas opens the joint", {}, "bolt_force=1e5,gas=80"
        for clearance in ("0", "1e6", "-0.1"):
            yield f"clearance {clearance}", {}, f"clearance={clearance}"


def stiffness(path, text):
    for contrast in ("1e6", "1e-6"):
        yield f"contrast of moduli {contrast}", {path: text.format(contrast)}, ""


def ratios(name):
    yield "Poisson's ratio 0.4999", NO_LIMITS, f"{name}=0.4999"
    yield "Poisson's ratio beyond the limits of the case", {f"-{name}": "0.4999"}, ""
    yield "Poisson's ratio -0.99", NO_LIMITS, f"{name}=-0.99"
    yield "Poisson's ratio 0.5", NO_LIMITS, f"{name}=0.5"


def solved():
    """Scenes of which answers are looked at."""
    yield Scene("membrane", "membrane_obstacle")
    yield Scene("membrane consistent", "membrane_obstacle", {"lumped": "no"})
    yield Scene("membrane degree 2", "membrane_obstacle", {"lumped": "no", "degree": "2"})
    yield Scene("two disks", "two_disks")
    yield Scene("two disks p1", "two_disks", {"multiplier": "p1"})
    yield Scene("two disks large", "two_disks", variant="large")
    for law in ("none", "tresca", "coulomb"):
        yield Scene(f"disk {law}", "rigid_disk", {"friction": law})
        yield Scene(f"disk {law} nitsche", "rigid_disk", {"friction": law, "formulation": "nitsche"})
    for law in ("none", "coulomb"):
        yield Scene(f"disk large {law}", "rigid_disk", {"friction": law}, "large")
        yield Scene(f"disk large {law} nitsche", "rigid_disk", {"friction": law}, "large_nitsche")
    yield Scene("patch two", "patch")
    yield Scene("patch one", "patch", {"bodies": "one"})
    yield Scene("patch one nitsche", "patch", {"bodies": "one", "formulation": "nitsche", "degree": "2"})
    yield Scene("roller", "roller")
    yield Scene("roller nitsche", "roller", {"formulation": "nitsche"})
    for case in ("seal", "bracket", "joint", "bolted_flange"):
        yield Scene(case, case)
    yield Scene("bracket guided", "bracket", variant="guided")
    yield Scene("joint tightening", "joint", variant="tightening")


FRICTION = {"rigid_disk": "friction_coefficient", "roller": "friction_coefficient", "patch": "friction_coefficient",
            "seal": "friction", "bracket": "friction", "joint": "friction", "bolted_flange": "friction"}


class Answers:
    """Answers of one scene, disturbed, found in two ways."""

    def __init__(self, lab, scene):
        self.lab, self.scene = lab, scene
        self.nitsche = "nitsche" in scene.name
        scene.mesh = FINE.get(scene.case, COARSE[scene.case]) if self.nitsche else COARSE[scene.case]
        self.large = "large" in scene.name
        # How far off the tangential force is by Nitsche's method its answers say: law_error_tangential.
        self.of = (ENERGY, "normal_force", "reaction") if self.nitsche else (ENERGY, *FORCES)

    def tree(self, **choices):
        tree = case_tree.load(self.scene.path(), self.scene.variant, **{**self.scene.choices, **choices})
        for where, value in self.scene.mesh.items():
            case_tree.put(tree, where, value)
        if self.scene.case == "rigid_disk":  # the same by Nitsche's method and with multipliers
            tree["parameters"]["friction_coefficient"]["default"] = "0.1"
        return tree

    def answer(self, edits, mu, *options, residual=1e-6, ranks=1, **choices):
        tree = self.tree(**choices)
        for where, value in edits.items():
            if where == FREE:
                for parameter in tree["parameters"].values():
                    parameter.pop("limits", None)
            elif where == "flat":
                flat(tree)
            elif where.startswith("-"):
                options = (*options, where, value)
            else:
                case_tree.put(tree, where, value)
        base = dict(part.split("=") for part in BASE[self.scene.case].split(","))
        given = {name: value for name, value in base.items() if name in tree.get("free", base)}
        given |= dict(part.split("=") for part in mu.split(",") if part)
        for name, value in given.items():  # the range holds what is asked
            number = float(value)
            ends = sorted((number, number * (1 - 1e-3) if number else 1e-30))
            tree["parameters"][name]["range"] = [repr(end) for end in ends]
            tree["parameters"][name]["default"] = value
            tree["parameters"][name].pop("spacing", None)
        tree["free"] = list(given)
        tree.pop("outputs", None)
        case = case_tree.save(tree, self.lab.work / "case.yaml")
        mu = ",".join(f"{name}={value}" for name, value in given.items())
        return self.lab.solve(case, mu, *options, residual=residual, ranks=ranks)

    def two_ways(self, edits, mu, *always):
        """Found in this way and in another."""
        first, said = self.answer(edits, mu, *always), None
        for tolerance, options, choices in self.other_ways(any(where.startswith("materials") for where in edits)):
            # Uzawa's method stops where its steps are small: its residual says how far it has come.
            residual = 1e-5 if "uzawa" in options else 1e-6
            try:
                second = self.answer(edits, mu, *always, *options, residual=residual, **choices)
                return (deviation([second], [first], of=self.of, residual=residual), tolerance,
                        shape_deviation([second], [first], ("u",) if self.nitsche else None),
                        10 * tolerance if "uzawa" in options else tolerance)
            except Refused as refused:
                said = f"no other way: {refused}"
        raise Refused(said)

    def other_ways(self, contrast):
        if self.nitsche:
            return [(CONTRAST if contrast else MIXED, (), {"formulation": "mixed"})]
        if self.large:
            return [(1e-6, ("-nonlinear_method", "kacanov", "-nonlinear_max_steps", "1000"), {})]
        return [(1e-6, ("-hf_contact", "eliminated"), {}),
                (1e-4, ("-hf_method", "uzawa", "-uzawa_accelerated", "yes", "-uzawa_tolerance", "1e-9"), {})]

    def rows(self):
        for what, edits, mu in (("undisturbed", {}, ""), *extremes(self.scene.case), *self.of_friction(),
                                *self.of_gamma(), *self.held_by_contact()):
            yield from judge(self.scene.name, what, lambda e=edits, m=mu: self.two_ways(e, m))
        yield from judge(self.scene.name, "refined once", lambda: self.two_ways({}, "", "-mesh_refine", "1"))
        yield from judge(self.scene.name, "two ranks against one", lambda: self.against_itself(RANKS, ranks=2))
        krylov = ("-nitsche_ksp_rtol", "1e-9") if self.nitsche else ("-hf_ksp_type", "cg", "-hf_pc_type", "gamg")
        yield from judge(self.scene.name, "conjugate gradients" + ("" if self.nitsche else ", multigrid"),
                         lambda: self.against_itself(KRYLOV, *krylov))

    def against_itself(self, tolerance, *options, **how):
        """Solved by other ranks or another linear solver."""
        first, second = self.answer({}, ""), self.answer({}, "", *options, **how)
        return deviation([second], [first]), tolerance, shape_deviation([second], [first]), 10 * tolerance

    def held_by_contact(self):
        """Bodies that lie there, by their weight; pushed by less than friction can hold, and by more."""
        freed = next((edits for name, edits in FREED.items() if self.scene.name.startswith(name)), None)
        if freed is None or self.nitsche or self.large:
            return
        for what, push in (("", "0"), (", pushed by 0.04 of its weight", "0.04"),
                           (", pushed by twice its weight", "2")):
            loads = {"top": {"at": "top", "traction": [f"{push}*10*indentation", "-10*indentation"]}}
            yield f"held by contact alone{what}", {**freed, "loads": loads}, ""

    def of_friction(self):
        name = FRICTION.get(self.scene.case)
        contacts = self.tree()["contact"].values()
        if not any(one.get("friction") for one in contacts):
            return
        if any("tresca" in one.get("friction", {}) for one in contacts):
            for value in ("0", "1e-12", "0.01", "1", "10"):
                yield f"threshold of friction {value}", NO_LIMITS, f"friction_threshold={value}"
            return
        for value in ("0", "1e-12", "0.5", "1", "2", "5", "10"):
            yield f"coefficient of friction {value}", {}, f"{name}={value}"

    def of_gamma(self):
        if not self.nitsche:
            return
        for value in ("0.2", "2", "20", "200", "2000"):
            yield (f"nitsche_gamma0 {value}",
                   {f"contact.{name}.nitsche_gamma0": value for name in self.tree()["contact"]}, "")


def rows(lab, scene):
    return Answers(lab, scene).rows()
