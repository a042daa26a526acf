#include "rbvi/fem/rigid_body_modes.hpp"

namespace rbvi {

double rigid_displacement(int dim, int mode, int component, const Point &x) {
  if (mode < dim) return mode == component ? 1 : 0;
  const int first = (mode - dim) % 3, second = (first + 1) % 3;
  const auto at = [&](int i) { return x[i]; };
  if (component == first) return -at(second);
  return component == second ? at(first) : 0;
}

Handle<MatNullSpace> rigid_body_modes(const Mesh &mesh, const Dofs &dofs) {
  const int count = mesh.dim == 2 ? 3 : 6;
  std::vector<Handle<Vec>> modes;
  std::vector<Vec> vectors;
  for (int mode = 0; mode < count; ++mode) {
    Handle<Vec> v = make_vector(dofs);
    for (std::size_t node = 0; node < mesh.points.size(); ++node)
      for (int c = 0; c < dofs.components; ++c) {
        const PetscInt row = dofs.free[node * static_cast<std::size_t>(dofs.components) +
                                       static_cast<std::size_t>(c)];
        if (row < 0 || !mesh.owned_node[node] ||
            dofs.tied.contains(mesh.natural_node[node] * dofs.components + c))
          continue;
        RBVI_CALL(VecSetValue(
            v.get(), row, rigid_displacement(mesh.dim, mode, c, mesh.points[node]), INSERT_VALUES));
      }
    RBVI_CALL(VecAssemblyBegin(v.get()));
    RBVI_CALL(VecAssemblyEnd(v.get()));
    for (int pass = 0; pass < 2; ++pass)
      for (const Vec before : vectors) {
        PetscScalar part = 0;
        RBVI_CALL(VecDot(v.get(), before, &part));
        RBVI_CALL(VecAXPY(v.get(), -part, before));
      }
    RBVI_CALL(VecNormalize(v.get(), nullptr));
    vectors.push_back(v.get());
    modes.push_back(std::move(v));
  }
  Handle<MatNullSpace> space;
  RBVI_CALL(MatNullSpaceCreate(dofs.comm, PETSC_FALSE, count, vectors.data(), space.put()));
  return space;
}

} // namespace rbvi
