#include "rbvi/fem/dofs.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/columns.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// Fills the entries of nodes owned by other ranks with their owners' values.
void share_with_ghosts(const Mesh &mesh, std::vector<PetscInt> &first_row) {
  if (ranks_of(mesh.comm) == 1) return;
  PetscInt begin = 0, end = 0;
  RBVI_CALL(DMPlexGetChart(mesh.dm.get(), &begin, &end));
  std::vector<PetscInt> by_point(end, -1);
  for (std::size_t v = 0; v < first_row.size(); ++v)
    by_point[mesh.dm_point[v]] = first_row[v];
  PetscSF sf = nullptr;
  RBVI_CALL(DMGetPointSF(mesh.dm.get(), &sf));
  const std::vector<PetscInt> roots = by_point;
  RBVI_CALL(PetscSFBcastBegin(sf, MPIU_INT, roots.data(), by_point.data(), MPI_REPLACE));
  RBVI_CALL(PetscSFBcastEnd(sf, MPIU_INT, roots.data(), by_point.data(), MPI_REPLACE));
  for (std::size_t v = 0; v < first_row.size(); ++v)
    first_row[v] = by_point[mesh.dm_point[v]];
}

/// Per local node * components + component.
std::vector<bool> fixed_components(const Mesh &mesh, int components,
                                   const std::vector<FixedBoundary> &fixed) {
  const auto count = static_cast<std::size_t>(components);
  std::vector<bool> result(mesh.points.size() * count, false);
  for (const FixedBoundary &part : fixed) {
    const std::vector<bool> &on_boundary = mesh.boundary.at(part.name);
    for (std::size_t c = 0; c < count; ++c) {
      const auto &list = part.components;
      if (!list.empty() && std::find(list.begin(), list.end(), static_cast<int>(c)) == list.end())
        continue;
      for (std::size_t v = 0; v < mesh.points.size(); ++v)
        if (on_boundary[v]) result[v * count + c] = true;
    }
    for (const int c : part.components)
      if (c < 0 || c >= components)
        throw bad_input("boundary " + part.name + " fixes component " + std::to_string(c) +
                        " of a displacement of " + std::to_string(components));
  }
  return result;
}

/// Dofs::imposed_by: where boundaries meet the first one that imposes values.
std::vector<int> imposing_boundaries(const Mesh &mesh, int components,
                                     const std::vector<FixedBoundary> &fixed) {
  if (std::ranges::all_of(fixed, [](const FixedBoundary &part) { return part.values.empty(); }))
    return {};
  const auto count = static_cast<std::size_t>(components);
  std::vector<int> result(mesh.points.size() * count, -1);
  for (std::size_t b = 0; b < fixed.size(); ++b) {
    if (fixed[b].values.empty()) continue;
    const std::vector<bool> own = fixed_components(mesh, components, {fixed[b]});
    for (std::size_t i = 0; i < own.size(); ++i)
      if (own[i] && result[i] < 0) result[i] = static_cast<int>(b);
  }
  return result;
}

/// Dofs::tied. `is_fixed`: per local node * components + component. Collective.
std::map<PetscInt, PetscInt> tied_dofs(const Mesh &mesh, int components,
                                       const std::vector<bool> &is_fixed,
                                       const std::vector<TiedBoundary> &tied) {
  std::map<PetscInt, PetscInt> all;
  for (const TiedBoundary &part : tied) {
    std::vector<PetscInt> numbers;
    collectively(mesh.comm, [&] {
      for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        if (!mesh.boundary.at(part.name)[v]) continue;
        numbers.push_back(mesh.natural_node[v] * components + part.component);
        const std::size_t dof = v * static_cast<std::size_t>(components);
        if (is_fixed[dof + static_cast<std::size_t>(part.component)] ||
            all.contains(numbers.back()))
          throw bad_input("the boundary '" + part.name + "' moves as one along " +
                          "xyz"[part.component] + ", but at (" + short_number(mesh.points[v][0]) +
                          ", " + short_number(mesh.points[v][1]) +
                          ") that displacement is given, or another boundary's");
      }
    });
    numbers = gather_all(mesh.comm, numbers, MPIU_INT);
    for (const PetscInt number : numbers)
      all[number] = *std::ranges::min_element(numbers);
  }
  return all;
}

