#include "rbvi/method/starts.hpp"

namespace rbvi {

Index Neighbours::nearest(const FullMu &mu) const {
  if (count() == 0) return -1;
  Index k = 0;
  (points_.colwise() - parts_of_box(space_, mu)).colwise().squaredNorm().minCoeff(&k);
  return k;
}

Vector Neighbours::fit(const Matrix &values, const FullMu &mu) const {
  if (values.cols() == 0) return {};
  return local_fit(values, points_, parts_of_box(space_, mu));
}

void Neighbours::add(const FullMu &mu) {
  const Vector here = parts_of_box(space_, mu);
  points_.conservativeResize(here.size(), count() + 1);
  points_.rightCols(1) = here;
}

} // namespace rbvi
