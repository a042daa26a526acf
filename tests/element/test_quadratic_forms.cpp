// Elasticity and the H1 product of degree 2: exact for quadratic fields on straight cells; and what
// the two degrees share.
#include "../linear_algebra.hpp"
#include "cells.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/quadrature.hpp"
#include "rbvi/element/scalar_forms.hpp"

#include <gtest/gtest.h>

namespace rbvi::quadratic_forms_test {
namespace {

const Lame steel = lame(15, 0.35), rubber = lame(0.2, 0.45);

/// u_c(x) = constant_c + linear_c . x + x . quadratic[c] x
struct Field {
  Eigen::Vector3d constant = Eigen::Vector3d::Zero();
  Eigen::Matrix3d linear = Eigen::Matrix3d::Zero();
  std::array<Eigen::Matrix3d, 3> quadratic{Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(),
                                           Eigen::Matrix3d::Zero()};

  Eigen::Vector3d operator()(const Eigen::Vector3d &x) const {
    Eigen::Vector3d u = constant + linear * x;
    for (int c = 0; c < 3; ++c)
      u[c] += x.dot(quadratic[c] * x);
    return u;
  }
  /// component x direction
  Eigen::Matrix3d gradient(const Eigen::Vector3d &x) const {
    Eigen::Matrix3d g = linear;
    for (int c = 0; c < 3; ++c) {
      const Eigen::Matrix3d &q = quadratic[c];
      g.row(c) += ((q + q.transpose()) * x).transpose();
    }
    return g;
  }
};

/// Its components and what they depend on are the first `dim`.
Field random_field(int dim, Random &random) {
  Field field;
  field.constant = random_point(dim, random);
  field.linear = random_block(dim, random);
  for (int c = 0; c < dim; ++c)
    field.quadratic[c] = random_block(dim, random);
  return field;
}

Vector interpolate(const Field &field, int dim, const Vertices &x, int components, int degree) {
  const auto nodes = nodes_of(dim, degree, x);
  Vector u(static_cast<Index>(nodes.size()) * components);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Vector value = field(nodes[i]);
    u.segment(static_cast<Index>(i) * components, components) = value.head(components);
  }
  return u;
}

/// The integral of a polynomial of degree <= 7.
double integral(int dim, const Vertices &x,
                const std::function<double(const Eigen::Vector3d &)> &integrand) {
  double sum = 0;
  for (const QuadraturePoint &q : simplex_quadrature(dim, 7)) {
    Eigen::Vector3d y = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i <= static_cast<std::size_t>(dim); ++i)
      y += q.barycentric[i] * Eigen::Vector3d(x[i].data());
    sum += q.weight * integrand(y);
  }
  return simplex(dim, x).volume * sum;
}

/// sigma(u) : eps(v)
double power(const Lame &material, const Eigen::Matrix3d &gradient_u,
             const Eigen::Matrix3d &gradient_v) {
  const Eigen::Matrix3d eps = (gradient_u + gradient_u.transpose()) / 2;
  const Eigen::Matrix3d sigma =
      material.lambda * eps.trace() * Eigen::Matrix3d::Identity() + 2 * material.shear * eps;
  return (sigma * (gradient_v + gradient_v.transpose()) / 2).trace();
}

TEST(PositiveQuadrature, IsExactToDegree2) {
  for (int dim : {1, 2, 3}) {
    const auto rule = positive_quadrature(dim);
    ASSERT_EQ(static_cast<int>(rule.size()), dim + 1);
    Matrix moments = Matrix::Zero(dim + 1, dim + 1); // b sums to 1: those of degree 2 tell all
    for (const QuadraturePoint &q : rule) {
      const Eigen::Map<const Vector> b(q.barycentric.data(), dim + 1);
      EXPECT_GT(b.minCoeff(), 0);
      EXPECT_NEAR(b.sum(), 1, 1e-15);
      EXPECT_EQ(q.weight, 1.0 / (dim + 1));
      moments += q.weight * b * b.transpose();
    }
    const Matrix exact = (Matrix::Ones(dim + 1, dim + 1) + Matrix::Identity(dim + 1, dim + 1)) /
                         ((dim + 1) * (dim + 2));
    EXPECT_LT((moments - exact).norm(), 1e-15);
  }
}

