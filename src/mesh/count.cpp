// How many nodes a mesh will have, before it is refined.
#include "rbvi/mesh/serial.hpp"

#include <algorithm>
#include <bit>

namespace rbvi {

namespace {

/// Different sets of vertices among the edges (size 2) or triangles (size 3) of the cells.
template <std::size_t size> std::int64_t count_parts(const SerialMesh &mesh) {
  std::vector<std::array<int, size>> parts;
  const int corners = mesh.dim + 1;
  for (const auto &cell : mesh.cells)
    for (unsigned mask = 0; mask < 1U << corners; ++mask) {
      if (std::popcount(mask) != size) continue;
      std::array<int, size> part{};
      for (std::size_t i = 0, at = 0; i < static_cast<std::size_t>(corners); ++i)
        if ((mask >> i & 1U) != 0) part[at++] = cell[i];
      std::sort(part.begin(), part.end());
      parts.push_back(part);
    }
  std::sort(parts.begin(), parts.end());
  return std::unique(parts.begin(), parts.end()) - parts.begin();
}

} // namespace

std::int64_t nodes_when_refined(const SerialMesh &mesh, int times, int degree) {
  std::int64_t vertices = std::ssize(mesh.points), edges = count_parts<2>(mesh),
               cells = std::ssize(mesh.cells), triangles = mesh.dim == 2 ? 0 : count_parts<3>(mesh);
  for (int level = 0; level < times; ++level) {
    vertices += edges;
    if (mesh.dim == 2) {
      edges = 2 * edges + 3 * cells;
      cells *= 4;
    } else {
      edges = 2 * edges + 3 * triangles + cells;
      triangles = 4 * triangles + 8 * cells;
      cells *= 8;
    }
  }
  return degree == 2 ? vertices + edges : vertices;
}

} // namespace rbvi
