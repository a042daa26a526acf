// Random simplices of degree 1 or 2 and the element matrices of forms, for tests.
#pragma once

#include "../method/random_matrix.hpp"
#include "rbvi/element/lagrange.hpp"

#include <functional>
#include <vector>

namespace rbvi {

using Vertices = std::array<Point, 4>;

inline Vertices random_cell(int dim, Random &random) {
  Vertices x{};
  do
    for (std::size_t i = 0; i <= static_cast<std::size_t>(dim); ++i)
      for (std::size_t c = 0; c < static_cast<std::size_t>(dim); ++c)
        x[i][c] = random();
  while (simplex(dim, x).volume < 0.1);
  return x;
}

/// Its first `dim` coordinates in [-1, 1], the others 0.
inline Eigen::Vector3d random_point(int dim, Random &random) {
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  for (int c = 0; c < dim; ++c)
    x[c] = random();
  return x;
}

/// Its leading dim x dim block in [-1, 1], the rest 0.
inline Eigen::Matrix3d random_block(int dim, Random &random) {
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  for (int c = 0; c < dim; ++c)
    m.row(c) = random_point(dim, random);
  return m;
}

/// The matrix of a bilinear form on a cell that is mapped by the identity.
inline Matrix evaluate(const Form &form, int dim, const Vertices &x, int components,
                       int degree = 1) {
  const Index k = nodes_per_cell(dim, degree) * components;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> m(k, k);
  form.kernel({}, {dim, x, x}, m.data());
  return m;
}

/// Vertices, then the middles of the edges, listed here by hand.
inline std::vector<Eigen::Vector3d> nodes_of(int dim, int degree, const Vertices &x) {
  std::vector<Eigen::Vector3d> nodes;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(dim); ++i)
    nodes.emplace_back(x[i][0], x[i][1], x[i][2]);
  if (degree == 1) return nodes;
  const auto middle = [&nodes](std::size_t i, std::size_t j) {
    nodes.push_back((nodes[i] + nodes[j]) / 2);
  };
  middle(0, 1);
  if (dim >= 2) middle(1, 2);
  if (dim >= 2) middle(2, 0);
  for (std::size_t i = 0; dim == 3 && i < 3; ++i)
    middle(i, 3);
  return nodes;
}

} // namespace rbvi
