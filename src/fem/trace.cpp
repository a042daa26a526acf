#include "rbvi/fem/trace.hpp"

#include "rbvi/par/collective.hpp"
#include "rbvi/par/columns.hpp"

#include <unordered_map>

namespace rbvi {

Trace make_trace(const Dofs &dofs, const std::vector<PetscInt> &natural) {
  std::unordered_map<PetscInt, PetscInt> contact_of_natural;
  for (const PetscInt number : natural)
    contact_of_natural.emplace(number, static_cast<PetscInt>(contact_of_natural.size()));
  Trace trace{dofs.comm, static_cast<PetscInt>(natural.size()), {}, {}};
  for (std::size_t row = 0; row < dofs.natural_owned.size(); ++row) {
    const auto found = contact_of_natural.find(dofs.natural_owned[row]);
    if (found == contact_of_natural.end()) continue;
    trace.local_row.push_back(static_cast<PetscInt>(row));
    trace.index.push_back(found->second);
  }
  return trace;
}

Trace part_of(const Trace &trace, const std::vector<Index> &dofs) {
  std::vector<PetscInt> number(trace.size, -1);
  for (std::size_t k = 0; k < dofs.size(); ++k)
    number[dofs[k]] = static_cast<PetscInt>(k);
  Trace part{trace.comm, static_cast<PetscInt>(dofs.size()), {}, {}};
  for (std::size_t k = 0; k < trace.index.size(); ++k)
    if (const PetscInt at = number[trace.index[k]]; at >= 0) {
      part.local_row.push_back(trace.local_row[k]);
      part.index.push_back(at);
    }
  return part;
}

std::vector<PetscInt> global_rows(const Trace &trace, PetscInt first) {
  std::vector<PetscInt> rows(trace.size, 0);
  for (std::size_t k = 0; k < trace.index.size(); ++k)
    rows[trace.index[k]] = first + trace.local_row[k];
  over_ranks(trace.comm, MPI_SUM, rows);
  return rows;
}

Vector restrict_to(const Trace &trace, Vec u) {
  Vector values = Vector::Zero(trace.size);
  values(trace.index) = local_values(u)(trace.local_row);
  over_ranks(trace.comm, MPI_SUM, values); // exact: zero but on the owner
  return values;
}

Matrix restrict_to(const Trace &trace, Mat dense) {
  const BorrowedRows local(dense);
  Matrix values = Matrix::Zero(trace.size, local.rows().cols());
  values(trace.index, Eigen::all) = local.rows()(trace.local_row, Eigen::all);
  over_ranks(trace.comm, MPI_SUM, values); // exact: zero but on the owner
  return values;
}

void add_extension(const Trace &trace, const Eigen::Ref<const Vector> &values, Vec f) {
  double *local = nullptr;
  RBVI_CALL(VecGetArray(f, &local));
  for (std::size_t k = 0; k < trace.index.size(); ++k)
    local[trace.local_row[k]] += values(trace.index[k]);
  RBVI_CALL(VecRestoreArray(f, &local));
}

Handle<Mat> extension(const Trace &trace, const Matrix &values, Mat like) {
  Handle<Mat> dense = make_dense(like, values.cols());
  PetscInt stride = 0;
  RBVI_CALL(MatDenseGetLDA(dense.get(), &stride));
  double *local = nullptr;
  RBVI_CALL(MatDenseGetArray(dense.get(), &local));
  for (Index j = 0; j < values.cols(); ++j)
    for (std::size_t k = 0; k < trace.index.size(); ++k)
      local[trace.local_row[k] + j * stride] += values(trace.index[k], j);
  RBVI_CALL(MatDenseRestoreArray(dense.get(), &local));
  return dense;
}

} // namespace rbvi
