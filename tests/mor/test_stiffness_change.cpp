// Terms of the stiffness that differ on few functions, against the projection of every term.
#include "tests/catalogue.hpp"
#include "rbvi/model/packed.hpp"
#include "rbvi/mor/affine.hpp"
#include "rbvi/mor/stiffness_change.hpp"
#include "rbvi/par/collective.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace rbvi::stiffness_change_test {
namespace {

/// Hat functions of dofs in the disc, which the map of the membrane only scales, and random fields.
Handle<Mat> basis_of(const Problem &problem, Index hats, Index fields) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const Dofs &dofs = problem.dofs();
  Matrix natural = Matrix::Zero(dofs.total, hats + fields);
  Index next = 0;
  const InterfaceMesh &disc = problem.contact().interfaces.front()->mesh();
  for (std::size_t i = 0; i < disc.points.size() && next < hats; ++i)
    if (std::hypot(disc.points[i][0], disc.points[i][1]) < 0.17)
      natural(problem.places().natural_dofs[disc.dofs[i]], next++) = 1;
  EXPECT_EQ(next, hats);
  for (Index k = 0; k < fields; ++k)
    for (Index i = 0; i < natural.rows(); ++i)
      natural(i, hats + k) = normal(random);
  Handle<Mat> basis;
  const Handle<Vec> like = from_natural(dofs, natural.col(0));
  PetscInt local = 0, stride = 0;
  RBVI_CALL(VecGetLocalSize(like.get(), &local));
  RBVI_CALL(MatCreateDense(problem.comm(), local, PETSC_DECIDE, PETSC_DETERMINE,
                           static_cast<PetscInt>(natural.cols()), nullptr, basis.put()));
  RBVI_CALL(MatDenseGetLDA(basis.get(), &stride));
  for (Index k = 0; k < natural.cols(); ++k) {
    const Handle<Vec> column = from_natural(dofs, natural.col(k));
    const double *from = nullptr;
    double *values = nullptr;
    RBVI_CALL(VecGetArrayRead(column.get(), &from));
    RBVI_CALL(MatDenseGetArray(basis.get(), &values));
    std::copy_n(from, local, values + k * stride);
    RBVI_CALL(MatDenseRestoreArray(basis.get(), &values));
    RBVI_CALL(VecRestoreArrayRead(column.get(), &from));
  }
  RBVI_CALL(MatAssemblyBegin(basis.get(), MAT_FINAL_ASSEMBLY));
  RBVI_CALL(MatAssemblyEnd(basis.get(), MAT_FINAL_ASSEMBLY));
  return basis;
}

/// V^T A V, on every rank.
Matrix projection(Mat basis, Mat a) {
  Handle<Mat> image;
  RBVI_CALL(MatMatMult(a, basis, MAT_INITIAL_MATRIX, PETSC_DEFAULT, image.put()));
  PetscInt n = 0, local = 0, stride = 0, of_image = 0;
  RBVI_CALL(MatGetSize(basis, nullptr, &n));
  RBVI_CALL(MatGetLocalSize(basis, &local, nullptr));
  RBVI_CALL(MatDenseGetLDA(basis, &stride));
  RBVI_CALL(MatDenseGetLDA(image.get(), &of_image));
  const double *v = nullptr, *av = nullptr;
  RBVI_CALL(MatDenseGetArrayRead(basis, &v));
  RBVI_CALL(MatDenseGetArrayRead(image.get(), &av));
  using Rows = Eigen::Map<const Matrix, 0, Eigen::OuterStride<>>;
  Matrix result = Rows(v, local, n, Eigen::OuterStride<>(stride)).transpose() *
                  Rows(av, local, n, Eigen::OuterStride<>(of_image));
  RBVI_CALL(MatDenseRestoreArrayRead(image.get(), &av));
  RBVI_CALL(MatDenseRestoreArrayRead(basis, &v));
  over_ranks(PetscObjectComm(reinterpret_cast<PetscObject>(a)), MPI_SUM, result);
  return result;
}

struct Trained {
  Problem problem{PETSC_COMM_WORLD, make_scene("membrane_obstacle", {}), {}};
  std::vector<Mu> training{{0.2, 0, 0}, {0.16, 0.05, -0.05}, {0.24, -0.03, 0.05}, {0.18, 0, 0.02}};
  Eim a = separate(problem, training, {.tolerance = 0}).a;
  std::vector<Mu> set{};
  Trained() {
    for (const int p : a.snapshots)
      set.push_back(training[p]);
  }
};

} // namespace

TEST(StiffnessChange, IsTheProjectionOfEveryTerm) {
  Trained trained;
  Problem &problem = trained.problem;
  const Index n = 300, fields = 12;
  const Handle<Mat> basis = basis_of(problem, n - fields, fields);
  const StiffnessChange change = stiffness_change(problem, trained.a, trained.set, basis.get());
  EXPECT_EQ(change.rank(), fields);
  std::vector<Matrix> snapshots;
  for (const Mu &mu : trained.set) {
    problem.assemble(mu);
    snapshots.push_back(projection(basis.get(), problem.a_terms().mapped.get()));
  }
  ASSERT_GE(trained.a.size(), 3);
  for (Index q = 0; q < trained.a.size(); ++q) {
    Matrix term = Matrix::Zero(n, n);
    for (Index i = 0; i <= q; ++i)
      term += trained.a.combination(i, q) * snapshots[i];
    const Matrix core = unpacked(change.cores.col(q), change.rank());
    const Matrix made =
        change.scales[q] * snapshots.front() + change.range * core * change.range.transpose();
    EXPECT_LE((made - term).norm(), 1e-9 * snapshots.front().norm()) << "term " << q;
  }
}

TEST(StiffnessChange, IsLeftOutWhereItSavesNothing) {
  Trained trained;
  const Handle<Mat> few = basis_of(trained.problem, 40, 12),
                    all = basis_of(trained.problem, 100, 200);
  EXPECT_EQ(stiffness_change(trained.problem, trained.a, trained.set, few.get()).rank(), 0);
  EXPECT_EQ(stiffness_change(trained.problem, trained.a, trained.set, all.get()).rank(), 0);
}

} // namespace rbvi::stiffness_change_test
