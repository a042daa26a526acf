// Facets of simplices and the forms on them: Gauss's theorem, and closed forms of polynomials.
#include "rbvi/element/facet_forms.hpp"

#include "cells.hpp"
#include "rbvi/element/facets.hpp"
#include "rbvi/element/quadrature.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::facet_forms_test {
namespace {

Cell cell_of(int dim, const Vertices &x) {
  return {dim, x, x};
}

const auto cases = ::testing::Combine(::testing::Values(2, 3), ::testing::Values(1, 2));

class Facets : public ::testing::TestWithParam<std::tuple<int, int>> {
protected:
  int dim = std::get<0>(GetParam()), degree = std::get<1>(GetParam());
  Random random{17};
  Cell cell = cell_of(dim, random_cell(dim, random));
};
INSTANTIATE_TEST_SUITE_P(Degrees, Facets, cases);

TEST_P(Facets, AreSeenOutwardsAndKeepTheOrientation) {
  const double volume = simplex(dim, cell.mapped).volume;
  for (int facet = 0; facet <= dim; ++facet) {
    const Cell turned = facet_cell(cell, facet);
    EXPECT_NEAR(simplex(dim, turned.mapped).volume, volume, 1e-14);
    const auto [size, n] = facet_measure(dim, turned.mapped);
    const Point &a = turned.mapped[0], &opposite = turned.mapped[dim];
    double height = 0;
    for (std::size_t c = 0; c < 3; ++c)
      height += n[c] * (a[c] - opposite[c]);
    EXPECT_NEAR(size * height / dim, volume, 1e-14);
  }
}

/// int over the surface of phi_i n_c = int of d phi_i / d x_c, node by node: facets have the nodes
/// that they say, and together the whole surface.
TEST_P(Facets, GaussTheoremHoldsForEveryNode) {
  const int nodes = nodes_per_cell(dim, degree);
  const Form form = traction_load(
      "", [](const FullMu &, const Point &, const Point &n) { return n; }, dim, degree);
  Matrix surface = Matrix::Zero(nodes, dim), inside = Matrix::Zero(nodes, dim);
  for (int facet = 0; facet <= dim; ++facet) {
    const std::vector<int> own = facet_nodes(dim, degree, facet);
    ASSERT_EQ(std::ssize(own), nodes_per_cell(dim - 1, degree));
    std::vector<double> values(own.size() * static_cast<std::size_t>(dim));
    form.kernel({}, facet_cell(cell, facet), values.data());
    for (std::size_t i = 0; i < own.size(); ++i)
      for (int c = 0; c < dim; ++c)
        surface(own[i], c) +=
            values[i * static_cast<std::size_t>(dim) + static_cast<std::size_t>(c)];
  }
  const Simplex s = simplex(dim, cell.mapped);
  std::vector<std::array<double, 3>> gradients(nodes);
  for (const QuadraturePoint &q : simplex_quadrature(dim, 2)) {
    lagrange_gradients(dim, degree, q.barycentric, s, gradients);
    for (int i = 0; i < nodes; ++i)
      for (int c = 0; c < dim; ++c)
        inside(i, c) += q.weight * s.volume * gradients[i][c];
  }
  EXPECT_LE((surface - inside).norm(), 1e-14 * surface.norm());
}

/// The work of the traction (1 + x_1^3) e_1 on all facets is that of its divergence.
TEST_P(Facets, CubicTractionsAreExact) {
  const Form form = traction_load(
      "",
      [](const FullMu &, const Point &x, const Point &n) -> Point {
        return {n[0] * (1 + x[0] * x[0] * x[0]), 0, 0};
      },
      dim, degree);
  double surface = 0, inside = 0;
  for (int facet = 0; facet <= dim; ++facet) {
    std::vector<double> values(30);
    form.kernel({}, facet_cell(cell, facet), values.data());
    for (std::size_t i = 0; i < facet_nodes(dim, degree, facet).size(); ++i)
      surface += values[i * static_cast<std::size_t>(dim)];
  }
  for (const QuadraturePoint &q : simplex_quadrature(dim, 2)) {
    double x = 0;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(dim); ++i)
      x += q.barycentric[i] * cell.mapped[i][0];
    inside += q.weight * simplex(dim, cell.mapped).volume * 3 * x * x;
  }
  EXPECT_NEAR(surface, inside, 1e-13);
}

TEST_P(Facets, APressurePushes) {
  const Form form = pressure_load("", 3, dim, degree);
  const auto [size, n] = facet_measure(dim, cell.mapped);
  std::vector<double> values(30);
  form.kernel({}, cell, values.data());
  const auto nodes = facet_nodes(dim, degree, 0).size();
  for (std::size_t c = 0; c < static_cast<std::size_t>(dim); ++c) {
    double force = 0;
    for (std::size_t i = 0; i < nodes; ++i)
      force += values[i * static_cast<std::size_t>(dim) + c];
    EXPECT_NEAR(force, -3 * size * n[c], 1e-14);
  }
}

/// int phi_i over a facet: shares of the vertices and of the middles of Simpson's rule and of its
/// kin on triangles.
TEST_P(Facets, SpringsAreTheMassOfAFacet) {
  const Form form = spring("", 2, dim, degree);
  const std::size_t nodes = facet_nodes(dim, degree, 0).size(),
                    stride = nodes * static_cast<std::size_t>(dim);
  std::vector<double> values(stride * stride);
  form.kernel({}, cell, values.data());
  const Matrix m = Eigen::Map<const Matrix>(values.data(), static_cast<Index>(stride),
                                            static_cast<Index>(stride));
  EXPECT_LE((m - m.transpose()).norm(), 1e-15);
  const double vertex = degree == 1 ? 1.0 / dim : (dim == 2 ? 1.0 / 6 : 0.0);
  const double middle = dim == 2 ? 4.0 / 6 : 1.0 / 3;
  const double size = facet_measure(dim, cell.mapped).size;
  for (Index i = 0; i < m.rows(); ++i) {
    double sum = 0; // over the nodes, of one component
    for (Index j = i % dim; j < m.cols(); j += dim)
      sum += m(i, j);
    EXPECT_NEAR(sum, 2 * size * (i < Index{dim} * dim ? vertex : middle), 1e-14);
    EXPECT_NEAR(m.row(i).sum(), sum, 1e-14) << "components are not coupled";
  }
}

} // namespace
} // namespace rbvi::facet_forms_test
