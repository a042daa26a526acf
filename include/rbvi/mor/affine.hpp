// Separation of mu and space: empirical interpolation of A, B, F, G over the training set, with the
// small meshes on which the sampled entries are re-assembled online.
#pragma once

#include "rbvi/mor/eim.hpp"
#include "rbvi/problem/problem.hpp"
#include "rbvi/rom/model.hpp"

namespace rbvi {

struct AffineOperators {
  Eim a, b, f, g; ///< of size 0: f without a load; b and g of two bodies (assembled exactly
                  ///< online) and of Nitsche's method (there are none)
  SampleMesh sample_a, sample_b, sample_f, sample_g;
};

/// Collective. Assembles the operators at every mu of `training` (A: its lower triangle, where the
/// parameters that it depends on differ) and interpolates each.
AffineOperators separate(Problem &problem, const std::vector<Mu> &training,
                         const EimOptions &options);

} // namespace rbvi
