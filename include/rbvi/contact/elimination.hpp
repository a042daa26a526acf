// Active constraints that give up displacement dofs, their pivots: the contact side of
// solve/eliminated.hpp, serial.
#pragma once

#include "rbvi/contact/contact.hpp"
#include "rbvi/law/friction/active_sets.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include <memory>

namespace rbvi {

/// The displacement dofs that contact sees.
struct ContactDofs {
  std::vector<Index> node; ///< per contact dof: its node, over all interfaces
  /// Per row of B: its node; of a macro-edge the one nearest to its middle.
  std::vector<Index> row_node;
};
ContactDofs contact_dofs(const Contact &contact);

/// One dof of its node for each row of C, none of them twice. Throws failure where there is none.
std::vector<Index> choose_pivots(const ContactDofs &dofs, const SetSystem &system,
                                 const SparseMatrix &c);

/// Solves with a sparse square matrix: entry by entry where each row and column has one, as by
/// vertex quadrature, by Cholesky where it is symmetric and positive definite, by LU otherwise.
class SquareFactor {
public:
  /// Throws failure where the matrix is singular.
  void compute(const Eigen::SparseMatrix<double> &matrix);
  Matrix solve(const Matrix &right) const;
  Matrix solve_transposed(const Matrix &right) const;

private:
  bool take_single_entries(const Eigen::SparseMatrix<double> &matrix);

  using Llt = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>;
  using Lu = Eigen::SparseLU<Eigen::SparseMatrix<double>, Eigen::COLAMDOrdering<int>>;
  bool single_ = false; ///< one entry in each row and column, values_ in columns_
  std::vector<Index> columns_;
  Vector values_;
  std::unique_ptr<Llt> symmetric_;
  std::unique_ptr<Lu> lu_;
};

/// u_P = C_P^-1 (c - C_N u_N), and its transpose.
class Elimination {
public:
  /// `c`: constraints x contact dofs; `pivots`: one of these dofs for each row.
  Elimination(const SparseMatrix &c, const std::vector<Index> &pivots);
  /// N: the contact dofs but P that C sees.
  const std::vector<Index> &coupled() const { return coupled_; }
  /// C_P^-1 (right - C_N u_N).
  Vector pivot_values(const Vector &right, const Vector &u_n) const;
  Vector pivot_values(const Vector &right) const { return factor_.solve(right); }
  /// C_P^-T r_P.
  Vector multipliers(const Vector &r_p) const { return factor_.solve_transposed(r_p); }
  /// -C_N^T C_P^-T r_P.
  Vector carried_over(const Vector &r_p) const { return -(others_.transpose() * multipliers(r_p)); }
  /// -C_P^-1 C_N in the rows of P without its small entries, contact dofs x contact dofs: it decays
  /// with the distance, as the inverse of a mass matrix does.
  SparseMatrix ties(Index contact_dofs) const;

private:
  std::vector<Index> pivots_, coupled_;
  SparseMatrix others_; ///< C_N, columns as in coupled_
  SquareFactor factor_;
};

} // namespace rbvi
