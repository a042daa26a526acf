#include "rbvi/contact/support/support.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/quadrature.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// Integrals over an edge: multiplier of vertex e or e + 1, displacement of vertex e, e + 1 or the
/// middle.
using Products = std::array<std::array<double, 3>, 2>;

/// A quadrature point of every edge; the weights sum to 1.
struct TracePoint {
  double weight;
  std::array<double, 2> eta; ///< of both multipliers: 1 - s and s
  Products products;         ///< weight * multiplier * displacement
};

TracePoint trace_point(int degree, const EdgePoint &at) {
  TracePoint point{at.weight, {1 - at.s, at.s}, {}};
  std::array<double, 3> phi{};
  lagrange_values(1, degree, point.eta, phi);
  for (std::size_t a = 0; a < 2; ++a)
    for (std::size_t node = 0; node < 3; ++node)
      point.products[a][node] = at.weight * point.eta[a] * phi[node];
  return point;
}

/// Four Gauss points, or the two vertices: there only the vertex itself moves, a middle is free.
std::vector<TracePoint> trace_points(int degree, bool lumped) {
  if (lumped) return {trace_point(degree, {0, 0.5}), trace_point(degree, {1, 0.5})};
  std::vector<TracePoint> points;
  for (const EdgePoint &at : edge_quadrature)
    points.push_back(trace_point(degree, at));
  return points;
}

/// The indices of what the multipliers of a curve couple. The row of a vertex holds the columns of
/// the vertices and the middles of its one or two edges.
struct Pattern {
  std::size_t vertices, middles; ///< middles: 0 of degree 1

  std::size_t edges() const { return vertices - 1; }
  std::size_t columns() const { return 2 * (vertices + middles); }
  std::size_t first_edge(std::size_t row) const { return row == 0 ? 0 : row - 1; }
  std::size_t edges_of(std::size_t row) const {
    return std::min(row + 1, edges()) - first_edge(row);
  }
  std::size_t entries(std::size_t row) const {
    return 2 * (edges_of(row) + 1 + (middles > 0 ? edges_of(row) : 0));
  }
  /// Where in the row the x component of a node of an edge is: 0, 1 its vertices, 2 its middle.
  std::size_t entry(std::size_t row, std::size_t edge, std::size_t node) const {
    const std::size_t local = edge - first_edge(row);
    return 2 * (node < 2 ? local + node : edges_of(row) + 1 + local);
  }
};

void check_curve(const SupportCurve &curve) {
  const auto vertices = static_cast<std::size_t>(std::max<Index>(0, curve.vertices));
  if (vertices < 2)
    throw bad_input("the support's boundary needs at least one edge, but has " +
                    std::to_string(vertices) + " vertices");
  if (curve.points.size() < vertices)
    throw bad_input("the support's boundary has " + std::to_string(vertices) +
                    " vertices, but only " + std::to_string(curve.points.size()) + " points");
  for (std::size_t i = 1; i < vertices; ++i)
    if (!(curve.points[i - 1][0] < curve.points[i][0]))
      throw bad_input("x must increase along the support's boundary, but vertex " +
                      std::to_string(i) + " at x = " + short_number(curve.points[i][0]) +
                      " follows x = " + short_number(curve.points[i - 1][0]));
}

Pattern pattern_of(const SupportCurve &curve, int degree) {
  check_degree(degree);
  check_curve(curve);
  const auto vertices = static_cast<std::size_t>(curve.vertices);
  const Pattern pattern{vertices, degree == 2 ? vertices - 1 : 0};
  if (curve.points.size() != pattern.columns() / 2)
    throw bad_input("a support's boundary of " + std::to_string(vertices) + " vertices has " +
                    std::to_string(pattern.columns() / 2) + " nodes of degree " +
                    std::to_string(degree) + ", not " + std::to_string(curve.points.size()));
  return pattern;
}

double distance(const Point &x, const Point &y) {
  const double dx = y[0] - x[0], dy = y[1] - x[1];
  return std::sqrt(dx * dx + dy * dy);
}

