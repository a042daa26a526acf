#include "rbvi/fem/assembly.hpp"

#include "means.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/formula.hpp"
#include "rbvi/element/facets.hpp"
#include "rbvi/par/collective.hpp"

#include <algorithm>
#include <numeric>
#include <set>

namespace rbvi {

namespace {

using CellRows = std::array<PetscInt, std::size_t{3} * most_nodes>;

/// Rows of the free dofs of one cell, -1 where fixed; returns how many dofs the cell has.
std::size_t cell_rows(const Mesh &mesh, const Dofs &dofs, std::size_t cell, CellRows &rows) {
  std::size_t count = 0;
  const auto components = static_cast<std::size_t>(dofs.components);
  const auto nodes = nodes_of(mesh, cell);
  for (std::size_t i = 0; i < nodes.size() && nodes[i] >= 0; ++i)
    for (std::size_t c = 0; c < components; ++c)
      rows[count++] = dofs.free[static_cast<std::size_t>(nodes[i]) * components + c];
  return count;
}

/// Calls visit(coupling, i) for the rows of all couplings that this rank owns.
template <class Visit> void visit_couplings(const Dofs &dofs, Visit &&visit) {
  const PetscInt end = dofs.first_free + static_cast<PetscInt>(dofs.natural_owned.size());
  for (const Coupling &coupling : dofs.couplings)
    for (std::size_t i = 0; i < coupling.rows.size(); ++i)
      if (coupling.rows[i] >= dofs.first_free && coupling.rows[i] < end) visit(coupling, i);
}

} // namespace

std::vector<int> imposed_on(const Mesh &mesh, const Dofs &dofs, std::size_t cell,
                            const std::vector<int> &local) {
  if (dofs.imposed_by.empty()) return {};
  const auto nodes = nodes_of(mesh, cell);
  std::vector<int> result;
  for (const int i : local) {
    const auto node = static_cast<std::size_t>(nodes[i / dofs.components]);
    result.push_back(dofs.imposed_by[node * static_cast<std::size_t>(dofs.components) +
                                     static_cast<std::size_t>(i % dofs.components)]);
  }
  if (std::ranges::all_of(result, [](int boundary) { return boundary < 0; })) result.clear();
  return result;
}

Cell cell_of(const Mesh &mesh, std::size_t cell, const MappedVertices &mapped) {
  Cell result{mesh.dim, {}, {}};
  const std::vector<Point> &moved = mapped.empty() ? mesh.points : mapped;
  for (int i = 0; i <= mesh.dim; ++i) {
    const auto vertex = static_cast<std::size_t>(mesh.cells[cell][i]);
    result.reference[i] = mesh.points[vertex];
    result.mapped[i] = moved[vertex];
  }
  return result;
}

MappedVertices map_vertices(const Scene &scene, const FullMu &mu, const Mesh &mesh) {
  MappedVertices mapped;
  collectively(mesh.comm, [&] {
    std::vector<Point> vertices;
    for (std::size_t v = 0; v < mesh.points.size() && mesh.natural_node[v] < mesh.total_vertices;
         ++v)
      vertices.push_back(mesh.points[v]);
    mapped = images(scene.map, mu, vertices);
    for (std::size_t v = 0; scene.axisymmetric && v < mapped.size(); ++v)
      if (const bool on = mesh.boundary.at(axis_of_turning)[v];
          on != !(mapped[v][0] > 1e-12 * norm(mapped[v])))
        throw failure("the map takes a point " + std::string(on ? "off" : "to or beyond") +
                      " the axis x = 0 at " + describe(scene.parameters, mu) +
                      ": it must leave the axis where it is");
    for (std::size_t k = 0; k < mesh.cells.size(); ++k)
      check_orientation(scene, mu, cell_of(mesh, k, mapped));
  });
  return mapped;
}

std::vector<WeightedForm> forms_of(const Sum &sum) {
  std::vector<WeightedForm> forms;
  for (const Term &term : sum)
    forms.push_back({&term.form});
  return forms;
}

Handle<Mat> make_matrix(const Mesh &mesh, const Dofs &dofs) {
  const auto owned = static_cast<PetscInt>(dofs.natural_owned.size());
  Handle<Mat> matrix;
  RBVI_CALL(MatCreate(dofs.comm, matrix.put()));
  RBVI_CALL(MatSetSizes(matrix.get(), owned, owned, dofs.total_free, dofs.total_free));
  RBVI_CALL(MatSetType(matrix.get(), MATAIJ));
  std::vector<PetscInt> rows, columns;
  CellRows cell{};
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    const std::size_t count = cell_rows(mesh, dofs, k, cell);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < count; ++j) {
        rows.push_back(cell[i]);
        columns.push_back(cell[j]);
      }
  }
  visit_couplings(dofs, [&](const Coupling &coupling, std::size_t i) {
    rows.insert(rows.end(), coupling.rows.size(), coupling.rows[i]);
    columns.insert(columns.end(), coupling.rows.begin(), coupling.rows.end());
  });
  RBVI_CALL(MatSetPreallocationCOO(matrix.get(), static_cast<PetscCount>(rows.size()), rows.data(),
                                   columns.data()));
  RBVI_CALL(MatSetOption(matrix.get(), MAT_SYMMETRIC, PETSC_TRUE));
  RBVI_CALL(MatSetOption(matrix.get(), MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
  RBVI_CALL(MatSetOption(matrix.get(), MAT_SPD, PETSC_TRUE));
  return matrix;
}

namespace {

/// The dofs of some nodes of a cell.
std::vector<int> local_dofs(const std::vector<int> &nodes, int components) {
  std::vector<int> local;
  for (const int node : nodes)
    for (int c = 0; c < components; ++c)
      local.push_back(node * components + c);
  return local;
}

/// Calls visitor(cell number, local dofs of the cell, values of the kernel) for each cell or facet
/// of a form: the values belong to these dofs alone.
template <class Visitor>
void visit_values(const Form &form, const FullMu &mu, const Mesh &mesh, const Dofs &dofs,
                  const MappedVertices &mapped, Visitor &&visitor) {
  std::array<double, CellRows{}.size() * CellRows{}.size()> values;
  const auto visit = [&](const Cell &cell, std::size_t number, const std::vector<int> &local) {
    const std::vector<int> imposed_by = imposed_on(mesh, dofs, number, local);
    if (imposed_by.empty()) {
      form.kernel(mu, cell, values.data());
    } else {
      Cell with_values = cell;
      with_values.imposed_by = imposed_by.data();
      form.kernel(mu, with_values, values.data());
    }
    visitor(number, local, values.data());
  };
  std::vector<int> all(
      static_cast<std::size_t>(nodes_per_cell(mesh.dim, mesh.degree) * dofs.components));
  std::iota(all.begin(), all.end(), 0);
  for (const auto &[cell, facet] : places_of(mesh, form))
    if (facet < 0)
      visit(cell_of(mesh, cell, mapped), cell, all);
    else
      visit(facet_cell(cell_of(mesh, cell, mapped), facet), cell,
            local_dofs(facet_nodes(mesh.dim, mesh.degree, facet), dofs.components));
}

} // namespace

std::vector<CellFacet> places_of(const Mesh &mesh, const Form &form) {
  const bool on_facets = !form.boundary.empty();
  const auto all_of = [&](const std::string &name) {
    if (on_facets && !name.empty()) return mesh.facets.at(name);
    std::vector<CellFacet> cells;
    for (std::size_t k = 0; k < mesh.cells.size(); ++k)
      if (name.empty() || mesh.region.at(name)[k]) cells.push_back({k, -1});
    return cells;
  };
  std::set<std::pair<std::size_t, int>> others;
  for (const std::string &name : form.without)
    for (const auto &[cell, facet] : all_of(name))
      others.emplace(cell, facet);
  std::vector<CellFacet> places = all_of(on_facets ? form.boundary : form.region);
  std::erase_if(places, [&](const CellFacet &at) { return others.contains({at.cell, at.facet}); });
  return places;
}

void assemble(const std::vector<WeightedForm> &forms, const FullMu &mu, const Mesh &mesh,
              const Dofs &dofs, const MappedVertices &mapped, Mat matrix) {
  const auto count =
      static_cast<std::size_t>(nodes_per_cell(mesh.dim, mesh.degree) * dofs.components);
  std::vector<PetscScalar> all(mesh.cells.size() * count * count, 0);
  visit_couplings(dofs, [&](const Coupling &coupling, std::size_t i) {
    double weight = 0;
    for (const WeightedForm &weighted : forms)
      if (are_same(weighted.form->means, coupling.means))
        weight += weighted.weight * coupling.values[i];
    for (const double value : coupling.values)
      all.push_back(weight * value);
  });
  for (const WeightedForm &weighted : forms)
    if (weighted.form->means.empty())
      visit_values(*weighted.form, mu, mesh, dofs, mapped,
                   [&](std::size_t cell, const std::vector<int> &local, const double *values) {
                     double *block = all.data() + cell * count * count;
                     for (const int i : local)
                       for (const int j : local)
                         block[static_cast<std::size_t>(i) * count + static_cast<std::size_t>(j)] +=
                             weighted.weight * *values++;
                   });
  RBVI_CALL(MatSetValuesCOO(matrix, all.data(), INSERT_VALUES));
}

LoadSums assemble(const std::vector<WeightedForm> &forms, const FullMu &mu, const Mesh &mesh,
                  const Dofs &dofs, const MappedVertices &mapped, Vec vector) {
  LoadSums sums;
  RBVI_CALL(VecZeroEntries(vector));
  RBVI_CALL(VecSetOption(vector, VEC_IGNORE_NEGATIVE_INDICES, PETSC_TRUE));
  CellRows rows{};
  for (const WeightedForm &weighted : forms) {
    if (!weighted.form->means.empty()) {
      const Vector of_means = mean_functional(weighted.form->means, mesh, dofs);
      for (Index i = 0; i < of_means.size(); ++i)
        if (of_means[i] != 0)
          RBVI_CALL(VecSetValue(vector, dofs.free[i], weighted.weight * of_means[i], ADD_VALUES));
      continue;
    }
    visit_values(*weighted.form, mu, mesh, dofs, mapped,
                 [&](std::size_t cell, const std::vector<int> &local, const double *values) {
                   cell_rows(mesh, dofs, cell, rows);
                   for (const int i : local) {
                     const double value = weighted.weight * *values++;
                     RBVI_CALL(VecSetValue(vector, rows[i], value, ADD_VALUES));
                     if (!weighted.of_imposed)
                       sums = sums + LoadSums{value, rows[i] < 0 ? value : 0, std::abs(value)};
                   }
                 });
  }
  RBVI_CALL(VecAssemblyBegin(vector));
  RBVI_CALL(VecAssemblyEnd(vector));
  return sums;
}

double integral(const std::vector<WeightedForm> &forms, const FullMu &mu, const Mesh &mesh,
                const Dofs &dofs, const MappedVertices &mapped) {
  double sum = 0;
  for (const WeightedForm &weighted : forms)
    visit_values(*weighted.form, mu, mesh, dofs, mapped,
                 [&](std::size_t, const std::vector<int> &, const double *values) {
                   sum += weighted.weight * *values;
                 });
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, mesh.comm);
  return sum;
}

Vector product_with(const std::vector<WeightedForm> &forms, const FullMu &mu, const Mesh &mesh,
                    const Dofs &dofs, const MappedVertices &mapped, const Vector &field) {
  Vector result = Vector::Zero(field.size());
  for (const WeightedForm &weighted : forms)
    visit_values(
        *weighted.form, mu, mesh, dofs, mapped,
        [&](std::size_t cell, const std::vector<int> &local, const double *values) {
          const auto nodes = nodes_of(mesh, cell);
          std::vector<Index> at;
          for (const int i : local)
            at.push_back(Index{nodes[i / dofs.components]} * dofs.components + i % dofs.components);
          const Vector in = field(at);
          for (const Index i : at) {
            result[i] += weighted.weight * in.dot(Eigen::Map<const Vector>(values, in.size()));
            values += in.size();
          }
        });
  return result;
}

} // namespace rbvi
