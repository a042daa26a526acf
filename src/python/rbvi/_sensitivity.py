"""Sobol's indices: which parameter an output varies with. The figures of cases/ take them from here, too,
without the rest of this package."""

import numpy as np

RESAMPLES = 200  # of the points, for the deviations of the indices


def shares(first, second, mixed, rows):
    """Indices of the first order and in total of the parameters, each p x outputs, from these rows of
    answers at two independent sets of points (n x outputs) and at the first set with one parameter of
    the second (p x n x outputs): Saltelli et al. 2010, (b), and Jansen 1999."""
    first, second, mixed = first[rows], second[rows], mixed[:, rows]
    both = np.concatenate([first, second])
    spread = both.var(axis=0)
    spread = np.where(spread > 0, spread, np.nan)
    alone = ((second - both.mean(axis=0)) * (mixed - first)).mean(axis=1) / spread
    total = ((mixed - first)**2).mean(axis=1) / 2 / spread
    return alone, total


def indices(evaluate, lower, upper, count, seed):
    """First order, total, and the deviations of both, each p x outputs, of parameters that are uniform and
    independent; `evaluate`: points x p -> points x outputs. Takes count (p + 2) points."""
    lower, upper = np.asarray(lower, float), np.asarray(upper, float)
    random = np.random.default_rng(seed)
    first, second = lower + (upper - lower) * random.random((2, count, len(lower)))
    points = [first, second]
    for k in range(len(lower)):
        mixed = first.copy()
        mixed[:, k] = second[:, k]
        points.append(mixed)
    answers = evaluate(np.concatenate(points)).reshape(len(points), count, -1)
    parts = answers[0], answers[1], answers[2:]
    draws = [shares(*parts, random.integers(count, size=count)) for _ in range(RESAMPLES)]
    return (*shares(*parts, slice(None)), *(np.std(kind, axis=0) for kind in zip(*draws)))


class Sensitivity:
    """Sobol's indices of outputs over a box: s.first["normal_force"]["depth"], the share of the
    variance of the output that goes with this parameter alone; s.total[...][...], with all that it takes
    part in; s.first_error, s.total_error, their standard deviations; s.plot(). NaN of an output that
    is constant."""

    def __init__(self, evaluate, box, outputs, count, seed):
        """`box`: parameter -> (lower, upper); `evaluate`: points, rows of the parameters, -> rows of the
        outputs."""
        names, ends = list(box), np.array(list(box.values()), float).T
        found = indices(evaluate, *ends, count, seed)
        self.first, self.total, self.first_error, self.total_error = (
            {output: dict(zip(names, map(float, values[:, k]))) for k, output in enumerate(outputs)}
            for values in found)

    def __repr__(self):
        rows = [f"{'output':24} {'parameter':16} first order       in total"]
        for output, own in self.first.items():
            rows += [f"{output:24} {name:16} {value:6.3f} +- {self.first_error[output][name]:.3f}  "
                     f"{self.total[output][name]:6.3f} +- {self.total_error[output][name]:.3f}"
                     for name, value in own.items()]
        return "\n".join(rows)

    def plot(self, axes=None):
        """Bars of both indices, for each output and parameter; returns the axes of matplotlib."""
        from ._figures import bars
        return bars(self, axes)
