#include "rbvi/method/anderson.hpp"

#include <Eigen/QR>

namespace rbvi {

Vector Anderson::combine(const Vector &residual) {
  residuals_.push_back(residual);
  if (static_cast<Index>(residuals_.size()) > depth_ + 1) residuals_.erase(residuals_.begin());
  const auto count = static_cast<Index>(residuals_.size());
  Vector coefficients = Vector::Zero(count);
  coefficients[count - 1] = 1;
  if (count == 1) return coefficients;
  Matrix differences(residual.size(), count - 1);
  for (Index k = 0; k + 1 < count; ++k)
    differences.col(k) = residual - residuals_[k];
  Eigen::ColPivHouseholderQR<Matrix> qr(differences);
  qr.setThreshold(1e-10);
  const Vector shares = qr.solve(residual);
  coefficients.head(count - 1) = shares;
  coefficients[count - 1] -= shares.sum();
  return coefficients;
}

} // namespace rbvi
