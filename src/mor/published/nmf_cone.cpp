#include "greedy_cone.hpp"
#include "reductions.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

constexpr int most_sweeps = 200;
constexpr double least_change = 1e-4; ///< of the objective, relative: a sweep below it is the last

/// Non-negative factors of X ~ g h^T.
struct Factors {
  Matrix g, h;
};

/// Each column of `factor` in turn minimises |X - factor other^T| over its values >= 0, in closed
/// form; `right` = X other, `gram` = other^T other.
void sweep(Matrix &factor, const Matrix &right, const Matrix &gram) {
  for (Index k = 0; k < factor.cols(); ++k)
    if (gram(k, k) > 0) {
      const Vector step = right.col(k) - factor * gram.col(k);
      factor.col(k) = (factor.col(k) + step / gram(k, k)).cwiseMax(0.0);
    }
}

/// Hierarchical alternating least squares (Cichocki and Phan, IEICE Trans. Fundamentals E92-A,
/// 2009): the problem of Lee and Seung, column by column, which needs fewer sweeps than their
/// multiplicative updates and keeps zeros exact. The objective never increases. Starts from `g`
/// and the best coefficients for it.
Factors factorise(const Matrix &x, const Matrix &g) {
  Factors factors{g, Matrix(x.cols(), g.cols())};
  NonnegativeQp projection(x.rows());
  for (Index p = 0; p < x.cols(); ++p) {
    if (!projection.solve(g, x.col(p)).converged)
      throw failure("the start of the non-negative factorisation did not converge");
    factors.h.row(p) = projection.x();
  }
  const auto objective = [&] { return (x - factors.g * factors.h.transpose()).squaredNorm(); };
  const double least = round_off * round_off * x.squaredNorm();
  double before = objective();
  for (int k = 0; k < most_sweeps && before > least; ++k) {
    sweep(factors.g, x * factors.h, factors.h.transpose() * factors.h);
    sweep(factors.h, x.transpose() * factors.g, factors.g.transpose() * factors.g);
    const double after = objective();
    if (before - after < least_change * before) break;
    before = after;
  }
  return factors;
}

struct Attempt {
  Matrix generators;
  double error = 0, gram_condition = 0;
};

/// Factorisations of the snapshots for any number of generators, from the first ones of CPG.
class Factorisation {
public:
  Factorisation(const Matrix &snapshots, const SparseMatrix &product, const Matrix &start)
      : start_(start), factor_(product_factor(product)), targets_(factor_ * snapshots),
        scale_(targets_.colwise().norm().maxCoeff()) {
    // The row sums alone: a product that couples the nodes would leave no closed form for the
    // column of least distance that is >= 0. Rows of zeros stay zero.
    const Vector lumped = product * Vector::Ones(product.cols());
    for (Index i = 0; i < snapshots.rows(); ++i)
      if ((snapshots.row(i).array() > 0).any()) rows_.push_back(i);
    if (!(lumped(rows_).minCoeff() > 0))
      throw failure("the inner product of the multipliers has a row sum that is not positive: it "
                    "cannot be lumped; try another -cone_type than nmf");
    weights_ = lumped(rows_).cwiseSqrt();
    x_ = weights_.asDiagonal() * snapshots(rows_, Eigen::all);
  }

  Attempt attempt(Index size) const {
    const Factors factors =
        factorise(x_, weights_.asDiagonal() * start_.leftCols(size)(rows_, Eigen::all));
    std::vector<Index> used;
    for (Index k = 0; k < size; ++k)
      if ((factors.g.col(k).array() > 0).any()) used.push_back(k);
    Attempt result{Matrix::Zero(start_.rows(), std::ssize(used))};
    result.generators(rows_, Eigen::all) =
        weights_.cwiseInverse().asDiagonal() * factors.g(Eigen::all, used);
    const Vector norms = (factor_ * result.generators).colwise().norm();
    result.generators *= norms.cwiseInverse().asDiagonal();
    const Matrix coordinates = factor_ * result.generators;
    const Matrix coefficients = norms.asDiagonal() * factors.h(Eigen::all, used).transpose();
    Distances distances(targets_, coordinates, coefficients);
    result.error = distances.largest(coordinates).second / scale_;
    result.gram_condition = gram_condition(coordinates);
    return result;
  }

private:
  const Matrix &start_;
  Matrix factor_, targets_;
  double scale_;
  std::vector<Index> rows_; ///< nodes in contact in some snapshot
  Vector weights_;
  Matrix x_; ///< with the Euclidean norm equal to the lumped one
};

/// Number of generators with which a greedy first reached `error`; all of them if it never did.
Index size_at(const ConeHistory &history, double error) {
  std::size_t r = 1;
  while (r + 1 < history.error.size() && history.error[r] > error)
    ++r;
  return static_cast<Index>(r);
}

} // namespace

/// Factorisations of different sizes are not nested, so that the smallest size within the tolerance
/// is looked for on a ladder: from what CPG needs for 4 times the tolerance (the factorisation
/// halves its error, about), in steps of a tenth, to all that CPG takes, which reproduce the
/// snapshots.
Cone nmf_cone(const Matrix &snapshots, const SparseMatrix &product, const ConeOptions &options) {
  const Cone start = projected_greedy_cone(
      snapshots, product, {.type = ConeType::cpg, .tolerance = 0, .max_size = options.max_size});
  const Factorisation factorisation(snapshots, product, start.basis.generators);
  const Index last = start.size();
  Index size = options.max_size > 0 ? last : size_at(start.history, 4 * options.tolerance);
  Cone cone;
  ConeHistory &history = cone.history;
  history.size = {0};
  history.error = {1};
  double best = 2; // no projection onto a cone is farther than 1
  for (;;) {
    Attempt tried = factorisation.attempt(size);
    history.size.push_back(static_cast<int>(tried.generators.cols()));
    history.error.push_back(tried.error);
    history.gram_condition.push_back(tried.gram_condition);
    if (tried.error < best) {
      best = tried.error;
      cone.basis.generators = std::move(tried.generators);
    }
    if (tried.error <= options.tolerance || size == last) break;
    size = std::min(last, size + (size + 9) / 10);
  }
  history.reason = best <= options.tolerance ? "tolerance reached"
                   : best <= round_off       ? "round-off reached"
                   : options.max_size > 0    ? "size reached"
                                             : "stagnation";
  return cone;
}

} // namespace rbvi
