// The two ways to meet the law of contact and friction at all nodes in a query.
#pragma once

#include "rbvi/method/nonlinear.hpp"
#include "rbvi/model/law_problem.hpp"
#include "rbvi/model/law_solver.hpp"

namespace rbvi {

/// At every node.
class NodeLawSolver : public QueryMethod {
public:
  /// `by_rule`: as in friction_answer.
  NodeLawSolver(const ReducedModel &model, const Scene &scene, const Contact &contact,
                const QueryOptions &options, bool by_rule);
  ReducedAnswer solve(const FullMu &mu, Relaxed relaxed) override;
  void displace(ReducedAnswer &answer) override;
  std::optional<ReducedAnswer> near(const ReducedAnswer &from, const FullMu &mu) override;
  /// From answer.start, where that is there, or from what the samples predict.
  void solve_at_nodes(const LawAtMu &law, ReducedAnswer &answer);
  LawProblem &problem() { return problem_; }

private:
  const ReducedModel &model_;
  const Scene &scene_;
  const bool by_rule_, looks_for_others_;
  LawProblem problem_;
  std::unique_ptr<FrictionSolver> near_; ///< of the answer that near() goes on from
  Starts<Vector> starts_;                ///< FrictionResult::start
  /// Of bodies that contact alone holds the last problem and its answer, where others are looked
  /// for: at the one at which forces balance.
  std::optional<std::pair<Vector, FrictionAnswer>> balanced_;
};

/// At every node, contact that follows the displacement.
class FollowingSolver : public QueryMethod {
public:
  FollowingSolver(const ReducedModel &model, const Scene &scene, const Contact &contact,
                  const QueryOptions &options, bool by_rule);
  ReducedAnswer solve(const FullMu &mu, Relaxed relaxed) override;
  std::optional<ReducedAnswer> near(const ReducedAnswer &from, const FullMu &mu) override;

private:
  Start start(const FullMu &mu) const;
  ReducedAnswer solve_from(const Start &start, const FullMu &mu, const Vector &beta);

  const ReducedModel &model_;
  const Scene &scene_;
  const Contact &contact_;
  const bool by_rule_, looks_for_others_;
  const ColumnLaws columns_; ///< of the dual basis
  const ReducedBody body_;
  BodyAtMu at_mu_;
  EvaluatedContact evaluated_;
  std::optional<NodalCompliance> nodal_;
  const bool rows_are_identity_; ///< of evaluated_
  const SparseMatrix w_product_; ///< of the columns of the dual basis
  Starts<Start> starts_;
  NonlinearOptions steps_{.economical = true};
};

} // namespace rbvi
