"""Every scene and formulation of rbvi, for tests and benchmarks that cover them all."""

from dataclasses import dataclass, field
from pathlib import Path

CASES = Path(__file__).resolve().parents[1] / "cases"


@dataclass
class Formulation:
    name: str
    case: Path
    scene: list  # options of the scene: what high-fidelity answers depend on
    few: list | None  # options that make a small training set; None: it is not reduced
    mu: list  # parameters inside the box
    reduction: list = field(default_factory=list)  # options of the reduced model
    training: list = field(default_factory=list)  # where the training set of the scene does not fit


def membranes():
    mu = ["0.2,0,0", "0.17,0.03,-0.02", "0.23,-0.04,0.01"]
    for name, scene in (("membrane", []), ("membrane_graded", ["-disc_map", "graded"]),
                        ("membrane_consistent", ["-lumped", "no"]),
                        ("membrane_published", ["-variant", "published"]),
                        ("membrane_degree_2", ["-degree", "2", "-lumped", "no"])):
        yield Formulation(name, CASES / "membrane_obstacle/case.yaml", scene,
                          ["-train", "grid:3,3,3"], mu)
    yield Formulation("membrane_frame", CASES / "membrane_obstacle/case.yaml",
                      ["-parameters", "radius,frame_height,frame_tilt"], ["-train", "grid:3,3,3"],
                      ["0.2,0,0", "0.17,0.03,-0.2", "0.23,-0.04,0.3"])


def two_disks():
    mu, few = ["0.83", "1", "1.17"], ["-train", "grid:41"]
    for name, case, scene in (("two_disks", "cone", []), ("two_disks_p1", "cone", ["-multiplier", "p1"]),
                              ("two_disks_degree_1", "cone", ["-degree", "1"]),
                              ("two_disks_published", "published", []),
                              ("two_disks_p1_direct", "cone",
                               ["-degree", "1", "-multiplier", "p1", "-integration", "direct"])):
        yield Formulation(name, CASES / "two_disks/case.yaml",
                          ["-variant", case, *scene], few, mu)


def two_disks_condensed():
    yield Formulation("two_disks_condensed", CASES / "two_disks/case.yaml", [],
                      ["-train", "grid:21"], ["0.83", "1", "1.17"],
                      ["-multiplier_reduction", "condensed"])
    yield Formulation("two_disks_large", CASES / "two_disks/case.yaml", ["-variant", "large"], [],
                      ["0.83", "1", "1.17"])


def rigid_disks():
    case, mu, few = CASES / "rigid_disk/case.yaml", ["0.83", "1", "1.17"], ["-train", "grid:9"]
    for law in ("none", "tresca", "coulomb"):
        friction = ["-friction", law]
        yield Formulation(f"disk_{law}", case, friction, few, mu)
        for rule in ("empirical", "full", "interpolated"):
            yield Formulation(f"nitsche_{law}_{rule}", case, ["-formulation", "nitsche", *friction],
                              few, mu,
                              [] if rule == "empirical" else ["-nitsche_quadrature", rule])
    yield Formulation("disk_collocated", case, [], ["-train", "grid:31"], mu,
                      ["-multiplier_reduction", "collocated"])
    few_of_large = ["-train", "random:20:1"]
    for law in ("none", "coulomb"):
        yield Formulation(f"disk_large_{law}", case, ["-variant", "large", "-friction", law],
                          few_of_large, ["0.8,0.05,0", "1,0.1,0.08", "1.2,0.18,-0.05"])
    for law in ("none", "coulomb"):
        yield Formulation(f"nitsche_large_{law}", case,
                          ["-variant", "large_nitsche", "-friction", law, "-arc_edges", "100"],
                          few_of_large,
                          ["0.8,0.05", "1,0.1", "1.2,0.18"])
    yield Formulation("disk_lumped", case, ["-friction", "none", "-lumped", "yes"], few, mu)
    yield Formulation("disk_rigid_normal", case, ["-normal", "rigid"], few, mu)
    yield Formulation("disk_stiffness", case,
                      ["-parameters", "radius,core_stiffness,poisson_ratio"],
                      ["-train", "grid:3,3,3"], ["1,1,0.3", "0.9,0.5,0.25", "1.1,2,0.35"],
                      training=["-train", "grid:5,5,5"])


def rollers():
    case, mu, few = CASES / "roller/case.yaml", ["0.04,0", "0.025,-0.15", "0.045,0.1"], ["-train", "grid:5,5"]
    yield Formulation("roller", case, [], few, mu)
    yield Formulation("roller_cone", case, ["-friction", "none"], few, mu,
                      ["-multiplier_reduction", "cone"])
    yield Formulation("roller_nitsche", case, ["-formulation", "nitsche"], few, mu)


def patches():
    case, mu = CASES / "patch/case.yaml", ["0.02", "0.05"]
    few = ["-multiplier_reduction", "cone"]
    yield Formulation("patch_two", case, [], few, mu)
    yield Formulation("patch_two_degree_2", case, ["-degree", "2"], few, mu)
    yield Formulation("patch_one", case, ["-bodies", "one"], None, mu)
    yield Formulation("patch_nitsche", case,
                      ["-formulation", "nitsche", "-bodies", "one", "-degree", "2"], [], mu)


def parts():
    """Of many parameters, on coarse meshes that gmsh makes of geometries."""
    for name, edges, mu in (
            ("bolted_flange", 16, ["1500,0.15,1e6,5,0.2", "3000,0.05,8e5,6,0.3"]),
            ("seal", 24, ["0.6,0.2,0.3,0.45", "0.8,0.15,0.4,0.48"]),
            ("bracket", 12, ["6,300,0,0.2,4", "7,500,0.01,0.3,3"]),
            ("joint", 16, ["900,600,30,0.2,7000", "1000,300,20,0.3,9000"])):
        yield Formulation(name, CASES / name / "case.yaml", ["-set", f"mesh.set.edges={edges}"],
                          ["-train", "random:10:1"], mu)


def every_term():
    """One case on which every kind of term acts."""
    yield Formulation("every_term", CASES.parent / "tests/baseline/every_term.yaml", [],
                      ["-train", "random:30:1"], ["1.02,0.01,0.02,0.2,25,0.25", "0.97,-0.01,0.03,0.1,10,0.15"])


def every_scene():
    return [*membranes(), *two_disks(), *two_disks_condensed(), *rigid_disks(), *rollers(), *patches()]
