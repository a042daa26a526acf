#include "rbvi/contact/curve.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rbvi {

namespace {

/// Values of the edges of a polyline at its nodes, weighted by length.
Vector means_at_nodes(const Grid &grid, const Vector &of_edges) {
  Vector sum = Vector::Zero(grid.points.rows()), weight = sum;
  for (Index e = 0; e < of_edges.size(); ++e) {
    const int a = grid.cells[2 * e], b = grid.cells[2 * e + 1];
    const double length = (grid.points.row(b) - grid.points.row(a)).norm();
    for (const int node : {a, b}) {
      sum[node] += length * of_edges[e];
      weight[node] += length;
    }
  }
  return (weight.array() > 0).select(sum.array() / weight.array(), 0.0);
}

/// The numbers of the nodes of a part begin here; of a mesh without parts there is one.
int first_node(const InterfaceMesh &mesh, std::size_t part) {
  return std::accumulate(mesh.parts.begin(), mesh.parts.begin() + static_cast<std::ptrdiff_t>(part),
                         0);
}

/// The edges of a part.
std::vector<Index> edges_of(const InterfaceMesh &mesh, std::size_t part) {
  const int first = first_node(mesh, part),
            end = mesh.parts.empty() ? static_cast<int>(mesh.nodes()) : first + mesh.parts[part];
  std::vector<Index> edges;
  for (Index e = 0; e < mesh.count(); ++e)
    if (const int node = mesh.nodes_of(e)[0]; node >= first && node < end) edges.push_back(e);
  return edges;
}

/// The nodes of some edges, of cells beside a boundary that on it, the body on the left.
std::vector<std::array<int, 2>> edges_of(const InterfaceMesh &mesh,
                                         const std::vector<Index> &entities) {
  std::vector<std::array<int, 2>> edges;
  for (const Index e : entities) {
    const auto [i, j] = simplex_edges[mesh.edges.empty() ? 0 : mesh.edges[e]];
    edges.push_back({mesh.nodes_of(e)[i], mesh.nodes_of(e)[j]});
  }
  return edges;
}

} // namespace

CurveShape::CurveShape(std::vector<CurveChain> chains) : pieces(std::move(chains)) {
  for (const CurveChain &piece : pieces) {
    vertices_ += piece.vertices();
    for (Index k = 0; k < piece.edges; ++k)
      ends.push_back({piece.first_vertex + k, piece.first_vertex + (k + 1) % piece.vertices()});
  }
}

ChainedEdges chained(const std::vector<std::array<int, 2>> &edges) {
  std::vector<int> vertices;
  std::vector<CurveChain> pieces;
  for (std::size_t e = 0; e < edges.size();) {
    const auto shares = [&](std::size_t one, int end, int other) {
      return one + 1 < edges.size() && edges[one][end] == edges[one + 1][other];
    };
    const int from = shares(e, 1, 0) || !shares(e, 0, 1) ? 0 : 1, to = 1 - from;
    CurveChain piece{static_cast<Index>(e), 1, std::ssize(vertices)};
    const int first = edges[e][from];
    vertices.push_back(first);
    for (; edges[e][to] != first && shares(e, to, from); ++e, ++piece.edges)
      vertices.push_back(edges[e][to]);
    piece.loop = edges[e][to] == first;
    if (!piece.loop) vertices.push_back(edges[e][to]);
    pieces.push_back(piece);
    ++e;
  }
  return {std::move(vertices), CurveShape(std::move(pieces))};
}

NodalCurve::NodalCurve(std::vector<Point> nodes, int degree,
                       std::shared_ptr<const CurveShape> shape)
    : nodes_(std::move(nodes)), degree_(degree), shape_(std::move(shape)) {}

NodalCurve::NodalCurve(std::vector<Point> nodes, int degree)
    : nodes_(std::move(nodes)), degree_(degree),
      shape_(std::make_shared<CurveShape>(
          std::vector{CurveChain{0, (std::ssize(nodes_) - 1) / degree, 0}})) {}

std::array<double, 2> hat_weights(const Point &begin, const Point &end, bool axisymmetric) {
  const double half = edge_length(begin, end) / 2;
  return {half * circumference(axisymmetric, (2 * begin + end) / 3),
          half * circumference(axisymmetric, (begin + 2 * end) / 3)};
}

HatWeights NodalCurve::hats(bool axisymmetric) const {
  HatWeights hats;
  for (Index e = 0; e < edges(); ++e)
    hats.push_back(hat_weights(end(e, 0), end(e, 1), axisymmetric));
  return hats;
}

