#include "facing.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/quadrature.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// A quarter turn to the left of a tangent, of length 1.
Point upwards(const Point &tangent) {
  const double length = norm(tangent);
  if (!(length > 0)) throw failure("an edge of a contact curve has lost its length");
  return {-tangent[1] / length, tangent[0] / length, 0};
}

Point mean(const Point &a, const Point &b) {
  const Point sum{a[0] + b[0], a[1] + b[1], 0};
  const double length = norm(sum);
  if (!(length > 1e-3)) throw failure("a contact curve has folded back on itself");
  return {sum[0] / length, sum[1] / length, 0};
}

} // namespace

CurrentCurve::CurrentCurve(std::vector<Point> nodes, int degree)
    : nodes_(std::move(nodes)), degree_(degree),
      edges_((static_cast<Index>(nodes_.size()) - 1) / degree) {}

std::array<double, 3> CurrentCurve::values(double s) const {
  std::array<double, 3> result{};
  lagrange_values(1, static_cast<int>(degree_), std::array{1 - s, s}, result);
  return result;
}

std::array<double, 3> CurrentCurve::slopes(double s) const {
  if (degree_ == 1) return {-1, 1, 0};
  return {4 * s - 3, 4 * s - 1, 4 - 8 * s};
}

Point CurrentCurve::sum(Index edge, const std::array<double, 3> &coefficients,
                        const std::vector<Point> &of_nodes) const {
  Point result{};
  for (Index k = 0; k < per_edge(); ++k)
    for (std::size_t c = 0; c < 2; ++c)
      result[c] += coefficients[k] * of_nodes[node(edge, k)][c];
  return result;
}

std::vector<Point> nodal_normals(const CurrentCurve &curve, MirroredEnds mirrored) {
  std::vector<Point> normals;
  const auto mirror = [](const Point &n) { return Point{-n[0], n[1], 0}; };
  for (Index v = 0; v <= curve.edges(); ++v) {
    const Index left = v - 1, right = v;
    if (v == 0 || v == curve.edges()) {
      const Point n = upwards(v == 0 ? curve.tangent(right, 0) : curve.tangent(left, 1));
      normals.push_back((v == 0 ? mirrored.first : mirrored.last) ? mean(n, mirror(n)) : n);
    } else {
      normals.push_back(mean(upwards(curve.tangent(left, 1)), upwards(curve.tangent(right, 0))));
    }
  }
  for (Index e = 0; e < curve.edges() && curve.per_edge() == 3; ++e)
    normals.push_back(upwards(curve.tangent(e, 0.5)));
  return normals;
}

Projection::Projection(const CurrentCurve &slave, const CurrentCurve &master, MirroredEnds mirrored)
    : slave_(slave), master_(master), normals_(nodal_normals(master, mirrored)) {
  Index from = 0;
  for (Index v = 0; v <= master.edges(); ++v)
    cuts_.push_back(abscissa_of(v, from));
}

/// Where the normal of a master vertex meets the slave curve, searched from edge `from` onwards.
double Projection::abscissa_of(Index master_vertex, Index &from) const {
  const Point &origin = master_.vertex(master_vertex);
  const Point &n = normals_[master_vertex];
  const auto beside = [&](Index edge, double s) { // > 0: to the right of the normal
    return cross(slave_.at(edge, s) - origin, n)[2];
  };
  const double edge_length = norm(slave_.vertex(1) - slave_.vertex(0));
  const double round_off = 1e-12 * edge_length;
  if (beside(0, 0) > round_off) return -1;
  while (from + 1 < slave_.edges() && beside(from, 1) <= round_off)
    ++from;
  const double end = beside(from, 1);
  if (end < -round_off) return static_cast<double>(slave_.edges()) + 1;
  double low = 0, high = 1, s = 0.5; // safeguarded Newton steps
  for (int k = 0; k < 60 && high - low > 1e-15; ++k) {
    const double value = beside(from, s);
    if (std::abs(value) <= 1e-15 * edge_length) break;
    (value > 0 ? high : low) = s;
    const double next = s - value / cross(slave_.tangent(from, s), n)[2];
    s = next > low && next < high ? next : 0.5 * (low + high);
  }
  return static_cast<double>(from) + s;
}

