#include "rbvi/method/active_sets.hpp"

#include "friction_laws.hpp"
#include "pivoting.hpp"
#include "rbvi/core/error.hpp"

namespace rbvi {

namespace {

using namespace friction;

constexpr double while_sets_change = 1e-6; ///< accuracy of the systems

SetSystem system_of(const NodeLaws &laws, const ActiveSets &sets) {
  const std::vector<Unknown> list = unknowns(laws, sets);
  std::vector<Eigen::Triplet<double>> t, r;
  SetSystem system;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const auto column = static_cast<int>(k);
    const auto row = static_cast<int>(list[k].first);
    r.emplace_back(row, column, 1);
    t.emplace_back(row, column, 1);
    if (list[k].slope == 0) continue;
    const auto tangent = static_cast<int>(laws.tangent[list[k].node]);
    t.emplace_back(tangent, column, list[k].slope * sets.direction(0, list[k].node));
    system.symmetric = false;
  }
  const auto columns = static_cast<Index>(list.size());
  system.t.resize(laws.rows, columns);
  system.r.resize(laws.rows, columns);
  system.t.setFromTriplets(t.begin(), t.end());
  system.r.setFromTriplets(r.begin(), r.end());
  system.fixed = fixed_part(laws, sets);
  return system;
}

class Iteration {
public:
  Iteration(const SetSolver &solve, const Vector &diagonal, const NodeLaws &laws,
            const FrictionOptions &options, const LargestOverRanks &largest)
      : solve_(solve), laws_(laws), diagonal_(diagonal), options_(options), largest_(largest) {}

  FrictionResult run(const Vector &start, bool by_rule) {
    const double steepest = largest(friction::steepest(laws_));
    return by_rule && steepest > 0 ? continued(start, steps_to(steepest)) : iterate(start);
  }

private:
  /// Along growing coefficients from none, as friction_answer by its rule.
  FrictionResult continued(Vector from, int steps) {
    const NodeLaws all = laws_;
    for (int k = 0; k < steps; ++k) {
      laws_ = with_slopes(all, static_cast<double>(k) / steps);
      const FrictionResult found = iterate(from);
      if (!found.converged) break;
      from = found.start;
    }
    laws_ = all;
    return iterate(from);
  }

  FrictionResult iterate(const Vector &from) {
    keys_.clear();
    ActiveSets sets(laws_);
    if (from.size() > 0) sets = predicted_sets(laws_, from);
    pivoting::Policy<Index, double> policy(/*patience=*/20);
    double accuracy = std::max(while_sets_change, options_.tolerance);
    State point;
    while (result_.iterations < options_.max_iterations) {
      ++result_.iterations;
      point = solved(sets, accuracy);
      Verdict verdict = judged(point, sets);
      const bool exact = accuracy <= options_.tolerance;
      const bool returned = verdict.changed && policy.returns(number_of(sets));
      if (!verdict.changed && exact) return finish(point, sets, verdict.residual);
      // Sets that settle, or return, with an inexact solution are judged by an exact one.
      if (exact && (returned || policy.is_lost(verdict.residual))) break;
      if (!verdict.changed || returned) accuracy = options_.tolerance;
      if (verdict.changed) sets = std::move(verdict.next);
    }
    result_.reason =
        "the active sets have not settled after " + std::to_string(result_.iterations) + " steps";
    return std::move(result_);
  }

  State solved(const ActiveSets &sets, double accuracy) const {
    const SetSolution found = solve_(system_of(laws_, sets), accuracy);
    return {found.x, found.w, found.terms};
  }

  double largest(double value) const { return largest(Vector(Vector::Constant(1, value)))[0]; }
  Vector largest(Vector values) const {
    if (largest_) largest_(values);
    return values;
  }

  /// Of all nodes, but for the next sets.
  Verdict judged(const State &point, const ActiveSets &sets) const {
    Verdict verdict = judge(diagonal_, laws_, point, sets, options_.tolerance,
                            largest(largest_scaled(diagonal_, point.x)));
    const Vector all = largest(Vector{{verdict.residual, verdict.changed ? 1.0 : 0.0}});
    verdict.residual = all[0];
    verdict.changed = all[1] > 0;
    return verdict;
  }

  /// Equal for sets that are equal on all ranks.
  Index number_of(const ActiveSets &sets) {
    keys_.push_back(sets.key());
    Vector differs(std::ssize(keys_));
    for (Index k = 0; k < differs.size(); ++k)
      differs[k] = keys_[k] == keys_.back() ? 0 : 1;
    Index first = 0;
    largest(differs).minCoeff(&first);
    return first;
  }

  FrictionResult finish(const State &point, const ActiveSets &sets, double residual) {
    FrictionResult result = std::move(result_);
    result.residual = residual;
    result.converged = true;
    result.reason = "every condition of contact holds";
    result.x = admissible(laws_, point.x);
    describe(result, laws_, sets);
    result.start = smooth_start(diagonal_, laws_, point);
    result.w = point.w;
    return result;
  }

  const SetSolver &solve_;
  NodeLaws laws_;
  const Vector &diagonal_;
  const FrictionOptions &options_;
  const LargestOverRanks &largest_;
  std::vector<std::string> keys_; ///< of the sets so far
  FrictionResult result_;
};

} // namespace

FrictionResult solve_by_sets(const SetSolver &solve, const Vector &diagonal, const NodeLaws &laws,
                             const Vector &start, const SetOptions &options) {
  check(laws);
  Vector in_space = Vector::Constant(1, laws.friction() && laws.tangents > 1 ? 1 : 0);
  if (options.largest) options.largest(in_space);
  if (in_space[0] > 0)
    throw failure("active sets without columns are for friction in two dimensions");
  return Iteration(solve, diagonal, laws, options.friction, options.largest)
      .run(start, options.by_rule);
}

} // namespace rbvi
