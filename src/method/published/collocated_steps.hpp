// The steps of collocated_friction.hpp: the problem with its bounds frozen, Newton's step on given
// sets, and what is left of both where bounds are zero.
#pragma once

#include "rbvi/core/error.hpp"
#include "rbvi/method/nonnegative_qp.hpp"
#include "rbvi/method/published/collocated_friction.hpp"

#include <compare>
#include <limits>
#include <memory>
#include <vector>

namespace rbvi::collocated {

inline constexpr double accuracy = 1e-12; ///< largest residual of a solution
inline constexpr double round_off =
    1e-13; ///< nothing is violated, a row of T says nothing, below it
inline constexpr double infinity = std::numeric_limits<double>::infinity();

inline signed char sign(double value) {
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

/// H is not positive definite.
Error not_positive_definite();

/// The problem in the scaling in which H has a unit diagonal: x = unit * (scaled x). Rows of T at
/// round-off are left out; the others have the norm `size`.
struct ScaledProblem {
  Vector unit, q, size;
  Matrix h, normal, tangential;
  std::vector<FrictionBound> bound; ///< of each node

  Index nodes() const { return tangential.rows(); }
  Index generators() const { return normal.cols(); }
  Index modes() const { return tangential.cols(); }

  Vector pressures(const Vector &x) const { return normal * x.head(generators()); }
  /// s at N a
  Vector bounds(const Vector &x) const {
    const Vector p = pressures(x);
    return Vector::NullaryExpr(nodes(), [&](Index j) { return bound[j].value(p[j]); });
  }
};

ScaledProblem scaled(const CollocatedProblem &problem);

/// Which generators may carry pressure; which nodes are at their bound: -1, 0 or 1, the sign of
/// T b; and on which piece of their laws those are.
struct ActiveSets {
  std::vector<char> free;
  std::vector<signed char> side, piece;

  explicit ActiveSets(const ScaledProblem &p)
      : free(p.generators(), 1), side(p.nodes(), 0), piece(p.nodes(), 0) {}
  friend auto operator<=>(const ActiveSets &, const ActiveSets &) = default;
};

/// A point and its multipliers, w_tau + T^T delta = 0; delta has the sign of T b.
struct State {
  Vector x, delta;
  Vector w, terms, bounds, traction; ///< filled by Judge: w, |H| |x| + |q|, s, T b
  double residual = infinity;
};

class FrozenBounds;

/// The problem with the nodes of zero bound eliminated: they hold T_E b = 0, often with more rows
/// than modes. b = Z y, with Z an orthonormal basis of the kernel, leaves the problem of the other
/// nodes for (a, y).
class ZeroBoundElimination {
public:
  /// `closed`: E, of every node.
  ZeroBoundElimination(const ScaledProblem &p, const std::vector<char> &closed);
  ~ZeroBoundElimination();
  bool is(const std::vector<char> &closed) const { return closed_ == closed; }

  /// Newton's step on these sets; the bounds follow the pressure.
  State newton(const ActiveSets &sets) const;

  /// The solution with the bounds s; `sets`: a first guess, and on return those of the solution.
  State frozen(const Vector &s, ActiveSets &sets);

private:
  void eliminate();
  ActiveSets restricted(const ActiveSets &sets) const;
  State lifted(const State &point) const;

  std::vector<char> closed_;
  const ScaledProblem &p_;
  ScaledProblem reduced_;
  std::vector<Index> zero_, nodes_;       ///< E, the others
  Eigen::ColPivHouseholderQR<Matrix> qr_; ///< QR of T_E^T
  Matrix z_;
  std::unique_ptr<FrozenBounds> qp_;
};

} // namespace rbvi::collocated
