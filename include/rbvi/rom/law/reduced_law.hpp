// The law of contact and friction on fewer functions than nodes (MultiplierReduction): collocated,
// cones, joint. Everything in coefficients of the nodal dual basis, m of them: k for lambda_n, then
// m - k for lambda_tau, of the interfaces with friction alone.
#pragma once

#include "rbvi/law/friction/collocated_friction.hpp"
#include "rbvi/law/friction/least_squares_friction.hpp"
#include "rbvi/rom/law/column_laws.hpp"
#include "rbvi/rom/law/reduced_stiffness.hpp"

#include <functional>

namespace rbvi {

/// What the elastic body says at one mu.
struct BodyAtMu {
  Vector terms;                      ///< coefficient of each term of the condensed operator
  Matrix b;                          ///< m x n, reduced; collocated, or with a load
  SparseMatrix b_contact;            ///< m x contact dofs, where b does not separate
  const ReducedStiffness *stiffness; ///< set to mu
  Vector q;                          ///< m: the gap, and the slip, of no multipliers
  Vector load;                       ///< half response to the load; empty without one
  NodeLaws laws;                     ///< of the m multipliers
};

/// What an answer leaves for a nearby query; empty: from rest.
struct ReducedLawStart {
  Vector x;                      ///< collocated: its coefficients
  std::vector<Index> active;     ///< cones
  std::vector<SlipState> states; ///< joint
};

struct ReducedLawAnswer {
  Vector x;            ///< m nodal coefficients
  double residual = 0; ///< of the reduced law, relative
  int iterations = 0;
  ReducedLawStart start{};
};

/// H X of any number of columns, H the condensed operator at mu: m rows each.
using CondensedProduct = std::function<Matrix(const Matrix &)>;

class ReducedLaw {
public:
  /// `law` must outlive it; its reduction is not `condensed`. `columns`: of the dual basis.
  /// `b_separates`: the condensed operator is the sum of its terms.
  ReducedLaw(const NodalLaw &law, ColumnLaws columns, bool b_separates);
  /// `times_h`: used where B does not separate. Throws failure, saying what to try, where the
  /// reduced law is not solved. Several answers are possible: `start` leads to one of them.
  ReducedLawAnswer solve(const BodyAtMu &body, const CondensedProduct &times_h,
                         const ReducedLawStart &start = {}) const;

private:
  void set_functions();
  /// Of H: cones D^T H D, joint H Z at the nodes.
  Matrix tested(const Matrix &image) const;
  Matrix operator_at(const BodyAtMu &body, const CondensedProduct &times_h) const;
  Vector diagonal_at(const BodyAtMu &body, const CondensedProduct &times_h) const;
  ReducedLawAnswer solve_cones(const BodyAtMu &body, const CondensedProduct &times_h,
                               const ReducedLawStart &start) const;
  ReducedLawAnswer solve_joint(const BodyAtMu &body, const CondensedProduct &times_h,
                               const ReducedLawStart &start) const;

  const NodalLaw &law_;
  ColumnLaws columns_;
  std::vector<Index> groups_; ///< cones: the first node of each interface with friction
  std::vector<Index> rows_; ///< joint: of H, normal of the nodes, then their tangential ones or -1
  std::vector<Matrix> terms_; ///< of the condensed operator: cones D^T H D, joint H Z at the nodes
  std::vector<Vector> diagonals_; ///< joint: of H at the nodes, n and then tau
  Matrix
      functions_; ///< cones: D, m x (R + (R + 1) an interface with friction + M); joint: Z, m x k
};

/// The functions of `collocated` in coefficients of the nodal dual basis: m x (R + S).
Matrix multiplier_coefficients(const MultiplierBasis &basis);

/// The reduced problem of `collocated`; its rows are those of the collocation nodes.
CollocatedProblem collocated_problem(const MultiplierBasis &basis, const BodyAtMu &body);

/// Largest of |x - P(x - w / H_jj)| over max |x|, P the projection of the law: zero where x solves
/// it. `w` = H x + q, `diagonal`: H_jj; m entries each.
double natural_residual(const Vector &x, const Vector &w, const Vector &diagonal,
                        const NodeLaws &laws);

} // namespace rbvi
