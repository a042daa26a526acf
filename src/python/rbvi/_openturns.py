"""A model as a function of OpenTURNS, and its box as a distribution."""

import numpy as np
import openturns

from ._library import NoAnswer


class Outputs(openturns.OpenTURNSPythonFunction):
    """Parameters -> some outputs; samples by Model.table, on all cores."""

    def __init__(self, model, outputs, extrapolate):
        super().__init__(len(model.parameters), len(outputs))
        self.model, self.outputs, self.extrapolate = model, outputs, extrapolate
        self.setInputDescription(list(model.parameters))
        self.setOutputDescription(outputs)

    def _exec(self, point):
        answer = self.model(**dict(zip(self.model.parameters, point)), extrapolate=self.extrapolate)
        return [answer[name] for name in self.outputs]

    def _exec_sample(self, sample):
        table = self.model.table(np.asarray(sample), extrapolate=self.extrapolate)
        if not table.ok.all():
            first = int(np.argmin(table.ok))
            raise NoAnswer(f"{np.count_nonzero(~table.ok)} of {len(table)} points have no answer; "
                           f"the first, {first}: {table.status[first]}")
        return np.column_stack([table[name] for name in self.outputs])


def function_of(model, outputs, extrapolate):
    if outputs is None:
        outputs = list(model.outputs)
    names = [outputs] if isinstance(outputs, str) else list(outputs)
    for name in names:
        model.outputs[name]  # refuses an unknown one
    return openturns.Function(Outputs(model, names, extrapolate))


def box_of(model):
    product = getattr(openturns, "JointDistribution", None) or openturns.ComposedDistribution
    box = product([openturns.Uniform(one.lower, one.upper) for one in model.parameters.values()])
    box.setDescription(list(model.parameters))
    return box
