// From snapshots to a reduced model: POD, cone, supremizers, separation, projection.
#pragma once

#include "rbvi/mor/affine.hpp"
#include "rbvi/mor/cones.hpp"
#include "rbvi/mor/pod.hpp"
#include "rbvi/mor/stability.hpp"
#include "rbvi/par/stage.hpp"
#include "rbvi/sweep/sweep.hpp"

namespace rbvi {

/// What is added to the modes.
enum class Enrichment {
  decorrelated, ///< nothing: V_N
  online,       ///< S_R(mu), made for each query (2.17); the model holds the span of all S_R(mu)
  offline,      ///< the supremizers of the projected greedy (2.30)
};

/// The product in which supremizers represent b(mu; ., eta).
enum class SupremizerProduct {
  v,     ///< the V product: beta and sigma are those of the theory
  energy ///< a(reference; ., .): the response of u to eta, exact where A does not vary
};

/// Their names, in order.
const std::vector<std::string> &enrichment_names();
const std::vector<std::string> &product_names();

struct ReduceOptions {
  PodOptions pod;
  ConeOptions cone;
  PgaOptions pga;
  EimOptions eim;
  Enrichment enrichment = Enrichment::offline;
  SupremizerProduct product = SupremizerProduct::v;
  Mu reference; ///< free parameters of that a, and of the hybrid cone's; empty: centre of the box
};

/// A basis pair and how it was found.
struct ReducedBases {
  Pod pod; ///< basis: N modes, then the S supremizers, V-orthonormal
  Cone cone;
  Pga pga;
  int modes = 0;       ///< N
  int supremizers = 0; ///< S
  bool online_enriched = false;
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
