#include "rbvi/method/published/collocated_friction.hpp"

#include "../pivoting.hpp"
#include "collocated_steps.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

using namespace collocated;

void check(const CollocatedProblem &p, const Vector &start) {
  const Index r = p.normal_rows.cols(), s = p.tangential_rows.cols();
  const bool fits = p.h.rows() == p.q.size() && p.h.cols() == p.q.size() && r + s == p.q.size() &&
                    p.normal_rows.rows() == p.tangential_rows.rows();
  if (!fits) throw failure("collocated friction: the sizes of H, q, N and T do not fit");
  if (start.size() != 0 && start.size() != p.q.size())
    throw failure("collocated friction: the first guess has " + std::to_string(start.size()) +
                  " entries instead of " + std::to_string(p.q.size()));
  const bool finite = p.h.allFinite() && p.q.allFinite() && p.normal_rows.allFinite() &&
                      p.tangential_rows.allFinite() && start.allFinite();
  if (!finite) throw failure("collocated friction: the problem or the first guess is not finite");
  bounds_per_node(p.bounds, p.normal_rows.rows());
  if (p.normal_rows.size() > 0 &&
      p.normal_rows.minCoeff() < -accuracy * p.normal_rows.cwiseAbs().maxCoeff())
    throw failure("collocated friction: a row of N has a negative entry: clip the functions");
  if (p.h.size() > 0 && !(p.h.diagonal().minCoeff() > 0)) throw not_positive_definite();
}

double smaller(double a, double b) {
  return std::max(0.0, std::min(a, b));
}

/// The largest relative violation of the definition at a point whose x and delta are given.
class Judge {
public:
  explicit Judge(const ScaledProblem &p) : p_(p) {}

  void operator()(State &point) {
    point.residual = infinity;
    if (!point.x.allFinite() || !point.delta.allFinite()) return;
    point.w = p_.h * point.x + p_.q;
    point.terms = p_.h.cwiseAbs() * point.x.cwiseAbs() + p_.q.cwiseAbs();
    point.bounds = p_.bounds(point.x);
    point.traction = p_.tangential * point.x.tail(p_.modes());
    largest_ = point.x.size() > 0 ? point.x.cwiseAbs().maxCoeff() : 0;
    worst_ = 0;
    for (Index i = 0; i < p_.generators(); ++i)
      generator(point, i);
    modes(point);
    for (Index j = 0; j < p_.nodes(); ++j)
      node(point, j);
    point.residual = worst_;
  }
  /// The size that a violation of the bound of node j is relative to.
  double scale(const State &point, Index j) const {
    return std::max(point.bounds[j], point.x.cwiseAbs().maxCoeff() * p_.size.maxCoeff());
  }

private:
  void violated(double amount, double terms) {
    if (amount > 0) worst_ = std::max(worst_, amount / terms);
  }
  void generator(const State &point, Index i) {
    const double a = point.x[i], w = point.w[i], terms = point.terms[i];
    violated(-a, largest_);
    violated(-w, terms);
    if (a > 0 && w > 0) violated(smaller(a / largest_, w / terms), 1);
  }
  void modes(const State &point) {
    const Index s = p_.modes();
    const Vector left = point.w.tail(s) + p_.tangential.transpose() * point.delta;
    const Vector terms =
        point.terms.tail(s) + p_.tangential.cwiseAbs().transpose() * point.delta.cwiseAbs();
    for (Index k = 0; k < s; ++k)
      violated(std::abs(left[k]), terms[k]);
    loads_ = s > 0 ? terms.maxCoeff() : 0;
  }
  void node(const State &point, Index j) {
    const double s = point.bounds[j], delta = point.delta[j], all = scale(point, j);
    violated(std::abs(point.traction[j]) - s, all);
    if (delta == 0) return;
    const double slack = s - std::copysign(point.traction[j], delta * point.traction[j]);
    if (slack != 0)
      violated(smaller(std::abs(slack) / all, std::abs(delta) * p_.size[j] / loads_), 1);
  }

  const ScaledProblem &p_;
  double largest_ = 0, loads_ = 0, worst_ = 0;
};

class Solver {
public:
  explicit Solver(const ScaledProblem &p) : p_(p), judge_(p) {}

  void run(const Vector &start) {
    ActiveSets sets(p_);
    if (start.size() > 0) {
      sets = sets_at(start);
      return iterate(sets, p_.bounds(start));
    }
    ScaledProblem without_bounds = p_;
    without_bounds.size.resize(0);
    without_bounds.normal.resize(0, Eigen::NoChange);
    without_bounds.tangential.resize(0, Eigen::NoChange);
    const State unbounded = ZeroBoundElimination(without_bounds, {}).frozen(Vector(0), sets);
    sets.side.assign(p_.nodes(), 0);
    sets.piece.assign(p_.nodes(), 0);
    iterate(sets, p_.bounds(unbounded.x));
  }
  int sweeps() const { return sweeps_; }
  const State &best() const { return best_; }

private:
  /// Sweeps with the bounds of Newton's point where that is the better one, else with those of the
  /// last sweep; where sets return, with smaller and smaller steps of the bounds.
  void iterate(ActiveSets sets, Vector s) {
    constexpr int limit = 200;
    bool cycles = false;
    Vector damping = Vector::Ones(p_.nodes()), last = Vector::Zero(p_.nodes());
    while (sweeps_ < limit) {
      ++sweeps_;
      std::vector<char> closed(p_.nodes());
      for (Index j = 0; j < p_.nodes(); ++j)
        closed[j] = s[j] == 0;
      const State point = judged(without(closed).frozen(s, sets));
      set_pieces(point.x, sets);
      if (best_.residual <= round_off) return;
      const bool known = policy_.returns(sets);
      if (!known && newton(sets)) return;
      if (known && best_.residual <= accuracy) return;
      const Vector step = p_.bounds(point.x) - s;
      for (Index j = 0; j < p_.nodes() && cycles; ++j)
        damping[j] = step[j] * last[j] < 0 ? 0.5 * damping[j] : std::min(1.0, 1.3 * damping[j]);
      cycles = cycles || known;
      last = step;
      if (!known && best_.residual < point.residual)
        s = best_.bounds;
      else
        s += damping.cwiseProduct(step);
    }
  }

