#include "rbvi/fem/contact_region.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/element/geometry.hpp"
#include "rbvi/par/gather.hpp"

#include <algorithm>
#include <map>
#include <numeric>

namespace rbvi {

namespace {

/// Everybody's cells of the region as records: cell, its vertices (natural), fixed flags,
/// coordinates.
struct Gathered {
  std::vector<PetscInt> numbers; ///< 1 + (dim + 1) per cell
  std::vector<double> points;    ///< (dim + 1) * 3 per cell
  std::vector<PetscInt> fixed;   ///< dim + 1 per cell
};

Gathered gather_cells(const Mesh &mesh, const Dofs &dofs, const std::vector<bool> &in_region) {
  Gathered mine;
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    if (!in_region[k]) continue;
    mine.numbers.push_back(mesh.natural_cell[k]);
    for (std::size_t i = 0; i <= static_cast<std::size_t>(mesh.dim); ++i) {
      const auto v = static_cast<std::size_t>(mesh.cells[k][i]);
      mine.numbers.push_back(mesh.natural_node[v]);
      mine.points.insert(mine.points.end(), mesh.points[v].begin(), mesh.points[v].end());
      mine.fixed.push_back(dofs.free[v * static_cast<std::size_t>(dofs.components)] < 0);
    }
  }
  return {gather_all(mesh.comm, mine.numbers, MPIU_INT),
          gather_all(mesh.comm, mine.points, MPI_DOUBLE),
          gather_all(mesh.comm, mine.fixed, MPIU_INT)};
}

} // namespace

ContactRegion make_contact_region(const Mesh &mesh, const Dofs &dofs, const std::string &name) {
  const Gathered all = gather_cells(mesh, dofs, mesh.region.at(name));
  const std::size_t corners = static_cast<std::size_t>(mesh.dim) + 1;
  const std::size_t count = all.numbers.size() / (corners + 1);
  if (count == 0) throw bad_input("the mesh has no cell in region '" + name + "'");

  ContactRegion region;
  region.dim = mesh.dim;
  region.components = dofs.components;
  std::map<PetscInt, std::pair<Point, bool>> vertices; // natural number -> coordinates, fixed
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t i = 0; i < corners; ++i) {
      const double *x = all.points.data() + (k * corners + i) * 3;
      vertices[all.numbers[k * (corners + 1) + 1 + i]] = {{x[0], x[1], x[2]},
                                                          all.fixed[k * corners + i] != 0};
    }
  std::map<PetscInt, int> dual_of;
  std::vector<PetscInt> natural_dofs;
  for (const auto &[number, vertex] : vertices) {
    dual_of[number] = static_cast<int>(region.points.size());
    region.natural_node.push_back(number);
    region.points.push_back(vertex.first);
    for (int c = 0; c < region.components; ++c) {
      region.contact_dof.push_back(vertex.second ? -1 : static_cast<int>(natural_dofs.size()));
      if (!vertex.second) natural_dofs.push_back(number * region.components + c);
    }
  }

  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return all.numbers[i * (corners + 1)] < all.numbers[j * (corners + 1)];
  });
  for (const std::size_t k : order) {
    std::array<int, 4> cell{};
    for (std::size_t i = 0; i < corners; ++i)
      cell[i] = dual_of.at(all.numbers[k * (corners + 1) + 1 + i]);
    region.cells.push_back(cell);
  }
  region.trace = make_trace(dofs, natural_dofs);
  return region;
}

std::vector<int> flat_cells(const ContactRegion &region) {
  std::vector<int> flat;
  for (const auto &cell : region.cells)
    flat.insert(flat.end(), cell.begin(), cell.begin() + region.dim + 1);
  return flat;
}

std::vector<Cell> mapped_contact_cells(const ContactRegion &region, const Scene &scene,
                                       const FullMu &mu) {
  std::vector<Point> mapped;
  mapped.reserve(region.points.size());
  for (const Point &x : region.points)
    mapped.push_back(scene.map(mu, x));
  std::vector<Cell> cells;
  cells.reserve(region.cells.size());
  for (const auto &vertices : region.cells) {
    Cell cell{region.dim, {}, {}};
    for (std::size_t i = 0; i <= static_cast<std::size_t>(region.dim); ++i) {
      cell.reference[i] = region.points[static_cast<std::size_t>(vertices[i])];
      cell.mapped[i] = mapped[static_cast<std::size_t>(vertices[i])];
    }
    check_orientation(scene, mu, cell);
    cells.push_back(cell);
  }
  return cells;
}

ContactMatrix::ContactMatrix(const ContactRegion &region, Columns columns) {
  const std::size_t corners = static_cast<std::size_t>(region.dim) + 1;
  const bool dual = columns == Columns::dual_dofs;
  const auto components = static_cast<std::size_t>(dual ? 1 : region.components);
  per_cell_ = corners * corners * components;
  std::vector<std::pair<int, int>> entries;
  for (const auto &cell : region.cells)
    for (std::size_t i = 0; i < corners; ++i)
      for (std::size_t j = 0; j < corners; ++j)
        for (std::size_t c = 0; c < components; ++c) {
          const auto vertex = static_cast<std::size_t>(cell[j]);
          entries.emplace_back(cell[i],
                               dual ? cell[j] : region.contact_dof[vertex * components + c]);
        }
  std::vector<Eigen::Triplet<double>> triplets;
  for (const auto &[row, column] : entries)
    if (column >= 0) triplets.emplace_back(row, column, 0.0);
  matrix_.resize(region.dual_size(), dual ? region.dual_size() : region.trace.size);
  matrix_.setFromTriplets(triplets.begin(), triplets.end());
  matrix_.makeCompressed();
  for (const auto &[row, column] : entries)
    position_.push_back(column < 0 ? -1 : &matrix_.coeffRef(row, column) - matrix_.valuePtr());
}

const SparseMatrix &ContactMatrix::assemble(const Form &form, const FullMu &mu,
                                            const std::vector<Cell> &cells) {
  std::vector<double> values(per_cell_);
  std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
  auto position = position_.begin();
  for (const Cell &cell : cells) {
    form.kernel(mu, cell, values.data());
    for (const double value : values) {
      if (*position >= 0) matrix_.valuePtr()[*position] += value;
      ++position;
    }
  }
  return matrix_;
}

Vector contact_vector(const ContactRegion &region, const Form &form, const FullMu &mu,
                      const std::vector<Cell> &cells) {
  Vector result = Vector::Zero(region.dual_size());
  std::array<double, 4> values{};
  for (std::size_t k = 0; k < cells.size(); ++k) {
    form.kernel(mu, cells[k], values.data());
    for (std::size_t i = 0; i <= static_cast<std::size_t>(region.dim); ++i)
      result[region.cells[k][i]] += values[i];
  }
  return result;
}

} // namespace rbvi
