#include "basis_change.hpp"

#include "rbvi/core/error.hpp"

#include <cmath>
#include <numeric>

namespace rbvi {

namespace {

/// visit(row in packed, i, j, order), for the entries i >= j of all blocks.
template <class Visit> void visit_triangles(const std::vector<int> &blocks, Visit &&visit) {
  const Index n = std::accumulate(blocks.begin(), blocks.end(), Index{0});
  Index first = 0, packed = 0;
  for (const int size : blocks) {
    for (Index j = first; j < first + size; ++j)
      for (Index i = j; i < first + size; ++i)
        visit(packed++, i, j, n);
    first += size;
  }
}

/// Offset of column j of a packed lower triangle of order n.
Index packed_column(Index n, Index j) {
  return j * n - j * (j - 1) / 2;
}

} // namespace

Matrix BasisChange::triangles(const Matrix &packed) const {
  Matrix result(after_ * (after_ + 1) / 2, packed.cols());
  if (c_ != nullptr) {
    for (Index q = 0; q < packed.cols(); ++q)
      result.col(q) = pack(c_->transpose() * (unpacked(packed.col(q), before_) * *c_));
    return result;
  }
  for (Index j = 0; j < after_; ++j)
    result.middleRows(packed_column(after_, j), after_ - j) =
        packed.middleRows(packed_column(before_, j), after_ - j);
  return result;
}

Matrix BasisChange::side_by_side(const Matrix &m) const {
  const Index count = m.cols() / before_;
  Matrix result(m.rows(), count * after_);
  for (Index q = 0; q < count; ++q)
    result.middleCols(q * after_, after_) = columns(m.middleCols(q * before_, before_));
  return result;
}

std::vector<int> diagonal_blocks(const Matrix &squares) {
  const auto n = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(squares.rows()))));
  std::vector<int> blocks;
  Index begin = 0, reach = 0;
  for (Index j = 0; j < n; ++j) {
    Index last = n - 1; // row of column j with an entry
    while (last > reach && (squares.row(j * n + last).array() == 0).all())
      --last;
    reach = std::max(reach, last);
    if (reach > j) continue;
    blocks.push_back(static_cast<int>(j + 1 - begin));
    begin = reach = j + 1;
  }
  return blocks;
}

Matrix pack_blocks(const Matrix &squares, const std::vector<int> &blocks) {
  Index rows = 0;
  for (const Index size : blocks)
    rows += size * (size + 1) / 2;
  Matrix packed(rows, squares.cols());
  visit_triangles(blocks, [&](Index at, Index i, Index j, Index n) {
    packed.row(at) = squares.row(j * n + i);
  });
  return packed;
}

Matrix unpacked_blocks(const Matrix &packed, const std::vector<int> &blocks) {
  Index n = 0, rows = 0;
  for (const Index size : blocks) {
    n += size;
    rows += size * (size + 1) / 2;
  }
  if (rows != packed.rows()) throw bad_input("blocks of matrices do not fit their entries");
  Matrix squares = Matrix::Zero(n * n, packed.cols());
  visit_triangles(blocks, [&](Index at, Index i, Index j, Index) {
    squares.row(j * n + i) = squares.row(i * n + j) = packed.row(at);
  });
  return squares;
}

} // namespace rbvi
