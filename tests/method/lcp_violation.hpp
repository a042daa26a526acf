// How far an answer is from a linear complementarity problem.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/largest.hpp"

#include <limits>

namespace rbvi {

/// Largest violation of x >= 0, w = m x + q >= 0, x . w = 0, relative to the terms of its own row;
/// infinite for a negative entry of x.
inline double lcp_violation(const Matrix &m, const Vector &q, const Vector &x) {
  const Vector w = m * x + q, terms = m.cwiseAbs() * x.cwiseAbs() + q.cwiseAbs();
  double worst = 0;
  for (Index i = 0; i < q.size(); ++i) {
    if (x[i] < 0) return std::numeric_limits<double>::infinity();
    if (terms[i] > 0) worst = larger(worst, (x[i] > 0 ? std::abs(w[i]) : -w[i]) / terms[i]);
  }
  return worst;
}

} // namespace rbvi
