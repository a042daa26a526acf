"""Inf-sup and continuity constants along the supremizers of a collocated model, from its model.h5:
rbvi verify does not make them for contact with a rigid support."""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent))

from study_tools import stored

HALF_ARC = np.pi / 8  # of the half-disk of radius 1
SAME = 1e-9  # functions that depend on the others but for this are dropped


def mass(points):
    """Of the hat functions of a curve."""
    result = np.zeros((len(points), len(points)))
    for k, length in enumerate(np.linalg.norm(np.diff(points, axis=0), axis=1)):
        result[k:k + 2, k:k + 2] += length / 6 * np.array([[2, 1], [1, 2]])
    return result


def form_at_radius_one(run):
    """b over an orthonormal basis of the multipliers (rows) and the one of the displacements, which
    is orthonormal in the model."""
    normal, tangential = (stored(run, "support/basis/" + name) for name in ("normal", "tangential"))
    coefficients = np.block([[normal, np.zeros((len(normal), tangential.shape[1]))],
                             [np.zeros((len(tangential), normal.shape[1])), tangential]])
    factor = np.linalg.cholesky(mass(stored(run, "contact/points")))
    functions = stored(run, "contact/dual_basis") @ coefficients
    weighted = np.concatenate([factor.T @ half for half in np.split(functions, 2)])
    norms = np.linalg.norm(weighted, axis=0)
    _, values, right = np.linalg.svd(weighted / norms, full_matrices=False)
    rank = np.count_nonzero(values > SAME * values[0])
    orthonormal = (right[:rank].T / values[:rank]) / norms[:, None]
    term = stored(run, "b/reduced")
    if term.shape[1] != 1:
        raise ValueError(f"{run}: b is no multiple of one form")
    form = term.reshape(-1, len(coefficients)).T
    # The term of b is scaled by its interpolation; over the arc n_y has the integral -2 sin(pi/8).
    vertical = np.split(stored(run, "support/lift")[:, 0], 2)[0].sum()
    return orthonormal.T @ coefficients.T @ form * (2 * np.sin(HALF_ARC) / abs(vertical))


def constants(run):
    """beta and c at radius 1 over the modes and the first s supremizers, s = 0, 1, ...; both are
    proportional to the radius."""
    form = form_at_radius_one(run)
    modes = int(stored(run, "size/modes"))
    beta, c = [], []
    for size in range(modes, form.shape[1] + 1):
        values = np.linalg.svd(form[:, :size], compute_uv=False)
        beta.append(values[-1] if size >= len(form) else 0)
        c.append(values[0])
    return np.array(beta), np.array(c)
