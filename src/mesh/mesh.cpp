#include "rbvi/mesh/mesh.hpp"

#include "axis.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/facets.hpp"
#include "rbvi/mesh/contact_curves.hpp"
#include "rbvi/mesh/serial.hpp"
#include "rbvi/par/collective.hpp"

#include <petscdmplex.h>
#include <petscsf.h>

#include <algorithm>
#include <numeric>
#include <unordered_map>

namespace rbvi {

namespace {

struct Communicator {
  MPI_Comm comm;
  int rank = rank_of(comm), size = ranks_of(comm);
  explicit Communicator(MPI_Comm c) : comm(c) {}
};

/// Owns a star forest that PETSc created for us.
struct StarForest {
  PetscSF sf = nullptr;
  StarForest() = default;
  StarForest(const StarForest &) = delete;
  StarForest &operator=(const StarForest &) = delete;
  ~StarForest() { (void)PetscSFDestroy(&sf); }
};

/// Tells the shell partitioner which cells go where; only the first rank has any.
void prescribe_partition(DM dm, const std::vector<int> &part, int parts) {
  std::vector<PetscInt> sizes(parts, 0), order(part.size());
  for (const int p : part)
    ++sizes[p];
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](PetscInt x, PetscInt y) { return part[x] < part[y]; });
  PetscPartitioner partitioner = nullptr;
  RBVI_CALL(DMPlexGetPartitioner(dm, &partitioner));
  RBVI_CALL(PetscPartitionerSetType(partitioner, PETSCPARTITIONERSHELL));
  RBVI_CALL(PetscPartitionerShellSetPartition(partitioner, parts, sizes.data(), order.data()));
}

/// What the first rank knows of every point of the undistributed DM, at the points of each rank.
class Migration {
public:
  /// Distributes `dm` in place.
  Migration(Handle<DM> &dm, const std::vector<int> &part, int parts) : distributed_(parts > 1) {
    if (distributed_) {
      prescribe_partition(dm.get(), part, parts);
      Handle<DM> local;
      RBVI_CALL(DMPlexDistribute(dm.get(), 0, &forest_.sf, local.put()));
      dm = std::move(local);
    }
    PetscInt end = 0;
    RBVI_CALL(DMPlexGetChart(dm.get(), nullptr, &end));
    points_ = static_cast<std::size_t>(end);
  }
  /// `type`: MPI's of Value.
  template <class Value>
  std::vector<Value> arrived(const std::vector<Value> &values, MPI_Datatype type) const {
    if (!distributed_) return values;
    std::vector<Value> here(points_);
    RBVI_CALL(PetscSFBcastBegin(forest_.sf, type, values.data(), here.data(), MPI_REPLACE));
    RBVI_CALL(PetscSFBcastEnd(forest_.sf, type, values.data(), here.data(), MPI_REPLACE));
    return here;
  }

private:
  bool distributed_;
  StarForest forest_;
  std::size_t points_ = 0;
};

/// Edges of the undistributed mesh: its points begin .. end - 1.
struct EdgePoints {
  PetscInt begin = 0, end = 0;
};

EdgePoints edges_of(DM dm, MPI_Comm comm) {
  std::array<PetscInt, 2> range{};
  RBVI_CALL(DMPlexGetDepthStratum(dm, 1, &range[0], &range[1]));
  MPI_Bcast(range.data(), 2, MPIU_INT, 0, comm);
  return {range[0], range[1]};
}

/// Both ends of a local edge, local vertices.
std::array<PetscInt, 2> ends_of(DM dm, PetscInt edge, PetscInt first_vertex) {
  const PetscInt *cone = nullptr;
  RBVI_CALL(DMPlexGetCone(dm, edge, &cone));
  return {cone[0] - first_vertex, cone[1] - first_vertex};
}

