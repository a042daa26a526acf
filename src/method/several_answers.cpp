#include "rbvi/method/several_answers.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

bool bounds_follow_pressure(const NodeLaws &laws) {
  for (Index i = 0; i < laws.nodes(); ++i)
    if (laws.friction_at(i).follows_pressure()) return true;
  return false;
}

double distance_of_answers(const Vector &x, const Vector &other) {
  const double size = std::max(x.cwiseAbs().maxCoeff(), other.cwiseAbs().maxCoeff());
  const double largest = (x - other).cwiseAbs().maxCoeff();
  return largest > least_distance * size ? largest / size : 0;
}

double distance_to_other_answer(FrictionSolver &solver, const FrictionResult &found) {
  const NodeLaws &laws = solver.laws();
  if (!bounds_follow_pressure(laws)) return 0;
  double farthest = 0;
  const auto look = [&](const Vector &start, bool by_rule) {
    const FrictionResult other = solver.another(start, by_rule);
    if (other.converged) farthest = std::max(farthest, distance_of_answers(found.x, other.x));
  };
  if (!solver.by_rule()) look(found.start, true);
  if (std::ranges::any_of(laws.bound, &FrictionBound::jumps)) look({}, false); // from rest
  Vector reversed = found.start;
  for (Index i = 0; i < laws.nodes(); ++i) {
    if (!laws.has_tangent(i)) continue;
    reversed[laws.normal[i]] = std::abs(reversed[laws.normal[i]]);
    reversed.segment(laws.tangent[i], laws.tangents) *= -2;
  }
  look(reversed, false);
  for (const double slip : {0.0, 1.0, -1.0}) {
    Vector start = found.start;
    for (Index i = 0; i < laws.nodes(); ++i) {
      double &normal = start[laws.normal[i]];
      if (found.active.empty()) normal = std::abs(normal);
      if (!laws.has_tangent(i)) continue;
      start.segment(laws.tangent[i], laws.tangents).setZero();
      start[laws.tangent[i]] = 2 * slip * laws.bound[i].value(normal);
    }
    look(start, false);
  }
  return farthest;
}

double distance_seen(FrictionSolver &solver, const FrictionAnswer &found, bool looks) {
  const double distance = looks && found.converged ? distance_to_other_answer(solver, found) : 0;
  return found.has_others ? std::max(distance, least_distance) : distance;
}

FrictionAnswer friction_answer(const ColumnSource &columns, const Vector &q, const NodeLaws &laws,
                               const Vector &start, bool by_rule, const FrictionOptions &options) {
  return FrictionSolver(columns, laws).answer(q, start, by_rule, options);
}

FrictionResult solve_friction(const ColumnSource &columns, const Vector &q, const NodeLaws &laws,
                              const Vector &start, const FrictionOptions &options) {
  return friction_answer(columns, q, laws, start, false, options);
}

} // namespace rbvi