TEST(QuadraticElasticity, RigidMotionsAndNothingElseCostNothing) {
  Random random(1);
  for (int dim : {2, 3})
    for (int repeat = 0; repeat < 10; ++repeat) {
      const Vertices x = random_cell(dim, random);
      const Matrix m = evaluate(elasticity("", steel, 2), dim, x, dim, 2);
      EXPECT_LT((m - m.transpose()).norm(), 1e-15 * m.norm());
      Field rigid;
      rigid.constant = random_point(dim, random);
      const Eigen::Matrix3d turn = random_block(dim, random);
      rigid.linear = turn - turn.transpose();
      EXPECT_LT((m * interpolate(rigid, dim, x, dim, 2)).norm(), 1e-13 * m.norm());
      const Vector eigenvalues = symmetric_eigenvalues(m);
      const Index kernel = dim == 2 ? 3 : 6;
      const double largest = eigenvalues.tail(1)[0];
      EXPECT_LT(eigenvalues.head(kernel).cwiseAbs().maxCoeff(), 1e-13 * largest);
      EXPECT_GT(eigenvalues[kernel], 1e-7 * largest);
    }
}

TEST(QuadraticElasticity, IsExactForQuadraticFields) {
  Random random(2);
  for (int dim : {2, 3})
    for (int repeat = 0; repeat < 10; ++repeat) {
      const Vertices x = random_cell(dim, random);
      const Field u = random_field(dim, random), v = random_field(dim, random);
      const Matrix m = evaluate(elasticity("", steel, 2), dim, x, dim, 2);
      const double exact = integral(dim, x, [&](const Eigen::Vector3d &y) {
        return power(steel, u.gradient(y), v.gradient(y));
      });
      const Vector nodal_u = interpolate(u, dim, x, dim, 2),
                   nodal_v = interpolate(v, dim, x, dim, 2);
      EXPECT_NEAR(nodal_v.dot(m * nodal_u), exact,
                  1e-14 * m.norm() * nodal_u.norm() * nodal_v.norm());
    }
}

TEST(QuadraticElasticity, ConstantStrainCostsWhatItDoesOfDegree1) {
  Random random(3);
  for (int dim : {2, 3}) {
    const Vertices x = random_cell(dim, random);
    Field u;
    u.linear = random_block(dim, random);
    const double exact = simplex(dim, x).volume * power(steel, u.linear, u.linear);
    for (int degree : {1, 2}) {
      const Matrix m = evaluate(elasticity("", steel, degree), dim, x, dim, degree);
      const Vector nodal = interpolate(u, dim, x, dim, degree);
      EXPECT_NEAR(nodal.dot(m * nodal), exact, 1e-13 * m.norm()) << dim << degree;
    }
  }
}

TEST(Elasticity, OfDegree1IsTheTextbookProductOfStrainMatrices) {
  Random random(4);
  for (int dim : {2, 3}) {
    const Vertices x = random_cell(dim, random);
    const Simplex s = simplex(dim, x);
    const int shears = dim == 2 ? 1 : 3;
    Matrix law = Matrix::Zero(dim + shears, dim + shears); // of eps_cc, then 2 eps_cd
    law.topLeftCorner(dim, dim).setConstant(steel.lambda);
    law.topLeftCorner(dim, dim).diagonal().array() += 2 * steel.shear;
    law.bottomRightCorner(shears, shears).diagonal().setConstant(steel.shear);
    Matrix strain = Matrix::Zero(dim + shears, (dim + 1) * dim);
    for (int i = 0; i <= dim; ++i) {
      for (int c = 0; c < dim; ++c)
        strain(c, i * dim + c) = s.gradients(i, c);
      for (int k = 0; k < shears; ++k) {
        const int c = k == 2 ? 2 : k, d = k == 2 ? 0 : k + 1;
        strain(dim + k, i * dim + c) = s.gradients(i, d);
        strain(dim + k, i * dim + d) = s.gradients(i, c);
      }
    }
    const Matrix expected = s.volume * strain.transpose() * law * strain;
    EXPECT_LT((evaluate(elasticity("", steel), dim, x, dim) - expected).norm(),
              1e-14 * expected.norm());
  }
}

