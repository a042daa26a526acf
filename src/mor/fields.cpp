#include "rbvi/mor/fields.hpp"

#include "rbvi/element/imposed.hpp"
#include "rbvi/fem/materials.hpp"
#include "rbvi/io/checksum.hpp"
#include "rbvi/model/fields_file.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/columns.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

namespace rbvi {

namespace {

/// Rows of all ranks, by the number of each, on the first rank. `records`: a number and the entries
/// of its row, one after the other.
std::vector<double> gathered(MPI_Comm comm, const std::vector<double> &records) {
  const int count = static_cast<int>(records.size());
  std::vector<int> counts(ranks_of(comm)), offsets(counts.size(), 0);
  MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm);
  std::partial_sum(counts.begin(), counts.end() - 1, offsets.begin() + 1);
  std::vector<double> all;
  if (rank_of(comm) == 0) all.resize(offsets.back() + counts.back());
  MPI_Gatherv(records.data(), count, MPI_DOUBLE, all.data(), counts.data(), offsets.data(),
              MPI_DOUBLE, 0, comm);
  return all;
}

/// Rows `first` to `first + count - 1` of the basis on the first rank, zero where a displacement is
/// fixed; empty on the others. Collective.
Matrix rows_of_basis(const Problem &problem, const BorrowedRows::LocalRows &local, Index first,
                     Index count) {
  std::vector<double> records;
  const auto add = [&](PetscInt number, std::size_t i) {
    if (number < first || number >= first + count) return;
    records.push_back(static_cast<double>(number - first));
    const auto row = local.row(i);
    records.insert(records.end(), row.begin(), row.end());
  };
  const std::vector<PetscInt> &numbers = problem.dofs().natural_owned;
  std::map<PetscInt, std::size_t> row_of;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    add(numbers[i], i);
    if (!problem.dofs().tied.empty()) row_of[numbers[i]] = i;
  }
  for (const auto &[number, with_row] : problem.dofs().tied)
    if (const auto found = row_of.find(with_row); found != row_of.end()) add(number, found->second);
  const std::vector<double> all = gathered(problem.comm(), records);
  if (rank_of(problem.comm()) != 0) return {};
  Matrix rows = Matrix::Zero(count, local.cols());
  for (auto record = all.begin(); record != all.end(); record += local.cols() + 1)
    rows.row(static_cast<Index>(*record)) =
        Eigen::Map<const Eigen::RowVectorXd>(&*record + 1, local.cols());
  return rows;
}

Matrix gather_points(const Mesh &mesh) {
  std::vector<double> records;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    if (!mesh.owned_node[v]) continue;
    records.push_back(static_cast<double>(mesh.natural_node[v]));
    records.insert(records.end(), mesh.points[v].begin(), mesh.points[v].begin() + mesh.dim);
  }
  const std::vector<double> all = gathered(mesh.comm, records);
  if (rank_of(mesh.comm) != 0) return {};
  Matrix points(mesh.total_nodes, mesh.dim);
  for (auto record = all.begin(); record != all.end(); record += mesh.dim + 1)
    points.row(static_cast<Index>(*record)) =
        Eigen::Map<const Eigen::RowVectorXd>(&*record + 1, mesh.dim);
  return points;
}

std::vector<int> gather_cells(const Mesh &mesh) {
  const int per_cell = nodes_per_cell(mesh.dim, mesh.degree);
  std::vector<double> records;
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    records.push_back(static_cast<double>(mesh.natural_cell[k]));
    const auto nodes = nodes_of(mesh, k);
    for (int i = 0; i < per_cell; ++i)
      records.push_back(static_cast<double>(mesh.natural_node[nodes[i]]));
  }
  const std::vector<double> all = gathered(mesh.comm, records);
  if (rank_of(mesh.comm) != 0) return {};
  std::vector<int> cells(mesh.total_cells * per_cell);
  for (auto record = all.begin(); record != all.end(); record += per_cell + 1)
    std::transform(record + 1, record + 1 + per_cell,
                   cells.begin() + static_cast<std::ptrdiff_t>(*record) * per_cell,
                   [](double node) { return static_cast<int>(node); });
  return cells;
}

/// ModelFields::materials.
std::vector<int> gather_materials(const Problem &problem) {
  const Mesh &mesh = problem.mesh();
  const std::vector<int> mine = materials_of_cells(problem.scene(), mesh);
  if (problem.scene().materials.size() < 2) return {};
  std::vector<int> materials(mesh.total_cells, -1);
  for (std::size_t k = 0; k < mine.size(); ++k)
    materials[mesh.natural_cell[k]] = mine[k];
  over_ranks(mesh.comm, MPI_MAX, materials);
  return materials;
}

