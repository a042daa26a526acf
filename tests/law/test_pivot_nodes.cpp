#include "../linear_algebra.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/law/friction/least_squares_friction.hpp"

#include "random_matrix.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace rbvi::pivot_nodes_test {

namespace {

Matrix orthonormal(const Matrix &columns) {
  return columns.householderQr().householderQ() * Matrix::Identity(columns.rows(), columns.cols());
}

/// Pressures of more and more narrow contacts and shears that follow them, at 41 nodes.
Matrix smooth_basis(Index modes) {
  Matrix basis(82, modes);
  for (Index k = 0; k < modes; ++k)
    for (Index i = 0; i < 41; ++i) {
      const double x = static_cast<double>(i - 20) /
                       (4 + 16.0 * static_cast<double>(k + 1) / static_cast<double>(modes));
      basis(i, k) = std::sqrt(std::max(0.0, 1 - x * x));
      basis(41 + i, k) = 0.3 * x * basis(i, k);
    }
  return orthonormal(basis);
}

/// The first ones.
std::vector<int> first_nodes(int count) {
  std::vector<int> result;
  for (int j = 0; j < count; ++j)
    result.push_back(j);
  return result;
}

/// The condition of the rows of the nodes, normal and tangential.
double condition(const Matrix &basis, std::vector<int> nodes) {
  for (int k = static_cast<int>(nodes.size()) - 1; k >= 0; --k)
    nodes.push_back(nodes[static_cast<std::size_t>(k)] + static_cast<int>(basis.rows() / 2));
  const Vector values = thin_svd(basis(nodes, Eigen::all)).values;
  return values[0] / values[values.size() - 1];
}

} // namespace

TEST(PivotNodes, DetermineTheCoefficients) {
  constexpr int modes = 12;
  const Matrix smooth = smooth_basis(modes);
  for (const int count : {modes, modes + 3, 35}) {
    const std::vector<int> nodes = pivot_nodes(smooth, count);
    EXPECT_EQ(nodes.size(), static_cast<std::size_t>(count));
    EXPECT_EQ(std::set<int>(nodes.begin(), nodes.end()).size(), nodes.size());
    EXPECT_GE(*std::min_element(nodes.begin(), nodes.end()), 0);
    EXPECT_LT(*std::max_element(nodes.begin(), nodes.end()), 41);
    EXPECT_LT(condition(smooth, nodes), 30);
    EXPECT_LT(condition(smooth, nodes), condition(smooth, first_nodes(count)));
  }
  // Modes that live at one node each, at the far end, normal or tangential.
  Matrix local = Matrix::Zero(82, 4);
  local(40, 0) = local(38, 1) = local(41 + 39, 2) = local(41 + 40, 3) = 1;
  EXPECT_EQ(pivot_nodes(local, 3), (std::vector<int>{38, 39, 40}));
  // In order of importance: fewer are the first of more.
  const std::vector<int> few = pivot_nodes(smooth, 7), more = pivot_nodes(smooth, 41);
  EXPECT_TRUE(std::equal(few.begin(), few.end(), more.begin()));
}

TEST(PivotNodes, OfEqualNodesTheLowestComesFirst) {
  // Mirrored data, with round-off: node j and node 19 - j.
  Random random(5);
  const Matrix half = random.matrix(10, 4);
  Matrix basis(40, 4);
  basis << half, half.colwise().reverse(), half, half.colwise().reverse();
  const std::vector<int> exact = pivot_nodes(basis, 20);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_LT(exact[k], 10);
  for (int k = 0; k < 10; ++k)
    EXPECT_EQ(
        pivot_nodes(basis.cwiseProduct(Matrix::Ones(40, 4) + 1e-15 * random.matrix(40, 4)), 20),
        exact);
  EXPECT_EQ(pivot_nodes(Matrix::Identity(6, 6), 3), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(pivot_nodes(Matrix::Zero(6, 2), 3), (std::vector<int>{0, 1, 2}));
  // Only the tangential value of node 1 tells anything.
  Matrix one = Matrix::Zero(6, 1);
  one(4, 0) = 1e-200;
  EXPECT_EQ(pivot_nodes(one, 2), (std::vector<int>{1, 0}));
  EXPECT_TRUE(pivot_nodes(one, 0).empty());
}

TEST(PivotNodes, RefuseBadInput) {
  EXPECT_THROW(pivot_nodes(Matrix::Ones(5, 1), 1), Error);
  EXPECT_THROW(pivot_nodes(Matrix::Ones(6, 0), 1), Error);
  EXPECT_THROW(pivot_nodes(Matrix::Ones(6, 1), 4), Error);
  EXPECT_THROW(pivot_nodes(Matrix::Ones(6, 1), -1), Error);
  EXPECT_THROW(pivot_nodes(Matrix::Constant(6, 1, std::nan("")), 1), Error);
}

} // namespace rbvi::pivot_nodes_test
