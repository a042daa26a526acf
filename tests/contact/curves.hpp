// Polygonal curves for tests of contact operators.
#pragma once

#include "../method/random_matrix.hpp"
#include "rbvi/contact/interface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace rbvi {

using Curve = std::vector<Point>;

inline Index size(const Curve &curve) {
  return static_cast<Index>(curve.size());
}

/// The nodes and edges of a polygon, with the middles of its edges (degree 2); no dofs yet.
inline InterfaceMesh curve_mesh(const Curve &vertices, int degree) {
  InterfaceMesh mesh;
  mesh.degree = degree;
  mesh.per_entity = degree + 1;
  mesh.points = vertices;
  for (int e = 0; e + 1 < static_cast<int>(vertices.size()); ++e) {
    const Point &a = vertices[e], &b = vertices[static_cast<std::size_t>(e) + 1];
    mesh.entities.insert(mesh.entities.end(), {e, e + 1});
    if (degree == 1) continue;
    mesh.entities.push_back(static_cast<int>(vertices.size()) + e);
    mesh.points.push_back({(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, 0});
  }
  return mesh;
}

/// Height of a polygon at x, by a search of all its edges.
inline double height_at(const Curve &curve, double x) {
  for (std::size_t i = 0; i + 1 < curve.size(); ++i)
    if (curve[i][0] <= x && x <= curve[i + 1][0]) {
      const double t = (x - curve[i][0]) / (curve[i + 1][0] - curve[i][0]);
      return (1 - t) * curve[i][1] + t * curve[i + 1][1];
    }
  ADD_FAILURE() << x << " is beyond the curve";
  return 0;
}

/// Edges of random length, and random heights within 0.1 of `height`.
inline Curve random_curve(Random &random, Index edges, double begin, double end, double height) {
  Vector x = 0.9 * random.vector(edges + 1).cwiseAbs() + Vector::Constant(edges + 1, 0.1);
  x[0] = 0;
  for (Index i = 0; i < edges; ++i)
    x[i + 1] += x[i];
  Curve curve;
  for (Index i = 0; i <= edges; ++i)
    curve.push_back({begin + (end - begin) * x[i] / x[edges], height + 0.1 * random(), 0});
  return curve;
}

/// Edges of equal length.
inline Curve line(Index edges, double begin, double end, double height) {
  Curve curve;
  for (Index i = 0; i <= edges; ++i) {
    const double s = static_cast<double>(i) / static_cast<double>(edges);
    curve.push_back({(1 - s) * begin + s * end, height, 0});
  }
  return curve;
}

inline Curve moved(Curve curve, double dx) {
  for (Point &p : curve)
    p[0] += dx;
  return curve;
}

inline double length(const Curve &curve, Index edge) {
  const auto i = static_cast<std::size_t>(edge);
  return std::hypot(curve[i + 1][0] - curve[i][0], curve[i + 1][1] - curve[i][1]);
}

inline double length(const Curve &curve) {
  double sum = 0;
  for (Index edge = 0; edge + 1 < size(curve); ++edge)
    sum += length(curve, edge);
  return sum;
}

/// Values at x of the P1 functions of the curve, by a search of all its edges; zero off the curve.
inline Vector hats(const Curve &curve, double x) {
  Vector values = Vector::Zero(size(curve));
  for (std::size_t i = 0; i + 1 < curve.size(); ++i)
    if (curve[i][0] <= x && x < curve[i + 1][0]) {
      const double t = (x - curve[i][0]) / (curve[i + 1][0] - curve[i][0]);
      values[static_cast<Index>(i)] = 1 - t;
      values[static_cast<Index>(i) + 1] = t;
    }
  return values;
}

inline Vector heights(const Curve &curve) {
  Vector y(size(curve));
  std::ranges::transform(curve, y.begin(), [](const Point &p) { return p[1]; });
  return y;
}

/// Compressed, with increasing columns in each row.
inline void expect_sorted(const SparseMatrix &m) {
  EXPECT_TRUE(m.isCompressed());
  EXPECT_EQ(m.outerIndexPtr()[0], 0);
  for (Index row = 0; row < m.rows(); ++row)
    for (Index k = m.outerIndexPtr()[row]; k < m.outerIndexPtr()[row + 1]; ++k) {
      EXPECT_GE(m.innerIndexPtr()[k], 0);
      EXPECT_LT(m.innerIndexPtr()[k], m.cols());
      EXPECT_TRUE(k == m.outerIndexPtr()[row] || m.innerIndexPtr()[k - 1] < m.innerIndexPtr()[k]);
    }
}

} // namespace rbvi
