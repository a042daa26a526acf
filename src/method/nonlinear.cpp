#include "rbvi/method/nonlinear.hpp"

#include "nodal_steps.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/method/anderson.hpp"
#include "rbvi/method/residual.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

const std::vector<std::string> &nonlinear_method_names() {
  static const std::vector<std::string> names{"auto", "kacanov", "newton", "anderson", "nodal"};
  return names;
}

namespace {

constexpr int patience = 15; ///< steps without a smaller change before it is given up

/// Said where the segments of the last step were not those of the one before. B and g are
/// continuous as a vertex passes another, so that nothing has to hold them.
const char *moving_segments(const NonlinearResult &result) {
  return result.segments_moved == result.steps && result.steps > 0
             ? ", while vertices of the master pass those of the slave"
             : "";
}

class Iteration {
public:
  Iteration(const NonlinearContact &contact, const NonlinearOptions &options)
      : contact_(contact), options_(options), method_(options.method) {
    has_newton_ = contact.curvature && !contact.laws.has_tangents();
    fallback_ = has_newton_ ? NonlinearMethod::newton : NonlinearMethod::kacanov;
    check_method();
    if (method_ == NonlinearMethod::automatic)
      method_ = contact.nodal ? NonlinearMethod::nodal : fallback_;
    if (method_ == NonlinearMethod::nodal) nodal_.emplace(contact, !options.economical);
  }
  /// At the solution, where the last step was one between nodes.
  const NodalCondition *condition() const { return nodal_ ? &nodal_->condition() : nullptr; }
  /// False where it goes on as before.
  bool fall_back() {
    if (!nodal_) return false;
    nodal_.reset();
    method_ = fallback_;
    return true;
  }

  /// Steps from `iterate`, whose u is the first state, until the changes are at most `tolerance`.
  /// `part`: of the motion and the loads.
  /// False: `result.reason` says why not.
  bool run(Iterate &iterate, double part, double tolerance, NonlinearResult &result);

private:
  bool is_complete(Iterate &iterate, double part, bool predicted);
  void check_method() const;
  std::string advice() const;
  Iterate step(Vector &state, const Iterate &last, double change, double part,
               NonlinearResult &result);
  void measure(const Iterate &next, const Vector &state, const Vector &reaction,
               const Vector &last_x, double part, NonlinearResult &result) const;

