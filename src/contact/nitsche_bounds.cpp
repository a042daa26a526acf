// Bounds of friction that follow the pressure by Nitsche's method.
#include "rbvi/contact/nitsche_curve.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

constexpr double steepest = 1e3; ///< of a threshold in contact alone, by the pressure

/// Of a law that jumps: what it jumps to.
double highest(const NitscheLaw &law) {
  return law->piece(0).offset;
}

} // namespace

double nitsche_bound(const NitscheLaw &law, double p_n) {
  if (!law) return -1;
  const double pressure = std::max(0.0, -p_n), bound = law->value(pressure);
  return law->jumps() ? std::min(bound, steepest * pressure) : bound;
}

Vector FollowingBounds::next(std::span<const NitscheLaw> laws, const Matrix &pressures,
                             const Vector &bounds) {
  Vector result(bounds.size()), excess = Vector::Zero(bounds.size());
  std::vector<Index> between;
  const bool first = bounds_.size() != bounds.size();
  for (Index i = 0; i < bounds.size(); ++i) {
    const NitscheLaw &law = laws[static_cast<std::size_t>(i)];
    result[i] = nitsche_bound(law, pressures(i, 0));
    if (!law || !law->jumps()) continue;
    excess[i] = pressures(i, 0) + bounds[i] / steepest;
    const bool inside = bounds[i] > 0 && bounds[i] < highest(law);
    if (!first && (inside || excess[i] * excess_[i] < 0)) between.push_back(i);
  }
  if (between != between_) { // each by its own change
    slopes_ = Matrix::Zero(std::ssize(between), std::ssize(between));
    for (Index k = 0; k < slopes_.rows(); ++k) {
      const Index i = between[k];
      const double slope = (excess[i] - excess_[i]) / (bounds[i] - bounds_[i]);
      slopes_(k, k) = slope > 0 ? slope : std::abs(excess[i]) / highest(laws[i]);
    }
    between_ = between;
  } else if (!between.empty()) { // Broyden's
    const Vector change = (bounds - bounds_)(between), rise = (excess - excess_)(between);
    if (change.norm() > 0)
      slopes_ += (rise - slopes_ * change) * change.transpose() / change.squaredNorm();
  }
  Vector step;
  if (!between.empty()) step = lu_solve(slopes_, -Vector(excess(between)));
  for (Index k = 0; k < step.size(); ++k)
    if (const Index i = between[k]; std::isfinite(step[k]))
      result[i] = std::clamp(bounds[i] + step[k], 0.0, highest(laws[i]));
  bounds_ = bounds;
  excess_ = std::move(excess);
  return result;
}

int settle_bounds(std::span<const NitscheLaw> laws, const BoundLoops &loops) {
  constexpr double small_change = 1e-12; // of u by new bounds, relative
  constexpr double round_off = 1e-9,
                   stagnant = 0.9; // it may rest here, and does where it falls less
  constexpr int most = 60;
  FollowingBounds following;
  double tolerance = loops.loosest, last_change = 1;
  for (int loop = 1;; ++loop) {
    const double change = loops.newton(tolerance);
    const Vector used = loops.bounds;
    loops.bounds = following.next(laws, loops.pressures(), used);
    const bool rests = change <= round_off && change > stagnant * last_change;
    // The first bounds are those of the start, not of u.
    const bool settled = loop > 1 && (change <= small_change || rests);
    if (settled && tolerance <= loops.accuracy) {
      loops.bounds = used; // under which forces balance
      return loop;
    }
    last_change = change;
    tolerance = std::clamp(1e-2 * change, loops.accuracy, tolerance);
    if (loop == most)
      throw failure("the bound of friction did not settle in " + std::to_string(most) +
                    " loops: it still changes u by " + short_number(change));
  }
}

} // namespace rbvi
