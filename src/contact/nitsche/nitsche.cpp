#include "rbvi/contact/nitsche/nitsche.hpp"

#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/quadrature.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace rbvi {

namespace {

/// Stress and displacement at a point by the dofs of the cell: values and gradients of its nodes.
void set_functionals(std::size_t nodes, std::span<const double> values,
                     std::span<const std::array<double, 3>> gradients, const Point &n,
                     const Lame &material, NitschePoint &point) {
  const Point tau{-n[1], n[0], 0};
  const auto [lambda, shear] = material;
  for (NitschePoint::Row *row : {&point.sigma_n, &point.sigma_tau, &point.n, &point.tau})
    row->setZero();
  for (std::size_t i = 0; i < nodes; ++i) {
    const auto &g = gradients[i];
    const double along_n = g[0] * n[0] + g[1] * n[1], along_tau = g[0] * tau[0] + g[1] * tau[1];
    for (std::size_t c = 0; c < 2; ++c) {
      const auto dof = static_cast<Index>(2 * i + c);
      point.sigma_n[dof] = lambda * g[c] + 2 * shear * along_n * n[c];
      point.sigma_tau[dof] = shear * (along_tau * n[c] + along_n * tau[c]);
      point.n[dof] = values[i] * n[c];
      point.tau[dof] = values[i] * tau[c];
    }
  }
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
  const double held = std::clamp(p, -bound, bound), rest = p - held;
  return {(p * p - rest * rest) / (2 * gamma), held / gamma, rest == 0 ? 1 / gamma : 0};
}

double coulomb_bound(double p, double coefficient) {
  return coefficient * std::max(-p, 0.0);
}

NitschePoint nitsche_point(const Scene &scene, const Support &support, const FullMu &mu,
                           const Cell &cell, int edge, const Lame &material, double s) {
  const Simplex geometry = simplex(2, cell.mapped);
  const auto [first, second] = simplex_edges[static_cast<std::size_t>(edge)];
  const auto begin = static_cast<std::size_t>(first), end = static_cast<std::size_t>(second);
  const Point x{(1 - s) * cell.reference[begin][0] + s * cell.reference[end][0],
                (1 - s) * cell.reference[begin][1] + s * cell.reference[end][1], 0};
  const SupportPoint here = support_point(scene, support, mu, x);
  NitschePoint point;
  point.weight = std::hypot(cell.mapped[end][0] - cell.mapped[begin][0],
                            cell.mapped[end][1] - cell.mapped[begin][1]);
  point.gap = here.gap;
  point.slip = here.slip;
  std::array<double, 3> barycentric{};
  barycentric[begin] = 1 - s;
  barycentric[end] = s;
  std::array<double, most_nodes> values{};
  std::array<std::array<double, 3>, most_nodes> gradients{};
  lagrange_values(2, scene.degree, barycentric, values);
  lagrange_gradients(2, scene.degree, barycentric, geometry, gradients);
  set_functionals(static_cast<std::size_t>(nodes_per_cell(2, scene.degree)), values, gradients,
                  here.normal, material, point);
  return point;
}

std::array<NitschePoint, 4> nitsche_points(const Scene &scene, const Support &support,
                                           const FullMu &mu, const Cell &cell, int edge,
                                           const Lame &material) {
  check_orientation(scene, mu, cell);
  std::array<NitschePoint, 4> points;
  for (std::size_t q = 0; q < points.size(); ++q) {
    points[q] = nitsche_point(scene, support, mu, cell, edge, material, edge_quadrature[q].s);
    points[q].weight *= edge_quadrature[q].weight;
  }
  return points;
}

} // namespace rbvi