  const NonlinearContact &contact_;
  const NonlinearOptions &options_;
  NonlinearMethod method_, fallback_;
  bool has_newton_;
  std::optional<NodalSteps> nodal_;
  std::vector<Index> segments_; ///< of the last step
};

void Iteration::check_method() const {
  if (method_ == NonlinearMethod::newton && !has_newton_)
    throw bad_input(std::string("-nonlinear_method newton is for contact ") +
                    (contact_.curvature ? "without friction"
                                        : "with the normal of the rigid surface (-normal rigid)") +
                    ": leave it out" + (contact_.nodal ? " (nodal)" : "") +
                    ", or use anderson or kacanov");
  if (method_ == NonlinearMethod::nodal && !contact_.nodal)
    throw bad_input("-nonlinear_method nodal is for contact with the normal of a rigid surface: "
                    "leave it out" +
                    std::string(has_newton_ ? " (newton)" : "") + ", or use anderson or kacanov");
}

/// What else to try.
std::string Iteration::advice() const {
  if (!contact_.advice.empty()) return contact_.advice;
  const bool newton = has_newton_ && method_ != NonlinearMethod::newton,
             anderson = method_ != NonlinearMethod::anderson;
  return std::string("try ") + (newton || anderson ? "-nonlinear_method " : "") +
         (anderson ? "anderson" : "") + (newton && anderson ? " or " : "") +
         (newton ? "newton" : "") + (newton || anderson ? ", " : "") +
         "more -nonlinear_max_steps, or a smaller load";
}

Iterate Iteration::step(Vector &state, const Iterate &last, double change, double part,
                        NonlinearResult &result) {
  if (contact_.solve) return contact_.solve(state);
  if (nodal_ && last.x.size() > 0 && part == 1) return nodal_->step(state, last, change);
  LinearisedContact linearised(contact_, state, part);
  if (!segments_.empty() && segments_ != linearised.segments())
    result.segments_moved = result.steps + 1;
  segments_ = linearised.segments();
  if (method_ == NonlinearMethod::newton && last.x.size() > 0 && !last.active.empty()) {
    // As exact as the next change, which is of second order, makes worth while.
    const double tolerance = std::clamp(0.1 * change, 1e-12, 1e-2);
    if (std::optional<Iterate> found = linearised.solve_with_curvature(last, tolerance))
      return std::move(*found);
  }
  return linearised.solve(last);
}

/// The energy norm |v|^2 = r . C r of what a load r on the contact dofs moves.
void Iteration::measure(const Iterate &next, const Vector &state, const Vector &reaction,
                        const Vector &last_x, double part, NonlinearResult &result) const {
  const auto ratio = [](double change, double size) {
    return change == 0 ? 0 : size > 0 ? change / size : std::numeric_limits<double>::infinity();
  };
  const auto energy = [](const Vector &load, const Vector &moved) {
    return std::sqrt(std::max(0.0, load.dot(moved)));
  };
  const auto dual = [&](const Vector &x) {
    return contact_.w_product.size() == 0 ? x.norm()
                                          : std::sqrt(std::max(0.0, x.dot(contact_.w_product * x)));
  };
  result.change_u = reaction.size() == 0
                        ? ratio((next.u - state).norm(), next.u.norm())
                        : ratio(energy(next.reaction - reaction, state - next.u),
                                energy(next.reaction, part * contact_.free - next.u));
  result.change_x = last_x.size() == 0 ? ratio(dual(next.x), dual(next.x))
                                       : ratio(dual(next.x - last_x), dual(next.x));
}

/// Whether the steps on the nodes near contact have solved the whole problem: no other node
/// overlaps, and, where the change of the next step was only `predicted`, the laws hold to the
/// tolerance.
bool Iteration::is_complete(Iterate &iterate, double part, bool predicted) {
  if (!nodal_ || part < 1) return true;
  if (!nodal_->complete(iterate)) return false;
  const Vector &w = nodal_->condition().w;
  return !predicted ||
         violation(contact_.laws, iterate.x, iterate.x - w.cwiseQuotient(iterate.diagonal)) <=
             options_.tolerance;
}

bool Iteration::run(Iterate &iterate, double part, double tolerance, NonlinearResult &result) {
  const bool friction = contact_.laws.has_tangents();
  Vector state = iterate.u, reaction = iterate.reaction;
  Anderson anderson(3);
  std::vector<Iterate> images;
  double best = std::numeric_limits<double>::infinity(), last = 0;
  int since_best = 0;
  for (int k = 0; k < options_.max_steps; ++k) {
    const Vector last_x = iterate.x;
    iterate = step(state, iterate, k == 0 ? 1 : last, part, result);
    ++result.steps;
    result.iterates.push_back(state);
    measure(iterate, state, reaction, last_x, part, result);
    const double change = std::max(result.change_u, result.change_x);
    if (!std::isfinite(iterate.u.norm())) break;
    result.rate = last > 0 ? change / last : 0;
    // With friction the contraction of the last step does not tell that of the next.
    const bool predicts = options_.economical && nodal_ && !friction && k > 1;
    const double left = predicts ? change * std::min(result.rate, 1.0) : change;
    if (left <= tolerance) {
      if (is_complete(iterate, part, change > tolerance)) return true;
      anderson = Anderson(3); // from here on states are seen as a whole
      images.clear();
    }
    since_best = change < best ? 0 : since_best + 1;
    best = std::min(best, change);
    if (since_best >= patience) break;
    last = change;
    state = iterate.u;
    reaction = iterate.reaction;
    // Steps between nodes with friction are Kacanov's: they contract alike, and gain as much.
    if (method_ != NonlinearMethod::anderson && !(nodal_ && friction)) continue;
    images.push_back(iterate);
    const Vector shares = anderson.combine(iterate.u - result.iterates.back());
    if (std::ssize(images) > shares.size()) images.erase(images.begin());
    state.setZero();
    reaction.setZero();
    if (nodal_) iterate.x.setZero(); // the next step starts from it, too
    for (Index j = 0; j < shares.size(); ++j) {
      state += shares[j] * images[j].u;
      reaction += shares[j] * images[j].reaction;
      if (nodal_) iterate.x += shares[j] * images[j].x;
    }
  }
  result.reason = "the condition that follows the displacement does not settle: after " +
                  std::to_string(result.steps) + " steps they change u by " +
                  short_number(result.change_u) + " and the multipliers by " +
                  short_number(result.change_x) + ", contraction " + short_number(result.rate) +
                  moving_segments(result) + ": " + advice();
  return false;
}

bool in_load_steps(const NonlinearContact &contact, const NonlinearOptions &options,
                   Iteration &iteration, Iterate &iterate, NonlinearResult &result) {
  constexpr double on_the_way = 1e-3;
  iterate = {};
  iterate.u = Vector::Zero(contact.free.size()); // of no part of the motion: undeformed
  for (int step = 1; step <= options.load_steps; ++step) {
    const bool last = step == options.load_steps;
    result.load_steps = step;
    result.iterates.clear();
    if (!iteration.run(iterate, static_cast<double>(step) / options.load_steps,
                       last ? options.tolerance : on_the_way, result))
      return false;
  }
  return true;
}

/// B v of displacements v, by averages at the nodes.
Vector times_b(const NodalContact &contact, const NodeLaws &laws, const NodalCondition &at,
               const Vector &v) {
  const Vector mean = contact.compliance.average() * v;
  Vector result = Vector::Zero(laws.rows);
  for (Index node = 0; node < laws.nodes(); ++node) {
    const auto n = at.normal.col(node);
    result[laws.normal[node]] = n.dot(mean.segment<2>(2 * node));
    if (laws.has_tangent(node))
      result[laws.tangent[node]] = n[0] * mean[2 * node + 1] - n[1] * mean[2 * node];
  }
  return result;
}

/// What is left of the laws at the solution, with the condition there. `nodal`: it, if it is known.
void measure_laws(const NonlinearContact &contact, const NodalCondition *nodal, Iterate &found,
                  NonlinearResult &result) {
  Vector w, moved, unloaded; // B u, B u_0
  if (nodal != nullptr) {
    w = nodal->w;
    found.reaction = nodal->load;
    moved = times_b(*contact.nodal, contact.laws, *nodal, found.u);
    unloaded = contact.free.isZero(0) ? Vector(Vector::Zero(w.size()))
                                      : times_b(*contact.nodal, contact.laws, *nodal, contact.free);
  } else {
    Linearised here;
    contact.linearise(found.u, here);
    moved = here.b * found.u;
    unloaded = here.b * contact.free;
    w = here.g - moved;
    found.reaction = here.b.transpose() * found.x;
  }
  result.start = found.x - w.cwiseQuotient(found.diagonal);
  result.residual =
      residual_of_laws(contact.laws, w + moved, found.x, w,
                       (unloaded.cwiseAbs() + (moved - unloaded).cwiseAbs()).maxCoeff());
}

} // namespace

