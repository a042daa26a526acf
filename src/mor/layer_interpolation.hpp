// Empirical interpolation of operators on the contact layer.
#pragma once

#include "rbvi/mor/eim.hpp"
#include "rbvi/rom/layer_terms.hpp"
#include "rbvi/solve/nitsche.hpp"
#include "rbvi/sweep/sweep.hpp"

#include <array>
#include <vector>

namespace rbvi {

/// a_gamma - a over the training parameters, exact but for round-off where it is a sum of few
/// terms. `trace`: dofs of the layer x n.
LayerTerms interpolate_consistency(const Scene &scene, const ContactLayer &layer,
                                   const std::vector<Sample> &samples, const Matrix &trace);

/// B^n, Theta^n and, with friction, B^tau, Theta^tau over all pairs of a training parameter and a
/// Newton step from u = 0 (4.71)-(4.78). Solves the high-fidelity problems again. Collective.
/// Returns the number of pairs; `errors`: e_EIM along the terms of each (B.32).
int interpolate_terms(Problem &problem, const std::vector<Sample> &samples,
                      const EimOptions &options, NitscheModel &nitsche,
                      std::array<std::vector<double>, 4> &errors);

} // namespace rbvi