/// Of the ranks that own them. Collective.
void share_tied_rows(const Mesh &mesh, Dofs &dofs) {
  std::map<PetscInt, std::size_t> place; // of the numbers that have the rows
  for (const auto &[number, with_row] : dofs.tied)
    place.emplace(with_row, place.size());
  if (place.empty()) return;
  std::vector<PetscInt> rows(place.size(), -1);
  for (std::size_t k = 0; k < dofs.natural_owned.size(); ++k)
    if (const auto found = place.find(dofs.natural_owned[k]); found != place.end())
      rows[found->second] = dofs.first_free + static_cast<PetscInt>(k);
  over_ranks(mesh.comm, MPI_MAX, rows);
  const auto count = static_cast<std::size_t>(dofs.components);
  for (std::size_t i = 0; i < dofs.free.size(); ++i)
    if (const auto found = place.find(dofs.natural(mesh, i / count, static_cast<int>(i % count)));
        found != place.end())
      dofs.free[i] = rows[found->second];
}

} // namespace

Dofs number_dofs(const Mesh &mesh, int components, const std::vector<FixedBoundary> &fixed,
                 const std::vector<TiedBoundary> &tied) {
  Dofs dofs;
  dofs.comm = mesh.comm;
  dofs.components = components;
  dofs.total = mesh.total_nodes * components;
  const std::vector<bool> is_fixed = fixed_components(mesh, components, fixed);
  dofs.imposed_by = imposing_boundaries(mesh, components, fixed);
  dofs.tied = tied_dofs(mesh, components, is_fixed, tied);
  std::erase_if(dofs.tied, [](const auto &pair) { return pair.first == pair.second; });
  const std::size_t nodes = mesh.points.size(), count = static_cast<std::size_t>(components);
  std::vector<bool> has_row;
  for (std::size_t i = 0; i < is_fixed.size(); ++i)
    has_row.push_back(!is_fixed[i] &&
                      !dofs.tied.contains(mesh.natural_node[i / count] * components +
                                          static_cast<PetscInt>(i % count)));

  PetscInt owned = 0;
  for (std::size_t i = 0; i < is_fixed.size(); ++i)
    if (mesh.owned_node[i / count] && has_row[i]) ++owned;
  MPI_Exscan(&owned, &dofs.first_free, 1, MPIU_INT, MPI_SUM, mesh.comm);
  MPI_Allreduce(&owned, &dofs.total_free, 1, MPIU_INT, MPI_SUM, mesh.comm);

  std::vector<PetscInt> first_row(nodes, -1);
  PetscInt next = dofs.first_free;
  for (std::size_t v = 0; v < nodes; ++v) {
    if (!mesh.owned_node[v]) continue;
    first_row[v] = next;
    for (std::size_t c = 0; c < count; ++c) {
      if (!has_row[v * count + c]) continue;
      dofs.natural_owned.push_back(mesh.natural_node[v] * components + static_cast<PetscInt>(c));
      ++next;
    }
  }
  share_with_ghosts(mesh, first_row);

  for (std::size_t v = 0; v < nodes; ++v) {
    PetscInt row = first_row[v];
    for (std::size_t c = 0; c < count; ++c)
      dofs.free.push_back(has_row[v * count + c] ? row++ : -1);
  }
  share_tied_rows(mesh, dofs);
  return dofs;
}

Handle<Vec> make_vector(const Dofs &dofs) {
  Handle<Vec> vector;
  RBVI_CALL(VecCreate(dofs.comm, vector.put()));
  RBVI_CALL(
      VecSetSizes(vector.get(), static_cast<PetscInt>(dofs.natural_owned.size()), dofs.total_free));
  RBVI_CALL(VecSetType(vector.get(), VECSTANDARD));
  RBVI_CALL(VecZeroEntries(vector.get()));
  return vector;
}

Vector to_natural(const Dofs &dofs, Vec free) {
  Vector natural = Vector::Zero(dofs.total);
  natural(dofs.natural_owned) = local_values(free);
  over_ranks(dofs.comm, MPI_SUM, natural);
  for (const auto &[number, with_row] : dofs.tied)
    natural[number] = natural[with_row];
  return natural;
}

Handle<Vec> from_natural(const Dofs &dofs, const Vector &natural) {
  Handle<Vec> vector = make_vector(dofs);
  PetscScalar *values = nullptr;
  RBVI_CALL(VecGetArrayWrite(vector.get(), &values));
  for (std::size_t i = 0; i < dofs.natural_owned.size(); ++i)
    values[i] = natural[dofs.natural_owned[i]];
  RBVI_CALL(VecRestoreArrayWrite(vector.get(), &values));
  return vector;
}

} // namespace rbvi
