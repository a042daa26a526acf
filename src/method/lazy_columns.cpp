#include "lazy_columns.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>

namespace rbvi {

void LazyColumns::require(const std::vector<Index> &which) {
  std::vector<Index> fresh;
  for (const Index i : which)
    if (!has(i)) fresh.push_back(i);
  if (fresh.empty()) return;
  const Matrix received = source_(fresh);
  const Index count = static_cast<Index>(fresh.size());
  if (received.rows() != h_.rows() || received.cols() != count || !received.allFinite())
    throw failure(
        "the source of the columns of H returned a matrix of the wrong size or not finite");
  if (count_ + count > h_.cols())
    h_.conservativeResize(Eigen::NoChange,
                          std::min(h_.rows(), std::max(count_ + count, 2 * h_.cols())));
  h_.middleCols(count_, count) = received;
  for (const Index i : fresh)
    slot_[i] = count_++;
}

Matrix LazyColumns::block(const std::vector<Index> &active) const {
  const Index count = static_cast<Index>(active.size());
  Matrix result(count, count);
  for (Index k = 0; k < count; ++k)
    result.col(k) = column(active[k])(active);
  return result;
}

std::pair<Vector, Vector> LazyColumns::multiply(const std::vector<Index> &active,
                                                const Vector &x) const {
  Vector spread = Vector::Zero(count_);
  for (std::size_t k = 0; k < active.size(); ++k)
    spread[slot(active[k])] = x[static_cast<Index>(k)];
  const auto h = h_.leftCols(count_);
  return {h * spread, h.cwiseAbs() * spread.cwiseAbs()};
}

} // namespace rbvi
