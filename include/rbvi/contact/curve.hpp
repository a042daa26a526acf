// What interfaces along polygonal curves in 2D share.
#pragma once

#include "rbvi/contact/interface.hpp"
#include "rbvi/element/geometry.hpp"

namespace rbvi {

/// Of a straight edge.
inline double edge_length(const Point &begin, const Point &end) {
  const double x = end[0] - begin[0], y = end[1] - begin[1];
  return std::sqrt(x * x + y * y);
}

/// Integrals of the hats of both ends over a straight edge, of a body that is turned over the
/// surface that the edge makes.
std::array<double, 2> hat_weights(const Point &begin, const Point &end, bool axisymmetric);

/// The nodal functions of an edge (its vertices, then of degree 2 its middle) at 0 <= s <= 1, and
/// their derivatives by s.
inline std::array<double, 3> edge_functions(int degree, double s) {
  const double r = 1 - s;
  if (degree == 1) return {r, s, 0};
  return {r * (2 * r - 1), s * (2 * s - 1), 4 * r * s};
}
inline std::array<double, 3> edge_slopes(int degree, double s) {
  if (degree == 1) return {-1, 1, 0};
  return {4 * s - 3, 4 * s - 1, 4 - 8 * s};
}

/// A curve of edges of degree 1 or 2: its vertices in their order, then the middles of the edges.
class NodalCurve {
public:
  NodalCurve(std::vector<Point> nodes, int degree);

  Index nodes() const { return std::ssize(nodes_); }
  Index edges() const { return edges_; }
  int degree() const { return degree_; }
  Index per_edge() const { return degree_ + 1; } ///< nodes
  Index node(Index edge, Index local) const { return local < 2 ? edge + local : edges_ + 1 + edge; }
  const Point &point(Index node) const { return nodes_[node]; }
  std::vector<double> lengths() const;                              ///< of the straight edges
  std::vector<std::array<double, 2>> hats(bool axisymmetric) const; ///< hat_weights of each edge
  Point at(Index edge, double s) const { return sum(edge, edge_functions(degree_, s), nodes_); }
  Point tangent(Index edge, double s) const { return sum(edge, edge_slopes(degree_, s), nodes_); }
  /// Sum of nodal vectors (one for each node of the curve).
  Point sum(Index edge, const std::array<double, 3> &coefficients,
            const std::vector<Point> &of_nodes) const {
    Point result{};
    for (Index k = 0; k < per_edge(); ++k)
      for (std::size_t c = 0; c < 2; ++c)
        result[c] += coefficients[k] * of_nodes[node(edge, k)][c];
    return result;
  }

private:
  std::vector<Point> nodes_;
  int degree_;
  Index edges_;
};

/// Throws bad_input unless part `part` of the mesh is a curve: at least one edge, edge e from
/// vertex e to e + 1, x increasing. Returns its number of vertices.
Index check_curve(const InterfaceMesh &mesh, std::size_t part, const std::string &name);

/// Gram matrix in L2 of the polygon through `points` of its hat functions, `copies` blocks; of a
/// body that is turned in L2 of the surface that it makes.
SparseMatrix linear_gram(const std::vector<Point> &points, int copies, bool axisymmetric = false);

/// The polygon through these nodes of an interface, mapped, with the field "u" (motion + u). `u`:
/// at the nodes of the mesh.
Grid polyline(const Scene &scene, const FullMu &mu, const InterfaceMesh &mesh,
              const std::vector<Index> &nodes, const Vector &u);

/// Adds the field "pressure" to a polyline: one value for each node, or for each edge, then also at
/// the nodes, as the mean of the edges beside them weighted by length.
void add_pressure(const Vector &values, Grid &grid);

} // namespace rbvi
