// Errors of reduced answers against high-fidelity ones, relative: u in V, the multiplier in W.
// Niakh (2022): (4.88), (4.89), (4.97), (4.98).
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/sweep/sweep.hpp"

#include <string>

namespace rbvi {

/// |u|_V of the whole displacement, the motion of the scene included; `u`: all dofs in natural
/// order, without it. Collective on the problem's communicator.
double displacement_norm(Problem &problem, const Mu &mu, const Vector &u);

/// High-fidelity answers as a model's V-orthonormal basis sees them: |u - V c|_V^2 =
/// |coordinates - c|^2 + remainder^2, so that one projection serves every sub-model.
struct Truths {
  std::vector<Mu> mu;
  Matrix coordinates;           ///< n x P
  Vector remainder;             ///< P: distance of u to the basis, in V
  Vector u_norm;                ///< P, in V, of the whole displacement
  Matrix lambda;                ///< dual dofs x P
  Vector lambda_norm;           ///< P, in W; with friction of the normal part
  Vector tangential_norm;       ///< P, of the tangential part; empty without friction
  std::vector<Outputs> outputs; ///< P
  double largest_u = 0, largest_lambda = 0, largest_tangential = 0; ///< of these norms
};

/// The error over the size, which counts as 1e-2 of the largest of its set where it is less: an
/// answer that is zero, or nearly, is measured on the scale of the set. Of a set of zeros the error
/// itself.
double relative(double error, double size, double largest);

/// Gives two sets one scale, the larger ones.
void share_scale(Truths &one, Truths &other);

/// Collective. `problem`: on the communicator of all ranks.
Truths make_truths(Problem &problem, const ReducedModel &model, const std::vector<Sample> &samples);

/// Errors at each mu, and what the bases alone could reach.
struct ModelErrors {
  Vector u, lambda;             ///< of the reduced answers; with friction lambda_n
  Vector tangential;            ///< lambda_tau; empty without friction
  Vector u_floor, lambda_floor; ///< of the projections on the space and on the cone
  Vector tangential_floor;      ///< Nitsche's method with friction alone
  double seconds = 0;           ///< median per query, outputs and reconstruction left out
  double kkt_residual = 0;      ///< largest
  int failed = 0;               ///< queries without an answer: their errors are infinite
};

/// Serial. `embedding`: coordinates of the sub-model's basis in the basis of the truths (n x k,
/// orthonormal columns); empty: the leading columns.
ModelErrors model_errors(const ReducedModel &model, const Matrix &embedding, const Truths &truths,
                         const SparseMatrix &w_product);

/// A sub-model and its embedding.
struct SubModel {
  ReducedModel model;
  Matrix embedding;
};

/// Whether the supremizers of smaller pairs lie in the model's space and are known: b depends on mu
/// by a factor only, and they are taken in the V product, so that the coordinates of T chi_r are
/// row r of the reduced b.
bool knows_enriched_pairs(const ReducedModel &model);

/// The pair of the first n modes and the first r generators, enriched by the supremizers of those
/// generators within the model's space. Needs knows_enriched_pairs(model).
SubModel enriched_pair(const ReducedModel &model, int n, int r);

/// Over the queries of some sets that have an answer; the others are counted.
ValidationErrors summary(const std::vector<const ModelErrors *> &sets);

/// What to try where a query takes half as long as a high-fidelity solve, or longer (seconds);
/// empty where it is faster, or where either is not known (0).
std::string slow_query(double query, double solve);

} // namespace rbvi
