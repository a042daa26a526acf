#include "rings.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rbvi {

namespace {

constexpr double radius = 0.2;
constexpr int disc_rings = 12;  ///< ring k has 6 k nodes
constexpr int outer_rings = 23; ///< from the circle's 72 nodes to the square's 200
constexpr int square_nodes = 200;
constexpr int circle_nodes = 6 * disc_rings;

// Sizes of the graded mesh. The contact set reaches to 0.6 of the disc's radius: the finest part is
// a little larger. It, outer_distance and outer_growth were chosen by the errors of all outputs at
// a given number of nodes.
constexpr double core = 0.65;           ///< radius, in radii of the disc
constexpr double shell_distance = 0.91; ///< of the rings around the core, in edges
constexpr double outer_distance = 0.74; ///< of the rings outside the disc, on average, in edges
constexpr double outer_growth = 1.1;    ///< of the edges from the circle to the square
constexpr double mean_width = 0.37;     ///< between the circle and the square

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
  const double size = std::sqrt(2 * std::numbers::pi / (3 * std::sqrt(3.0)));
  return size * ((1 - along) * on_circle(corner / 6) + along * on_circle((corner + 1) / 6));
}

/// Ring at the fraction rho of the radius: a lattice of equilateral triangles near the centre,
/// which turns into the circle. It is turned and shifted a little: a mesh whose rings are
/// concentric with the contact set would gain or lose whole rings of contact nodes at once.
Point in_disc(double rho, double t, double turn) {
  constexpr std::array shift{0.0061, 0.0043};
  const double blend = rho * rho, rest = 1 - rho * rho;
  const Point x = radius * rho * ((1 - blend) * on_hexagon(t) + blend * on_circle(t));
  const Point rotation = on_circle(turn);
  return {rotation[0] * x[0] - rotation[1] * x[1] + rest * shift[0],
          rotation[1] * x[0] + rotation[0] * x[1] + rest * shift[1], 0};
}

/// Ring at the fraction blend of the way from the circle to the square.
Point in_frame(double blend, double t) {
  return radius * (1 - blend) * on_circle(t) + blend * on_square(t);
}

using Zip = void (*)(SerialMesh &, const Ring &, const Ring &);

/// The rings of the disc at the fractions rho of its radius; the k-th has 6 k nodes, at most
/// `circle_edges`: those after that are turned by half an edge against each other. Returns the
/// circle.
Ring add_disc(SerialMesh &mesh, const std::vector<double> &rho, int circle_edges, Zip fill) {
  const double turn = 0.4 / circle_edges;
  mesh.points.push_back(in_disc(0, 0, turn));
  Ring ring;
  for (int k = 1; k <= static_cast<int>(rho.size()); ++k) {
    const int nodes = std::min(6 * k, circle_edges);
    const double start = 6 * k > circle_edges && (k - circle_edges / 6) % 2 == 1 ? 0.5 / nodes : 0;
    const Ring next = add_closed_ring(
        mesh, nodes, [&](double t) { return in_disc(rho[k - 1], t + start, turn); });
    if (k > 1)
      fill(mesh, ring, next);
    else
      for (std::size_t i = 0; i < 6; ++i)
        mesh.cells.push_back({0, next[i], next[i + 1], -1});
    ring = next;
  }
  for (int cell = 0; cell < static_cast<int>(mesh.cells.size()); ++cell)
    mesh.region["obstacle"].push_back(cell);
  return ring;
}

/// The core in rings of equal distance, then a shell of rings whose distance grows with the radius
/// as their edges do.
std::vector<double> graded_disc(int circle_edges) {
  const int core_rings = circle_edges / 6;
  const double distance = shell_distance * 2 * std::numbers::pi / circle_edges;
  const auto shells = static_cast<int>(std::lround(-std::log(core) / distance));
  std::vector<double> rho;
  for (int k = 1; k <= core_rings; ++k)
    rho.push_back(core * k / core_rings);
  for (int k = 1; k < shells; ++k)
    rho.push_back(std::pow(core, 1 - static_cast<double>(k) / shells));
  rho.push_back(1);
  return rho;
}

} // namespace

SerialMesh square_with_disc() {
  SerialMesh mesh;
  std::vector<double> rho;
  for (int k = 1; k <= disc_rings; ++k)
    rho.push_back(static_cast<double>(k) / disc_rings);
  Ring ring = add_disc(mesh, rho, circle_nodes, zip);
  for (int j = 1; j <= outer_rings; ++j) {
    const double blend = static_cast<double>(j) / outer_rings;
    const Ring next =
        add_closed_ring(mesh, nodes_of_outer_ring(j), [&](double t) { return in_frame(blend, t); });
    zip(mesh, ring, next);
    ring = next;
  }
  add_facets(mesh, "boundary", ring);
  return mesh;
}

SerialMesh square_with_disc(int circle_edges) {
  if (circle_edges < 12 || circle_edges % 12 != 0)
    throw bad_input("the mesh of the square with a disc cannot have " +
                    std::to_string(circle_edges) +
                    " edges on the circle: their number must be a multiple of 12");
  SerialMesh mesh;
  Ring ring = add_disc(mesh, graded_disc(circle_edges), circle_edges, zip_best);
  // Edges grow linearly with blend; rings are equally distant in edges.
  const double circle_edge = 2 * std::numbers::pi * radius / circle_edges;
  const double across = mean_width * std::log(outer_growth) / (outer_growth - 1) / circle_edge;
  const auto rings = static_cast<int>(std::lround(across / outer_distance));
  for (int j = 1; j <= rings; ++j) {
    const double growth = std::pow(outer_growth, static_cast<double>(j) / rings);
    const double blend = j == rings ? 1 : (growth - 1) / (outer_growth - 1);
    const double perimeter = 2 * std::numbers::pi * radius * (1 - blend) + 4 * blend;
    const int nodes = 8 * static_cast<int>(std::lround(perimeter / (circle_edge * growth) / 8));
    const Ring next = add_closed_ring(mesh, nodes, [&](double t) { return in_frame(blend, t); });
    zip_best(mesh, ring, next);
    ring = next;
  }
  add_facets(mesh, "boundary", ring);
  return mesh;
}

} // namespace rbvi
