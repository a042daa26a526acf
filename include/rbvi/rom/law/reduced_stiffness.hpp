// A_N(mu) of a reduced body. Of one or two terms it is diagonal for every mu in one basis, the
// eigenvectors of A_2 v = sigma A_1 v: a query then solves no system for its displacement. Of more
// terms it is factorised where the parameters that it depends on change.
#pragma once

#include "rbvi/rom/model/model.hpp"

#include <Eigen/Cholesky>

namespace rbvi {

/// V_N + S_R(mu) (2.17) in a model whose supremizers span S_R(mu) for every mu: orthonormal
/// columns, the modes first. `b`: of R functions of the multipliers at mu, R x n, in V-orthonormal
/// primal functions: row r behind the modes is the supremizer of function r.
Matrix enriched_subspace(const Matrix &b, Index modes);

class ReducedStiffness {
public:
  /// `model` and `scene` must outlive it.
  ReducedStiffness(const ReducedModel &model, const Scene &scene);
  /// The mu of the next calls. Throws failure where A_N is not positive definite.
  void set(const FullMu &all_parameters);
  /// Restricts A_N to the columns of `subspace` (n x any number) until the next call; a model that
  /// is enriched online needs that after every set(). Throws likewise.
  void restrict_to(Matrix subspace);

  /// A_N^-1 B_N^T x, B_N of the coefficients `theta_b`.
  Vector response(const Vector &theta_b, const Vector &x) const;
  Vector response(const Vector &load) const; ///< A_N^-1 load, n entries
  /// The loads of unit forces, n x any number, as response_of_turned takes them: products that a
  /// query is spared where A_N is diagonal in another basis. They stay the same for every mu.
  Matrix turned(const Matrix &loads) const;
  Vector response_of_turned(const Vector &load) const; ///< A_N^-1 of the load that was turned
  /// Some root of it: L loads, L^T L = A_N^-1. `loads`: n x any number.
  Matrix half_response(const Matrix &loads) const;
  /// L^T half: of half_response(load) it is A_N^-1 load.
  Vector transposed_half_response(const Vector &half) const;

private:
  void factorise(const Matrix &stiffness);
  void find_common_eigenvectors();

  const ReducedModel &model_;
  const Scene &scene_;
  std::optional<std::vector<double>> at_{}; ///< values of the parameters that a depends on

  Matrix eigenvectors_; ///< n x n; empty: A_N is factorised
  Matrix eigenvalues_;  ///< n x J: the diagonal of each term
  Matrix b_;            ///< generators x n, term by term side by side: B_N on the eigenvectors
  Vector diagonal_;     ///< of A_N at mu
  Matrix a_;            ///< A_N, its lower triangle
  Matrix subspace_;     ///< enriched online: the columns it is restricted to
  Matrix lower_;
};

} // namespace rbvi
