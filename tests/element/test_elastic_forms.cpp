// Elasticity and the vector H1 product: rigid motions, closed-form energies, plane strain against
// a prism in 3D.
#include "../linear_algebra.hpp"
#include "cells.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"

#include <gtest/gtest.h>

namespace rbvi::elastic_forms_test {
namespace {

using LinearField = Eigen::Matrix3d; // u(x) = field * x

constexpr double young = 15, poisson = 0.35;
constexpr double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
constexpr double shear = young / (2 * (1 + poisson));
const Lame material = lame(young, poisson);

Vector nodal_values(int dim, const Vertices &x, const LinearField &field) {
  Vector u((dim + 1) * dim);
  for (int i = 0; i <= dim; ++i) {
    const Point &p = x[i];
    for (int c = 0; c < dim; ++c)
      u[i * dim + c] = field.row(c).dot(Eigen::RowVector3d(p[0], p[1], p[2]));
  }
  return u;
}

LinearField unit_field(int component, int direction) {
  LinearField field = LinearField::Zero();
  field(component, direction) = 1;
  return field;
}

TEST(Elasticity, IsSymmetricAndRigidMotionsCostNothing) {
  Random random(1);
  for (int dim : {2, 3})
    for (int repeat = 0; repeat < 10; ++repeat) {
      const Vertices x = random_cell(dim, random);
      const Matrix m = evaluate(elasticity("", material), dim, x, dim);
      EXPECT_LT((m - m.transpose()).norm(), 1e-15 * m.norm());
      for (int c = 0; c < dim; ++c) {
        Vector translation = Vector::Zero(m.cols());
        for (int i = 0; i <= dim; ++i)
          translation[i * dim + c] = 1;
        EXPECT_LT((m * translation).norm(), 1e-13 * m.norm());
        for (int d = 0; d < c; ++d) {
          const Vector rotation = nodal_values(dim, x, unit_field(c, d) - unit_field(d, c));
          EXPECT_LT((m * rotation).norm(), 1e-13 * m.norm());
        }
      }
      const Vector eigenvalues = symmetric_eigenvalues(m);
      const Index rigid = dim == 2 ? 3 : 6;
      EXPECT_GT(eigenvalues[rigid], 1e-4 * eigenvalues.tail(1)[0]) << "only rigid motions are free";
    }
}

TEST(Elasticity, EnergyOfUniaxialStrainAndSimpleShear) {
  Random random(2);
  for (int dim : {2, 3}) {
    const Vertices x = random_cell(dim, random);
    const double volume = simplex(dim, x).volume;
    const Matrix m = evaluate(elasticity("", material), dim, x, dim);
    for (int c = 0; c < dim; ++c)
      for (int d = 0; d < dim; ++d) {
        const Vector u = nodal_values(dim, x, 0.3 * unit_field(c, d));
        const double exact = (c == d ? lambda + 2 * shear : shear) * 0.09 * volume;
        EXPECT_NEAR(u.dot(m * u), exact, 1e-13 * exact) << dim << c << d;
      }
    const Vector u = nodal_values(dim, x, unit_field(0, 0)),
                 v = nodal_values(dim, x, unit_field(1, 1));
    EXPECT_NEAR(u.dot(m * v), lambda * volume, 1e-13 * lambda) << "Poisson's coupling";
  }
}

TEST(Elasticity, PlaneStrainIsAPrismWithoutAxialDisplacement) {
  Random random(3);
  const Vertices base = random_cell(2, random);
  const double height = 0.7;
  Vertices top = base;
  for (Point &p : top)
    p[2] = height;
  const std::array<Vertices, 3> prism{Vertices{base[0], base[1], base[2], top[2]},
                                      Vertices{base[0], base[1], top[2], top[1]},
                                      Vertices{base[0], top[1], top[2], top[0]}};
  const Form form = elasticity("", material);
  LinearField u = LinearField::Zero(), v = LinearField::Zero();
  u.topLeftCorner(2, 2) = random.matrix(2, 2);
  v.topLeftCorner(2, 2) = random.matrix(2, 2);
  double volume = 0, work = 0;
  for (const Vertices &x : prism) {
    ASSERT_GT(simplex(3, x).volume, 0);
    volume += simplex(3, x).volume;
    work += nodal_values(3, x, v).dot(evaluate(form, 3, x, 3) * nodal_values(3, x, u));
  }
  ASSERT_NEAR(volume, height * simplex(2, base).volume, 1e-15);
  const double plane =
      nodal_values(2, base, v).dot(evaluate(form, 2, base, 2) * nodal_values(2, base, u));
  EXPECT_NEAR(work, height * plane, 1e-13 * young);
}

TEST(Elasticity, DoesNotDependOnTheScaleIn2D) {
  Random random(4);
  const Vertices x = random_cell(2, random);
  const Matrix m = evaluate(elasticity("", material), 2, x, 2);
  for (double scale : {1e-3, 0.7, 1.3, 50.0}) {
    Vertices scaled = x;
    for (Point &p : scaled)
      for (double &coordinate : p)
        coordinate *= scale;
    const Matrix other = evaluate(elasticity("", material), 2, scaled, 2);
    EXPECT_LT((other - m).norm(), 1e-14 * m.norm()) << scale;
  }
}

TEST(Elasticity, RefusesUnphysicalConstants) {
  EXPECT_THROW(lame(0, 0.3), Error);
  EXPECT_THROW(lame(-1, 0.3), Error);
  EXPECT_THROW(lame(1, 0.5), Error);
  EXPECT_THROW(lame(1, -1), Error);
  EXPECT_NO_THROW(lame(1, -0.9));
}

TEST(H1Product, ActsOnEachComponentAlone) {
  Random random(5);
  const double length = 0.4;
  for (int dim : {2, 3}) {
    const Vertices x = random_cell(dim, random);
    const Matrix scalar = evaluate(h1_product(length), dim, x, 1);
    const Vector ones = Vector::Ones(dim + 1);
    const double volume = simplex(dim, x).volume;
    EXPECT_NEAR(ones.dot(scalar * ones), volume, 1e-14);
    Vector abscissa(dim + 1); // v = x: int grad 1 . grad x = 0, int |grad x|^2 = volume
    double mean = 0, square = 0;
    for (int i = 0; i <= dim; ++i) {
      abscissa[i] = x[i][0];
      mean += abscissa[i] / (dim + 1);
      square += abscissa[i] * abscissa[i];
    }
    const double moment = (square + (dim + 1) * (dim + 1) * mean * mean) / ((dim + 1) * (dim + 2));
    EXPECT_NEAR(ones.dot(scalar * abscissa), mean * volume, 1e-14);
    EXPECT_NEAR(abscissa.dot(scalar * abscissa), volume * (moment + length * length), 1e-13);
    for (int components : {2, 3}) {
      const Matrix m = evaluate(h1_product(length, components), dim, x, components);
      for (Index i = 0; i < m.rows(); ++i)
        for (Index j = 0; j < m.cols(); ++j)
          EXPECT_EQ(m(i, j), i % components == j % components
                                 ? scalar(i / components, j / components)
                                 : 0.0);
    }
  }
}

} // namespace
} // namespace rbvi::elastic_forms_test
