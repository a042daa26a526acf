#include "rbvi/mesh/mesh.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/mesh/serial.hpp"
#include "rbvi/par/collective.hpp"

#include <petscdmplex.h>
#include <petscsf.h>

#include <numeric>
#include <string_view>

namespace rbvi {

namespace {

struct Communicator {
  MPI_Comm comm;
  int rank = 0, size = 1;
  explicit Communicator(MPI_Comm c) : comm(c) {
    MPI_Comm_rank(comm, &rank);
    MPI_Comm_size(comm, &size);
  }
};

/// Owns a star forest that PETSc created for us.
struct StarForest {
  PetscSF sf = nullptr;
  StarForest() = default;
  StarForest(const StarForest &) = delete;
  StarForest &operator=(const StarForest &) = delete;
  ~StarForest() { (void)PetscSFDestroy(&sf); }
};

struct Generator {
  std::string_view name;
  SerialMesh (*make)();
};

constexpr std::array generators{Generator{"square_with_disc", square_with_disc},
                                Generator{"two_quarter_discs", two_quarter_discs},
                                Generator{"two_blocks", two_blocks}};

/// Throws bad_input if this build does not have the scene's generator.
SerialMesh generated_mesh(const Scene &scene) {
  std::string names;
  for (const auto &[name, make] : generators) {
    if (name == scene.mesh.generator) return make();
    names.append(names.empty() ? "" : ", ").append(name);
  }
  throw bad_input("scene " + scene.name + " asks for the mesh generator '" + scene.mesh.generator +
                  "': this build has " + names);
}

SerialMesh undistributed_mesh(const Scene &scene, const MeshOptions &options) {
  if (options.refine < 0) throw bad_input("the number of mesh refinements is negative");
  SerialMesh mesh = options.file.empty() ? generated_mesh(scene) : read_gmsh(options.file, scene);
  const std::string source =
      options.file.empty() ? "the built-in mesh" : "mesh file '" + options.file + "'";
  check_mesh(mesh, source);
  for (int level = 1; level <= options.refine; ++level) {
    mesh = refined(mesh);
    snap_curves(mesh, scene);
    check_mesh(mesh, source + ", refined " + std::to_string(level) + " times");
  }
  return mesh;
}

/// Tells the shell partitioner which cells go where; only the first rank has any.
void prescribe_partition(DM dm, const std::vector<int> &part, int parts) {
  std::vector<PetscInt> sizes(static_cast<std::size_t>(parts), 0), order(part.size());
  for (const int p : part)
    ++sizes[static_cast<std::size_t>(p)];
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](PetscInt x, PetscInt y) {
    return part[static_cast<std::size_t>(x)] < part[static_cast<std::size_t>(y)];
  });
  PetscPartitioner partitioner = nullptr;
  RBVI_CALL(DMPlexGetPartitioner(dm, &partitioner));
  RBVI_CALL(PetscPartitionerSetType(partitioner, PETSCPARTITIONERSHELL));
  RBVI_CALL(PetscPartitionerShellSetPartition(partitioner, parts, sizes.data(), order.data()));
}

/// Distributes `dm` in place. Returns, for each local point, its point in the undistributed DM.
std::vector<PetscInt> distribute(Handle<DM> &dm, const std::vector<int> &part, int parts) {
  PetscInt begin = 0, end = 0;
  RBVI_CALL(DMPlexGetChart(dm.get(), &begin, &end));
  std::vector<PetscInt> original(static_cast<std::size_t>(end));
  std::iota(original.begin(), original.end(), 0);
  if (parts == 1) return original;

  prescribe_partition(dm.get(), part, parts);
  StarForest migration;
  Handle<DM> local;
  RBVI_CALL(DMPlexDistribute(dm.get(), 0, &migration.sf, local.put()));
  RBVI_CALL(DMPlexGetChart(local.get(), &begin, &end));
  std::vector<PetscInt> arrived(static_cast<std::size_t>(end), -1);
  RBVI_CALL(
      PetscSFBcastBegin(migration.sf, MPIU_INT, original.data(), arrived.data(), MPI_REPLACE));
  RBVI_CALL(PetscSFBcastEnd(migration.sf, MPIU_INT, original.data(), arrived.data(), MPI_REPLACE));
  dm = std::move(local);
  return arrived;
}

