#include "friction_convex.hpp"
#include "friction_laws.hpp"
#include "friction_normal.hpp"
#include "friction_run.hpp"
#include "pivoting.hpp"
#include "rbvi/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <set>
#include <string>

namespace rbvi {

namespace {

using namespace friction;

constexpr double round_off = 1e-11; ///< of the violation of a law, relative

class Solver {
public:
  /// It ends at sets that are known; those that it comes to are added.
  Solver(LazyColumns &h, const Vector &q, const NodeLaws &laws, const FrictionOptions &options,
         Kept &kept)
      : h_(h), q_(q), laws_(laws), options_(options), kept_(kept), best_sets_(laws),
        systems_left_(options.max_iterations) {}

  /// `searches`: for another answer, where Newton's method goes straight to it.
  FrictionAnswer run(const Vector &start, bool by_rule, bool searches) {
    Outcome outcome;
    if (by_rule && bounds_follow_pressure(laws_)) {
      outcome = continued_from_no_friction(start);
    } else if (start.size() > 0) {
      best_.x = admissible(laws_, start);
      result_.residual = std::numeric_limits<double>::infinity();
      State point;
      outcome = newton_from(laws_, sets_from(start), point);
    } else {
      prepare(laws_, Vector::Zero(q_.size()));
      State point = evaluate(h_, q_, Vector::Zero(q_.size()));
      outcome = newton(laws_, point);
    }
    const bool settles = jump(laws_);
    if (outcome == Outcome::cycles && !searches) {
      State point = evaluate(h_, q_, admissible(laws_, best_.x));
      outcome = settles ? settle_contact(laws_, point) : backup(laws_, point);
    }
    if (settles && (outcome == Outcome::cycles || outcome == Outcome::known)) {
      const bool from_rest = !searches || start.size() == 0;
      State point =
          evaluate(h_, q_, from_rest ? Vector::Zero(q_.size()) : admissible(laws_, start));
      outcome = settle_contact(laws_, point);
    }
    if (outcome == Outcome::cycles && searches) outcome = Outcome::known;
    kept_.known.merge(visited_);
    return outcome == Outcome::known ? FrictionAnswer() : finish(outcome);
  }

private:
  static constexpr int usual_patience = 10; ///< pivoting::Policy

  /// Along growing coefficients, or thresholds in contact that come down to what they are, from the
  /// last point that is reached.
  Outcome continued_from_no_friction(const Vector &guess) {
    constexpr int halvings = 10; // of thresholds, from where all that touches sticks
    const LcpResult normal = normal_contact(h_, q_, laws_, guess, options_);
    systems_left_ -= normal.iterations;
    Vector x = Vector::Zero(q_.size());
    if (normal.x.size() == laws_.nodes()) x(laws_.normal) = normal.x;
    prepare(laws_, x);
    State point = evaluate(h_, q_, std::move(x));
    const double slope = steepest(laws_);
    const bool comes_down = slope == 0;
    const int steps = comes_down ? halvings : steps_to(slope);
    for (int k = 1; k < steps; ++k) {
      State next = point;
      const NodeLaws part = comes_down ? with_thresholds(laws_, std::ldexp(1.0, steps - k))
                                       : with_slopes(laws_, static_cast<double>(k) / steps);
      if ((comes_down ? settle_contact(part, next) : newton(part, next)) != Outcome::converged)
        break;
      point = std::move(next);
    }
    State last = point;
    if (comes_down && settle_contact(laws_, last) == Outcome::converged) return Outcome::converged;
    return newton(laws_, point);
  }

  /// The sets that a start tells, with the columns of their support.
  ActiveSets sets_from(const Vector &start) {
    ActiveSets sets = predicted_sets(laws_, start);
    h_.require(sets.support(laws_));
    set_curvature(h_.diagonal(), laws_, start, sets);
    return sets;
  }

  /// The columns of the support of x, of nodes that touch, and of thresholds that hold everywhere.
  void prepare(const NodeLaws &laws, const Vector &x) {
    ActiveSets sets = contact_sets(laws, x);
    for (Index i = 0; i < laws.nodes(); ++i)
      if (laws.friction_at(i).carries_traction(sets.is_active(i))) sets.tangent[i] = Tangent::stick;
    h_.require(sets.support(laws));
  }

  Outcome newton(const NodeLaws &laws, State &point, int patience = usual_patience) {
    const ActiveSets sets = contact_sets(laws, point.x);
    Verdict verdict = judge(h_.diagonal(), laws, point, sets, options_.tolerance);
    keep(laws, point, sets, verdict);
    return newton_from(laws, std::move(verdict.next), point, patience);
  }

