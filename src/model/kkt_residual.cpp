#include "rbvi/model/cone_solver.hpp"

#include "rbvi/core/largest.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// Of the terms of B u: where bodies touch without a gap, B u and g are round-off, 1e-16 of these
/// terms times the condition number of A (1e3 with modes down to 1e-6 of the first), which
/// 1e-12 of them, the largest residual of an answer over this scale, has to contain.
constexpr double resolved = 1e-4;

} // namespace

double kkt_residual(const KktTerms &answer) {
  const auto &[au, btx, f, bu, g, x, free, terms] = answer;
  const auto relative = [](double error, double scale) { return error == 0 ? 0 : error / scale; };
  const double stationarity = relative((au + btx - f).norm(), f.norm() + btx.norm());
  const double scale =
      std::max({g.lpNorm<Eigen::Infinity>(), bu.lpNorm<Eigen::Infinity>(), resolved * terms});
  const Vector excess = bu - g;
  const double unequal = free > 0 ? excess.tail(free).cwiseAbs().maxCoeff() : 0;
  const double infeasible = relative(std::max({0.0, excess.maxCoeff(), unequal}), scale);
  const double gap = relative(std::abs(x.dot(excess)), scale * x.lpNorm<1>());
  return largest({stationarity, infeasible, gap});
}

} // namespace rbvi
