"""Chapter 2 of Niakh (2022) on matrices (study_matrices.py), with numpy and scipy: inf-sup constants
over the cone beside those over its span, in the norms of the reference domain or of that of mu; an
enlarged cone; supremizers solved for at each query; and a double greedy algorithm.
"""

from resource import RUSAGE_SELF, getrusage

import numpy as np
import scipy.linalg as dense
from scipy.optimize import linprog, nnls
from scipy.sparse.linalg import splu

DEPENDENT = 1e-9  # of the norm of a generator: what is left of it beside others


def user_seconds(who=RUSAGE_SELF):
    """CPU seconds of this process, or with RUSAGE_CHILDREN of those that it waited for."""
    return getrusage(who).ru_utime


def factorised(product):
    """A function that solves with a symmetric positive matrix."""
    return splu(product.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True},
                diag_pivot_thresh=0).solve


class Space:
    """V with a product. What contact sees of it has coordinates in which the product is Euclidean
    (include/rbvi/mor/stability.hpp): L^T B^T X are those of the supremizers of X."""

    def __init__(self, product, contact):
        self.product, self.contact = product, contact
        self.solve = factorised(product)
        unit = np.zeros((product.shape[0], len(contact)))
        unit[contact, np.arange(len(contact))] = 1
        self.responses = self.solve(unit)
        self.lower = np.linalg.cholesky(self.responses[contact])

    def supremizers(self, b, x):
        """Their coordinates: |column| is the norm of each, and |T a| that of a combination a."""
        return self.lower.T @ (b.T @ x)

    def pairing(self, b, x, basis):
        """A matrix P with |P a| the largest b(v, X a) / |v| over the span of a basis."""
        gram = basis.T @ (self.product @ basis)
        return dense.solve_triangular(np.linalg.cholesky(gram), basis[self.contact].T @ (b.T @ x),
                                      lower=True)


def dual_factor(w, x):
    """C with |C a| = |X a|_W."""
    return np.linalg.cholesky(w).T @ x


def orthonormal_combinations(c):
    """Columns that combine those of c to orthonormal ones, without those of which DEPENDENT is left
    beside those before."""
    sizes, kept = np.linalg.norm(c, axis=0), np.arange(c.shape[1])
    while True:
        factor = np.linalg.qr(c[:, kept] / sizes[kept], mode="r")
        left = np.abs(np.diag(factor))
        lost = np.flatnonzero(left < DEPENDENT)
        if left.size == kept.size and not lost.size:
            break
        kept = np.delete(kept, lost[0] if lost.size else left.size)
    result = np.zeros((c.shape[1], kept.size))
    result[kept] = dense.solve_triangular(factor, np.eye(kept.size)) / sizes[kept, None]
    return result


def span_constant(s, c):
    """The smallest |S a| / |C a| over all a: a singular value of orthonormal combinations of the
    generators; and the a of it."""
    back = orthonormal_combinations(c)
    _, stretch, directions = np.linalg.svd(s @ back, full_matrices=s.shape[0] < back.shape[1])
    return (stretch[-1] if len(stretch) == back.shape[1] else 0.0), back @ directions[-1]


def quotient(s, c, a):
    return np.linalg.norm(s @ a) / np.linalg.norm(c @ a)


def descend(s, c, a, steps=60):
    """A local minimum of |S a| / |C a| over a >= 0: |C a|^2 is convex, so that its tangent at the last
    a lies below it, and a step minimises |S a|^2 - 2 (C a', C a), a least-squares problem over a >= 0.
    The quotient falls with each. A part of |C a|^2 on both sides keeps it bounded where S is singular:
    it changes no minimum."""
    best = quotient(s, c, a)
    for _ in range(steps):
        shift = max(0.1 * best, 1e-12)
        upper = np.linalg.qr(np.vstack([s, shift * c]), mode="r")
        target = np.linalg.lstsq(upper.T, c.T @ (c @ a), rcond=1e-13)[0]
        try:
            new = nnls(upper, target)[0]
        except RuntimeError:  # too many exchanges between the faces
            return best, a
        if not new.any():
            return best, a
        value = quotient(s, c, new)
        if not value < best * (1 - 1e-9):
            return (value, new) if value < best else (best, a)
        best, a = value, new
    return best, a


