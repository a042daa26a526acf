// One Newton step for contact with friction, and what a vector x says about the laws.
//
// A node that slips has x_tau = s e, |e| = 1, s = c x_n + t on its piece of the law: in two
// dimensions e is a sign and x_tau is eliminated; in three the turn z of e is an unknown, x_tau = s
// e + z e', e' orthogonal to e, with the row  e' . w_tau + kappa z = 0,  kappa = (|y| - s) / (rho
// s),  y = x_tau - rho w_tau: that is the derivative of the projection on the disk, and kappa >= 0.
// After the step x_tau is brought back to the circle.
#pragma once

#include "lazy_columns.hpp"
#include "rbvi/method/friction.hpp"

#include <optional>
#include <string>

namespace rbvi::friction {

/// The kind of x_tau at a node: zero, free, or of a given direction.
enum class Tangent : char { none, stick, slip };

/// The active sets: nodes in contact, and the kind of x_tau at every node. They make the laws
/// linear equations.
struct ActiveSets {
  std::vector<char> active;
  std::vector<Tangent> tangent;
  Matrix direction;        ///< e of the nodes that slip, tangents x nodes
  std::vector<char> piece; ///< the piece of its law that each of them is on
  Vector curvature;        ///< kappa of those nodes; negative: no turn

  explicit ActiveSets(const NodeLaws &laws);
  bool is_active(Index i) const { return active[i] != 0; }
  Tangent tangent_at(Index i) const { return tangent[i]; }
  /// The piece of the law that a slipping node is on.
  FrictionBound::Piece piece_of(const NodeLaws &laws, Index i) const {
    return laws.friction_at(i).piece(piece[i]);
  }
  /// The entries of x that need not be zero.
  std::vector<Index> support(const NodeLaws &laws) const;
  /// Whether a node is in another state than in other sets, but for the direction of slip; how
  /// many are.
  bool differs(const ActiveSets &other, Index i) const {
    return active[i] != other.active[i] || tangent[i] != other.tangent[i] ||
           piece[i] != other.piece[i];
  }
  Index differences(const ActiveSets &other) const;
  /// A text that is equal for sets with the same linear system, in two dimensions.
  std::string key() const;
};

struct State {
  Vector x, w;           ///< multipliers, H x + q
  Vector terms;          ///< the sum of the sizes of the terms of every row of w
  bool negative = false; ///< the determinant of the linear system that gave it
};

/// The point of x, whose support has its columns.
State evaluate(const LazyColumns &h, const Vector &q, Vector x);

struct Verdict {
  ActiveSets next;      ///< the sets that x - rho w predicts
  bool changed = false; ///< next differs from the sets of the point
  double residual = 0;  ///< largest relative violation of the laws
};

/// The largest x in the scaling in which H has a unit diagonal.
double largest_scaled(const Vector &diagonal, const Vector &x);
/// The sets that a point predicts, and its violation. `diagonal`: H_jj, or its size; 0 where it is
/// not known: of x_j it is then only known whether it is zero. `sets`: of the step that gave the
/// point (they decide where the difference is below tolerance). `largest`: largest_scaled, of all
/// nodes.
Verdict judge(const Vector &diagonal, const NodeLaws &laws, const State &point,
              const ActiveSets &sets, double tolerance, double largest);
Verdict judge(const Vector &diagonal, const NodeLaws &laws, const State &point,
              const ActiveSets &sets, double tolerance);
/// H_jj of the tangential row of a node, of two rows their mean.
double tangential_diagonal(const Vector &diagonal, const NodeLaws &laws, Index node);
/// The sets to judge a point by that no step gave.
ActiveSets contact_sets(const NodeLaws &laws, const Vector &x);
/// The sets that y = x - w / H_jj tells, but for their curvature.
ActiveSets predicted_sets(const NodeLaws &laws, const Vector &y);
/// The curvature of sets that y predicts.
void set_curvature(const Vector &diagonal, const NodeLaws &laws, const Vector &y, ActiveSets &sets);

/// An unknown of the linear system, and its row: a combination of at most two entries.
struct Unknown {
  Index node;
  Index first, second;  ///< entries of x
  double a = 1, b = 0;  ///< their factors
  double slope = 0;     ///< x_tau grows by this times e with the normal unknown
  double curvature = 0; ///< on the diagonal
};
std::vector<Unknown> unknowns(const NodeLaws &laws, const ActiveSets &sets);
/// What scales the diagonal of H to one in its row.
double unit_of(const Unknown &unknown, const Vector &diagonal, const NodeLaws &laws);
/// What a unit of an unknown adds to w, but for its curvature, at any row: a combination of at most
/// four columns of H, which must outlive it.
class MovedBy {
public:
  MovedBy(const LazyColumns &h, const NodeLaws &laws, const ActiveSets &sets,
          const Unknown &unknown);
  double operator[](Index row) const {
    double sum = factors_[0] * columns_[0][row];
    for (std::size_t k = 1; k < count_; ++k)
      sum += factors_[k] * columns_[k][row];
    return sum;
  }

private:
  void add(double factor, const LazyColumns &h, Index column);

