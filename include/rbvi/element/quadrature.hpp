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

/// Triangles, exact to degree 5 (Radon 1948): 7 points inside of positive weights.
std::vector<QuadraturePoint> radon_quadrature();

/// A point s of [0, 1].
struct EdgePoint {
  double s, weight;
};

/// Gauss, exact to degree 7; the weights sum to 1.
inline constexpr std::array<EdgePoint, 4> edge_quadrature{
    {{0.06943184420297371239, 0.17392742256872692869},
     {0.33000947820757186760, 0.32607257743127307131},
     {0.66999052179242813240, 0.32607257743127307131},
     {0.93056815579702628761, 0.17392742256872692869}}};

} // namespace rbvi
