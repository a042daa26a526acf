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

double distance_to_other_answer(FrictionSolver &solver, const FrictionResult &found,
                                const Matrix &held) {
  constexpr double balanced = 1e-2; // of sizes: springs that are 1e4 times as soft
  const NodeLaws &laws = solver.laws();
  if (!bounds_follow_pressure(laws)) return 0;
  double farthest = 0;
  const auto look = [&](const Vector &start, bool by_rule) {
    const FrictionResult other = solver.another(start, by_rule);
    if (!other.converged) return;
    if (held.size() > 0) {
      const Vector change = held.transpose() * (other.x - found.x),
                   sizes = held.transpose().cwiseAbs() * (other.x.cwiseAbs() + found.x.cwiseAbs());
      if (!(change.norm() <= balanced * sizes.norm())) return;
    }
    farthest = std::max(farthest, distance_of_answers(found.x, other.x));
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

double distance_seen(FrictionSolver &solver, const FrictionAnswer &found, bool looks,
                     const Matrix &held) {
  const double distance =
      looks && found.converged ? distance_to_other_answer(solver, found, held) : 0;
  return found.has_others ? std::max(distance, least_distance) : distance;
}

double distance_seen_from(const ColumnSource &columns, const Vector &q, const NodeLaws &laws,
                          const FrictionAnswer &found, const Matrix &held) {
  constexpr double softer = 1e4;
  std::vector<Index> support;
  for (Index j = 0; j < found.x.size(); ++j)
    if (found.x[j] != 0) support.push_back(j);
  if (!bounds_follow_pressure(laws) || !found.converged || support.empty()) return 0;
  const double of_springs = held(support, Eigen::all).squaredNorm(),
               of_body = columns(support)(support, Eigen::all).trace(),
               weight = softer * of_body / of_springs;
  const auto softened = [&](const std::vector<Index> &which) {
    return Matrix(columns(which) + weight * held * held(which, Eigen::all).transpose());
  };
  FrictionSolver solver(softened, laws);
  const Vector forces = held.transpose() * found.x;
  const FrictionAnswer same = solver.answer(q - weight * held * forces, found.start, false);
  return distance_seen(solver, same, true, held);
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