  /// Whether steps by old factors that lower the residual like the last one end before those by new
  /// factors, which take the time of some four of them.
  bool ends_soon(double residual, double before) const {
    constexpr double worth = 5;
    return residual < before && std::pow(residual / before, worth) * residual <= options_.tolerance;
  }

  /// Newton from these sets until the laws hold or the policy gives up. In three dimensions the
  /// directions of slip vary continuously: there the sets alone do not tell that a step returns,
  /// and a step by new factors is followed by such by the same ones while fewer nodes change with
  /// each, or none and the residual falls fast.
  Outcome newton_from(const NodeLaws &laws, ActiveSets sets, State &point,
                      int patience = usual_patience) {
    pivoting::Policy<std::string, double> policy(patience);
    const bool own = &laws == &laws_;
    std::optional<ActiveSets> from; // of the point, where factors of a step before may serve
    Index changes = 0;              // of the step before
    double residual = 0;            // likewise
    for (;;) {
      std::string key;
      if (laws.tangents == 1) {
        key = sets.key();
        if (own && kept_.known.contains(key)) return Outcome::known;
        if (own) visited_.insert(key);
        if (policy.returns(key)) return Outcome::cycles;
      }
      h_.require(sets.support(laws));
      Solved solved = from ? other_->step_nearby(h_, q_, laws, *from, sets, point) : Solved::far;
      const bool anew = solved == Solved::far;
      if (anew && systems_left_ <= 0) return Outcome::limit;
      if (anew) --systems_left_;
      const System &system = anew ? system_of(laws, sets, std::move(key)) : *other_;
      const auto solve = [&](int refinements) {
        return system.step(h_, q_, laws, refinements, point);
      };
      if (anew) solved = solve(0);
      if (solved == Solved::indefinite) return Outcome::indefinite;
      if (solved == Solved::singular) return Outcome::cycles;
      Verdict verdict = judge(h_.diagonal(), laws, point, sets, options_.tolerance);
      if (laws.tangents == 1 && !verdict.changed) { // it may be the last one
        solve(1);
        verdict = judge(h_.diagonal(), laws, point, sets, options_.tolerance);
      }
      keep(laws, point, sets, verdict);
      if (anew ? settled(verdict, policy.least(), round_off)
               : settled(verdict, residual, 0.1 * round_off))
        return Outcome::converged;
      if (anew && policy.is_lost(verdict.residual)) return Outcome::cycles;
      const Index differ = laws.tangents == 2 ? verdict.next.differences(sets) : 0;
      const bool helps = differ < changes || (differ == 0 && ends_soon(verdict.residual, residual));
      from.reset();
      if (laws.tangents == 2 && (anew || helps)) from = std::move(sets);
      changes = differ;
      residual = verdict.residual;
      sets = std::move(verdict.next);
    }
  }

  /// `key`: of the sets, in the plane.
  const System &system_of(const NodeLaws &laws, const ActiveSets &sets, std::string key) {
    if (&laws != &laws_ || key.empty()) return other_.emplace(h_, laws, sets);
    if (!kept_.system || kept_.key != key) {
      kept_.system.emplace(h_, laws, sets);
      kept_.key = std::move(key);
    }
    return *kept_.system;
  }

  /// The sets are right and the violations below tolerance; or as small as round-off lets them be,
  /// `allowed`: in two dimensions what a repeated step would give again, in three what it did not
  /// improve.
  bool settled(const Verdict &verdict, double least, double allowed) const {
    if (verdict.changed) return false;
    if (verdict.residual <= options_.tolerance) return true;
    return verdict.residual <= allowed && (laws_.tangents == 1 || verdict.residual >= 0.5 * least);
  }

  /// The fixed point of the bounds, frozen in turn, with shorter steps where it turns back; and
  /// Newton whenever they settle. `point` is feasible.
  Outcome backup(const NodeLaws &laws, State &point) {
    double near = 0.5, part = 1;
    Vector before;
    Vector held = bounds_of(laws, point.x);
    while (systems_left_ > 0 && result_.backup_steps < options_.max_iterations) {
      ++result_.backup_steps;
      if (!solve_frozen(frozen(laws, held), 1e-2 * near, point)) return Outcome::indefinite;
      const Vector bounds = bounds_of(laws, point.x), change = bounds - held;
      if (change.cwiseAbs().maxCoeff() <= near * bounds.maxCoeff()) {
        near *= 0.1;
        State trial = evaluate(h_, q_, admissible(laws, point.x));
        const Outcome outcome = newton(laws, trial, /*patience=*/2);
        if (outcome == Outcome::converged) point = std::move(trial);
        if (outcome != Outcome::cycles) return outcome;
      }
      const bool turns = before.size() > 0 && change.dot(before) < 0;
      part = turns ? std::max(0.1, 0.5 * part) : std::min(1.0, 2 * part);
      before = change;
      held += part * change;
      point = evaluate(h_, q_, admissible(frozen(laws, held), std::move(point.x)));
    }
    return Outcome::limit;
  }

