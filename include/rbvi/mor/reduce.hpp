// From snapshots to a reduced model: POD, cone, supremizers, separation, projection.
#pragma once

#include "rbvi/mor/affine.hpp"
#include "rbvi/mor/cones.hpp"
#include "rbvi/mor/pod.hpp"
#include "rbvi/mor/stability.hpp"
#include "rbvi/par/stage.hpp"
#include "rbvi/sweep/sweep.hpp"

namespace rbvi {

struct ReduceOptions {
  PodOptions pod;
  ConeOptions cone;
  PgaOptions pga;
  EimOptions eim;
};

/// A basis pair with what is known about its stability. Coordinates as in mor/stability.hpp.
struct ReducedBases {
  Pod pod; ///< basis: N modes, then the S supremizers, V-orthonormal
  Cone cone;
  RieszSpace riesz;
  Pga pga;
  Matrix dual;         ///< orthonormal basis of the span of the cone
  int modes = 0;       ///< N
  int supremizers = 0; ///< S
};

/// Collective. `world_problem`: on all ranks. `b_is_scaled`: b depends on mu by a factor only, so
/// one training mu serves the supremizers.
ReducedBases build_bases(Problem &problem, const std::vector<Sample> &samples,
                         const ReduceOptions &options, bool b_is_scaled, StageTimes &times);

/// Collective. Projects the separated operators onto the bases. The model is complete on every
/// rank, but for its settings, validation errors and stage times.
ReducedModel project(Problem &problem, const std::vector<Sample> &samples,
                     const AffineOperators &affine, const ReducedBases &bases);

/// Collective. Fills the parts of a model that describe the mesh and the contact region.
void describe_mesh(const Problem &problem, ReducedModel &model);

/// T(mu) X in coordinates for every mu of the set (n_c x columns of X each). Not collective.
std::vector<Matrix> supremizers_at(Problem &problem, const RieszSpace &riesz, const Matrix &x,
                                   const std::vector<Mu> &set);

} // namespace rbvi
