// Loops over cells and facets: matrices and vectors of free dofs from Forms. The pattern is set
// once; a sweep only fills values (PETSc's COO assembly).
#pragma once

#include "rbvi/core/scene.hpp"
#include "rbvi/fem/dofs.hpp"
#include "rbvi/mesh/mesh.hpp"

#include <cmath>

namespace rbvi {

/// Where h(mu) takes this rank's vertices, in the order of Mesh::points; empty: they stay.
using MappedVertices = std::vector<Point>;

/// Each vertex is mapped once. Throws failure on every rank if a cell of any rank is inverted.
/// Collective.
MappedVertices map_vertices(const Scene &scene, const FullMu &mu, const Mesh &mesh);

/// An owned cell with both copies of its vertices.
Cell cell_of(const Mesh &mesh, std::size_t cell, const MappedVertices &mapped = {});

/// Cell::imposed_by of an owned cell, or of the nodes of one of its facets; `local`: which of the
/// cell's dofs, node * components + component. Empty where no value is imposed on any of them.
std::vector<int> imposed_on(const Mesh &mesh, const Dofs &dofs, std::size_t cell,
                            const std::vector<int> &local);

/// Cells of this rank that a form without means is over, with the facet -1, or the facets.
std::vector<CellFacet> places_of(const Mesh &mesh, const Form &form);

/// A multiple of a form.
struct WeightedForm {
  const Form *form;
  double weight = 1;
  bool of_imposed = false; ///< Term::of_imposed
};

/// A load on the function that is 1 everywhere, without that of imposed values: what the cells of
/// this rank give. Of a displacement with several components it makes no sense.
struct LoadSums {
  double all = 0, held = 0; ///< of all nodal functions, of those of held dofs
  double sizes = 0;         ///< of all terms
};
inline LoadSums operator+(const LoadSums &one, const LoadSums &other) {
  return {one.all + other.all, one.held + other.held, one.sizes + other.sizes};
}
inline LoadSums operator*(double factor, const LoadSums &sums) {
  return {factor * sums.all, factor * sums.held, std::abs(factor) * sums.sizes};
}

/// All terms of a sum with the weight 1, whatever their coefficients. `sum` must outlive them.
std::vector<WeightedForm> forms_of(const Sum &sum);

/// A square matrix of free dofs whose pattern is that of all cells and couplings. Collective.
Handle<Mat> make_matrix(const Mesh &mesh, const Dofs &dofs);

/// Overwrites the values of a matrix by the sum of bilinear forms. Collective.
void assemble(const std::vector<WeightedForm> &forms, const FullMu &mu, const Mesh &mesh,
              const Dofs &dofs, const MappedVertices &mapped, Mat matrix);

/// Overwrites a vector by the sum of linear forms. Collective.
LoadSums assemble(const std::vector<WeightedForm> &forms, const FullMu &mu, const Mesh &mesh,
                  const Dofs &dofs, const MappedVertices &mapped, Vec vector);

/// The sum over all cells of forms that fill a single number each (imposed_energy). Collective.
double integral(const std::vector<WeightedForm> &forms, const FullMu &mu, const Mesh &mesh,
                const Dofs &dofs, const MappedVertices &mapped);

/// The share of this rank's cells in the sum of bilinear forms times a field; both by local node *
/// components, fixed dofs included. Not collective.
Vector product_with(const std::vector<WeightedForm> &forms, const FullMu &mu, const Mesh &mesh,
                    const Dofs &dofs, const MappedVertices &mapped, const Vector &field);

} // namespace rbvi