  /// Of thresholds that act in contact alone: the nodes that touch tell them, and laws without a
  /// jump are left, whose answer tells the nodes that touch, until they stay or come back.
  Outcome settle_contact(const NodeLaws &laws, State &point) {
    std::vector<std::vector<char>> seen{jumped(laws, point.x)};
    while (systems_left_ > 0) {
      ++result_.backup_steps;
      const Outcome outcome = settle_held(without_jump(laws, seen.back()), point);
      if (outcome != Outcome::converged) return outcome;
      const std::vector<char> touching = jumped(laws, point.x);
      undecided_ = std::inner_product(touching.begin(), touching.end(), seen.back().begin(), 0L,
                                      std::plus(), std::not_equal_to());
      if (undecided_ == 0) return &laws == &laws_ ? newton(laws, point) : Outcome::converged;
      if (std::ranges::find(seen, touching) != seen.end()) return Outcome::cycles;
      seen.push_back(touching);
    }
    return Outcome::limit;
  }

  /// Of laws without a jump; a convex problem where none has a slope.
  Outcome settle_held(const NodeLaws &laws, State &point) {
    point = evaluate(h_, q_, admissible(laws, std::move(point.x)));
    if (!bounds_follow_pressure(laws))
      return solve_frozen(laws, options_.tolerance, point) ? Outcome::converged
                                                           : Outcome::indefinite;
    const Outcome outcome = newton(laws, point);
    if (outcome != Outcome::cycles) return outcome;
    point = evaluate(h_, q_, admissible(laws, std::move(point.x)));
    return backup(laws, point);
  }

  bool solve_frozen(const NodeLaws &held, double tolerance, State &point) {
    prepare(held, point.x);
    return minimise(h_, q_, held, std::max(tolerance, round_off), systems_left_, point);
  }

  void keep(const NodeLaws &laws, const State &point, const ActiveSets &sets,
            const Verdict &verdict) {
    if (&laws != &laws_) return;
    if (best_.x.size() > 0 && verdict.changed && verdict.residual >= result_.residual) return;
    best_ = point;
    best_sets_ = sets;
    result_.residual = verdict.residual;
  }

  FrictionAnswer finish(Outcome outcome) {
    FrictionAnswer result{std::move(result_)};
    result.iterations = options_.max_iterations - systems_left_;
    result.columns = h_.count();
    result.converged = outcome == Outcome::converged;
    result.has_others = result.converged && best_.negative && laws_.tangents == 1 && !jump(laws_);
    best_.x = admissible(laws_, std::move(best_.x));
    if (!result.converged || kept_.key != best_sets_.key()) kept_.system.reset();
    if (!result.converged) {
      best_ = evaluate(h_, q_, std::move(best_.x));
      result.residual = judge(h_.diagonal(), laws_, best_, best_sets_, options_.tolerance).residual;
    }
    result.start = smooth_start(h_.diagonal(), laws_, best_);
    result.x = std::move(best_.x);
    result.w = std::move(best_.w);
    describe(result, laws_, best_sets_);
    result.reason = reason_of(outcome, options_.max_iterations, result.backup_steps, undecided_);
    kept_.sets = std::move(best_sets_);
    return result;
  }

  LazyColumns &h_;
  const Vector &q_;
  const NodeLaws &laws_;
  const FrictionOptions &options_;
  Kept &kept_;
  std::optional<System> other_;   ///< the last one of other laws
  std::set<std::string> visited_; ///< by the laws themselves
  State best_;                    ///< the solution, or the point of the least residual
  ActiveSets best_sets_;
  FrictionResult result_;
  int systems_left_;   ///< linear systems
  long undecided_ = 0; ///< nodes that lift off with their thresholds and touch without
};

} // namespace

namespace friction {

FrictionAnswer run_friction(LazyColumns &h, const Vector &q, const NodeLaws &laws,
                            const FrictionOptions &options, Kept &kept, const Vector &start,
                            bool by_rule, bool searches) {
  return Solver(h, q, laws, options, kept).run(start, by_rule, searches);
}

} // namespace friction

} // namespace rbvi
