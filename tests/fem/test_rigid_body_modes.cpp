// Displacements of rigid bodies: orthonormal, and without strain.
#include "../cube_mesh.hpp"
#include "../mesh/temporary_file.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/fem/assembly.hpp"
#include "rbvi/fem/rigid_body_modes.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

namespace rbvi::rigid_body_modes_test {
namespace {

/// Of a body that nothing holds.
void expect_rigid(const Mesh &mesh) {
  const Dofs dofs = number_dofs(mesh, mesh.dim, {});
  const Handle<Mat> a = make_matrix(mesh, dofs);
  const Sum energy{exact_term(elasticity("", lame(1, 0.3), mesh.degree))};
  assemble(forms_of(energy), {}, mesh, dofs, {}, a.get());
  PetscReal size = 0;
  RBVI_CALL(MatNorm(a.get(), NORM_INFINITY, &size));

  const Handle<MatNullSpace> space = rigid_body_modes(mesh, dofs);
  PetscBool constant = PETSC_TRUE;
  PetscInt count = 0;
  const Vec *modes = nullptr;
  RBVI_CALL(MatNullSpaceGetVecs(space.get(), &constant, &count, &modes));
  EXPECT_FALSE(constant);
  ASSERT_EQ(count, mesh.dim == 2 ? 3 : 6);
  for (PetscInt k = 0; k < count; ++k) {
    for (PetscInt j = 0; j <= k; ++j) {
      PetscScalar product = 0;
      RBVI_CALL(VecDot(modes[k], modes[j], &product));
      EXPECT_NEAR(product, j == k ? 1 : 0, 1e-13) << "modes " << k << " and " << j;
    }
    const Handle<Vec> forces = make_vector(dofs);
    PetscReal force = 0;
    RBVI_CALL(MatMult(a.get(), modes[k], forces.get()));
    RBVI_CALL(VecNorm(forces.get(), NORM_2, &force));
    EXPECT_LE(force, 1e-13 * size) << "mode " << k;
  }
}

TEST(RigidBodyModes, HaveNoStrainInThePlane) {
  for (const std::string degree : {"1", "2"})
    expect_rigid(make_mesh(PETSC_COMM_WORLD, make_scene("patch", {{"degree", degree}}), {}));
}

TEST(RigidBodyModes, HaveNoStrainInSpace) {
  Scene scene = make_scene("membrane_obstacle");
  scene.dim = 3;
  scene.mesh = {"", {"core"}, {"boundary"}};
  scene.curves = {};
  scene.contacts = {};
  scene.a = scene.f = {};
  const TemporaryFile file(cube_mesh(6, 0.1));
  expect_rigid(make_mesh(PETSC_COMM_WORLD, scene, {file.name(), 0}));
}

} // namespace
} // namespace rbvi::rigid_body_modes_test
