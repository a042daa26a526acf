#include "rbvi/fem/interface_mesh.hpp"

#include "curve_nodes.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/fem/materials.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/gather.hpp"

#include <algorithm>
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

/// A cell that an interface sees: its number in the undistributed mesh, its edge on a boundary (-1:
/// none), its nodes.
struct SeenCell {
  PetscInt number, edge;
  std::array<int, most_nodes> nodes;
};

/// Those of all ranks; nodes by increasing natural number, `fixed` a bit for each component.
struct SeenCells {
  std::vector<SeenCell> cells;
  std::vector<PetscInt> natural, fixed;
  std::vector<Point> points;
};

/// This rank's nodes of some of its cells, each once.
std::vector<std::size_t> nodes_of_cells(const Mesh &mesh, const std::vector<SeenCell> &mine) {
  std::vector<bool> seen(mesh.points.size(), false);
  for (const SeenCell &cell : mine)
    for (std::size_t i = 0; i < cell.nodes.size() && cell.nodes[i] >= 0; ++i)
      seen[cell.nodes[i]] = true;
  std::vector<std::size_t> nodes;
  for (std::size_t node = 0; node < seen.size(); ++node)
    if (seen[node]) nodes.push_back(node);
  return nodes;
}

/// Fills in the nodes of all ranks; those on the border of several come from each of them.
void gather_nodes(const Mesh &mesh, const Dofs &dofs, const std::vector<SeenCell> &mine,
                  SeenCells &all) {
  const auto components = static_cast<std::size_t>(dofs.components);
  std::vector<PetscInt> natural, fixed;
  std::vector<double> x;
  for (const std::size_t node : nodes_of_cells(mesh, mine)) {
    natural.push_back(mesh.natural_node[node]);
    x.insert(x.end(), mesh.points[node].begin(), mesh.points[node].end());
    fixed.push_back(0);
    for (std::size_t c = 0; c < components; ++c)
      if (dofs.free[node * components + c] < 0) fixed.back() |= PetscInt{1} << c;
  }
  natural = gather_all(mesh.comm, natural, MPIU_INT);
  fixed = gather_all(mesh.comm, fixed, MPIU_INT);
  x = gather_all(mesh.comm, x, MPI_DOUBLE);
  std::vector<std::size_t> order(natural.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return natural[k]; });
  for (const std::size_t k : order) {
    if (!all.natural.empty() && all.natural.back() == natural[k]) continue;
    all.natural.push_back(natural[k]);
    all.fixed.push_back(fixed[k]);
    all.points.push_back({x[3 * k], x[3 * k + 1], x[3 * k + 2]});
  }
}

/// `mine`: with this rank's local nodes. Collective.
SeenCells gather_cells(const Mesh &mesh, const Dofs &dofs, const std::vector<SeenCell> &mine) {
  SeenCells all;
  gather_nodes(mesh, dofs, mine, all);
  const auto per_cell = static_cast<std::size_t>(nodes_per_cell(mesh.dim, mesh.degree));
  std::vector<PetscInt> packed;
  for (const SeenCell &cell : mine) {
    packed.insert(packed.end(), {cell.number, cell.edge});
    for (std::size_t i = 0; i < per_cell; ++i)
      packed.push_back(mesh.natural_node[cell.nodes[i]]);
  }
  packed = gather_all(mesh.comm, packed, MPIU_INT);
  for (std::size_t at = 0; at < packed.size(); at += 2 + per_cell) {
    SeenCell &cell = all.cells.emplace_back(SeenCell{packed[at], packed[at + 1], {}});
    for (std::size_t i = 0; i < per_cell; ++i)
      cell.nodes[i] = static_cast<int>(std::ranges::lower_bound(all.natural, packed[at + 2 + i]) -
                                       all.natural.begin());
  }
  return all;
}

/// Cells in their order.
Found found_cells(const Mesh &mesh, const Dofs &dofs, SeenCells &&seen) {
  Found found;
  found.mesh.per_entity = nodes_per_cell(mesh.dim, mesh.degree);
  for (const PetscInt fixed : seen.fixed)
    for (int c = 0; c < dofs.components; ++c)
      found.free.push_back((fixed >> c & 1) == 0);
  for (const SeenCell &cell : seen.cells) {
    found.mesh.entities.insert(found.mesh.entities.end(), cell.nodes.begin(),
                               cell.nodes.begin() + found.mesh.per_entity);
    if (cell.edge >= 0) found.mesh.edges.push_back(static_cast<int>(cell.edge));
  }
  found.mesh.parts = {static_cast<int>(seen.natural.size())};
  found.mesh.points = std::move(seen.points);
  found.natural = std::move(seen.natural);
  return found;
}

