#include "rbvi/mor/operator_entries.hpp"

#include "rbvi/par/collective.hpp"

namespace rbvi {

namespace {

std::vector<PetscInt> natural_of_rows(const Dofs &dofs) {
  std::vector<PetscInt> natural(dofs.total_free, 0);
  for (std::size_t i = 0; i < dofs.natural_owned.size(); ++i)
    natural[static_cast<std::size_t>(dofs.first_free) + i] = dofs.natural_owned[i];
  over_ranks(dofs.comm, MPI_SUM, natural);
  return natural;
}

} // namespace

LowerTriangle::LowerTriangle(Mat a, const Dofs &dofs) {
  const std::vector<PetscInt> natural = natural_of_rows(dofs);
  visit_entries(a, [&](PetscInt row, PetscInt column, double) {
    const EntryKey key{natural[row], natural[column]};
    taken_.push_back(key.row >= key.column);
    if (taken_.back()) keys_.push_back(key);
  });
}

Vector LowerTriangle::values(Mat a) const {
  Vector result(std::ssize(keys_));
  auto taken = taken_.begin();
  Index next = 0;
  visit_entries(a, [&](PetscInt, PetscInt, double value) {
    if (*taken++) result[next++] = value;
  });
  return result;
}

std::vector<EntryKey> nonzero_keys(const SparseMatrix &matrix) {
  std::vector<EntryKey> keys;
  for (Index row = 0; row < matrix.rows(); ++row)
    for (SparseMatrix::InnerIterator entry(matrix, row); entry; ++entry)
      keys.push_back({static_cast<PetscInt>(row), static_cast<PetscInt>(entry.col())});
  return keys;
}

Vector nonzero_values(const SparseMatrix &matrix) {
  return Eigen::Map<const Vector>(matrix.valuePtr(), matrix.nonZeros());
}

} // namespace rbvi
