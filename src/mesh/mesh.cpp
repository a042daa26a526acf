#include "rbvi/mesh/mesh.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/element/facets.hpp"
#include "rbvi/mesh/serial.hpp"
#include "rbvi/par/collective.hpp"

#include <petscdmplex.h>
#include <petscsf.h>

#include <algorithm>
#include <numeric>
#include <string_view>

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

struct Generator {
  std::string_view name;
  SerialMesh (*make)(const MeshRecipe &);
  bool takes_edges = false;
};

constexpr std::array generators{
    Generator{"square_with_disc",
              [](const MeshRecipe &recipe) {
                return recipe.edges == 0 ? square_with_disc() : square_with_disc(recipe.edges);
              },
              true},
    Generator{"two_quarter_discs", [](const MeshRecipe &) { return two_quarter_discs(); }},
    Generator{"two_graded_quarter_discs",
              [](const MeshRecipe &recipe) { return two_graded_quarter_discs(recipe.edges); },
              true},
    Generator{"two_blocks", [](const MeshRecipe &) { return two_blocks(); }},
    Generator{"half_disc",
              [](const MeshRecipe &recipe) {
                return recipe.edges == 0 ? half_disc() : half_disc(recipe.edges);
              },
              true},
    Generator{"wide_half_disc",
              [](const MeshRecipe &recipe) {
                return recipe.edges == 0 ? wide_half_disc() : wide_half_disc(recipe.edges);
              },
              true},
    Generator{"one_block", [](const MeshRecipe &) { return one_block(); }},
    Generator{"annulus",
              [](const MeshRecipe &recipe) {
                return recipe.edges == 0 ? annulus() : annulus(recipe.edges);
              },
              true}};

/// Throws bad_input if a built-in mesh lacks a name of the scene's recipe.
void check_labels(const SerialMesh &mesh, const Scene &scene) {
  const std::string lacks =
      "the mesh generator '" + scene.mesh.generator + "' that scene " + scene.name + " asks for ";
  for (const std::string &name : scene.mesh.regions)
    if (!mesh.region.contains(name)) throw bad_input(lacks + "makes no region '" + name + "'");
  for (const std::string &name : scene.mesh.boundaries)
    if (!mesh.boundary.contains(name)) throw bad_input(lacks + "makes no boundary '" + name + "'");
}

/// Throws bad_input if this build does not have the scene's generator, or not with its edges.
SerialMesh generated_mesh(const Scene &scene) {
  std::string names;
  for (const Generator &generator : generators) {
    names.append(names.empty() ? "" : ", ").append(generator.name);
    if (generator.name != scene.mesh.generator) continue;
    if (scene.mesh.edges != 0 && !generator.takes_edges)
      throw bad_input("scene " + scene.name + " asks for " + std::to_string(scene.mesh.edges) +
                      " contact edges: the number of the mesh generator '" + scene.mesh.generator +
                      "' is fixed");
    SerialMesh mesh = generator.make(scene.mesh);
    check_labels(mesh, scene);
    return mesh;
  }
  throw bad_input("scene " + scene.name + " asks for the mesh generator '" + scene.mesh.generator +
                  "': this build has " + names);
}

/// The given mesh refined so many times; those on the way are left in `levels`.
SerialMesh refined_mesh(SerialMesh mesh, int times, const Scene &scene, const std::string &source,
                        std::vector<SerialMesh> &levels) {
  for (int level = 1; level <= times; ++level) {
    SerialMesh finer = refined(mesh);
    levels.push_back(std::move(mesh));
    mesh = std::move(finer);
    snap_curves(mesh, scene);
    const std::string name = source + ", refined " + std::to_string(level) + " times";
    check_volumes(mesh, name);
    check_places(mesh, scene, name);
  }
  return mesh;
}

/// Leaves in `levels` those that it was refined from, where they are not known.
SerialMesh undistributed_mesh(const Scene &scene, const MeshOptions &options,
                              std::vector<SerialMesh> &levels) {
  if (options.refine < 0) throw bad_input("the number of mesh refinements is negative");
  const std::string source =
      options.file.empty() ? "the built-in mesh" : "mesh file '" + options.file + "'";
  SerialMesh mesh;
  if (options.levels) {
    mesh = options.levels->at(static_cast<std::size_t>(options.refine));
  } else {
    mesh = options.file.empty() ? generated_mesh(scene) : read_gmsh(options.file, scene);
    check_mesh(mesh, source);
    check_facts(mesh, scene, source);
    mesh = refined_mesh(std::move(mesh), options.refine, scene, source, levels);
  }
  balance_inclusion(mesh, scene);
  check_volumes(mesh, source);
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
    mesh.natural_node.push_back(original[static_cast<std::size_t>(vertex)] - mesh.total_cells);
  }
}

