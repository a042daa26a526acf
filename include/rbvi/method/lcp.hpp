// Primal-dual active set method for the condensed contact problem: find x with
//
//   x >= 0,   w = H x + q >= 0,   x . w = 0               H: n x n, symmetric positive definite
//
// (H = B A^-1 B^T, q = g - B A^-1 f, x = lambda, w = g - B u: a semismooth Newton method.)
// Columns of H are asked for only when a node enters the active set for the first time. Block
// exchange of all violated entries; where it runs in circles, single exchanges by lowest index
// (Murty), which end for every such H, until the number of violations falls again.
// src/method/README.md says which solver serves whom.
#pragma once

#include "rbvi/core/dense.hpp"

#include <functional>
#include <string>
#include <vector>

namespace rbvi {

/// Returns the columns H(:, which) as an n x which.size() matrix; each column is asked for once.
using ColumnSource = std::function<Matrix(const std::vector<Index> &which)>;

/// H where all of it is there: `factor` times a square matrix, which outlives its use.
struct ScaledMatrix {
  Eigen::Map<const Matrix> matrix;
  double factor;
};

struct LcpOptions {
  double tolerance = 1e-13; ///< relative: w to the terms of its row, x (unit diag. H) to its max
  int max_iterations = 0;   ///< 0: 50 + 10 n
};

struct LcpResult {
  Vector x, w;               ///< n each
  std::vector<Index> active; ///< increasing
  int iterations = 0;
  int columns = 0;      ///< columns of H that were asked for
  int backup_steps = 0; ///< single exchanges, where block exchange gave up
  bool converged = false;
  std::string reason; ///< why it stopped
};

/// `start`: first guess of the active set (any order). Not converged, or a block of H that is not
/// positive definite: `reason` says what to try (then x and w are empty for the latter). Throws
/// failure for a q or a column that is not finite or of the wrong size, or a start out of range.
LcpResult solve_lcp(const ColumnSource &columns, const Vector &q, const std::vector<Index> &start,
                    const LcpOptions &options = {});

} // namespace rbvi
