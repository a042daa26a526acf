#include "rbvi/contact/support/support_outputs.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// Arc lengths of the points from the middle of the curve.
Vector arc_lengths(const std::vector<Point> &points) {
  Vector s(static_cast<Index>(points.size()));
  s[0] = 0;
  for (Index i = 1; i < s.size(); ++i) {
    const Point &a = points[static_cast<std::size_t>(i) - 1];
    const Point &b = points[static_cast<std::size_t>(i)];
    s[i] = s[i - 1] + std::hypot(b[0] - a[0], b[1] - a[1]);
  }
  return s.array() - s[s.size() - 1] / 2;
}

/// Below its bound by more than round-off, and than the law is met to.
bool sticks(double tangential, double bound, double violation) {
  return tangential < (1 - 1e-9) * bound - violation;
}

} // namespace

FrictionBound friction_bound(const Friction &friction, const FullMu &all_parameters) {
  FrictionBound bound;
  if (friction.law == FrictionLaw::none) return bound;
  const double value = friction.value(all_parameters);
  if (!(value >= 0))
    throw failure("the friction coefficient or threshold is " + short_number(value) +
                  ": it must not be negative");
  (friction.law == FrictionLaw::coulomb ? bound.coefficient : bound.threshold) = value;
  bound.only_in_contact = friction.only_in_contact;
  return bound;
}

Vector friction_bounds(const FrictionBound &bound, const Vector &lambda_n) {
  Vector result = bound.coefficient * lambda_n;
  for (Index i = 0; i < result.size(); ++i)
    if (!bound.only_in_contact || lambda_n[i] > 0) result[i] += bound.threshold;
  return result;
}

double centre_pressure(const Vector &pressure, const Vector &s, double half_width) {
  Index next = 0;
  s.cwiseAbs().minCoeff(&next);
  double count = 0, x = 0, xx = 0, p = 0, xp = 0; // p = a + b x, x = s^2
  for (Index i = 0; i < s.size(); ++i) {
    if (!(std::abs(s[i]) < 0.12 * half_width)) continue;
    const double square = s[i] * s[i];
    ++count;
    x += square;
    xx += square * square;
    p += pressure[i];
    xp += square * pressure[i];
  }
  return count < 3 ? pressure[next] : (p * xx - xp * x) / (count * xx - x * x);
}

void support_outputs(const SupportState &state, Outputs &outputs) {
  const Index count = state.weights.size();
  const Vector pressure = state.lambda.head(count);
  double contact = 0, stick = 0, sticking = 0;
  for (Index i = 0; i < count; ++i)
    if (pressure[i] > 0) contact += state.weights[i];
  outputs.contact_nodes = static_cast<double>((pressure.array() > 0).count());
  outputs.normal_force = state.weights.dot(pressure);
  outputs.reaction = -state.lift.dot(state.lambda);
  outputs.contact_measure = contact;
  outputs.contact_half_width = contact / 2;
  outputs.peak_pressure = pressure.maxCoeff();
  outputs.centre_pressure = centre_pressure(pressure, arc_lengths(state.points), contact / 2);
  if (state.lambda.size() == count) return;

  const Vector shear = state.lambda.tail(count).cwiseAbs();
  const Vector bounds = friction_bounds(state.bound, pressure);
  const double violation = std::max(0.0, (shear - bounds).maxCoeff());
  for (Index i = 0; i < count; ++i)
    if (pressure[i] > 0 && sticks(shear[i], bounds[i], violation)) {
      stick += state.weights[i];
      ++sticking;
    }
  outputs.tangential_force = state.weights.dot(shear);
  outputs.stick_half_width = stick / 2;
  outputs.stick_nodes = sticking;
  outputs.friction_violation = violation;
}

} // namespace rbvi
