#include "rbvi/mor/orthonormal.hpp"

#include "append_block.hpp"
#include "rbvi/core/error.hpp"

namespace rbvi {

Fit fit_columns(const Matrix &gram, const std::vector<Index> &candidates) {
  constexpr double own = 1e-4; // one Cholesky factor leaves angles of round-off over its square
  const Vector norms = gram.diagonal().cwiseMax(0).cwiseSqrt();
  Fit fit;
  Matrix factor = Matrix::Zero(gram.rows(), gram.cols());
  for (const Index j : candidates) {
    const auto size = std::ssize(fit.columns);
    Vector row = gram(fit.columns, j).cwiseQuotient(norms(fit.columns)) / norms[j];
    factor.topLeftCorner(size, size).triangularView<Eigen::Lower>().solveInPlace(row);
    const double left = std::sqrt(std::max(0.0, 1 - row.squaredNorm()));
    if (!(left > own)) continue;
    factor.row(size).head(size) = row.transpose();
    factor(size, size) = left;
    fit.least = std::min(fit.least, left);
    fit.columns.push_back(j);
  }
  const auto size = std::ssize(fit.columns);
  Matrix inverse = norms(fit.columns).cwiseInverse().asDiagonal();
  factor.topLeftCorner(size, size)
      .transpose()
      .triangularView<Eigen::Upper>()
      .solveInPlace<Eigen::OnTheRight>(inverse);
  fit.rotation = Matrix::Zero(gram.rows(), size);
  fit.rotation(fit.columns, Eigen::all) = inverse;
  return fit;
}

Order fitting_first(const Fit &fit, const std::vector<Index> &candidates, Index among, Index all) {
  Order order{fit.columns, {}};
  std::ranges::set_difference(candidates, fit.columns, std::back_inserter(order.columns));
  for (Index j = among; j < all; ++j)
    order.columns.push_back(j);
  const auto fitting = std::ssize(fit.columns);
  order.rotation = Matrix::Zero(all, std::ssize(order.columns));
  order.rotation.topLeftCorner(among, fitting) = fit.rotation;
  for (Index k = fitting; k < order.rotation.cols(); ++k)
    order.rotation(order.columns[k], k) = 1;
  return order;
}

namespace {

/// What append_block wants of columns.
struct DenseColumns {
  const SparseMatrix *product;
  Matrix &columns;

  Matrix image(const Matrix &x) const { return product != nullptr ? Matrix(*product * x) : x; }
  Matrix gram(const Matrix &x, Index n) const {
    Matrix result = x.leftCols(n).transpose() * image(x.leftCols(n));
    if (!result.allFinite()) throw failure("columns to orthonormalise are not finite");
    return result;
  }
  Vector remove(Matrix &x, Index n) const {
    const Matrix inside = columns.transpose() * image(x.leftCols(n));
    x.leftCols(n) -= columns * inside;
    return inside.colwise().norm();
  }
  void rotate(Matrix &x, const Matrix &rotation) const {
    x.leftCols(rotation.cols()) = (x.leftCols(rotation.rows()) * rotation).eval();
  }
  void take(const Matrix &x, Index n) const {
    columns.conservativeResize(Eigen::NoChange, columns.cols() + n);
    columns.rightCols(n) = x.leftCols(n);
  }
};

} // namespace

Matrix OrthonormalColumns::coordinates(const Matrix &x) const {
  return product_ != nullptr ? Matrix(columns_.transpose() * (*product_ * x))
                             : Matrix(columns_.transpose() * x);
}

Matrix OrthonormalColumns::remainder(Matrix x) const {
  for (int pass = 0; pass < 2 && columns_.cols() > 0; ++pass)
    x -= columns_ * coordinates(x);
  return x;
}

void OrthonormalColumns::append(const Matrix &block, double tolerance) {
  constexpr Index width = 48;
  if (columns_.rows() == 0) columns_.resize(block.rows(), 0);
  DenseColumns basis{product_, columns_};
  for (Index first = 0; first < block.cols(); first += width) {
    Matrix part = block.middleCols(first, std::min(width, block.cols() - first));
    append_block(basis, part, part.cols(), tolerance);
  }
}

Matrix orthonormal_range(const Matrix &vectors) {
  OrthonormalColumns range;
  range.append(vectors, 1e-12);
  return range.columns();
}

} // namespace rbvi
