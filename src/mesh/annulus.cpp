#include "rings.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rbvi {

namespace {

constexpr double hub = 0.3, coarsest = 0.12, growth = 0.25;
constexpr double quarter = std::numbers::pi / 2;

/// Edges of a quarter of the circle of radius r, about `size` long each.
int edges_of(double r, double size) {
  return std::max(3, static_cast<int>(std::lround(quarter * r / size)));
}

/// A circle from the polar angle pi / 4 on: the arcs about (0, 1) and (0, -1) of `contact` edges
/// each, the two sides between them of `side` edges.
Ring add_circle(SerialMesh &mesh, double r, int contact, int side) {
  Ring ring;
  for (int part = 0; part < 4; ++part) {
    const int count = part % 2 == 0 ? contact : side;
    for (int i = 0; i < count; ++i) {
      const double angle = quarter * (0.5 + part + static_cast<double>(i) / count);
      ring.push_back(static_cast<int>(mesh.points.size()));
      mesh.points.push_back({r * std::cos(angle), r * std::sin(angle), 0});
    }
  }
  ring.push_back(ring.front());
  return ring;
}

} // namespace

SerialMesh annulus(int edges) {
  if (edges < 8)
    throw bad_input("an annulus needs at least 8 edges on each contact arc, not " +
                    std::to_string(edges));
  SerialMesh mesh;
  double size = quarter / edges, r = 1;
  const int side = edges_of(1, std::max(size, coarsest / 2));
  Ring outer = add_circle(mesh, r, edges, side);
  add_facets(mesh, "rim", outer);
  const auto arc = [&](int first) {
    return Ring(outer.begin() + first, outer.begin() + first + edges + 1);
  };
  add_facets(mesh, "top", arc(0));
  add_facets(mesh, "bottom", arc(edges + side));
  while (r > hub) {
    // The last ring is the hub's: what is left is not less than half a layer.
    r = r - 1.5 * size < hub ? hub : r - size;
    size = std::min(coarsest, (1 + growth) * size);
    const Ring inner =
        add_circle(mesh, r, edges_of(r, size), edges_of(r, std::max(size, coarsest / 2)));
    zip(mesh, inner, outer);
    outer = inner;
  }
  add_facets(mesh, "hub", outer);
  return mesh;
}

} // namespace rbvi
