// Scalar forms of degree 1 and 2 on triangles and tetrahedra: exact for polynomials of their
// degree, and what couples the hats of the vertices with them.
#include "cells.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/quadrature.hpp"
#include "rbvi/element/scalar_forms.hpp"

#include <gtest/gtest.h>

namespace rbvi::scalar_forms_test {
namespace {

/// constant + slope . x + x . curvature x
struct Polynomial {
  double constant;
  Eigen::Vector3d slope;
  Eigen::Matrix3d curvature;

  Polynomial(int dim, int degree, Random &random)
      : constant(random()), slope(random_point(dim, random)),
        curvature((degree - 1) * random_block(dim, random)) {}
  double operator()(const Eigen::Vector3d &x) const {
    return constant + slope.dot(x) + x.dot(curvature * x);
  }
  Eigen::Vector3d gradient(const Eigen::Vector3d &x) const {
    return slope + (curvature + curvature.transpose()) * x;
  }
};

/// A cell whose mapped copy differs from its reference.
struct Example {
  int dim, degree;
  Cell cell;
  Polynomial u, v, eta; ///< eta is linear

  Example(int dimension, int of_degree, Random &random)
      : dim(dimension),
        degree(of_degree), cell{dim, random_cell(dim, random), random_cell(dim, random)},
        u(dim, degree, random), v(dim, degree, random), eta(dim, 1, random) {}

