#include "rbvi/element/contact_pair.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rbvi {

namespace {

using Curve = std::vector<Point>;

/// Abscissae of the 2-point Gauss rule on (0, 1), 1/2 -+ 1/sqrt(12).
constexpr std::array<double, 2> gauss{0.21132486540518711775, 0.78867513459481288225};

/// A quadrature point of the slave curve and its partner, by coordinates 0 to 1 along their edges.
struct FacingPoint {
  std::size_t slave_edge, master_edge;
  double s, t;
  double weight; ///< arc length of the slave curve
};

/// Successive edges [first, last) of a curve; their nodes are first, ..., last.
struct EdgeRange {
  std::size_t first, last;
};

void check_curve(const Curve &curve, const std::string &name) {
  if (curve.size() < 2)
    throw bad_input("the " + name + " curve needs at least 2 nodes, not " +
                    std::to_string(curve.size()));
  for (std::size_t i = 1; i < curve.size(); ++i)
    if (!(curve[i - 1][0] < curve[i][0]))
      throw bad_input("x must increase along the " + name + " curve, but node " +
                      std::to_string(i) + " at x = " + short_number(curve[i][0]) +
                      " follows x = " + short_number(curve[i - 1][0]));
}

double edge_length(const Curve &curve, std::size_t edge) {
  const double dx = curve[edge + 1][0] - curve[edge][0], dy = curve[edge + 1][1] - curve[edge][1];
  return std::sqrt(dx * dx + dy * dy);
}

double height(const Curve &curve, std::size_t edge, double s) {
  return (1 - s) * curve[edge][1] + s * curve[edge + 1][1];
}

double coordinate(const Curve &curve, std::size_t edge, double x) {
  return (x - curve[edge][0]) / (curve[edge + 1][0] - curve[edge][0]);
}

/// The edge that contains x, searched from `edge` onwards; the last one if x lies beyond the end.
std::size_t advance(const Curve &curve, std::size_t edge, double x) {
  while (edge + 2 < curve.size() && curve[edge + 1][0] <= x)
    ++edge;
  return edge;
}

/// Whether coordinate t of the master edge that advance() found is on the curve, up to round-off:
/// else it is beyond an end.
bool on_curve(double t) {
  return t >= -1e-12 && t <= 1 + 1e-12;
}

/// Exact for integrands that are cubic in x on every overlap of a slave and a master edge.
std::vector<FacingPoint> intersection_points(const Curve &slave, const Curve &master) {
  std::vector<FacingPoint> points;
  points.reserve(2 * (slave.size() + master.size()));
  std::size_t first = 0;
  for (std::size_t edge = 0; edge + 1 < slave.size(); ++edge) {
    const double begin = slave[edge][0], end = slave[edge + 1][0];
    const double length = edge_length(slave, edge);
    first = advance(master, first, begin);
    for (std::size_t m = first; m + 1 < master.size() && master[m][0] < end; ++m) {
      const double left = std::max(begin, master[m][0]), right = std::min(end, master[m + 1][0]);
      const double part = (right - left) / (end - begin);
      if (part <= 1e-14) continue;
      for (const double at : gauss) {
        const double x = left + at * (right - left);
        points.push_back(
            {edge, m, coordinate(slave, edge, x), coordinate(master, m, x), 0.5 * part * length});
      }
    }
  }
  return points;
}

std::vector<FacingPoint> direct_points(const Curve &slave, const Curve &master) {
  std::vector<FacingPoint> points;
  points.reserve(2 * slave.size());
  std::size_t m = 0;
  for (std::size_t edge = 0; edge + 1 < slave.size(); ++edge)
    for (const double s : gauss) {
      const double x = (1 - s) * slave[edge][0] + s * slave[edge + 1][0];
      m = advance(master, m, x);
      const double t = coordinate(master, m, x);
      if (on_curve(t)) points.push_back({edge, m, s, t, 0.5 * edge_length(slave, edge)});
    }
  return points;
}

/// The edges on which a multiplier does not vanish.
EdgeRange support(std::size_t multiplier, std::size_t slave_nodes, MultiplierSpace space) {
  const std::size_t edges = slave_nodes - 1;
  if (space == MultiplierSpace::nodes)
    return {multiplier == 0 ? 0 : multiplier - 1, std::min(multiplier + 1, edges)};
  return {2 * multiplier, 2 * multiplier + 3 < edges ? 2 * multiplier + 2 : edges};
}

double multiplier_value(std::size_t multiplier, MultiplierSpace space, const FacingPoint &point) {
  if (space == MultiplierSpace::macro_edges) return 1;
  return point.slave_edge == multiplier ? 1 - point.s : point.s;
}

/// What a row of b couples: the nodes of edges of both curves, by quadrature points [begin, end).
struct Row {
  EdgeRange slave, master;
  std::size_t begin, end;