/// ModelFields::imposed_by.
std::vector<int> gather_imposed(const Problem &problem) {
  const Dofs &dofs = problem.dofs();
  const Mesh &mesh = problem.mesh();
  if (!imposes_values(problem.scene())) return {};
  std::vector<double> records;
  for (std::size_t i = 0; i < dofs.imposed_by.size(); ++i) {
    const auto components = static_cast<std::size_t>(dofs.components);
    if (dofs.imposed_by[i] < 0) continue;
    records.push_back(static_cast<double>(mesh.natural_node[i / components] * dofs.components) +
                      static_cast<double>(i % components));
    records.push_back(dofs.imposed_by[i]);
  }
  const std::vector<double> all = gathered(problem.comm(), records);
  if (rank_of(problem.comm()) != 0) return {};
  std::vector<int> imposed_by(dofs.total, -1);
  for (auto record = all.begin(); record != all.end(); record += 2)
    imposed_by[static_cast<std::size_t>(*record)] = static_cast<int>(record[1]);
  return imposed_by;
}

/// Calls visit(first, count, rows) for the rows of the basis, block by block; rows: on the first
/// rank.
template <class Visit>
void visit_rows(const Problem &problem, const LinearBasis &basis, Visit &&visit) {
  constexpr Index entries_at_a_time = Index{1} << 22;
  const BorrowedColumns columns(basis.columns.get());
  const BorrowedRows borrowed(columns.get());
  const Index total = problem.dofs().total;
  const Index step = std::max<Index>(1, entries_at_a_time / std::max<Index>(1, basis.size()));
  for (Index first = 0; first < total; first += step) {
    const Index count = std::min(step, total - first);
    visit(first, count, rows_of_basis(problem, borrowed.rows(), first, count));
  }
}

} // namespace

void gather_mesh(const Problem &problem, ReducedModel &model) {
  model.fields.points = gather_points(problem.mesh());
  model.fields.cells = gather_cells(problem.mesh());
  model.fields.materials = gather_materials(problem);
  model.fields.imposed_by = gather_imposed(problem);
}

std::string key_of_fields(const Problem &problem, const LinearBasis &basis) {
  const BorrowedColumns columns(basis.columns.get());
  const BorrowedRows borrowed(columns.get());
  std::uint64_t own = fnv1a(nullptr, 0);
  for (Index j = 0; j < borrowed.rows().cols(); ++j)
    own = fnv1a(borrowed.rows().col(j).data(),
                static_cast<std::size_t>(borrowed.rows().rows()) * sizeof(double), own);
  const std::vector<std::uint64_t> all =
      gather_all(problem.comm(), std::vector<std::uint64_t>{own}, MPI_UINT64_T);
  return std::to_string(fnv1a(all.data(), all.size() * sizeof(own))) + "-" +
         problem.mesh().fingerprint;
}

void write_fields(const Problem &problem, const LinearBasis &basis, const ReducedModel &model,
                  const std::filesystem::path &model_path) {
  const MPI_Comm comm = problem.comm();
  const bool writes = rank_of(comm) == 0;
  ReducedModel mesh;
  gather_mesh(problem, mesh);
  std::unique_ptr<FieldsFile> file;
  collectively(comm, [&] {
    if (!writes) return;
    file = std::make_unique<FieldsFile>(model_path, model.fields.key);
    file->write_mesh(mesh);
    file->begin_basis(problem.dofs().total, basis.size());
  });
  visit_rows(problem, basis, [&](Index first, Index, const Matrix &rows) {
    collectively(comm, [&] {
      if (writes) file->write_basis(first, rows);
    });
  });
  collectively(comm, [&] {
    if (writes) file->commit();
  });
}

void gather_fields(const Problem &problem, const LinearBasis &basis, ReducedModel &model) {
  const MPI_Comm comm = problem.comm();
  gather_mesh(problem, model);
  const auto share = [&](auto &values, MPI_Datatype type) {
    MPI_Bcast(values.data(), static_cast<int>(values.size()), type, 0, comm);
  };
  const Mesh &mesh = problem.mesh();
  model.fields.points.resize(mesh.total_nodes, mesh.dim); // on the first rank they are there
  model.fields.cells.resize(
      static_cast<std::size_t>(mesh.total_cells * nodes_per_cell(mesh.dim, mesh.degree)));
  if (imposes_values(problem.scene())) model.fields.imposed_by.resize(problem.dofs().total);
  share(model.fields.points, MPI_DOUBLE);
  share(model.fields.cells, MPI_INT);
  share(model.fields.imposed_by, MPI_INT);
  model.fields.basis.resize(problem.dofs().total, basis.size());
  visit_rows(problem, basis, [&](Index first, Index count, Matrix rows) {
    rows.resize(count, basis.size());
    share(rows, MPI_DOUBLE);
    model.fields.basis.middleRows(first, count) = rows;
  });
}

} // namespace rbvi
