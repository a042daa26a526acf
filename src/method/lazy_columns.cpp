#include "lazy_columns.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>

namespace rbvi {

void LazyColumns::require(const std::vector<Index> &which) {
  std::vector<Index> fresh;
  for (const Index i : which)
    if (!has(i)) fresh.push_back(i);
  if (fresh.empty()) return;
  if (source_) receive(fresh);
  for (const Index i : fresh) {
    slot_[i] = source_ ? count_ : i;
    ++count_;
    diagonal_[i] = column(i)[i];
  }
}

void LazyColumns::receive(const std::vector<Index> &fresh) {
  const Matrix received = source_(fresh);
  const Index count = static_cast<Index>(fresh.size());
  if (received.rows() != h_.rows() || received.cols() != count || !received.allFinite())
    throw failure(
        "the source of the columns of H returned a matrix of the wrong size or not finite");
  if (count_ + count > h_.cols())
    h_.conservativeResize(Eigen::NoChange,
                          std::min(h_.rows(), std::max(count_ + count, 2 * h_.cols())));
  h_.middleCols(count_, count) = received;
  data_ = h_.data();
}

Matrix LazyColumns::block(const std::vector<Index> &active) const {
  const Index count = static_cast<Index>(active.size());
  Matrix result(count, count);
  for (Index k = 0; k < count; ++k) {
    const auto whole = column(active[k]);
    for (Index i = 0; i < count; ++i) // twice as fast as an expression with indices
      result(i, k) = whole[active[i]];
  }
  return result;
}

std::pair<Vector, Vector> LazyColumns::multiply(const std::vector<Index> &active,
                                                const Vector &x) const {
  Vector product = Vector::Zero(size()), sizes = product;
  const auto add = [&](auto... k) {
    product += (... + (x[k] * column(active[k])));
    sizes += (... + (std::abs(x[k]) * column(active[k]).cwiseAbs()));
  };
  Index k = 0;
  for (; k + 4 <= x.size(); k += 4) // which reads and writes the sums once for four columns
    add(k, k + 1, k + 2, k + 3);
  for (; k < x.size(); ++k)
    add(k);
  return {std::move(product), std::move(sizes)};
}

} // namespace rbvi
