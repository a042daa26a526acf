// Active sets on the multipliers: by columns of the compliance of the contact dofs.
#include "contact_method.hpp"

#include "proportional_body.hpp"

#include "rbvi/contact/history.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/method/several_answers.hpp"
#include "rbvi/solve/contact_cost.hpp"
#include "rbvi/solve/scaled_part.hpp"
#include "rbvi/solve/vectors.hpp"

#include <algorithm>
#include <ranges>
#include <set>
#include <vector>

namespace rbvi {

namespace {

constexpr double refined_above = 1e-11;
constexpr int most_refinements = 4, while_refused = 12; // passes, where the limit is met or not

/// The history of friction that a solution leaves, all rows of B on this rank.
Vector slip_left(const Problem &problem, const Operators &op, const Vector &before,
                 const MethodResult &result) {
  if (tangential_size(problem.contact()) == 0) return {};
  return slip_of(problem.contact(), op.b * restrict_to(problem.trace(), result.free_u.get()) - op.g,
                 op.weights, before);
}

/// Where a few dozen accelerated Uzawa steps see contact: far cheaper than the columns of all
/// nodes.
Vector rough_start(KSP ksp, Problem &problem, const Operators &op) {
  const UzawaOptions rough{.tolerance = 1e-3, .max_iterations = 100, .accelerated = true};
  const DualLayout &layout = problem.dual_layout();
  const DistributedContact contact = distribute(layout, op, op.laws);
  const Handle<Mat> w = distribute(layout, problem.w_product());
  MethodResult found = solve_uzawa(ksp, layout, contact, op.f, w.get(), rough);
  return found.lambda.allFinite() ? found.lambda : Vector(); // not finite: B is zero
}

class OnColumns : public ContactMethod {
public:
  OnColumns(Problem &problem, const HfOptions &options, KSP ksp, ColumnsLast last)
      : problem_(problem), options_(options), ksp_(ksp), body_(ksp, problem.trace(), last) {}
  ContactRows begin(const Vector &) override { return ContactRows::all; }
  void set(const Operators &op) override {
    set_operator(ksp_, op.a);
    body_.set(op.a);
    const double half = problem_.trace().size / 2.0; // of the columns, as contact_cost has it
    if (body_.keeps_columns() && body_.count() == 0 && takes_complement(problem_, half))
      body_.require_all();
  }
  void share_columns(const Groups &groups, const std::vector<Mu> &set) override;

protected:
  Problem &problem_;
  const HfOptions &options_;
  KSP ksp_;
  FactoredBody body_;
};

void OnColumns::share_columns(const Groups &groups, const std::vector<Mu> &set) {
  if (!body_.keeps_columns() || groups.count() == 1 || std::ssize(set) < 2 * groups.count() ||
      !problem_.scene().f.empty())
    return;
  std::set<Index> dofs;
  Operators rows;
  Mat a = nullptr;
  for (const Mu &mu : set) {
    try {
      problem_.assemble_contact(mu, rows);
      if (a == nullptr) a = problem_.assemble(mu).a;
    } catch (const Error &) {
      continue; // of every group; the sample will say why
    }
    for (Index i = 0; i < rows.g.size(); ++i)
      for (SparseMatrix::InnerIterator entry(rows.b, i); entry && rows.g[i] < 0; ++entry)
        dofs.insert(entry.col());
  }
  if (a == nullptr) return;
  set_operator(ksp_, a);
  body_.set(a);
  if (takes_complement(problem_, static_cast<double>(dofs.size()) / groups.count()))
    return body_.require_all(&groups);
  body_.require({dofs.begin(), dofs.end()}, groups);
}

class Condensed : public OnColumns {
public:
  using OnColumns::OnColumns;
  ContactRows begin(const Vector &slip) override {
    if (part_fits_ && !part_ && solves_ > 0) part_ = std::make_unique<ScaledPart>(problem_);
    if (proportional_ && !whole_ && solves_ > 0)
      whole_ = std::make_unique<ProportionalBody>(problem_);
    ++solves_;
    return OnColumns::begin(slip);
  }
  MethodResult solve(const ContactTask &task) override;
  void check(const MethodResult &result) const override {
    require_residual(result, residual_limit);
  }

private:
  /// Without what is measured on it.
  MethodResult refined(FullBody &body, const ContactTask &task);
  Vector start_of(const ContactTask &task) {
    if (task.near != nullptr) return task.near->start.x;
    const bool columns_are_kept = part_ || whole_ || body_.count() > 0;
    return columns_are_kept ? Vector() : rough_start(ksp_, problem_, task.op);
  }

