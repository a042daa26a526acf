"""Every scene, formulation and reduction on small meshes, for the stress table."""

import sys
from dataclasses import dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from every_scene import CASES


COARSE = {"membrane_obstacle": {"mesh.edges": "24"}, "two_disks": {"mesh.edges": "40"},
          "rigid_disk": {"mesh.edges": "40"}, "roller": {"mesh.edges": "24"}, "patch": {},
          "seal": {"mesh.set.edges": "24"}, "bracket": {"mesh.set.edges": "12"},
          "joint": {"mesh.set.edges": "16"}, "bolted_flange": {"mesh.set.edges": "16"}}


@dataclass
class Scene:
    name: str
    case: str
    choices: dict = field(default_factory=dict)  # of the case file
    variant: str | None = None
    mesh: dict = field(default_factory=dict)  # values at paths that make the mesh small
    free: tuple = ()  # parameters; () those of the case
    reduction: tuple = ()  # options

    def path(self):
        return CASES / self.case / "case.yaml"


def scenes():
    for scene in (*membranes(), *two_disks(), *rigid_disks(), *others()):
        scene.mesh = COARSE[scene.case]
        yield scene


def reduced(name, *more):
    return ("-multiplier_reduction", name, *more)


def membranes():
    case = "membrane_obstacle"
    for cone in ("hybrid", "cpg", "mcpg", "angle_greedy", "nmf", "nodal"):
        yield Scene(f"membrane {cone}", case, reduction=("-cone_type", cone))
    for enrichment in ("online", "decorrelated"):
        yield Scene(f"membrane {enrichment}", case, reduction=("-pga_enrichment", enrichment))
    yield Scene("membrane graded", case, {"disc_map": "graded"})
    yield Scene("membrane consistent mcpg", case, {"lumped": "no"}, reduction=("-cone_type", "mcpg"))
    yield Scene("membrane degree 2", case, {"lumped": "no", "degree": "2"})
    yield Scene("membrane published", case, variant="published")
    yield Scene("membrane frame", case, free=("radius", "frame_height", "frame_tilt"))


def two_disks():
    case = "two_disks"
    yield Scene("two disks condensed", case, reduction=reduced("condensed"))
    yield Scene("two disks p1 condensed", case, {"multiplier": "p1"}, reduction=reduced("condensed"))
    yield Scene("two disks cone", case, reduction=reduced("cone"))
    yield Scene("two disks collocated", case, reduction=reduced("collocated"))
    yield Scene("two disks direct cone", case, {"integration": "direct", "multiplier": "p1", "degree": "1"},
                reduction=reduced("cone", "-cone_type", "mcpg"))
    yield Scene("two disks published", case, variant="published")
    yield Scene("two disks large", case, variant="large")


def rigid_disks():
    case = "rigid_disk"
    for law in ("none", "tresca", "coulomb"):
        yield Scene(f"disk {law} condensed", case, {"friction": law})
        yield Scene(f"disk {law} collocated", case, {"friction": law}, reduction=reduced("collocated"))
        for rule in ("empirical", "full", "interpolated"):
            yield Scene(f"disk {law} nitsche {rule}", case, {"friction": law, "formulation": "nitsche"},
                        reduction=("-nitsche_quadrature", rule))
    yield Scene("disk none cone", case, {"friction": "none"}, reduction=reduced("cone"))
    yield Scene("disk stiffness condensed", case, free=("radius", "core_stiffness", "poisson_ratio"))
    for law in ("none", "coulomb"):
        yield Scene(f"disk large {law} condensed", case, {"friction": law}, "large")
        yield Scene(f"disk large {law} nitsche", case, {"friction": law}, "large_nitsche")
    yield Scene("disk large none cone", case, {}, "large", reduction=reduced("cone"))
    for variant in ("published", "published_large", "nitsche_published"):
        yield Scene(f"disk {variant}", case, variant=variant)


def others():
    yield Scene("patch two cone", "patch", reduction=reduced("cone"))
    yield Scene("patch two condensed", "patch", reduction=reduced("condensed"))
    one = {"bodies": "one"}
    yield Scene("patch one condensed", "patch", one, free=("indentation", "shear"))
    yield Scene("patch one collocated", "patch", one, free=("indentation", "shear"), reduction=reduced("collocated"))
    yield Scene("patch one nitsche", "patch", {**one, "formulation": "nitsche", "degree": "2"})
    yield Scene("roller condensed", "roller")
    yield Scene("roller none cone", "roller", {"friction": "none"}, reduction=reduced("cone"))
    yield Scene("roller collocated", "roller", reduction=reduced("collocated"))
    yield Scene("roller nitsche", "roller", {"formulation": "nitsche"})
    for case in ("seal", "bracket", "joint", "bolted_flange"):
        yield Scene(f"{case} condensed", case, reduction=reduced("condensed"))
        yield Scene(f"{case} collocated", case, reduction=reduced("collocated"))
    yield Scene("bracket guided condensed", "bracket", variant="guided")
    yield Scene("joint tightening condensed", "joint", variant="tightening")
