#include "rbvi/contact/pair/contact_pair.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/lagrange.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rbvi {

namespace {

std::size_t checked_degree(int degree) {
  check_degree(degree);
  return static_cast<std::size_t>(degree);
}

/// The nodes of one curve.
class Curve {
public:
  Curve(const std::vector<Point> &nodes, int degree, const std::string &name);

  std::size_t nodes() const { return nodes_.size(); }
  std::size_t edges() const { return edges_; }
  std::size_t per_edge() const { return degree_ + 1; } ///< nodes
  /// The nodes of an edge: its vertices, then its middle.
  std::size_t node(std::size_t edge, std::size_t local) const {
    return local < 2 ? edge + local : edges_ + 1 + edge;
  }
  double x(std::size_t vertex) const { return nodes_[vertex][0]; }
  double y(std::size_t vertex) const { return nodes_[vertex][1]; }
  /// The length of the straight edge.
  double length(std::size_t edge) const {
    const double dx = x(edge + 1) - x(edge), dy = y(edge + 1) - y(edge);
    return std::sqrt(dx * dx + dy * dy);
  }
  /// 0 to 1 along the edge.
  double coordinate(std::size_t edge, double at) const {
    return (at - x(edge)) / (x(edge + 1) - x(edge));
  }
  double on_chord(std::size_t edge, double s) const { return (1 - s) * y(edge) + s * y(edge + 1); }
  double height(std::size_t edge, double s) const {
    return on_chord(edge, s) + (degree_ == 2 ? 4 * s * (1 - s) * bulge_[edge] : 0);
  }

private:
  const std::vector<Point> &nodes_;
  std::size_t degree_, edges_;
  std::vector<double> bulge_; ///< degree 2: height of the parabola over the middle of the chord
};

Curve::Curve(const std::vector<Point> &nodes, int degree, const std::string &name)
    : nodes_(nodes), degree_(checked_degree(degree)),
      edges_(nodes.empty() ? 0 : (nodes.size() - 1) / degree_) {
  if (edges_ == 0 || nodes.size() != edges_ * degree_ + 1)
    throw bad_input("the " + name + " curve needs " +
                    (degree == 1 ? "at least 2 nodes" : "an odd number of nodes, at least 3") +
                    ", not " + std::to_string(nodes.size()));
  const auto refuse = [&](std::size_t i, std::size_t before) {
    throw bad_input("x must increase along the " + name + " curve, but node " + std::to_string(i) +
                    " at x = " + short_number(x(i)) + " follows x = " + short_number(x(before)));
  };
  for (std::size_t i = 1; i <= edges_; ++i)
    if (!(x(i - 1) < x(i))) refuse(i, i - 1);
  for (std::size_t edge = 0; edge < edges_ && degree == 2; ++edge) {
    const std::size_t middle = node(edge, 2);
    if (!(x(edge) < x(middle))) refuse(middle, edge);
    if (!(x(middle) < x(edge + 1))) refuse(edge + 1, middle);
    const double s = coordinate(edge, x(middle));
    bulge_.push_back((y(middle) - on_chord(edge, s)) / (4 * s * (1 - s)));
  }
}

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

/// The edge that contains x, searched from `edge` onwards; the last one if x lies beyond the end.
std::size_t advance(const Curve &curve, std::size_t edge, double x) {
  while (edge + 1 < curve.edges() && curve.x(edge + 1) <= x)
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
  points.reserve(2 * (slave.edges() + master.edges()));
  std::size_t first = 0;
  for (std::size_t edge = 0; edge < slave.edges(); ++edge) {
    const double begin = slave.x(edge), end = slave.x(edge + 1);
    const double length = slave.length(edge);
    first = advance(master, first, begin);
    for (std::size_t m = first; m < master.edges() && master.x(m) < end; ++m) {
      const double left = std::max(begin, master.x(m)), right = std::min(end, master.x(m + 1));
      const double part = (right - left) / (end - begin);
      if (part <= 1e-14) continue;
      for (const double at : gauss) {
        const double x = left + at * (right - left);
        points.push_back(
            {edge, m, slave.coordinate(edge, x), master.coordinate(m, x), 0.5 * part * length});
      }
    }
  }
  return points;
}

std::vector<FacingPoint> direct_points(const Curve &slave, const Curve &master) {
  std::vector<FacingPoint> points;
  points.reserve(2 * slave.edges());
  std::size_t m = 0;
  for (std::size_t edge = 0; edge < slave.edges(); ++edge)
    for (const double s : gauss) {
      const double x = (1 - s) * slave.x(edge) + s * slave.x(edge + 1);
      m = advance(master, m, x);
      const double t = master.coordinate(m, x);
      if (on_curve(t)) points.push_back({edge, m, s, t, 0.5 * slave.length(edge)});
    }
  return points;
}

/// Edges of a macro-edge but perhaps the last.
Index macro_size(int degree) {
  return degree == 1 ? 2 : 1;
}

std::size_t multipliers(const Curve &slave, MultiplierSpace space) {
  return static_cast<std::size_t>(multiplier_count(static_cast<Index>(slave.nodes()), space,
                                                   static_cast<int>(slave.per_edge()) - 1));
}

/// The edges on which a multiplier does not vanish.
EdgeRange support(std::size_t multiplier, const Curve &slave, MultiplierSpace space) {
  const std::size_t edges = slave.edges();
  if (space == MultiplierSpace::nodes)
    return {multiplier == 0 ? 0 : multiplier - 1, std::min(multiplier + 1, edges)};
  const auto size = static_cast<std::size_t>(macro_size(static_cast<int>(slave.per_edge()) - 1));
  const bool last = multiplier + 1 == multipliers(slave, space);
  return {size * multiplier, last ? edges : size * (multiplier + 1)};
}

double multiplier_value(std::size_t multiplier, MultiplierSpace space, const FacingPoint &point) {
  if (space == MultiplierSpace::macro_edges) return 1;
  return point.slave_edge == multiplier ? 1 - point.s : point.s;
}

/// What a row of b couples: the nodes of edges of both curves, by quadrature points [begin, end).
struct Row {
  EdgeRange slave, master;
  std::size_t begin, end;
};

std::size_t nodes_of(const EdgeRange &edges, const Curve &curve) {
  return (edges.last - edges.first) * (curve.per_edge() - 1) + 1;
}

std::size_t entries(const Row &row, const Curve &slave, const Curve &master) {
  return row.begin == row.end ? 0 : nodes_of(row.slave, slave) + nodes_of(row.master, master);
}

/// The nodes of successive edges, increasing: their vertices, then their middles.
int *list_nodes(const EdgeRange &edges, const Curve &curve, std::size_t first_column,
                int *columns) {
  int *const middles = columns + (edges.last - edges.first + 1);
  int *const end = columns + nodes_of(edges, curve);
  std::iota(columns, middles, static_cast<int>(first_column + edges.first));
  if (middles != end)
    std::iota(middles, end, static_cast<int>(first_column + curve.node(edges.first, 2)));
  return end;
}

/// Where in that list a node of an edge is.
std::size_t listed(const EdgeRange &edges, std::size_t edge, std::size_t local) {
  const std::size_t at = edge - edges.first;
  return local < 2 ? at + local : edges.last - edges.first + 1 + at;
}

std::vector<Row> rows_of(const std::vector<FacingPoint> &points, const Curve &slave,
                         MultiplierSpace space) {
  std::vector<std::size_t> of_edge(slave.edges() + 1, 0); // first point of an edge
  for (std::size_t edge = 0, q = 0; edge < slave.edges(); of_edge[++edge] = q)
    while (q < points.size() && points[q].slave_edge == edge)
      ++q;
  std::vector<Row> rows(multipliers(slave, space));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const EdgeRange edges = support(i, slave, space);
    rows[i] = {edges, {0, 0}, of_edge[edges.first], of_edge[edges.last]};
    if (rows[i].begin != rows[i].end)
      rows[i].master = {points[rows[i].begin].master_edge, points[rows[i].end - 1].master_edge + 1};
  }
  return rows;
}

