// What V_N + S guarantees at one mu, from the part of the supremizers that it leaves out.
#pragma once

#include "rbvi/mor/stability.hpp"
#include "rbvi/par/small_svd.hpp"

#include <algorithm>

namespace rbvi {

/// `enriched`: coordinates of V_N + S; `supremizers`: T(mu) X for an orthonormal dual basis X, at
/// least as many rows as columns and one column.
inline StabilityBound stability_bound(const Matrix &enriched, const Matrix &supremizers) {
  const Vector stretch = singular_values(supremizers);
  const Matrix range = orthonormal_range(supremizers);
  Matrix rest = Matrix::Zero(enriched.rows(), range.cols());
  rest.topRows(range.rows()) = range;
  rest -= enriched * (enriched.topRows(range.rows()).transpose() * range);
  StabilityBound bound{};
  bound.sigma = std::min(singular_values(rest)(0), 1.0);
  bound.c = stretch(0);
  bound.on = stretch(supremizers.cols() - 1);
  // The smallest cosine between S_R(mu) and the space is sqrt(1 - sigma^2), without cancellation.
  bound.sharp = std::min(infsup_constant(enriched, range), 1.0) * bound.on;
  bound.classic = (bound.on - bound.c * bound.sigma) / (1 + bound.sigma);
  return bound;
}

} // namespace rbvi
