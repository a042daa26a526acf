#include "rings.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// [0, 1] x [low, low + 1/2] in `across` times `up` quadrilaterals of two triangles each.
struct Block {
  std::string region; ///< "" for none
  std::string low_side, high_side;
  double low;
  int across, up;
  bool mirrored = false; ///< about x = 1/2; `across` is even
};

/// Node (i, j) of the grid, moved by at most a fifth of the spacing so that the mesh has no
/// symmetry but the one that is asked for; nodes of a side, and of the mirror, stay on it.
Point node(const Block &block, int i, int j) {
  constexpr double amplitude = 0.2;
  if (block.mirrored && 2 * i > block.across) {
    const Point image = node(block, block.across - i, j);
    return {1 - image[0], image[1], 0};
  }
  const bool on_mirror = block.mirrored && 2 * i == block.across;
  const bool on_side = i == 0 || i == block.across || on_mirror;
  const bool on_end = j == 0 || j == block.up;
  const double x = on_side ? i : i + amplitude * std::sin(5.0 * i + 3.0 * j + block.low);
  const double y = on_end ? j : j + amplitude * std::sin(2.0 * i + 7.0 * j - block.low);
  return {x / block.across, block.low + 0.5 * y / block.up, 0};
}

Ring add_row(SerialMesh &mesh, const Block &block, int j) {
  Ring row;
  for (int i = 0; i <= block.across; ++i) {
    row.push_back(static_cast<int>(mesh.points.size()));
    mesh.points.push_back(node(block, i, j));
  }
  return row;
}

double length(const SerialMesh &mesh, int a, int b) {
  const Point &x = mesh.points[a];
  const Point &y = mesh.points[b];
  return std::hypot(x[0] - y[0], x[1] - y[1]);
}

/// Splits each quadrilateral between two rows along its shorter diagonal.
void add_cells(SerialMesh &mesh, const Ring &row, const Ring &next) {
  for (std::size_t i = 0; i + 1 < row.size(); ++i) {
    const int a = row[i], b = row[i + 1], c = next[i + 1], d = next[i];
    const bool rising = length(mesh, a, c) < length(mesh, b, d);
    mesh.cells.push_back(rising ? std::array{a, b, c, -1} : std::array{a, b, d, -1});
    mesh.cells.push_back(rising ? std::array{a, c, d, -1} : std::array{b, c, d, -1});
  }
}

void add_block(SerialMesh &mesh, const Block &block) {
  const std::size_t first = mesh.cells.size();
  Ring row = add_row(mesh, block, 0);
  add_facets(mesh, block.low_side, row);
  for (int j = 1; j <= block.up; ++j) {
    const Ring next = add_row(mesh, block, j);
    add_cells(mesh, row, next);
    add_facets(mesh, "sides", {next.front(), row.front()});
    add_facets(mesh, "sides", {row.back(), next.back()});
    row = next;
  }
  add_facets(mesh, block.high_side, row);
  if (block.region.empty()) return;
  for (std::size_t cell = first; cell < mesh.cells.size(); ++cell)
    mesh.region[block.region].push_back(static_cast<int>(cell));
}

} // namespace

SerialMesh two_blocks() {
  SerialMesh mesh;
  add_block(mesh, {"upper", "slave", "top", 0.25, 10, 5});
  add_block(mesh, {"lower", "bottom", "master", -0.75, 7, 4});
  return mesh;
}

SerialMesh one_block() {
  SerialMesh mesh;
  add_block(mesh, {"", "contact", "top", 0, 8, 5, true});
  return mesh;
}

} // namespace rbvi
