#include "rbvi/contact/contact_pair.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/lagrange.hpp"

#include <algorithm>

namespace rbvi {

namespace {

constexpr double round_off = 1e-9; ///< of the weight of a multiplier

/// Successive edges [first, last) of a curve.
struct EdgeRange {
  Index first, last;
};

/// Edges of a macro-edge but perhaps the last.
Index macro_size(int degree) {
  return degree == 1 ? 2 : 1;
}

/// The edges on which a multiplier does not vanish.
EdgeRange support(Index multiplier, Index edges, MultiplierSpace space, int degree) {
  if (space == MultiplierSpace::nodes)
    return {std::max<Index>(multiplier - 1, 0), std::min(multiplier + 1, edges)};
  const Index size = macro_size(degree), count = std::max<Index>(1, edges / size);
  return {size * multiplier, multiplier + 1 == count ? edges : size * (multiplier + 1)};
}

double multiplier_value(Index multiplier, MultiplierSpace space, const PairPoint &point) {
  if (space == MultiplierSpace::macro_edges) return 1;
  return point.slave_edge == multiplier ? 1 - point.s : point.s;
}

/// A curve as a graph over x.
class Graph {
public:
  /// `curve` must outlive it.
  Graph(const NodalCurve &curve, const std::string &name);

  Index edges() const { return curve_.edges(); }
  double x(Index node) const { return curve_.point(node)[0]; }
  double abscissa(Index edge, double s) const { return (1 - s) * x(edge) + s * x(edge + 1); }
  /// 0 to 1 along the edge.
  double coordinate(Index edge, double at) const {
    return (at - x(edge)) / (x(edge + 1) - x(edge));
  }
  double height(Index edge, double s) const {
    const double on_chord = (1 - s) * curve_.point(edge)[1] + s * curve_.point(edge + 1)[1];
    return on_chord + (bulge_.empty() ? 0 : 4 * s * (1 - s) * bulge_[edge]);
  }

private:
  const NodalCurve &curve_;
  std::vector<double> bulge_; ///< degree 2: height of the parabola over the middle of the chord
};

Graph::Graph(const NodalCurve &curve, const std::string &name) : curve_(curve) {
  const int degree = curve.degree();
  check_degree(degree);
  if (edges() < 1 || curve.nodes() != edges() * degree + 1)
    throw bad_input("the " + name + " curve needs " +
                    (degree == 1 ? "at least 2 nodes" : "an odd number of nodes, at least 3") +
                    ", not " + std::to_string(curve.nodes()));
  const auto check = [&](Index before, Index i) {
    if (!(x(before) < x(i)))
      throw bad_input("x must increase along the " + name + " curve, but node " +
                      std::to_string(i) + " at x = " + short_number(x(i)) +
                      " follows x = " + short_number(x(before)));
  };
  for (Index e = 0; e < edges(); ++e)
    check(e, e + 1);
  std::vector<double> bulge;
  bulge.reserve(edges());
  for (Index e = 0; e < edges() && degree == 2; ++e) {
    const Index middle = curve.node(e, 2);
    check(e, middle);
    check(middle, e + 1);
    const double s = coordinate(e, x(middle));
    bulge.push_back((curve.point(middle)[1] - height(e, s)) / (4 * s * (1 - s)));
  }
  bulge_ = std::move(bulge);
}

/// The vertices of the master curve by their abscissae.
Cuts vertical_cuts(const Graph &slave, const Graph &master) {
  constexpr double at_end = 1e-12; // of an edge
  const auto edges = static_cast<int>(slave.edges());
  Cuts cuts{{}, edges};
  int edge = 0;
  for (Index v = 0; v <= master.edges(); ++v) {
    const double x = master.x(v);
    while (edge + 1 < edges && slave.x(edge + 1) <= x)
      ++edge;
    const double s = slave.coordinate(edge, x);
    const int beyond = s < -at_end ? -1 : edges + 1;
    cuts.places.push_back(s < -at_end || s > 1 + at_end ? CurvePlace{beyond} : CurvePlace{edge, s});
  }
  return cuts;
}

/// Gauss of two points on (0, 1): exact for integrands that are cubic in x on every piece.
constexpr std::array<EdgePoint, 2> two_points{
    {{0.21132486540518711775, 0.5}, {0.78867513459481288225, 0.5}}};

} // namespace

DifferenceRows::DifferenceRows(const Partners &of, const std::vector<int> &dofs, Index columns)
    : dofs_(dofs), size_(columns),
      components_(std::ssize(dofs) / (of.slave.nodes() + of.master.nodes())), slave_{of.slave, 0},
      master_{of.master, of.slave.nodes()}, row_(dofs.size(), 0.0) {
  columns_.reserve(4 * dofs.size());
  values_.reserve(4 * dofs.size());
}

void DifferenceRows::add(const PairPoint &point, double factor) {
  const Point &n = point.normal;
  add(slave_, point.slave_edge, point.s, {-factor * n[0], -factor * n[1], 0});
  add(master_, point.master_edge, point.t, {factor * n[0], factor * n[1], 0});
}

void DifferenceRows::add(Side &side, Index edge, double s, const Point &vector) {
  const bool first = side.last < side.first;
  side.first = first ? edge : std::min(side.first, edge);
  side.last = first ? edge : std::max(side.last, edge);
  const std::array<double, 3> functions = edge_functions(side.curve.degree(), s);
  for (Index k = 0; k < side.curve.per_edge(); ++k) {
    double *const node = row_.data() + components_ * (side.first_node + side.curve.node(edge, k));
    if (components_ == 2) node[0] += functions[k] * vector[0];
    node[components_ - 1] += functions[k] * vector[1];
  }
}

void DifferenceRows::end_nodes(Index begin, Index end) {
  for (Index i = components_ * begin; i < components_ * end; ++i) {
    if (row_[i] != 0 && dofs_[i] >= 0) {
      if (std::ssize(columns_) > begins_.back() && columns_.back() > dofs_[i]) sorted_ = false;
      columns_.push_back(dofs_[i]);
      values_.push_back(row_[i]);
    }
    row_[i] = 0;
  }
}

void DifferenceRows::end_row() {
  for (Side *side : {&slave_, &master_}) {
    if (side->last < side->first) continue;
    const Index vertex = side->first_node + side->first, count = side->last - side->first + 1;
    end_nodes(vertex, vertex + count + 1);
    const Index middle = vertex + side->curve.edges() + 1;
    if (side->curve.degree() == 2) end_nodes(middle, middle + count);
    side->last = side->first - 1;
  }
  begins_.push_back(static_cast<int>(columns_.size()));
}

SparseMatrix DifferenceRows::matrix() const {
  SparseMatrix rows(std::ssize(begins_) - 1, size_);
  rows.resizeNonZeros(std::ssize(values_));
  std::ranges::copy(begins_, rows.outerIndexPtr());
  std::ranges::copy(columns_, rows.innerIndexPtr());
  std::ranges::copy(values_, rows.valuePtr());
  if (sorted_) return rows;
  return Eigen::SparseMatrix<double, Eigen::ColMajor>(rows); // sorts each row
}

PairOperators pair_operators(const Partners &partners, MultiplierSpace space,
                             const std::vector<int> &dofs, Index columns) {
  const NodalCurve &slave = partners.slave;
  const Index count = multiplier_count(slave.nodes(), space, slave.degree());
  PairOperators result;
  result.g = result.weights = Vector::Zero(count);
  const Vector whole = whole_weights(partners.hats, space, slave.degree());
  std::vector<const PairPoint *> of_edge{partners.points.data()}; // from its first point on
  const PairPoint *const end = of_edge[0] + partners.points.size();
  for (Index edge = 0; edge < slave.edges(); ++edge)
    of_edge.push_back(
        std::find_if(of_edge.back(), end, [&](const PairPoint &p) { return p.slave_edge > edge; }));
  DifferenceRows weak(partners, dofs, columns), nodal(partners, dofs, columns);
  for (Index i = 0; i < count; ++i) {
    const EdgeRange edges = support(i, slave.edges(), space, slave.degree());
    for (const PairPoint *p = of_edge[edges.first]; p != of_edge[edges.last]; ++p) {
      const double weight = p->weight * multiplier_value(i, space, *p);
      weak.add(*p, weight);
      result.g[i] += weight * p->gap;
      result.weights[i] += weight;
    }
    weak.end_row();
    if (is_partial(result.weights[i], whole[i])) result.uncovered.push_back(i);
  }
  result.b = weak.matrix();
  result.nodal_gap.resize(std::ssize(partners.vertices));
  result.normals.reserve(partners.vertices.size());
  for (const PairPoint &p : partners.vertices) {
    nodal.add(p, 1);
    nodal.end_row();
    result.nodal_gap[std::ssize(result.paired)] = p.gap;
    result.paired.push_back(p.slave_edge + (p.s > 0.5 ? 1 : 0));
    result.normals.push_back({-p.normal[0], -p.normal[1], 0});
  }
  result.nodal_b = nodal.matrix();
  return result;
}

Partners vertical_partners(std::vector<Point> slave_nodes, std::vector<Point> master_nodes,
                           PairQuadrature quadrature, int degree, bool axisymmetric) {
  Partners result{{std::move(slave_nodes), degree}, {std::move(master_nodes), degree}};
  const Graph slave(result.slave, "slave"), master(result.master, "master");
  result.lengths = result.slave.lengths();
  result.hats = result.slave.hats(axisymmetric);
  result.cuts = vertical_cuts(slave, master);
  const Cuts &cuts = result.cuts;
  result.vertices = cuts.at_vertices();
  if (quadrature == PairQuadrature::intersection) {
    result.points = cuts.on_pieces(two_points);
  } else {
    std::vector<CurvePlace> places;
    for (int e = 0; e < cuts.slave_edges; ++e)
      for (const EdgePoint &at : two_points)
        places.push_back({e, at.s});
    result.points = cuts.at(places);
    for (PairPoint &p : result.points)
      p.weight = 0.5;
  }
  for (std::vector<PairPoint> *points : {&result.points, &result.vertices})
    for (PairPoint &p : *points) {
      const double x = slave.abscissa(p.slave_edge, p.s);
      p.t = master.coordinate(p.master_edge, x);
      p.weight *= result.lengths[p.slave_edge] * circumference(axisymmetric, {x, 0, 0});
      p.normal = {0, 1, 0};
      p.gap = slave.height(p.slave_edge, p.s) - master.height(p.master_edge, p.t);
    }
  return result;
}

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

Vector whole_weights(const std::vector<std::array<double, 2>> &hats, MultiplierSpace space,
                     int degree) {
  const Index edges = std::ssize(hats);
  Vector whole = Vector::Zero(multiplier_count(degree * edges + 1, space, degree));
  for (Index i = 0; i < whole.size(); ++i) {
    const EdgeRange own = support(i, edges, space, degree);
    for (Index e = own.first; e < own.last; ++e)
      whole[i] +=
          space == MultiplierSpace::nodes ? hats[e][e == i ? 0 : 1] : hats[e][0] + hats[e][1];
  }
  return whole;
}

bool is_partial(double weight, double whole) {
  return !(weight > (1 - round_off) * whole);
}

double ends_in_contact(const Vector &whole, const Vector &weights, const Vector &lambda,
                       double least, const ClosedEnds &closed) {
  const Index count = whole.size();
  const auto carries_from = [&](Index first, Index step) {
    Index row = first;
    while (row >= 0 && row < count && !(weights[row] > round_off * whole[row]))
      row += step;
    const auto &ends = row == first ? closed.slave : closed.master;
    if (ends[step > 0 ? 0 : 1] || row < 0 || row >= count) return false;
    do {
      if (lambda[row] > least) return true;
      row += step;
    } while (row >= 0 && row < count && is_partial(weights[row], whole[row]));
    return false;
  };
  return (carries_from(0, 1) ? 1.0 : 0.0) + (carries_from(count - 1, -1) ? 1.0 : 0.0);
}

SparseMatrix multiplier_product(const std::vector<Point> &nodes, MultiplierSpace space, int degree,
                                bool axisymmetric) {
  const NodalCurve curve(nodes, degree);
  const Graph slave(curve, "slave");
  if (space == MultiplierSpace::nodes)
    return linear_gram({nodes.begin(), nodes.begin() + slave.edges() + 1}, 1, axisymmetric);
  const Vector whole = whole_weights(curve.hats(axisymmetric), space, degree);
  SparseMatrix product(whole.size(), whole.size());
  product.reserve(Eigen::VectorXi::Constant(whole.size(), 3));
  for (Index i = 0; i < whole.size(); ++i)
    for (Index j = std::max<Index>(i - 1, 0); j < std::min(i + 2, whole.size()); ++j)
      product.insert(i, j) = i == j ? whole[i] : 0;
  product.makeCompressed();
  return product;
}

std::vector<Point> multiplier_points(const std::vector<Point> &nodes, MultiplierSpace space,
                                     int degree) {
  const NodalCurve curve(nodes, degree);
  const Graph slave(curve, "slave");
  if (space == MultiplierSpace::nodes) return {nodes.begin(), nodes.begin() + slave.edges() + 1};
  const std::vector<double> lengths = curve.lengths();
  const Vector whole = whole_weights(curve.hats(false), space, degree);
  std::vector<Point> points;
  for (Index i = 0; i < whole.size(); ++i) {
    auto [edge, last] = support(i, slave.edges(), space, degree);
    double rest = whole[i] / 2; // to the middle, along the curve
    for (; edge + 1 < last && rest > lengths[edge]; ++edge)
      rest -= lengths[edge];
    const double s = rest / lengths[edge];
    points.push_back({slave.abscissa(edge, s), slave.height(edge, s), 0});
  }
  return points;
}

} // namespace rbvi
