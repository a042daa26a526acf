// Cell loops: matrices and vectors of free dofs from Forms. The pattern is set once; a sweep only
// fills values (PETSc's COO assembly).
#pragma once

#include "rbvi/core/scene.hpp"
#include "rbvi/fem/dofs.hpp"
#include "rbvi/mesh/mesh.hpp"

namespace rbvi {

/// This rank's cells with both copies of their vertices.
struct MappedCells {
  std::vector<Cell> cells; ///< one per owned cell
};

/// Collective. The reference cells, `mapped` equal to `reference`.
MappedCells reference_cells(const Mesh &mesh);

/// Collective. Moves the vertices by h(mu): each vertex is mapped once. Throws failure on every
/// rank if a cell of any rank is inverted.
void map_cells(const Scene &scene, const FullMu &mu, const Mesh &mesh, MappedCells &cells);

/// A square matrix of free dofs whose pattern is fixed by the cells of `region` ("": all).
/// Collective.
Handle<Mat> make_matrix(const Mesh &mesh, const Dofs &dofs, const std::string &region);

/// Fills a matrix made for form.region. Collective.
void assemble_matrix(const Form &form, const FullMu &mu, const Mesh &mesh, const Dofs &dofs,
                     const MappedCells &cells, Mat matrix);

/// Overwrites `vector` by the values of a linear form. Collective.
void assemble_vector(const Form &form, const FullMu &mu, const Mesh &mesh, const Dofs &dofs,
                     const MappedCells &cells, Vec vector);

} // namespace rbvi
