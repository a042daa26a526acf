#include "rbvi/fem/problem.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/cell_fields.hpp"
#include "rbvi/fem/assembly.hpp"
#include "rbvi/fem/materials.hpp"
#include "rbvi/par/collective.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace rbvi {

namespace {

using Part = OutputCells::Part;

/// The parts of outputs on the cells of this rank.
class OwnParts {
public:
  OwnParts(const Scene &scene, const Mesh &mesh, const Dofs &dofs)
      : scene_(scene), mesh_(mesh), dofs_(dofs) {}

  std::vector<Part> of(int output) {
    const OutputForm &form = scene_.outputs[output];
    output_ = output;
    parts_.clear();
    if (form.kind == OutputForm::Kind::reaction)
      add_reaction(form);
    else if (form.kind == OutputForm::Kind::spring)
      for (std::size_t m = 0; m < form.means.size(); ++m)
        add_places({"", {}, form.means[m].boundary}, static_cast<int>(m));
    else if (form.place == OutputForm::Place::point)
      add_point(form);
    else
      add_parts(form);
    return parts_;
  }

private:
  void add(Part part) {
    part.output = output_;
    parts_.push_back(part);
  }

  void add_places(const Form &over, int term) {
    for (const auto &[cell, facet] : places_of(mesh_, over))
      add({.cell = static_cast<int>(cell), .facet = facet, .term = term});
  }

  /// Boundaries or regions may overlap: each cell or facet is there once.
  void add_parts(const OutputForm &form) {
    Form over{"", {}};
    if (form.at.empty()) add_places(over, 0);
    for (const std::string &name : form.at) {
      (form.place == OutputForm::Place::boundary ? over.boundary : over.region) = name;
      add_places(over, 0);
      over.without.push_back(name);
    }
  }

  bool is_in(const std::vector<std::string> &regions, std::size_t cell) const {
    return regions.empty() || std::ranges::any_of(regions, [&](const std::string &region) {
             return mesh_.region.at(region)[cell];
           });
  }

  /// The one of the lowest number of those around it, on all ranks.
  void add_point(const OutputForm &form) {
    const auto corners = static_cast<std::size_t>(mesh_.dim) + 1;
    std::vector<PetscInt> around; // of each its number and its vertices
    for (std::size_t cell = 0; cell < mesh_.cells.size(); ++cell) {
      const auto at = barycentric_of(mesh_.dim, cell_of(mesh_, cell).reference, form.vector);
      if (!is_in(form.at, cell) || !(std::ranges::min(at) > -1e-10)) continue;
      around.push_back(mesh_.natural_cell[cell]);
      for (std::size_t i = 0; i < corners; ++i)
        around.push_back(mesh_.natural_node[static_cast<std::size_t>(nodes_of(mesh_, cell)[i])]);
    }
    around = gather_all(mesh_.comm, around, MPIU_INT);
    const std::string where = "the output '" + form.name + "' is at " + place_text(form.vector);
    if (around.empty())
      throw bad_input(where + ", which no cell of the mesh" +
                      (form.at.empty() ? "" : " in '" + joined(form.at, "', '") + "'") + " has");
    if (!meet(around, corners))
      throw bad_input(where + ", which two bodies have: say which one by a region of it, "
                              "{value: ..., point: [x, y], in: REGION}");
    PetscInt first = mesh_.total_cells;
    for (std::size_t k = 0; k < around.size(); k += corners + 1)
      first = std::min(first, around[k]);
    for (std::size_t cell = 0; cell < mesh_.cells.size(); ++cell)
      if (mesh_.natural_cell[cell] == first) add({.cell = static_cast<int>(cell)});
  }

  /// Whether cells around a point, each a number and its vertices, are of one body: those that are
  /// have one of these in common, with all others or with one beside them.
  static bool meet(const std::vector<PetscInt> &around, std::size_t corners) {
    std::vector<int> cells;
    std::map<PetscInt, int> numbers;
    for (std::size_t k = 0; k < around.size(); ++k)
      if (k % (corners + 1) != 0)
        cells.push_back(
            numbers.try_emplace(around[k], static_cast<int>(numbers.size())).first->second);
    return body_numbers(cells, static_cast<int>(corners), std::ssize(numbers), 0).maxCoeff() == 1;
  }

