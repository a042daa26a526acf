#!/usr/bin/env python3
"""formulas.py: the closed forms of the cases beside this file, each found a second time by numbers.

Every expected value is that of the expression in case.yaml; beside it stands what quadrature, a linear
system or a root of the governing equation gives. Needs python3-scipy and python3-yaml. The exit status
is 1 where one differs by more than 1e-6.
"""

import sys
from math import acosh, cos, log, pi, radians, sin, sqrt, tanh
from pathlib import Path

import numpy as np
import yaml
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq
from scipy.special import ellipk

HERE = Path(__file__).resolve().parent


def expected(case, test):
    """Values that case.yaml expects, by output."""
    node = yaml.safe_load((HERE / case / "case.yaml").read_text())["tests"][test]
    names = {"pi": pi, "cos": cos, "sin": sin, "sqrt": sqrt, "log": log, "tanh": tanh}
    return {name: eval(str(value).replace("^", "**"), {"__builtins__": {}}, names)  # pylint: disable=eval-used
            for name, value in node["expect"].items()}


def slope_of(pressure, a, x):
    """Slope of a half-plane of E* = 1 at |x| < a: (2/pi) PV int p(s)/(x - s) ds; p is even, and is
    subtracted at x. (Johnson 1985, 2.25b.)"""
    regular = quad(lambda s: (pressure(s) - pressure(x)) / (x - s), -a, a, points=[-x, 0, x], limit=400)[0]
    return 2 / pi * (regular + pressure(x) * log((a + x) / (a - x)))


def sink(pressure, a, r):
    """Displacement of a half-space of E* = 1 at r < a: rings of load, (4/pi) int p s/(r + s) K(m) ds."""
    def ring(s):
        return pressure(s) * s / (r + s) * ellipk(4 * r * s / (r + s)**2)
    return 4 / pi * quad(ring, 0, a, points=[r] if r else None, limit=400)[0]


def balance(case, test, angle, weight):
    """Pressure, friction and moment of pressure from the equations of forces and moments."""
    t = radians(angle)
    system = np.array([[1, 0, 0], [0, 1, 0], [0, 0.25, 1]])  # about the middle of the body
    normal, along, moment = np.linalg.solve(system, [weight * cos(t), -weight * sin(t), 0])
    return case, test, {"normal_force": normal, "horizontal_reaction": along, "moment": moment}


def column(stiffness, height, strain, play, weight):
    """Force on the floor: the root at which the lower end of a bar of unit width has sunk by its play."""
    def sunk(force):
        return quad(lambda y: strain + (weight * y - force) / stiffness, 0, height)[0] - play
    return brentq(sunk, 0, 1e6)


def string(height):
    """Force on a string of width 0.1: its tangent from the end to the parabola."""
    at = brentq(lambda a: height - a**2 - 2 * a * (0.5 - a), 1e-9, 0.499)
    energy = quad(lambda s: 2 * s**2, -at, at)[0] + (2 * at)**2 * (0.5 - at)
    return {"normal_force": 0.1 * 4 * at}, {"energy": 0.1 * energy}


def membrane(height):
    """Force and energy of a round membrane: contact to a, beyond it a logarithm."""
    a = brentq(lambda a: height - a**2 + 2 * a**2 * log(a), 1e-6, 0.99)
    energy = quad(lambda r: pi * r * 4 * r**2, 0, a)[0] + quad(lambda r: pi * r * (2 * a**2 / r)**2, a, 1)[0]
    return {"normal_force": 4 * pi * a**2, "energy": energy}, {"contact_measure": pi * a**2}


def round_membrane(force, a, height):
    """Force, energy and contact of a round membrane on a flat obstacle from the radius a on, by a given
    force per area: the slope at r is what the loads between a and r pull, over r. And how far it is off
    `height` at the rim."""
    def slope(r):
        return -quad(lambda s: s * force(s), a, r)[0] / r if r > a else 0
    def shape(r):
        return quad(slope, a, r)[0] if r > a else 0
    work = quad(lambda r: pi * r * (slope(r)**2 - 2 * force(r) * shape(r)), 0, 1, points=[a])[0]
    pressed = -quad(lambda r: 2 * pi * r * force(r), 0, a)[0]
    return {"normal_force": pressed, "energy": work}, {"contact_measure": pi * a**2}, shape(1) - height


def ceiling(load, height):
    """The membrane under a ceiling, turned upside down and moved by the height, so that the rim is lifted."""
    def of(a):
        return round_membrane(lambda r: -load, a, height)
    a = brentq(lambda a: of(a)[2], 0.05, 0.95)
    forces, contact, _ = of(a)
    forces["energy"] -= load * pi * height  # of the load, on its way to the ceiling
    return forces, contact


