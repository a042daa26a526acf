#include "rbvi/fem/dofs.hpp"

#include "rbvi/core/error.hpp"
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

} // namespace

Dofs number_dofs(const Mesh &mesh, int components, const std::vector<FixedBoundary> &fixed) {
  Dofs dofs;
  dofs.comm = mesh.comm;
  dofs.components = components;
  dofs.total = mesh.total_nodes * components;
  const std::vector<bool> is_fixed = fixed_components(mesh, components, fixed);
  dofs.imposed_by = imposing_boundaries(mesh, components, fixed);
  const std::size_t nodes = mesh.points.size(), count = static_cast<std::size_t>(components);

  PetscInt owned = 0;
  for (std::size_t i = 0; i < is_fixed.size(); ++i)
    if (mesh.owned_node[i / count] && !is_fixed[i]) ++owned;
  MPI_Exscan(&owned, &dofs.first_free, 1, MPIU_INT, MPI_SUM, mesh.comm);
  MPI_Allreduce(&owned, &dofs.total_free, 1, MPIU_INT, MPI_SUM, mesh.comm);

  std::vector<PetscInt> first_row(nodes, -1);
  PetscInt next = dofs.first_free;
  for (std::size_t v = 0; v < nodes; ++v) {
    if (!mesh.owned_node[v]) continue;
    first_row[v] = next;
    for (std::size_t c = 0; c < count; ++c) {
      if (is_fixed[v * count + c]) continue;
      dofs.natural_owned.push_back(mesh.natural_node[v] * components + static_cast<PetscInt>(c));
      ++next;
    }
  }
  share_with_ghosts(mesh, first_row);

  for (std::size_t v = 0; v < nodes; ++v) {
    PetscInt row = first_row[v];
    for (std::size_t c = 0; c < count; ++c)
      dofs.free.push_back(is_fixed[v * count + c] ? -1 : row++);
  }
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
