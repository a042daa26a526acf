// Quadrature on simplices of any dimension.
#pragma once

#include <array>
#include <vector>

namespace rbvi {

struct QuadraturePoint {
  std::array<double, 4> barycentric; ///< dim + 1 coordinates that sum to 1
  double weight;                     ///< relative to the volume: the weights sum to 1
};

/// Grundmann and Moeller (1978), exact to degree 2 s + 1 >= `degree`: s = 0, 1, 2, ...; some
/// weights are negative. dim = 1, 2, 3.
std::vector<QuadraturePoint> simplex_quadrature(int dim, int degree);

/// Exact to degree 2: dim + 1 points inside, each of weight 1 / (dim + 1). dim = 1, 2, 3.
std::vector<QuadraturePoint> positive_quadrature(int dim);

} // namespace rbvi
