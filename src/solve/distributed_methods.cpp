// B, G and multipliers distributed over the ranks: active sets by elimination, Uzawa's method and
// SNES with its VI extension.
#include "contact_method.hpp"

#include "rbvi/contact/history.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/solve/eliminated.hpp"
#include "rbvi/solve/vectors.hpp"

#include <algorithm>

namespace rbvi {

namespace {

void measure_over_ranks(Problem &problem, const ContactTask &task,
                        const DistributedContact &contact, MethodResult &result) {
  const DualLayout &layout = problem.dual_layout();
  const Handle<Vec> lambda = distribute(layout, result.lambda);
  result.kkt = kkt_residual(contact, task.op, result.free_u.get(), lambda.get());
  const Vector weights = on_every_rank(layout, contact.weights.get())(task.op.laws.normal);
  measure(problem, task.op, weights, result);
  if (tangential_size(problem.contact()) == 0) return;
  const Handle<Vec> excess = like(contact.g.get());
  RBVI_CALL(MatMult(contact.b.get(), result.free_u.get(), excess.get()));
  RBVI_CALL(VecAXPY(excess.get(), -1, contact.g.get()));
  result.slip = slip_of(problem.contact(), on_every_rank(layout, excess.get()), weights, task.slip);
}

class ByElimination : public ContactMethod {
public:
  ByElimination(Problem &problem, const HfOptions &options,
                std::unique_ptr<ContactMethod> otherwise)
      : problem_(problem), options_(options), grids_(problem), otherwise_(std::move(otherwise)) {}
  ContactRows begin(const Vector &) override { return ContactRows::own; }
  void set(const Operators &op) override { otherwise_->set(op); }
  MethodResult solve(const ContactTask &task) override {
    std::string complaint;
    MethodResult result = eliminated(task, complaint);
    if (complaint.empty()) return result;
    if (options_.contact == HfContact::eliminated) throw failure(complaint);
    const Operators &op = problem_.assemble(task.mu, otherwise_->begin(task.slip), task.slip);
    result = otherwise_->solve({task.mu, op, task.slip, task.starts, task.near, task.continues});
    result.reason += ", condensed because elimination failed: " + complaint;
    return result;
  }
  void check(const MethodResult &result) const override {
    require_residual(result, residual_limit);
  }

private:
  /// Why elimination does not meet the laws: in `complaint`.
  MethodResult eliminated(const ContactTask &task, std::string &complaint) {
    try {
      MethodResult result =
          grids_.solve(task.mu, task.op, task.near == nullptr ? Vector() : task.near->start.x,
                       1e-13, !task.continues);
      if (!result.converged) {
        complaint = result.reason;
        return result;
      }
      measure_over_ranks(problem_, task, distribute(problem_.dual_layout(), task.op, task.op.laws),
                         result);
      if (!(result.residual <= residual_limit))
        complaint = "a KKT residual of " + short_number(result.residual) +
                    " is left: try -hf_contact condensed";
      return result;
    } catch (const Error &error) { // of every rank
      complaint = error.what();
      return {};
    }
  }

  Problem &problem_;
  const HfOptions &options_;
  GridSequence grids_;
  std::unique_ptr<ContactMethod> otherwise_; ///< where it fails
};

class Rescued : public ContactMethod {
public:
  Rescued(Problem &problem, const HfOptions &options, std::unique_ptr<ContactMethod> first)
      : problem_(problem), options_(options), first_(std::move(first)) {
    options_.contact = HfContact::eliminated;
  }
  ContactRows begin(const Vector &slip) override { return first_->begin(slip); }
  void set(const Operators &op) override { first_->set(op); }
  MethodResult solve(const ContactTask &task) override {
    MethodResult result = first_->solve(task);
    if (!result.converged || result.residual <= residual_limit) return result;
    if (!second_) second_ = make_elimination(problem_, options_, nullptr);
    try {
      MethodResult other = second_->solve(task); // which takes its own of all rows
      other.reason += ", eliminated because a condensed residual of " +
                      short_number(result.residual) + " was left";
      return other;
    } catch (const Error &) { // of every rank; the first one's residual says what to try
      return result;
    }
  }
  void check(const MethodResult &result) const override { first_->check(result); }
  Solved kept(MethodResult &result) const override { return first_->kept(result); }
  void share_columns(const Groups &groups, const std::vector<Mu> &set) override {
    first_->share_columns(groups, set);
  }

private:
  Problem &problem_;
  HfOptions options_;
  std::unique_ptr<ContactMethod> first_, second_; ///< null: not asked for yet
};

class OverRanks : public ContactMethod {
public:
  OverRanks(Problem &problem, const HfOptions &options, KSP ksp)
      : problem_(problem), options_(options), ksp_(ksp) {}
  ContactRows begin(const Vector &) override { return ContactRows::own; }
  void set(const Operators &op) override { set_operator(ksp_, op.a); }
  MethodResult solve(const ContactTask &task) override {
    const Operators &op = task.op;
    const DualLayout &layout = problem_.dual_layout();
    const DistributedContact contact = distribute(layout, op, op.laws);
    if (!w_product_) w_product_ = distribute(layout, problem_.w_product());
    MethodResult result =
        options_.method == HfMethod::vi
            ? solve_vi(problem_, contact, op)
            : solve_uzawa(ksp_, layout, contact, op.f, w_product_.get(), options_.uzawa);
    if (!result.converged) return result;
    result.active = in_contact(op.laws, result.lambda);
    measure_over_ranks(problem_, task, contact, result);
    return result;
  }
  void check(const MethodResult &result) const override {
    if (options_.method == HfMethod::uzawa)
      check_residual(result.residual,
                     limit_of_iteration(gradient_residual_limit, options_.uzawa.tolerance),
                     " at steps below -uzawa_tolerance: lower it, or try -uzawa_accelerated or "
                     "-hf_method active_set");
  }

private:
  Problem &problem_;
  const HfOptions &options_;
  KSP ksp_;
  Handle<Mat> w_product_; ///< made when first wanted
};

} // namespace

std::unique_ptr<ContactMethod> make_elimination(Problem &problem, const HfOptions &options,
                                                std::unique_ptr<ContactMethod> otherwise) {
  return std::make_unique<ByElimination>(problem, options, std::move(otherwise));
}

std::unique_ptr<ContactMethod> make_rescued(Problem &problem, const HfOptions &options,
                                            std::unique_ptr<ContactMethod> first) {
  return std::make_unique<Rescued>(problem, options, std::move(first));
}

std::unique_ptr<ContactMethod> make_distributed_method(Problem &problem, const HfOptions &options,
                                                       KSP ksp) {
  return std::make_unique<OverRanks>(problem, options, ksp);
}

} // namespace rbvi
