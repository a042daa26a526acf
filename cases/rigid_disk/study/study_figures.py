"""Figures of study.py."""

import sys
from functools import partial
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from figure_tools import BLUE, GREEN, GREY, ORANGE, PURPLE, history, in_length, read_grid, use_units
from panels import Curve, Drawn, Lines, legend_below, save_panels
from solution_figures import draw_mesh
from study_panels import along_size, level, over_disk, pale, published, room_of
from study_tools import rows_of, separation_errors, stored, table

import numpy as np

RADII = ("0.7", "1", "1.3")
FRICTION = 0.2
INITIAL_GAP = 0.001  # m, to the rigid disk of radius 1
SHOWN = 0.25  # of the arc: a little more than is ever in contact
SIZES = {"text": ("(30, 20, 20)", ORANGE), "published": ("published tolerances", BLUE)}
MODELS = {  # of the tangential stress
    "as published": ("(30, 20, 20), 20 pairs", ORANGE, "--"),
    "published": ("published tolerances", BLUE, "-"),
    "default": ("condensed", GREEN, "-"),
}
TINY = 1e-16


def contact_curve(path):
    """x, pressure and tangential stress, of the part that is shown."""
    curve = read_grid(path)
    shown = np.abs(curve.points[:, 0]) <= SHOWN
    return curve.points[shown, 0], *(curve.of_nodes[name][shown] for name in ("pressure", "tangential_stress"))


def laws(directory):
    """Multipliers at three radii, and Coulomb's law (figure 3.3)."""
    normal, tangential, law = [], [], []
    for radius, colour in zip(RADII, (BLUE, GREEN, ORANGE)):
        x, pressure, stress = contact_curve(directory / f"truth_{radius}_contact.vtu")
        normal.append(Curve(x, pressure, f"radius {radius} m", colour))
        tangential.append(Curve(x, stress, "", colour))
        law += [Curve(x, FRICTION * pressure, "", pale(colour), width=4),
                Curve(x, np.abs(stress), "", colour, width=1)]
    x = in_length("x")
    save_panels(directory, "laws.png", [
        Lines(r"normal multiplier", x, r"$\lambda_n$ (Pa)", normal),
        Lines(r"tangential multiplier", x, r"$\lambda_\tau$ (Pa)", tangential),
        Lines(r"Coulomb's law; pale: the bound $\nu_F\,\lambda_n$", x, r"$|\lambda_\tau|$ (Pa)", law)])


def bases(runs, directory):
    """Projection errors over the training set (figure 3.4)."""
    panels = []
    for run, name, title, xlabel, which, size, error in (
            ("text", "pod/error", "displacement, POD", "modes N", "", 30, 1e-6),
            ("generators", "normal_cone/error", r"$\lambda_n$, mCPG", "functions R", "largest ", 20, 1e-3),
            ("text", "tangential/error", r"$\lambda_\tau$, POD", "modes S", "", 20, 1e-4)):
        panels.append(Lines(title, xlabel, which + "relative error (-)", [
            along_size(history(runs["radius", run], name), least=1e-15), published(size, error)], log=True,
            floor=1e-15))
    save_panels(directory, "bases.png", panels)


def greedy(runs, directory):
    """Smallest beta and sigma along the supremizers (figure 3.5)."""
    beta, sigma = [], []
    for key, (name, colour) in SIZES.items():
        run = runs["radius", key]
        steps = table(run, "stability.csv")
        steps = steps[steps["beta_min"] > 1e-12]
        beta.append(Curve(steps["S"], steps["beta_min"], name, colour, ".-"))
        sigma.append(along_size(history(run, "pga/sigma"), name, colour, ".-", -1))
    tolerance = history(runs["radius", "published"], "pga/tolerance")[0]
    sigma += [level(tolerance, sigma, f"tolerance {tolerance:.3f}", "black", ":"),
              level(0.072, sigma, "tolerance published, 0.072", GREY, "--")]
    save_panels(directory, "pga.png", [
        Lines(r"smallest $\beta$; before: 0", "supremizers", "inf-sup constant (-)", beta, log=True),
        Lines(r"largest $\sigma$", "supremizers", r"$\sigma$ (-)", sigma)])


def interpolation(runs, directory):
    """Errors of the empirical interpolation of B^n, of B^tau and of the gap over the training and
    the validation set (figure 3.6)."""
    panels = []
    operators = {"radius": ("b", "b", "g"), "rigid": ("b_normal", "b_tangential", "g")}
    for place, title in enumerate(("$B^n$", r"$B^\tau$", "gap")):
        for count in (61, 150):
            curves = [] if title == "gap" else [published(41, 1e-3)]
            for variant, normal, colour in (("radius", "normal of the half-disk", BLUE),
                                            ("rigid", "normal of the rigid disk", ORANGE)):
                errors = separation_errors(runs[variant, f"grid {count}"], operators[variant][place])
                for error, style, which in zip(errors, ("-", "+"), ("training", "validation")):
                    curves.append(Curve(np.arange(len(error)), np.maximum(error, TINY), f"{normal}, {which}", colour,
                                        style))
            panels.append(Lines(f"{title}, {count} training radii", "terms", "largest relative error (-)", curves,
                                log=True, floor=TINY, ylimits=(TINY, 3)))
    save_panels(directory, "eim.png", panels, f"errors below {TINY:.0e} are drawn there")