std::vector<double> NodalCurve::lengths() const {
  std::vector<double> lengths;
  lengths.reserve(edges());
  for (Index e = 0; e < edges(); ++e)
    lengths.push_back(edge_length(end(e, 0), end(e, 1)));
  return lengths;
}

CurveShape curve_shape(const InterfaceMesh &mesh, std::size_t part, const std::string &name) {
  if (mesh.dim != 2)
    throw bad_input("the " + name + " is a curve in two dimensions: the mesh has " +
                    std::to_string(mesh.dim));
  const int nodes = part < mesh.parts.size() ? mesh.parts[part] : 0;
  std::vector<Index> own;
  if (nodes > 0 && mesh.per_entity == mesh.degree + 1) own = edges_of(mesh, part);
  if (own.empty())
    throw bad_input("the " + name + " needs at least one edge, but has " + std::to_string(nodes) +
                    (nodes == 1 ? " node" : " nodes") + " of degree " +
                    std::to_string(mesh.degree));
  const int first = first_node(mesh, part);
  auto [vertices, shape] = chained(edges_of(mesh, own));
  const auto count = static_cast<int>(shape.vertices());
  bool fits = nodes == count + (mesh.degree == 2 ? shape.edges() : Index{0});
  for (int v = 0; v < count; ++v)
    fits = fits && vertices[v] == first + v;
  for (std::size_t e = 0; e < own.size() && mesh.degree == 2; ++e)
    fits = fits && mesh.nodes_of(own[e])[2] == first + count + static_cast<int>(e);
  if (!fits)
    throw bad_input("the edges of the " + name + " do not go from vertex to vertex of its " +
                    std::to_string(nodes) + " nodes of degree " + std::to_string(mesh.degree));
  return std::move(shape);
}

ChainedEdges first_curve(const InterfaceMesh &mesh) {
  return chained(edges_of(mesh, edges_of(mesh, 0)));
}

std::size_t count_ends(const InterfaceMesh &mesh) {
  if (mesh.dim == 3) return mesh.points.size();
  std::vector<Index> all(static_cast<std::size_t>(mesh.count()));
  std::iota(all.begin(), all.end(), Index{0});
  return 2 * chained(edges_of(mesh, all)).shape.pieces.size();
}

namespace {

/// The ends of an edge of one boundary, the body on the left.
std::array<Point, 2> ends_of(const InterfaceMesh &mesh, Index e) {
  const auto [i, j] = simplex_edges[mesh.edges.empty() ? 0 : mesh.edges[e]];
  return {mesh.points[mesh.nodes_of(e)[i]], mesh.points[mesh.nodes_of(e)[j]]};
}

} // namespace

int middle_node(const InterfaceMesh &mesh, Index e) {
  if (mesh.degree == 1) return mesh.nodes_of(e)[0];
  return mesh.nodes_of(e)[mesh.edges.empty() ? 2 : 3 + mesh.edges[e]];
}

void check_body_normal(const Scene &scene, const Facing &facing, const InterfaceMesh &mesh) {
  constexpr double scatter = 0.02; // of vertices near each other
  if (!facing.body_normal) return;
  FullMu mu;
  for (const Parameter &parameter : scene.parameters.all)
    mu.push_back(parameter.value);
  for (Index e = 0; e < mesh.count(); ++e) {
    const auto [begin, end] = ends_of(mesh, e);
    const Point along = scene.map(mu, end) - scene.map(mu, begin), middle = (begin + end) / 2,
                n = facing.body_normal(mu, middle),
                of_edge = Point{along[1], -along[0], 0} / norm(along);
    const double turning = norm(facing.body_normal(mu, end) - facing.body_normal(mu, begin));
    if (!(norm(n - of_edge) <= turning / 4 + scatter))
      throw bad_input("scene " + scene.name + ": the normal of the contact boundary at (" +
                      short_number(middle[0]) + ", " + short_number(middle[1]) + ") is (" +
                      short_number(n[0]) + ", " + short_number(n[1]) + "), and that of its edge (" +
                      short_number(of_edge[0]) + ", " + short_number(of_edge[1]) +
                      "): does the boundary have another circle, or is it that of a hole?");
  }
}

