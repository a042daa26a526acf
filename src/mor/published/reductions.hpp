// The published reductions, which reductions.cpp enters in their lists.
#pragma once

#include "rbvi/mor/cones.hpp"
#include "rbvi/mor/nitsche_quadrature.hpp"
#include "rbvi/mor/reduction.hpp"

namespace rbvi {

extern const ReductionWay collocated_way;

// Types of cones: `snapshots` are checked ones.
Cone projected_greedy_cone(const Matrix &snapshots, const SparseMatrix &product,
                           const ConeOptions &options);
Cone angle_greedy_cone(const Matrix &snapshots, const SparseMatrix &product,
                       const ConeOptions &options);
Cone nmf_cone(const Matrix &snapshots, const SparseMatrix &product, const ConeOptions &options);

/// B^n, Theta^n and, with friction, B^tau, Theta^tau over all pairs of a training parameter and a
/// Newton step (4.71)-(4.78), without friction from u = 0 (CurveOptions::published_pairs). Solves
/// the high-fidelity problems again. Collective. Sets the terms of model.contact.nitsche, the
/// errors and the number of pairs in the report.
void interpolate_terms(Problem &problem, const std::vector<Sample> &samples,
                       const CurveOptions &options, ReducedModel &model, CurveReport &report);

} // namespace rbvi
