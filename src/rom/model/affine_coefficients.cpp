#include "rbvi/rom/model/affine_coefficients.hpp"

#include "rbvi/contact/entity_sum.hpp"
#include "rbvi/element/geometry.hpp"
#include "rbvi/element/lagrange.hpp"

namespace rbvi {

namespace {

/// A sampled cell or edge, mapped.
Cell sample_cell(const SampleMesh &sample, const Scene &scene, const FullMu &mu, Index number) {
  Cell cell{sample.corners - 1, {}, {}};
  for (int i = 0; i < sample.corners; ++i) {
    const auto at = static_cast<std::size_t>(i);
    cell.reference[at] = point_of(sample.vertices, number * sample.corners + i);
    cell.mapped[at] = scene.map(mu, cell.reference[at]);
  }
  if (cell.dim == scene.dim) check_orientation(scene, mu, cell);
  return cell;
}

} // namespace

Vector affine_coefficients(const AffineTerms &terms, const Form &form, const Scene &scene,
                           const FullMu &all_parameters) {
  Vector theta = Vector::Zero(terms.size());
  if (terms.size() == 0) return theta;
  const SampleMesh &sample = terms.samples.front();
  const Index cells = sample.vertices.rows() / sample.corners;
  const Index dofs = Index{nodes_per_cell(scene.dim, scene.degree)} * scene.components;
  Matrix values(dofs * dofs, cells); // a linear form fills the first rows only
  for (Index number = 0; number < cells; ++number)
    form.kernel(all_parameters, sample_cell(sample, scene, all_parameters, number),
                values.col(number).data());
  for (const SampleMesh::Contribution &c : sample.contributions)
    theta[c.entry] += values(c.local, c.cell);
  terms.interpolation.triangularView<Eigen::UnitLower>().solveInPlace(theta);
  return theta;
}

Vector contact_coefficients(const AffineTerms &terms, Part part, const Contact &contact,
                            const Scene &scene, const FullMu &all_parameters) {
  Vector theta = Vector::Zero(terms.size());
  for (std::size_t i = 0; i < terms.samples.size(); ++i) {
    const EntitySum &interface = *contact.interfaces[i]->entity_sum();
    const SampleMesh &sample = terms.samples[i];
    const auto entities = static_cast<std::size_t>(sample.vertices.rows() / sample.corners);
    std::vector<EntityValues> values(entities, interface.shape());
    for (std::size_t e = 0; e < entities; ++e)
      interface.integrate(all_parameters,
                          sample_cell(sample, scene, all_parameters, static_cast<Index>(e)),
                          values[e]);
    for (const SampleMesh::Contribution &c : sample.contributions) {
      const EntityValues &of = values[static_cast<std::size_t>(c.cell)];
      theta[c.entry] += part == Part::b ? of.b.data()[c.local] : of.g[c.local];
    }
  }
  terms.interpolation.triangularView<Eigen::UnitLower>().solveInPlace(theta);
  return theta;
}

} // namespace rbvi
