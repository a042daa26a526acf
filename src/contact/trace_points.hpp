// Where the integrals over an edge of a support are taken.
#pragma once

#include "rbvi/contact/curve.hpp"
#include "rbvi/core/functions.hpp"
#include "rbvi/element/quadrature.hpp"

namespace rbvi {

/// A quadrature point of every edge; the weights sum to 1.
struct TracePoint {
  double s; ///< along the edge, 0 ... 1
  double weight;
  std::array<double, 2> eta; ///< of both multipliers: 1 - s and s
  std::array<double, 3> phi; ///< of the displacements: vertices, middle
};

inline TracePoint trace_point(int degree, const EdgePoint &at) {
  return {at.s, at.weight, {1 - at.s, at.s}, edge_functions(degree, at.s)};
}

/// Four Gauss points, or the two vertices: there only the vertex itself moves, a middle is free.
inline std::vector<TracePoint> trace_points(int degree, bool lumped) {
  if (lumped) return {trace_point(degree, {0, 0.5}), trace_point(degree, {1, 0.5})};
  std::vector<TracePoint> points;
  for (const EdgePoint &at : edge_quadrature)
    points.push_back(trace_point(degree, at));
  return points;
}

/// The point of an edge, reference coordinates.
inline Point point_on(const Cell &edge, const TracePoint &at) {
  const Point &begin = edge.reference[0], &end = edge.reference[1];
  return {at.eta[0] * begin[0] + at.eta[1] * end[0], at.eta[0] * begin[1] + at.eta[1] * end[1], 0};
}

} // namespace rbvi
