// Block Gram-Schmidt, with BV on the ranks and with matrices on one core.
#pragma once

#include "rbvi/core/dense.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <vector>

namespace rbvi {

/// Columns that have enough of their own beside those before them for one Cholesky factor of their
/// Gram matrix.
struct Fit {
  std::vector<Index> columns;
  Matrix rotation;  ///< X times it: these columns, orthonormal
  double least = 1; ///< the part of its norm that one of them has of its own
};

/// Of these candidates, in their order. `gram`: X^T P X of all columns.
Fit fit_columns(const Matrix &gram, const std::vector<Index> &candidates);

/// Old positions of the columns that stay, and the rotation that brings them there.
struct Order {
  std::vector<Index> columns;
  Matrix rotation;
};

/// Those that fit, the other candidates, and those behind the first `among` of `all` columns.
Order fitting_first(const Fit &fit, const std::vector<Index> &candidates, Index among, Index all);

/// Makes the first `count` columns of a block orthonormal to a basis and to each other, and appends
/// them, but for those of which no more than `tolerance` of their norm is left. Returns which were
/// taken. A column of which little is left waits for the others, so that factors have small
/// condition; one that fitted by round-off alone is found so by the next factor. The basis has, for
/// the first n columns of a block X,
///   Matrix gram(block, n)            X^T P X; throws failure where it is not finite
///   Vector remove(block, n)          X <- X - Q Q^T P X; the norm of what each column loses
///   void rotate(block, Y)            X <- X Y
///   void take(block, n)              Q <- (Q, X)
template <class Basis, class Block>
std::vector<int> append_block(Basis &basis, Block &block, Index count, double tolerance) {
  constexpr double little = 0.1; // of its own: what one step leaves is not orthogonal to the rest
  std::vector<Index> waiting(count); // the numbers of the first columns of the block
  std::iota(waiting.begin(), waiting.end(), Index{0});
  Vector whole; // norms of the columns, scaled as they are
  std::vector<int> taken;
  // Those of the candidates that fit, orthonormal, and behind them the other candidates.
  const auto orthonormalise = [&](const Matrix &gram, const std::vector<Index> &candidates) {
    Fit fit = fit_columns(gram, candidates);
    const auto fitting = std::ssize(fit.columns);
    const auto [order, rotation] = fitting_first(fit, candidates, gram.rows(), std::ssize(waiting));
    basis.rotate(block, rotation);
    for (Index k = 0; k < fitting; ++k)
      whole[waiting[order[k]]] *= fit.rotation(order[k], k);
    std::vector<Index> now;
    std::ranges::transform(order, std::back_inserter(now), [&](Index j) { return waiting[j]; });
    waiting = std::move(now);
    return fit;
  };
  while (!waiting.empty()) {
    Matrix gram;
    std::vector<Index> candidates;
    for (bool lost = true; lost;) { // until what is left is orthogonal to the basis
      const Vector removed = basis.remove(block, std::ssize(waiting));
      gram = basis.gram(block, std::ssize(waiting));
      const Vector left = gram.diagonal().cwiseMax(0).cwiseSqrt();
      if (whole.size() == 0) whole = (left.array().square() + removed.array().square()).sqrt();
      candidates.clear();
      for (Index j = 0; j < left.size(); ++j)
        if (left[j] > tolerance * whole[waiting[j]]) candidates.push_back(j);
      lost = std::ranges::any_of(candidates, [&](Index j) { return left[j] < removed[j]; });
    }
    if (candidates.empty()) break;
    Fit fit = orthonormalise(gram, candidates);
    bool amplified = fit.least < little;
    for (bool near = false; !near; amplified = !near) { // until one factor leaves round-off
      const Index fitting = std::ssize(fit.columns);
      if (amplified) basis.remove(block, fitting);
      gram = basis.gram(block, fitting);
      near = (gram - Matrix::Identity(fitting, fitting)).norm() <= little;
      std::vector<Index> all(fitting);
      std::iota(all.begin(), all.end(), Index{0});
      fit = orthonormalise(gram, all);
    }
    const Index fitting = std::ssize(fit.columns), others = std::ssize(waiting) - fitting;
    basis.take(block, fitting);
    if (others > 0)
      basis.rotate(block, Matrix::Identity(fitting + others, fitting + others).rightCols(others));
    for (Index k = 0; k < fitting; ++k)
      taken.push_back(static_cast<int>(waiting[k]));
    waiting.erase(waiting.begin(), waiting.begin() + fitting);
  }
  std::ranges::sort(taken);
  return taken;
}

} // namespace rbvi