  std::array<const double *, 4> columns_{};
  std::array<double, 4> factors_{};
  std::size_t count_ = 0;
};
/// The row of an unknown times what there is at all rows, a Vector or MovedBy.
template <class Rows> double along(const Unknown &row, const Rows &rows) {
  if (row.b == 0) return row.a * rows[row.first];
  return row.a * rows[row.first] + row.b * rows[row.second];
}
/// The part of x that no unknown changes: what bounds of slipping nodes have at x_n = 0.
Vector fixed_part(const NodeLaws &laws, const ActiveSets &sets);
/// x of the unknowns u, beside its fixed part `x`.
Vector expand(const NodeLaws &laws, const ActiveSets &sets, const std::vector<Unknown> &list,
              const Vector &u, Vector x);
/// With tractions of nodes that slip as long as their bounds, which turns them.
Vector on_circles(const NodeLaws &laws, const ActiveSets &sets, Vector x);

/// With friction a singular matrix need not be a fault of H.
enum class Solved { yes, singular, indefinite, far };

/// The linear system of active sets, factorised.
class System {
public:
  /// The system of `sets`. `h` has the columns of their support.
  System(const LazyColumns &h, const NodeLaws &laws, ActiveSets sets);
  /// The point that solves it; `point` is unchanged where none does.
  Solved step(const LazyColumns &h, const Vector &q, const NodeLaws &laws, int refinements,
              State &point) const;
  /// The same for other sets, in space: a step from `point`, which those of `from` gave, by the
  /// factors of these sets, bordered by what is unknown in one of both alone. Slips have turned
  /// since, so that it is no step of Newton's method. Solved::far where much is.
  Solved step_nearby(const LazyColumns &h, const Vector &q, const NodeLaws &laws,
                     const ActiveSets &from, ActiveSets to, State &point) const;
  /// Changes of x in the plane by those of q (columns), while the sets stay.
  Matrix change(const NodeLaws &laws, const Matrix &of_q) const;
  /// As FrictionSolver::near, of the point x that the sets gave by `laws`.
  State near(const LazyColumns &h, const Vector &x, const NodeLaws &laws, const Vector &left,
             const NodeLaws &other_laws) const;

private:
  void assemble(const LazyColumns &h, const NodeLaws &laws);
  /// The unknowns for one right side (a Vector) or several, in their units, as the factors have
  /// them.
  template <class Right> Right times_inverse(Right right) const {
    if (rough_) return rough_->solve(right.template cast<float>()).template cast<double>();
    if (!symmetric_) return lu_.solve(right);
    solve_lower(lower_, right);
    solve_lower_transposed(lower_, right);
    return right;
  }
  /// -(a y[first] + b y[second]) of each row, in its unit.
  Vector right_side(const Vector &y) const;
  /// By the factors in single precision, which cost half, refined until they change by `accuracy`.
  Vector refined(const Vector &right, double accuracy) const;
  /// The unknowns for a right side; without refinement as exact as a step of Newton's method needs.
  Vector solve(const Vector &right, int refinements) const;

  ActiveSets sets_;
  std::vector<Unknown> list_;
  Vector unit_; ///< what scales the diagonal of H to one
  Matrix matrix_, lower_;
  // Where it is not symmetric, the one or the other:
  Eigen::PartialPivLU<Matrix> lu_;
  std::optional<Eigen::PartialPivLU<Eigen::MatrixXf>> rough_; ///< in space, of many unknowns
  bool symmetric_ = true, negative_ = false;
  Solved solved_ = Solved::yes;
};

} // namespace rbvi::friction
