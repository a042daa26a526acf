#include "quarter_disc.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>
#include <numbers>

namespace rbvi {

namespace {

/// With the image by x -> -x; the nodes of the axis are shared.
SerialMesh mirrored(const SerialMesh &right) {
  SerialMesh mesh = right;
  std::vector<int> images;
  for (int v = 0; v < static_cast<int>(right.points.size()); ++v) {
    const Point &x = right.points[v];
    images.push_back(x[0] == 0 ? v : static_cast<int>(mesh.points.size()));
    if (x[0] != 0) mesh.points.push_back({-x[0], x[1], 0});
  }
  const auto image = [&](int v) { return images[v]; };
  for (const auto &cell : right.cells)
    mesh.cells.push_back({image(cell[0]), image(cell[2]), image(cell[1]), -1});
  for (const int cell : right.region.at("core"))
    mesh.region["core"].push_back(static_cast<int>(right.cells.size()) + cell);
  for (const auto &[name, facets] : right.boundary)
    for (const auto &facet : facets)
      mesh.boundary[name].push_back({image(facet[1]), image(facet[0]), -1});
  return mesh;
}

void check_edges(int edges) {
  if (edges < 8 || edges % 2 != 0)
    throw bad_input("the mesh of the half disc cannot have " + std::to_string(edges) +
                    " contact edges: their number must be even and at least 8");
}

} // namespace

SerialMesh half_disc(int edges) {
  check_edges(edges);
  // With these values 100 contact edges give 787 nodes and 5950 dofs of degree 2.
  SerialMesh right = quarter_disc({.contact_angle = std::numbers::pi / 8,
                                   .edges = edges / 2,
                                   .growth = 0.2255,
                                   .corner_edge = std::min(0.021, 6.0 / edges),
                                   .rim_edge = 0.06,
                                   .longest_edge = 0.135,
                                   .inner_end = 0.61,
                                   .outer_end = 0.88});
  right.boundary.erase("axis");
  return mirrored(right);
}

SerialMesh wide_half_disc(int edges) {
  check_edges(edges);
  SerialMesh right = quarter_disc({.contact_angle = std::numbers::pi / 4,
                                   .edges = edges / 2,
                                   .growth = 0.2255,
                                   .corner_edge = std::min(0.021, 12.0 / edges),
                                   .rim_edge = 0.06,
                                   .longest_edge = 0.135,
                                   .inner_end = 0.95,
                                   .outer_end = 1.3});
  right.boundary.erase("axis");
  return mirrored(right);
}

} // namespace rbvi