  const bool part_fits_ = ScaledPart::fits(problem_.scene());
  const bool proportional_ = stiffness_scales(problem_.scene()) && problem_.free_bodies().empty();
  std::unique_ptr<ScaledPart> part_;        ///< where a part of A is scaled, from the second mu on
  std::unique_ptr<ProportionalBody> whole_; ///< where all of it is, likewise
  int solves_ = 0;
};

MethodResult Condensed::solve(const ContactTask &task) {
  const Operators &op = task.op;
  MethodResult result;
  if (part_) {
    part_->set(op);
    result = refined(*part_, task);
  }
  if (whole_) {
    whole_->set(op);
    result = refined(*whole_, task);
  }
  // What these leave by round-off, the body itself may not.
  if (!(part_ || whole_) || !(result.kkt.largest() <= residual_limit))
    result = refined(body_, task);
  if (!result.converged) return result;
  measure(problem_, op, op.weights, result);
  result.slip = slip_left(problem_, op, task.slip, result);
  return result;
}

MethodResult Condensed::refined(FullBody &body, const ContactTask &task) {
  const Operators &op = task.op;
  std::vector<MethodResult> passes;
  passes.reserve(while_refused + 1);
  const auto add = [&](const Vector &start, const ActiveSetOptions &options) {
    MethodResult &result = passes.emplace_back(solve_active_set(body, op, start, options));
    // Of a body that contact alone holds, whose springs are as stiff as itself, the motion under
    // its load is round-off's measure; one on soft springs of its own shall be more exact.
    const double moved = problem_.free_bodies().empty() ? 0 : result.moved;
    if (result.converged)
      result.kkt = kkt_residual(problem_.trace(), op, result.free_u.get(), result.lambda, moved);
    return result.converged;
  };
  ActiveSetOptions first{!task.continues, options_.looks_for_others, {}};
  if (first.looks_for_others && !problem_.free_bodies().empty()) first.held = problem_.held_by(op);
  if (!add(start_of(task), first)) return std::move(passes.front());
  // H has the round-off of A^-1, which iterative refinement takes out; where its own is as large,
  // the best of the passes counts.
  Vector correction = Vector::Zero(op.g.size());
  const auto residual = [](const MethodResult &of) { return of.kkt.largest(); };
  for (int pass = 0; pass < while_refused; ++pass) {
    const MethodResult &last = passes.back();
    if (residual(last) <= refined_above) break;
    if (pass >= most_refinements &&
        std::ranges::min(passes | std::views::transform(residual)) <= residual_limit)
      break;
    correction += op.g - op.b * restrict_to(problem_.trace(), last.free_u.get()) - last.w;
    if (!add(last.start.size() > 0 ? last.start : last.lambda, {false, false, correction, &last})) {
      passes.pop_back();
      break;
    }
  }
  const auto best = std::ranges::min_element(passes, {}, residual);
  int iterations = 0, columns = 0;
  double to_other = 0;
  for (const MethodResult &of : passes) {
    iterations += of.iterations;
    columns += of.columns;
    to_other = std::max(to_other, of.to_other);
  }
  best->iterations = iterations;
  best->columns = columns;
  best->to_other = to_other;
  return std::move(*best);
}

/// Contact that follows the displacement.
class Following : public OnColumns {
public:
  using OnColumns::OnColumns;
  MethodResult solve(const ContactTask &task) override {
    Operators op = task.op;
    Start start{undeformed(problem_.contact(), problem_.scene(), op.mu), {}};
    if (task.near != nullptr && !bounds_follow_pressure(op.laws)) start = task.near->start;
    NonlinearOptions options = options_.nonlinear;
    FollowingResult found = solve_from(start, task, options, op);
    // Steps that change little may leave more of the laws, which a smaller tolerance takes out.
    for (int pass = 0; pass < most_refinements && !(found.result.kkt.largest() <= allowed());
         ++pass) {
      options.tolerance /= 100;
      const FollowingResult before = std::move(found);
      op = task.op;
      found = solve_from({before.steps.state, before.steps.start}, task, options, op);
      found.result.iterations += before.result.iterations;
      found.steps.load_steps += before.steps.load_steps;
      found.steps.iterates.insert(found.steps.iterates.begin(), before.steps.iterates.begin(),
                                  before.steps.iterates.end());
    }
    auto &[result, steps] = found;
    measure(problem_, op, op.weights, result);
    result.load_steps = steps.load_steps;
    result.slip = slip_left(problem_, op, task.slip, result);
    result.contraction = steps.rate;
    result.states = std::move(steps.iterates);
    result.states.push_back(std::move(steps.state));
    return std::move(result);
  }
  void check(const MethodResult &result) const override { require_residual(result, allowed()); }

private:
  double allowed() const {
    return limit_of_iteration(residual_limit, options_.nonlinear.tolerance);
  }
  FollowingResult solve_from(const Start &start, const ContactTask &task,
                             const NonlinearOptions &options, Operators &op) {
    FollowingResult found = solve_following(body_, problem_, op, task.slip, start, options);
    found.result.kkt =
        kkt_residual(problem_.trace(), op, found.result.free_u.get(), found.result.lambda);
    return found;
  }
};

} // namespace

std::unique_ptr<ContactMethod> make_contact_method(Problem &problem, const HfOptions &options,
                                                   KSP ksp) {
  const bool by_sets = options.method == HfMethod::active_set,
             follows = follows_state(problem.contact());
  if (follows && !by_sets)
    throw bad_input("-hf_method " + hf_method_names()[static_cast<std::size_t>(options.method)] +
                    " is for small deformations: leave it out, or use -kinematics small");
  if (options.method == HfMethod::vi) require_bounds_at_nodes(problem.scene());
  if (!has_multipliers(problem.scene())) return make_nitsche_method(problem, options);
  const ColumnsLast changing =
      follows || !problem.free_bodies().empty() ? ColumnsLast::for_one_mu : ColumnsLast::for_one_b;
  const ColumnsLast last = constant_stiffness(problem.scene()) ? ColumnsLast::for_all_mu : changing;
  if (follows) {
    if (options.contact == HfContact::eliminated)
      throw bad_input("-hf_contact eliminated is for small deformations: leave it out, or use "
                      "-kinematics small");
    return std::make_unique<Following>(problem, options, ksp, last);
  }
  if (!by_sets) return make_distributed_method(problem, options, ksp);
  if (eliminates(problem, options))
    return make_elimination(problem, options,
                            std::make_unique<Condensed>(problem, options, ksp, changing));
  auto condensed = std::make_unique<Condensed>(problem, options, ksp, last);
  PetscBool iterative = PETSC_FALSE; // then its tolerance is what is to be changed
  RBVI_CALL(PetscOptionsHasName(nullptr, nullptr, "-hf_ksp_type", &iterative));
  if (options.contact == HfContact::condensed || iterative == PETSC_TRUE) return condensed;
  return make_rescued(problem, options, std::move(condensed));
}

} // namespace rbvi
