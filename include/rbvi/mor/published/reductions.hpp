// Published variants of reductions: the law on fewer functions with collocation nodes, cones by
// greedy choice of snapshots or by non-negative factors, and Nitsche's method interpolated over
// (mu, Newton step).
#pragma once

#include "rbvi/mor/reduce.hpp"

namespace rbvi {

/// Enters them in the lists of mor/reduction.hpp, mor/cones.hpp and mor/nitsche_quadrature.hpp, and
/// their queries. To be called before options are read.
void add_published_reductions();

/// `collocated` alone: the collocation nodes of a model that has none yet, into it. Serial.
Gcns collocate(ReducedModel &model, const Problem &problem, const std::vector<Sample> &samples,
               const GcnsOptions &options);

} // namespace rbvi
