"""The membrane over an obstacle without a mesh: the contact set, energy, force and area.

Where the membrane rests on the obstacle the pressure is the constant p = 5 / r^2 - load, so that

    u = load T + p int_C G(., y) dy,   -Laplace T = 1,  T = 0 on the boundary,

G Green's function of the square, and the contact set C is the one for which u = psi on it. C is
rho(theta) about the obstacle's centre c, a Fourier sum. On C, u - psi is harmonic: it vanishes where
it does on one circle inside. Newton's method finds the Fourier coefficients.
"""

import numpy as np

LOAD = -25
CURVATURE = 1.25  # psi = -CURVATURE |x - c|^2 / r^2
MODES = 12        # cosines and sines of rho
ANGLES = 2 * np.pi * np.arange(48) / 48
RADII, RADIAL_WEIGHTS = (np.polynomial.legendre.leggauss(16) + np.array([[1], [0]])) / 2
ODD = np.pi * (2 * np.arange(60) + 1)


def torsion(z):
    """T at the complex points z inside the square, by its Fourier series in y."""
    x, y = np.abs(z.real)[..., None], z.imag[..., None]
    cosh_ratio = (np.exp(ODD * (x - 0.5)) + np.exp(-ODD * (x + 0.5))) / (1 + np.exp(-ODD))
    terms = 4 * (-1.0) ** np.arange(ODD.size) / ODD**3 * np.cos(ODD * y) * cosh_ratio
    return (0.25 - z.imag**2) / 2 - terms.sum(-1)


def torsion_integral():
    """int T over the square."""
    odd = np.pi * (2 * np.arange(4000) + 1)
    return 1 / 12 - np.sum(16 * np.tanh(odd / 2) / odd**5)


def regular_green(z, w):
    """G(z, w) + log|z - w| / (2 pi): the images of w, those of each column summed in closed form."""
    total = 0
    for column in range(-14, 15):
        sign, x = (-1) ** column, column + (-1) ** column * w.real
        same, opposite = x + 1j * w.imag, x + 1j * (1 - w.imag)
        own = z - same if column == 0 else 1
        total = total + sign * np.log(np.abs(np.sinh(np.pi * (z - same) / 2) / own /
                                             np.sinh(np.pi * (z - opposite) / 2)))
    return -total / (2 * np.pi)


def harmonics(angles):
    """1, cos, sin, cos 2, sin 2, ... of the angles; the last axis is the mode."""
    columns = [np.ones_like(angles)]
    for k in range(1, MODES + 1):
        columns += [np.cos(k * angles), np.sin(k * angles)]
    return np.stack(columns, -1)


class Exact:
    """The solution at mu = (r, cx, cy), for contact sets that are star-shaped about c."""

    def __init__(self, mu, load=LOAD):
        self.mu, self.obstacle, self.centre = mu, CURVATURE / mu[0]**2, mu[1] + 1j * mu[2]
        self.load, self.pressure = load, 4 * CURVATURE / mu[0]**2 - load
        self.inner = 0.27 * mu[0] * np.exp(1j * ANGLES)  # the circle where u = psi is asked for
        self.torsion_inside = torsion(self.centre + self.inner)
        # Images as a function of y are harmonic: their Fourier sums on a circle give them inside.
        self.circle = 0.6 * mu[0]
        on_circle = self.centre + self.circle * np.exp(1j * ANGLES)
        images = regular_green((self.centre + self.inner)[:, None], on_circle[None, :])
        self.images = np.linalg.lstsq(harmonics(ANGLES), images.T, rcond=None)[0].T
        self.modes = np.zeros(2 * MODES + 1)
        self.modes[0] = 0.54 * mu[0]
        self.find_contact()
        points, weights = self.area_rule()
        self.area = weights.sum()
        self.force = self.pressure * self.area
        # J = -int load u / 2 + int p psi / 2, and int u = int T (-Laplace u).
        of_u = load * torsion_integral() + self.pressure * (torsion(points) @ weights)
        of_psi = -self.obstacle * (np.abs(points - self.centre)**2 @ weights)
        self.energy = (self.pressure * of_psi - load * of_u) / 2

    def radius(self, angles):
        return harmonics(angles) @ self.modes

    def contains(self, x, y):
        """Whether the points are in contact."""
        z = x + 1j * y - self.centre
        return np.abs(z) < self.radius(np.angle(z))

    def area_rule(self):
        """Points and weights of a quadrature over the contact set."""
        rho = self.radius(ANGLES)[:, None]
        points = self.centre + rho * RADII * np.exp(1j * ANGLES)[:, None]
        return points.ravel(), (rho**2 * RADII * RADIAL_WEIGHTS).ravel() * 2 * np.pi / ANGLES.size

    def harmonic_integrals(self, rho):
        """Of (|y - c| / R)^k times cos k and sin k over the contact set, R = self.circle."""
        integrals = 2 * np.pi * np.mean(harmonics(ANGLES) * rho[:, None]**2, axis=0) / 2
        for k in range(1, MODES + 1):
            power = rho**(k + 2) / (k + 2) / self.circle**k
            for i in (2 * k - 1, 2 * k):
                integrals[i] = 2 * np.pi * np.mean(harmonics(ANGLES)[:, i] * power)
        return integrals

    def excess(self):
        """u - psi on the inner circle."""
        rho = self.radius(ANGLES)
        # int log|x - y| dy over C: a harmonic part by the moments of C, and pi |x - c|^2 / 2.
        mean = 2 * np.pi * np.mean(rho**2 / 2 * (np.log(rho) - 0.5))
        log = np.pi * np.abs(self.inner)**2 / 2 + mean
        for k in range(1, ANGLES.size // 2):
            power = np.log(rho) if k == 2 else rho**(2 - k) / (2 - k)
            moment = 2 * np.pi * np.mean(power * np.exp(-1j * k * ANGLES))
            log -= (self.inner**k * moment).real / k
        images = self.images @ self.harmonic_integrals(rho)
        u = self.load * self.torsion_inside + self.pressure * (images - log / (2 * np.pi))
        return u + self.obstacle * np.abs(self.inner)**2

    def find_contact(self):
        to_modes = np.linalg.pinv(harmonics(ANGLES))
        step = 1e-6 * self.modes[0]
        for _ in range(12):
            now, start, columns = to_modes @ self.excess(), self.modes.copy(), []
            for mode in range(start.size):
                self.modes = start + step * np.eye(start.size)[mode]
                columns.append((to_modes @ self.excess() - now) / step)
            change = np.linalg.solve(np.transpose(columns), now)
            self.modes = start - change
            if np.max(np.abs(change)) < 1e-11:
                return
        raise RuntimeError(f"no contact set found at mu = {self.mu}")