/// Zero values in the pattern of the rows.
SparseMatrix zeros(const std::vector<Row> &rows, const Curve &slave, const Curve &master) {
  SparseMatrix b(static_cast<Index>(rows.size()),
                 static_cast<Index>(slave.nodes() + master.nodes()));
  int *outer = b.outerIndexPtr();
  for (std::size_t i = 0; i < rows.size(); ++i)
    outer[i + 1] = outer[i] + static_cast<int>(entries(rows[i], slave, master));
  b.resizeNonZeros(outer[rows.size()]);
  std::fill_n(b.valuePtr(), b.nonZeros(), 0.0);
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (entries(rows[i], slave, master) > 0)
      list_nodes(rows[i].master, master, slave.nodes(),
                 list_nodes(rows[i].slave, slave, 0, b.innerIndexPtr() + outer[i]));
  return b;
}

using Values = std::array<double, 3>;

/// The values of the displacement functions of an edge, at 0 <= s <= 1.
Values displacements(const Curve &curve, double s) {
  Values values{};
  lagrange_values(1, static_cast<int>(curve.per_edge()) - 1, std::array{1 - s, s}, values);
  return values;
}

/// The integral of a multiplier's function over all of its slave edges.
double whole_weight(std::size_t multiplier, const Curve &slave, MultiplierSpace space) {
  const EdgeRange edges = support(multiplier, slave, space);
  double length = 0;
  for (std::size_t edge = edges.first; edge < edges.last; ++edge)
    length += slave.length(edge);
  return space == MultiplierSpace::nodes ? length / 2 : length;
}