SeenCell seen_cell(const Mesh &mesh, std::size_t cell, int edge) {
  return {mesh.natural_cell[cell], edge, nodes_of(mesh, cell)};
}

Found find_region(const Mesh &mesh, const Dofs &dofs, const std::string &name) {
  const std::vector<bool> &in_region = mesh.region.at(name);
  std::vector<SeenCell> mine;
  for (std::size_t k = 0; k < mesh.cells.size(); ++k)
    if (in_region[k]) mine.push_back(seen_cell(mesh, k, -1));
  SeenCells seen = gather_cells(mesh, dofs, mine);
  if (seen.cells.empty()) throw bad_input("the mesh has no cell in region '" + name + "'");
  std::ranges::sort(seen.cells, {}, &SeenCell::number);
  return found_cells(mesh, dofs, std::move(seen));
}

/// Local edge of a triangle whose nodes are all on the boundary; -1: none.
int edge_on(const std::vector<bool> &boundary, const std::array<int, most_nodes> &nodes,
            int degree) {
  const auto on = [&](std::size_t i) { return boundary[nodes[i]]; };
  for (std::size_t e = 0; e < 3; ++e)
    if (on(simplex_edges[e][0]) && on(simplex_edges[e][1]) && (degree == 1 || on(3 + e)))
      return static_cast<int>(e);
  return -1;
}

Found find_cells_beside(const Mesh &mesh, const Dofs &dofs, const std::string &boundary) {
  std::vector<SeenCell> mine;
  for (std::size_t k = 0; k < mesh.cells.size(); ++k)
    if (const int edge = edge_on(mesh.boundary.at(boundary), nodes_of(mesh, k), mesh.degree);
        edge >= 0)
      mine.push_back(seen_cell(mesh, k, edge));
  SeenCells seen = gather_cells(mesh, dofs, mine);
  if (seen.cells.empty()) throw bad_input("no cell has an edge on the boundary '" + boundary + "'");
  std::ranges::sort(seen.cells, {}, [&](const SeenCell &cell) {
    const auto x = [&](int i) { return seen.points[cell.nodes[i]][0]; };
    const auto [a, b] = simplex_edges[cell.edge];
    return x(a) + x(b);
  });
  return found_cells(mesh, dofs, std::move(seen));
}

/// Adds the edges of a curve whose nodes begin at `first`: vertices, then middles.
void add_edges(int first, int nodes, int degree, std::vector<int> &entities) {
  const int edges = (nodes - 1) / degree;
  for (int e = 0; e < edges; ++e) {
    entities.insert(entities.end(), {first + e, first + e + 1});
    if (degree == 2) entities.push_back(first + edges + 1 + e);
  }
}

void add_closed_ends(const Mesh &mesh, const std::string &boundary, InterfaceMesh &interface) {
  const auto &[first, last] = mesh.closed_ends.at(boundary);
  interface.closed_ends.insert(interface.closed_ends.end(), {first ? 1 : 0, last ? 1 : 0});
}