NonlinearResult solve_nonlinear(const NonlinearContact &contact, const Start &start,
                                const NonlinearOptions &options) {
  NonlinearResult result;
  Iteration iteration(contact, options);
  Iterate iterate;
  iterate.u = start.state;
  if (contact.laws.has_tangents()) {
    iterate.start = start.x;
    if (contact.nodal && start.x.size() > 0) iterate.x = admissible(contact.laws, start.x);
  } else if (start.x.size() > 0) {
    iterate.x = start.x.cwiseMax(0.0);
    for (Index row = 0; row < start.x.size(); ++row)
      if (start.x[row] > 0) iterate.active.push_back(row);
  }
  std::string from_rest;
  const auto attempt = [&](auto &&steps) {
    try {
      result.converged = steps();
    } catch (const Error &error) {
      result.reason = error.what();
    }
  };
  const Iterate begin = iterate;
  attempt([&] { return iteration.run(iterate, 1, options.tolerance, result); });
  if (!result.converged && iteration.fall_back()) {
    iterate = begin;
    result.iterates.clear();
    attempt([&] { return iteration.run(iterate, 1, options.tolerance, result); });
  }
  if (!result.converged && options.load_steps > 0) {
    from_rest = result.reason;
    attempt([&] { return in_load_steps(contact, options, iteration, iterate, result); });
  }
  if (!result.converged) {
    result.last_x = std::move(iterate.x);
    return result;
  }
  result.reason = std::to_string(result.steps) + " steps";
  if (result.load_steps > 0)
    result.reason += " in " + std::to_string(result.load_steps) +
                     " load steps, as without them it failed (" + from_rest + ")";
  result.reason += ", last change " + short_number(std::max(result.change_u, result.change_x)) +
                   ", contraction " + short_number(result.rate) + moving_segments(result);
  if (!contact.solve) measure_laws(contact, iteration.condition(), iterate, result);
  result.x = std::move(iterate.x);
  result.reaction = std::move(iterate.reaction);
  result.state = std::move(iterate.u);
  result.active = std::move(iterate.active);
  return result;
}

} // namespace rbvi