  std::size_t slave_nodes() const { return slave.last - slave.first + 1; }
  std::size_t entries() const {
    return begin == end ? 0 : slave_nodes() + master.last - master.first + 1;
  }
};

std::vector<Row> rows_of(const std::vector<FacingPoint> &points, std::size_t slave_nodes,
                         MultiplierSpace space) {
  std::vector<std::size_t> of_edge(slave_nodes, 0); // first point of an edge
  for (std::size_t edge = 0, q = 0; edge + 1 < slave_nodes; of_edge[++edge] = q)
    while (q < points.size() && points[q].slave_edge == edge)
      ++q;
  const Index count = multiplier_count(static_cast<Index>(slave_nodes), space);
  std::vector<Row> rows(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const EdgeRange edges = support(i, slave_nodes, space);
    rows[i] = {edges, {0, 0}, of_edge[edges.first], of_edge[edges.last]};
    if (rows[i].begin != rows[i].end)
      rows[i].master = {points[rows[i].begin].master_edge, points[rows[i].end - 1].master_edge + 1};
  }
  return rows;
}

/// Zero values in the pattern of the rows.
SparseMatrix zeros(const std::vector<Row> &rows, std::size_t slave_nodes,
                   std::size_t master_nodes) {
  SparseMatrix b(static_cast<Index>(rows.size()), static_cast<Index>(slave_nodes + master_nodes));
  int *outer = b.outerIndexPtr();
  for (std::size_t i = 0; i < rows.size(); ++i)
    outer[i + 1] = outer[i] + static_cast<int>(rows[i].entries());
  b.resizeNonZeros(outer[rows.size()]);
  std::fill_n(b.valuePtr(), b.nonZeros(), 0.0);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].entries() == 0) continue;
    int *const columns = b.innerIndexPtr() + outer[i];
    int *const middle = columns + rows[i].slave_nodes();
    std::iota(columns, middle, static_cast<int>(rows[i].slave.first));
    std::iota(middle, b.innerIndexPtr() + outer[i + 1],
              static_cast<int>(slave_nodes + rows[i].master.first));
  }
  return b;
}

void integrate(const Curve &slave, const Curve &master, const PairDiscretisation &discretisation,
               PairOperators &result) {
  const std::vector<FacingPoint> points = discretisation.quadrature == PairQuadrature::intersection
                                              ? intersection_points(slave, master)
                                              : direct_points(slave, master);
  const std::vector<Row> rows = rows_of(points, slave.size(), discretisation.multiplier);
  result.b = zeros(rows, slave.size(), master.size());
  result.g = Vector::Zero(result.b.rows());
  result.weights = Vector::Zero(result.b.rows());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    double *const of_slave = result.b.valuePtr() + result.b.outerIndexPtr()[i];
    double *const of_master = of_slave + rows[i].slave_nodes();
    double gap = 0, length = 0;
    for (std::size_t q = rows[i].begin; q < rows[i].end; ++q) {
      const FacingPoint &p = points[q];
      const double weight = p.weight * multiplier_value(i, discretisation.multiplier, p);
      double *const at_slave = of_slave + (p.slave_edge - rows[i].slave.first);
      double *const at_master = of_master + (p.master_edge - rows[i].master.first);
      at_slave[0] -= weight * (1 - p.s);
      at_slave[1] -= weight * p.s;
      at_master[0] += weight * (1 - p.t);
      at_master[1] += weight * p.t;
      gap += weight * (height(slave, p.slave_edge, p.s) - height(master, p.master_edge, p.t));
      length += weight;
    }
    result.g[static_cast<Index>(i)] = gap;
    result.weights[static_cast<Index>(i)] = length;
  }
}