  /// A bit for each of these nodes that a cell has.
  int held_of(const std::vector<bool> &held, std::size_t cell) const {
    const auto nodes = nodes_of(mesh_, cell);
    int bits = 0;
    for (std::size_t i = 0; i < nodes.size() && nodes[i] >= 0; ++i)
      if (held[static_cast<std::size_t>(nodes[i])]) bits |= 1 << i;
    return bits;
  }

  void add_term(const std::vector<bool> &held, const Form &of, int term) {
    if (!of.kernel) return;
    const auto add_held = [&](std::size_t cell, int facet) {
      if (const int bits = held_of(held, cell); bits != 0)
        add({.cell = static_cast<int>(cell), .facet = facet, .term = term, .held = bits});
    };
    for (const auto &[cell, facet] : places_of(mesh_, of))
      add_held(cell, facet);
  }

  /// What contact number i pushes these nodes with.
  void add_contact(const std::vector<bool> &held, int i) {
    const InterfaceEntities &entities = scene_.contacts[i].entities;
    const bool of_cells = entities.kind == InterfaceEntities::Kind::cells;
    for (const std::string &part : entities.parts)
      for (const auto &[cell, facet] :
           places_of(mesh_, {of_cells ? part : "", {}, of_cells ? "" : part}))
        if (const int bits = held_of(held, cell); bits != 0)
          add({.cell = static_cast<int>(cell), .term = ~i, .held = bits});
  }

  void add_reaction(const OutputForm &form) {
    std::vector<bool> held(mesh_.points.size(), false);
    for (const std::string &boundary : form.at)
      for (std::size_t node = 0; node < held.size(); ++node)
        if (mesh_.boundary.at(boundary)[node]) held[node] = true;
    check_reaction(form, held);
    const std::optional<std::vector<bool>> whole = bodies_held_by(form, held);
    const auto a_terms = static_cast<int>(scene_.a.size());
    for (int q = 0; q < a_terms && !whole; ++q)
      add_term(held, scene_.a[q].form, q);
    if (whole) held = *whole;
    for (int q = 0; q < std::ssize(scene_.f); ++q)
      if (!scene_.f[q].of_imposed && !(whole && scene_.f[q].form.boundary.empty()))
        add_term(held, scene_.f[q].form, a_terms + q);
    for (int i = 0; has_multipliers(scene_) && i < std::ssize(scene_.contacts); ++i)
      add_contact(held, i);
  }

  /// Whether a load on cells may do work on a translation. Those of free strains do none.
  bool works_along(const Term &load, const Point &direction) const {
    if (!load.form.kernel) return false;
    if (!load.theta) return true;
    const auto components = static_cast<std::size_t>(dofs_.components);
    std::vector<double> values(components *
                               static_cast<std::size_t>(nodes_per_cell(mesh_.dim, mesh_.degree)));
    for (const CellFacet &at : places_of(mesh_, load.form)) {
      load.form.kernel({}, cell_of(mesh_, at.cell), values.data());
      double work = 0, terms = 0;
      for (std::size_t i = 0; i < values.size(); ++i) {
        work += direction[i % components] * values[i];
        terms += std::abs(direction[i % components] * values[i]);
      }
      if (std::abs(work) > 1e-12 * terms) return true;
    }
    return false;
  }

  bool moves(std::size_t node, int c) const {
    return dofs_.free[node * static_cast<std::size_t>(dofs_.components) +
                      static_cast<std::size_t>(c)] >= 0;
  }

  /// Boundaries that are pushed along the direction by what no part of the reaction has: means, and
  /// contact without multipliers.
  std::vector<std::string> pushed_otherwise(const OutputForm &form) const {
    std::vector<std::string> boundaries;
    if (!has_multipliers(scene_))
      for (const ContactRecipe &contact : scene_.contacts)
        boundaries.insert(boundaries.end(), contact.entities.parts.begin(),
                          contact.entities.parts.end());
    for (const Sum *sum : {&scene_.a, &scene_.f})
      for (const Term &term : *sum)
        for (const Mean &mean : term.form.means)
          if (dot(mean.direction, form.vector) != 0) boundaries.push_back(mean.boundary);
    return boundaries;
  }