  /// Semismooth Newton from `sets` until the laws hold (true) or the policy gives up.
  bool newton(ActiveSets sets) {
    policy_.restart();
    for (;;) {
      const State point = judged(without(zero_bounds(sets)).newton(sets));
      if (point.residual <= round_off) return true;
      if (point.residual == infinity) return false;
      ActiveSets next = corrected(sets, point);
      if (next == sets && point.residual <= accuracy) return true;
      const bool lost = policy_.is_lost(point.residual);
      if (policy_.returns(next) || lost) return false;
      sets = std::move(next);
    }
  }

  ZeroBoundElimination &without(const std::vector<char> &closed) {
    if (!elimination_ || !elimination_->is(closed))
      elimination_ = std::make_unique<ZeroBoundElimination>(p_, closed);
    return *elimination_;
  }

  /// Nodes whose bound is zero whatever the pressures of the free generators.
  std::vector<char> zero_bounds(const ActiveSets &sets) const {
    std::vector<char> closed(p_.nodes());
    for (Index j = 0; j < p_.nodes(); ++j) {
      closed[j] = p_.bound[j].value(0) == 0;
      for (Index i = 0; i < p_.generators() && p_.bound[j].carries_traction(true); ++i)
        if (sets.free[i] != 0 && p_.normal(j, i) > 0) closed[j] = 0;
    }
    return closed;
  }

  State judged(State point) {
    judge_(point);
    if (point.residual < best_.residual || best_.x.size() == 0) best_ = point;
    return point;
  }

  ActiveSets corrected(ActiveSets sets, const State &point) const {
    for (Index i = 0; i < p_.generators(); ++i) {
      char &free = sets.free[i];
      free = free != 0 ? point.x[i] > 0 : point.w[i] < -round_off * point.terms[i];
    }
    for (Index j = 0; j < p_.nodes(); ++j) {
      signed char &side = sets.side[j];
      const double traction = point.traction[j], s = point.bounds[j];
      if (s == 0) {
        side = sign(point.delta[j]);
      } else if (side != 0) {
        if (point.delta[j] * side < 0) side = 0;
      } else if (std::abs(traction) - s > round_off * judge_.scale(point, j)) {
        side = traction > 0 ? 1 : -1;
      }
    }
    set_pieces(point.x, sets);
    return sets;
  }

  /// At a kink of a law, where two pieces are, the piece stays.
  void set_pieces(const Vector &x, ActiveSets &sets) const {
    const Vector pressures = p_.pressures(x);
    for (Index j = 0; j < p_.nodes(); ++j) {
      const FrictionBound &law = p_.bound[j];
      const auto [offset, slope] = law.piece(sets.piece[j]);
      const double p = pressures[j], s = law.value(p);
      if (sets.side[j] == 0 || !(std::abs(offset + slope * p - s) <= accuracy * s))
        sets.piece[j] = static_cast<signed char>(sets.side[j] == 0 ? 0 : law.piece_at(p));
    }
  }

  ActiveSets sets_at(const Vector &x) const {
    constexpr double near = 1e-9;
    ActiveSets sets(p_);
    const double largest = x.size() > 0 ? x.cwiseAbs().maxCoeff() : 0;
    for (Index i = 0; i < p_.generators(); ++i)
      sets.free[i] = x[i] > round_off * largest;
    const Vector s = p_.bounds(x), traction = p_.tangential * x.tail(p_.modes());
    for (Index j = 0; j < p_.nodes(); ++j)
      if (s[j] > 0 && std::abs(traction[j]) >= s[j] * (1 - near))
        sets.side[j] = traction[j] > 0 ? 1 : -1;
    set_pieces(x, sets);
    return sets;
  }

  const ScaledProblem &p_;
  Judge judge_;
  std::unique_ptr<ZeroBoundElimination> elimination_;
  State best_;
  pivoting::Policy<ActiveSets, double> policy_{/*patience=*/8};
  int sweeps_ = 0;
};

} // namespace

CollocatedResult solve_collocated(const CollocatedProblem &problem, const Vector &start) {
  // The sweeps aim at `accuracy`. Where the generators of a greedy cone nearly depend on each
  // other, round-off leaves a few 1e-11 however many sweeps follow; where one of them comes into
  // contact, it can break the laws by what it carries whether it does or not (3e-10 at 205 of 1e5
  // parameters of a half-disk): far below what such a cone misses, and less than other laws are let
  // pass.
  constexpr double accepted = 1e-8;
  check(problem, start);
  const ScaledProblem p = scaled(problem);
  Solver solver(p);
  solver.run(start.size() > 0 ? Vector(start.cwiseQuotient(p.unit)) : start);
  CollocatedResult result;
  result.x = p.unit.cwiseProduct(solver.best().x);
  result.w = problem.h * result.x + problem.q;
  result.iterations = solver.sweeps();
  result.residual = solver.best().residual;
  result.converged = result.residual <= accepted;
  result.reason =
      result.converged
          ? "the laws hold to " + short_number(result.residual)
          : "the bounds of friction did not settle within " + std::to_string(result.iterations) +
                " steps (" + short_number(result.residual) +
                " is left): a smaller coefficient of friction or other collocation nodes may help";
  return result;
}

} // namespace rbvi