def floor(a):
    """The membrane on a floor: the radius at which contact ends, from the height of the rim."""
    def load(r):
        return -8 * a**2 * (1 + a**2 - r**2) if r < a else 8 * a**2 - 16 * r**2
    at = brentq(lambda end: round_membrane(load, end, (1 - a**2)**2)[2], 0.3, 0.95)
    forces, contact, _ = round_membrane(load, at, 0)
    return forces, contact


def bed(height):
    """A string of width 0.1 on a bed of stiffness pi^2, by shooting from the end of contact to where it is held."""
    def free(a):
        return solve_ivp(lambda x, v: [v[1], pi**2 * v[0]], (a, 1), [height - a**2, -2 * a], rtol=1e-12, atol=1e-13,
                         dense_output=True)
    a = brentq(lambda a: free(a).y[0, -1], 0.05, 0.95, xtol=1e-13)
    beyond = free(a).sol
    energy = quad(lambda x: (2 * x)**2 + pi**2 * (height - x**2)**2, 0, a)[0]
    energy += quad(lambda x: beyond(x)[1]**2 + pi**2 * beyond(x)[0]**2, a, 1)[0]
    force = quad(lambda x: 2 + pi**2 * (height - x**2), 0, a)[0]
    return {"normal_force": 0.1 * force, "energy": 0.1 * energy / 2}, {}


def rings(delta):
    """Pressure of a shrink fit: u = A r + B/r of each ring of E = 1, nu = 0.3, from the four conditions."""
    up, down = 1 / 0.7, 1 / 1.3  # sigma_r = up A - down B/r^2
    rows = [[up, -down, 0, 0], [0, 0, up, -down / 9], [up, -down / 4, -up, down / 4], [-2, -0.5, 2, 0.5]]
    _, _, a, b = np.linalg.solve(np.array(rows), [0, 0, 0, delta])
    return -(up * a - down * b / 4), up * a + down * b / 9


def beam(load, play):
    """Force on the stop: unit loads, M = q s^2/2 - R s at the distance s from the end."""
    stiffness = 1 / 12
    free = quad(lambda s: load * s**2 / 2 * s / stiffness, 0, 20)[0]
    unit = quad(lambda s: s * s / stiffness, 0, 20)[0]
    return max(0, (free - play) / unit), free


def hertz_line(force):
    """p0 (1 - (x/a)^2)^(1/2) has the slope x/R of the circle and this force, for the case's a."""
    a, peak = 2 * sqrt(force / pi), sqrt(force / pi)
    def pressure(x):
        return peak * sqrt(max(0, 1 - (x / a)**2))
    slopes = [slope_of(pressure, a, t * a) / (t * a) for t in (0.2, 0.5, 0.8)]  # of the surface, downwards
    found = quad(pressure, -a, a)[0] / force
    return {"width": 2 * a * found, "peak_pressure": peak * np.mean(slopes)}


def partial_slip(force, share):
    """Cattaneo's shear stress has this sum, and moves all of the stick zone alike; R = 1000."""
    a = 2 * sqrt(1000 * force / pi)
    c = a * sqrt(1 - share)
    def shear(x):
        outer = sqrt(max(0, 1 - (x / a)**2))
        return 0.3 * a / 2000 * (outer - c / a * sqrt(max(0, 1 - (x / c)**2)))
    total = quad(shear, -a, a, points=[-c, c])[0]
    outer = slope_of(lambda x: sqrt(max(0, 1 - (x / a)**2)), a, c / 2)
    inner = slope_of(lambda x: c / a * sqrt(max(0, 1 - (x / c)**2)), c, c / 2)
    return {"stick": 2 * c * total / (0.3 * force * share) * outer / inner}


def hertz_point(a):
    """2 a/pi (1 - (r/a)^2)^(1/2) sinks by r^2/2 less than in the middle."""
    def pressure(r):
        return 2 * a / pi * sqrt(max(0, 1 - (r / a)**2))
    shape = (sink(pressure, a, 0) - sink(pressure, a, 0.6 * a)) / ((0.6 * a)**2 / 2)
    return {"area": pi * a**2, "peak_pressure": 2 / pi * a * shape}


def cone():
    """arccosh(1/r)/2 times the slope 0.01 sinks by 0.01 r less than in the middle."""
    def pressure(r):
        return 0.005 * acosh(1 / max(r, 1e-300)) if r < 1 else 0
    shape = (sink(pressure, 1, 0.2) - sink(pressure, 1, 0.7)) / (0.01 * 0.5)
    force = quad(lambda r: 2 * pi * r * pressure(r), 0, 1)[0]
    inner = quad(lambda r: 2 * pi * r * pressure(r), 0, 0.5)[0]
    return {"area": pi * force / (0.005 * pi) * shape, "inner": inner}


