#include "rbvi/contact/support_outputs.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// Arc lengths of the points from the middle of the curve.
Vector arc_lengths(const Matrix &points) {
  Vector s = Vector::Zero(points.rows());
  for (Index i = 1; i < s.size(); ++i)
    s[i] = s[i - 1] + (points.row(i) - points.row(i - 1)).norm();
  return s.array() - s[s.size() - 1] / 2;
}

/// Below its bound by more than round-off, and than the law is met to.
bool sticks(double tangential, double bound, double violation) {
  return tangential < (1 - 1e-9) * bound - violation;
}

} // namespace

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

double direction_count(const Vector &tangential, const Vector &pressure) {
  const auto in_contact = [&](const auto &of_sign) {
    return (of_sign && pressure.array() > 0).any() ? 1.0 : 0.0;
  };
  return in_contact(tangential.array() > 0) + in_contact(tangential.array() < 0);
}

void drop_plane_outputs(Outputs &outputs) {
  for (const auto member : {&Outputs::horizontal_reaction, &Outputs::contact_half_width,
                            &Outputs::stick_half_width, &Outputs::centre_pressure})
    (outputs.*member).reset();
}

void support_outputs(const SupportState &state, Outputs &outputs) {
  const Index count = state.weights.size();
  const Vector pressure = state.lambda.head(count);
  double contact = 0;
  for (Index i = 0; i < count; ++i)
    if (pressure[i] > 0) contact += state.weights[i];
  outputs.contact_nodes = static_cast<double>((pressure.array() > 0).count());
  outputs.free_nodes = static_cast<double>(count) - *outputs.contact_nodes;
  outputs.normal_force = state.weights.dot(pressure);
  outputs.reaction = -state.lift.dot(state.lambda);
  outputs.horizontal_reaction = -state.push.dot(state.lambda);
  outputs.contact_measure = contact;
  outputs.contact_half_width = contact / 2;
  outputs.peak_pressure = pressure.maxCoeff();
  if (state.points.rows() > 0)
    outputs.centre_pressure = centre_pressure(pressure, arc_lengths(state.points), contact / 2);
  if (state.lambda.size() > count)
    friction_outputs(1, state.weights, state.lambda, state.bound, outputs);
}

void friction_outputs(double images, const Vector &weights, const Vector &lambda,
                      const FrictionBound &bound, Outputs &outputs) {
  const Index count = weights.size();
  const Vector pressure = lambda.head(count), shear = lambda.tail(count).cwiseAbs(),
               bounds = values_of(bound, pressure);
  double stick = 0, sticking = 0;
  const double violation = std::max(0.0, (shear - bounds).maxCoeff());
  for (Index i = 0; i < count; ++i)
    if (pressure[i] > 0 && sticks(shear[i], bounds[i], violation)) {
      stick += weights[i];
      ++sticking;
    }
  const double directions = direction_count(lambda.tail(count), pressure);
  outputs.slip_directions = std::min(images * directions, 2.0); // an image slips the other way
  outputs.tangential_force = images * weights.dot(shear);
  outputs.stick_half_width = images * stick / 2;
  outputs.stick_nodes = images * sticking;
  outputs.friction_violation = violation;
}

} // namespace rbvi
