// What people ask of contact with a rigid support: forces, half-widths, pressures.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/outputs.hpp"
#include "rbvi/core/scene.hpp"
#include "rbvi/method/node_laws.hpp"

namespace rbvi {

/// Where the middle of the contact boundary of the whole body is along that of the domain: nowhere
/// where it is not one open piece; at an end that is on a plane of symmetry.
enum class Middle { none, halfway, first, last };
/// `points`: the vertices along a curve in one piece that is `open`, or any.
Middle middle_of(const MirrorPlanes &mirrors, const std::vector<Point> &points, bool open);
inline bool is_halved(Middle middle) {
  return middle == Middle::first || middle == Middle::last;
}
/// The way along points to each.
Vector arc_lengths(const Matrix &points);
/// From the middle, of places by their way along a curve of this length; empty where it has none.
Vector from_middle(Middle middle, const Vector &arc, double length);

/// At the middle of a curve: by a fit of p against s^2 over arc lengths |s| < 0.12 half_width, or
/// linear between the two values around it where that holds fewer than three. `halved`: s >= 0,
/// and what lies beyond the middle is the image of it.
double centre_pressure(const Vector &pressure, const Vector &s, double half_width, bool halved);

/// One state of contact on a curve.
struct SupportState {
  const Vector &lambda;  ///< normal multipliers, then tangential ones if there are any
  const Vector &weights; ///< vertices: integral of the hat function
  const Point &force;    ///< on the body
  FrictionBound bound;
  double tangential_force; ///< integral of the magnitude of the tangential stress
  const Vector &images;    ///< of each vertex
  Middle middle;
  Vector s; ///< vertices: arc lengths from the middle; empty: it has none
};

/// The signs, 0 to 2 of them, that the tangential stress has where there is pressure.
double direction_count(const Vector &tangential, const Vector &pressure);

/// Those of a section of the plane, which a body that is turned does not have: horizontal_reaction,
/// contact_half_width, stick_half_width, centre_pressure.
void drop_plane_outputs(Outputs &outputs);

/// Makes outputs of contact of the domain those of the whole body: forces and lengths are those of
/// all images; components of the force that cancel are taken away.
void make_whole(const MirrorPlanes &mirrors, Outputs &outputs);

/// What tangential stresses miss of their bounds, at most; and what a node that sticks is below
/// its bound by: more than that and than round-off (0: it does not).
double friction_violation(const Vector &tangential, const Vector &bounds);
double sticks_by(double tangential, double bound, double violation);

/// Of normal and tangential multipliers: stick_half_width, friction_violation (a pressure), and
/// tangential_force, which is this. A node sticks where it is below its bound by more than the
/// violation. `images`: as in pressure_outputs.
void friction_outputs(const Vector &images, double tangential_force, const Vector &weights,
                      const Vector &lambda, const FrictionBound &bound, Outputs &outputs);

/// Fills normal_force, contact_measure, contact_half_width (half of the measure), reaction,
/// horizontal_reaction, peak_pressure, centre_pressure, the numbers of nodes and, with friction,
/// what friction_outputs does.
void support_outputs(const SupportState &state, Outputs &outputs);

/// Throws failure where a body is pressed at x (reference) along a normal that points into it, so
/// that it would have to be behind what it touches. `cosine`: between that normal and the body's.
void check_pressed_side(double cosine, const Point &x);

} // namespace rbvi
