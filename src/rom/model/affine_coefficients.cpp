#include "rbvi/rom/model/affine_coefficients.hpp"

#include "rbvi/element/geometry.hpp"
#include "rbvi/element/lagrange.hpp"

namespace rbvi {

namespace {

Cell sample_cell(const SampleMesh &sample, int dim, int number) {
  Cell cell{dim, {}, {}};
  for (int i = 0; i <= dim; ++i)
    for (int k = 0; k < dim; ++k)
      cell.reference[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] =
          sample.vertices(number * (dim + 1) + i, k);
  return cell;
}

} // namespace

Vector affine_coefficients(const AffineTerms &terms, const Form &form, const Scene &scene,
                           const FullMu &all_parameters) {
  Vector theta = Vector::Zero(terms.size());
  if (terms.size() == 0) return theta;
  const int dim = static_cast<int>(terms.sample.vertices.cols());
  const Index cells = terms.sample.vertices.rows() / (dim + 1);
  const Index dofs = Index{nodes_per_cell(dim, scene.degree)} * scene.components;
  Matrix values(dofs * dofs, cells); // a linear form fills the first rows only
  for (int number = 0; number < cells; ++number) {
    Cell cell = sample_cell(terms.sample, dim, number);
    map_cell(scene, all_parameters, cell);
    form.kernel(all_parameters, cell, values.col(number).data());
  }
  for (const SampleMesh::Contribution &c : terms.sample.contributions)
    theta[c.entry] += values(c.local, c.cell);
  terms.interpolation.triangularView<Eigen::UnitLower>().solveInPlace(theta);
  return theta;
}

} // namespace rbvi
