// Empirical interpolation of operators on the contact layer.
#pragma once

#include "rbvi/model/nitsche_layer_terms.hpp"
#include "rbvi/mor/eim.hpp"
#include "rbvi/mor/nitsche_quadrature.hpp"
#include "rbvi/solve/nitsche.hpp"

namespace rbvi {

/// a_gamma - a over the training parameters, exact but for round-off where it is a sum of few
/// terms. `trace`: contact dofs x n.
LayerTerms interpolate_consistency(const NitscheLayer &layer, const std::vector<Sample> &samples,
                                   const Matrix &trace);

/// B^n, Theta^n and, with friction, B^tau, Theta^tau over all pairs of a training parameter and a
/// Newton step (4.71)-(4.78), without friction from u = 0 (CurveOptions::published_pairs). Solves
/// the high-fidelity problems again. Collective. Sets the terms of model.contact.nitsche, the
/// errors and the number of pairs in the report.
void interpolate_terms(Problem &problem, const std::vector<Sample> &samples,
                       const CurveOptions &options, ReducedModel &model, CurveReport &report);

} // namespace rbvi
