// A query on the pair of spaces. With A_N = R R^T, Y = R^-1 B^T and c = R^-1 f the multipliers
// solve
//
//   min over x >= 0 of  1/2 |Y x - c|^2 + g . x,    then  u = R^-T (c - Y x)
//
// What does not depend on mu is done once: Y where A and B have one term each. B and G that do not
// separate are evaluated anew, on the interfaces alone. Free modes have equations in place of
// inequalities. An online-enriched model is first reduced to V_N + S_R(mu) (2.17).
// Niakh (2022): (1.21)-(1.24).
#pragma once

#include "rbvi/method/mixed_qp.hpp"
#include "rbvi/method/starts.hpp"
#include "rbvi/model/answer.hpp"
#include "rbvi/model/reduced_body.hpp"

namespace rbvi {

/// Where a query starts.
struct ConeStart {
  std::vector<Index> active;
  std::optional<MixedQp> qp{}; ///< with its factorisation, of Y number y_number
  int y_number = 0;
};

class ConeSolver : public QueryMethod {
public:
  /// `model`, `scene` and `contact` must outlive it.
  ConeSolver(const ReducedModel &model, const Scene &scene, const Contact &contact,
             const QueryOptions &options);
  /// Throws failure, saying what to try, if the reduced constraints contradict each other, if A_N
  /// is not positive definite, if the KKT residual exceeds 1e-8, or if a node that the dual basis
  /// takes to be in contact is pulled at by more than 1 % of the peak pressure.
  ReducedAnswer solve(const FullMu &mu, Relaxed relaxed) override;
  std::optional<ReducedAnswer> near(const ReducedAnswer &from, const FullMu &mu) override;

private:
  /// Of the answer at a sample, where the model has it.
  std::vector<Index> known_active(Index sample) const;
  /// Sets qp_ to where a query starts.
  void start(const FullMu &mu);
  void solve_from_start(ReducedAnswer &answer);
  /// The pair at mu; contact, where it follows the displacement, at a state.
  void solve_pair(const Vector &state, ReducedAnswer &answer);
  /// Kacanov's iteration with the pair, accelerated but for OnlineMethod::kacanov.
  void solve_following(ReducedAnswer &answer);
  /// Sets G, and B where that is evaluated too.
  void evaluate(const Vector &state, ReducedAnswer &answer);
  void set_b(const Vector &theta_b);
  void set_y();
  void solve_dual(ReducedAnswer &answer);
  /// Sets the energy and the residual of an answer. Throws failure where it is none.
  void finish(ReducedAnswer &answer);
  void check_pull(const ReducedAnswer &answer) const;

  const ReducedModel &model_;
  const Scene &scene_;
  const Contact &contact_;
  const QueryOptions options_;
  const ReducedBody body_;
  bool positive_; ///< every pressure is: no free modes, no negative entry of a generator
  Index first_dual_ = 0, dual_rows_; ///< the rows of the dual basis that are not zero are these

  // What a query changes.
  Vector beta_; ///< Relaxed::beta
  Starts<ConeStart> starts_;
  BodyAtMu at_mu_;
  MixedQp qp_;
  int y_number_ = 0; ///< Y so far
  int root_of_y_ = 0;
  // B = b_scale_ b_, Y = b_scale_ / sqrt(at_mu_.scale()) y_.
  Vector theta_b_; ///< of b_
  Matrix b_, turned_b_, y_;
  double b_scale_ = 1;
  Vector f_, g_;
};

} // namespace rbvi
