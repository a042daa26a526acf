#include "rbvi/contact/nitsche.hpp"

#include "rbvi/contact/curve.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/quadrature.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace rbvi {

namespace {

/// What a point of a cell sees of its nodes.
struct NodeValues {
  std::array<double, most_nodes> values{};
  std::array<std::array<double, 3>, most_nodes> gradients{};
  std::array<double, most_nodes> hoop{}; ///< strain by u_x, of a body that is turned
};

/// Stress on the body's normal and displacement at a point, along n and tau, by the dofs of the
/// cell.
void set_functionals(std::size_t nodes, const NodeValues &at, const Lame &material,
                     NitschePoint &point) {
  const Point &face = point.body_normal, &n = point.facing.normal, tau{-n[1], n[0], 0};
  const auto [lambda, shear] = material;
  const double turned_n = face[0] * n[0] + face[1] * n[1],
               turned_tau = face[0] * tau[0] + face[1] * tau[1];
  for (NitschePoint::Row *row : {&point.sigma_n, &point.sigma_tau, &point.n, &point.tau})
    row->setZero();
  for (std::size_t i = 0; i < nodes; ++i) {
    const auto &g = at.gradients[i];
    const double along_n = g[0] * n[0] + g[1] * n[1], along_tau = g[0] * tau[0] + g[1] * tau[1];
    const double outwards = g[0] * face[0] + g[1] * face[1];
    for (std::size_t c = 0; c < 2; ++c) {
      const auto dof = static_cast<Index>(2 * i + c);
      const double growth = g[c] + (c == 0 ? at.hoop[i] : 0);
      point.sigma_n[dof] =
          lambda * growth * turned_n + shear * (outwards * n[c] + along_n * face[c]);
      point.sigma_tau[dof] =
          lambda * growth * turned_tau + shear * (outwards * tau[c] + along_tau * face[c]);
      point.n[dof] = at.values[i] * n[c];
      point.tau[dof] = at.values[i] * tau[c];
    }
  }
}

/// Of the edge between two vertices of a triangle.
Point outward_normal(const std::array<Point, 4> &vertices, std::size_t begin, std::size_t end) {
  const Point &a = vertices[begin], &b = vertices[end], &c = vertices[3 - begin - end];
  const double x = b[1] - a[1], y = a[0] - b[0];
  const double inwards = x * (c[0] - a[0]) + y * (c[1] - a[1]);
  const double length = std::copysign(std::hypot(x, y), -inwards);
  return {x / length, y / length, 0};
}

} // namespace

PointTerm consistency_term(double sigma, double gamma) {
  return {-sigma * sigma / (2 * gamma), -sigma / gamma, -1 / gamma};
}

PointTerm contact_term(double p, double gamma) {
  if (p >= 0) return {0, 0, 0};
  return {p * p / (2 * gamma), p / gamma, 1 / gamma};
}

PointTerm friction_term(double p, double bound, double gamma) {
  if (bound < 0) return {0, 0, 0};
  const double held = std::clamp(p, -bound, bound), rest = p - held;
  return {(p * p - rest * rest) / (2 * gamma), held / gamma, rest == 0 ? 1 / gamma : 0};
}

NitschePoint nitsche_point(const Scene &scene, const Facing &facing, const FullMu &mu,
                           const CurveCellAtMu &at, double s) {
  const auto [first, second] = simplex_edges[at.edge];
  const auto begin = static_cast<std::size_t>(first), end = static_cast<std::size_t>(second);
  const auto &reference = at.cell.reference, &mapped = at.cell.mapped;
  const Point x{(1 - s) * reference[begin][0] + s * reference[end][0],
                (1 - s) * reference[begin][1] + s * reference[end][1], 0};
  const Point y = (1 - s) * mapped[begin] + s * mapped[end];
  // Made in place: copies of what has just been written stall the processor.
  NitschePoint point{.weight = edge_length(mapped[begin], mapped[end]) *
                               circumference(scene.axisymmetric, y),
                     .place = place(scene, facing, mu, x),
                     .facing = facing.at(mu, point.place, {}),
                     .body_normal = facing.body_normal ? facing.body_normal(mu, x)
                                                       : outward_normal(mapped, begin, end)};
  std::array<double, 3> barycentric{};
  barycentric[begin] = 1 - s;
  barycentric[end] = s;
  NodeValues nodes;
  lagrange_values(2, scene.degree, barycentric, nodes.values);
  lagrange_gradients(2, scene.degree, barycentric, at.geometry, nodes.gradients);
  for (std::size_t i = 0; scene.axisymmetric && i < most_nodes; ++i) // on the axis u_x = 0: a slope
    nodes.hoop[i] = y[0] > 0 ? nodes.values[i] / y[0] : nodes.gradients[i][0];
  set_functionals(nodes_per_cell(2, scene.degree), nodes, at.material, point);
  return point;
}

std::array<NitschePoint, 4> nitsche_points(const Scene &scene, const Facing &facing,
                                           const FullMu &mu, const CurveCellAtMu &at) {
  check_orientation(scene, mu, at.cell);
  std::array<NitschePoint, 4> points;
  for (std::size_t q = 0; q < points.size(); ++q) {
    points[q] = nitsche_point(scene, facing, mu, at, edge_quadrature[q].s);
    points[q].weight *= edge_quadrature[q].weight;
  }
  return points;
}

TurnedAxes turned_axes(const Facing &facing, const FullMu &mu, const PlacedPoint &point,
                       const Point &n, double along_n, double along_tau) {
  const Point displacement{along_n * n[0] - along_tau * n[1], along_n * n[1] + along_tau * n[0], 0};
  const FacedPoint now = facing.at(mu, point, displacement);
  return {now, dot(now.normal, n), slip_along(n, now.normal)};
}

void turn_to(const Facing &facing, const FullMu &mu, const NitschePoint::Row &u,
             NitschePoint &point) {
  const auto [now, c, s] =
      turned_axes(facing, mu, point.place, point.facing.normal, point.n.dot(u), point.tau.dot(u));
  for (const auto &[normal, tangential] :
       {std::pair{&point.sigma_n, &point.sigma_tau}, std::pair{&point.n, &point.tau}}) {
    const NitschePoint::Row before = *normal;
    *normal = c * before + s * *tangential;
    *tangential = c * *tangential - s * before;
  }
  point.facing = now;
  point.turning = std::min(point.sigma_n.dot(u), 0.0) * now.curvature;
}

} // namespace rbvi
