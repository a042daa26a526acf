// Multipliers that hold a part of the contact region, against what the body does under them.
#include "../method/random_matrix.hpp"
#include "tests/catalogue.hpp"
#include "rbvi/mor/held_multipliers.hpp"
#include "rbvi/solve/response_solver.hpp"

#include <gtest/gtest.h>

namespace rbvi::held_multipliers_test {
namespace {

/// Nodes at the edge of the region, too: their neighbours are no contact dofs.
std::vector<Index> two_of_three(Index nodes) {
  std::vector<Index> held;
  for (Index i = 0; i < nodes; ++i)
    if (i % 3 != 0) held.push_back(i);
  return held;
}

/// The same on every rank.
Matrix on_the_others(Index size, const std::vector<Index> &held, Index columns) {
  Matrix others = Random(1).matrix(size, columns).cwiseAbs();
  others(held, Eigen::all).setZero();
  return others;
}

TEST(HeldMultipliers, KeepTheHeldNodesWhereTheyAre) {
  for (const std::string lumped : {"yes", "no"}) {
    SCOPED_TRACE("lumped " + lumped);
    Problem problem(PETSC_COMM_WORLD, make_scene("membrane_obstacle", {{"lumped", lumped}}), {});
    const Operators &op = problem.assemble({0.2, 0.03, -0.02});
    const std::vector<Index> held = two_of_three(problem.dual_size());
    EXPECT_EQ(held_dofs(op.b, held).has_value(), lumped == "yes");
    Matrix all = on_the_others(problem.dual_size(), held, 3);
    all(held, Eigen::all) = holding(problem, op)(held, all);
    EXPECT_GT(all(held, Eigen::all).norm(), 0.1 * all.norm());
    ResponseSolver body(op.a, problem.trace(), "hf_");
    const Matrix u = op.b * body.responses(op.b.transpose() * all);
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
  const Matrix reactions = hold_by_reactions(problem, op, *held_dofs(op.b, held), others);
  EXPECT_LE((reactions - expected).norm(), 1e-11 * expected.norm());
}

TEST(HeldMultipliers, DofsAreHeldWhereEachHasARowOfItsOwn) {
  Matrix b(4, 4);
  b << 2, 0, 0, 0, //
      0, 3, 1, 0,  //
      0, 0, 5, 0,  //
      0, 0, 4, 0;
  const SparseMatrix sparse = b.sparseView();
  const std::optional<HeldDofs> held = held_dofs(sparse, {2, 0});
  ASSERT_TRUE(held.has_value());
  EXPECT_EQ(held->dofs, (std::vector<Index>{2, 0}));
  EXPECT_EQ(held->entries, Vector({{5, 2}}));
  EXPECT_TRUE(held_dofs(sparse, {}).has_value());
  EXPECT_FALSE(held_dofs(sparse, {0, 1}).has_value()) << "two dofs in a row";
  EXPECT_FALSE(held_dofs(sparse, {2, 3}).has_value()) << "two rows of one dof";
  EXPECT_FALSE(held_dofs(SparseMatrix(4, 4), {0}).has_value()) << "no dof";
}

} // namespace
} // namespace rbvi::held_multipliers_test
