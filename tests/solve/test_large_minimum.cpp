// The solution of contact that follows the displacement is the minimum (A.1) that a general-purpose
// optimiser finds: TAO's augmented Lagrangian, which knows the energy, the weighted distances and
// their derivatives alone.
#include "rbvi/solve/high_fidelity.hpp"
#include "rbvi/solve/methods.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <petsctao.h>

#include <numeric>

namespace rbvi::large_minimum_test {
namespace {

/// On the contact dofs: the energy u . K u / 2, K the inverse of the compliance, and w(u) >= 0.
struct Minimum {
  const Contact &contact;
  FullMu mu;
  Matrix stiffness{};
  ContactOperators op{};

  static PetscErrorCode energy(Tao, Vec u, PetscReal *value, Vec gradient, void *of) {
    const auto &self = *static_cast<const Minimum *>(of);
    const Vector x = values(u), force = self.stiffness * x;
    *value = 0.5 * x.dot(force);
    set(gradient, force);
    return 0;
  }
  static PetscErrorCode distances(Tao, Vec u, Vec w, void *of) {
    auto &self = *static_cast<Minimum *>(of);
    const Vector x = values(u);
    assemble(self.contact, self.mu, {x}, self.op);
    set(w, self.op.g - self.op.b * x);
    return 0;
  }
  static PetscErrorCode derivatives(Tao, Vec u, Mat jacobian, Mat, void *of) {
    auto &self = *static_cast<Minimum *>(of);
    assemble(self.contact, self.mu, {values(u)}, self.op);
    const Matrix b = -Matrix(self.op.b);
    PetscScalar *entries = nullptr;
    RBVI_CALL(MatDenseGetArray(jacobian, &entries));
    std::copy_n(b.data(), b.size(), entries);
    RBVI_CALL(MatDenseRestoreArray(jacobian, &entries));
    RBVI_CALL(MatAssemblyBegin(jacobian, MAT_FINAL_ASSEMBLY));
    RBVI_CALL(MatAssemblyEnd(jacobian, MAT_FINAL_ASSEMBLY));
    return 0;
  }

  static Vector values(Vec v) {
    const PetscScalar *entries = nullptr;
    PetscInt size = 0;
    RBVI_CALL(VecGetSize(v, &size));
    RBVI_CALL(VecGetArrayRead(v, &entries));
    const Vector result = Eigen::Map<const Vector>(entries, size);
    RBVI_CALL(VecRestoreArrayRead(v, &entries));
    return result;
  }
  static void set(Vec v, const Vector &values) {
    PetscScalar *entries = nullptr;
    RBVI_CALL(VecGetArray(v, &entries));
    Eigen::Map<Vector>(entries, values.size()) = values;
    RBVI_CALL(VecRestoreArray(v, &entries));
  }
};

Handle<Vec> vector_of(Index size) {
  Handle<Vec> v;
  RBVI_CALL(VecCreateSeq(PETSC_COMM_SELF, static_cast<PetscInt>(size), v.put()));
  return v;
}

Matrix compliance_of(Problem &problem, const Operators &op) {
  const Handle<KSP> ksp = make_direct_solver(PETSC_COMM_SELF, "hf_");
  RBVI_CALL(KSPSetOperators(ksp.get(), op.a, op.a));
  std::vector<Index> dofs(problem.trace().size);
  std::iota(dofs.begin(), dofs.end(), 0);
  FactoredBody kept(ksp.get(), problem.trace(), ColumnsLast::for_all_mu);
  kept.set(op.a);
  kept.require(dofs);
  Matrix c(problem.trace().size, problem.trace().size);
  for (const Index dof : dofs)
    c.col(dof) = kept.column(dof);
  return (c + c.transpose()) / 2;
}

TEST(LargeDeformations, AGeneralPurposeOptimiserFindsTheSameMinimum) {
  Scene scene = make_scene("rigid_disk",
                           {{"friction", "none"}, {"kinematics", "large"}, {"arc_edges", "20"}});
  scene.parameters = free_only(scene.parameters, "radius,indentation,offset");
  Problem problem(PETSC_COMM_SELF, scene, {});
  const Mu mu{1, 0.15, 0.1};
  const HfSolution expected = HighFidelity(problem, {}).solve(mu);
  const Operators &op = problem.assemble(mu);
  Minimum minimum{problem.contact(), op.mu};
  minimum.stiffness = compliance_of(problem, op).inverse();

  Tao tao = nullptr;
  Handle<Vec> u = vector_of(problem.trace().size), w = vector_of(expected.lambda.size());
  Handle<Mat> jacobian;
  RBVI_CALL(MatCreateSeqDense(PETSC_COMM_SELF, static_cast<PetscInt>(expected.lambda.size()),
                              static_cast<PetscInt>(problem.trace().size), nullptr,
                              jacobian.put()));
  RBVI_CALL(TaoCreate(PETSC_COMM_SELF, &tao));
  RBVI_CALL(TaoSetType(tao, TAOALMM));
  Minimum::set(u.get(), undeformed(problem.contact(), scene, op.mu)); // nothing has moved
  RBVI_CALL(TaoSetSolution(tao, u.get()));
  RBVI_CALL(TaoSetObjectiveAndGradient(tao, nullptr, Minimum::energy, &minimum));
  RBVI_CALL(TaoSetInequalityConstraintsRoutine(tao, w.get(), Minimum::distances, &minimum));
  RBVI_CALL(TaoSetJacobianInequalityRoutine(tao, jacobian.get(), jacobian.get(),
                                            Minimum::derivatives, &minimum));
  RBVI_CALL(TaoSetTolerances(tao, 1e-7, 1e-7, 0));
  RBVI_CALL(TaoSetConstraintTolerances(tao, 1e-10, 0));
  RBVI_CALL(TaoSetMaximumIterations(tao, 200));
  RBVI_CALL(TaoSetFromOptions(tao));
  RBVI_CALL(TaoSolve(tao));
  TaoConvergedReason reason{};
  RBVI_CALL(TaoGetConvergedReason(tao, &reason));
  EXPECT_GT(reason, 0);
  const Vector found = Minimum::values(u.get()), &wanted = expected.states.back();
  EXPECT_NEAR(0.5 * found.dot(minimum.stiffness * found), *expected.outputs.energy,
              1e-5 * *expected.outputs.energy);
  EXPECT_LT((found - wanted).norm(), 1e-3 * wanted.norm());
  RBVI_CALL(TaoDestroy(&tao));
}

} // namespace
} // namespace rbvi::large_minimum_test
