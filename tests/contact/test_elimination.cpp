// Displacement dofs that constraints give up, against dense linear algebra.
#include "rbvi/contact/elimination.hpp"
#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

namespace rbvi {
namespace {

constexpr Index dofs = 12;

/// Row i of C is a hat over dofs i, ..., i + 2; `skew` takes the symmetry of its middle.
SparseMatrix constraints(Index rows, double skew) {
  SparseMatrix c(rows, dofs);
  for (Index i = 0; i < rows; ++i) {
    c.insert(i, i) = 1 + skew;
    c.insert(i, i + 1) = 4;
    c.insert(i, i + 2) = 1;
  }
  return c;
}

std::vector<Index> range(Index first, Index count) {
  std::vector<Index> list;
  for (Index i = 0; i < count; ++i)
    list.push_back(first + i);
  return list;
}

/// Meets the constraints whatever the coupled dofs are, and so does its transpose.
void expect_eliminates(const Elimination &elimination, const SparseMatrix &c,
                       const std::vector<Index> &pivots) {
  Vector u = Vector::LinSpaced(dofs, -1, 2);
  const Vector right = Vector::LinSpaced(c.rows(), 3, -4);
  u(pivots) = elimination.pivot_values(right, u(elimination.coupled()));
  EXPECT_LE((c * u - right).norm(), 1e-14 * right.norm());

  const Matrix c_p = Matrix(c)(Eigen::all, pivots);
  const Vector r = Vector::LinSpaced(c.rows(), 1, 2);
  const Vector y = elimination.multipliers(r);
  EXPECT_LE((c_p.transpose() * y - r).norm(), 1e-14 * r.norm());
  const Vector carried = -Matrix(c)(Eigen::all, elimination.coupled()).transpose() * y;
  EXPECT_LE((elimination.carried_over(r) - carried).norm(), 1e-14 * carried.norm());
}

class EliminationOf : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(SymmetricAndNot, EliminationOf, testing::Values(0.0, 0.3));

TEST_P(EliminationOf, MeetsTheConstraintsAndItsTranspose) {
  const SparseMatrix c = constraints(6, GetParam());
  const std::vector<Index> pivots = range(1, 6);
  const Elimination elimination(c, pivots);
  ASSERT_EQ(elimination.coupled(), (std::vector<Index>{0, 7}));
  expect_eliminates(elimination, c, pivots);

  const Matrix c_p = Matrix(c)(Eigen::all, pivots);
  const Matrix ties = elimination.ties(dofs);
  const Matrix expected = -c_p.lu().solve(Matrix(c)(Eigen::all, elimination.coupled()));
  const Matrix found = ties(pivots, elimination.coupled());
  EXPECT_LE((found - expected).cwiseAbs().maxCoeff(), 1e-3) << "small entries are left out";
  EXPECT_NEAR(found(0, 0), expected(0, 0), 1e-14);
  EXPECT_EQ(ties.norm(), found.norm()) << "nothing elsewhere";
}

/// As by vertex quadrature; the rows in another order than the dofs.
TEST(Elimination, OfConstraintsThatSeeOnePivotEach) {
  SparseMatrix c(3, dofs);
  c.insert(0, 5) = 2;
  c.insert(0, 9) = 1;
  c.insert(1, 3) = -4;
  c.insert(1, 5) = 0; // of the pattern alone
  c.insert(2, 7) = 0.5;
  c.insert(2, 9) = 3;
  const std::vector<Index> pivots{3, 5, 7};
  const Elimination elimination(c, pivots);
  ASSERT_EQ(elimination.coupled(), std::vector<Index>{9});
  expect_eliminates(elimination, c, pivots);
}

TEST(Elimination, OfNoConstraint) {
  const Elimination none(SparseMatrix(0, dofs), {});
  EXPECT_TRUE(none.coupled().empty());
}

TEST(Elimination, RefusesConstraintsThatDependOnEachOther) {
  SparseMatrix c(2, dofs);
  for (const Index row : {0, 1}) {
    c.insert(row, 3) = 1;
    c.insert(row, 4) = 2;
  }
  const std::vector<Index> pivots{3, 4};
  EXPECT_THROW(Elimination(c, pivots), Error);
}

} // namespace
} // namespace rbvi