void fill_vertices(Mesh &mesh, const std::vector<PetscInt> &original, PetscInt begin,
                   PetscInt end) {
  mesh.points = vertex_points(mesh.dm.get());
  for (PetscInt vertex = begin; vertex < end; ++vertex) {
    mesh.dm_point.push_back(vertex);
    mesh.natural_node.push_back(original[vertex] - mesh.total_cells);
  }
}

/// The middles of the local edges, behind the vertices.
void fill_middles(Mesh &mesh, const std::vector<PetscInt> &original, const EdgePoints &edges,
                  PetscInt first_vertex) {
  PetscInt begin = 0, end = 0;
  RBVI_CALL(DMPlexGetDepthStratum(mesh.dm.get(), 1, &begin, &end));
  for (PetscInt edge = begin; edge < end; ++edge) {
    const auto [i, j] = ends_of(mesh.dm.get(), edge, first_vertex);
    mesh.points.push_back((mesh.points[i] + mesh.points[j]) / 2);
    mesh.dm_point.push_back(edge);
    mesh.natural_node.push_back(mesh.total_vertices + original[edge] - edges.begin);
  }
}

/// Per local DMPlex point: whether another rank owns it.
std::vector<bool> owned_elsewhere(const Mesh &mesh) {
  PetscSF shared = nullptr;
  PetscInt leaves = 0, chart = 0;
  const PetscInt *leaf = nullptr;
  RBVI_CALL(DMGetPointSF(mesh.dm.get(), &shared));
  RBVI_CALL(PetscSFGetGraph(shared, nullptr, &leaves, &leaf, nullptr));
  RBVI_CALL(DMPlexGetChart(mesh.dm.get(), nullptr, &chart));
  std::vector<bool> elsewhere(chart, false);
  for (PetscInt i = 0; i < leaves; ++i)
    elsewhere[leaf != nullptr ? leaf[i] : i] = true;
  return elsewhere;
}

/// Marks of the undistributed mesh at its `points`, the cells of a region.
std::vector<char> marked_cells(const SerialMesh &serial, const std::string &region,
                               std::size_t points) {
  std::vector<char> marks(points, 0);
  if (points == 0 || !serial.region.contains(region)) return marks;
  for (const int cell : serial.region.at(region))
    marks[cell] = 1;
  return marks;
}

/// The vertices of facets, and where the DM has them their edges.
std::vector<char> marked_nodes(DM dm, const SerialMesh &serial,
                               const std::vector<SerialFacet> &facets, std::size_t points) {
  std::vector<char> marks(points, 0);
  PetscInt depth = 0;
  RBVI_CALL(DMPlexGetDepth(dm, &depth));
  const auto first_vertex = static_cast<PetscInt>(serial.cells.size());
  const auto count = static_cast<std::size_t>(serial.dim);
  for (const SerialFacet &facet : facets)
    for (std::size_t i = 0; i < count; ++i) {
      const PetscInt vertex = first_vertex + facet.vertices[i];
      marks[vertex] = 1;
      for (std::size_t j = 0; depth > 1 && j < i; ++j) {
        const std::array<PetscInt, 2> ends{vertex, first_vertex + facet.vertices[j]};
        PetscInt edges = 0;
        const PetscInt *edge = nullptr;
        RBVI_CALL(DMPlexGetFullJoin(dm, 2, ends.data(), &edges, &edge));
        for (PetscInt k = 0; k < edges; ++k)
          marks[edge[k]] = 1;
        RBVI_CALL(DMPlexRestoreJoin(dm, 2, ends.data(), &edges, &edge));
      }
    }
  return marks;
}

/// Facets of the first rank, on every rank.
void share(MPI_Comm comm, std::vector<SerialFacet> &facets) {
  auto bytes = static_cast<int>(facets.size() * sizeof(SerialFacet));
  MPI_Bcast(&bytes, 1, MPI_INT, 0, comm);
  facets.resize(static_cast<std::size_t>(bytes) / sizeof(SerialFacet));
  MPI_Bcast(facets.data(), bytes, MPI_CHAR, 0, comm);
}

