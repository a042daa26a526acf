// Niakh (2022): (3.40), (3.52), (3.55).
#include "rbvi/method/published/collocated_friction.hpp"

#include "rbvi/core/text.hpp"
#include "rbvi/method/nonnegative_qp.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// Below it a row of T says nothing, and what is left of a projection is zero: its changes would
/// never end.
constexpr double projection_noise = 1e-13;

/// a >= 0, then the b nearest to the given one with |T b| <= s, the bounds at this a: a
/// least-distance problem, whose dual is non-negative in the multipliers of both signs of T b.
class Projection {
public:
  explicit Projection(const CollocatedProblem &p)
      : p_(p), bounds_(bounds_per_node(p.bounds, p.normal_rows.rows())),
        qp_(p.tangential_rows.cols()), y_(p.tangential_rows.cols(), 2 * p.tangential_rows.rows()) {
    const Vector norms = p.tangential_rows.rowwise().norm();
    const double least = projection_noise * norms.lpNorm<Eigen::Infinity>();
    const Vector kept = (norms.array() > least).cast<double>();
    y_.leftCols(norms.size()) = p.tangential_rows.transpose() * kept.asDiagonal();
    y_.rightCols(norms.size()) = -y_.leftCols(norms.size());
  }
  Vector operator()(Vector x) {
    const Index r = p_.normal_rows.cols(), s = p_.tangential_rows.cols();
    x.head(r) = x.head(r).cwiseMax(0);
    const Vector pressure = p_.normal_rows * x.head(r);
    const Vector bound = Vector::NullaryExpr(
        pressure.size(), [&](Index j) { return bounds_[j].value(pressure[j]); });
    qp_.solve(y_, x.tail(s), bound.replicate(2, 1));
    if (qp_.residual().norm() <= projection_noise * x.tail(s).norm())
      x.tail(s).setZero();
    else
      x.tail(s) = qp_.residual();
    return x;
  }

private:
  const CollocatedProblem &p_;
  std::vector<FrictionBound> bounds_;
  NonnegativeQp qp_;
  Matrix y_;
};

} // namespace

CollocatedResult solve_collocated_by_uzawa(const CollocatedProblem &problem, const Matrix &product,
                                           const UzawaOptions &options) {
  const Index r = problem.normal_rows.cols(), s = problem.tangential_rows.cols();
  Projection projection(problem);
  const auto size = [](const auto &x, const auto &of) { return std::sqrt(x.dot(of * x)); };
  const UzawaResult found =
      solve_uzawa({.times_h = [&](const Vector &x) { return Vector(problem.h * x); },
                   .q = problem.q,
                   .projection = [&](const Vector &x) { return projection(x); },
                   .dot = [](const Vector &x, const Vector &y) { return x.dot(y); },
                   .sizes =
                       [&](const Vector &x) {
                         return std::array{size(x.head(r), product.topLeftCorner(r, r)),
                                           size(x.tail(s), product.bottomRightCorner(s, s))};
                       },
                   .first = Vector::Ones(problem.q.size())},
                  options);
  return {.x = found.x,
          .w = problem.h * found.x + problem.q,
          .iterations = found.iterations,
          .residual = found.change,
          .converged = found.converged,
          .reason = "Uzawa's method does not converge in " + std::to_string(found.iterations) +
                    " iterations: the last one changes the multipliers by " +
                    short_number(found.change)};
}

} // namespace rbvi
