// What people ask of contact with a rigid support: forces, half-widths, pressures.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/outputs.hpp"
#include "rbvi/method/node_laws.hpp"

namespace rbvi {

/// At the middle of a curve: by a fit of p against s^2 over arc lengths |s| < 0.12 half_width, or
/// the next value where that holds fewer than three.
double centre_pressure(const Vector &pressure, const Vector &arc_length, double half_width);

/// One state of contact on a curve.
struct SupportState {
  const Vector &lambda;  ///< normal multipliers, then tangential ones if there are any
  const Vector &weights; ///< vertices: integral of the hat function
  const Vector &push;    ///< multipliers: their work on a unit horizontal displacement, B e_x
  const Vector &lift;    ///< and on a vertical one, B e_y
  FrictionBound bound;
  const Matrix &points; ///< mapped vertices x dim, along the curve; empty: it has no middle
};

/// The signs, 0 to 2 of them, that the tangential stress has where there is pressure.
double direction_count(const Vector &tangential, const Vector &pressure);

/// Those of a section of the plane, which a body that is turned does not have: horizontal_reaction,
/// contact_half_width, stick_half_width, centre_pressure.
void drop_plane_outputs(Outputs &outputs);

/// Of normal and tangential multipliers: tangential_force, stick_half_width, friction_violation (a
/// pressure), of `images` mirror images together. A node sticks where it is below its bound by more
/// than that.
void friction_outputs(double images, const Vector &weights, const Vector &lambda,
                      const FrictionBound &bound, Outputs &outputs);

/// Fills normal_force, contact_measure, contact_half_width (half of the measure), reaction,
/// horizontal_reaction, peak_pressure, centre_pressure, the numbers of nodes and, with friction,
/// what friction_outputs does.
void support_outputs(const SupportState &state, Outputs &outputs);

} // namespace rbvi