/// Points with the label among begin .. end-1.
std::vector<bool> marks(DM dm, const std::string &name, PetscInt begin, PetscInt end) {
  std::vector<bool> marked;
  DMLabel label = nullptr;
  RBVI_CALL(DMGetLabel(dm, name.c_str(), &label));
  for (PetscInt point = begin; point < end; ++point) {
    PetscInt value = -1;
    RBVI_CALL(DMLabelGetValue(label, point, &value));
    marked.push_back(value == 1);
  }
  return marked;
}

void fill_vertices(Mesh &mesh, const std::vector<PetscInt> &original, PetscInt begin,
                   PetscInt end) {
  mesh.points = vertex_points(mesh.dm.get());
  for (PetscInt vertex = begin; vertex < end; ++vertex) {
    mesh.dm_vertex.push_back(vertex);
    mesh.natural_vertex.push_back(original[static_cast<std::size_t>(vertex)] - mesh.total_cells);
  }
  mesh.owned_vertex.assign(mesh.points.size(), true);
  PetscSF shared = nullptr;
  PetscInt leaves = 0;
  const PetscInt *leaf = nullptr;
  RBVI_CALL(DMGetPointSF(mesh.dm.get(), &shared));
  RBVI_CALL(PetscSFGetGraph(shared, nullptr, &leaves, &leaf, nullptr));
  for (PetscInt i = 0; i < leaves; ++i) {
    const PetscInt point = leaf != nullptr ? leaf[i] : i;
    if (point >= begin && point < end)
      mesh.owned_vertex[static_cast<std::size_t>(point - begin)] = false;
  }
}

void fill_cells(Mesh &mesh, const std::vector<PetscInt> &original, PetscInt first_vertex) {
  PetscInt begin = 0, end = 0;
  RBVI_CALL(DMPlexGetHeightStratum(mesh.dm.get(), 0, &begin, &end));
  for (PetscInt cell = begin; cell < end; ++cell) {
    const auto vertices = vertices_of(mesh.dm.get(), cell);
    std::array<int, 4> local{-1, -1, -1, -1};
    for (std::size_t i = 0; i <= static_cast<std::size_t>(mesh.dim); ++i)
      local[i] = static_cast<int>(vertices[i] - first_vertex);
    mesh.cells.push_back(local);
    mesh.natural_cell.push_back(original[static_cast<std::size_t>(cell)]);
  }
  orient_cells(mesh.dim, mesh.points, mesh.cells);
}

} // namespace

Mesh make_mesh(MPI_Comm comm, const Scene &scene, const MeshOptions &options) {
  const Communicator world(comm);
  SerialMesh serial;
  serial.dim = scene.dim;
  std::vector<int> part;
  std::string fingerprint(16, '0');
  collectively(comm, [&] {
    if (world.rank != 0) return;
    serial = undistributed_mesh(scene, options);
    part = partition_cells(serial, world.size);
    fingerprint = fingerprint_of(serial);
  });

  Mesh mesh;
  mesh.comm = comm;
  mesh.dim = scene.dim;
  std::array<PetscInt, 2> totals{static_cast<PetscInt>(serial.points.size()),
                                 static_cast<PetscInt>(serial.cells.size())};
  MPI_Bcast(totals.data(), 2, MPIU_INT, 0, comm);
  MPI_Bcast(fingerprint.data(), 16, MPI_CHAR, 0, comm);
  mesh.total_vertices = totals[0];
  mesh.total_cells = totals[1];
  mesh.fingerprint = fingerprint;

  mesh.dm = make_plex(comm, serial, scene.mesh);
  const std::vector<PetscInt> original = distribute(mesh.dm, part, world.size);
  PetscInt begin = 0, end = 0;
  RBVI_CALL(DMPlexGetDepthStratum(mesh.dm.get(), 0, &begin, &end));
  fill_vertices(mesh, original, begin, end);
  fill_cells(mesh, original, begin);
  const auto cells = static_cast<PetscInt>(mesh.cells.size());
  for (const std::string &name : scene.mesh.regions)
    mesh.region[name] = marks(mesh.dm.get(), name, 0, cells);
  for (const std::string &name : scene.mesh.boundaries)
    mesh.boundary[name] = marks(mesh.dm.get(), name, begin, end);
  return mesh;
}

} // namespace rbvi
