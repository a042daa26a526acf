#include "rbvi/method/mixed_qp.hpp"

#include "rbvi/core/error.hpp"

#include <Eigen/QR>

#include <cmath>

namespace rbvi {

namespace {

constexpr double dependence = 1e-10; ///< as NonnegativeQpOptions::dependence

} // namespace

MixedQp::MixedQp(Index rows, Index free) : free_(free), qp_(rows) {}

void MixedQp::reset() {
  stale_ = true;
  qp_.reset();
}

void MixedQp::eliminate(const Matrix &y) {
  const auto columns = y.rightCols(free_);
  Eigen::ColPivHouseholderQR<Matrix> qr(columns);
  qr.setThreshold(dependence);
  const Index rank = qr.rank();
  q_ = qr.householderQ() * Matrix::Identity(y.rows(), rank);
  r_ = qr.matrixQR().topRows(rank).triangularView<Eigen::Upper>();
  order_ = qr.colsPermutation();
  bounded_ = y.leftCols(y.cols() - free_);
  coupling_ = q_.transpose() * bounded_;
  bounded_.noalias() -= q_ * coupling_;
  // What round-off leaves of a column inside the span of the free ones is no direction of its own.
  for (Index j = 0; j < bounded_.cols(); ++j)
    if (bounded_.col(j).norm() <= dependence * coupling_.col(j).norm()) bounded_.col(j).setZero();
  stale_ = false;
}

NonnegativeQpReport MixedQp::solve(const Matrix &y, const Vector &c, const Vector &g) {
  if (free_ == 0) return qp_.solve(y, c, g);
  if (y.cols() < free_ || c.size() != y.rows() || (g.size() > 0 && g.size() != y.cols()))
    throw failure("a quadratic problem whose sizes do not fit");
  if (stale_) eliminate(y);
  const Index bounded = bounded_.cols(), rank = q_.cols();
  const auto square = r_.leftCols(rank).triangularView<Eigen::Upper>();
  Vector w = Vector::Zero(rank), linear;
  if (g.size() > 0) {
    const Vector g_free = order_.transpose() * g.tail(free_);
    w = square.transpose().solve(g_free.head(rank));
    const Vector uphill = g_free.tail(free_ - rank) - r_.rightCols(free_ - rank).transpose() * w;
    if (uphill.size() > 0 && uphill.cwiseAbs().maxCoeff() > dependence * g_free.norm())
      return {.iterations = 0, .converged = false, .unbounded = true};
    linear = g.head(bounded) - coupling_.transpose() * w;
    for (Index j = 0; j < bounded; ++j)
      if (std::abs(linear[j]) <= dependence * (std::abs(g[j]) + coupling_.col(j).norm() * w.norm()))
        linear[j] = 0;
  }
  const Vector inside = q_.transpose() * c;
  const NonnegativeQpReport report = qp_.solve(bounded_, c - q_ * inside, linear);
  Vector coefficients = Vector::Zero(free_);
  coefficients.head(rank) = square.solve(inside - coupling_ * qp_.x() - w);
  x_.resize(y.cols());
  x_ << qp_.x(), order_ * coefficients;
  residual_ = qp_.residual() + q_ * w;
  return report;
}

} // namespace rbvi
