#include "rbvi/contact/support/curve_support.hpp"

#include "rbvi/contact/curve.hpp"
#include "rbvi/contact/support/support_outputs.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/quadrature.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

TracePoint trace_point(int degree, const EdgePoint &at) {
  TracePoint point{at.s, at.weight, {1 - at.s, at.s}, {}};
  lagrange_values(1, degree, point.eta, point.phi);
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

/// n . the normal of the mapped edge that points down where the edge goes to the right.
double downwards(const Cell &edge, const Point &n) {
  const Point &begin = edge.mapped[0], &end = edge.mapped[1];
  return n[0] * (end[1] - begin[1]) - n[1] * (end[0] - begin[0]);
}

} // namespace

double length_of(const Cell &edge) {
  const double x = edge.mapped[1][0] - edge.mapped[0][0], y = edge.mapped[1][1] - edge.mapped[0][1];
  return std::sqrt(x * x + y * y);
}

CurveSupport::CurveSupport(const Scene &scene, InterfaceMesh interface_mesh, Friction friction,
                           bool lumped)
    : EntitySum(scene, std::move(interface_mesh), 1), friction_(std::move(friction)),
      points_(trace_points(mesh_.degree, lumped)) {
  const Index vertices = check_curve(mesh_, 0, "support's boundary");
  if (mesh_.components != 2)
    throw bad_input("scene " + scene.name +
                    ": a rigid support is for displacements of two "
                    "components");
  const std::vector<Point> points(mesh_.points.begin(), mesh_.points.begin() + vertices);
  const int copies = friction_.law == FrictionLaw::none ? 1 : 2;
  set_dual(vertices, copies, lumped, linear_gram(points, copies));
}

void CurveSupport::find_side() {
  FullMu mu;
  for (const Parameter &parameter : scene_.parameters.all)
    mu.push_back(parameter.value);
  double nearest = std::numeric_limits<double>::infinity();
  for (Index e = 0; e < mesh_.count(); ++e) {
    try {
      Cell edge = reference_entity(e);
      for (std::size_t i = 0; i < 2; ++i)
        edge.mapped[i] = scene_.map(mu, edge.reference[i]);
      const TracePoint &at = points_.front();
      const SupportPoint here = support_at(mu, edge, at, point_on(edge, at));
      if (!(std::abs(here.gap) < nearest)) continue;
      nearest = std::abs(here.gap);
      side_ = std::copysign(1, downwards(edge, here.normal));
    } catch (const std::exception &) { // it faces nothing at these values
    }
  }
}

void CurveSupport::integrate(const FullMu &mu, const Cell &edge, EntityValues &values) const {
  const double whole = length_of(edge);
  const Index columns = values.b.cols(), nodes = columns / 2;
  const bool friction = values.b.rows() > 2;
  values.b.setZero();
  values.g.setZero();
  for (const TracePoint &at : points_) {
    const double weight = at.weight * whole;
    const SupportPoint here = support_at(mu, edge, at, point_on(edge, at));
    for (Index a = 0; a < 2; ++a) {
      const double eta = weight * at.eta[a];
      for (Index node = 0; node < nodes; ++node)
        for (Index c = 0; c < 2; ++c)
          values.b(a, 2 * node + c) += eta * at.phi[node] * here.normal[c];
      values.g[a] += here.gap * eta;
      if (friction) values.g[2 + a] -= here.slip * eta;
    }
  }
  for (Index a = 0; a < 2 && friction; ++a) // v . tau is v . n with v turned: (v_y, -v_x) . n
    for (Index k = 0; k < columns; k += 2) {
      values.b(2 + a, k) = -values.b(a, k + 1);
      values.b(2 + a, k + 1) = values.b(a, k);
    }
}

/// The work of multipliers on a unit displacement, B e_x and B e_y, where `lambda` is not zero.
/// `mapped`: the vertices.
CurveSupport::Lift CurveSupport::lift(const FullMu &mu, const ContactState &state,
                                      const Matrix &mapped, const Vector &lambda) const {
  Lift result{Vector::Zero(dual_.size()), Vector::Zero(dual_.size())};
  std::vector<double> displacement;
  for (Index e = 0; e < mesh_.count(); ++e) {
    const std::span<const int> rows = rows_of(e);
    if (std::ranges::none_of(rows, [&](Index row) { return row >= 0 && lambda[row] != 0; }))
      continue;
    Cell edge = reference_entity(e);
    if (follows_state()) set_displacement(mu, e, state, edge, displacement);
    for (Index i = 0; i < 2; ++i)
      edge.mapped[i] = {mapped(e + i, 0), mapped(e + i, 1), 0};
    const double whole = length_of(edge);
    const auto pressure = [&](std::size_t a) { return rows[a] < 0 ? 0 : lambda[rows[a]]; };
    for (const TracePoint &at : points_) {
      const Point x = point_on(edge, at), n = normal_at(mu, edge, at, x);
      // Tresca's traction acts without pressure, too.
      const bool pressed = at.eta[0] * pressure(0) + at.eta[1] * pressure(1) > 0;
      if (pressed && side_ != 0) check_pressed_side(side_ * downwards(edge, n), x);
      for (std::size_t a = 0; a < 2; ++a) {
        if (rows[a] < 0) continue;
        const double eta = at.weight * whole * at.eta[a];
        result.horizontal[rows[a]] += eta * n[0];
        result.vertical[rows[a]] += eta * n[1];
        if (dual_.components == 1) continue;
        result.horizontal[rows[2 + a]] -= eta * n[1];
        result.vertical[rows[2 + a]] += eta * n[0];
      }
    }
  }
  return result;
}

void CurveSupport::outputs(const FullMu &mu, const ContactOperators &operators,
                           const Vector &lambda, double, Outputs &outputs) const {
  const std::vector<Point> vertices(mesh_.points.begin(), mesh_.points.begin() + mesh_.count() + 1);
  const Matrix mapped = mapped_points(scene_, mu, vertices);
  const Lift unit = lift(mu, operators.state, mapped, lambda);
  support_outputs({lambda, operators.weights, unit.horizontal, unit.vertical, bound(mu),
                   mapped(dual_.vertices, Eigen::all)},
                  outputs);
  if (!counts_ends()) return;
  const std::vector<Index> on_axis = partly_fixed(); // of symmetry: there contact has no end
  const auto carries = [&](Index node) {
    return lambda[node] > 0 && std::ranges::find(on_axis, node) == on_axis.end() ? 1.0 : 0.0;
  };
  outputs.ends_in_contact = carries(0) + carries(dual_.nodes() - 1);
}

} // namespace rbvi