/// Those of this rank's cells; `cell_of`: by natural number.
std::vector<CellFacet> own_facets(const Mesh &mesh,
                                  const std::unordered_map<PetscInt, std::size_t> &cell_of,
                                  const std::vector<SerialFacet> &facets) {
  std::vector<CellFacet> result;
  for (const SerialFacet &whole : facets) {
    const auto found = cell_of.find(whole.cell);
    if (found == cell_of.end()) continue;
    const auto end = whole.vertices.begin() + mesh.dim;
    for (int facet = 0; facet <= mesh.dim; ++facet)
      if (std::ranges::all_of(facet_nodes(mesh.dim, 1, facet), [&](int i) {
            const int node = mesh.cells[found->second][i];
            const PetscInt vertex = mesh.natural_node[node];
            return std::find(whole.vertices.begin(), end, vertex) != end;
          }))
        result.push_back({found->second, facet});
  }
  return result;
}

void fill_cells(Mesh &mesh, const std::vector<PetscInt> &original, PetscInt first_vertex) {
  PetscInt begin = 0, end = 0;
  RBVI_CALL(DMPlexGetHeightStratum(mesh.dm.get(), 0, &begin, &end));
  for (PetscInt cell = begin; cell < end; ++cell) {
    const auto vertices = vertices_of(mesh.dm.get(), cell);
    std::array<int, 4> local{-1, -1, -1, -1};
    for (int i = 0; i <= mesh.dim; ++i)
      local[i] = static_cast<int>(vertices[i] - first_vertex);
    mesh.cells.push_back(local);
    mesh.natural_cell.push_back(original[cell]);
  }
  orient_cells(mesh.dim, mesh.points, mesh.cells);
}

/// Finds the edges of each cell by their two vertices.
void fill_cell_middles(Mesh &mesh, PetscInt first_vertex) {
  const auto vertices = static_cast<std::size_t>(
      std::count_if(mesh.natural_node.begin(), mesh.natural_node.end(),
                    [&](PetscInt number) { return number < mesh.total_vertices; }));
  std::map<std::array<PetscInt, 2>, int> middle;
  for (std::size_t node = vertices; node < mesh.points.size(); ++node) {
    auto ends = ends_of(mesh.dm.get(), mesh.dm_point[node], first_vertex);
    std::sort(ends.begin(), ends.end());
    middle[ends] = static_cast<int>(node);
  }
  for (const auto &cell : mesh.cells) {
    std::array<int, 6> middles{-1, -1, -1, -1, -1, -1};
    for (std::size_t e = 0; e < (mesh.dim == 2 ? 3U : 6U); ++e) {
      std::array<PetscInt, 2> ends{cell[simplex_edges[e][0]], cell[simplex_edges[e][1]]};
      std::sort(ends.begin(), ends.end());
      middles[e] = middle.at(ends);
    }
    mesh.cell_middles.push_back(middles);
  }
}

/// On the first rank: elsewhere there is nothing of it.
struct Undistributed {
  SerialMesh mesh;
  std::map<std::string, std::vector<SerialFacet>> facets; ///< of every boundary
  std::map<std::string, std::vector<CurvePiece>> curves;  ///< of those with contact, in 2D
  std::map<std::string, std::vector<PetscInt>> open_rims; ///< likewise, in 3D
  std::size_t points = 0;                                 ///< of its DM
  /// Per region and per boundary, which may have the name of a region, of them.
  std::map<std::string, std::vector<char>> in_region, on_boundary;
  std::vector<int> bodies; ///< of the cells, then 0
};