std::vector<Index> Projection::segments() const {
  constexpr double round_off = 1e-8;
  std::vector<Index> edges;
  for (const double cut : cuts_)
    edges.push_back(static_cast<Index>(std::floor(cut + round_off)));
  return edges;
}

/// Newton's method for (y - y(t)) x nu(t) = 0, from where the point is between the cuts.
Facing Projection::facing(Index slave_edge, double s, Index master_edge) const {
  constexpr double round_off = 1e-13, settled = 1e-8; // what is left is the square of the last step
  const Point y = slave_.at(slave_edge, s);
  const double begin = cuts_[master_edge], end = cuts_[static_cast<std::size_t>(master_edge) + 1];
  double t = std::clamp((static_cast<double>(slave_edge) + s - begin) / (end - begin), 0.0, 1.0);
  Facing result{slave_edge, master_edge, s, 0, 0, {}, 0, 0};
  double last = 1;
  for (int k = 0; k < 30; ++k) {
    const Point away = y - master_.at(master_edge, t);
    const Point field = master_.sum(master_edge, master_.values(t), normals_);
    const Point turn = master_.sum(master_edge, master_.slopes(t), normals_);
    const Point tangent = master_.tangent(master_edge, t);
    const double length = norm(field), stretch = norm(tangent);
    const double step = cross(away, field)[2] / (cross(tangent, field) - cross(away, turn))[2];
    if (std::abs(step) > round_off && std::abs(last) > settled) {
      t += std::clamp(step, -0.5, 0.5);
      last = step;
      continue;
    }
    result.t = t;
    result.normal = {field[0] / length, field[1] / length, 0};
    result.stretch = stretch;
    // d nu = -k tau along the curve
    const Point tau{result.normal[1], -result.normal[0], 0};
    result.curvature = -(tau[0] * turn[0] + tau[1] * turn[1]) / (length * stretch);
    return result;
  }
  throw failure("the bodies do not face each other at (" + short_number(y[0]) + ", " +
                short_number(y[1]) +
                ") of the upper contact curve, which has no projection onto the lower one there: "
                "try a smaller indentation, or more -nonlinear_load_steps");
}

std::vector<Facing> Projection::gauss_points() const {
  std::vector<Facing> points;
  for (Index m = 0; m < master_.edges(); ++m) {
    const double end =
        std::min(cuts_[static_cast<std::size_t>(m) + 1], static_cast<double>(slave_.edges()));
    double begin = std::max(cuts_[m], 0.0);
    while (end - begin > 1e-12) {
      const auto edge = std::min(static_cast<Index>(begin + 1e-12), slave_.edges() - 1);
      const double first = begin - static_cast<double>(edge),
                   last = std::min(end - static_cast<double>(edge), 1.0);
      begin = static_cast<double>(edge) + last;
      if (last - first <= 1e-12) continue;
      for (const EdgePoint &at : edge_quadrature) {
        points.push_back(facing(edge, first + at.s * (last - first), m));
        points.back().weight = at.weight * (last - first);
      }
    }
  }
  return points;
}

std::vector<Facing> Projection::vertices() const {
  std::vector<Facing> points;
  Index m = 0;
  for (Index v = 0; v <= slave_.edges(); ++v) {
    const auto at = static_cast<double>(v);
    while (m + 1 < master_.edges() && cuts_[static_cast<std::size_t>(m) + 1] <= at)
      ++m;
    if (at < cuts_[m] - 1e-12 || at > cuts_[static_cast<std::size_t>(m) + 1] + 1e-12) continue;
    const Index edge = std::min(v, slave_.edges() - 1);
    points.push_back(facing(edge, at - static_cast<double>(edge), m));
    points.back().weight = at;
  }
  return points;
}

} // namespace rbvi