def wedge():
    """arccosh(1/x)/pi times the slope 0.01 has that slope."""
    def pressure(x):
        return 0.01 / pi * acosh(1 / max(abs(x), 1e-300)) if abs(x) < 1 else 0
    force = 2 * quad(pressure, 0, 1)[0]
    return {"width": 2 * force / 0.01 * slope_of(pressure, 1, 0.4) / 0.01, "inner": 2 * quad(pressure, 0, 0.5)[0]}


def torsion(twist):
    """Moment of the shear stress, twist r up to 1."""
    return {"torque": quad(lambda r: 2 * pi * r**2 * min(1, twist * r), 0, 1, points=[1 / twist])[0]}


def bolted(pretension, pull, stiffness):
    """Forces of bolt and block from their springs: bolt - block = pull, one displacement."""
    system = np.array([[1, -1, 0], [1, 0, -stiffness], [0, 1, 200]])
    bolt, block, _ = np.linalg.solve(system, [pull, pretension, pretension])
    return {"bolt force": max(bolt, pull), "normal_force": max(block, 0)}


def values():
    """Rows (case, test, outputs) found by numbers."""
    yield balance("incline", "shallow", 10, 1)
    yield balance("incline", "steep", 20, 2)
    yield "hanging_bar", "stopped", {"normal_force": column(100, 0.5, 0, 0.02, 20)}
    yield "hanging_bar", "touching", {"normal_force": column(100, 0.5, 0, 0, 40)}
    yield "heated_block", "stopped", {"normal_force": column(240000, 0.5, heat_strain(100), 0.0002, 0)}
    yield "heated_block", "free", {"growth": 0.5 * heat_strain(40)}
    for test, at in (("tightened", (2, 0, 50)), ("pulled", (2, 1, 50)), ("stiff", (3, 4, 80)), ("apart", (1, 4, 20))):
        yield "bolted_block", test, bolted(*at)
    for test, height in (("low", 0.09), ("middle", 0.16), ("high", 0.24)):
        yield "string", test, string(height)[0]
    yield "string", "energy", string(0.16)[1]
    forces, contact = membrane(0.25 * (1 + 2 * log(2)))
    yield "membrane_disk", "forces", forces
    yield "membrane_disk", "contact", contact
    for case, (forces, contact) in (("membrane_under_ceiling", ceiling(4, 0.75 - 0.5 * log(2))),
                                    ("membrane_on_floor", floor(0.5)),
                                    ("string_on_bed", bed(0.25 + tanh(pi / 2) / pi))):
        yield case, "forces", forces
        if contact:
            yield case, "contact", contact
    for test, twist in (("elastic", 1), ("half", 2), ("most", 4)):
        yield "torsion", test, torsion(twist)
    for test, force in (("light", 0.0025), ("heavy", 0.01)):
        yield "hertz_line", test, hertz_line(force)
    yield "partial_slip", "half", partial_slip(pi / 4000, 0.5)
    yield "partial_slip", "most", partial_slip(pi / 4000, 0.75)
    line = hertz_line(pi / 4)  # of R = 1: a = 1
    yield "partial_slip", "pressure", {"width": line["width"], "peak_pressure": line["peak_pressure"] / 1000}
    for test, a in (("light", 0.05), ("heavy", 0.1)):
        yield "hertz_point", test, hertz_point(a)
    yield "cone", "unit", cone()
    yield "wedge", "unit", wedge()
    pressure, hoop = rings(0.004)
    yield "shrink_fit", "forces", {"pressure at seat": pressure, "normal_force": 2 * pi * 2 * 0.5 * pressure}
    yield "shrink_fit", "points", {"peak_pressure": pressure, "hoop outside": hoop}
    for test, at in (("stopped", (1e-6, 0.05)), ("heavy", (1.5e-6, 0.05))):
        yield "beam_on_stop", test, {"normal_force": beam(*at)[0]}
    yield "beam_on_stop", "hanging", {"sag": beam(0.5e-6, 0.13)[1]}


def heat_strain(heat):
    """Strain along the free axis where the two others are held: Hooke's law with E = 1, nu = 0.25."""
    nu, thermal = 0.25, 12e-6 * heat
    held = np.linalg.solve(np.array([[1, -nu], [-nu, 1]]), [-thermal, -thermal])  # stresses of the held axes
    return thermal - nu * held.sum()


def main():
    wrong = 0
    for case, test, found in values():
        for name, value in found.items():
            want = expected(case, test)[name]
            off = abs(value - want) / (abs(want) or 1)
            wrong += off > 1e-6
            print(f"{case:22} {test:10} {name:20} {want:14.9g} by numbers {value:14.9g}, off by {off:.1e}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
