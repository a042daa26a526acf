#include "pga_candidate.hpp"

#include "rbvi/mor/stability.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

// A Gram matrix that shrank this much is computed afresh: round-off in the range, which began as
// the whole of it, is then far below a tie.
constexpr double cancellation = 1e-4;
constexpr int power_iterations = 4;

/// Norm of `matrix` x after some steps towards its dominant eigenvector.
double power_bound(const Matrix &matrix, Vector &x) {
  double norm = 0;
  for (int k = 0; k < power_iterations; ++k) {
    const Vector image = matrix.selfadjointView<Eigen::Lower>() * x;
    norm = image.norm();
    if (!(norm > 0)) break;
    x = image / norm;
  }
  return norm;
}

} // namespace

Matrix PgaSpace::remainder(const Matrix &top) const {
  Matrix rest = Matrix::Zero(columns.rows(), top.cols());
  rest.topRows(contact) = top;
  rest.noalias() -= in_use() * (in_use().topRows(contact).transpose() * top);
  return rest;
}

void PgaSpace::add(const Vector &source) {
  Vector column = remainder(source);
  column -= in_use() * (in_use().transpose() * column);
  sources.col(size - modes) = source;
  columns.col(size) = column.normalized();
  ++size;
}

void PgaSpace::take(const Vector &source, const Vector &left) {
  const auto known = columns.leftCols(modes);
  sources.col(size - modes) = source;
  columns.col(size) = (left - known * (known.transpose() * left)).normalized();
  ++size;
}

void PgaCandidate::update(const PgaSpace &space) {
  if (seen_ == space.size) return;
  if (seen_ < 0) {
    range_ = orthonormal_range(range_);
    gram_.setIdentity(range_.cols(), range_.cols());
    seen_ = 0;
  }
  const auto fresh = space.columns.block(0, seen_, space.contact, space.size - seen_);
  const Matrix overlap = range_.transpose() * fresh;
  gram_.selfadjointView<Eigen::Lower>().rankUpdate(overlap, -1);
  seen_ = space.size;
}

void PgaCandidate::refresh(const PgaSpace &space) {
  const Matrix rest = space.remainder(range_);
  gram_.noalias() = rest.transpose() * rest;
  built_ = gram_.norm();
}

double PgaCandidate::lower_bound(const PgaSpace &space) {
  update(space);
  if (gram_.rows() == 0) return 0;
  if (direction_.size() == 0) {
    Index widest = 0;
    gram_.diagonal().maxCoeff(&widest);
    direction_ = Vector::Unit(gram_.rows(), widest);
  }
  double bound = power_bound(gram_, direction_);
  if (bound < cancellation * built_) {
    refresh(space);
    bound = power_bound(gram_, direction_);
  }
  return std::sqrt(bound);
}

bool PgaCandidate::certainly_below(const PgaSpace &space, double needed) {
  update(space);
  const double square = needed * needed;
  if (square < cancellation * built_) return false;
  Matrix shifted = -gram_;
  shifted.diagonal().array() += square;
  return cholesky_in_place(shifted);
}

double PgaCandidate::evaluate(const PgaSpace &space, SmallEigen &eigen) {
  update(space);
  farthest_.resize(range_.rows(), 0);
  if (gram_.rows() == 0) return 0;
  Vector values = eigen.values(gram_);
  if (values(0) < cancellation * built_) {
    refresh(space);
    values = eigen.values(gram_);
  }
  Index multiplicity = 1;
  while (multiplicity < values.size() && values(multiplicity) >= (1 - 2 * pga_tie) * values(0))
    ++multiplicity;
  // The next eigenvector becomes the largest when these have joined the space.
  const Matrix vectors = eigen.vectors(std::min(multiplicity + 1, values.size()));
  direction_ = vectors.rightCols(1);
  farthest_ = range_ * vectors.leftCols(multiplicity);
  return std::sqrt(std::max(values(0), 0.0));
}

} // namespace rbvi
