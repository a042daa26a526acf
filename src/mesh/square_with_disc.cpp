#include "rings.hpp"

#include <cmath>
#include <numbers>

namespace rbvi {

namespace {

constexpr double radius = 0.2;
constexpr int disc_rings = 12;  ///< ring k has 6 k nodes
constexpr int outer_rings = 23; ///< from the circle's 72 nodes to the square's 200
constexpr int square_nodes = 200;
constexpr int circle_nodes = 6 * disc_rings;

int nodes_of_outer_ring(int j) {
  return circle_nodes + 8 * ((square_nodes - circle_nodes) * j / (8 * outer_rings));
}

/// Point of the unit circle at turn t in [0, 1).
Point on_circle(double t) {
  const double angle = 2 * std::numbers::pi * t;
  return {std::cos(angle), std::sin(angle), 0};
}

/// Point of the boundary of [-1/2, 1/2]^2 at the fraction t of its length, from (1/2, 0) on.
Point on_square(double t) {
  const double s = std::fmod(8 * t + 1, 8.0);
  const double along = 0.5 * (std::fmod(s, 2.0) - 1);
  switch (static_cast<int>(s / 2)) {
  case 0:
    return {0.5, along, 0};
  case 1:
    return {-along, 0.5, 0};
  case 2:
    return {-0.5, -along, 0};
  default:
    return {along, -0.5, 0};
  }
}

/// Point of the regular hexagon of the unit circle's area, corners at turns 0, 1/6, ...
Point on_hexagon(double t) {
  const double corner = std::floor(6 * t), along = 6 * t - corner;
  const Point c = on_circle(corner / 6), d = on_circle((corner + 1) / 6);
  const double size = std::sqrt(2 * std::numbers::pi / (3 * std::sqrt(3.0)));
  return {size * ((1 - along) * c[0] + along * d[0]), size * ((1 - along) * c[1] + along * d[1]),
          0};
}

/// Ring at the fraction rho of the radius: a lattice of equilateral triangles near the centre,
/// which turns into the circle. It is turned and shifted a little: a mesh whose rings are
/// concentric with the contact set would gain or lose whole rings of contact nodes at once.
Point in_disc(double rho, double t) {
  constexpr double turn = 0.4 / circle_nodes;
  constexpr std::array shift{0.0061, 0.0043};
  const Point h = on_hexagon(t), c = on_circle(t);
  const double blend = rho * rho, rest = 1 - rho * rho;
  const double x = radius * rho * ((1 - blend) * h[0] + blend * c[0]);
  const double y = radius * rho * ((1 - blend) * h[1] + blend * c[1]);
  const Point rotation = on_circle(turn);
  return {rotation[0] * x - rotation[1] * y + rest * shift[0],
          rotation[1] * x + rotation[0] * y + rest * shift[1], 0};
}

} // namespace

SerialMesh square_with_disc() {
  SerialMesh mesh;
  mesh.points.push_back(in_disc(0, 0));
  Ring ring;
  for (int k = 1; k <= disc_rings; ++k) {
    const Ring next = add_closed_ring(
        mesh, 6 * k, [&](double t) { return in_disc(static_cast<double>(k) / disc_rings, t); });
    if (k > 1)
      zip(mesh, ring, next);
    else
      for (std::size_t i = 0; i < 6; ++i)
        mesh.cells.push_back({0, next[i], next[i + 1], -1});
    ring = next;
  }
  for (int cell = 0; cell < static_cast<int>(mesh.cells.size()); ++cell)
    mesh.region["obstacle"].push_back(cell);

  for (int j = 1; j <= outer_rings; ++j) {
    const Ring next = add_closed_ring(mesh, nodes_of_outer_ring(j), [&](double t) -> Point {
      const Point c = on_circle(t), s = on_square(t);
      const double blend = static_cast<double>(j) / outer_rings;
      const double circle = radius * (1 - blend);
      return {circle * c[0] + blend * s[0], circle * c[1] + blend * s[1], 0};
    });
    zip(mesh, ring, next);
    ring = next;
  }
  add_facets(mesh, "boundary", ring);
  return mesh;
}

} // namespace rbvi
