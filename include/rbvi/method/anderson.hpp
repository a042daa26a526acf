// Anderson's acceleration of a fixed-point iteration s <- F(s): the next state combines the last
// few images so that their residuals F(s) - s cancel best, by least squares (QR).
#pragma once

#include "rbvi/core/dense.hpp"

#include <vector>

namespace rbvi {

class Anderson {
public:
  /// `depth`: earlier images that are combined with the last.
  explicit Anderson(Index depth) : depth_(depth) {}
  /// Coefficients of the images so far, the last one's last; they sum to 1. `residual`: F(s) - s of
  /// the last image. At most depth + 1 images are kept: as many coefficients.
  Vector combine(const Vector &residual);

private:
  Index depth_;
  std::vector<Vector> residuals_;
};

} // namespace rbvi
