// The law of contact and friction in front of a reduced body, at the nodes of its dual basis: find
// x by the laws with w = H x + q, H the condensed operator, q the gap, and the slip, of no
// multipliers.
#pragma once

#include "rbvi/method/several_answers.hpp"
#include "rbvi/model/column_laws.hpp"
#include "rbvi/model/reduced_contact.hpp"

namespace rbvi {

/// At one mu; m multipliers.
struct LawAtMu {
  Vector q;        ///< m
  Matrix b;        ///< m x n; where the law is one on fewer functions
  Vector load;     ///< half response to the load; empty without one
  Vector unloaded; ///< n: the displacement of no multipliers; likewise
  NodeLaws laws;
  Matrix by_beta{}; ///< of q by what springs of free bodies are relaxed at; empty without them
};

/// What multipliers x leave at all nodes.
struct AtAllNodes {
  Vector w, diagonal; ///< H x + q, H_jj
  Vector start;       ///< x - w / H_jj (FrictionResult::start)
};

class LawProblem {
public:
  /// All must outlive it. Throws bad_input for a model without a law at nodes.
  LawProblem(const ReducedModel &model, const Scene &scene, const Contact &contact);
  LawProblem(const LawProblem &) = delete;

  /// At mu, contact at a state where it follows one, springs of free bodies relaxed at beta; valid
  /// until the next call. Sets mu, theta_b or contact of the answer, and its free motions where
  /// there is a beta; of an answer at this mu that has them only q and the load change with beta.
  const LawAtMu &at(const FullMu &mu, ReducedAnswer &answer, const Vector &state = {},
                    const Vector &beta = {});
  ReducedContact &contact() { return *contact_; } ///< of the last at()
  FrictionSolver &friction();                     ///< likewise
  /// That of the last at(), if friction() was asked for: of the columns that it knows it has those
  /// at the mu of before.
  std::unique_ptr<FrictionSolver> take_friction() { return std::move(friction_); }
  /// H x + q.
  Vector left(const LawAtMu &law, const Vector &x);
  const BodyAtMu &body() const { return at_mu_; }
  AtAllNodes at_all_nodes(const LawAtMu &law, const Vector &x);
  /// KktResidual::largest() of multipliers with w = H x + q.
  double residual(const LawAtMu &law, const Vector &x, const Vector &w) const;
  /// Sets the displacement of answer.lambda and, where answer.left is there, the residual. Throws
  /// failure where that is above its limit, and where contact leaves the nodes that the model has
  /// multipliers at.
  void displace(ReducedAnswer &answer) const;

private:
  void set(const FullMu &mu, const Vector &state, ReducedAnswer &answer);
  void set_springs(ReducedAnswer &answer);

  const ReducedModel &model_;
  const Scene &scene_;
  const Contact &interfaces_;
  const ColumnLaws columns_;      ///< of the dual basis
  const std::vector<Index> edge_; ///< columns of the dual basis beside nodes without one
  const ReducedBody body_;
  BodyAtMu at_mu_;
  const std::unique_ptr<ReducedContact> contact_;
  std::optional<FullMu> mu_; ///< of the next ones
  LawAtMu law_;
  std::unique_ptr<FrictionSolver> friction_; ///< null: not asked for
  // Of springs of free bodies: their coefficients, half responses and displacements to them, and
  // what of the law there is without them.
  Vector theta_, q_, load_, unloaded_;
  Matrix springs_, motions_;
};

/// The functions in coefficients of the nodal dual basis: m x (R + S).
Matrix multiplier_coefficients(const MultiplierBasis &basis);

} // namespace rbvi