def pairwise_bound(s, c):
    """A lower bound of |S a| / |C a| over a >= 0. With A = S^T S and M = C^T C >= 0 each term of
    a^T A a is at least min A_ij / M_ij times that of a^T M a, where A_ij >= 0 wherever M_ij = 0."""
    work, gram = s.T @ s, c.T @ c
    work[np.abs(work) < 1e-14 * work.max()] = 0
    gram[np.abs(gram) < 1e-14 * gram.max()] = 0
    if gram.min() < 0 or work[gram == 0].min(initial=0) < 0:
        return 0.0
    return np.sqrt(max(0, (work[gram > 0] / gram[gram > 0]).min()))


def cone_constant(s, c, starts=(), descents=6):
    """(upper value, lower value, value over the span, a) of the smallest |S a| / |C a| over a >= 0. That
    is no convex problem. The upper value is the best that descents find: from the generators with the
    smallest quotients, the parts of the smallest singular vector, random a and `starts`. The lower one
    is the constant of the span or, where it is larger, the bound by pairs: a generator that reaches it
    is the minimum, and nothing is searched."""
    sizes = np.linalg.norm(c, axis=0)
    s, c = s / sizes, c / sizes
    own = np.linalg.norm(s, axis=0)
    span, least = span_constant(s, c)
    lower = max(span, pairwise_bound(s, c))
    count = c.shape[1]
    if own.min() <= lower * (1 + 1e-9):
        return own.min(), lower, span, np.eye(count)[own.argmin()] / sizes
    columns = [np.eye(count)[k] for k in np.argsort(own)[:descents]]
    columns += [part for sign in (1, -1) if (part := np.maximum(sign * least, 0)).any()]
    columns += [np.abs(least), *np.random.default_rng(1).exponential(size=(descents, count))]
    columns += [start * sizes for start in starts if len(start) == count]
    upper, a = min((descend(s, c, column) for column in columns), key=lambda pair: pair[0])
    return upper, lower, span, a / sizes


def continuity_constant(s, c):
    """(over the cone at least, over the span) the largest |S a| / |C a|. They are equal where the a of
    the span has one sign; else its absolute value starts an ascent."""
    factor = np.linalg.qr(c, mode="r")
    _, stretch, directions = np.linalg.svd(dense.solve_triangular(factor, s.T, trans="T").T)
    a = dense.solve_triangular(factor, directions[0])
    a[np.abs(a) < 1e-12 * np.abs(a).max()] = 0
    one_sign = (a >= 0).all() or (a <= 0).all()
    return (stretch[0] if one_sign else 1 / descend(c, s, np.abs(a))[0]), stretch[0]


def constants(space, b, w, modes, enriched, x, starts):
    """{name: (over the cone at most, at least, over the span)} of beta_dec (2.14), beta_on (2.18) and
    beta_off (2.30). `starts`: {name: a of another mu}, which it keeps up."""
    c, found = dual_factor(w, x), {}
    for name, s in (("dec", space.pairing(b, x, modes)), ("on", space.supremizers(b, x)),
                    ("off", space.pairing(b, x, enriched))):
        *found[name], starts[name] = cone_constant(s, c, [starts[name]] if name in starts else [])
    return found


def high_fidelity_constants(space, b, w, covered):
    """beta_HF as constants() has the others, and c_HF over the cone at least and over the span (2.3), of
    the multipliers that face a partner everywhere."""
    every = np.eye(len(w))[:, covered]
    s, c = space.supremizers(b, every), dual_factor(w, every)
    return cone_constant(s, c)[:3], continuity_constant(s, c)


def project(c, target):
    """Nearest point of the cone of the columns of c: coefficients, distance."""
    try:
        return nnls(c, target, maxiter=30 * c.shape[1])
    except RuntimeError:
        a = nnls(c[:, ::-1], target, maxiter=300 * c.shape[1])[0][::-1]
        return a, np.linalg.norm(c @ a - target)