void integrate(const Curve &slave, const Curve &master, const PairDiscretisation &discretisation,
               PairOperators &result) {
  const std::vector<FacingPoint> points = discretisation.quadrature == PairQuadrature::intersection
                                              ? intersection_points(slave, master)
                                              : direct_points(slave, master);
  const std::vector<Row> rows = rows_of(points, slave, discretisation.multiplier);
  result.b = zeros(rows, slave, master);
  result.g = Vector::Zero(result.b.rows());
  result.weights = Vector::Zero(result.b.rows());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row &row = rows[i];
    double *const of_slave = result.b.valuePtr() + result.b.outerIndexPtr()[i];
    double *const of_master = of_slave + nodes_of(row.slave, slave);
    double gap = 0, length = 0;
    for (std::size_t q = row.begin; q < row.end; ++q) {
      const FacingPoint &p = points[q];
      const double weight = p.weight * multiplier_value(i, discretisation.multiplier, p);
      const Values at_slave = displacements(slave, p.s), at_master = displacements(master, p.t);
      for (std::size_t k = 0; k < slave.per_edge(); ++k) {
        of_slave[listed(row.slave, p.slave_edge, k)] -= weight * at_slave[k];
        of_master[listed(row.master, p.master_edge, k)] += weight * at_master[k];
      }
      gap += weight * (slave.height(p.slave_edge, p.s) - master.height(p.master_edge, p.t));
      length += weight;
    }
    result.g[static_cast<Index>(i)] = gap;
    result.weights[static_cast<Index>(i)] = length;
    if (!(length > (1 - 1e-9) * whole_weight(i, slave, discretisation.multiplier)))
      result.uncovered.push_back(static_cast<Index>(i));
  }
}

