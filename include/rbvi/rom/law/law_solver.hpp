// The online stage of the law at the nodes: the condensed operator and the gap at mu, the
// law of contact and friction at every node by solve_friction, then the displacement in V_N by
// A_N u = F_N - B_N^T x. Where the multipliers are reduced further, the law is that of
// rom/law/reduced_law.hpp; with the condensed operator its answer is checked at all nodes, and
// mended by solve_friction, which starts from it, where it fails.
#pragma once

#include "rbvi/law/friction/several_answers.hpp"
#include "rbvi/law/nonlinear/nonlinear.hpp"
#include "rbvi/rom/law/reduced_law.hpp"
#include "rbvi/rom/model/answer.hpp"
#include "rbvi/rom/model/sample_starts.hpp"

namespace rbvi {

/// Whether the self-check met another answer at some parameter: its distance
/// (ReducedAnswer::to_other) and the parameter are the history "self_check/other".
bool has_several_answers(const ReducedModel &model);

class ModelCompliance;

/// Starts from what the training samples around mu predict (core/local_fit.hpp), a reduced law from
/// its own answer at the nearest of them. Where the self-check met another answer to the law at all
/// nodes, every query is solved by the rule of the high-fidelity solver (friction_answer)
/// and looks for others.
class LawSolver : public QueryMethod {
public:
  /// `model`, `scene` and `contact` must outlive it. Throws bad_input where they do not fit.
  LawSolver(const ReducedModel &model, const Scene &scene, const Contact &contact,
            const QueryOptions &options = {});
  ~LawSolver() override;
  /// Throws failure, saying what to try, if the law is not met to 1e-8.
  ReducedAnswer solve(const FullMu &all_parameters) override;
  /// What the elastic body says at mu, contact at a state where it follows one; valid until the
  /// next call of either. Sets theta_b or contact of the answer.
  LawAtMu law_at(const FullMu &all_parameters, ReducedAnswer &answer, const Vector &state = {});
  /// x - w / H_jj (FrictionResult::start) of the multipliers x at mu, H from the condensed
  /// operator. `state`: the displacement at the contact dofs, where contact follows it.
  Vector start_of(const FullMu &all_parameters, const Vector &x, const Vector &state);

private:
  /// What the condensed operator says of multipliers x.
  struct AtAllNodes {
    Vector w, diagonal; ///< H x + q, H_jj
    Vector start;       ///< x - w / H_jj
  };
  AtAllNodes at_all_nodes(const LawAtMu &law, const Vector &x);
  /// H(:, which), m x which.size().
  Matrix condensed_columns(const LawAtMu &law, const std::vector<Index> &which);
  Vector reduced_start(const Vector &here);
  /// Whether its answer stands; if not, exact steps follow, from it if there is one.
  bool answer_reduced_law(const LawAtMu &law, const Vector &start, ReducedAnswer &answer);
  void solve_at_nodes(const LawAtMu &law, const Vector &here, ReducedAnswer &answer);
  /// Empty: from rest.
  Vector start_at(const Vector &here) const;
  NonlinearStart following_start(const FullMu &all_parameters) const;
  ReducedAnswer solve_following(const FullMu &all_parameters);
  Vector term_coefficients(const FullMu &all_parameters, const Vector &theta_b) const;
  /// -A_N^-1 of the forces on CondensedOperator::dofs.
  Vector moved_by(const Vector &reaction) const;

  const ReducedModel &model_;
  const Scene &scene_;
  const Contact &contact_;
  QueryOptions options_;
  bool reduced_; ///< MultiplierReduction::collocated
  bool by_rule_; ///< the law at all nodes
  SampleStarts<Vector> reduced_starts_;
  Vector last_reduced_; ///< CollocatedResult::x of the last query
  /// The columns of B that the condensed operator knows. Throws failure where it meets others.
  SparseMatrix known_columns(const SparseMatrix &b) const;
  void check_edge(const Vector &x) const;

  ColumnLaws columns_;      ///< of the dual basis
  SparseMatrix nodal_;      ///< the dual basis transposed, where b does not separate
  std::vector<int> place_;  ///< of each contact dof in CondensedOperator::dofs; -1: it is not there
  Matrix trace_;            ///< the primal basis at these dofs, without an operator at all
  Matrix unit_loads_;       ///< of a unit force at each of these dofs: ReducedBody::prepared
  std::vector<Index> edge_; ///< columns of the dual basis beside nodes without one
  Matrix samples_;          ///< where the starts are, as parts of the box
  Vector last_start_;       ///< of the last query
  std::unique_ptr<ModelCompliance> compliance_; ///< where b does not separate
  // Where contact follows the displacement:
  std::optional<NodalCompliance> nodal_compliance_;
  bool nodal_is_identity_ = false; ///< nodal_
  SparseMatrix w_product_;         ///< of the columns of the dual basis
  Vector last_state_;
  const ReducedBody body_;
  BodyAtMu at_mu_;
};

} // namespace rbvi
