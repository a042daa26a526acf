// Active constraints that give up displacement dofs, their pivots: the contact side of
// solve/eliminated.hpp, on one rank.
#pragma once

#include "rbvi/contact/contact.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include <memory>

namespace rbvi {

/// The displacement dofs that contact sees.
struct ContactDofs {
  std::vector<Index> node; ///< per contact dof: its node, over all interfaces
  /// Per row of B: its node; of a macro-edge the one nearest to its middle.
  std::vector<Index> row_node;
  /// Per contact dof, as a row, the function of the dofs that a pivot there moves. On triangles of
  /// degree 2 the hat of its vertex: the integrals of the vertex's own function against the hats
  /// of multipliers are a matrix without a bounded inverse, those of the hat are a mass matrix.
  /// Else the dof alone.
  SparseMatrix moves;
};
ContactDofs contact_dofs(const Contact &contact);

/// One dof of its node for each row of C, none of them twice. `rows`: of B, that those of C are of.
/// Throws failure where there is none.
std::vector<Index> choose_pivots(const ContactDofs &dofs, const std::vector<Index> &rows,
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

/// C_P, the columns of what the pivots move, and the other columns C_N of some constraints.
class PivotBlock {
public:
  /// Nothing.
  PivotBlock() = default;
  /// `c`: constraints x contact dofs; `pivots`: one of these dofs for each; `moves`: as
  /// ContactDofs. Throws failure where C_P is singular.
  PivotBlock(const SparseMatrix &c, const std::vector<Index> &pivots, const SparseMatrix &moves);
  /// C_P^-1 right.
  Vector solve(const Vector &right) const { return factor_.solve(right); }
  /// C_P^-T right.
  Vector solve_transposed(const Vector &right) const { return factor_.solve_transposed(right); }
  /// -C_P^-1 C_N without its small entries, constraints x contact dofs: it decays with the
  /// distance, as the inverse of a mass matrix does.
  SparseMatrix ties(Index contact_dofs) const;

private:
  std::vector<Index> coupled_; ///< contact dofs of the columns of C_N that are not zero
  SparseMatrix others_;        ///< those columns
  SquareFactor factor_;
};

} // namespace rbvi
