// Queries by the published law on fewer functions. Niakh (2022): (3.52), (3.54).
#include "../law_methods.hpp"
#include "queries.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/model/published/collocated_problem.hpp"

namespace rbvi {

namespace {

/// Greedy cones can have a generator that depends on the others: its coefficient is any; this
/// chooses one, far below all tolerances.
constexpr double ridge = 1e-12;

constexpr double mended_above = 1e-6; ///< violation of the law at all nodes
/// Steps are cheap here, and along nearly dependent generators some 20000 are needed.
constexpr UzawaOptions uzawa_options{.max_iterations = 200000};

} // namespace

CollocatedProblem collocated_problem(const MultiplierBasis &basis, const LawAtMu &law,
                                     const BodyAtMu &body) {
  const Matrix functions = multiplier_coefficients(basis);
  const Matrix y = body.half_response(law.b.transpose() * functions);
  Matrix h = y.transpose() * y;
  h.diagonal() *= 1 + ridge;
  const std::vector<Index> nodes(basis.nodes.begin(), basis.nodes.end());
  std::vector<Index> rows; // of the tangential multipliers that collocation nodes have
  for (const Index node : nodes)
    rows.push_back(law.laws.tangent[node] - law.laws.nodes());
  return {h, functions.transpose() * law.q, basis.normal(nodes, Eigen::all),
          basis.tangential(rows, Eigen::all), bounds_at(law.laws.bound, nodes)};
}

namespace {

/// On fewer functions. From the answer on them at the nearest training sample; by Uzawa's method
/// from zero, and then never mended.
class CollocatedSolver : public QueryMethod {
public:
  CollocatedSolver(const ReducedModel &model, const Scene &scene, const Contact &contact,
                   const QueryOptions &options);
  ReducedAnswer solve(const FullMu &mu, Relaxed relaxed) override;
  void displace(ReducedAnswer &answer) override { at_nodes_.displace(answer); }

private:
  Vector start(const FullMu &mu);
  CollocatedResult solve_functions(const LawAtMu &law, const Vector &start);
  /// Whether its answer stands; if not, exact steps follow, from it if there is one.
  bool answer_on_functions(const LawAtMu &law, const Vector &start, ReducedAnswer &answer);

  const ReducedModel &model_;
  const Scene &scene_;
  const QueryOptions options_;
  NodeLawSolver at_nodes_;
  Starts<Vector> starts_; ///< CollocatedResult::x
  Matrix product_;        ///< Gram matrix of the functions in W, for Uzawa's method
};

CollocatedSolver::CollocatedSolver(const ReducedModel &model, const Scene &scene,
                                   const Contact &contact, const QueryOptions &options)
    : model_(model), scene_(scene), options_(options),
      at_nodes_(model, scene, contact, options, false),
      starts_(scene.parameters,
              options.method == OnlineMethod::uzawa ? Matrix() : model.contact.law->starts_mu,
              options.warm) {
  if (options.method != OnlineMethod::uzawa) return;
  const Matrix functions =
      model.contact.dual_basis * multiplier_coefficients(model.contact.law->basis);
  product_ = functions.transpose() * (contact.w_product() * functions);
}

CollocatedResult CollocatedSolver::solve_functions(const LawAtMu &law, const Vector &start) {
  const bool by_uzawa = product_.size() > 0;
  const CollocatedProblem problem =
      collocated_problem(model_.contact.law->basis, law, at_nodes_.problem().body());
  CollocatedResult found = by_uzawa ? solve_collocated_by_uzawa(problem, product_, uzawa_options)
                                    : solve_collocated(problem, start);
  if (!found.converged)
    throw failure("the reduced law of contact is not solved: " + found.reason +
                  (by_uzawa ? "; ask by the method exact, or reduce again with fewer functions"
                            : "; reduce again with -multiplier_reduction condensed, or with more "
                              "functions"));
  return found;
}

Vector CollocatedSolver::start(const FullMu &mu) {
  const auto from_rest = [&](Index sample) {
    const Vector there = model_.contact.law->starts_mu.col(sample);
    ReducedAnswer unused;
    const LawAtMu &law =
        at_nodes_.problem().at(expand(scene_.parameters, {there.begin(), there.end()}), unused);
    return solve_functions(law, {}).x;
  };
  return starts_.at([&] { return starts_.nearest_from(mu, from_rest); });
}

bool CollocatedSolver::answer_on_functions(const LawAtMu &law, const Vector &start,
                                           ReducedAnswer &answer) {
  const bool checks = model_.contact.law->condensed.terms.size() > 0;
  const bool mends = model_.contact.law->mended && checks && product_.size() == 0;
  try {
    CollocatedResult reduced = solve_functions(law, start);
    const Matrix functions = multiplier_coefficients(model_.contact.law->basis);
    answer.lambda = functions * reduced.x;
    if (options_.looks_for_others)
      answer.to_other = distance_of_answers(answer.lambda, functions * solve_functions(law, {}).x);
    answer.residual = reduced.residual;
    answer.iterations = reduced.iterations;
    starts_.keep(reduced.x);
  } catch (const Error &) {
    if (!mends) throw;
    return false;
  }
  if (!checks) {
    const Vector half = at_nodes_.problem().body().half_response(law.b.transpose() * answer.lambda);
    answer.energy = 0.5 * (half.squaredNorm() - law.load.squaredNorm());
    return true;
  }
  AtAllNodes nodes = at_nodes_.problem().at_all_nodes(law, answer.lambda);
  answer.energy = 0.5 * (answer.lambda.dot(nodes.w - law.q) - law.load.squaredNorm());
  answer.residual = at_nodes_.problem().residual(law, answer.lambda, nodes.w);
  answer.start = std::move(nodes.start);
  return !mends || violation(law.laws, answer.lambda, answer.start) <= mended_above;
}

ReducedAnswer CollocatedSolver::solve(const FullMu &mu, Relaxed relaxed) {
  const Vector from = start(mu);
  ReducedAnswer answer = std::move(relaxed.before);
  answer.start.resize(0);
  answer.left.resize(0);
  answer.iterations = 0;
  const LawAtMu &law = at_nodes_.problem().at(mu, answer, {}, relaxed.beta);
  if (!answer_on_functions(law, from, answer)) at_nodes_.solve_at_nodes(law, answer);
  return answer;
}

} // namespace

std::unique_ptr<QueryMethod> collocated_solver(const ReducedModel &model, const Scene &scene,
                                               const Contact &contact,
                                               const QueryOptions &options) {
  return std::make_unique<CollocatedSolver>(model, scene, contact, options);
}

} // namespace rbvi
