// What interfaces along polygonal curves in 2D share.
#pragma once

#include "rbvi/contact/facing.hpp"
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
using HatWeights = std::vector<std::array<double, 2>>; ///< of each edge

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

/// A chain of edges: edge first_edge + k goes from vertex first_vertex + k to the next one, the
/// last edge of a closed one back to the first vertex.
struct CurveChain {
  Index first_edge, edges, first_vertex;
  bool loop = false;
  Index vertices() const { return edges + (loop ? 0 : 1); }
};

/// How the edges of a curve hang together, in one piece or several, and the numbers of its nodes:
/// vertices along the pieces, then the middles of the edges.
struct CurveShape {
  std::vector<CurveChain> pieces;
  std::vector<std::array<Index, 2>> ends{}; ///< vertices of each edge, along its piece

  explicit CurveShape(std::vector<CurveChain> chains);
  Index edges() const { return std::ssize(ends); }
  Index vertices() const { return vertices_; }
  Index node(Index edge, Index local) const {
    return local < 2 ? ends[edge][local] : vertices_ + edge;
  }

private:
  Index vertices_ = 0;
};

inline bool is_one_open_piece(const CurveShape &shape) {
  return shape.pieces.size() == 1 && !shape.pieces.front().loop;
}

/// Of the first boundary, which has this shape.
inline std::vector<Point> vertices_of(const InterfaceMesh &mesh, const CurveShape &shape) {
  return {mesh.points.begin(), mesh.points.begin() + shape.vertices()};
}

/// Successive edges with their shape, whatever the numbers of their vertices.
struct ChainedEdges {
  std::vector<int> vertices; ///< those numbers, along the pieces
  CurveShape shape;
};
/// `edges`: in the order of InterfaceMesh.
ChainedEdges chained(const std::vector<std::array<int, 2>> &edges);

/// A curve of edges of degree 1 or 2.
class NodalCurve {
public:
  NodalCurve(std::vector<Point> nodes, int degree, std::shared_ptr<const CurveShape> shape);
  /// In one open piece.
  NodalCurve(std::vector<Point> nodes, int degree);

  Index nodes() const { return std::ssize(nodes_); }
  Index edges() const { return shape_->edges(); }
  int degree() const { return degree_; }
  const CurveShape &shape() const { return *shape_; }
  const std::shared_ptr<const CurveShape> &shared_shape() const { return shape_; }
  Index per_edge() const { return degree_ + 1; } ///< nodes
  Index node(Index edge, Index local) const { return shape_->node(edge, local); }
  const Point &point(Index node) const { return nodes_[node]; }
  const Point &end(Index edge, Index local) const { return nodes_[shape_->ends[edge][local]]; }
  std::vector<double> lengths() const; ///< of the straight edges
  HatWeights hats(bool axisymmetric) const;
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
  std::shared_ptr<const CurveShape> shape_;
};

/// The shape of part `part` of the mesh. Throws bad_input unless it is a curve in the order of
/// InterfaceMesh, of at least one edge.
CurveShape curve_shape(const InterfaceMesh &mesh, std::size_t part, const std::string &name);

/// The edges of the first boundary of a mesh, which may be one of cells beside it.
ChainedEdges first_curve(const InterfaceMesh &mesh);
/// Numbers in InterfaceMesh::closed_ends, where there are any.
std::size_t count_ends(const InterfaceMesh &mesh);

/// With the circular arcs through the ends and the middles of edges of degree 2, where a middle is
/// off its edge (move_middles): Facing::on_curve.
Facing on_arcs(Facing facing, const InterfaceMesh &mesh);
/// Throws bad_input where the normal that a facing has of the body's boundary is off that of an
/// edge by more than a quarter of its turn along it.
void check_body_normal(const Scene &scene, const Facing &facing, const InterfaceMesh &mesh);

/// Gram matrix in L2 of the hat functions of the polygon through `points`, `copies` blocks; of a
/// body that is turned in L2 of the surface that it makes.
SparseMatrix linear_gram(const std::vector<Point> &points, const CurveShape &shape, int copies,
                         bool axisymmetric = false);

/// A place on a curve.
struct CurvePlace {
  Index edge;
  double s = 0;
  double minus(const CurvePlace &other) const { // in edges
    return static_cast<double>(edge - other.edge) + s - other.s;
  }
};

/// The node in the middle of an edge of one boundary; of degree 1 an end.
int middle_node(const InterfaceMesh &mesh, Index e);

/// Lines between places of the first boundary of an interface, mapped, with the field "u" (motion +
/// u). `cells`: two places each; `u`: at the nodes of the mesh. `middles`: the middles of the
/// cells, whose u is then the field "u_middle" of cells.
Grid polyline(const Scene &scene, const FullMu &mu, const InterfaceMesh &mesh,
              const std::vector<CurvePlace> &places, std::vector<int> cells, const Vector &u,
              const std::vector<CurvePlace> &middles = {});

/// Adds a stress to a polyline: one value for each node, or for each edge, then also at the nodes,
/// as the mean of the edges beside them weighted by length.
void add_stress(const std::string &name, const Vector &values, bool of_edges, Grid &grid);

} // namespace rbvi