Found find_curves(const Mesh &mesh, const Dofs &dofs, const InterfaceEntities &entities,
                  const std::function<Point(const Point &)> &snap) {
  std::vector<int> components = entities.components;
  const bool sees_all = components.empty(); // then it takes fixed nodes into account
  if (sees_all) {
    components.resize(dofs.components);
    std::iota(components.begin(), components.end(), 0);
  }
  Found found;
  found.mesh.per_entity = mesh.degree + 1;
  for (const std::string &name : entities.parts) {
    const std::vector<CurveNode> nodes = gather_curve(mesh, dofs, name, components, sees_all);
    add_edges(static_cast<int>(found.natural.size()), static_cast<int>(nodes.size()), mesh.degree,
              found.mesh.entities);
    found.mesh.parts.push_back(static_cast<int>(nodes.size()));
    add_closed_ends(mesh, name, found.mesh);
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
  if (entities.kind == cells_beside) add_closed_ends(mesh, entities.parts.front(), found.mesh);
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

/// Whether it constrains displacements one by one. What sees the cells beside a curve does not, and
/// may share them.
bool constrains(const ContactRecipe &contact) {
  return contact.entities.kind != InterfaceEntities::Kind::cells_beside;
}

/// "contact on 'slave' and contact on 'master' ".
std::string both(const ContactRecipe &one, const ContactRecipe &other) {
  return described(one) + " and " + described(other) + " ";
}

std::string place(const Point &x) {
  return "(" + short_number(x[0]) + ", " + short_number(x[1]) + ", " + short_number(x[2]) + ")";
}

/// What to throw for a displacement that two interfaces constrain.
Error shared_displacement(const ContactRecipe &one, const ContactRecipe &other, const Point &at,
                          int component) {
  return bad_input(both(one, other) + "both constrain the displacement along " + "xyz"[component] +
                   " at " + place(at) +
                   ": give them boundaries without common nodes, or fix the displacement there");
}

/// Whose each edge of a boundary is, by the natural numbers of its ends.
using Edges = std::map<std::pair<PetscInt, PetscInt>, const ContactRecipe *>;

/// The edges that its cells stand beside are its own. Throws bad_input where one is another
/// interface's.
void claim_edges(const Found &found, const ContactRecipe &contact, Edges &edges) {
  for (std::size_t e = 0; e < found.mesh.edges.size(); ++e) {
    const int *nodes = found.mesh.nodes_of(static_cast<Index>(e));
    const auto [i, j] = simplex_edges[found.mesh.edges[e]];
    const auto a = static_cast<std::size_t>(nodes[i]), b = static_cast<std::size_t>(nodes[j]);
    const auto [known, is_new] =
        edges.emplace(std::minmax({found.natural[a], found.natural[b]}), &contact);
    if (!is_new)
      throw bad_input(both(*known->second, contact) + "share the edge from " +
                      place(found.mesh.points[a]) + " to " + place(found.mesh.points[b]) +
                      ": give each a boundary of its own");
  }
}

} // namespace

InterfacePlaces place_interfaces(const Mesh &mesh, const Dofs &dofs, const Scene &scene) {
  InterfacePlaces places;
  std::map<PetscInt, int> column; // natural dof -> contact dof
  std::vector<std::size_t> first; // contact dofs before each interface
  std::vector<PetscInt> &natural_dofs = places.natural_dofs;
  const auto components = static_cast<std::size_t>(dofs.components);
  const std::vector<int> materials = materials_of_cells(scene, mesh);
  Edges edges;
  for (const ContactRecipe &contact : scene.contacts) {
    Found found = find_interface(mesh, dofs, scene, contact.entities);
    claim_edges(found, contact, edges);
    first.push_back(natural_dofs.size());
    for (std::size_t i = 0; i < found.free.size(); ++i) {
      const PetscInt natural =
          found.natural[i / components] * dofs.components + static_cast<PetscInt>(i % components);
      if (!found.free[i]) {
        found.mesh.dofs.push_back(-1);
        continue;
      }
      if (dofs.tied.contains(natural) ||
          std::ranges::any_of(dofs.tied, [&](const auto &pair) { return pair.second == natural; }))
        throw bad_input("a boundary that moves as one by a force meets " + described(contact) +
                        " at " + place(found.mesh.points[i / components]) +
                        ": give them boundaries without common nodes");
      const auto [at, is_new] = column.emplace(natural, static_cast<int>(natural_dofs.size()));
      if (const auto dof = static_cast<std::size_t>(at->second);
          !is_new && dof < first.back() && constrains(contact)) {
        const auto other = std::ranges::upper_bound(first, dof) - first.begin() - 1;
        throw shared_displacement(scene.contacts[other], contact, found.mesh.points[i / components],
                                  static_cast<int>(i % components));
      }
      if (is_new) natural_dofs.push_back(natural);
      found.mesh.dofs.push_back(at->second);
    }
    found.mesh.imposed_by = imposed_at(mesh, dofs, found.natural);
    found.mesh.materials = materials_of_entities(scene, mesh, materials, found.mesh, found.natural);
    places.meshes.push_back(std::move(found.mesh));
    places.natural_nodes.push_back(std::move(found.natural));
  }
  for (InterfaceMesh &interface : places.meshes)
    interface.columns = std::ssize(natural_dofs);
  places.trace = make_trace(dofs, natural_dofs);
  return places;
}

} // namespace rbvi
