// The responses A(mu)^-1 L of a body whose A is a sum of exact terms, for all mu of a box: a space
// that holds them, and H = L^T A^-1 L by Galerkin's method in it. The error of H is the square of
// that of the responses.
//
// The space grows by the responses at one mu after the other, on a sparse grid of nested points
// along each parameter. It goes on along the parameter whose last point has added most, until the
// remainders outside the space are below the tolerance (dimension-adaptive, Gerstner and Griebel
// 2003).
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/model/sparse_grid.hpp"
#include "rbvi/mor/pod.hpp"

namespace rbvi {

struct ResponseSpace {
  int points = 0;    ///< factorisations
  int functions = 0; ///< appended to the basis
  double left = 0;   ///< largest remainder at the last point of each direction, relative
};

/// Where responses are asked for, and until when.
struct ResponseSearch {
  std::vector<GridAxis> axes; ///< of the free parameters of A
  FullMu all_parameters;
  double tolerance; ///< of the largest response
  int most;         ///< points, each a factorisation
};

/// Appends to `basis` what the responses to `loads` (contact dofs x m) have outside it, in the
/// directions whose remainder, weighted, is above the tolerance. `weights`: m x any number,
/// combinations of the loads that are as large as the multipliers can be. Collective. Says so on
/// standard error, and ends, where the most points do not reach the tolerance.
ResponseSpace append_responses(Problem &problem, const Matrix &loads, const Matrix &weights,
                               const ResponseSearch &search, LinearBasis &basis);

/// The same for the responses to `loads` on the whole body, until all of them are there to the
/// tolerance.
ResponseSpace append_load_responses(Problem &problem, const std::vector<Vec> &loads,
                                    const ResponseSearch &search, LinearBasis &basis);

/// Galerkin's method in a basis, for a sum of exact terms.
class ReducedResponses {
public:
  /// Collective.
  ReducedResponses(const Problem &problem, const Matrix &loads, const LinearBasis &basis);
  /// L_N^T A_N(mu)^-1 L_N, m x m. Throws failure where A_N is not positive definite. Not
  /// collective.
  Matrix compliance(const FullMu &all_parameters) const;

private:
  const Problem &problem_;
  std::vector<Matrix> terms_; ///< A_q, n x n
  Matrix loads_;              ///< n x m
};

} // namespace rbvi