def draw_nodes(run, _, axis):
    """The collocation nodes, and bands of the edges of contact and of stick at the training radii."""
    chosen, right = pairs_of(run)
    rows, handles = rows_of(run / "samples.csv"), []
    for column, shade, label in (("contact_half_width", GREY, "edge of contact"),
                                 ("stick_half_width", PURPLE, "edge of stick")):
        edges = np.sin([row[column] / row["radius"] for row in rows])
        handles.append(axis.axvspan(edges.min(), edges.max(), color=shade, alpha=0.25, linewidth=0, label=label))
    axis.plot(right, np.zeros_like(right), "|", color=GREY)
    handles += axis.plot(right[chosen], np.arange(1, len(chosen) + 1), "o", color=BLUE, label="chosen node")
    axis.set_xlabel("x at radius 1 (m)")
    axis.set_ylabel("step (number)")
    axis.locator_params(nbins=4)
    legend_below(axis, handles)


def pairs_of(run):
    """The pairs of nodes that were chosen, in their order, and x of the right one of each pair."""
    chosen, per_edge = stored(run, "law/basis/nodes"), stored(run, "interfaces/0/sizes")[3]
    vertices = len(stored(run, "interfaces/0/entities")) // per_edge + 1
    x = stored(run, "interfaces/0/points")[:vertices, 0]
    return chosen, x[::-1][:vertices // 2 + 1]  # of pair 0, 1, ...: mirror images


def nodes(runs, directory):
    """Where the collocation nodes are, and when each was taken (figure 3.7)."""
    panels = []
    for key, (name, _) in SIZES.items():
        chosen, right = pairs_of(runs["radius", key])
        panels.append(Drawn(f"{name}: {len(chosen)} of {len(right)} pairs",
                            partial(draw_nodes, runs["radius", key])))
    save_panels(directory, "nodes.png", panels)


def collocation(runs, directory):
    """Errors along the greedy selection of nodes (figure 3.8)."""
    error, violation = [published(20, 0.39)], [published(20, 1e-6)]
    for key, (name, colour) in SIZES.items():
        pairs = history(runs["radius", key], "gcns/nodes")
        for curves, column in ((error, "error"), (violation, "violation")):
            curves.append(Curve(pairs, history(runs["radius", key], "gcns/" + column), name, colour, ".-"))
    save_panels(directory, "gcns.png", [
        Lines(r"$e_{GCNS}$", "pairs of nodes", "largest relative error (-)", error, log=True),
        Lines("violation of the bound (3.63)", "pairs of nodes", "stress (Pa)", violation, log=True, floor=TINY)])


def tangential(study, runs, directory):
    """Reduced and high-fidelity tangential stress, and the difference (figure 3.9)."""
    panels = []
    for radius in RADII:
        x, _, truth = contact_curve(directory / f"truth_{radius}_contact.vtu")
        stresses, errors = [Curve(x, truth, "high-fidelity", pale(GREY), width=5)], []
        for key, (name, colour, style) in MODELS.items():
            path = directory / f"{key.replace(' ', '_')}_{radius}.vtu"
            study.call(runs["radius", key] / "model.h5", "--mu", radius, "--vtu", path,
                       program="rbvi-online")
            _, _, stress = contact_curve(path.with_name(path.stem + "_contact.vtu"))
            stresses.append(Curve(x, stress, name, colour, style, width=1.2))
            errors.append(Curve(x, np.maximum(np.abs(stress - truth), TINY), name, colour, style, width=1.2))
        panels += [Lines(f"radius {radius} m", in_length("x"), r"$\lambda_\tau$ (Pa)", stresses),
                   Lines(f"its error, radius {radius} m", in_length("x"), "size of the error (Pa)", errors, log=True,
                         floor=TINY, ylimits=(1e-14, 10))]
    save_panels(directory, "tangential.png", panels)


def draw_at_rest(path, centre, frame, _, axis):
    grid, angle = read_grid(path), np.linspace(0, np.pi, 200)
    draw_mesh(axis, grid.points[:, :2], grid, np.ptp(frame[0]))
    axis.fill(centre[0] + np.cos(angle), centre[1] + np.sin(angle), color=GREY, alpha=0.4, linewidth=0)
    axis.set(xlim=frame[0], ylim=frame[1], aspect="equal", xlabel=in_length("x"), ylabel=in_length("y"))
    axis.grid(False)
    axis.locator_params(nbins=4)


def configurations(directory, radius="0.7"):
    """The body at rest, and deformed by the full and by the reduced answer (figure 3.2)."""
    centre, frame = (0, -float(radius) - INITIAL_GAP - 1), ((-0.8, 0.8), (-1, 0.05))
    paths = {name: directory / f"{name}_{radius}.vtu" for name in ("truth", "published")}
    save_panels(directory, "configurations.png", [
        Drawn("at rest", partial(draw_at_rest, paths["truth"], centre, frame),
              ratio=room_of(frame)),
        over_disk("high-fidelity", paths["truth"], centre, frame),
        over_disk("reduced, published tolerances", paths["published"], centre, frame)], f"radius {radius} m")


def draw_all(study, runs, directory):
    use_units(next(iter(runs.values())))
    directory.mkdir(exist_ok=True)
    for radius in RADII:
        study.call("solve", "-case", *study.case, "-mu", radius, "-vtu",
                   directory / f"truth_{radius}.vtu")
    laws(directory)
    bases(runs, directory)
    greedy(runs, directory)
    interpolation(runs, directory)
    nodes(runs, directory)
    collocation(runs, directory)
    tangential(study, runs, directory)
    configurations(directory)
