// Lagrange functions of degree 1 and 2 on segments, triangles and tetrahedra.
#include "cells.hpp"
#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

namespace rbvi::lagrange_test {
namespace {

/// Its vertices are the origin and random points; edge vectors are independent.
struct RandomSimplex {
  Vertices x{};
  Simplex geometry;

  RandomSimplex(int dim, Random &random) {
    if (dim > 1) {
      x = random_cell(dim, random);
      geometry = simplex(dim, x);
      return;
    }
    x[0][0] = random();
    x[1][0] = x[0][0] + 0.7;
    geometry.gradients.setZero();
    geometry.gradients(0, 0) = -1 / 0.7;
    geometry.gradients(1, 0) = 1 / 0.7;
  }

  /// Barycentric coordinates of y: 1 at a vertex, and linear.
  Vector barycentric(int dim, const Eigen::Vector3d &y) const {
    Vector b(dim + 1);
    for (int i = 0; i <= dim; ++i)
      b[i] = (i == 0 ? 1 : 0) +
             geometry.gradients.row(i).dot((y - Eigen::Vector3d(x[0].data())).transpose());
    return b;
  }
};

Vector values(int dim, int degree, const Vector &barycentric) {
  Vector phi(nodes_per_cell(dim, degree));
  lagrange_values(dim, degree, {barycentric.data(), barycentric.data() + barycentric.size()},
                  {phi.data(), phi.data() + phi.size()});
  return phi;
}

/// node x direction
Matrix gradients(int dim, int degree, const Vector &barycentric, const Simplex &geometry) {
  std::array<std::array<double, 3>, most_nodes> phi{};
  lagrange_gradients(dim, degree, {barycentric.data(), barycentric.data() + barycentric.size()},
                     geometry, phi);
  Matrix result(nodes_per_cell(dim, degree), 3);
  for (Index i = 0; i < result.rows(); ++i)
    for (Index c = 0; c < 3; ++c)
      result(i, c) = phi[i][c];
  return result;
}

Vector random_barycentric(int dim, Random &random) {
  const Vector b = random.vector(dim + 1).cwiseAbs() + Vector::Constant(dim + 1, 0.01);
  return b / b.sum();
}

/// Calls `check(dim, degree, cell)` for every kind of cell.
template <class Check> void for_all_cells(Check &&check) {
  Random random(1);
  for (int dim : {1, 2, 3})
    for (int degree : {1, 2}) {
      SCOPED_TRACE("dim " + std::to_string(dim) + ", degree " + std::to_string(degree));
      for (int repeat = 0; repeat < 5; ++repeat)
        check(dim, degree, RandomSimplex(dim, random), random);
    }
}

TEST(Lagrange, CountsNodes) {
  EXPECT_EQ(nodes_per_cell(1, 1), 2);
  EXPECT_EQ(nodes_per_cell(2, 1), 3);
  EXPECT_EQ(nodes_per_cell(3, 1), 4);
  EXPECT_EQ(nodes_per_cell(1, 2), 3);
  EXPECT_EQ(nodes_per_cell(2, 2), 6);
  EXPECT_EQ(nodes_per_cell(3, 2), most_nodes);
}

TEST(Lagrange, EachFunctionIsOneAtItsNodeAndZeroAtTheOthers) {
  for_all_cells([](int dim, int degree, const RandomSimplex &cell, Random &) {
    const auto nodes = nodes_of(dim, degree, cell.x);
    ASSERT_EQ(static_cast<int>(nodes.size()), nodes_per_cell(dim, degree));
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      const Vector phi = values(dim, degree, cell.barycentric(dim, nodes[j]));
      EXPECT_LT((phi - Vector::Unit(phi.size(), static_cast<Index>(j))).norm(), 1e-13);
    }
  });
}

TEST(Lagrange, FunctionsSumToOneAndGradientsToZero) {
  for_all_cells([](int dim, int degree, const RandomSimplex &cell, Random &random) {
    const Vector b = random_barycentric(dim, random);
    EXPECT_NEAR(values(dim, degree, b).sum(), 1, 1e-15);
    const Matrix g = gradients(dim, degree, b, cell.geometry);
    EXPECT_LT(g.colwise().sum().norm(), 1e-13 * g.norm());
  });
}

TEST(Lagrange, GradientsAreThoseOfCentralDifferences) {
  for_all_cells([](int dim, int degree, const RandomSimplex &cell, Random &random) {
    const Eigen::Vector3d y = random_point(dim, random);
    const Matrix exact = gradients(dim, degree, cell.barycentric(dim, y), cell.geometry);
    const double h = 0.1; // no error but round-off: the functions are quadratic
    for (int c = 0; c < dim; ++c) {
      const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(c);
      const Vector difference = values(dim, degree, cell.barycentric(dim, y + step)) -
                                values(dim, degree, cell.barycentric(dim, y - step));
      EXPECT_LT((difference / (2 * h) - exact.col(c)).norm(), 1e-12 * exact.norm());
    }
    EXPECT_EQ(exact.rightCols(3 - dim).norm(), 0);
  });
}

TEST(Lagrange, ReproducesPolynomialsOfItsDegree) {
  for_all_cells([](int dim, int degree, const RandomSimplex &cell, Random &random) {
    const Eigen::Vector3d slope = random.vector(3);
    const Eigen::Matrix3d curvature = (degree - 1) * random.matrix(3, 3);
    const auto p = [&](const Eigen::Vector3d &y) {
      return 0.3 + slope.dot(y) + y.dot(curvature * y);
    };
    const Eigen::Vector3d y = random_point(dim, random);
    const Vector phi = values(dim, degree, cell.barycentric(dim, y));
    double sum = 0;
    const auto nodes = nodes_of(dim, degree, cell.x);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      sum += phi[static_cast<Index>(i)] * p(nodes[i]);
    EXPECT_NEAR(sum, p(y), 1e-11);
  });
}

TEST(Lagrange, OnlyDegrees1And2Exist) {
  EXPECT_NO_THROW(check_degree(1));
  EXPECT_NO_THROW(check_degree(2));
  for (int degree : {-1, 0, 3})
    try {
      check_degree(degree);
      ADD_FAILURE() << degree;
    } catch (const Error &error) {
      EXPECT_EQ(error.status(), Status::bad_input);
      EXPECT_NE(std::string(error.what()).find("not " + std::to_string(degree)), std::string::npos);
    }
}

} // namespace
} // namespace rbvi::lagrange_test
