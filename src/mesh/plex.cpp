#include "rbvi/core/error.hpp"
#include "rbvi/element/geometry.hpp"
#include "rbvi/mesh/serial.hpp"

#include <metis.h>
#include <petscdmplex.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <span>

namespace rbvi {

namespace {

void label_facets(DM dm, DMLabel label, const SerialMesh &mesh,
                  std::span<const std::array<int, 3>> facets) {
  const auto first = static_cast<PetscInt>(mesh.cells.size());
  for (const auto &facet : facets) {
    const std::array<PetscInt, 3> vertices{first + facet[0], first + facet[1], first + facet[2]};
    PetscInt count = 0, point = -1;
    const PetscInt *found = nullptr;
    RBVI_CALL(DMPlexGetFullJoin(dm, mesh.dim, vertices.data(), &count, &found));
    if (count == 1) point = found[0];
    RBVI_CALL(DMPlexRestoreJoin(dm, mesh.dim, vertices.data(), &count, &found));
    if (point < 0) throw failure("a boundary facet is not a facet of any cell of the mesh");
    RBVI_CALL(DMLabelSetValue(label, point, 1));
  }
}

/// Local points of one height that carry a label, none where there is no such label.
std::vector<PetscInt> labelled_points(DM dm, const std::string &name, PetscInt height) {
  DMLabel label = nullptr;
  RBVI_CALL(DMGetLabel(dm, name.c_str(), &label));
  if (label == nullptr) return {};
  PetscInt begin = 0, end = 0, count = 0;
  RBVI_CALL(DMPlexGetHeightStratum(dm, height, &begin, &end));
  Handle<IS> marked; // null where there is none
  RBVI_CALL(DMLabelGetStratumIS(label, 1, marked.put()));
  if (!marked) return {};
  const PetscInt *point = nullptr;
  RBVI_CALL(ISGetLocalSize(marked.get(), &count));
  RBVI_CALL(ISGetIndices(marked.get(), &point));
  std::vector<PetscInt> points;
  std::copy_if(point, point + count, std::back_inserter(points),
               [&](PetscInt p) { return begin <= p && p < end; });
  RBVI_CALL(ISRestoreIndices(marked.get(), &point));
  std::sort(points.begin(), points.end());
  return points;
}

struct MetisFree {
  void operator()(idx_t *array) const { (void)METIS_Free(array); }
};
using MetisArray = std::unique_ptr<idx_t, MetisFree>;

} // namespace

Handle<DM> make_plex(MPI_Comm comm, const SerialMesh &mesh, bool interpolated) {
  const auto dim = static_cast<std::size_t>(mesh.dim);
  std::vector<PetscInt> cells;
  for (const auto &cell : mesh.cells)
    cells.insert(cells.end(), cell.begin(), cell.begin() + mesh.dim + 1);
  std::vector<PetscReal> coordinates;
  for (const Point &x : mesh.points)
    coordinates.insert(coordinates.end(), x.begin(), x.begin() + mesh.dim);
  Handle<DM> dm;
  RBVI_CALL(DMPlexCreateFromCellListPetsc(comm, mesh.dim, static_cast<PetscInt>(mesh.cells.size()),
                                          static_cast<PetscInt>(mesh.points.size()),
                                          static_cast<PetscInt>(dim + 1),
                                          interpolated ? PETSC_TRUE : PETSC_FALSE, cells.data(),
                                          mesh.dim, coordinates.data(), dm.put()));
  return dm;
}

std::vector<Point> vertex_points(DM dm) {
  PetscInt dim = 0, begin = 0, end = 0;
  Vec coordinates = nullptr;
  PetscSection section = nullptr;
  RBVI_CALL(DMGetCoordinateDim(dm, &dim));
  RBVI_CALL(DMPlexGetDepthStratum(dm, 0, &begin, &end));
  RBVI_CALL(DMGetCoordinatesLocal(dm, &coordinates));
  RBVI_CALL(DMGetCoordinateSection(dm, &section));
  std::vector<Point> points(end - begin, Point{});
  const PetscScalar *values = nullptr;
  RBVI_CALL(VecGetArrayRead(coordinates, &values));
  for (PetscInt vertex = begin; vertex < end; ++vertex) {
    PetscInt offset = 0;
    RBVI_CALL(PetscSectionGetOffset(section, vertex, &offset));
    std::copy_n(values + offset, dim, points[vertex - begin].begin());
  }
  RBVI_CALL(VecRestoreArrayRead(coordinates, &values));
  return points;
}

std::array<PetscInt, 4> vertices_of(DM dm, PetscInt point) {
  PetscInt begin = 0, end = 0, size = 0;
  PetscInt *closure = nullptr;
  RBVI_CALL(DMPlexGetDepthStratum(dm, 0, &begin, &end));
  RBVI_CALL(DMPlexGetTransitiveClosure(dm, point, PETSC_TRUE, &size, &closure));
  std::array<PetscInt, 4> vertices{-1, -1, -1, -1};
  std::size_t count = 0;
  for (PetscInt k = 0; k < size && count < vertices.size(); ++k)
    if (closure[2 * k] >= begin && closure[2 * k] < end) vertices[count++] = closure[2 * k];
  RBVI_CALL(DMPlexRestoreTransitiveClosure(dm, point, PETSC_TRUE, &size, &closure));
  return vertices;
}

void orient_cells(int dim, const std::vector<Point> &points,
                  std::vector<std::array<int, 4>> &cells) {
  for (auto &cell : cells) {
    std::array<Point, 4> vertices{};
    for (int i = 0; i <= dim; ++i)
      vertices[i] = points[cell[i]];
    if (simplex(dim, vertices).volume < 0)
      std::swap(cell[static_cast<std::size_t>(dim) - 1], cell[dim]);
  }
}

namespace {

/// How labels begin: a region and a boundary may have one name.
const std::string of_region = "region ", of_boundary = "boundary ";

/// With a label of value 1 for each region (cells) and boundary (facets and their closure).
Handle<DM> labelled_plex(const SerialMesh &mesh) {
  Handle<DM> dm = make_plex(PETSC_COMM_SELF, mesh, true);
  DMLabel label = nullptr;
  const auto create = [&](const std::string &name) {
    RBVI_CALL(DMCreateLabel(dm.get(), name.c_str()));
    RBVI_CALL(DMGetLabel(dm.get(), name.c_str(), &label));
  };
  for (const auto &[name, cells] : mesh.region) {
    create(of_region + name);
    for (const int cell : cells)
      RBVI_CALL(DMLabelSetValue(label, cell, 1));
  }
  for (const auto &[name, facets] : mesh.boundary) {
    create(of_boundary + name);
    label_facets(dm.get(), label, mesh, facets);
    RBVI_CALL(DMPlexLabelComplete(dm.get(), label));
  }
  return dm;
}

/// The way back, with the labels that `like` has names for.
SerialMesh from_plex(DM dm, const SerialMesh &like) {
  PetscInt dim = 0, first_cell = 0, last_cell = 0, first_vertex = 0, last_vertex = 0;
  RBVI_CALL(DMGetDimension(dm, &dim));
  RBVI_CALL(DMPlexGetHeightStratum(dm, 0, &first_cell, &last_cell));
  RBVI_CALL(DMPlexGetDepthStratum(dm, 0, &first_vertex, &last_vertex));
  SerialMesh mesh;
  mesh.dim = static_cast<int>(dim);
  mesh.points = vertex_points(dm);
  for (PetscInt cell = first_cell; cell < last_cell; ++cell) {
    const auto vertices = vertices_of(dm, cell);
    std::array<int, 4> numbers{-1, -1, -1, -1};
    for (int i = 0; i <= dim; ++i)
      numbers[i] = static_cast<int>(vertices[i] - first_vertex);
    mesh.cells.push_back(numbers);
  }
  orient_cells(mesh.dim, mesh.points, mesh.cells);
  for (const auto &[name, cells] : like.region)
    for (const PetscInt cell : labelled_points(dm, of_region + name, 0))
      mesh.region[name].push_back(static_cast<int>(cell - first_cell));
  for (const auto &[name, facets] : like.boundary)
    for (const PetscInt facet : labelled_points(dm, of_boundary + name, 1)) {
      const auto vertices = vertices_of(dm, facet);
      std::array<int, 3> numbers{-1, -1, -1};
      for (int i = 0; i < dim; ++i)
        numbers[i] = static_cast<int>(vertices[i] - first_vertex);
      mesh.boundary[name].push_back(numbers);
    }
  return mesh;
}

} // namespace

SerialMesh refined(const SerialMesh &mesh) {
  const Handle<DM> coarse = labelled_plex(mesh);
  Handle<DM> fine;
  RBVI_CALL(DMPlexSetRefinementUniform(coarse.get(), PETSC_TRUE));
  RBVI_CALL(DMRefine(coarse.get(), PETSC_COMM_SELF, fine.put()));
  return from_plex(fine.get(), mesh);
}

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