std::vector<double> mapped_lengths(const Scene &scene, const FullMu &mu,
                                   const SupportCurve &curve) {
  std::vector<double> lengths(static_cast<std::size_t>(curve.vertices) - 1);
  Point begin = scene.map(mu, curve.points[0]);
  for (std::size_t edge = 0; edge < lengths.size(); ++edge) {
    const Point end = scene.map(mu, curve.points[edge + 1]);
    lengths[edge] = distance(begin, end);
    begin = end;
  }
  const double longest = *std::ranges::max_element(lengths);
  for (std::size_t edge = 0; edge < lengths.size(); ++edge)
    if (!(lengths[edge] > 1e-12 * longest))
      throw failure("edge " + std::to_string(edge) + " of the support's boundary has no length, " +
                    "mapped at " + describe(scene.parameters, mu));
  return lengths;
}

/// Zero values; `copies` blocks of rows of the same pattern.
SparseMatrix zeros(const Pattern &pattern, std::size_t copies) {
  const std::size_t rows = copies * pattern.vertices;
  SparseMatrix b(static_cast<Index>(rows), static_cast<Index>(pattern.columns()));
  int *const outer = b.outerIndexPtr();
  for (std::size_t i = 0; i < rows; ++i)
    outer[i + 1] = outer[i] + static_cast<int>(pattern.entries(i % pattern.vertices));
  b.resizeNonZeros(outer[rows]);
  std::fill_n(b.valuePtr(), b.nonZeros(), 0.0);
  for (std::size_t i = 0; i < rows; ++i) {
    const std::size_t row = i % pattern.vertices;
    const std::size_t first = pattern.first_edge(row),
                      on_vertices = 2 * (pattern.edges_of(row) + 1);
    int *const columns = b.innerIndexPtr() + outer[i];
    for (std::size_t k = 0; k < pattern.entries(row); ++k)
      columns[k] = static_cast<int>(
          k < on_vertices ? 2 * first + k : 2 * (pattern.vertices + first) + k - on_vertices);
  }
  return b;
}

/// What an edge adds to both components of its columns in the normal rows of its two vertices.
struct EdgeBlock {
  Products x{}, y{};

  void add(const TracePoint &at, double n_x, double n_y) {
    for (std::size_t a = 0; a < 2; ++a)
      for (std::size_t node = 0; node < 3; ++node) {
        x[a][node] += at.products[a][node] * n_x;
        y[a][node] += at.products[a][node] * n_y;
      }
  }
  void add_to(SparseMatrix &b, const Pattern &pattern, std::size_t edge) const {
    for (std::size_t a = 0; a < 2; ++a) {
      double *const values = b.valuePtr() + b.outerIndexPtr()[edge + a];
      for (std::size_t node = 0; node < (pattern.middles > 0 ? 3 : 2); ++node) {
        double *const of_node = values + pattern.entry(edge + a, edge, node);
        of_node[0] += x[a][node];
        of_node[1] += y[a][node];
      }
    }
  }
};

/// v . tau is v . n with v turned: (v_y, -v_x) . n.
void set_tangential_rows(SparseMatrix &b) {
  const Index half = b.nonZeros() / 2;
  const double *const normal = b.valuePtr();
  double *const tangential = b.valuePtr() + half;
  for (Index k = 0; k < half; k += 2) {
    tangential[k] = -normal[k + 1];
    tangential[k + 1] = normal[k];
  }
}