  /// The nodes of the bodies that the boundaries of a reaction alone hold along it, where forces on
  /// them balance: then the reaction is all others on these bodies, whose stresses do not enter.
  /// None where something else holds or pushes them, or loads are on their cells, all of which a
  /// model would have to keep.
  /// Collective.
  std::optional<std::vector<bool>> bodies_held_by(const OutputForm &form,
                                                  const std::vector<bool> &held) const {
    if (dofs_.components == 1 || (scene_.axisymmetric && form.vector[0] != 0)) return std::nullopt;
    std::vector<std::vector<int>> bodies(held.size());
    std::vector<PetscInt> of_reaction(static_cast<std::size_t>(mesh_.bodies), 0), not_alone{0};
    for (std::size_t k = 0; k < mesh_.cells.size(); ++k)
      for (const int node : nodes_of(mesh_, k))
        if (node >= 0) bodies[static_cast<std::size_t>(node)].push_back(mesh_.body[k]);
    const auto visit = [&](const std::vector<bool> &nodes, const auto &at) {
      for (std::size_t node = 0; node < nodes.size(); ++node)
        if (nodes[node])
          for (const int body : bodies[node])
            at(node, static_cast<std::size_t>(body));
    };
    visit(held, [&](std::size_t, std::size_t body) { of_reaction[body] = 1; });
    over_ranks(mesh_.comm, MPI_MAX, of_reaction);
    visit(std::vector<bool>(held.size(), true), [&](std::size_t node, std::size_t body) {
      for (int c = 0; c < dofs_.components; ++c)
        if (of_reaction[body] != 0 && form.vector[c] != 0 && !moves(node, c) && !held[node])
          not_alone[0] = 1;
    });
    for (const std::string &boundary : pushed_otherwise(form))
      visit(mesh_.boundary.at(boundary), [&](std::size_t, std::size_t body) {
        if (of_reaction[body] != 0) not_alone[0] = 1;
      });
    for (const Term &a : scene_.a)
      if (!a.form.boundary.empty()) not_alone[0] = 1;
    for (const Term &load : scene_.f)
      if (!load.of_imposed && load.form.boundary.empty() && works_along(load, form.vector))
        not_alone[0] = 1;
    over_ranks(mesh_.comm, MPI_MAX, not_alone);
    if (not_alone[0] != 0) return std::nullopt;
    std::vector<bool> whole(held.size(), false);
    visit(std::vector<bool>(held.size(), true), [&](std::size_t node, std::size_t body) {
      if (of_reaction[body] != 0) whole[node] = true;
    });
    return whole;
  }

  void check_reaction(const OutputForm &form, const std::vector<bool> &held) const {
    const std::vector<std::string> forces = pushed_otherwise(form);
    std::vector<int> shared(forces.size()), loose{0};
    for (std::size_t node = 0; node < held.size(); ++node) {
      if (!held[node]) continue;
      for (int c = 0; c < dofs_.components; ++c)
        if (form.vector[c] != 0 && moves(node, c)) loose[0] = 1;
      for (std::size_t i = 0; i < forces.size(); ++i)
        if (mesh_.boundary.at(forces[i])[node]) shared[i] = 1;
    }
    over_ranks(mesh_.comm, MPI_MAX, shared);
    over_ranks(mesh_.comm, MPI_MAX, loose);
    const std::string where = "the reaction '" + form.name + "' is of " + joined(form.at);
    if (loose[0] != 0)
      throw bad_input(where + ", which is not held in its direction: impose a displacement there");
    for (std::size_t i = 0; i < forces.size(); ++i)
      if (shared[i] != 0)
        throw bad_input(where + ", which shares nodes with '" + forces[i] +
                        "': what that pushes them with is not known apart");
  }