def cone_error(w, x, snapshots):
    """e(R) (2.13): the largest distance of a snapshot from the cone, over the largest norm."""
    factor, c = np.linalg.cholesky(w).T @ snapshots, dual_factor(w, x)
    return max(project(c, column)[1] for column in factor.T) / np.linalg.norm(factor, axis=0).max()


def gram_condition(w, x):
    c = dual_factor(w, x)
    values = np.linalg.svd(c / np.linalg.norm(c, axis=0), compute_uv=False)
    return (values[0] / values[-1])**2


def enlarged_cone(w, x):
    """Generators of a cone that holds that of x and has as many. From each the combination of the
    others with coefficients >= 0 is taken off that leaves it >= 0 and has the largest integral, a
    linear program. With Sigma these coefficients X' = X (I - Sigma), and integrals m: m - m Sigma > 0
    where no generator vanishes, so that (I - Sigma)^-1 = I + Sigma + Sigma^2 + ... >= 0."""
    weights = w.sum(axis=0)
    x = x / np.linalg.norm(dual_factor(w, x), axis=0)
    result = np.empty_like(x)
    for r in range(x.shape[1]):
        others = np.delete(x, r, axis=1)
        found = linprog(-(weights @ others), A_ub=others, b_ub=x[:, r], method="highs")
        left = np.maximum(x[:, r] - others @ found.x, 0)
        result[:, r] = left if left.max() > 1e-9 * x[:, r].max() else x[:, r]
    return result / np.linalg.norm(dual_factor(w, result), axis=0)


def orthonormal(product, basis, columns):
    """A basis orthonormal in the product and columns, without those in its span but for round-off."""
    for _ in range(2):
        columns = columns - basis @ (basis.T @ (product @ columns))
    values, vectors = np.linalg.eigh(columns.T @ (product @ columns))
    kept = values > DEPENDENT**2 * max(values.max(), 1e-300)
    fresh = columns @ (vectors[:, kept] / np.sqrt(values[kept]))
    fresh -= basis @ (basis.T @ (product @ fresh))
    return np.hstack([basis, fresh])


def reduced_answer(a, f, b, g, contact, basis, x):
    """u and lambda of (2.7) on the span of a basis and the cone of x, exactly: the dual problem is a
    least-squares problem over coefficients >= 0."""
    lower = np.linalg.cholesky(basis.T @ (a @ basis))
    m = dense.solve_triangular(lower, basis[contact].T @ (b.T @ x), lower=True)
    load = dense.solve_triangular(lower, basis.T @ f, lower=True)
    upper = np.linalg.qr(m, mode="r")
    target = np.linalg.lstsq(upper.T, m.T @ load - x.T @ g, rcond=1e-13)[0]
    coefficients, _ = project(upper, target)
    u = basis @ dense.solve_triangular(lower.T, load - m @ coefficients)
    return u, x @ coefficients


def query_seconds(operators, solve, modes, x, mus):
    """CPU seconds of queries that solve for their supremizers: operators of mu, R solves with the
    factor of V, an orthonormal basis of V_N + S_R(mu) (2.17), projection, and the reduced problem."""
    product = operators.v()
    start = user_seconds()
    for mu in mus:
        b = operators.b(mu)
        loads = np.zeros((len(modes), x.shape[1]))
        loads[operators.contact] = b.T @ x
        basis = orthonormal(product, modes, solve(loads))
        reduced_answer(operators.a(mu), operators.f(mu), b, operators.g(mu), operators.contact, basis, x)
    return user_seconds() - start


