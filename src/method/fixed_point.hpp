// Linear fixed points, by Anderson's acceleration with all iterates: GMRES.
#pragma once

#include "rbvi/method/anderson.hpp"

namespace rbvi {

/// The solution of d = right - image(d), image linear, to `tolerance` relative to `right`.
template <class Image> Vector fixed_point(const Vector &right, double tolerance, Image &&image) {
  constexpr int most = 60;
  Anderson accelerated(most);
  std::vector<Vector> images;
  Vector d = right;
  for (int k = 0; k < most; ++k) {
    images.push_back(right - image(d));
    const Vector residual = images.back() - d;
    if (residual.norm() <= tolerance * right.norm()) break;
    const Vector shares = accelerated.combine(residual);
    d.setZero();
    for (Index j = 0; j < shares.size(); ++j)
      d += shares[j] * images[j];
  }
  return images.back();
}

} // namespace rbvi