  Matrix matrix(const Form &form, int rows_degree, int columns_degree) const {
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> m(
        nodes_per_cell(dim, rows_degree), nodes_per_cell(dim, columns_degree));
    form.kernel({}, cell, m.data());
    return m;
  }
  Vector vector(const Form &form, int test_degree) const {
    Vector load(nodes_per_cell(dim, test_degree));
    form.kernel({}, cell, load.data());
    return load;
  }
};

/// Values at the nodes of degree 1 or 2.
Vector interpolate(const Polynomial &p, int dim, int degree, const Vertices &x) {
  const auto nodes = nodes_of(dim, degree, x);
  Vector values(static_cast<Index>(nodes.size()));
  for (Index i = 0; i < values.size(); ++i)
    values[i] = p(nodes[i]);
  return values;
}

/// The integral over a simplex of a polynomial of degree <= 7.
template <class Integrand> double integral(int dim, const Vertices &x, const Integrand &integrand) {
  double sum = 0;
  for (const QuadraturePoint &q : simplex_quadrature(dim, 7)) {
    Eigen::Vector3d y = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i <= static_cast<std::size_t>(dim); ++i)
      y += q.barycentric[i] * Eigen::Vector3d(x[i].data());
    sum += q.weight * integrand(y);
  }
  return simplex(dim, x).volume * sum;
}

/// Calls `check(example)` for every dimension and degree.
template <class Check> void for_examples(const Check &check) {
  Random random(1);
  for (int dim : {2, 3})
    for (int degree : {1, 2}) {
      SCOPED_TRACE("dim " + std::to_string(dim) + ", degree " + std::to_string(degree));
      for (int repeat = 0; repeat < 10; ++repeat)
        check(Example(dim, degree, random));
    }
}

TEST(Laplace, IsExactSymmetricAndZeroForConstants) {
  for_examples([](const Example &e) {
    const Vertices &x = e.cell.mapped;
    const Matrix m = e.matrix(laplace("", e.degree), e.degree, e.degree);
    const double exact = integral(
        e.dim, x, [&](const Eigen::Vector3d &y) { return e.u.gradient(y).dot(e.v.gradient(y)); });
    const Vector u = interpolate(e.u, e.dim, e.degree, x), v = interpolate(e.v, e.dim, e.degree, x);
    EXPECT_NEAR(v.dot(m * u), exact, 1e-14 * m.norm() * u.norm() * v.norm());
    EXPECT_EQ(m, m.transpose());
    EXPECT_LT(m.rowwise().sum().norm(), 1e-14 * m.norm());
  });
}

TEST(ConstantLoad, IsTheIntegralOfTheTestFunction) {
  for_examples([](const Example &e) {
    const Vertices &x = e.cell.mapped;
    const Vector load = e.vector(constant_load("", -3, e.degree), e.degree);
    const double exact = -3 * integral(e.dim, x, e.v);
    EXPECT_NEAR(load.dot(interpolate(e.v, e.dim, e.degree, x)), exact, 1e-13);
    EXPECT_NEAR(load.sum(), -3 * simplex(e.dim, x).volume, 1e-14);
  });
}

TEST(ConstantLoad, OfDegree2HasTheSharesOfTextbooks) {
  Random random(2);
  for (int dim : {2, 3}) {
    const Example e(dim, 2, random);
    const double volume = simplex(dim, e.cell.mapped).volume;
    const Vector load = e.vector(constant_load("", 1, 2), 2);
    for (Index i = 0; i < load.size(); ++i) {
      const double share = i <= dim ? (dim == 2 ? 0 : -1.0 / 20) : (dim == 2 ? 1.0 / 3 : 1.0 / 5);
      EXPECT_NEAR(load[i], share * volume, 1e-15 * volume) << dim << " " << i;
    }
  }
}

/// Of a constant force the load of each component; of one that is linear the integral.
TEST(BodyLoad, IsTheIntegralOfTheForceTimesTheTestFunction) {
  for_examples([](const Example &e) {
    const Vertices &x = e.cell.mapped;
    const auto nodes = static_cast<Index>(nodes_per_cell(e.dim, e.degree));
    const Vector constant = e.vector(constant_load("", 1, e.degree), e.degree);
    Vector values(2 * nodes);
    const std::function<PointMap> force = [](const FullMu &, const Point &at) {
      return Point{-3, 2 + at[0], 0};
    };
    body_load("", force, 2, e.degree).kernel({}, e.cell, values.data());
    Point centre{};
    for (int v = 0; v <= e.dim; ++v)
      centre = centre + 1.0 / (e.dim + 1) * x[v];
    for (Index i = 0; i < nodes; ++i)
      EXPECT_NEAR(values[2 * i], -3 * constant[i], 1e-13);
    double second = 0;
    for (Index i = 0; i < nodes; ++i)
      second += values[2 * i + 1];
    EXPECT_NEAR(second, (2 + centre[0]) * simplex(e.dim, x).volume, 1e-13);
  });
}

TEST(HatCoupling, IntegratesALinearDualFunctionTimesTheDisplacement) {
  for_examples([](const Example &e) {
    const Vertices &x = e.cell.mapped;
    const Matrix m = e.matrix(hat_coupling("", -2, e.degree, false), 1, e.degree);
    const double exact =
        -2 * integral(e.dim, x, [&](const Eigen::Vector3d &y) { return e.eta(y) * e.u(y); });
    EXPECT_NEAR(interpolate(e.eta, e.dim, 1, x).dot(m * interpolate(e.u, e.dim, e.degree, x)),
                exact, 1e-13);
    const Vector hats = e.vector(constant_load("", -2), 1);
    EXPECT_LT((m.rowwise().sum() - hats).norm(), 1e-14) << "the displacements sum to 1";
  });
}

TEST(HatCoupling, LumpedIsTheIntegralOfEachHatAtItsVertex) {
  for_examples([](const Example &e) {
    const Matrix m = e.matrix(hat_coupling("", 1, e.degree, true), 1, e.degree);
    const Vector hats = e.vector(constant_load("", 1), 1);
    EXPECT_LT((m.diagonal() - hats).norm(), 1e-15);
    Matrix others = m;
    others.diagonal().setZero();
    EXPECT_EQ(others.norm(), 0);
  });
}

TEST(HatCoupling, OfLinearDisplacementsIsTheSameForBothDegrees) {
  Random random(3);
  for (int dim : {2, 3}) {
    const Example e(dim, 1, random);
    for (bool lumped : {false, true}) {
      const Vector one =
          e.matrix(hat_coupling("", 1, 1, lumped), 1, 1) * interpolate(e.u, dim, 1, e.cell.mapped);
      const Vector two =
          e.matrix(hat_coupling("", 1, 2, lumped), 1, 2) * interpolate(e.u, dim, 2, e.cell.mapped);
      EXPECT_LT((one - two).norm(), 1e-14) << dim << lumped;
    }
  }
}

TEST(L2Product, IntegratesLinearFunctionsOverTheReferenceCell) {
  for_examples([](const Example &e) {
    const Vertices &x = e.cell.reference;
    const Matrix m = e.matrix(l2_product(""), 1, 1);
    const double exact =
        integral(e.dim, x, [&](const Eigen::Vector3d &y) { return e.eta(y) * e.eta(y); });
    const Vector eta = interpolate(e.eta, e.dim, 1, x);
    EXPECT_NEAR(eta.dot(m * eta), exact, 1e-13);
    EXPECT_EQ(m, m.transpose());
  });
}

TEST(FunctionLoad, TestsWithTheHatsOfTheVertices) {
  for_examples([](const Example &e) { // its rule is exact to degree 5
    const Vertices &x = e.cell.mapped;
    const auto psi = [&](const FullMu &, const Point &y) {
      return e.u(Eigen::Vector3d(y.data())) * e.v(Eigen::Vector3d(y.data()));
    };
    const Vector eta = interpolate(e.eta, e.dim, 1, x);
    const double exact =
        integral(e.dim, x, [&](const Eigen::Vector3d &y) { return e.u(y) * e.v(y) * e.eta(y); });
    EXPECT_NEAR(e.vector(function_load("", -1, psi), 1).dot(eta), -exact, 1e-13);
    Vector at_vertices = e.vector(constant_load("", 1), 1);
    for (Index i = 0; i < at_vertices.size(); ++i)
      at_vertices[i] *= psi({}, x[i]);
    EXPECT_LT((e.vector(function_load("", 1, psi, true), 1) - at_vertices).norm(), 1e-13);
  });
}

TEST(ScalarForms, RefuseOtherDegrees) {
  for (int degree : {0, 3}) {
    EXPECT_THROW(laplace("", degree), Error);
    EXPECT_THROW(constant_load("", 1, degree), Error);
    EXPECT_THROW(hat_coupling("", 1, degree, true), Error);
  }
}

} // namespace
} // namespace rbvi::scalar_forms_test