TEST(QuadraticElasticity, DoesNotDependOnTheScaleIn2DAndGrowsWithItIn3D) {
  Random random(5);
  for (int dim : {2, 3}) {
    const Vertices x = random_cell(dim, random);
    const Matrix m = evaluate(elasticity("", steel, 2), dim, x, dim, 2);
    for (double scale : {1e-3, 0.7, 1.3, 50.0}) {
      Cell cell{dim, x, x};
      for (Point &p : cell.mapped)
        for (double &coordinate : p)
          coordinate *= scale;
      Matrix other(m.rows(), m.cols());
      elasticity("", steel, 2).kernel({}, cell, other.data());
      const double factor = dim == 2 ? 1 : scale;
      EXPECT_LT((other - factor * m).norm(), 1e-14 * factor * m.norm()) << scale;
    }
  }
}

TEST(Elasticity, MaterialMayDependOnTheCellAndTheParameters) {
  Random random(6);
  const FullMu mu{0.25};
  for (int dim : {2, 3})
    for (int degree : {1, 2}) {
      const Form piecewise = elasticity(
          "",
          [](const FullMu &at, const Point &centre) { return centre[0] < at[0] ? steel : rubber; },
          degree);
      int rubbers = 0;
      for (int repeat = 0; repeat < 20; ++repeat) {
        const Cell cell{dim, random_cell(dim, random), random_cell(dim, random)};
        double centre = 0;
        for (std::size_t i = 0; i <= static_cast<std::size_t>(dim); ++i)
          centre += cell.reference[i][0] / (dim + 1);
        const bool soft = centre >= mu[0];
        rubbers += soft;
        const Index size = nodes_per_cell(dim, degree) * dim;
        Matrix got(size, size), expected(size, size);
        piecewise.kernel(mu, cell, got.data());
        elasticity("", soft ? rubber : steel, degree).kernel({}, cell, expected.data());
        EXPECT_EQ(got, expected);
      }
      EXPECT_GT(rubbers, 0);
      EXPECT_LT(rubbers, 20);
    }
}

TEST(Elasticity, OfAWeightedSumOfMaterialsIsTheSum) {
  Random random(7);
  const Lame sum{2 * steel.lambda + 3 * rubber.lambda, 2 * steel.shear + 3 * rubber.shear};
  for (int dim : {2, 3})
    for (int degree : {1, 2}) {
      const Vertices x = random_cell(dim, random);
      const auto matrix = [&](const Lame &material) {
        return evaluate(elasticity("", material, degree), dim, x, dim, degree);
      };
      EXPECT_LT((matrix(sum) - 2 * matrix(steel) - 3 * matrix(rubber)).norm(),
                1e-14 * matrix(sum).norm());
    }
}

TEST(QuadraticH1Product, IntegratesProductsOfQuadraticFields) {
  Random random(8);
  const double length = 0.4;
  for (int dim : {2, 3})
    for (int components : {1, dim}) {
      const Vertices x = random_cell(dim, random);
      const Matrix m = evaluate(h1_product(length, components, 2), dim, x, components, 2);
      const Field u = random_field(dim, random), v = random_field(dim, random);
      const double exact = integral(dim, x, [&](const Eigen::Vector3d &y) {
        double sum = 0;
        for (int c = 0; c < components; ++c)
          sum +=
              u(y)[c] * v(y)[c] + length * length * u.gradient(y).row(c).dot(v.gradient(y).row(c));
        return sum;
      });
      const Vector nodal_u = interpolate(u, dim, x, components, 2);
      const Vector nodal_v = interpolate(v, dim, x, components, 2);
      EXPECT_NEAR(nodal_v.dot(m * nodal_u), exact,
                  1e-14 * m.norm() * nodal_u.norm() * nodal_v.norm());
      EXPECT_LT((m - m.transpose()).norm(), 1e-15 * m.norm());
      EXPECT_GT(symmetric_eigenvalues(m)[0], 0);
      for (Index i = 0; i < m.rows(); ++i)
        for (Index j = 0; j < m.cols(); ++j)
          EXPECT_TRUE(i % components == j % components || m(i, j) == 0) << i << " " << j;
    }
}

TEST(QuadraticForms, RefuseOtherDegrees) {
  const auto material = [](const FullMu &, const Point &) { return steel; };
  for (int degree : {0, 3}) {
    EXPECT_THROW(elasticity("", steel, degree), Error);
    EXPECT_THROW(elasticity("", material, degree), Error);
    EXPECT_THROW(h1_product(1, 2, degree), Error);
  }
}

} // namespace
} // namespace rbvi::quadratic_forms_test
