// Nitsche's terms along the contact curves, on the dofs of the cells beside them (the contact
// layer), from the terms of contact/nitsche.hpp. Serial: the layer is small beside the
// domain, and every rank holds all of it. The energy is a quadratic one, a_gamma(u, u) / 2 - f(u)
// with a_gamma = a + consistency (4.18), (4.40), and the integrals of contact and friction over the
// pressures P_n, P_tau, which are affine in u.
//
// Where contact follows the displacement (large deformations) the axes n, tau of each point are
// those of the state: the residual is that in the axes at u itself, and the tangent adds what n
// turns by, sigma_n kappa tau tau^T in contact, kappa the curvature of what is faced (from afar
// sigma_n is far smaller than P_n). What is left out, mostly of the tangential stress, is small:
// the steps converge linearly, but fast. There is no energy then.
// Niakh (2022): (4.4), (4.5), (4.12), (4.13), (4.39), (4.42), (4.44), (4.49), (4.50), (4.52).
#pragma once

#include "rbvi/contact/nitsche.hpp"
#include "rbvi/contact/support_outputs.hpp"
#include "rbvi/core/outputs.hpp"

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace rbvi {

struct Contact;

/// A cell beside a curve. Its dofs, node * 2 + component, are numbered in the layer; -1: fixed,
/// or not there (degree 1).
struct CurveCell {
  Cell cell; ///< reference; mapped alike
  int edge = 0;
  std::array<int, 12> dofs;
  std::array<int, 2> ends{}; ///< where the edge begins and ends, vertices of the curve
  int curve = 0;             ///< of the layer's
  int material = 0;          ///< of the scene's
};

/// The law of friction at one mu; none without friction.
using NitscheLaw = std::optional<FrictionBound>;

/// Whether the bounds depend on u.
inline bool moves(const NitscheLaw &law) {
  return law && law->follows_pressure();
}

/// The curve of one interface. gamma = gamma0 (lambda + 2 shear) / h on each edge, h its length in
/// the reference domain.
struct NitscheCurve {
  Friction law;
  Facing facing;
  double gamma0;
  std::vector<int> open_ends{}; ///< vertices where pieces end that are not closed
  Middle middle = Middle::halfway;
  Vector images{}; ///< of each vertex
  bool friction() const { return law.law != FrictionLaw::none; }
  /// Throws failure, naming the value, for a negative one.
  NitscheLaw law_at(const FullMu &mu) const;
};

/// The curves of all interfaces. `scene` has a material and outlives it.
struct NitscheLayer {
  const Scene &scene;
  std::vector<NitscheCurve> curves;
  std::vector<CurveCell> cells; ///< curve by curve, in the order of their meshes
  bool friction() const;        ///< of some curve
  bool follows_state() const;   ///< some facing does
  const NitscheCurve &curve_of(const CurveCell &cell) const { return curves[cell.curve]; }
  std::span<const CurveCell> cells_of(std::size_t curve) const;
};

/// All of contact by Nitsche's method. Throws failure where multipliers hold it.
NitscheLayer layer_of(const Contact &contact);

/// What a cell sees at one mu. Rows of NitschePoint are for these dofs.
struct NitscheFace {
  std::array<NitschePoint, 4> points;
  double gamma = 0;
  std::array<int, 12> dofs;
  int curve = 0;
  NitscheLaw law{};
  /// Whether the consistency term has sigma_tau beside sigma_n: with friction; and where the axes
  /// turn, as the whole stress does not depend on them.
  bool whole_stress = false;
};

using FaceBlock = Eigen::Matrix<double, 12, 12>;

CurveCellAtMu curve_cell_at(const NitscheLayer &layer, const FullMu &mu, const CurveCell &cell);

/// The faces of some cells of the layer, in their order. `state`: u of the layer, where contact
/// follows it; empty: at rest. Throws failure, naming mu, for an inverted cell.
std::vector<NitscheFace> nitsche_faces(const NitscheLayer &layer, const FullMu &mu,
                                       const std::vector<CurveCell> &cells,
                                       const Vector &state = {});

/// Turns their axes to another state; nothing where contact does not follow it.
void turn_to(const NitscheLayer &layer, const FullMu &mu, const Vector &state,
             std::vector<NitscheFace> &faces);

/// P_n (4.19a) and P_tau (4.35) at every point, face by face: 4 * faces rows, 2 columns.
Matrix nitsche_pressures(const std::vector<NitscheFace> &faces, const Vector &u);

/// The bound of friction that the pressure P_n at a point of this law tells: s (4.33), or s^c
/// (4.51); -1 without friction. A threshold that acts in contact alone rises with the pressure,
/// from 0 to s at s / 1000: where friction lifts a point off that touches without it, some bound
/// between them is the answer.
double nitsche_bound(const NitscheLaw &law, double p_n);

/// Bounds that follow u, one loop of frozen ones after the other. Where a threshold turns back and
/// forth, that at which bound and pressure agree, by Broyden's method.
class FollowingBounds {
public:
  /// From the pressures that bounds have led to, those of the next loop.
  Vector next(std::span<const NitscheLaw> laws, const Matrix &pressures, const Vector &bounds);

private:
  Vector bounds_, excess_;     ///< of the loop before
  std::vector<Index> between_; ///< points where the threshold turns
  Matrix slopes_;              ///< of their excesses by their bounds
};

/// Newton's method with bounds frozen, in a loop in which they follow u (4.63).
struct BoundLoops {
  /// With the bounds as they are, until the residual is at most `tolerance`; the change of u, as a
  /// part of it.
  std::function<double(double tolerance)> newton;
  std::function<Matrix()> pressures; ///< P_n and P_tau at u
  Vector &bounds;
  double loosest, accuracy; ///< tolerances: of the first loop, of the last one
};
/// Until new bounds do not change u. Returns the loops. Throws failure where there is no end.
int settle_bounds(std::span<const NitscheLaw> laws, const BoundLoops &loops);

/// The terms at P points as functions of their pressures, P x 2, whatever unknowns these are
/// functions of. `bounds` of friction: P of them, or none.
struct NitscheTerms {
  Vector weights, gamma;
  Vector turning; ///< NitschePoint::turning with the weights
  std::vector<NitscheLaw> laws;
  bool friction = false; ///< of some law

  Vector bounds_at(const Matrix &pressures) const;
  /// One of energy, slope and curvature of every term with its weight: of contact, then with bounds
  /// of friction.
  Vector weighted(double PointTerm::*part, const Matrix &pressures, const Vector &bounds) const;
  /// The slopes to first order, where the pressures at which they are taken change.
  Vector linearised(const Matrix &pressures, const Matrix &change, const Vector &bounds) const;
  /// Of tau tau^T: what the normals of the points in contact turn by.
  Vector turning_at(const Matrix &pressures) const {
    return (pressures.col(0).array() < 0).select(turning, 0.0);
  }
};

/// At the points of the faces, face by face.
NitscheTerms terms_of(std::span<const NitscheFace> faces);

/// The bounds at every point; empty where no face has friction.
Vector nitsche_bounds(std::span<const NitscheFace> faces, const Matrix &pressures);
std::vector<NitscheLaw> laws_at_points(std::span<const NitscheFace> faces);

/// Whether the bounds of some face depend on u.
bool bounds_move(const std::vector<NitscheFace> &faces);

/// a_gamma - a, a block for each face: (4.18), with the whole stress (4.40).
std::vector<FaceBlock> nitsche_consistency(const std::vector<NitscheFace> &faces);

/// Integrals of contact in J^Nitsche (4.15) and of friction of these bounds (4.36); without
/// friction `bounds` is empty.
double nitsche_energy(const std::vector<NitscheFace> &faces, const Vector &u, const Vector &bounds);

/// Their gradient, `u.size()` entries: theta_gamma^n (4.25), theta_gamma^tau (4.43b), (4.55b).
Vector nitsche_residual(const std::vector<NitscheFace> &faces, const Vector &u,
                        const Vector &bounds);

/// What round-off in P_n, the difference of large numbers where gamma is large, leaves of its norm.
double nitsche_round_off(const std::vector<NitscheFace> &faces, const Vector &u);

/// Their Hessian at given pressures, a block for each face, the bounds being fixed: b_gamma^n
/// (4.24a), b_gamma^tau (4.43a), (4.55a); and what their axes turn by.
std::vector<FaceBlock> nitsche_tangent(const std::vector<NitscheFace> &faces,
                                       const Matrix &pressures, const Vector &bounds);

/// The gradient at u of the terms linearised about given pressures: those who are in contact, and
/// who stick, there.
Vector nitsche_linearised(const std::vector<NitscheFace> &faces, const Vector &u,
                          const Matrix &pressures, const Vector &bounds);

/// The integrals along u + t d, which are piecewise quadratic in t.
struct NitscheLine {
  NitscheTerms terms;
  Matrix start, change;         ///< pressures at t = 0, and what t = 1 adds
  Vector bounds;                ///< of friction; empty without
  double turning = 0;           ///< d^T (what the axes turn by in the Hessian at u) d
  double slope(double t) const; ///< of their sum
};
NitscheLine nitsche_line(const std::vector<NitscheFace> &faces, const Vector &u, const Vector &d,
                         const Vector &bounds);

/// The t > 0 where `linear` + t `quadratic` + line.slope(t) vanishes, to one per cent of its value
/// at 0, of which it must be below zero: the minimum along a line of a convex energy. At most 16.
double line_minimum(double linear, double quadratic, const NitscheLine &line);

/// Fields at the vertices of one curve, in the order of its mesh: stress averaged from the edges
/// that meet there, the pressures with it, and u_n less the gap.
struct CurveFields {
  Vector sigma_n, sigma_tau, p_n, p_tau, excess;
  Vector arc_length;   ///< from the middle, mapped; empty where the curve has none
  Vector images;       ///< of each vertex
  bool halved = false; ///< the arc lengths are those of one half of the whole curve
};
CurveFields nitsche_fields(const NitscheLayer &layer, std::size_t curve, const FullMu &mu,
                           const Vector &u);

/// -sigma_n, then with friction -sigma_tau at the vertices, curve by curve: what stands for the
/// multipliers of the mixed method.
Vector nitsche_multiplier(const NitscheLayer &layer, const FullMu &mu, const Vector &u);

/// What outputs have a point push the body with, its weight included, at pressures P_n and P_tau;
/// `bound` >= 0: of friction there.
Point nitsche_force(const NitschePoint &point, double p_n, double p_tau, double bound);

/// How many of a curve's open ends are in contact.
double ends_in_contact(const CurveFields &fields, const std::vector<int> &open_ends);

/// Fills forces, half-widths, pressures, penetration and the errors of the laws of one curve; see
/// support_outputs. `faces`: all of the curve. centre_pressure is that of -[P_n]_- averaged over
/// each edge.
void nitsche_outputs(std::span<const NitscheFace> faces, const Matrix &pressures,
                     const Vector &bounds_there, const CurveFields &fields, Outputs &outputs);

/// The same of all curves of the layer: with several, what are sums or maxima over them, and the
/// errors of the laws over the nodes of all, so that one without contact does not count. `faces`:
/// of all cells; `u`, the pressures and the bounds of friction are those of their state.
void nitsche_outputs(const NitscheLayer &layer, const FullMu &mu,
                     const std::vector<NitscheFace> &faces, const Vector &u,
                     const Matrix &pressures, const Vector &bounds, Outputs &outputs);

} // namespace rbvi
