// Uzawa's method: multipliers x of a body by projected gradient steps,
//
//   x <- P(x - rho w),   w = H x + q,   H = B A^-1 B^T,   q = g - B A^-1 f,
//
// P a projection onto the laws: corrected (3.18), (3.24), (3.32) of Niakh (2022) on a full body,
// whose ranks share the entries of x, corrected (3.40), (3.52), (3.55) on a reduced one
// (published/collocated_friction.hpp).
#pragma once

#include "rbvi/core/dense.hpp"

#include <array>
#include <functional>

namespace rbvi {

struct UzawaOptions {
  double tolerance = 1e-6; ///< relative change of x in W (3.19)
  int max_iterations = 20000;
  bool accelerated = false; ///< Nesterov's extrapolation, restarted when it overshoots
  double step = 0;          ///< rho; 0: 1 / largest eigenvalue of H
};

/// Vectors are the entries of this rank; numbers are of the entries of all.
struct UzawaProblem {
  std::function<Vector(const Vector &x)> times_h{};
  Vector q;
  std::function<Vector(const Vector &x)> projection{};
  std::function<double(const Vector &x, const Vector &y)> dot{};
  std::function<std::array<double, 2>(const Vector &x)> sizes{}; ///< in W: of x_n, of x_tau
  Vector first{}; ///< not orthogonal to the eigenvector of the largest eigenvalue of H
};

struct UzawaResult {
  Vector x;
  int iterations = 0;
  double change = 0; ///< of the last step, relative: of x_n or of x_tau, the larger
  bool converged = false;
};

/// From x = 0. Collective where the problem is.
UzawaResult solve_uzawa(const UzawaProblem &problem, const UzawaOptions &options);

} // namespace rbvi
