// Nitsche's terms for contact with a rigid support in 2D, one point of the contact curve at a time
// (Niakh 2022, 4.3). With the stress on the curve (sigma_n, sigma_tau), the displacement
// (u_n, u_tau) and the gap there,
//
//   P_n = sigma_n - gamma (u_n - gap)     (4.19a)        P_tau = sigma_tau - gamma u_tau   (4.35)
//
// each term is a function of one of these scalars: an energy density, its slope (what the residual
// tests with) and its curvature (what the tangent has). The distributed assembly and the reduced
// models use the same functions. gamma is a pressure over a length.
// Niakh (2022): (4.1)-(4.3), (4.16), (4.17), (4.20), (4.34), (4.37), (4.38).
#pragma once

#include "rbvi/contact/facing.hpp"
#include "rbvi/core/dense.hpp"
#include "rbvi/element/geometry.hpp"

#include <array>

namespace rbvi {

/// Energy density and its derivatives with respect to one scalar.
struct PointTerm {
  double energy, slope, curvature;
};

/// -sigma^2 / (2 gamma): what keeps the method consistent, in a_gamma (4.18), (4.40).
PointTerm consistency_term(double sigma, double gamma);

/// [p]_-^2 / (2 gamma), [p]_- = min(p, 0): contact (4.15), (4.25), (4.24a).
PointTerm contact_term(double p, double gamma);

/// (p^2 - (p - [p]_s)^2) / (2 gamma), [p]_s the projection on [-s, s]: friction of the bound s
/// (4.36), (4.43); nothing where the bound is below zero: no friction.
PointTerm friction_term(double p, double bound, double gamma);

/// What a point of the curve sees of the displacement of the cell beside it: functionals of its
/// dofs, node * 2 + component, the first 2 * nodes_per_cell entries.
struct NitschePoint {
  using Row = Eigen::Matrix<double, 12, 1>;
  double weight = 0;                      ///< of the integral over the mapped edge
  Row sigma_n{}, sigma_tau{}, n{}, tau{}; ///< stress and displacement
  PlacedPoint place{};
  FacedPoint facing{}; ///< at the state
  Point body_normal{}; ///< at rest: Facing's, or that of the mapped edge
  double turning = 0;  ///< sigma_n < 0 times the curvature of what is faced, there

  /// Linear parts of P_n and of P_tau in u.
  Row normal(double gamma) const { return sigma_n - gamma * n; }
  Row tangential(double gamma) const { return sigma_tau - gamma * tau; }
};

/// A triangle beside a curve at one mu.
struct CurveCellAtMu {
  Cell cell;
  int edge; ///< on the curve (Lagrange order)
  Lame material;
  Simplex geometry; ///< mapped
  double gamma = 0;
};

/// What point s of [0, 1] on the edge of a cell sees, of degree scene.degree, at rest; weight: the
/// length of the mapped edge. The axes are those faced at the reference point; edges are straight.
/// The stress is that on the body at rest, sigma n_0.
NitschePoint nitsche_point(const Scene &scene, const Facing &facing, const FullMu &mu,
                           const CurveCellAtMu &at, double s);

/// The Gauss points of the edge, with their weights. Throws failure, naming mu, for an inverted
/// cell.
std::array<NitschePoint, 4> nitsche_points(const Scene &scene, const Facing &facing,
                                           const FullMu &mu, const CurveCellAtMu &at);

/// What a point faces at a displacement, and how far its axes turn to that from the normal n: n
/// becomes c n + s tau, and tau c tau - s n.
struct TurnedAxes {
  FacedPoint facing;
  double c, s;
};
/// `along_n`, `along_tau`: the displacement in the axes of n.
TurnedAxes turned_axes(const Facing &facing, const FullMu &mu, const PlacedPoint &point,
                       const Point &n, double along_n, double along_tau);

/// Turns the axes of a point to those of a displacement of the cell's dofs, for a facing that
/// follows it.
void turn_to(const Facing &facing, const FullMu &mu, const NitschePoint::Row &u,
             NitschePoint &point);

} // namespace rbvi