/// Fills in the points and their marks. `dm`: not distributed yet.
void mark(DM dm, const MeshRecipe &recipe, Undistributed &all) {
  PetscInt end = 0;
  RBVI_CALL(DMPlexGetChart(dm, nullptr, &end));
  all.points = static_cast<std::size_t>(end);
  all.bodies = bodies_of(all.mesh);
  all.bodies.resize(all.points);
  for (const std::string &name : recipe.regions)
    all.in_region[name] = marked_cells(all.mesh, name, all.points);
  for (const std::string &name : recipe.boundaries)
    all.on_boundary[name] = marked_nodes(dm, all.mesh, all.facets[name], all.points);
}

void fill_nodes_and_cells(Mesh &mesh, const Migration &migration, const EdgePoints &edges,
                          std::size_t points) {
  std::vector<PetscInt> all(points);
  std::iota(all.begin(), all.end(), 0);
  const std::vector<PetscInt> original = migration.arrived(all, MPIU_INT);
  PetscInt begin = 0, end = 0;
  RBVI_CALL(DMPlexGetDepthStratum(mesh.dm.get(), 0, &begin, &end));
  fill_vertices(mesh, original, begin, end);
  fill_cells(mesh, original, begin);
  mesh.total_nodes = mesh.total_vertices;
  if (mesh.degree == 2) {
    fill_middles(mesh, original, edges, begin);
    fill_cell_middles(mesh, begin);
    mesh.total_nodes += edges.end - edges.begin;
  }
  const std::vector<bool> elsewhere = owned_elsewhere(mesh);
  for (const PetscInt point : mesh.dm_point)
    mesh.owned_node.push_back(!elsewhere[point]);
}

std::vector<bool> own_region(const Mesh &mesh, const std::vector<char> &marks) {
  return {marks.begin(), marks.begin() + std::ssize(mesh.cells)}; // cells are the first points
}

void fill_bodies(Mesh &mesh, const Migration &migration, const std::vector<int> &all) {
  mesh.body = migration.arrived(all, MPI_INT);
  mesh.body.resize(mesh.cells.size()); // cells are the first points
  for (const int body : mesh.body)
    mesh.bodies = std::max(mesh.bodies, body + 1);
  MPI_Allreduce(MPI_IN_PLACE, &mesh.bodies, 1, MPI_INT, MPI_MAX, mesh.comm);
}

/// The pieces of the first rank, on every rank.
std::vector<CurvePiece> shared(MPI_Comm comm, std::vector<CurvePiece> pieces) {
  std::vector<PetscInt> packed;
  for (const auto &[vertices, loop, ends] : pieces) {
    packed.insert(packed.end(), {static_cast<PetscInt>(vertices.size()), loop, ends[0], ends[1]});
    packed.insert(packed.end(), vertices.begin(), vertices.end());
  }
  auto size = static_cast<int>(packed.size());
  MPI_Bcast(&size, 1, MPI_INT, 0, comm);
  packed.resize(static_cast<std::size_t>(size));
  MPI_Bcast(packed.data(), size, MPIU_INT, 0, comm);
  pieces.clear();
  for (auto at = packed.begin(); at != packed.end(); at += 4 + at[0])
    pieces.push_back({{at + 4, at + 4 + at[0]}, at[1] != 0, {at[2] != 0, at[3] != 0}});
  return pieces;
}

std::vector<bool> at_nodes(const Mesh &mesh, const std::vector<char> &marks) {
  std::vector<bool> result;
  for (const PetscInt point : mesh.dm_point)
    result.push_back(marks[point] != 0);
  return result;
}

} // namespace

