// A model of the compliance of an elastic half-plane, for contact with friction.
#pragma once

#include "rbvi/core/dense.hpp"

#include <cmath>

namespace rbvi {

/// Pressures and then the tangential parts of every node in turn, as in friction.hpp: a logarithmic
/// kernel in all directions, and a pressure moves the surface on its left and right in opposite
/// tangential directions.
inline Matrix half_plane(Index nodes, int dim = 2, double coupling = 0.2) {
  const double size = static_cast<double>(nodes);
  Matrix h = Matrix::Zero(nodes * dim, nodes * dim);
  for (Index i = 0; i < nodes; ++i)
    for (Index j = 0; j < nodes; ++j) {
      const double distance = static_cast<double>(i - j);
      const double kernel = std::log(3 * size / (std::abs(distance) + 0.25)) / size;
      const Index ti = nodes + i * (dim - 1), tj = nodes + j * (dim - 1);
      h(i, j) = kernel;
      for (int k = 0; k < dim - 1; ++k)
        h(ti + k, tj + k) = kernel;
      if (i != j && dim > 1) h(i, tj) = h(tj, i) = std::copysign(coupling / size, distance);
    }
  return h;
}

} // namespace rbvi
