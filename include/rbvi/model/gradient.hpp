// Derivatives of the outputs of an answer by its parameters. Of mu + h e_p the answer is known to
// first order from the linear system of the active sets at mu (OnlineSolver::near), in which the
// operators, gaps and bounds are those of mu + h e_p; outputs of two such answers make a difference
// quotient of second order. No problem with inequalities is solved again, but by the methods that
// QueryMethod::near names.
#pragma once

#include "rbvi/model/online.hpp"

namespace rbvi {

struct OutputGradient {
  Matrix values;            ///< columns of outputs x free parameters; NaN: it has none
  std::vector<bool> kinked; ///< of each parameter: a node changes its state so near that
                            ///< derivatives are those of one side, or between both
};

/// `answer`: the last one of solver.solve(mu). Columns that count, or that are checks of the
/// answer, have no derivative, nor has an output without a value. Throws failure where an answer
/// nearby cannot be told.
OutputGradient gradient_of(OnlineSolver &solver, const Mu &mu, const ReducedAnswer &answer,
                           const std::vector<OutputColumn> &columns);

/// The same as named outputs, "d_OUTPUT_d_PARAMETER", parameter by parameter; of columns that have
/// a derivative alone.
void add_gradient(const OutputGradient &gradient, const std::vector<OutputColumn> &columns,
                  const ParameterSpace &space, Outputs &outputs);

} // namespace rbvi
