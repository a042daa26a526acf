#include "rbvi/method/compliance.hpp"

#include "loaded_columns.hpp"
#include "rbvi/core/error.hpp"

#include <algorithm>
#include <numeric>

namespace rbvi {

void Compliance::require(const std::vector<Index> &dofs) {
  constexpr Index pending = -2;
  std::vector<Index> fresh;
  for (const Index dof : dofs)
    if (slot_[dof] == -1) {
      slot_[dof] = pending;
      fresh.push_back(dof);
    }
  if (fresh.empty()) return;
  const Index needed = count_ + std::ssize(fresh);
  if (needed > columns_.cols()) columns_.conservativeResize(size_, std::min(size_, 2 * needed));
  try {
    make(fresh, columns_.middleCols(count_, std::ssize(fresh)));
  } catch (...) {
    for (const Index dof : fresh)
      slot_[dof] = -1;
    throw;
  }
  for (const Index dof : fresh)
    slot_[dof] = count_++;
}

Eigen::Map<const Vector> Compliance::column(Index dof) const {
  if (slot_[dof] < 0) throw failure("a column of the compliance is used before it is required");
  return {columns_.col(slot_[dof]).data(), size_};
}

Matrix Compliance::moved(const SparseMatrix &b, const std::vector<Index> &which) {
  std::vector<Index> dofs;
  for (const Index row : which)
    for (SparseMatrix::InnerIterator entry(b, row); entry; ++entry)
      dofs.push_back(entry.col());
  require(dofs);
  Matrix result = Matrix::Zero(size_, std::ssize(which));
  for (Index k = 0; k < result.cols(); ++k) {
    LoadedColumns columns;
    for (SparseMatrix::InnerIterator entry(b, which[k]); entry; ++entry)
      columns.add(-entry.value(), column(entry.col()).data(), body_of(entry.col()));
    columns.subtract_from(result.col(k), {0, size_});
  }
  return result;
}

Vector Compliance::displaced_by(const Vector &reaction) {
  std::vector<Index> dofs;
  for (Index dof = 0; dof < size_; ++dof)
    if (reaction[dof] != 0) dofs.push_back(dof);
  require(dofs);
  LoadedColumns loaded;
  loaded.add(reaction, *this);
  Vector result = Vector::Zero(size_);
  loaded.subtract_from(result, {0, size_});
  return result;
}

void Compliance::forget() {
  count_ = 0;
  slot_.assign(size_, -1);
}

void Compliance::set_all(Matrix columns) {
  columns_ = std::move(columns);
  count_ = size_;
  std::iota(slot_.begin(), slot_.end(), Index{0});
}

Matrix condensed_columns(Compliance &compliance, const SparseMatrix &b,
                         const std::vector<Index> &which) {
  constexpr Index block = 128; // at a time: bounds the memory
  Matrix result(b.rows(), std::ssize(which));
  for (Index first = 0; first < result.cols(); first += block) {
    const Index count = std::min(block, result.cols() - first);
    result.middleCols(first, count) =
        b * compliance.moved(b, {which.begin() + first, which.begin() + first + count});
  }
  return result;
}

} // namespace rbvi
