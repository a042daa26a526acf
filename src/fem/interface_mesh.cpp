#include "rbvi/fem/interface_mesh.hpp"

#include "curve_nodes.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/gather.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <numeric>

namespace rbvi {

namespace {

/// An interface as it is found: `free` tells of every node * components + c whether its kernels can
/// move it.
struct Found {
  InterfaceMesh mesh;
  std::vector<PetscInt> natural;
  std::vector<bool> free;
};

/// A cell as it travels: its number, its edge on a boundary (-1: none), its nodes, which of their
/// components are fixed, and where they are.
struct Record {
  PetscInt number, edge;
  std::array<PetscInt, most_nodes> nodes;
  std::array<unsigned char, most_nodes> fixed; ///< a bit for each component
  std::array<Point, most_nodes> points;
};

Record record_of(const Mesh &mesh, const Dofs &dofs, std::size_t cell, int edge) {
  Record record{mesh.natural_cell[cell], edge, {}, {}, {}};
  const auto nodes = nodes_of(mesh, cell);
  const auto components = static_cast<std::size_t>(dofs.components);
  for (std::size_t i = 0; i < nodes.size() && nodes[i] >= 0; ++i) {
    const auto node = static_cast<std::size_t>(nodes[i]);
    record.nodes[i] = mesh.natural_node[node];
    record.points[i] = mesh.points[node];
    for (std::size_t c = 0; c < components; ++c)
      if (dofs.free[node * components + c] < 0)
        record.fixed[i] = static_cast<unsigned char>(record.fixed[i] | (1U << c));
  }
  return record;
}

std::vector<Record> on_every_rank(MPI_Comm comm, const std::vector<Record> &mine) {
  std::vector<char> bytes(mine.size() * sizeof(Record));
  if (!mine.empty()) std::memcpy(bytes.data(), mine.data(), bytes.size());
  bytes = gather_all(comm, bytes, MPI_CHAR);
  std::vector<Record> all(bytes.size() / sizeof(Record));
  if (!all.empty()) std::memcpy(all.data(), bytes.data(), bytes.size());
  return all;
}

/// Cells in the order of `records`, their nodes by number.
Found found_cells(const Mesh &mesh, const Dofs &dofs, const std::vector<Record> &records) {
  Found found;
  found.mesh.per_entity = nodes_per_cell(mesh.dim, mesh.degree);
  const auto per_cell = static_cast<std::size_t>(found.mesh.per_entity);
  std::map<PetscInt, std::pair<Point, unsigned>> nodes; // natural number -> where, fixed components
  for (const Record &record : records)
    for (std::size_t i = 0; i < per_cell; ++i)
      nodes[record.nodes[i]] = {record.points[i], record.fixed[i]};
  std::map<PetscInt, int> position;
  for (const auto &[number, node] : nodes) {
    position[number] = static_cast<int>(found.natural.size());
    found.natural.push_back(number);
    found.mesh.points.push_back(node.first);
    for (int c = 0; c < dofs.components; ++c)
      found.free.push_back((node.second >> c & 1U) == 0);
  }
  for (const Record &record : records) {
    for (std::size_t i = 0; i < per_cell; ++i)
      found.mesh.entities.push_back(position.at(record.nodes[i]));
    if (record.edge >= 0) found.mesh.edges.push_back(static_cast<int>(record.edge));
  }
  found.mesh.parts = {static_cast<int>(found.natural.size())};
  return found;
}

Found find_region(const Mesh &mesh, const Dofs &dofs, const std::string &name) {
  const std::vector<bool> &in_region = mesh.region.at(name);
  std::vector<Record> records;
  for (std::size_t k = 0; k < mesh.cells.size(); ++k)
    if (in_region[k]) records.push_back(record_of(mesh, dofs, k, -1));
  records = on_every_rank(mesh.comm, records);
  if (records.empty()) throw bad_input("the mesh has no cell in region '" + name + "'");
  std::ranges::sort(records, {}, &Record::number);
  return found_cells(mesh, dofs, records);
}

/// Local edge of a triangle whose nodes are all on the boundary; -1: none.
int edge_on(const std::vector<bool> &boundary, const std::array<int, most_nodes> &nodes,
            int degree) {
  const auto on = [&](std::size_t i) { return boundary[static_cast<std::size_t>(nodes[i])]; };
  for (std::size_t e = 0; e < 3; ++e)
    if (on(static_cast<std::size_t>(simplex_edges[e][0])) &&
        on(static_cast<std::size_t>(simplex_edges[e][1])) && (degree == 1 || on(3 + e)))
      return static_cast<int>(e);
  return -1;
}

Found find_cells_beside(const Mesh &mesh, const Dofs &dofs, const std::string &boundary) {
  std::vector<Record> records;
  for (std::size_t k = 0; k < mesh.cells.size(); ++k)
    if (const int edge = edge_on(mesh.boundary.at(boundary), nodes_of(mesh, k), mesh.degree);
        edge >= 0)
      records.push_back(record_of(mesh, dofs, k, edge));
  records = on_every_rank(mesh.comm, records);
  if (records.empty()) throw bad_input("no cell has an edge on the boundary '" + boundary + "'");
  std::ranges::sort(records, {}, [](const Record &record) {
    const auto [a, b] = simplex_edges[static_cast<std::size_t>(record.edge)];
    return record.points[static_cast<std::size_t>(a)][0] +
           record.points[static_cast<std::size_t>(b)][0];
  });
  return found_cells(mesh, dofs, records);
}

/// Adds the edges of a curve whose nodes begin at `first`: vertices, then middles.
void add_edges(int first, int nodes, int degree, std::vector<int> &entities) {
  const int edges = (nodes - 1) / degree;
  for (int e = 0; e < edges; ++e) {
    entities.insert(entities.end(), {first + e, first + e + 1});
    if (degree == 2) entities.push_back(first + edges + 1 + e);
  }
}

Found find_curves(const Mesh &mesh, const Dofs &dofs, const InterfaceEntities &entities,
                  const std::function<Point(const Point &)> &snap) {
  std::vector<int> components = entities.components;
  const bool sees_all = components.empty(); // then it takes fixed nodes into account
  if (sees_all) {
    components.resize(static_cast<std::size_t>(dofs.components));
    std::iota(components.begin(), components.end(), 0);
  }
  Found found;
  found.mesh.per_entity = mesh.degree + 1;
  for (const std::string &name : entities.parts) {
    const std::vector<CurveNode> nodes = gather_curve(mesh, dofs, name, components, sees_all);
    add_edges(static_cast<int>(found.natural.size()), static_cast<int>(nodes.size()), mesh.degree,
              found.mesh.entities);
    found.mesh.parts.push_back(static_cast<int>(nodes.size()));
    for (const CurveNode &node : nodes) {
      const bool middle = node.natural >= mesh.total_vertices;
      found.natural.push_back(node.natural);
      found.mesh.points.push_back(middle && entities.snapped && snap ? snap(node.point)
                                                                     : node.point);
      for (int c = 0; c < dofs.components; ++c)
        found.free.push_back((node.fixed >> c & 1) == 0 &&
                             std::ranges::find(components, c) != components.end());
    }
  }
  return found;
}

Found find_interface(const Mesh &mesh, const Dofs &dofs, const Scene &scene,
                     const InterfaceEntities &entities) {
  using enum InterfaceEntities::Kind;
  if (entities.kind != cells && mesh.dim != 2)
    throw bad_input("contact along a boundary is for two dimensions: the mesh has " +
                    std::to_string(mesh.dim));
  Found found = entities.kind == cells    ? find_region(mesh, dofs, entities.parts.front())
                : entities.kind == curves ? find_curves(mesh, dofs, entities, scene.snap)
                                          : find_cells_beside(mesh, dofs, entities.parts.front());
  found.mesh.dim = mesh.dim;
  found.mesh.degree = mesh.degree;
  found.mesh.components = dofs.components;
  return found;
}

/// InterfaceMesh::imposed_by of nodes with these natural numbers. Collective.
std::vector<int> imposed_at(const Mesh &mesh, const Dofs &dofs,
                            const std::vector<PetscInt> &natural) {
  if (dofs.imposed_by.empty()) return {};
  const auto components = static_cast<std::size_t>(dofs.components);
  std::map<PetscInt, std::size_t> position;
  for (std::size_t k = 0; k < natural.size(); ++k)
    position[natural[k]] = k;
  std::vector<PetscInt> found(natural.size() * components, -1);
  for (std::size_t node = 0; node < mesh.points.size(); ++node)
    if (const auto at = position.find(mesh.natural_node[node]); at != position.end())
      for (std::size_t c = 0; c < components; ++c)
        found[at->second * components + c] = dofs.imposed_by[node * components + c];
  over_ranks(mesh.comm, MPI_MAX, found);
  return {found.begin(), found.end()};
}

/// What to throw for a displacement that two interfaces constrain.
Error shared_displacement(const ContactRecipe &one, const ContactRecipe &other, const Point &at,
                          int component) {
  const auto name = [](const ContactRecipe &contact) {
    return "'" + contact.entities.parts.front() + "'";
  };
  return bad_input("the contact interfaces on " + name(one) + " and " + name(other) +
                   " both constrain the displacement along " + "xyz"[component] + " at (" +
                   short_number(at[0]) + ", " + short_number(at[1]) + ", " + short_number(at[2]) +
                   "): give them boundaries without common nodes, or fix the displacement there");
}

} // namespace

InterfacePlaces place_interfaces(const Mesh &mesh, const Dofs &dofs, const Scene &scene) {
  InterfacePlaces places;
  std::map<PetscInt, int> column; // natural dof -> contact dof
  std::vector<std::size_t> first; // contact dofs before each interface
  std::vector<PetscInt> &natural_dofs = places.natural_dofs;
  const auto components = static_cast<std::size_t>(dofs.components);
  for (const ContactRecipe &contact : scene.contacts) {
    Found found = find_interface(mesh, dofs, scene, contact.entities);
    first.push_back(natural_dofs.size());
    for (std::size_t i = 0; i < found.free.size(); ++i) {
      const PetscInt natural =
          found.natural[i / components] * dofs.components + static_cast<PetscInt>(i % components);
      if (!found.free[i]) {
        found.mesh.dofs.push_back(-1);
        continue;
      }
      const auto [at, is_new] = column.emplace(natural, static_cast<int>(natural_dofs.size()));
      if (const auto dof = static_cast<std::size_t>(at->second); !is_new && dof < first.back()) {
        const auto other = std::ranges::upper_bound(first, dof) - first.begin() - 1;
        throw shared_displacement(scene.contacts[static_cast<std::size_t>(other)], contact,
                                  found.mesh.points[i / components],
                                  static_cast<int>(i % components));
      }
      if (is_new) natural_dofs.push_back(natural);
      found.mesh.dofs.push_back(at->second);
    }
    found.mesh.imposed_by = imposed_at(mesh, dofs, found.natural);
    places.meshes.push_back(std::move(found.mesh));
    places.natural_nodes.push_back(std::move(found.natural));
  }
  for (InterfaceMesh &interface : places.meshes)
    interface.columns = static_cast<Index>(natural_dofs.size());
  places.trace = make_trace(dofs, natural_dofs);
  return places;
}

} // namespace rbvi
