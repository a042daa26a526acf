// Where the bound of friction follows the pressure and its coefficient c is large, several x can
// solve the problem of friction.hpp. The rule that chooses one, whatever came before: the answer
// without friction, which is unique, continued while the coefficients grow to c.
#pragma once

#include "rbvi/method/friction.hpp"

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
/// lets the coefficients grow in steps of at most 0.25; `start` is then no more than a guess of the
/// contact without friction, so that the answer depends on the problem alone.
FrictionAnswer friction_answer(const ColumnSource &columns, const Vector &q, const NodeLaws &laws,
                               const Vector &start, bool by_rule,
                               const FrictionOptions &options = {});

/// Largest difference of two answers over their largest entry; 0 up to least_distance, as of one.
double distance_of_answers(const Vector &x, const Vector &other);

/// The distance of found.x to the farthest other answer; 0: none was found. Looks from rest, by the
/// rule, and from the contact of `found` (of all nodes where it has none) with all of it stuck, or
/// slipping one way or the other.
/// Where bounds do not follow the pressure nothing is asked.
double distance_to_other_answer(const ColumnSource &columns, const Vector &q, const NodeLaws &laws,
                                const FrictionResult &found);

} // namespace rbvi
