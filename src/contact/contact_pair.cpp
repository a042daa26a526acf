#include "rbvi/contact/contact_pair.hpp"

#include "rbvi/contact/contact_area.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/lagrange.hpp"

#include <algorithm>
#include <numeric>

namespace rbvi {

namespace {

constexpr double round_off = 1e-9; ///< of the weight of a multiplier

/// Gauss of two points on (0, 1): exact for integrands that are cubic in x on every piece.
constexpr std::array<EdgePoint, 2> two_points{
    {{0.21132486540518711775, 0.5}, {0.78867513459481288225, 0.5}}};

/// With -tau of the slave for the normal towards it, as the slip is the other way round.
PairPoint turned(PairPoint point) {
  point.normal = {-point.normal[1], point.normal[0], 0};
  return point;
}

} // namespace

PairMultipliers::PairMultipliers(const CurveShape &slave, MultiplierSpace space, int degree)
    : space_(space) {
  if (space == MultiplierSpace::nodes) {
    on_edge_ = slave.ends;
    edges_.resize(static_cast<std::size_t>(slave.vertices()));
    for (Index e = 0; e < slave.edges(); ++e)
      for (const Index vertex : slave.ends[e])
        edges_[vertex].push_back(e);
    return;
  }
  const Index size = degree == 1 ? 2 : 1;
  for (const CurveChain &piece : slave.pieces) {
    const Index first = count(), macros = std::max<Index>(1, piece.edges / size);
    edges_.resize(static_cast<std::size_t>(first + macros));
    for (Index k = 0; k < piece.edges; ++k) {
      const Index macro = first + std::min(k / size, macros - 1);
      edges_[macro].push_back(piece.first_edge + k);
      on_edge_.push_back({macro, macro});
    }
  }
}

Vector PairMultipliers::whole_weights(const HatWeights &hats) const {
  Vector whole = Vector::Zero(count());
  for (std::size_t e = 0; e < on_edge_.size(); ++e)
    for (std::size_t end = 0; end < 2; ++end)
      whole[on_edge_[e][end]] += hats[e][end];
  return whole;
}

SparseMatrix PairMultipliers::gram(const NodalCurve &slave, int copies, bool axisymmetric) const {
  std::vector<Point> vertices;
  for (Index v = 0; v < slave.shape().vertices(); ++v)
    vertices.push_back(slave.point(v));
  if (space_ == MultiplierSpace::nodes)
    return linear_gram(vertices, slave.shape(), copies, axisymmetric);
  const Vector whole = whole_weights(slave.hats(axisymmetric));
  std::vector<Eigen::Triplet<double>> entries;
  for (Index k = 0; k < copies; ++k) {
    const Index first = k * count();
    for (Index i = 0; i < count(); ++i)
      entries.emplace_back(first + i, first + i, whole[i]);
    for (const CurveChain &piece : slave.shape().pieces)
      for (Index e = 0; e + (piece.loop ? 0 : 1) < piece.edges; ++e) {
        const Index i = first + on_edge_[piece.first_edge + e][0],
                    j = first + on_edge_[piece.first_edge + (e + 1) % piece.edges][0];
        if (i == j) continue;
        entries.emplace_back(i, j, 0.0);
        entries.emplace_back(j, i, 0.0);
      }
  }
  SparseMatrix product(copies * count(), copies * count());
  product.setFromTriplets(entries.begin(), entries.end());
  return product;
}

std::vector<Point> PairMultipliers::points(const NodalCurve &slave) const {
  std::vector<Point> points;
  const std::vector<double> lengths = slave.lengths();
  for (Index i = 0; i < count(); ++i) {
    if (space_ == MultiplierSpace::nodes) {
      points.push_back(slave.point(i));
      continue;
    }
    double rest = 0; // to the middle, along the curve
    for (const Index e : edges_[i])
      rest += lengths[e] / 2;
    auto edge = edges_[i].begin();
    for (; edge + 1 != edges_[i].end() && rest > lengths[*edge]; ++edge)
      rest -= lengths[*edge];
    points.push_back(slave.at(*edge, rest / lengths[*edge]));
  }
  return points;
}

DifferenceRows::DifferenceRows(const Partners &of, const std::vector<int> &dofs, Index columns)
    : dofs_(dofs), size_(columns), slave_{of.slave, 0}, master_{of.master, of.slave.nodes()},
      row_(dofs.size(), 0.0) {
  columns_.reserve(4 * dofs.size());
  values_.reserve(4 * dofs.size());
}

void DifferenceRows::add(const PairPoint &point, double factor) {
  const Point &n = point.normal;
  add(slave_, point.slave_edge, point.s, {-factor * n[0], -factor * n[1], 0});
  add(master_, point.master_edge, point.t, {factor * n[0], factor * n[1], 0});
}

void DifferenceRows::add(Side &side, Index edge, double s, const Point &vector) {
  const bool is_first = side.last_vertex < side.first_vertex;
  const auto &[a, b] = side.curve.shape().ends[edge];
  const Index low = std::min(a, b), high = std::max(a, b);
  side.first_vertex = is_first ? low : std::min(side.first_vertex, low);
  side.last_vertex = is_first ? high : std::max(side.last_vertex, high);
  side.first_edge = is_first ? edge : std::min(side.first_edge, edge);
  side.last_edge = is_first ? edge : std::max(side.last_edge, edge);
  const std::array<double, 3> functions = edge_functions(side.curve.degree(), s);
  for (Index k = 0; k < side.curve.per_edge(); ++k) {
    double *const node = row_.data() + 2 * (side.first_node + side.curve.node(edge, k));
    node[0] += functions[k] * vector[0];
    node[1] += functions[k] * vector[1];
  }
}

void DifferenceRows::end_nodes(Index first, Index last) {
  for (Index i = 2 * first; i < 2 * last + 2; ++i) {
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
    if (side->last_vertex < side->first_vertex) continue;
    end_nodes(side->first_node + side->first_vertex, side->first_node + side->last_vertex);
    const Index middles = side->first_node + side->curve.shape().vertices();
    if (side->curve.degree() == 2) end_nodes(middles + side->first_edge, middles + side->last_edge);
    side->last_vertex = side->first_vertex - 1;
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

PairOperators pair_operators(const Partners &partners, const PairMultipliers &multipliers,
                             const std::vector<int> &dofs, Index columns, bool friction) {
  const Index count = multipliers.count();
  PairOperators result;
  result.weights = Vector::Zero(count);
  result.g = Vector::Zero(friction ? 2 * count : count);
  const Vector whole = multipliers.whole_weights(partners.hats);
  std::vector<const PairPoint *> of_edge{partners.points.data()}; // from its first point on
  const PairPoint *const end = of_edge[0] + partners.points.size();
  for (Index edge = 0; edge < partners.slave.edges(); ++edge)
    of_edge.push_back(
        std::find_if(of_edge.back(), end, [&](const PairPoint &p) { return p.slave_edge > edge; }));
  DifferenceRows weak(partners, dofs, columns), nodal(partners, dofs, columns);
  for (Index row = 0; row < result.g.size(); ++row) {
    const bool tangential = row >= count;
    const Index i = row % count;
    for (const Index edge : multipliers.edges_of(i))
      for (const PairPoint *p = of_edge[edge]; p != of_edge[edge + 1]; ++p) {
        const double weight = p->weight * multipliers.value(i, edge, p->s);
        weak.add(tangential ? turned(*p) : *p, weight);
        result.g[row] += tangential ? -weight * p->slip : weight * p->gap;
        if (!tangential) result.weights[i] += weight;
      }
    weak.end_row();
    if (!tangential && is_partial(result.weights[i], whole[i])) result.uncovered.push_back(i);
  }
  result.b = weak.matrix();
  result.nodal_gap.resize(std::ssize(partners.vertices));
  for (Index k = 0; k < result.nodal_gap.size(); ++k) {
    nodal.add(partners.vertices[k], 1);
    nodal.end_row();
    const PairPoint &p = partners.vertices[k];
    result.nodal_gap[k] = p.gap;
    result.paired.push_back(partners.slave.node(p.slave_edge, p.s > 0.5 ? 1 : 0));
  }
  result.nodal_b = nodal.matrix();
  return result;
}

double tangential_force(const Partners &partners, const PairMultipliers &multipliers,
                        const Vector &shear) {
  double sum = 0;
  for (const auto &[edge, begin, end] : partners.faced) {
    const auto [first, last] = partners.hats[edge]; // of a weight that is linear along the edge
    const auto weight = [&, a = first, b = last](double s) {
      return (1 - s) * (4 * a - 2 * b) + s * (4 * b - 2 * a);
    };
    const double length = end - begin, from = length * weight(begin), to = length * weight(end);
    sum += integral_of_magnitude(
        {from / 3 + to / 6, from / 6 + to / 3},
        {multipliers.sum(shear, edge, begin), multipliers.sum(shear, edge, end)});
  }
  return sum;
}

Vector nodal_forces(const Partners &partners, const PairMultipliers &multipliers,
                    const Vector &lambda) {
  std::vector<int> all(
      static_cast<std::size_t>(2 * partners.slave.nodes() + 2 * partners.master.nodes()));
  std::iota(all.begin(), all.end(), 0);
  const bool friction = lambda.size() > multipliers.count();
  return pair_operators(partners, multipliers, all, std::ssize(all), friction).b.transpose() *
         lambda;
}

PointForces point_forces(const Partners &partners, const PairMultipliers &multipliers,
                         const Vector &lambda) {
  const Index count = multipliers.count();
  const Vector pressure = lambda.head(count), shear = lambda.tail(lambda.size() - count);
  const auto on_edge = [](const NodalCurve &curve, Index edge, double s) {
    return (1 - s) * curve.end(edge, 0) + s * curve.end(edge, 1);
  };
  PointForces forces;
  for (const PairPoint &p : partners.points) {
    Point force = p.weight * multipliers.sum(pressure, p.slave_edge, p.s) * p.normal;
    if (shear.size() > 0)
      force = force - p.weight * multipliers.sum(shear, p.slave_edge, p.s) *
                          Point{p.normal[1], -p.normal[0], 0};
    forces.push_back({0, on_edge(partners.slave, p.slave_edge, p.s), force});
    forces.push_back({1, on_edge(partners.master, p.master_edge, p.t), -1.0 * force});
  }
  return forces;
}

Partners find_partners(NodalCurve slave, NodalCurve master, const PairDiscretisation &how,
                       MasterField field, const HatWeights &hats) {
  Partners result{std::move(slave), std::move(master), hats};
  const PartnerSearch search(result.slave, result.master, std::move(field));
  result.segments = search.segments();
  result.vertices = search.at_vertices();
  result.faced = search.faced();
  std::vector<CurvePlace> cuts;
  for (const auto &[edge, begin, end] : result.faced)
    for (const double s : {begin, end})
      if (s > 0 && s < 1) cuts.push_back({edge, s});
  result.cuts = search.at(cuts);
  const std::span<const EdgePoint> rule = how.projection == PairProjection::vertical
                                              ? std::span<const EdgePoint>(two_points)
                                              : std::span<const EdgePoint>(edge_quadrature);
  if (how.quadrature == PairQuadrature::intersection) {
    result.points = search.on_parts(rule);
  } else {
    std::vector<CurvePlace> places;
    for (Index e = 0; e < result.slave.edges(); ++e)
      for (const EdgePoint &at : rule)
        places.push_back({e, at.s});
    result.points = search.at(places);
    for (PairPoint &p : result.points)
      p.weight = std::ranges::find(rule, p.s, &EdgePoint::s)->weight;
  }
  result.bends.reserve(result.points.size());
  for (PairPoint &p : result.points) {
    result.bends.push_back(search.project(p));
    const auto [first, last] = hats[p.slave_edge]; // of a weight that is linear along the edge
    p.weight *= (1 - p.s) * (4 * first - 2 * last) + p.s * (4 * last - 2 * first);
  }
  for (std::vector<PairPoint> *points : {&result.vertices, &result.cuts})
    for (PairPoint &p : *points)
      (void)search.project(p);
  for (std::vector<PairPoint> *points : {&result.points, &result.vertices, &result.cuts})
    set_gaps(result.slave, result.master, *points);
  return result;
}

void set_gaps(const NodalCurve &slave, const NodalCurve &master, std::vector<PairPoint> &points) {
  for (PairPoint &p : points)
    p.gap = dot(p.normal, slave.at(p.slave_edge, p.s) - master.at(p.master_edge, p.t));
}

NodalCurve as_graph(NodalCurve curve, const std::string &name) {
  check_degree(curve.degree());
  const int degree = curve.degree();
  if (curve.edges() < 1 ||
      curve.nodes() != curve.shape().vertices() + (degree == 2 ? curve.edges() : Index{0}))
    throw bad_input("the " + name + " curve needs " +
                    (degree == 1 ? "at least 2 nodes" : "an odd number of nodes, at least 3") +
                    ", not " + std::to_string(curve.nodes()));
  const auto check = [&](Index before, Index i) {
    const double x = curve.point(i)[0], last = curve.point(before)[0];
    if (!(last < x))
      throw bad_input("x must increase along the " + name + " curve, but node " +
                      std::to_string(i) + " at x = " + short_number(x) +
                      " follows x = " + short_number(last));
  };
  std::vector<Point> nodes;
  for (Index i = 0; i < curve.nodes(); ++i)
    nodes.push_back(curve.point(i));
  for (Index e = 0; e < curve.edges(); ++e) {
    check(curve.node(e, 0), curve.node(e, 1));
    if (degree == 1) continue;
    const Index middle = curve.node(e, 2);
    check(curve.node(e, 0), middle);
    check(middle, curve.node(e, 1));
    const Point &a = curve.end(e, 0), &b = curve.end(e, 1), &x = curve.point(middle);
    const double s = (x[0] - a[0]) / (b[0] - a[0]);
    const double bulge = (x[1] - (1 - s) * a[1] - s * b[1]) / (4 * s * (1 - s));
    nodes[middle] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2 + bulge, 0};
  }
  return {std::move(nodes), degree, curve.shared_shape()};
}

bool is_partial(double weight, double whole) {
  return !(weight > (1 - round_off) * whole);
}

double ends_in_contact(const PairMultipliers &multipliers, const CurveShape &slave,
                       const Vector &shares, const Vector &lambda, double least,
                       const std::vector<std::array<bool, 2>> &closed) {
  double ends = 0;
  for (std::size_t k = 0; k < slave.pieces.size(); ++k) {
    const CurveChain &piece = slave.pieces[k];
    if (piece.loop) continue;
    const Index begin = multipliers.on_edge(piece.first_edge)[0],
                end = multipliers.on_edge(piece.first_edge + piece.edges - 1)[1];
    const auto carries_from = [&](Index first, Index step) {
      const auto inside = [&](Index row) { return row >= begin && row <= end; };
      Index row = first;
      while (inside(row) && !(shares[row] > round_off))
        row += step;
      if ((row == first ? closed[k] : closed.back())[step > 0 ? 0 : 1] || !inside(row)) return 0.0;
      do {
        if (lambda[row] > least) return 1.0;
        row += step;
      } while (inside(row) && is_partial(shares[row], 1));
      return 0.0;
    };
    ends += carries_from(begin, 1) + carries_from(end, -1);
  }
  return ends;
}

} // namespace rbvi
