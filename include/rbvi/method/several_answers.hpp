// Where the bound of friction follows the pressure and its coefficient c is large, several x can
// solve the problem of friction.hpp. The rule that chooses one, whatever came before: the answer
// without friction, which is unique, continued while the coefficients grow to c. Of thresholds
// alone that act in contact alone: that of what touches without friction and sticks, continued
// while the thresholds come down to what they are.
#pragma once

#include "rbvi/method/friction.hpp"

#include <memory>

namespace rbvi {

/// Whether the bound of some node depends on its pressure: Coulomb's law, or a threshold in contact
/// alone. Otherwise there is one answer.
bool bounds_follow_pressure(const NodeLaws &laws);

/// Of two answers, relative; of another one that only the sign of the tangent tells of.
constexpr double least_distance = 1e-6;

struct FrictionAnswer : FrictionResult {
  /// In the plane: the determinant of the tangent at x is negative. For every c there is one more
  /// answer with a positive determinant than with a negative one, as without friction: so there are
  /// two others.
  bool has_others = false;
};

/// As solve_friction. `by_rule`, where bounds follow the pressure: begins without friction, and
/// lets the coefficients grow in steps of at most 0.25, or halves 500-fold thresholds until they
/// are what they are; `start` is then no more than a guess of the contact without friction, so that
/// the answer depends on the problem alone.
FrictionAnswer friction_answer(const ColumnSource &columns, const Vector &q, const NodeLaws &laws,
                               const Vector &start, bool by_rule,
                               const FrictionOptions &options = {});

/// An answer near another one, to first order, with the active sets of that.
struct NearAnswer {
  Vector x, w;
  Vector start;     ///< FrictionResult::start
  bool same_states; ///< whether `start` tells the same active sets
};

/// Problems of friction.hpp one after another that differ in q alone: of H each column is asked for
/// once.
class FrictionSolver {
public:
  /// Throws as solve_friction where the laws make no sense.
  FrictionSolver(ColumnSource columns, const NodeLaws &laws);
  FrictionSolver(const ScaledMatrix &h, const NodeLaws &laws);
  ~FrictionSolver();
  FrictionSolver(const FrictionSolver &) = delete;
  /// As friction_answer.
  FrictionAnswer answer(const Vector &q, const Vector &start, bool by_rule,
                        const FrictionOptions &options = {});
  /// To the last q, from another start. In the plane active sets tell all that follow: this ends,
  /// not converged, where it comes to some that were met on the way to an answer before.
  FrictionAnswer another(const Vector &start, bool by_rule);
  /// Changes of the x of the last answer() by those of q (columns), while its active sets stay. To
  /// be asked before another(). `anew`: their system is factorised where it is not there; else
  /// nothing is returned, as in space or without friction.
  Matrix change(const Matrix &of_q, bool anew) const;
  /// The answer where H, q and the laws are others, near the last answer(): one step with the
  /// system of its active sets, which is factorised once. `left`: of that problem, H x + q at the x
  /// of that answer; `laws`: of that problem, of the same nodes. Throws failure where there is no
  /// answer, or the system is singular.
  NearAnswer near(const Vector &left, const NodeLaws &laws) const;
  const NodeLaws &laws() const;
  bool by_rule() const; ///< the last answer()

private:
  struct Parts;
  const std::unique_ptr<Parts> parts_;
};

/// Largest difference of two answers over their largest entry; 0 up to least_distance, as of one.
double distance_of_answers(const Vector &x, const Vector &other);

/// The distance of found.x, the last answer() of a problem, to the farthest other answer; 0: none
/// was found. Looks by the rule where `found` is not the answer by it; where thresholds act in
/// contact alone, from rest; from contact at every node with friction, its traction against that of
/// `found`; and from the contact of `found` (of all nodes where it has none) with all of it stuck,
/// or slipping one way or the other. Where bounds do not follow the pressure nothing is asked.
/// `held`: of bodies that contact alone holds B Z, rows of x by free motions: answers whose forces
/// along these are others do not count. Empty: there are none.
double distance_to_other_answer(FrictionSolver &solver, const FrictionResult &found,
                                const Matrix &held = {});
/// The same where that is asked for; at least least_distance where others are known of.
double distance_seen(FrictionSolver &solver, const FrictionAnswer &found, bool looks,
                     const Matrix &held = {});
/// Of bodies that contact alone holds, at the answer `found` to q at which their forces balance
/// with springs (method/balance.hpp): with springs that are far softer, whose forces no other
/// answer changes. `columns`: of H with the springs.
double distance_seen_from(const ColumnSource &columns, const Vector &q, const NodeLaws &laws,
                          const FrictionAnswer &found, const Matrix &held);

} // namespace rbvi
