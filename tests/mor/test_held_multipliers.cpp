// Multipliers that hold a part of the contact region, against what the body does under them.
#include "../linear_algebra.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/mor/bases/held_multipliers.hpp"
#include "rbvi/solve/linear/linear.hpp"
#include "rbvi/solve/linear/vectors.hpp"
#include "rbvi/solve/methods.hpp"

#include <gtest/gtest.h>

#include <random>

namespace rbvi {
namespace {

/// B A^-1 B^T l.
Matrix displacements(Problem &problem, const Operators &op, const Matrix &multipliers) {
  const Handle<KSP> ksp = make_direct_solver(problem.comm(), "hf_");
  RBVI_CALL(KSPSetOperators(ksp.get(), op.a, op.a));
  Matrix result(multipliers.rows(), multipliers.cols());
  for (Index k = 0; k < multipliers.cols(); ++k) {
    const Handle<Vec> load = like(op.f), u = like(op.f);
    RBVI_CALL(VecZeroEntries(load.get()));
    add_extension(problem.trace(), op.b.transpose() * multipliers.col(k), load.get());
    solve_linear(ksp.get(), load.get(), u.get());
    result.col(k) = op.b * restrict_to(problem.trace(), u.get());
  }
  return result;
}

/// Nodes at the edge of the region, too: their neighbours are no contact dofs.
std::vector<Index> two_of_three(Index nodes) {
  std::vector<Index> held;
  for (Index i = 0; i < nodes; ++i)
    if (i % 3 != 0) held.push_back(i);
  return held;
}

/// The same on every rank.
Matrix on_the_others(Index size, const std::vector<Index> &held, Index columns) {
  std::mt19937 generator(1);
  Matrix others(size, columns);
  for (double &value : others.reshaped())
    value = static_cast<double>(generator()) / std::mt19937::max();
  others(held, Eigen::all).setZero();
  return others;
}

TEST(HeldMultipliers, KeepTheHeldNodesWhereTheyAre) {
  for (const std::string lumped : {"yes", "no"}) {
    SCOPED_TRACE("lumped " + lumped);
    Problem problem(PETSC_COMM_WORLD, make_scene("membrane_obstacle", {{"lumped", lumped}}), {});
    const Operators &op = problem.assemble({0.2, 0.03, -0.02});
    const std::vector<Index> held = two_of_three(problem.dual_size());
    EXPECT_EQ(holds_dofs(op.b, held), lumped == "yes");
    Matrix all = on_the_others(problem.dual_size(), held, 3);
    all(held, Eigen::all) = holding(problem, op)(held, all);
    EXPECT_GT(all(held, Eigen::all).norm(), 0.1 * all.norm());
    const Matrix u = displacements(problem, op, all);
    EXPECT_LE(u(held, Eigen::all).norm(), 1e-11 * u.norm());
  }
}

TEST(HeldMultipliers, ReactionsAreWhatColumnsGive) {
  Problem problem(PETSC_COMM_WORLD, make_scene("membrane_obstacle", {}), {});
  const Operators &op = problem.assemble({0.2, 0.03, -0.02});
  const std::vector<Index> held = two_of_three(problem.dual_size());
  const auto k = std::ssize(held); // as many: by columns
  const Matrix others = on_the_others(problem.dual_size(), held, k);
  const Matrix expected = holding(problem, op)(held, others);
  EXPECT_LE((hold_by_reactions(problem, op, held, others) - expected).norm(),
            1e-11 * expected.norm());
}

TEST(HeldMultipliers, DofsAreHeldWhereEachHasARowOfItsOwn) {
  Matrix b(4, 4);
  b << 2, 0, 0, 0, //
      0, 3, 1, 0,  //
      0, 0, 5, 0,  //
      0, 0, 4, 0;
  const SparseMatrix sparse = b.sparseView();
  EXPECT_TRUE(holds_dofs(sparse, {0, 2}));
  EXPECT_TRUE(holds_dofs(sparse, {}));
  EXPECT_FALSE(holds_dofs(sparse, {0, 1})) << "two dofs in a row";
  EXPECT_FALSE(holds_dofs(sparse, {2, 3})) << "two rows of one dof";
}

} // namespace
} // namespace rbvi
