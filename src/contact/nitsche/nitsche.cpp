#include "rbvi/contact/nitsche/nitsche.hpp"

#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/quadrature.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace rbvi {

namespace {

/// Stress on the body's normal and displacement at a point, along n and tau, by the dofs of the
/// cell: values and gradients of its nodes.
void set_functionals(std::size_t nodes, std::span<const double> values,
                     std::span<const std::array<double, 3>> gradients, const Lame &material,
                     NitschePoint &point) {
  const Point &face = point.body_normal, &n = point.facing.normal, tau{-n[1], n[0], 0};
  const auto [lambda, shear] = material;
  const double turned_n = face[0] * n[0] + face[1] * n[1],
               turned_tau = face[0] * tau[0] + face[1] * tau[1];
  for (NitschePoint::Row *row : {&point.sigma_n, &point.sigma_tau, &point.n, &point.tau})
    row->setZero();
  for (std::size_t i = 0; i < nodes; ++i) {
    const auto &g = gradients[i];
    const double along_n = g[0] * n[0] + g[1] * n[1], along_tau = g[0] * tau[0] + g[1] * tau[1];
    const double outwards = g[0] * face[0] + g[1] * face[1];
    for (std::size_t c = 0; c < 2; ++c) {
      const auto dof = static_cast<Index>(2 * i + c);
      point.sigma_n[dof] = lambda * g[c] * turned_n + shear * (outwards * n[c] + along_n * face[c]);
      point.sigma_tau[dof] =
          lambda * g[c] * turned_tau + shear * (outwards * tau[c] + along_tau * face[c]);
      point.n[dof] = values[i] * n[c];
      point.tau[dof] = values[i] * tau[c];
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

double coulomb_bound(double p, double coefficient) {
  return coefficient * std::max(-p, 0.0);
}

NitschePoint nitsche_point(const Scene &scene, const NitscheFacing &facing, const FullMu &mu,
                           const Cell &cell, int edge, const Lame &material, double s) {
  const Simplex geometry = simplex(2, cell.mapped);
  const auto [first, second] = simplex_edges[edge];
  const auto begin = static_cast<std::size_t>(first), end = static_cast<std::size_t>(second);
  const Point x{(1 - s) * cell.reference[begin][0] + s * cell.reference[end][0],
                (1 - s) * cell.reference[begin][1] + s * cell.reference[end][1], 0};
  NitschePoint point;
  point.x = x;
  point.facing = facing.at(mu, x, {});
  point.weight = std::hypot(cell.mapped[end][0] - cell.mapped[begin][0],
                            cell.mapped[end][1] - cell.mapped[begin][1]);
  std::array<double, 3> barycentric{};
  barycentric[begin] = 1 - s;
  barycentric[end] = s;
  std::array<double, most_nodes> values{};
  std::array<std::array<double, 3>, most_nodes> gradients{};
  lagrange_values(2, scene.degree, barycentric, values);
  lagrange_gradients(2, scene.degree, barycentric, geometry, gradients);
  point.body_normal =
      facing.body_normal ? facing.body_normal(mu, x) : outward_normal(cell.mapped, begin, end);
  set_functionals(nodes_per_cell(2, scene.degree), values, gradients, material, point);
  return point;
}

std::array<NitschePoint, 4> nitsche_points(const Scene &scene, const NitscheFacing &facing,
                                           const FullMu &mu, const Cell &cell, int edge,
                                           const Lame &material) {
  check_orientation(scene, mu, cell);
  std::array<NitschePoint, 4> points;
  for (std::size_t q = 0; q < points.size(); ++q) {
    points[q] = nitsche_point(scene, facing, mu, cell, edge, material, edge_quadrature[q].s);
    points[q].weight *= edge_quadrature[q].weight;
  }
  return points;
}

void turn_to(const NitscheFacing &facing, const FullMu &mu, const NitschePoint::Row &u,
             NitschePoint &point) {
  const Point n = point.facing.normal;
  const double along_n = point.n.dot(u), along_tau = point.tau.dot(u);
  point.facing = facing.at(
      mu, point.x, {along_n * n[0] - along_tau * n[1], along_n * n[1] + along_tau * n[0], 0});
  const Point &now = point.facing.normal;
  const double c = now[0] * n[0] + now[1] * n[1], s = now[1] * n[0] - now[0] * n[1];
  for (const auto &[normal, tangential] :
       {std::pair{&point.sigma_n, &point.sigma_tau}, std::pair{&point.n, &point.tau}}) {
    const NitschePoint::Row before = *normal;
    *normal = c * before + s * *tangential;
    *tangential = c * *tangential - s * before;
  }
  point.turning = std::min(point.sigma_n.dot(u), 0.0) * point.facing.curvature;
}

} // namespace rbvi
