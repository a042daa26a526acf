#include "rbvi/method/nonnegative_qp.hpp"

#include <Eigen/Jacobi>

#include <algorithm>

namespace rbvi {

UpdatableQr::UpdatableQr(Index rows, Index capacity) : q_(rows, 0) {
  reserve(capacity);
}

void UpdatableQr::reserve(Index capacity) {
  if (capacity <= q_.cols()) return;
  q_.conservativeResize(Eigen::NoChange, capacity);
  r_.conservativeResize(capacity, capacity);
  projection_.resize(capacity);
}

bool UpdatableQr::append(const Eigen::Ref<const Vector> &column, double tolerance) {
  if (size_ == rows()) return false;
  if (size_ == q_.cols()) reserve(std::min(rows(), 2 * size_ + 8));
  const double norm = column.norm();
  auto remainder = q_.col(size_);
  auto total = r_.col(size_).head(size_);
  auto part = projection_.head(size_);
  remainder = column;
  total.setZero();
  for (int pass = 0; pass < 2; ++pass) {
    part.noalias() = q().transpose() * remainder;
    remainder.noalias() -= q() * part;
    total += part;
  }
  const double left = remainder.norm();
  if (!(left > tolerance * norm)) return false;
  remainder /= left;
  r_(size_, size_) = left;
  r_.row(size_).head(size_).setZero();
  ++size_;
  return true;
}

bool UpdatableQr::assign(const Eigen::Ref<const Matrix> &columns) {
  clear();
  const Index count = columns.cols();
  if (count > rows()) return false;
  if (count == 0) return true;
  reserve(count);
  // Cholesky QR, twice: the second pass repairs the orthogonality that the first one loses.
  auto q = q_.leftCols(count);
  q = columns;
  auto r = r_.topLeftCorner(count, count);
  r.setIdentity();
  Matrix gram(count, count);
  for (int pass = 0; pass < 2; ++pass) {
    gram.setZero();
    gram.selfadjointView<Eigen::Lower>().rankUpdate(q.transpose());
    const double loss = (gram.diagonal().array() - 1).abs().maxCoeff();
    Eigen::LLT<Eigen::Ref<Matrix>> cholesky(gram);
    if (cholesky.info() != Eigen::Success || gram.diagonal().minCoeff() < 1e-6) return false;
    if (pass == 1 && (!(loss < 1e-2) || gram.diagonal().minCoeff() < 0.9)) return false;
    const auto upper = gram.triangularView<Eigen::Lower>().transpose();
    upper.solveInPlace<Eigen::OnTheRight>(q);
    const auto previous = r.triangularView<Eigen::Upper>();
    r = Matrix(upper * Matrix(previous));
  }
  size_ = count;
  return true;
}

void UpdatableQr::remove(Index position) {
  for (Index j = position + 1; j < size_; ++j)
    r_.col(j - 1).head(j + 1) = r_.col(j).head(j + 1);
  --size_;
  for (Index i = position; i < size_; ++i) {
    Eigen::JacobiRotation<double> rotation;
    rotation.makeGivens(r_(i, i), r_(i + 1, i));
    r_.middleCols(i, size_ - i).applyOnTheLeft(i, i + 1, rotation.adjoint());
    r_(i + 1, i) = 0;
    q_.applyOnTheRight(i, i + 1, rotation);
  }
}

} // namespace rbvi