Facing on_arcs(Facing facing, const InterfaceMesh &mesh) {
  struct Arc {
    Point begin, chord, centre;
    double radius;
  };
  constexpr double straight = 1e-9; // of the chord
  std::vector<Arc> arcs;
  for (Index e = 0; e < mesh.count() && mesh.degree == 2; ++e) {
    const auto [begin, end] = ends_of(mesh, e);
    const Point &middle = mesh.points[middle_node(mesh, e)];
    const Point rise = middle - (begin + end) / 2, chord = end - begin;
    const double height = norm(rise), half = norm(chord) / 2;
    if (height <= straight * half) continue;
    const double radius = (half * half + height * height) / (2 * height);
    arcs.push_back({begin, chord, middle - radius / height * rise, radius});
  }
  if (arcs.empty()) return facing;
  facing.on_curve = [arcs = std::move(arcs)](const Point &x) {
    for (const Arc &arc : arcs) {
      const Point from = x - arc.begin, out = x - arc.centre;
      const double along = dot(from, arc.chord) / dot(arc.chord, arc.chord);
      if (along >= -straight && along <= 1 + straight &&
          norm(from - along * arc.chord) <= straight * norm(arc.chord))
        return arc.centre + arc.radius / norm(out) * out;
    }
    return x;
  };
  return facing;
}

SparseMatrix linear_gram(const std::vector<Point> &points, const CurveShape &shape, int copies,
                         bool axisymmetric) {
  const auto around = [&](const Point &x) { return circumference(axisymmetric, x); };
  const Index vertices = shape.vertices();
  std::vector<Eigen::Triplet<double>> entries;
  for (Index k = 0; k < copies; ++k)
    for (const auto &[a, b] : shape.ends) {
      const Point &x = points[a], &y = points[b];
      const double length = edge_length(x, y);
      const Index i = k * vertices + a, j = k * vertices + b;
      // The mean radius that the product of two hats sees on an edge is that of 3 parts of its end
      // to one of the other for a square, else that of the middle.
      entries.emplace_back(i, i, length / 3 * around((3 * x + y) / 4));
      entries.emplace_back(j, j, length / 3 * around((x + 3 * y) / 4));
      entries.emplace_back(i, j, length / 6 * around((x + y) / 2));
      entries.emplace_back(j, i, length / 6 * around((x + y) / 2));
    }
  SparseMatrix product(vertices * copies, vertices * copies);
  product.setFromTriplets(entries.begin(), entries.end());
  return product;
}

Grid polyline(const Scene &scene, const FullMu &mu, const InterfaceMesh &mesh,
              const std::vector<CurvePlace> &places, std::vector<int> cells, const Vector &u,
              const std::vector<CurvePlace> &middles) {
  const auto [vertices, shape] = first_curve(mesh);
  const std::vector<Index> entities = edges_of(mesh, 0);
  std::vector<Point> ends;
  for (const int vertex : vertices)
    ends.push_back(mesh.points[vertex]);
  const Matrix mapped = mapped_points(scene, mu, ends);
  const Vector moved = moved_nodes(scene, mu, mesh, u);
  const auto moved_at = [&, &numbers = vertices,
                         &ends = shape.ends](const std::vector<CurvePlace> &at) {
    Vector result(3 * std::ssize(at));
    for (Index k = 0; k < std::ssize(at); ++k) {
      const auto [edge, s] = at[k];
      const std::array<double, 3> phi = edge_functions(mesh.degree, s);
      const std::array<int, 3> nodes{numbers[ends[edge][0]], numbers[ends[edge][1]],
                                     middle_node(mesh, entities[edge])};
      result.segment<3>(3 * k).setZero();
      for (std::size_t i = 0; i < nodes.size(); ++i)
        result.segment<3>(3 * k) += phi[i] * moved.segment<3>(Index{3} * nodes[i]);
    }
    return result;
  };
  Matrix points(std::ssize(places), scene.dim);
  for (Index k = 0; k < points.rows(); ++k) {
    const auto [edge, s] = places[k];
    const auto [a, b] = shape.ends[edge];
    points.row(k) = (1 - s) * mapped.row(a) + s * mapped.row(b);
  }
  Grid grid{std::move(points), std::move(cells), 2, {{"u", moved_at(places), "m"}}, {}, {}};
  if (!middles.empty()) grid.of_cells.push_back({"u_middle", moved_at(middles), "m"});
  return grid;
}

void add_stress(const std::string &name, const Vector &values, bool of_edges, Grid &grid) {
  if (of_edges) grid.of_cells.push_back({name, values, "Pa"});
  grid.of_nodes.push_back({name, of_edges ? means_at_nodes(grid, values) : values, "Pa"});
}

} // namespace rbvi
