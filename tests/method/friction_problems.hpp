// Problems of contact with friction, and what their solutions must fulfil.
#pragma once

#include "columns.hpp"
#include "half_plane.hpp"
#include "random_matrix.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/method/friction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

struct FrictionProblem {
  Matrix h;
  Vector q;
  int dim = 2;

  Index nodes() const { return q.size() / dim; }
  Index tangent(Index i) const { return nodes() + i * (dim - 1); }
};

inline double bound_of(const FrictionBound &bound, double normal) {
  const double threshold = normal > 0 || !bound.only_in_contact ? bound.threshold : 0;
  return std::min(bound.coefficient * std::max(normal - bound.pull, 0.0) + threshold, bound.limit);
}

inline Vector projected(const Vector &y, double radius) {
  return y.norm() > radius ? Vector(y * (radius / y.norm())) : y;
}

/// The definition: how far x is from the projections of x - rho w, rho = 1 / H_ii, in the scaling
/// of a unit diagonal and relative to the largest x or the terms of the row.
inline double violation(const FrictionProblem &p, const FrictionBound &bound, const Vector &x) {
  const Vector w = p.h * x + p.q, terms = p.h.cwiseAbs() * x.cwiseAbs() + p.q.cwiseAbs();
  const Vector root = p.h.diagonal().cwiseSqrt();
  const double largest = root.cwiseProduct(x).cwiseAbs().maxCoeff();
  double worst = 0;
  const auto add = [&](Index j, double distance) {
    if (distance > 0)
      worst = larger(worst, distance * root[j] / std::max(largest, terms[j] / root[j]));
  };
  for (Index i = 0; i < p.nodes(); ++i) {
    if (x[i] < 0) return std::numeric_limits<double>::infinity();
    add(i, std::abs(x[i] - std::max(0.0, x[i] - w[i] / p.h(i, i))));
    if (p.dim == 1) continue;
    const Index t = p.tangent(i), count = p.dim - 1;
    const Vector now = x.segment(t, count), y = now - w.segment(t, count) / p.h(t, t);
    add(t, (now - projected(y, bound_of(bound, x[i]))).norm());
  }
  return worst;
}

inline FrictionResult expect_solved(const FrictionProblem &p, const FrictionBound &bound,
                                    const Vector &start = {}) {
  std::set<Index> given;
  const FrictionResult result = solve_friction(once(p.h, given), p.q, p.dim, bound, start);
  EXPECT_TRUE(result.converged) << result.reason;
  EXPECT_LT(violation(p, bound, result.x), 1e-12);
  EXPECT_LT(result.residual, 1e-12);
  EXPECT_EQ(result.columns, static_cast<int>(given.size()));
  EXPECT_LE((result.w - (p.h * result.x + p.q)).norm(),
            1e-12 * (p.q.norm() + (p.h * result.x).norm()));
  EXPECT_TRUE(std::is_sorted(result.active.begin(), result.active.end()));
  for (Index i = 0; i < p.nodes(); ++i) {
    const bool listed = std::binary_search(result.active.begin(), result.active.end(), i);
    EXPECT_EQ(listed, result.x[i] > 0);
    EXPECT_EQ(listed, result.states[i] != NodeState::open);
  }
  return result;
}

inline const std::vector<FrictionBound> all_bounds{
    {0, 0, false},  {0.3, 0, false},   {0.8, 0, false}, {0, 0.2, false},
    {0, 0.2, true}, {0.2, 0.1, false}, {0.2, 0.1, true}};

inline Matrix random_positive(Random &random, Index n, double least) {
  const Matrix b = random.matrix(n, n);
  return b * b.transpose() + least * Matrix::Identity(n, n);
}

/// Condition number 1e8, eigenvectors at random.
inline Matrix ill_conditioned(Random &random, Index n) {
  const Matrix orthogonal = random.matrix(n, n).householderQr().householderQ();
  const Vector spectrum = Vector::NullaryExpr(n, [&](Index i) {
    return std::pow(10, -8 * static_cast<double>(i) / static_cast<double>(n - 1));
  });
  const Matrix h = orthogonal * spectrum.asDiagonal() * orthogonal.transpose();
  return 0.5 * (h + h.transpose());
}

/// A round punch on a half-plane, of half-width `radius` in nodes where it would cut the surface,
/// pushed by `slide` along it.
inline FrictionProblem punch(Index nodes, int dim, double radius, double slide) {
  FrictionProblem p{half_plane(nodes, dim), Vector::Zero(nodes * dim), dim};
  for (Index i = 0; i < nodes; ++i) {
    const double u = (static_cast<double>(i) - 0.45 * static_cast<double>(nodes)) / radius;
    p.q[i] = u * u - 1;
    for (int k = 0; k < dim - 1; ++k)
      p.q[p.tangent(i) + k] = slide * (1 - 0.5 * k) + 0.2 * slide * std::sin(u + k);
  }
  return p;
}

} // namespace rbvi