class Problem:
    """All of (2.7) at one mu, V and W with the products of the reference domain."""

    def __init__(self, operators, space, mu):
        self.a, self.f, self.b, self.g = (getattr(operators, name)(mu) for name in "afbg")
        self.space, self.contact = space, operators.contact
        self.w_lower = np.linalg.cholesky(operators.w())

    def answer(self, basis, x):
        return reduced_answer(self.a, self.f, self.b, self.g, self.contact, basis, x)

    def surrogate(self, basis, x):
        """Of the error of the answer of a pair: the residual of the equation in the dual norm of V over
        the size of its forces, and what the constraint is missed by in that of W over the size of g."""
        u, lam = self.answer(basis, x)
        reaction = self.b.T @ lam
        rest = self.f - self.a @ u
        rest[self.contact] -= reaction
        missed = np.maximum(self.b @ u[self.contact] - self.g, 0)
        missed, gap = (np.linalg.norm(dense.solve_triangular(self.w_lower, v, lower=True))
                       for v in (missed, self.g))
        pushed = np.linalg.norm(self.space.lower.T @ reaction)
        loaded = np.sqrt(self.f @ self.space.solve(self.f))
        return np.hypot(np.sqrt(max(rest @ self.space.solve(rest), 0)) / max(pushed, loaded), missed / gap)

    def errors(self, basis, x, u, lam):
        """Relative, of u in V and of lambda in W, against an exact answer."""
        found = self.answer(basis, x)

        def sizes(v, multiplier):
            return np.array([np.sqrt(v @ (self.space.product @ v)),
                             np.linalg.norm(self.w_lower.T @ multiplier)])
        return sizes(found[0] - u, found[1] - lam) / sizes(u, lam)


class DoubleGreedy:
    """After Dahmen, Plesken and Welper (2014), Algorithms 2 and 3, for (2.7). The pair starts with one
    snapshot. Supremizers are added, each that of the worst mu and multiplier, until beta_off >=
    sqrt(1 - delta^2) beta_on over the span at all training mu; then the snapshots u and lambda join at
    the mu where the surrogate of the error is largest; and so on."""

    def __init__(self, problems, w, snapshots, delta):
        self.problems, self.w, self.space = problems, w, problems[0].space
        self.u, self.lam = snapshots
        self.fraction = np.sqrt(1 - delta**2)
        self.basis, self.x = np.empty((len(self.u), 0)), np.empty((len(self.w), 0))
        self.supremizers, self.chosen = 0, []

    def add(self, k):
        self.chosen.append(k)
        self.basis = orthonormal(self.space.product, self.basis, self.u[:, [k]])
        size = np.sqrt(self.lam[:, k] @ self.w @ self.lam[:, k])
        self.x = np.column_stack([self.x, self.lam[:, k] / size])

    def stabilise(self):
        """Returns the smallest beta_off / beta_on."""
        while True:
            ratios, worst = stability(self.problems, self.w, self.basis, self.x)
            k = int(np.argmin(ratios))
            if ratios[k] >= self.fraction:
                return ratios[k]
            supremizer = self.space.responses @ (self.problems[k].b.T @ worst[k])
            size = self.basis.shape[1]
            self.basis = orthonormal(self.space.product, self.basis, supremizer[:, None])
            assert self.basis.shape[1] == size + 1, "no supremizer is left to add"
            self.supremizers += 1

    def run(self, tolerance, most):
        """Until the largest surrogate is at most `tolerance`, or `most` snapshots are in. Yields it and
        the smallest beta_off / beta_on after each snapshot."""
        norms = np.einsum("ij,ij->j", self.u, self.space.product @ self.u)
        self.add(int(np.argmax(norms)))
        while True:
            least = self.stabilise()
            values = np.array([problem.surrogate(self.basis, self.x) for problem in self.problems])
            yield values.max(), least
            worst = int(np.argmax(values))
            if values.max() <= tolerance or len(self.chosen) >= most or worst in self.chosen:
                return
            self.add(worst)


def stability(problems, w, basis, x):
    """beta_off / beta_on over the span at every problem, and the multiplier where beta_off is taken."""
    x = x @ orthonormal_combinations(dual_factor(w, x))
    ratios, worst = np.empty(len(problems)), []
    space = problems[0].space
    top, traces = basis[space.contact].T, space.responses[space.contact]
    for k, problem in enumerate(problems):
        forces = problem.b.T @ x
        pushed = np.flatnonzero(np.abs(forces).max(axis=1))
        work = traces[np.ix_(pushed, pushed)] @ forces[pushed]
        on = np.sqrt(np.linalg.eigvalsh(forces[pushed].T @ work)[0])
        stretch, right = np.linalg.svd(top @ forces, full_matrices=top.shape[0] < x.shape[1])[1:]
        ratios[k] = stretch[-1] / on if len(stretch) == x.shape[1] else 0.0
        worst.append(x @ right[-1])
    return ratios, worst
