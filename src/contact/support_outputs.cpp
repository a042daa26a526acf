#include "rbvi/contact/support_outputs.hpp"

#include "rbvi/contact/interface.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

double friction_violation(const Vector &tangential, const Vector &bounds) {
  return std::max(0.0, (tangential.cwiseAbs() - bounds).maxCoeff());
}

double sticks_by(double tangential, double bound, double violation) {
  return std::max(0.0, (1 - 1e-9) * bound - violation - std::abs(tangential));
}

Middle middle_of(const MirrorPlanes &mirrors, const std::vector<Point> &points, bool open) {
  if (!open || mirrors.size() > 1) return Middle::none;
  if (mirrors.empty()) return Middle::halfway;
  const Vector images = image_counts(mirrors, points);
  const bool at_first = images[0] == 1, at_last = images[images.size() - 1] == 1;
  return at_first == at_last ? Middle::none : at_first ? Middle::first : Middle::last;
}

Vector arc_lengths(const Matrix &points) {
  Vector s = Vector::Zero(points.rows());
  for (Index i = 1; i < s.size(); ++i)
    s[i] = s[i - 1] + (points.row(i) - points.row(i - 1)).norm();
  return s;
}

Vector from_middle(Middle middle, const Vector &arc, double length) {
  switch (middle) {
  case Middle::halfway:
    return arc.array() - length / 2;
  case Middle::first:
    return arc;
  case Middle::last:
    return length - arc.array();
  default:
    return {};
  }
}

double centre_pressure(const Vector &pressure, const Vector &s, double half_width, bool halved) {
  std::array<Index, 2> around{-1, -1}; // the last one before the middle, the first one behind it
  double count = 0, x = 0, xx = 0, p = 0, xp = 0; // p = a + b x, x = s^2
  for (Index i = 0; i < s.size(); ++i) {
    Index &next = around[s[i] < 0 ? 0 : 1];
    if (next < 0 || std::abs(s[i]) < std::abs(s[next])) next = i;
    if (!(std::abs(s[i]) < 0.12 * half_width)) continue;
    const double square = s[i] * s[i], images = halved && s[i] > 0 ? 2 : 1;
    count += images;
    x += images * square;
    xx += images * square * square;
    p += images * pressure[i];
    xp += images * square * pressure[i];
  }
  if (count >= 3) return (p * xx - xp * x) / (count * xx - x * x);
  const auto [before, behind] = around;
  if (before < 0 || behind < 0) return pressure[std::max(before, behind)];
  return (s[behind] * pressure[before] - s[before] * pressure[behind]) / (s[behind] - s[before]);
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

void make_whole(const MirrorPlanes &mirrors, Outputs &outputs) {
  const int images = image_count(mirrors);
  for (const auto member :
       {&Outputs::normal_force, &Outputs::tangential_force, &Outputs::reaction,
        &Outputs::horizontal_reaction, &Outputs::force_x, &Outputs::force_y, &Outputs::force_z,
        &Outputs::contact_measure, &Outputs::contact_half_width, &Outputs::stick_half_width})
    if (std::optional<double> &of_domain = outputs.*member) *of_domain *= images;
  // An image slips the other way; what counts in space has seen the images.
  if (outputs.slip_directions && !outputs.force_x)
    outputs.slip_directions = std::min(images * *outputs.slip_directions, 2.0);
  if (cancels(mirrors, 0)) outputs.horizontal_reaction.reset();
  if (cancels(mirrors, 1)) outputs.reaction.reset();
  constexpr std::array forces{&Outputs::force_x, &Outputs::force_y, &Outputs::force_z};
  for (std::size_t c = 0; c < forces.size(); ++c)
    if (cancels(mirrors, c)) (outputs.*forces[c]).reset();
}

void support_outputs(const SupportState &state, Outputs &outputs) {
  const Index count = state.weights.size();
  const Vector pressure = state.lambda.head(count);
  pressure_outputs(state.images, state.weights, pressure, 0, outputs);
  outputs.reaction = state.force[1];
  outputs.horizontal_reaction = state.force[0];
  outputs.contact_half_width = *outputs.contact_measure / 2;
  if (const bool halved = is_halved(state.middle); state.s.size() > 0)
    outputs.centre_pressure =
        centre_pressure(pressure, state.s, *outputs.contact_measure / (halved ? 1 : 2), halved);
  if (state.lambda.size() > count)
    friction_outputs(state.images, state.tangential_force, state.weights, state.lambda, state.bound,
                     outputs);
}

void friction_outputs(const Vector &images, double tangential_force, const Vector &weights,
                      const Vector &lambda, const FrictionBound &bound, Outputs &outputs) {
  const Index count = weights.size();
  const Vector pressure = lambda.head(count), shear = lambda.tail(count),
               bounds = values_of(bound, pressure);
  double stick = 0, sticking = 0;
  const double violation = friction_violation(shear, bounds);
  for (Index i = 0; i < count; ++i)
    if (pressure[i] > 0 && sticks_by(shear[i], bounds[i], violation) > 0) {
      stick += weights[i];
      sticking += images[i];
    }
  outputs.slip_directions = direction_count(shear, pressure);
  outputs.tangential_force = tangential_force;
  outputs.stick_half_width = stick / 2;
  outputs.stick_nodes = sticking;
  outputs.friction_violation = violation;
}

void check_pressed_side(double cosine, const Point &x) {
  if (!(cosine > 0))
    throw failure(
        "contact through the body: it is pressed at (" + short_number(x[0]) + ", " +
        short_number(x[1]) +
        ") of its boundary from inside, as what it faces there lies behind it; move less, "
        "or pose contact on a shorter boundary");
}

} // namespace rbvi
