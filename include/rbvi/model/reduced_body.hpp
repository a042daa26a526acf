// A reduced body: A_N(mu) = R R^T with a root R, and its load. The part of R^-1 that is the same
// for every mu is taken into loads once (turned), and a query adds what mu changes:
//
//   common eigenvectors  A of one or two terms: V^T A_N V = D(mu) is diagonal, R^-1 = D^-1/2 V^T
//   few functions        terms that differ on few of them (StiffnessChange), with one factor L of
//                        A_1 and an orthonormal basis U of L^-1 Q:
//                          A_N = s L (I + U K U^T) L^T,  R = sqrt(s) L (I + U (M - I) U^T),
//                          M^2 = I + K,  s = sum of theta_q scales_q,
//                          K = U^T L^-1 (sum of theta_q Q C_q Q^T / s) L^-T U is small
//   factorised           else, where the parameters that A depends on change
#pragma once

#include "rbvi/model/model.hpp"

namespace rbvi {

/// V_N + S_R(mu) (2.17) in a model whose supremizers span S_R(mu) for every mu: orthonormal
/// columns, the modes first. `b`: of R functions of the multipliers at mu, R x n, in V-orthonormal
/// primal functions: row r behind the modes is the supremizer of function r.
Matrix enriched_subspace(const Matrix &b, Index modes);

/// What does not depend on mu: const, for any number of threads.
class ReducedBody {
public:
  /// `model` and `scene` must outlive it. Throws failure where A_1 of a body that changes on few
  /// functions is not positive definite.
  ReducedBody(const ReducedModel &model, const Scene &scene);
  /// The fixed part of R^-1 times loads, n x any number.
  Matrix turned(const Matrix &loads) const;
  /// Loads as BodyAtMu::response_of_prepared takes them, n x any number: turned, or where mu only
  /// scales A_N the response to them.
  Matrix prepared(const Matrix &loads) const;
  /// Those of the terms of F, n x terms, where mu only scales A_N; else empty.
  const Matrix &unit_responses() const { return unit_responses_; }

private:
  friend class BodyAtMu;
  bool only_scales() const { return eigenvalues_.cols() == 1; }
  void find_common_eigenvectors();
  void find_change();

  const ReducedModel &model_;
  const Scene &scene_;
  Matrix eigenvectors_; ///< V; empty: there are none in common
  Matrix eigenvalues_;  ///< n x terms: the diagonal of each
  Matrix a_, l_;        ///< A_1 and L, their lower triangles, where few functions change; or empty
  Matrix u_, along_;    ///< U, n x min(n, r); U^T L^-1 Q
  Matrix prepared_b_;   ///< n x generators, of the terms of B side by side
  Matrix unit_responses_;
  Matrix turned_f_, turned_springs_; ///< of the terms of F; of the springs of free bodies
};

/// What mu makes of it: of one thread.
class BodyAtMu {
public:
  /// `body` must outlive it.
  explicit BodyAtMu(const ReducedBody &body) : body_(body) {}
  /// The mu of the next calls, and what the springs of free bodies are relaxed at. They, or this,
  /// throw failure where A_N is not positive definite.
  void set(const FullMu &mu, const Vector &beta = {});
  /// Restricts displacements and loads to the columns of `subspace` (n x any number) until the next
  /// set(); for a model that is enriched online, which needs that after each.
  void restrict_to(Matrix subspace);
  /// Without restriction what it is given; else its coordinates in the subspace.
  Vector restricted(const Vector &load) const;

  bool has_load() const { return body_.model_.body.f.size() > 0; }
  Vector load() const;         ///< F_N, n entries, with that of the springs; zero without
  Vector given_load() const;   ///< without it
  Matrix free_motions() const; ///< of bodies that contact alone holds, n x k
  Matrix stiffness() const;    ///< A_N, n x n
  Vector times(const Vector &u) const;
  Vector diagonal() const; ///< of A_N, of the part that mu scales as a whole where there is one

  /// R without the factor sqrt(scale()) is another one where root_number() is.
  double scale() const { return scale_; }
  int root_number() const { return root_number_; }
  /// R^-1 of loads that were turned.
  Matrix half_response_of_turned(const Matrix &turned) const;
  /// The same times the root of scale(), with the same digits whatever that is.
  Matrix scaled_half_response_of_turned(const Matrix &turned) const;
  Matrix half_response(const Matrix &loads) const; ///< R^-1 loads, n x any number
  Vector half_response_to_load() const;            ///< R^-1 load()
  Vector response_to_load() const;                 ///< A_N^-1 load()
  /// The same is ReducedBody::unit_responses() times this; empty where it is not.
  Vector load_shares() const;
  Matrix half_response_to_springs() const;                   ///< n x k
  Vector transposed_half_response(const Vector &half) const; ///< R^-T half
  Vector response_of_prepared(const Vector &prepared) const; ///< A_N^-1 of the load
  Vector response(const Vector &load) const;                 ///< A_N^-1 load
  /// A_N^-1 B_N^T x, B_N of the coefficients `theta_b`.
  Vector response(const Vector &theta_b, const Vector &x) const;

private:
  void set_change();
  const Matrix &lower_triangle() const;
  const Matrix &factor() const;

  const ReducedBody &body_;
  FullMu mu_{};
  Vector beta_{};
  std::optional<std::vector<double>> at_{}; ///< values of the parameters that A depends on
  Vector theta_;
  double scale_ = 1;
  int root_number_ = 0;
  Vector inverse_roots_; ///< D^-1/2 without the scale
  Matrix core_;          ///< sum of theta_q C_q
  Matrix inverse_;       ///< M^-1 - I
  Matrix subspace_;      ///< empty: all of the primal space
  mutable Matrix a_;     ///< A_N, its lower triangle; empty: not made yet
  mutable Matrix lower_; ///< its factor; likewise
};

} // namespace rbvi
