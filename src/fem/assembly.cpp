#include "rbvi/fem/assembly.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/element/geometry.hpp"
#include "rbvi/par/collective.hpp"

namespace rbvi {

namespace {

bool in_region(const Mesh &mesh, const std::string &region, std::size_t cell) {
  return region.empty() || mesh.region.at(region)[cell];
}

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

} // namespace

MappedCells reference_cells(const Mesh &mesh) {
  MappedCells result;
  for (const auto &vertices : mesh.cells) {
    Cell cell{mesh.dim, {}, {}};
    for (std::size_t i = 0; i <= static_cast<std::size_t>(mesh.dim); ++i)
      cell.reference[i] = mesh.points[static_cast<std::size_t>(vertices[i])];
    cell.mapped = cell.reference;
    result.cells.push_back(cell);
  }
  return result;
}

void map_cells(const Scene &scene, const FullMu &mu, const Mesh &mesh, MappedCells &cells) {
  collectively(mesh.comm, [&] {
    std::vector<Point> mapped;
    mapped.reserve(mesh.points.size());
    for (std::size_t v = 0; v < mesh.points.size() && mesh.natural_node[v] < mesh.total_vertices;
         ++v)
      mapped.push_back(scene.map(mu, mesh.points[v]));
    for (std::size_t i = 0; i < cells.cells.size(); ++i) {
      Cell &cell = cells.cells[i];
      for (std::size_t j = 0; j <= static_cast<std::size_t>(mesh.dim); ++j)
        cell.mapped[j] = mapped[static_cast<std::size_t>(mesh.cells[i][j])];
      check_orientation(scene, mu, cell);
    }
  });
}

Handle<Mat> make_matrix(const Mesh &mesh, const Dofs &dofs, const std::string &region) {
  const auto owned = static_cast<PetscInt>(dofs.natural_owned.size());
  Handle<Mat> matrix;
  RBVI_CALL(MatCreate(dofs.comm, matrix.put()));
  RBVI_CALL(MatSetSizes(matrix.get(), owned, owned, dofs.total_free, dofs.total_free));
  RBVI_CALL(MatSetType(matrix.get(), MATAIJ));
  std::vector<PetscInt> rows, columns;
  CellRows cell{};
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    if (!in_region(mesh, region, k)) continue;
    const std::size_t count = cell_rows(mesh, dofs, k, cell);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < count; ++j) {
        rows.push_back(cell[i]);
        columns.push_back(cell[j]);
      }
  }
  RBVI_CALL(MatSetPreallocationCOO(matrix.get(), static_cast<PetscCount>(rows.size()), rows.data(),
                                   columns.data()));
  RBVI_CALL(MatSetOption(matrix.get(), MAT_SYMMETRIC, PETSC_TRUE));
  RBVI_CALL(MatSetOption(matrix.get(), MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
  RBVI_CALL(MatSetOption(matrix.get(), MAT_SPD, PETSC_TRUE));
  return matrix;
}

void assemble_matrix(const Form &form, const FullMu &mu, const Mesh &mesh, const Dofs &dofs,
                     const MappedCells &cells, Mat matrix) {
  const auto count =
      static_cast<std::size_t>(nodes_per_cell(mesh.dim, mesh.degree) * dofs.components);
  std::vector<PetscScalar> values;
  values.reserve(mesh.cells.size() * count * count);
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    if (!in_region(mesh, form.region, k)) continue;
    values.resize(values.size() + count * count);
    form.kernel(mu, cells.cells[k], values.data() + values.size() - count * count);
  }
  RBVI_CALL(MatSetValuesCOO(matrix, values.data(), INSERT_VALUES));
}

void assemble_vector(const Form &form, const FullMu &mu, const Mesh &mesh, const Dofs &dofs,
                     const MappedCells &cells, Vec vector) {
  RBVI_CALL(VecZeroEntries(vector));
  RBVI_CALL(VecSetOption(vector, VEC_IGNORE_NEGATIVE_INDICES, PETSC_TRUE));
  CellRows rows{};
  std::array<double, std::size_t{3} * most_nodes> values{};
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    if (!in_region(mesh, form.region, k)) continue;
    const std::size_t count = cell_rows(mesh, dofs, k, rows);
    form.kernel(mu, cells.cells[k], values.data());
    RBVI_CALL(
        VecSetValues(vector, static_cast<PetscInt>(count), rows.data(), values.data(), ADD_VALUES));
  }
  RBVI_CALL(VecAssemblyBegin(vector));
  RBVI_CALL(VecAssemblyEnd(vector));
}

} // namespace rbvi