  const Scene &scene_;
  const Mesh &mesh_;
  const Dofs &dofs_;
  int output_ = 0;
  std::vector<Part> parts_;
};

/// What is told of a cell to the other ranks.
struct CellTable {
  std::vector<PetscInt> numbers; ///< per cell: natural number, material, nodes, imposed_by of dofs
  std::vector<double> points;    ///< per cell: its nodes' coordinates
};

void tell(const Mesh &mesh, const Dofs &dofs, std::size_t cell, int material, CellTable &table) {
  table.numbers.push_back(mesh.natural_cell[cell]);
  table.numbers.push_back(material);
  const auto nodes = nodes_of(mesh, cell);
  const int count = nodes_per_cell(mesh.dim, mesh.degree);
  for (int i = 0; i < count; ++i) {
    table.numbers.push_back(mesh.natural_node[static_cast<std::size_t>(nodes[i])]);
    const Point &x = mesh.points[static_cast<std::size_t>(nodes[i])];
    table.points.insert(table.points.end(), x.begin(), x.begin() + mesh.dim);
  }
  for (int i = 0; i < count * dofs.components; ++i)
    table.numbers.push_back(
        dofs.imposed_by.empty()
            ? -1
            : dofs.imposed_by[static_cast<std::size_t>(
                  nodes[i / dofs.components] * dofs.components + i % dofs.components)]);
}

/// Cells and nodes by their natural numbers; the position of each cell.
std::map<PetscInt, int> put_cells(const CellTable &table, const Mesh &mesh, const Dofs &dofs,
                                  OutputCells &result) {
  const int count = nodes_per_cell(mesh.dim, mesh.degree), components = dofs.components;
  const auto stride = static_cast<std::size_t>(2 + count * (1 + components));
  std::map<PetscInt, std::size_t> rows;
  std::map<PetscInt, int> nodes, cells;
  for (std::size_t row = 0; row * stride < table.numbers.size(); ++row) {
    rows[table.numbers[row * stride]] = row;
    for (int i = 0; i < count; ++i)
      nodes[table.numbers[row * stride + 2 + static_cast<std::size_t>(i)]] = 0;
  }
  for (auto &[natural, position] : nodes) {
    position = static_cast<int>(result.nodes.size());
    result.nodes.push_back(static_cast<int>(natural));
  }
  result.points.resize(std::ssize(nodes), mesh.dim);
  result.imposed_by.assign(nodes.size() * static_cast<std::size_t>(components), -1);
  for (const auto &[natural, row] : rows) {
    const PetscInt *numbers = table.numbers.data() + row * stride;
    cells[natural] = static_cast<int>(cells.size());
    result.materials.push_back(static_cast<int>(numbers[1]));
    for (int i = 0; i < count; ++i) {
      const int node = nodes.at(numbers[2 + i]);
      result.cells.push_back(node);
      for (int k = 0; k < mesh.dim; ++k)
        result.points(node, k) =
            table.points[(row * static_cast<std::size_t>(count) + static_cast<std::size_t>(i)) *
                             static_cast<std::size_t>(mesh.dim) +
                         static_cast<std::size_t>(k)];
      for (int c = 0; c < components; ++c)
        result.imposed_by[static_cast<std::size_t>(node * components + c)] =
            static_cast<int>(numbers[2 + count + i * components + c]);
    }
  }
  return cells;
}

} // namespace

OutputCells cells_of_outputs(const Scene &scene, const Mesh &mesh, const Dofs &dofs) {
  OutputCells result;
  if (std::ranges::none_of(scene.outputs, has_cells)) return result;
  const std::vector<int> materials = materials_of_cells(scene, mesh);
  OwnParts own(scene, mesh, dofs);
  CellTable table;
  std::vector<bool> told(mesh.cells.size());
  std::vector<PetscInt> rows;
  for (std::size_t k = 0; k < scene.outputs.size(); ++k) {
    if (!has_cells(scene.outputs[k])) continue;
    for (const Part &part : own.of(static_cast<int>(k))) {
      const auto cell = static_cast<std::size_t>(part.cell);
      if (!told[cell]) tell(mesh, dofs, cell, materials.empty() ? 0 : materials[cell], table);
      told[cell] = true;
      for (const PetscInt number : {PetscInt{part.output}, mesh.natural_cell[cell],
                                    PetscInt{part.facet}, PetscInt{part.term}, PetscInt{part.held}})
        rows.push_back(number);
    }
  }
  table = {gather_all(mesh.comm, table.numbers, MPIU_INT),
           gather_all(mesh.comm, table.points, MPI_DOUBLE)};
  rows = gather_all(mesh.comm, rows, MPIU_INT);
  const std::map<PetscInt, int> cells = put_cells(table, mesh, dofs, result);
  if (dofs.imposed_by.empty()) result.imposed_by.clear();
  if (materials.empty()) result.materials.clear();
  for (std::size_t r = 0; r < rows.size(); r += 5)
    result.parts.push_back({int(rows[r]), cells.at(rows[r + 1]), int(rows[r + 2]), int(rows[r + 3]),
                            int(rows[r + 4])});
  std::ranges::sort(result.parts, {}, [](const Part &part) {
    return std::tuple(part.output, part.cell, part.facet, part.term);
  });
  return result;
}

} // namespace rbvi
