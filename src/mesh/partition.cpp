#include "rbvi/mesh/serial.hpp"

#include "rbvi/core/error.hpp"

#include <metis.h>

#include <memory>

namespace rbvi {

namespace {

struct MetisFree {
  void operator()(idx_t *array) const { (void)METIS_Free(array); }
};
using MetisArray = std::unique_ptr<idx_t, MetisFree>;

} // namespace

std::vector<int> partition_cells(const SerialMesh &mesh, int parts) {
  if (mesh.cells.size() < static_cast<std::size_t>(parts))
    throw bad_input("the mesh has " + std::to_string(mesh.cells.size()) + " cells for " +
                    std::to_string(parts) + " ranks: refine it or use fewer ranks");
  auto cells = static_cast<idx_t>(mesh.cells.size());
  std::vector<idx_t> part(mesh.cells.size(), 0);
  if (parts == 1) return part;

  std::vector<idx_t> start{0}, vertices;
  for (const auto &cell : mesh.cells) {
    vertices.insert(vertices.end(), cell.begin(), cell.begin() + mesh.dim + 1);
    start.push_back(static_cast<idx_t>(vertices.size()));
  }
  auto points = static_cast<idx_t>(mesh.points.size());
  idx_t common = mesh.dim, from_zero = 0;
  idx_t *offsets = nullptr, *neighbours = nullptr;
  const int graph = METIS_MeshToDual(&cells, &points, start.data(), vertices.data(), &common,
                                     &from_zero, &offsets, &neighbours);
  const MetisArray own_offsets(offsets), own_neighbours(neighbours);
  if (graph != METIS_OK) throw failure("METIS could not build the graph of the cells");

  std::array<idx_t, METIS_NOPTIONS> options{};
  METIS_SetDefaultOptions(options.data());
  options[METIS_OPTION_SEED] = 1;
  idx_t constraints = 1, wanted = parts, cut = 0;
  const int status =
      METIS_PartGraphRecursive(&cells, &constraints, offsets, neighbours, nullptr, nullptr, nullptr,
                               &wanted, nullptr, nullptr, options.data(), &cut, part.data());
  if (status != METIS_OK)
    throw failure("METIS could not split the mesh into " + std::to_string(parts) + " parts");
  return part;
}

} // namespace rbvi
