// The online stage: one parameter in, one checked answer out. Serial and dense. With A = L L^T,
// Y = L^-1 B^T and c = L^-1 f the multipliers solve
//
//   min over x >= 0 of  1/2 |Y x - c|^2 + g . x,    then  u = L^-T (c - Y x)
//
// What does not depend on mu is done once: the factor L where A has one term, Y where B has one
// term too. B and G that do not separate are evaluated anew, on the interfaces alone. Free modes
// have equations in place of inequalities. An online-enriched model is first reduced to V_N +
// S_R(mu) (2.17): the rows of B are the coordinates of T(mu) chi_r. The law at the nodes:
// rom/law/law_solver.hpp, by Nitsche's method rom/nitsche/nitsche_solver.hpp.
#pragma once

#include "rbvi/core/outputs.hpp"
#include "rbvi/law/qp/mixed_qp.hpp"
#include "rbvi/rom/law/changed_stiffness.hpp"
#include "rbvi/rom/law/law_solver.hpp"
#include "rbvi/rom/model/model.hpp"
#include "rbvi/rom/nitsche/nitsche_solver.hpp"
#include "rbvi/rom/nodal_trace.hpp"

#include <memory>

namespace rbvi {

static_assert(EIGEN_DEFAULT_ALIGN_BYTES == 64 && alignof(Eigen::Matrix<double, 8, 1>) == 64,
              "include headers of rbvi before those of Eigen, or define EIGEN_MAX_ALIGN_BYTES and "
              "EIGEN_MAX_STATIC_ALIGN_BYTES as 64 in the whole program: both share memory");

/// Answers queries on a model that it does not own. An answer depends on its mu and the model, to
/// round-off, not on the queries before (but QueryOptions::warm).
class OnlineSolver {
public:
  explicit OnlineSolver(const ReducedModel &model, const QueryOptions &options = {});
  OnlineSolver(const OnlineSolver &) = delete;
  /// With the forms, map and obstacle of `scene` instead of those of the model.
  OnlineSolver(const ReducedModel &model, Scene scene, const QueryOptions &options = {});
  /// `mu`: the free parameters; throws bad_input outside the box unless `extrapolate`. Throws
  /// failure, saying what to try, if the reduced constraints contradict each other, if the reduced
  /// stiffness is not positive definite, if the KKT residual exceeds 1e-8, or if a node that the
  /// dual basis takes to be in contact is pulled at by more than 1 % of the peak pressure.
  ReducedAnswer solve(const Mu &mu, bool extrapolate = false);
  /// Energy, forces and contact measures of an answer, at a cost that depends on the contact region
  /// alone (min_u is left unset: it needs the full field). Expected errors are set inside the box.
  /// Throws failure (check_finite).
  Outputs outputs(const Mu &mu, const ReducedAnswer &solution) const;
  /// At the dual dofs; of Nitsche's method what stands for it (nitsche_multiplier).
  Vector multiplier(const ReducedAnswer &solution) const;
  /// Gap that is left at the nodes with a constraint (ContactOperators::nodal_gap); infinite where
  /// the model has no displacement (ReducedModel::trace_dofs).
  Vector contact_gap(const ReducedAnswer &solution) const;
  /// At all dofs, without the motion of the scene, with the values that boundaries impose. Throws
  /// failure if the model was read without its fields.
  Vector field(const ReducedAnswer &solution) const;
  const ReducedModel &model() const { return model_; }
  const Scene &scene() const { return scene_; }
  const Contact &contact() const { return contact_; }

private:
  ReducedAnswer solve_at(const FullMu &all_parameters);
  void solve_cone(ReducedAnswer &solution);
  /// Sets qp_ to where a query starts.
  void start_cone(const FullMu &all_parameters);
  void evaluate_contact(const Vector &state, ReducedAnswer &solution);
  /// The pair at mu; contact, where it follows the displacement, at a state.
  void solve_pair(const Vector &state, ReducedAnswer &solution);
  /// Kacanov's iteration with the pair, accelerated.
  void solve_following(ReducedAnswer &solution);
  void update_operators(const Vector &theta_a, const Vector &theta_b);
  /// The same where the terms of A differ on few functions; whether B was made anew.
  void update_changed(const Vector &theta_a, bool new_b);
  void enrich();
  void solve_dual(ReducedAnswer &solution);
  /// Sets the energy and the residual of an answer of solve_pair, and u in the n functions. Throws
  /// failure where it is none.
  void finish(ReducedAnswer &solution);
  /// u of solve_pair in the n functions.
  Vector in_primal_basis(const Vector &u) const;
  /// weights, nodal_b and nodal_gap.
  ContactOperators nodal_operators(const ReducedAnswer &solution, const Vector &lambda) const;

  const ReducedModel &model_;
  const Scene scene_; ///< with_imposed_loads
  const Sum imposed_energy_;
  Contact contact_;
  std::optional<NodalTrace> trace_; ///< but by Nitsche's method
  // The law at nodes, or Nitsche's method: the rest is not used.
  std::unique_ptr<LawSolver> law_;
  SparseMatrix nodal_basis_; ///< with it: the dual basis
  std::unique_ptr<ReducedNitsche> nitsche_;
  const QueryOptions options_;
  MixedQp qp_;
  struct ConeStart {
    std::vector<Index> active;
    std::optional<MixedQp> qp; ///< with its factorisation, of Y number y_number
    int y_number = 0;
  };
  SampleStarts<ConeStart> starts_;
  int y_number_ = 0; ///< Y so far
  bool positive_;    ///< every pressure is: no free modes, no negative entry of a generator
  Index first_dual_, dual_rows_; ///< the rows of the dual basis that are not zero lie among these
  // At the last assembly: A (lower triangle), L, B and Y. The operators of the query are
  // a_scale_^2 A, a_scale_ L, b_scale_ B.
  Vector theta_a_, theta_b_;
  Matrix a_, l_, b_, y_;                    // evaluated contact: B is always that of the query
  std::optional<ChangedStiffness> changed_; ///< in place of a_ and l_
  Matrix fixed_y_;                          ///< L^-1 B^T, L of A_1
  Matrix enrichment_; ///< online-enriched: V_N + S_R(mu) in the n functions, which a_ ... f_ are in
  double a_scale_ = 1, b_scale_ = 1;
  Vector f_, g_, c_;
};

/// Relative residual of A u + B^T x = f, B u <= g, x . (B u - g) = 0 for x >= 0: the largest of
/// |A u + B^T x - f| / (|f| + |B^T x|), max (B u - g)_+ / s and |x . (B u - g)| / (s sum |x|), with
/// s = max(|g|, |B u|, 1e-4 terms) in the maximum norm. au = A u, bu = B u, btx = B^T x; `terms`:
/// |B| |u|, what cancels in B u. The last `free` rows are equations: B u = g.
double kkt_residual(const Vector &au, const Vector &btx, const Vector &f, const Vector &bu,
                    const Vector &g, const Vector &x, Index free = 0, double terms = 0);

} // namespace rbvi
