#include "balancing_functions.hpp"

#include "rbvi/par/columns.hpp"
#include "rbvi/solve/vectors.hpp"

namespace rbvi {

namespace {

/// The number of columns that are not in the basis yet, which join it. Collective.
std::size_t joined(Problem &problem, const std::vector<Handle<Vec>> &functions,
                   LinearBasis &basis) {
  constexpr double outside = 1e-8;
  Matrix columns(std::ssize(problem.dofs().natural_owned), std::ssize(functions));
  for (Index k = 0; k < columns.cols(); ++k)
    columns.col(k) = local_values(functions[k].get());
  return append_orthonormalised(basis, dense_like(problem.v_product(), columns).get(), outside)
      .size();
}

/// Of one body along a direction. Collective.
Handle<Vec> translation(const Problem &problem, int body, const Point &direction) {
  const Mesh &mesh = problem.mesh();
  const Dofs &dofs = problem.dofs();
  Handle<Vec> result = make_vector(dofs);
  for (std::size_t cell = 0; cell < mesh.body.size(); ++cell) {
    const auto nodes = nodes_of(mesh, cell);
    for (int i = 0; i < nodes_per_cell(mesh.dim, mesh.degree) && mesh.body[cell] == body; ++i)
      for (int c = 0; c < dofs.components; ++c)
        if (const PetscInt row =
                dofs.free[nodes[static_cast<std::size_t>(i)] * dofs.components + c];
            row >= 0)
          RBVI_CALL(VecSetValue(result.get(), row, direction[static_cast<std::size_t>(c)],
                                INSERT_VALUES));
  }
  RBVI_CALL(VecAssemblyBegin(result.get()));
  RBVI_CALL(VecAssemblyEnd(result.get()));
  return result;
}

} // namespace

void add_balancing_functions(Problem &problem, const std::vector<Sample> &samples,
                             LinearBasis &basis) {
  constexpr int enough = 3; // samples in a row that add none
  const Scene &scene = problem.scene();
  int without = 0;
  for (std::size_t p = 0; !problem.free_bodies().empty() && p < samples.size() && without < enough;
       ++p) {
    const auto motions =
        rigid_motions(problem.free_bodies(), scene, expand(scene.parameters, samples[p].mu),
                      problem.mesh(), problem.dofs());
    without = joined(problem, motions, basis) > 0 ? 0 : without + 1;
  }
  std::vector<Handle<Vec>> translations;
  for (const OutputForm &output : scene.outputs)
    for (int body = 0; output.kind == OutputForm::Kind::reaction && body < problem.mesh().bodies;
         ++body)
      translations.push_back(translation(problem, body, output.vector));
  if (!translations.empty()) joined(problem, translations, basis);
}

} // namespace rbvi
