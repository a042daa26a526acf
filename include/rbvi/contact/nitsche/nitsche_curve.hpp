// Nitsche's terms along the whole contact curve, on the dofs of the cells beside it (the contact
// layer), from the terms of contact/nitsche/nitsche.hpp. Serial: the layer is small beside the
// domain, and every rank holds all of it. The energy is a quadratic one, a_gamma(u, u) / 2 - f(u)
// with a_gamma = a + consistency (4.18), (4.40), and the integrals of contact and friction over the
// pressures P_n, P_tau, which are affine in u.
//
// Where contact follows the displacement (large deformations) the axes n, tau of each point are
// those of the state: the residual is that in the axes at u itself, and the tangent adds what n
// turns by, sigma_n kappa tau tau^T in contact, kappa the curvature of what is faced (from afar
// sigma_n is far smaller than P_n). What is left out, mostly of the tangential stress, is small:
// the steps converge linearly, but fast. There is no energy then.
#pragma once

#include "rbvi/contact/nitsche/nitsche.hpp"
#include "rbvi/core/outputs.hpp"

#include <vector>

namespace rbvi {

struct Contact;

/// A cell beside the curve. Its dofs, node * 2 + component, are numbered in the layer; -1: fixed,
/// or not there (degree 1).
struct CurveCell {
  Cell cell; ///< reference; mapped alike
  int edge = 0;
  std::array<int, 12> dofs;
};

/// The curve of one interface. gamma = gamma0 (lambda + 2 shear) / h on each edge, h its length in
/// the reference domain. `scene` has a material and outlives it.
struct NitscheCurve {
  const Scene &scene;
  Friction law;
  NitscheFacing facing;
  double gamma0;
  std::vector<CurveCell> cells; ///< along the curve, by increasing x
  bool friction() const { return law.law != FrictionLaw::none; }
  /// Whether the consistency term has sigma_tau beside sigma_n. Where the axes turn it does without
  /// friction too: the whole stress does not depend on them.
  bool whole_stress() const { return friction() || facing.follows_state; }
};

/// The one of contact by Nitsche's method, which has a single interface. Throws failure where
/// multipliers hold contact.
const NitscheCurve &curve_of(const Contact &contact);

/// What it sees at one mu. Rows of NitschePoint are for these dofs.
struct NitscheFace {
  std::array<NitschePoint, 4> points;
  double gamma = 0;
  std::array<int, 12> dofs;
};

using FaceBlock = Eigen::Matrix<double, 12, 12>;

/// A cell at mu: mapped, with its material and its gamma.
struct CurveCellAtMu {
  Cell cell;
  Lame material;
  double gamma;
};
CurveCellAtMu curve_cell_at(const NitscheCurve &curve, const FullMu &mu, const CurveCell &cell);

/// The faces of some cells of the curve, in their order. `state`: u of the layer, where contact
/// follows it; empty: at rest. Throws failure, naming mu, for an inverted cell.
std::vector<NitscheFace> nitsche_faces(const NitscheCurve &curve, const FullMu &mu,
                                       const std::vector<CurveCell> &cells,
                                       const Vector &state = {});

/// Turns their axes to another state; nothing where contact does not follow it.
void turn_to(const NitscheCurve &curve, const FullMu &mu, const Vector &state,
             std::vector<NitscheFace> &faces);

/// Friction::law with its threshold or coefficient at one mu.
struct NitscheLaw {
  FrictionLaw law = FrictionLaw::none;
  double value = 0;
  bool only_in_contact = false; ///< Tresca's threshold holds where [P_n]_- < 0 alone
  /// Whether the bounds depend on u.
  bool moves() const { return law == FrictionLaw::coulomb || only_in_contact; }
};

/// Throws failure, naming the value, for a negative one.
NitscheLaw nitsche_law(const NitscheCurve &curve, const FullMu &mu);

/// P_n (4.19a) and P_tau (4.35) at every point, face by face: 4 * faces rows, 2 columns.
Matrix nitsche_pressures(const std::vector<NitscheFace> &faces, const Vector &u);

/// What a change of u adds to them.
Matrix nitsche_pressure_changes(const std::vector<NitscheFace> &faces, const Vector &du);

/// The bound of friction at every point that these pressures tell: s (4.33), or s^c (4.51); empty
/// without friction.
Vector nitsche_bounds(const Matrix &pressures, const NitscheLaw &law);

/// a_gamma - a, a block for each face: (4.18), with the whole stress (4.40).
std::vector<FaceBlock> nitsche_consistency(const std::vector<NitscheFace> &faces,
                                           bool whole_stress);

/// Integrals of contact in J^Nitsche (4.15) and of friction of these bounds (4.36); without
/// friction `bounds` is empty.
double nitsche_energy(const std::vector<NitscheFace> &faces, const Vector &u, const Vector &bounds);

/// Their gradient, `u.size()` entries: theta_gamma^n (4.25), theta_gamma^tau (4.43b), (4.55b).
Vector nitsche_residual(const std::vector<NitscheFace> &faces, const Vector &u,
                        const Vector &bounds);

/// Their Hessian at given pressures, a block for each face, the bounds being fixed: b_gamma^n
/// (4.24a), b_gamma^tau (4.43a), (4.55a); and what their axes turn by.
std::vector<FaceBlock> nitsche_tangent(const std::vector<NitscheFace> &faces,
                                       const Matrix &pressures, const Vector &bounds);

/// d^T (what the axes turn by in that Hessian) d.
double nitsche_turning(const std::vector<NitscheFace> &faces, const Matrix &pressures,
                       const Vector &d);

/// The gradient at u of the terms linearised about given pressures: those who are in contact, and
/// who stick, there.
Vector nitsche_linearised(const std::vector<NitscheFace> &faces, const Vector &u,
                          const Matrix &pressures, const Vector &bounds);

/// The integrals along u + t d, which are piecewise quadratic in t.
struct NitscheLine {
  Vector weights, gamma;
  Matrix start, change;         ///< pressures at t = 0, and what t = 1 adds
  Vector bounds;                ///< of friction; empty without
  double slope(double t) const; ///< of their sum
};
NitscheLine nitsche_line(const std::vector<NitscheFace> &faces, const Vector &u, const Vector &d,
                         const Vector &bounds);

/// The t > 0 where `linear` + t `quadratic` + line.slope(t) vanishes, to one per cent of its value
/// at 0, of which it must be below zero: the minimum along a line of a convex energy. At most 16.
double line_minimum(double linear, double quadratic, const NitscheLine &line);

/// Fields at the vertices of the curve, by increasing x: stress averaged from the edges that meet
/// there, the pressures with it, and u_n less the gap.
struct CurveFields {
  Vector sigma_n, sigma_tau, p_n, p_tau, excess;
  Vector arc_length; ///< from the middle, mapped
};
CurveFields nitsche_fields(const NitscheCurve &curve, const FullMu &mu, const Vector &u);

/// -sigma_n, then with friction -sigma_tau at the vertices: what stands for the multipliers of the
/// mixed method.
Vector nitsche_multiplier(const CurveFields &fields, bool friction);

/// How many of the curve's two ends are in contact.
double ends_in_contact(const CurveFields &fields);

/// Fills forces, half-widths, pressures, penetration and the errors of the laws; see
/// support_outputs. centre_pressure is that of -[P_n]_- averaged over each edge.
void nitsche_outputs(const std::vector<NitscheFace> &faces, const Matrix &pressures,
                     const CurveFields &fields, const NitscheLaw &law, Outputs &outputs);

} // namespace rbvi
