#include "quarter_disc.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace rbvi {

namespace {

constexpr double centre = 1.5; ///< height of the upper disc's centre; its radius is 1
constexpr double contact_angle = std::numbers::pi / 4;
constexpr int contact_edges = 560;

// With these three values each body has 3065 nodes, and no cell an aspect ratio above 1.65.
constexpr double growth = 0.242; ///< of the edges, per distance from the contact arc
constexpr double longest_edge = 0.094;
constexpr int last_ring = 25;            ///< the flat side; ring 0 is the contact arc
constexpr double offset_distance = 0.25; ///< up to here the rings are offset curves

/// Edge length at a distance from the contact arc.
double edge_at(double distance) {
  return std::min(contact_angle / contact_edges + growth * distance, longest_edge);
}

/// Distances of the rings: nearly equilateral triangles in the strips between them.
std::vector<double> ring_distances() {
  const double height = std::sqrt(3.0) / 2;
  std::vector<double> distances{0};
  for (int j = 1; j <= last_ring; ++j) {
    const double d = distances.back();
    distances.push_back(d + height * edge_at(d + 0.5 * height * edge_at(d)));
  }
  return distances;
}

/// Point of the upper disc at a radius and at an angle from its lowest point.
Point polar(double radius, double angle) {
  return {radius * std::sin(angle), centre - radius * std::cos(angle), 0};
}

/// The curve at a distance d from the contact arc: a concentric arc, then the round cap about the
/// end of the contact arc, as far as the boundary of the disc.
struct Offset {
  double d;
  double arc() const { return (1 - d) * contact_angle; }
  double cap() const { return d * (std::numbers::pi / 2 - std::asin(d / 2)); }
  double length() const { return arc() + cap(); }
  /// Angle at which it meets the boundary of the disc.
  double end_angle() const { return contact_angle + 2 * std::asin(d / 2); }
  /// At the fraction s of its length.
  Point at(double s) const {
    const double along = s * length();
    if (along <= arc()) return polar(1 - d, along / (1 - d));
    const Point end = polar(1, contact_angle);
    const double angle = contact_angle - (along - arc()) / d; // of the normal to the vertical
    return {end[0] - d * std::sin(angle), end[1] + d * std::cos(angle), 0};
  }
};

/// Turns from an offset curve (blend = 0) into the flat side (blend = 1); the ends move along the
/// axis and along the boundary of the disc.
struct RingCurve {
  Offset offset;
  double blend;
  double length() const { return (1 - blend) * offset.length() + blend; }
  Point straight(double s) const {
    return (1 - blend) * offset.at(s) + blend * Point{s, centre, 0};
  }
  Point at(double s) const {
    const Point rim = polar(1, (1 - blend) * offset.end_angle() + blend * std::numbers::pi / 2);
    return straight(s) + s * (rim - straight(1));
  }
};

SerialMesh upper_body() {
  SerialMesh mesh;
  Ring ring;
  const std::vector<double> distances = ring_distances();
  for (const double d : distances) {
    const double blend = (d - offset_distance) / (distances.back() - offset_distance);
    const RingCurve curve{{std::min(d, offset_distance)}, std::max(0.0, blend)};
    const int edges = static_cast<int>(std::lround(curve.length() / edge_at(d)));
    const Ring next = add_open_ring(mesh, edges, [&](double s) { return curve.at(s); });
    if (ring.empty()) {
      add_facets(mesh, "slave", next);
      add_facets(mesh, "arc", next);
    } else {
      zip(mesh, next, ring);
      add_facets(mesh, "arc", {ring.back(), next.back()});
      add_facets(mesh, "axis", {next.front(), ring.front()});
    }
    ring = next;
  }
  add_facets(mesh, "top", ring);
  for (int cell = 0; cell < static_cast<int>(mesh.cells.size()); ++cell)
    mesh.region["upper"].push_back(cell);
  return mesh;
}

/// Appends the image of the upper body by y -> -y.
void add_lower_body(SerialMesh &mesh, const SerialMesh &upper) {
  const auto first = static_cast<int>(mesh.points.size());
  for (const Point &x : upper.points)
    mesh.points.push_back({x[0], -x[1], 0});
  for (const auto &cell : upper.cells) {
    mesh.region["lower"].push_back(static_cast<int>(mesh.cells.size()));
    mesh.cells.push_back({first + cell[0], first + cell[2], first + cell[1], -1});
  }
  for (const auto &[name, facets] : upper.boundary) {
    const std::string image = name == "top" ? "bottom" : name == "slave" ? "master" : name;
    for (const auto &facet : facets)
      mesh.boundary[image].push_back({first + facet[1], first + facet[0], -1});
  }
}

SerialMesh two_bodies(const SerialMesh &upper) {
  SerialMesh mesh = upper;
  add_lower_body(mesh, upper);
  return mesh;
}

} // namespace

SerialMesh two_quarter_discs() {
  return two_bodies(upper_body());
}

SerialMesh two_graded_quarter_discs(int edges) {
  if (edges < 8)
    throw bad_input("the mesh of two quarter discs cannot have " + std::to_string(edges) +
                    " contact edges: at least 8");
  // With these values 140 contact edges give 6142 nodes of degree 2, and no aspect ratio
  // above 1.56.
  SerialMesh upper = quarter_disc({.contact_angle = contact_angle,
                                   .edges = edges,
                                   .growth = 0.24,
                                   .corner_edge = std::min(0.021, 3.0 / edges),
                                   .rim_edge = 0.12,
                                   .longest_edge = 0.12,
                                   .inner_end = 0.95,
                                   .outer_end = 1.3});
  for (Point &x : upper.points)
    x[1] += centre;
  std::vector<int> cells(upper.cells.size());
  std::iota(cells.begin(), cells.end(), 0);
  upper.region = {{"upper", cells}};
  auto contact = upper.boundary.extract("contact");
  contact.key() = "slave";
  upper.boundary.insert(std::move(contact));
  return two_bodies(upper);
}

} // namespace rbvi