/// All but what is nodal.
void integrate(const Scene &scene, const FullMu &mu, const SupportCurve &curve,
               const Pattern &pattern, SupportOperators &result) {
  const SupportRecipe &support = scene.support.value();
  const bool friction = support.friction.law != FrictionLaw::none;
  const std::vector<double> lengths = mapped_lengths(scene, mu, curve);
  const std::vector<TracePoint> points = trace_points(scene.degree, scene.lumped);
  const auto vertices = static_cast<Index>(pattern.vertices);
  result.b = zeros(pattern, friction ? 2 : 1);
  result.g = Vector::Zero(result.b.rows());
  result.weights = Vector::Zero(vertices);
  for (std::size_t edge = 0; edge < lengths.size(); ++edge) {
    const Point &begin = curve.points[edge], &end = curve.points[edge + 1];
    const auto first = static_cast<Index>(edge);
    EdgeBlock block;
    for (const TracePoint &at : points) {
      const double weight = at.weight * lengths[edge];
      const Point x{at.eta[0] * begin[0] + at.eta[1] * end[0],
                    at.eta[0] * begin[1] + at.eta[1] * end[1], 0};
      const Eigen::Vector2d eta(weight * at.eta[0], weight * at.eta[1]);
      const Point n = support.normal(mu, x);
      double gap = support.gap(mu, x), slip = 0;
      if (scene.motion) {
        const Point motion = scene.motion(mu, x);
        gap -= motion[0] * n[0] + motion[1] * n[1];
        slip = motion[1] * n[0] - motion[0] * n[1];
      }
      block.add(at, lengths[edge] * n[0], lengths[edge] * n[1]);
      result.weights.segment<2>(first) += eta;
      result.g.segment<2>(first) += gap * eta;
      if (friction) result.g.segment<2>(vertices + first) -= slip * eta;
    }
    block.add_to(result.b, pattern, edge);
  }
  if (friction) set_tangential_rows(result.b);
}

void collocate(const Scene &scene, const FullMu &mu, const SupportCurve &curve,
               const Pattern &pattern, SupportOperators &result) {
  const auto vertices = static_cast<Index>(pattern.vertices);
  SparseMatrix b(vertices, static_cast<Index>(pattern.columns()));
  b.resizeNonZeros(2 * vertices);
  result.nodal_gap.resize(vertices);
  for (std::size_t i = 0; i < pattern.vertices; ++i) {
    const Point &x = curve.points[i], n = scene.support->normal(mu, x);
    const Point motion = scene.motion ? scene.motion(mu, x) : Point{};
    for (std::size_t c = 0; c < 2; ++c) {
      b.innerIndexPtr()[2 * i + c] = static_cast<int>(2 * i + c);
      b.valuePtr()[2 * i + c] = n[c];
    }
    b.outerIndexPtr()[i + 1] = static_cast<int>(2 * (i + 1));
    result.nodal_gap[static_cast<Index>(i)] =
        scene.support->gap(mu, x) - (motion[0] * n[0] + motion[1] * n[1]);
  }
  result.nodal_b = std::move(b);
}

} // namespace

Index multiplier_count(const SupportCurve &curve, const SupportRecipe &support) {
  return support.friction.law == FrictionLaw::none ? curve.vertices : 2 * curve.vertices;
}

SupportOperators couple_with_support(const Scene &scene, const FullMu &all_parameters,
                                     const SupportCurve &curve) {
  const Pattern pattern = pattern_of(curve, scene.degree);
  SupportOperators result;
  integrate(scene, all_parameters, curve, pattern, result);
  collocate(scene, all_parameters, curve, pattern, result);
  return result;
}

SparseMatrix multiplier_product(const SupportCurve &curve, const SupportRecipe &support) {
  check_curve(curve);
  const Index vertices = curve.vertices, rows = multiplier_count(curve, support);
  const auto length = [&curve](Index edge) {
    const auto e = static_cast<std::size_t>(edge);
    return distance(curve.points[e], curve.points[e + 1]);
  };
  SparseMatrix product(rows, rows);
  product.reserve(Eigen::VectorXi::Constant(rows, 3));
  for (Index row = 0; row < rows; ++row) {
    const Index i = row % vertices;
    const double before = i > 0 ? length(i - 1) : 0, after = i + 1 < vertices ? length(i) : 0;
    if (i > 0) product.insert(row, row - 1) = before / 6;
    product.insert(row, row) = (before + after) / 3;
    if (i + 1 < vertices) product.insert(row, row + 1) = after / 6;
  }
  product.makeCompressed();
  return product;
}

} // namespace rbvi