void collocate(const Curve &slave, const Curve &master, PairOperators &result) {
  struct Partner {
    std::size_t edge;
    double t;
  };
  std::vector<Partner> partners;
  partners.reserve(slave.size());
  result.paired.reserve(slave.size());
  for (std::size_t node = 0, edge = 0; node < slave.size(); ++node) {
    edge = advance(master, edge, slave[node][0]);
    const double t = coordinate(master, edge, slave[node][0]);
    if (!on_curve(t)) continue;
    partners.push_back({edge, t});
    result.paired.push_back(static_cast<Index>(node));
  }
  const auto count = static_cast<Index>(partners.size());
  SparseMatrix b(count, static_cast<Index>(slave.size() + master.size()));
  b.resizeNonZeros(3 * count);
  result.nodal_gap.resize(count);
  for (std::size_t i = 0; i < partners.size(); ++i) {
    const auto [edge, t] = partners[i];
    const auto node = static_cast<std::size_t>(result.paired[i]);
    const auto column = static_cast<int>(slave.size() + edge);
    std::ranges::copy(std::array{static_cast<int>(node), column, column + 1},
                      b.innerIndexPtr() + 3 * i);
    std::ranges::copy(std::array{-1.0, 1 - t, t}, b.valuePtr() + 3 * i);
    b.outerIndexPtr()[i + 1] = static_cast<int>(3 * (i + 1));
    result.nodal_gap[static_cast<Index>(i)] = slave[node][1] - height(master, edge, t);
  }
  result.nodal_b = std::move(b);
}

} // namespace

Index multiplier_count(Index slave_nodes, MultiplierSpace space) {
  return space == MultiplierSpace::nodes ? slave_nodes : std::max<Index>(1, (slave_nodes - 1) / 2);
}

Index macro_edge_of(Index edge, Index slave_nodes) {
  return std::min(edge / 2, multiplier_count(slave_nodes, MultiplierSpace::macro_edges) - 1);
}

PairOperators couple(const Curve &slave, const Curve &master,
                     const PairDiscretisation &discretisation) {
  check_curve(slave, "slave");
  check_curve(master, "master");
  PairOperators result;
  integrate(slave, master, discretisation, result);
  collocate(slave, master, result);
  return result;
}

PairOperators couple_at(const Scene &scene, const Mu &all_parameters,
                        const std::vector<Point> &points, Index slave_nodes) {
  std::vector<Point> mapped;
  mapped.reserve(points.size());
  for (const Point &x : points)
    mapped.push_back(scene.map(all_parameters, x));
  const auto master = mapped.begin() + slave_nodes;
  PairOperators pair;
  try {
    pair =
        couple({mapped.begin(), master}, {master, mapped.end()}, scene.pair.value().discretisation);
  } catch (const Error &error) { // of this mu, not of the input
    throw failure(std::string(error.what()) + ", mapped at " +
                  describe(all_free(scene.parameters.all), all_parameters));
  }
  if (!scene.motion) return pair;
  Vector motion(static_cast<Index>(points.size()));
  for (Index i = 0; i < motion.size(); ++i)
    motion[i] = scene.motion(all_parameters, points[static_cast<std::size_t>(i)])[1];
  pair.g -= pair.b * motion;
  pair.nodal_gap -= pair.nodal_b * motion;
  return pair;
}

SparseMatrix multiplier_product(const Curve &slave, MultiplierSpace space) {
  check_curve(slave, "slave");
  const Index count = multiplier_count(static_cast<Index>(slave.size()), space);
  SparseMatrix product(count, count);
  product.reserve(Eigen::VectorXi::Constant(count, 3));
  for (Index i = 0; i < count; ++i) {
    const EdgeRange edges = support(static_cast<std::size_t>(i), slave.size(), space);
    double length = 0;
    for (std::size_t edge = edges.first; edge < edges.last; ++edge)
      length += edge_length(slave, edge);
    const bool linear = space == MultiplierSpace::nodes;
    if (i > 0) product.insert(i, i - 1) = linear ? edge_length(slave, edges.first) / 6 : 0;
    product.insert(i, i) = linear ? length / 3 : length;
    if (i + 1 < count)
      product.insert(i, i + 1) = linear ? edge_length(slave, edges.last - 1) / 6 : 0;
  }
  product.makeCompressed();
  return product;
}

std::vector<Point> multiplier_points(const Curve &slave, MultiplierSpace space) {
  check_curve(slave, "slave");
  if (space == MultiplierSpace::nodes) return slave;
  std::vector<Point> points;
  const Index count = multiplier_count(static_cast<Index>(slave.size()), space);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    auto [edge, last] = support(i, slave.size(), space);
    double rest = 0; // to the middle, along the curve
    for (std::size_t e = edge; e < last; ++e)
      rest += edge_length(slave, e) / 2;
    for (; edge + 1 < last && rest > edge_length(slave, edge); ++edge)
      rest -= edge_length(slave, edge);
    const double s = rest / edge_length(slave, edge);
    points.push_back(
        {(1 - s) * slave[edge][0] + s * slave[edge + 1][0], height(slave, edge, s), 0});
  }
  return points;
}

} // namespace rbvi