/// The middles of the local edges, behind the vertices.
void fill_middles(Mesh &mesh, const std::vector<PetscInt> &original, const EdgePoints &edges,
                  PetscInt first_vertex) {
  PetscInt begin = 0, end = 0;
  RBVI_CALL(DMPlexGetDepthStratum(mesh.dm.get(), 1, &begin, &end));
  for (PetscInt edge = begin; edge < end; ++edge) {
    const auto [i, j] = ends_of(mesh.dm.get(), edge, first_vertex);
    const Point a = mesh.points[static_cast<std::size_t>(i)];
    const Point b = mesh.points[static_cast<std::size_t>(j)];
    mesh.points.push_back({(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2});
    mesh.dm_point.push_back(edge);
    mesh.natural_node.push_back(mesh.total_vertices + original[static_cast<std::size_t>(edge)] -
                                edges.begin);
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
  std::vector<bool> elsewhere(static_cast<std::size_t>(chart), false);
  for (PetscInt i = 0; i < leaves; ++i)
    elsewhere[static_cast<std::size_t>(leaf != nullptr ? leaf[i] : i)] = true;
  return elsewhere;
}

/// The facets of a boundary, by the vertices of each.
std::vector<CellFacet> boundary_facets(const Mesh &mesh, const std::string &name,
                                       const std::vector<bool> &elsewhere, PetscInt first_vertex) {
  std::vector<CellFacet> result;
  for (const PetscInt point : labelled_points(mesh.dm.get(), name, 1)) {
    const PetscInt *support = nullptr;
    RBVI_CALL(DMPlexGetSupport(mesh.dm.get(), point, &support));
    if (elsewhere[static_cast<std::size_t>(point)]) continue;
    const auto vertices = vertices_of(mesh.dm.get(), point);
    const auto end = vertices.begin() + mesh.dim;
    const auto cell = static_cast<std::size_t>(support[0]);
    for (int facet = 0; facet <= mesh.dim; ++facet) {
      const std::vector<int> nodes = facet_nodes(mesh.dim, 1, facet);
      if (std::all_of(nodes.begin(), nodes.end(), [&](int i) {
            const PetscInt vertex = mesh.cells[cell][static_cast<std::size_t>(i)] + first_vertex;
            return std::find(vertices.begin(), end, vertex) != end;
          }))
        result.push_back({cell, facet});
    }
  }
  return result;
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
  const std::size_t edges = mesh.dim == 2 ? 3 : 6;
  for (const auto &cell : mesh.cells) {
    std::array<int, 6> middles{-1, -1, -1, -1, -1, -1};
    for (std::size_t e = 0; e < edges; ++e) {
      std::array<PetscInt, 2> ends{cell[static_cast<std::size_t>(simplex_edges[e][0])],
                                   cell[static_cast<std::size_t>(simplex_edges[e][1])]};
      std::sort(ends.begin(), ends.end());
      middles[e] = middle.at(ends);
    }
    mesh.cell_middles.push_back(middles);
  }
}

/// Which of these DMPlex points, of these heights, carry a label.
std::vector<bool> marks(const Mesh &mesh, const std::string &name,
                        std::initializer_list<PetscInt> heights,
                        const std::vector<PetscInt> &points) {
  PetscInt end = 0;
  RBVI_CALL(DMPlexGetChart(mesh.dm.get(), nullptr, &end));
  std::vector<bool> labelled(static_cast<std::size_t>(end), false), marked;
  for (const PetscInt height : heights)
    for (const PetscInt point : labelled_points(mesh.dm.get(), name, height))
      labelled[static_cast<std::size_t>(point)] = true;
  for (const PetscInt point : points)
    marked.push_back(labelled[static_cast<std::size_t>(point)]);
  return marked;
}

} // namespace

Mesh make_mesh(MPI_Comm comm, const Scene &scene, const MeshOptions &options) {
  const Communicator world(comm);
  SerialMesh serial;
  serial.dim = scene.dim;
  std::vector<SerialMesh> levels;
  std::vector<int> part;
  std::string fingerprint(16, '0');
  collectively(comm, [&] {
    if (world.rank != 0) return;
    serial = undistributed_mesh(scene, options, levels);
    part = partition_cells(serial, world.size);
    fingerprint = fingerprint_of(serial);
  });

  Mesh mesh;
  mesh.comm = comm;
  mesh.dim = scene.dim;
  mesh.degree = scene.degree;
  mesh.levels = options.levels ? options.levels
                               : std::make_shared<const std::vector<SerialMesh>>(std::move(levels));
  std::array<PetscInt, 2> totals{static_cast<PetscInt>(serial.points.size()),
                                 static_cast<PetscInt>(serial.cells.size())};
  MPI_Bcast(totals.data(), 2, MPIU_INT, 0, comm);
  MPI_Bcast(fingerprint.data(), 16, MPI_CHAR, 0, comm);
  mesh.total_vertices = totals[0];
  mesh.total_cells = totals[1];
  mesh.fingerprint = fingerprint;

  mesh.dm = make_plex(comm, serial, scene.mesh);
  const EdgePoints edges = edges_of(mesh.dm.get(), comm);
  const std::vector<PetscInt> original = distribute(mesh.dm, part, world.size);
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
    mesh.owned_node.push_back(!elsewhere[static_cast<std::size_t>(point)]);
  std::vector<PetscInt> cells(mesh.cells.size());
  std::iota(cells.begin(), cells.end(), 0);
  for (const std::string &name : scene.mesh.regions)
    mesh.region[name] = marks(mesh, name, {0}, cells);
  for (const std::string &name : scene.mesh.boundaries) {
    mesh.boundary[name] = marks(mesh, name, {mesh.dim - 1, mesh.dim}, mesh.dm_point);
    mesh.facets[name] = boundary_facets(mesh, name, elsewhere, begin);
  }
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
