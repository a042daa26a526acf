#include "rbvi/fem/distributed_contact.hpp"

#include "seen.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/facets.hpp"
#include "rbvi/fem/materials.hpp"
#include "rbvi/par/collective.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace rbvi {

namespace {

/// An interface as it is found: `free` tells of every node * components + c whether its kernels can
/// move it.
struct Found {
  InterfaceMesh mesh;
  std::vector<PetscInt> natural;
  std::vector<bool> free;
};

/// The pieces of a boundary in the order that InterfaceMesh has, `second` of two; `backwards`: the
/// body is on the right.
struct OrderedPiece {
  CurvePiece chain;
  bool backwards;
};

std::vector<OrderedPiece> ordered_pieces(const Mesh &mesh, const SeenNodes &nodes,
                                         const std::string &boundary, bool alone, bool second) {
  std::vector<OrderedPiece> pieces;
  if (mesh.curves.at(boundary).empty())
    throw bad_input("the contact boundary '" + boundary + "' has no edge");
  for (CurvePiece piece : mesh.curves.at(boundary)) {
    const auto x = [&](PetscInt vertex) { return -nodes.at(vertex)[0]; };
    const auto not_rising = [](double before, double after) { return before >= after; };
    const bool leftwards = !piece.loop && std::ranges::adjacent_find(piece.vertices, not_rising,
                                                                     x) == piece.vertices.end();
    const bool backwards = second || (alone && leftwards);
    if (backwards) {
      std::reverse(piece.vertices.begin() + (piece.loop ? 1 : 0), piece.vertices.end());
      std::swap(piece.closed_ends[0], piece.closed_ends[1]);
    }
    pieces.push_back({std::move(piece), backwards});
  }
  return pieces;
}

/// Calls visit(begin, end), natural numbers, for the edges in their order, the body on the left of
/// each.
template <class Visit>
void visit_edges(const std::vector<OrderedPiece> &pieces, const Visit &visit) {
  for (const auto &[piece, backwards] : pieces) {
    const std::vector<PetscInt> &v = piece.vertices;
    for (std::size_t i = 0; i + (piece.loop ? 0 : 1) < v.size(); ++i) {
      const PetscInt a = v[i], b = v[(i + 1) % v.size()];
      backwards ? visit(b, a) : visit(a, b);
    }
  }
}

/// Cells, or facets, in their order.
Found found_cells(const Dofs &dofs, SeenCells &&seen, int per_entity) {
  Found found;
  found.mesh.per_entity = per_entity;
  for (const PetscInt fixed : seen.nodes.fixed)
    for (int c = 0; c < dofs.components; ++c)
      found.free.push_back((fixed >> c & 1) == 0);
  for (const SeenCell &cell : seen.cells) {
    found.mesh.entities.insert(found.mesh.entities.end(), cell.nodes.begin(),
                               cell.nodes.begin() + found.mesh.per_entity);
    if (cell.edge >= 0) found.mesh.edges.push_back(static_cast<int>(cell.edge));
  }
  found.mesh.parts = {static_cast<int>(seen.nodes.natural.size())};
  found.mesh.points = std::move(seen.nodes.points);
  found.natural = std::move(seen.nodes.natural);
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
  SeenCells seen = gather_cells(mesh, dofs, mine, nodes_per_cell(mesh.dim, mesh.degree));
  if (seen.cells.empty()) throw bad_input("the mesh has no cell in region '" + name + "'");
  std::ranges::sort(seen.cells, {}, &SeenCell::number);
  return found_cells(dofs, std::move(seen), nodes_per_cell(mesh.dim, mesh.degree));
}

/// The triangles of a boundary.
Found find_surface(const Mesh &mesh, const Dofs &dofs, const std::string &name) {
  const int per_facet = nodes_per_cell(2, mesh.degree);
  std::vector<SeenCell> mine;
  for (const auto &[cell, facet] : mesh.facets.at(name)) {
    const std::array<int, most_nodes> of_cell = nodes_of(mesh, cell);
    SeenCell &seen = mine.emplace_back(SeenCell{mesh.natural_cell[cell], facet, {}});
    std::ranges::transform(facet_nodes(3, mesh.degree, facet), seen.nodes.begin(),
                           [&](int i) { return of_cell[i]; });
  }
  SeenCells seen = gather_cells(mesh, dofs, mine, per_facet);
  if (seen.cells.empty()) throw bad_input("the contact boundary '" + name + "' has no triangle");
  std::ranges::sort(seen.cells, {},
                    [](const SeenCell &of) { return std::pair(of.number, of.edge); });
  for (SeenCell &of : seen.cells)
    of.edge = -1;
  Found found = found_cells(dofs, std::move(seen), per_facet);
  const std::vector<PetscInt> &open = mesh.open_rims.at(name);
  for (const PetscInt node : found.natural)
    found.mesh.closed_ends.push_back(std::ranges::binary_search(open, node) ? 0 : 1);
  return found;
}

void add_closed_ends(const std::vector<OrderedPiece> &pieces, InterfaceMesh &interface) {
  for (const OrderedPiece &piece : pieces)
    for (const bool closed : piece.chain.closed_ends)
      interface.closed_ends.push_back(closed ? 1 : 0);
}

Found find_cells_beside(const Mesh &mesh, const Dofs &dofs, const InterfaceEntities &entities,
                        const Scene &scene) {
  const std::string &boundary = entities.parts.front();
  std::vector<SeenCell> mine;
  for (const auto &[cell, facet] : mesh.facets.at(boundary)) {
    const std::vector<int> ends = facet_nodes(2, 1, facet);
    int edge = 0;
    while (std::ranges::count(ends, simplex_edges[edge][0]) == 0 ||
           std::ranges::count(ends, simplex_edges[edge][1]) == 0)
      ++edge;
    mine.push_back(seen_cell(mesh, cell, edge));
  }
  SeenCells seen = gather_cells(mesh, dofs, mine, nodes_per_cell(mesh.dim, mesh.degree));
  if (entities.snapped) move_middles(mesh, scene, boundary, seen.nodes);
  const std::vector<OrderedPiece> pieces = ordered_pieces(mesh, seen.nodes, boundary, true, false);
  std::map<PetscInt, int> number; // of the edge by where it begins
  visit_edges(pieces, [&](PetscInt begin, PetscInt) { number.emplace(begin, std::ssize(number)); });
  std::ranges::sort(seen.cells, {}, [&](const SeenCell &cell) {
    return number.at(seen.nodes.natural[cell.nodes[simplex_edges[cell.edge][0]]]);
  });
  Found found = found_cells(dofs, std::move(seen), nodes_per_cell(mesh.dim, mesh.degree));
  add_closed_ends(pieces, found.mesh);
  return found;
}

/// Adds a boundary, whose nodes begin at `first`: vertices, then middles.
void add_curve(const Mesh &mesh, const SeenCurve &curve, const std::vector<OrderedPiece> &pieces,
               Found &found) {
  const auto first = static_cast<int>(found.natural.size());
  std::map<PetscInt, int> number;
  for (const OrderedPiece &piece : pieces)
    for (const PetscInt vertex : piece.chain.vertices) {
      number.emplace(vertex, first + static_cast<int>(std::ssize(number)));
      found.natural.push_back(vertex);
    }
  auto middle = first + static_cast<int>(std::ssize(number));
  visit_edges(pieces, [&](PetscInt begin, PetscInt end) {
    found.mesh.entities.insert(found.mesh.entities.end(), {number.at(begin), number.at(end)});
    if (mesh.degree == 1) return;
    found.mesh.entities.push_back(middle++);
    found.natural.push_back(curve.middle.at(begin));
  });
  found.mesh.parts.push_back(static_cast<int>(found.natural.size()) - first);
  add_closed_ends(pieces, found.mesh);
}

Found find_curves(const Mesh &mesh, const Dofs &dofs, const InterfaceEntities &entities,
                  const Scene &scene) {
  const bool sees_all = entities.components.empty(); // then it takes fixed nodes into account
  const auto sees = [&](int c) {
    return sees_all || std::ranges::find(entities.components, c) != entities.components.end();
  };
  Found found;
  found.mesh.per_entity = mesh.degree + 1;
  for (std::size_t part = 0; part < entities.parts.size(); ++part) {
    const std::string &name = entities.parts[part];
    const std::size_t first = found.natural.size();
    SeenCurve curve = gather_curve(mesh, dofs, name);
    if (entities.snapped) move_middles(mesh, scene, name, curve.nodes);
    add_curve(mesh, curve,
              ordered_pieces(mesh, curve.nodes, name, entities.parts.size() == 1, part > 0), found);
    for (std::size_t i = first; i < found.natural.size(); ++i) {
      const Index at = curve.nodes.position(found.natural[i]);
      found.mesh.points.push_back(curve.nodes.points[at]);
      for (int c = 0; c < dofs.components; ++c) {
        const bool free = (curve.nodes.fixed[at] >> c & 1) == 0;
        if (!free && sees(c) && !sees_all)
          throw bad_input("the displacement is fixed on the contact curve '" + name +
                          "': contact cannot move it");
        found.free.push_back(free && sees(c));
      }
    }
  }
  return found;
}

Found find_interface(const Mesh &mesh, const Dofs &dofs, const Scene &scene,
                     const InterfaceEntities &entities) {
  using enum InterfaceEntities::Kind;
  if (mesh.dim == 3 && (entities.kind == cells_beside || entities.parts.size() > 1))
    throw bad_input("Nitsche's method, and contact between two bodies, are for two dimensions: a "
                    "solid meets something rigid, by multipliers");
  Found found = entities.kind == cells          ? find_region(mesh, dofs, entities.parts.front())
                : entities.kind == cells_beside ? find_cells_beside(mesh, dofs, entities, scene)
                : mesh.dim == 3                 ? find_surface(mesh, dofs, entities.parts.front())
                                                : find_curves(mesh, dofs, entities, scene);
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

/// Whether it bounds displacements one by one, or over cells: then none is shared. Curves may have
/// a node in common, but no edge: each constraint is one of the edges beside the node.
bool bounds_alone(const ContactRecipe &contact) {
  return contact.entities.kind == InterfaceEntities::Kind::cells || contact.nodal;
}

/// "contact on 'slave' and contact on 'master' ".
std::string both(const ContactRecipe &one, const ContactRecipe &other) {
  return described(one) + " and " + described(other) + " ";
}

/// Whose each facet of a boundary is, by the natural numbers of its vertices.
using Facets = std::map<std::set<PetscInt>, const ContactRecipe *>;

/// The facets of its boundaries, or that its cells stand beside, are its own. Throws bad_input
/// where one is another interface's.
void claim_facets(const Found &found, const ContactRecipe &contact, Facets &facets) {
  if (contact.entities.kind == InterfaceEntities::Kind::cells) return;
  for (Index e = 0; e < found.mesh.count(); ++e) {
    const int *nodes = found.mesh.nodes_of(e);
    std::vector<int> corners(nodes, nodes + found.mesh.dim);
    if (!found.mesh.edges.empty())
      std::ranges::transform(simplex_edges[found.mesh.edges[e]], corners.begin(),
                             [&](int i) { return nodes[i]; });
    std::set<PetscInt> facet;
    for (const int node : corners)
      facet.insert(found.natural[node]);
    const auto [known, is_new] = facets.emplace(facet, &contact);
    if (!is_new)
      throw bad_input(both(*known->second, contact) +
                      (found.mesh.dim == 2 ? "share the edge from " : "share the triangle from ") +
                      place_text(found.mesh.points[corners[0]]) + " to " +
                      place_text(found.mesh.points[corners[1]]) +
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
  Facets facets;
  for (const ContactRecipe &contact : scene.contacts) {
    Found found = find_interface(mesh, dofs, scene, contact.entities);
    claim_facets(found, contact, facets);
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
                        " at " + place_text(found.mesh.points[i / components]) +
                        ": give them boundaries without common nodes");
      const auto [at, is_new] = column.emplace(natural, static_cast<int>(natural_dofs.size()));
      if (const auto dof = static_cast<std::size_t>(at->second);
          !is_new && dof < first.back() && bounds_alone(contact)) {
        const auto other = std::ranges::upper_bound(first, dof) - first.begin() - 1;
        if (!(scene.contacts[other].push * contact.push < 0)) // not from both sides
          throw bad_input(both(scene.contacts[other], contact) +
                          "both constrain the displacement along " + "xyz"[i % components] +
                          " at " + place_text(found.mesh.points[i / components]) +
                          ": give them boundaries without common nodes, or fix the displacement "
                          "there");
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