Mesh make_mesh(MPI_Comm comm, const Scene &scene, const MeshOptions &options) {
  const Communicator world(comm);
  Undistributed all{.mesh = {.dim = scene.dim}};
  std::vector<SerialMesh> levels;
  std::vector<int> part;
  std::string fingerprint(16, '0');
  collectively(comm, [&] {
    if (world.rank != 0) return;
    all.mesh = undistributed_mesh(scene, options, levels);
    part = partition_cells(all.mesh, world.size);
    fingerprint = fingerprint_of(all.mesh);
    for (const std::string &name : scene.mesh.boundaries)
      if (all.mesh.boundary.contains(name)) all.facets[name] = facets_with_cells(all.mesh, name);
    for (const std::string &name : contact_boundaries(scene))
      if (scene.dim == 2)
        all.curves[name] = curve_pieces(all.mesh, name, "the mesh");
      else
        all.open_rims[name] = open_rim(all.mesh, name);
  });

  Mesh mesh;
  mesh.comm = comm;
  mesh.dim = scene.dim;
  mesh.degree = scene.degree;
  mesh.levels = options.levels ? options.levels
                               : std::make_shared<const std::vector<SerialMesh>>(std::move(levels));
  std::array<PetscInt, 2> totals{static_cast<PetscInt>(all.mesh.points.size()),
                                 static_cast<PetscInt>(all.mesh.cells.size())};
  MPI_Bcast(totals.data(), 2, MPIU_INT, 0, comm);
  MPI_Bcast(fingerprint.data(), 16, MPI_CHAR, 0, comm);
  mesh.total_vertices = totals[0];
  mesh.total_cells = totals[1];
  mesh.fingerprint = fingerprint;

  mesh.dm = make_plex(comm, all.mesh, mesh.degree == 2);
  mark(mesh.dm.get(), scene.mesh, all);
  const EdgePoints edges = mesh.degree == 2 ? edges_of(mesh.dm.get(), comm) : EdgePoints{};
  const Migration migration(mesh.dm, part, world.size);
  fill_nodes_and_cells(mesh, migration, edges, all.points);
  fill_bodies(mesh, migration, all.bodies);
  for (const std::string &name : contact_boundaries(scene)) {
    mesh.curves[name] = shared(comm, all.curves[name]);
    mesh.open_rims[name] = gather_all(comm, all.open_rims[name], MPIU_INT);
  }
  for (const std::string &name : scene.mesh.regions)
    mesh.region[name] = own_region(mesh, migration.arrived(all.in_region[name], MPI_CHAR));
  std::unordered_map<PetscInt, std::size_t> cell_of; // by natural number
  for (std::size_t cell = 0; cell < mesh.cells.size(); ++cell)
    cell_of.emplace(mesh.natural_cell[cell], cell);
  for (const std::string &name : scene.mesh.boundaries) {
    mesh.boundary[name] = at_nodes(mesh, migration.arrived(all.on_boundary[name], MPI_CHAR));
    share(comm, all.facets[name]);
    mesh.facets[name] = own_facets(mesh, cell_of, all.facets[name]);
  }
  if (scene.axisymmetric) mark_axis(mesh);
  return mesh;
}

PetscInt count_nodes(MPI_Comm comm, const Scene &scene, const MeshOptions &options) {
  PetscInt nodes = 0;
  collectively(comm, [&] {
    if (rank_of(comm) != 0) return;
    if (options.refine < 0) throw bad_input("the number of mesh refinements is negative");
    std::vector<SerialMesh> levels;
    const SerialMesh first = undistributed_mesh(scene, {options.file, 0}, levels);
    nodes = static_cast<PetscInt>(nodes_when_refined(first, options.refine, scene.degree));
  });
  MPI_Bcast(&nodes, 1, MPIU_INT, 0, comm);
  return nodes;
}

std::array<int, most_nodes> nodes_of(const Mesh &mesh, std::size_t cell) {
  std::array<int, most_nodes> nodes;
  nodes.fill(-1);
  const auto corners = static_cast<std::size_t>(mesh.dim) + 1;
  std::copy_n(mesh.cells[cell].begin(), corners, nodes.begin());
  if (mesh.degree == 2)
    std::copy_n(mesh.cell_middles[cell].begin(), corners * (corners - 1) / 2,
                nodes.begin() + static_cast<std::ptrdiff_t>(corners));
  return nodes;
}

} // namespace rbvi
