// Answers of small reduced models by trying every active set.
#pragma once

#include "synthetic.hpp"

#include <gtest/gtest.h>

namespace rbvi::brute {

/// Positive for every form but, on the left half of the box, b: signs change with mu.
inline double smooth(int form, int i, const FullMu &mu) {
  return 1 + 0.3 * form + 0.5 * i * (mu[0] - 0.16) / 0.08 + 0.2 * mu[1] / 0.05;
}

inline double flipping(int form, int i, const FullMu &mu) {
  const double value = smooth(form, i, mu);
  return form == 1 && mu[1] < 0 ? -value : value;
}

struct Operators {
  Matrix a, b;
  Vector f, g;
};

inline Vector combine(const AffineTerms &terms, int form, double (*value)(int, int, const FullMu &),
                      const FullMu &mu) {
  Vector sum = Vector::Zero(terms.reduced.rows());
  for (int q = 0; q < terms.size(); ++q)
    sum += value(form, q, mu) * terms.reduced.col(q);
  return sum;
}

inline Operators assemble(const ReducedModel &model, double (*value)(int, int, const FullMu &),
                          const Mu &free) {
  const FullMu mu = expand(model.scene.parameters, free);
  const Index n = model.primal_size(), r = model.contact.generators;
  Operators result;
  const Vector a = combine(model.body.a, 0, value, mu), b = combine(model.contact.b, 1, value, mu);
  result.a.resize(n, n);
  for (Index j = 0, at = 0; j < n; ++j)
    for (Index i = j; i < n; ++i, ++at)
      result.a(i, j) = result.a(j, i) = a[at];
  result.b = Eigen::Map<const Matrix>(b.data(), r, n);
  result.f = combine(model.body.f, 2, value, mu);
  result.g = combine(model.contact.g, 3, value, mu);
  return result;
}

struct PairAnswer {
  Vector u, x;
};

/// Tries every active set: the one whose KKT system gives x >= 0 and B u <= g holds the solution.
/// The last `free` rows are equations, their multipliers of either sign.
inline PairAnswer brute_force_pair(const Operators &o, Index free = 0) {
  const Index n = o.a.rows(), r = o.b.rows(), bounded = r - free;
  for (int set = 0; set < (1 << bounded); ++set) {
    std::vector<Index> active;
    for (Index i = 0; i < bounded; ++i)
      if ((set >> i) & 1) active.push_back(i);
    const auto signed_ones = static_cast<Index>(active.size());
    for (Index i = bounded; i < r; ++i)
      active.push_back(i);
    const auto k = static_cast<Index>(active.size());
    Matrix system = Matrix::Zero(n + k, n + k);
    Vector right(n + k);
    system.topLeftCorner(n, n) = o.a;
    right.head(n) = o.f;
    for (Index j = 0; j < k; ++j) {
      system.row(n + j).head(n) = o.b.row(active[std::size_t(j)]);
      system.col(n + j).head(n) = o.b.row(active[std::size_t(j)]).transpose();
      right[n + j] = o.g[active[std::size_t(j)]];
    }
    const Eigen::FullPivLU<Matrix> lu(system);
    if (!lu.isInvertible()) continue;
    const Vector solution = lu.solve(right);
    const Vector u = solution.head(n);
    if ((signed_ones > 0 && solution.segment(n, signed_ones).minCoeff() < 0) ||
        (o.b * u - o.g).maxCoeff() > 1e-11 * (1 + u.norm()))
      continue;
    Vector x = Vector::Zero(r);
    x(active) = solution.tail(k);
    return {u, x};
  }
  ADD_FAILURE() << "no active set fits";
  return {Vector::Zero(n), Vector::Zero(r)};
}

inline Vector brute_force(const Operators &o, Index free = 0) {
  return brute_force_pair(o, free).u;
}

inline ReducedModel toy_model(const synthetic::Sizes &sizes, unsigned seed) {
  return synthetic::random_model(sizes, seed, synthetic::toy_scene<smooth>(), true);
}

} // namespace rbvi::brute
