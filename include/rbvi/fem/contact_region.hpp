// The contact region, whole on every rank: its vertices carry the multipliers, its cells the forms
// b and g. Small beside the domain, so its operators are assembled without communication and are
// bitwise the same for any number of ranks.
#pragma once

#include "rbvi/fem/dofs.hpp"
#include "rbvi/fem/trace.hpp"

namespace rbvi {

struct ContactRegion {
  int dim = 2, components = 1;
  std::vector<PetscInt> natural_node;    ///< per dual dof, increasing
  std::vector<Point> points;             ///< per dual dof, reference coordinates
  std::vector<std::array<int, 4>> cells; ///< dual dofs of each cell, in natural order of cells
  std::vector<int> contact_dof;          ///< per dual dof * components + c: 0 .. n_c - 1, or -1
  Trace trace;                           ///< contact dof -> displacement dof
  Index dual_size() const { return static_cast<Index>(points.size()); }
};

/// Collective.
ContactRegion make_contact_region(const Mesh &mesh, const Dofs &dofs, const std::string &region);

/// Not collective. The dual dofs of all cells one after the other, dim + 1 of each.
std::vector<int> flat_cells(const ContactRegion &region);

/// Not collective. The region's cells, `mapped` filled by h(mu).
std::vector<Cell> mapped_contact_cells(const ContactRegion &region, const Scene &scene,
                                       const FullMu &mu);

/// Assembles dual x contact-dof matrices (or dual x dual ones) with one pattern. Not collective.
class ContactMatrix {
public:
  /// `columns`: contact dofs, or dual dofs (for products of W).
  enum class Columns { contact_dofs, dual_dofs };
  ContactMatrix(const ContactRegion &region, Columns columns);
  const SparseMatrix &assemble(const Form &form, const FullMu &mu, const std::vector<Cell> &cells);

private:
  SparseMatrix matrix_;
  std::vector<Index> position_; ///< per kernel value: where it is added, -1 nowhere
  std::size_t per_cell_;
};

/// Dual vector of a linear form. Not collective.
Vector contact_vector(const ContactRegion &region, const Form &form, const FullMu &mu,
                      const std::vector<Cell> &cells);

} // namespace rbvi
