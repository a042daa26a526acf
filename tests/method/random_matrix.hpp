// Reproducible random matrices for tests.
#pragma once

#include "rbvi/core/dense.hpp"

#include <random>

namespace rbvi {

/// Uniform in [-1, 1].
class Random {
public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()() { return uniform_(engine_); }
  Matrix matrix(Index rows, Index columns) {
    return Matrix::NullaryExpr(rows, columns, [this] { return (*this)(); });
  }
  Vector vector(Index size) { return matrix(size, 1); }

private:
  std::mt19937 engine_;
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

} // namespace rbvi