void collocate(const Curve &slave, const Curve &master, PairOperators &result) {
  struct Partner {
    std::size_t edge;
    double t;
  };
  std::vector<Partner> partners;
  partners.reserve(slave.edges() + 1);
  result.paired.reserve(slave.edges() + 1);
  for (std::size_t vertex = 0, edge = 0; vertex <= slave.edges(); ++vertex) {
    edge = advance(master, edge, slave.x(vertex));
    const double t = master.coordinate(edge, slave.x(vertex));
    if (!on_curve(t)) continue;
    partners.push_back({edge, t});
    result.paired.push_back(static_cast<Index>(vertex));
  }
  const auto count = static_cast<Index>(partners.size());
  const std::size_t entries = 1 + master.per_edge();
  SparseMatrix b(count, static_cast<Index>(slave.nodes() + master.nodes()));
  b.resizeNonZeros(static_cast<Index>(entries) * count);
  result.nodal_gap.resize(count);
  for (std::size_t i = 0; i < partners.size(); ++i) {
    const auto [edge, t] = partners[i];
    const auto vertex = static_cast<std::size_t>(result.paired[i]);
    const Values at_master = displacements(master, t);
    int *const columns = b.innerIndexPtr() + entries * i;
    double *const values = b.valuePtr() + entries * i;
    columns[0] = static_cast<int>(vertex);
    values[0] = -1;
    for (std::size_t k = 0; k < master.per_edge(); ++k) {
      columns[1 + k] = static_cast<int>(slave.nodes() + master.node(edge, k));
      values[1 + k] = at_master[k];
    }
    b.outerIndexPtr()[i + 1] = static_cast<int>(entries * (i + 1));
    result.nodal_gap[static_cast<Index>(i)] = slave.y(vertex) - master.height(edge, t);
  }
  result.nodal_b = std::move(b);
}

} // namespace

Index vertex_count(Index nodes, int degree) {
  return (nodes - 1) / degree + 1;
}

Index multiplier_count(Index slave_nodes, MultiplierSpace space, int degree) {
  const Index vertices = vertex_count(slave_nodes, degree);
  return space == MultiplierSpace::nodes ? vertices
                                         : std::max<Index>(1, (vertices - 1) / macro_size(degree));
}

Index macro_edge_of(Index edge, Index slave_nodes, int degree) {
  return std::min(edge / macro_size(degree),
                  multiplier_count(slave_nodes, MultiplierSpace::macro_edges, degree) - 1);
}

PairOperators couple(const std::vector<Point> &slave_nodes, const std::vector<Point> &master_nodes,
                     const PairDiscretisation &discretisation, int degree) {
  const Curve slave(slave_nodes, degree, "slave"), master(master_nodes, degree, "master");
  PairOperators result;
  integrate(slave, master, discretisation, result);
  collocate(slave, master, result);
  return result;
}

SparseMatrix multiplier_product(const std::vector<Point> &slave_nodes, MultiplierSpace space,
                                int degree) {
  const Curve slave(slave_nodes, degree, "slave");
  const auto count = static_cast<Index>(multipliers(slave, space));
  SparseMatrix product(count, count);
  product.reserve(Eigen::VectorXi::Constant(count, 3));
  for (Index i = 0; i < count; ++i) {
    const EdgeRange edges = support(i, slave, space);
    const double weight = whole_weight(i, slave, space);
    const bool linear = space == MultiplierSpace::nodes;
    if (i > 0) product.insert(i, i - 1) = linear ? slave.length(edges.first) / 6 : 0;
    product.insert(i, i) = linear ? weight * 2 / 3 : weight;
    if (i + 1 < count) product.insert(i, i + 1) = linear ? slave.length(edges.last - 1) / 6 : 0;
  }
  product.makeCompressed();
  return product;
}

std::vector<Point> multiplier_points(const std::vector<Point> &slave_nodes, MultiplierSpace space,
                                     int degree) {
  const Curve slave(slave_nodes, degree, "slave");
  if (space == MultiplierSpace::nodes)
    return {slave_nodes.begin(), slave_nodes.begin() + static_cast<Index>(slave.edges()) + 1};
  std::vector<Point> points;
  for (std::size_t i = 0; i < multipliers(slave, space); ++i) {
    auto [edge, last] = support(i, slave, space);
    double rest = 0; // to the middle, along the curve
    for (std::size_t e = edge; e < last; ++e)
      rest += slave.length(e) / 2;
    for (; edge + 1 < last && rest > slave.length(edge); ++edge)
      rest -= slave.length(edge);
    const double s = rest / slave.length(edge);
    points.push_back({(1 - s) * slave.x(edge) + s * slave.x(edge + 1), slave.height(edge, s), 0});
  }
  return points;
}

} // namespace rbvi
