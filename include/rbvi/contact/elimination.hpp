// Active constraints that give up displacement dofs, their pivots: the contact side of
// solve/eliminated.hpp, serial.
#pragma once

#include "rbvi/contact/contact.hpp"
#include "rbvi/law/friction/active_sets.hpp"

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

/// u_P = C_P^-1 (c - C_N u_N), and its transpose.
class Elimination {
public:
  Elimination(const SparseMatrix &c, const std::vector<Index> &pivots);
  /// C_P^-1 (right - C_N v); `v`: all contact dofs.
  Vector pivot_values(const Vector &right, const Vector &v) const;
  Vector pivot_values(const Vector &right) const { return lu_->solve(right); }
  /// C_P^-T r_P.
  Vector multipliers(const Vector &r) const;
  /// r_N - C_N^T C_P^-T r_P, zero at P.
  Vector reduced(const Vector &r) const;
  /// -C_P^-1 C_N in the rows of P without its small entries, contact dofs x contact dofs: it decays
  /// with the distance, as the inverse of a mass matrix does.
  SparseMatrix ties() const;

private:
  using Lu = Eigen::SparseLU<Eigen::SparseMatrix<double>, Eigen::COLAMDOrdering<int>>;
  std::vector<Index> pivots_;
  SparseMatrix others_; ///< C_N, all contact dofs wide
  std::unique_ptr<Lu> lu_;
};

} // namespace rbvi
