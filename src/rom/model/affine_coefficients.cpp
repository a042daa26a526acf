#include "rbvi/rom/model/affine_coefficients.hpp"

#include "rbvi/element/geometry.hpp"
#include "rbvi/element/lagrange.hpp"

#include <algorithm>

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

/// theta of empirical interpolation; `form_of(cell)`: the form of a sampled cell.
template <class FormOf>
Vector interpolation_coefficients(const AffineTerms &terms, const FormOf &form_of,
                                  const Scene &scene, const FullMu &all_parameters) {
  Vector theta = Vector::Zero(terms.interpolation.rows());
  if (theta.size() == 0) return theta;
  const int dim = static_cast<int>(terms.sample.vertices.cols());
  const Index cells = terms.sample.vertices.rows() / (dim + 1);
  const Index dofs = Index{nodes_per_cell(dim, scene.degree)} * scene.components;
  Matrix values(dofs * dofs, cells); // a linear form, or one on a facet, fills the first rows only
  for (int number = 0; number < cells; ++number) {
    Cell cell = sample_cell(terms.sample, dim, number);
    map_cell(scene, all_parameters, cell);
    form_of(number).kernel(all_parameters, cell, values.col(number).data());
  }
  for (const SampleMesh::Contribution &c : terms.sample.contributions)
    theta[c.entry] += values(c.local, c.cell);
  terms.interpolation.triangularView<Eigen::UnitLower>().solveInPlace(theta);
  return theta;
}

} // namespace

Vector affine_coefficients(const AffineTerms &terms, const Form &form, const Scene &scene,
                           const FullMu &all_parameters) {
  return interpolation_coefficients(
      terms, [&](int) -> const Form & { return form; }, scene, all_parameters);
}

Vector affine_coefficients(const AffineTerms &terms, const Sum &sum, const Scene &scene,
                           const FullMu &all_parameters) {
  const std::vector<double> exact =
      exact_coefficients(sum, split_sum(sum, scene.parameters), scene.parameters, all_parameters);
  const auto form_of = [&](int cell) -> const Form & {
    const int term = terms.sample.terms[static_cast<std::size_t>(cell)];
    return sum[static_cast<std::size_t>(term)].form;
  };
  Vector theta(terms.size());
  theta << Eigen::Map<const Vector>(exact.data(), std::ssize(exact)),
      interpolation_coefficients(terms, form_of, scene, all_parameters);
  return theta;
}

void check_terms_of(const AffineTerms &terms, const Sum &sum, const ParameterSpace &space,
                    const std::string &name) {
  const SplitSum split = split_sum(sum, space);
  const bool sampled =
      std::all_of(terms.sample.terms.begin(), terms.sample.terms.end(), [&](int term) {
        return std::find(split.mapped.begin(), split.mapped.end(), term) != split.mapped.end();
      });
  const int dim = static_cast<int>(terms.sample.vertices.cols());
  if (terms.exact != std::ssize(split.exact) || !sampled ||
      std::ssize(terms.sample.terms) * (dim + 1) != terms.sample.vertices.rows())
    throw bad_input("the terms of " + name +
                    " of the model are not those of its scene in this "
                    "build");
}

} // namespace rbvi
