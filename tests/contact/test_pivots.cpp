// Displacement dofs that constraints give up, against dense linear algebra.
#include "rbvi/contact/pivots.hpp"
#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

namespace rbvi::pivots_test {
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

/// A pivot moves its dof alone.
SparseMatrix alone(const SparseMatrix &c) {
  SparseMatrix moves(c.cols(), c.cols());
  moves.setIdentity();
  return moves;
}

std::vector<Index> range(Index first, Index count) {
  std::vector<Index> list;
  for (Index i = 0; i < count; ++i)
    list.push_back(first + i);
  return list;
}

void expect_solves(const PivotBlock &block, const SparseMatrix &c,
                   const std::vector<Index> &pivots) {
  const Matrix c_p = Matrix(c)(Eigen::all, pivots);
  const Vector right = Vector::LinSpaced(c.rows(), 3, -4);
  EXPECT_LE((c_p * block.solve(right) - right).norm(), 1e-14 * right.norm());
  const Vector y = block.solve_transposed(right);
  EXPECT_LE((c_p.transpose() * y - right).norm(), 1e-14 * right.norm());
}

/// Of the coupled dofs, in the rows of the constraints.
void expect_ties(const PivotBlock &block, const SparseMatrix &c, const std::vector<Index> &pivots,
                 const std::vector<Index> &coupled) {
  const Matrix c_p = Matrix(c)(Eigen::all, pivots), ties = block.ties(dofs);
  const Matrix expected = -c_p.lu().solve(Matrix(c)(Eigen::all, coupled));
  const Matrix found = ties(Eigen::all, coupled);
  EXPECT_LE((found - expected).cwiseAbs().maxCoeff(), 1e-3) << "small entries are left out";
  EXPECT_NEAR(found(0, 0), expected(0, 0), 1e-14 * std::abs(expected(0, 0)));
  EXPECT_NEAR(ties.norm(), found.norm(), 1e-14 * found.norm()) << "nothing elsewhere";
}

class PivotBlockOf : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(SymmetricAndNot, PivotBlockOf, testing::Values(0.0, 0.3));

TEST_P(PivotBlockOf, SolvesAndTies) {
  const SparseMatrix c = constraints(6, GetParam());
  const std::vector<Index> pivots = range(1, 6);
  const PivotBlock block(c, pivots, alone(c));
  expect_solves(block, c, pivots);
  expect_ties(block, c, pivots, {0, 7});
}

/// As by vertex quadrature; the rows in another order than the dofs.
TEST(PivotBlock, OfConstraintsThatSeeOnePivotEach) {
  SparseMatrix c(3, dofs);
  c.insert(0, 5) = 2;
  c.insert(0, 9) = 1;
  c.insert(1, 3) = -4;
  c.insert(1, 5) = 0; // of the pattern alone
  c.insert(2, 7) = 0.5;
  c.insert(2, 9) = 3;
  const std::vector<Index> pivots{5, 3, 7};
  const PivotBlock block(c, pivots, alone(c));
  expect_solves(block, c, pivots);
  expect_ties(block, c, pivots, {9});
}

TEST(PivotBlock, RefusesConstraintsThatDependOnEachOther) {
  SparseMatrix c(2, dofs);
  for (const Index row : {0, 1}) {
    c.insert(row, 3) = 1;
    c.insert(row, 4) = 2;
  }
  EXPECT_THROW(PivotBlock(c, {3, 4}, alone(c)), Error);
}

} // namespace
} // namespace rbvi::pivots_test
