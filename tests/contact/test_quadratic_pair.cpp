// Contact operators of two curves of degree 2: against analytic parabolas and quadratic
// displacements, the operators of degree 1 on the same vertices, and by balance of forces.
#include "../couple.hpp"
#include "curves.hpp"
#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace rbvi::quadratic_pair_test {
namespace {

using Function = std::function<double(double)>;
constexpr auto lac = MultiplierSpace::macro_edges;
constexpr auto vertices = MultiplierSpace::nodes;
constexpr auto exact = PairQuadrature::intersection;

/// The vertices of a polygon, then of each edge the point at a part of it between 0.3 and 0.7; all
/// of them at a height.
Curve quadratic(const Curve &polygon, const Function &height, Random &random) {
  Curve curve = polygon;
  for (std::size_t e = 0; e + 1 < polygon.size(); ++e) {
    const double s = 0.5 + 0.2 * random();
    curve.push_back({(1 - s) * polygon[e][0] + s * polygon[e + 1][0], 0, 0});
  }
  for (Point &p : curve)
    p[1] = height(p[0]);
  return curve;
}

/// Values of a function at the nodes of the displacement: the vertices, the middles of the chords.
Vector at_nodes(const Curve &curve, const Function &f) {
  const std::size_t edges = (curve.size() - 1) / 2;
  Vector values(size(curve));
  for (std::size_t v = 0; v <= edges; ++v)
    values[static_cast<Index>(v)] = f(curve[v][0]);
  for (std::size_t e = 0; e < edges; ++e)
    values[static_cast<Index>(edges + 1 + e)] = f((curve[e][0] + curve[e + 1][0]) / 2);
  return values;
}

Vector side_by_side(const Vector &a, const Vector &b) {
  Vector both(a.size() + b.size());
  both << a, b;
  return both;
}

/// int f eta ds over the chords of the slave curve, by three Gauss points on each: f a polynomial
/// of degree 4 or less.
Vector moments(const Curve &slave, MultiplierSpace space, const Function &f) {
  const Index edges = (size(slave) - 1) / 2;
  Vector sum = Vector::Zero(multiplier_count(size(slave), space, 2));
  for (Index e = 0; e < edges; ++e)
    for (const auto &[s, weight] :
         {std::array{0.5 - std::sqrt(0.15), 5.0 / 18}, std::array{0.5, 4.0 / 9},
          std::array{0.5 + std::sqrt(0.15), 5.0 / 18}}) {
      const auto i = static_cast<std::size_t>(e);
      const double at = weight * length(slave, e) * f((1 - s) * slave[i][0] + s * slave[i + 1][0]);
      if (space == lac) {
        sum[e] += at;
      } else {
        sum[e] += (1 - s) * at;
        sum[e + 1] += s * at;
      }
    }
  return sum;
}

double upper(double x) {
  return 0.5 + 0.3 * x - 0.7 * x * x;
}
double lower(double x) {
  return 0.1 - 0.2 * x + 0.4 * x * x;
}

struct Parabolas {
  Random random{11};
  Curve slave = quadratic(random_curve(random, 7, 0, 1, 0), upper, random),
        master = quadratic(random_curve(random, 5, -0.1, 1.2, 0), lower, random);
};

TEST(QuadraticPair, GapAndJumpOfQuadraticsAreExact) {
  const Parabolas curves;
  const Function on_slave = [](double x) { return 1 - 2 * x + 3 * x * x; },
                 on_master = [](double x) { return 0.5 + x - 1.5 * x * x; };
  const Vector displacement =
      side_by_side(at_nodes(curves.slave, on_slave), at_nodes(curves.master, on_master));
  for (const MultiplierSpace space : {lac, vertices}) {
    const PairOperators pair = couple(curves.slave, curves.master, {space, exact}, 2);
    ASSERT_EQ(pair.b.cols(), displacement.size());
    expect_sorted(pair.b);
    expect_sorted(pair.nodal_b);
    const Vector gap = moments(curves.slave, space, [](double x) { return upper(x) - lower(x); });
    const Vector jump =
        moments(curves.slave, space, [&](double x) { return on_master(x) - on_slave(x); });
    EXPECT_LT((pair.g - gap).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT((pair.b * displacement - jump).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT((pair.b * Vector::Ones(pair.b.cols())).cwiseAbs().maxCoeff(), 1e-15) << "balance";
    EXPECT_LT((pair.weights - moments(curves.slave, space, [](double) { return 1; })).norm(),
              1e-15);
  }
}

TEST(QuadraticPair, VerticesMeetTheMastersParabola) {
  const Parabolas curves;
  const PairOperators pair = couple(curves.slave, curves.master, {lac, exact}, 2);
  ASSERT_EQ(pair.paired.size(), 8u) << "vertices alone";
  const Function on_master = [](double x) { return 2 * x * x; };
  const Vector displacement = side_by_side(Vector::Zero(size(curves.slave)),
                                           at_nodes(curves.master, on_master)),
               seen = pair.nodal_b * displacement;
  for (Index i = 0; i < 8; ++i) {
    EXPECT_EQ(pair.paired[i], i);
    const double x = curves.slave[i][0];
    EXPECT_NEAR(pair.nodal_gap[i], upper(x) - lower(x), 1e-15);
    EXPECT_NEAR(seen[i], on_master(x), 1e-14);
  }
}

/// With every middle on its chord, and displacements that are linear on each edge.
TEST(QuadraticPair, StraightEdgesGiveTheOperatorsOfDegreeOne) {
  Random random(12);
  const Curve slave = random_curve(random, 6, 0, 1, 0.5),
              master = random_curve(random, 9, 0.1, 0.8, 0);
  const auto with_middles = [](const Curve &polygon) {
    Curve curve = polygon;
    for (std::size_t e = 0; e + 1 < polygon.size(); ++e)
      curve.push_back(
          {(polygon[e][0] + polygon[e + 1][0]) / 2, (polygon[e][1] + polygon[e + 1][1]) / 2, 0});
    return curve;
  };
  const auto linear = [](const Curve &polygon, Index first, const Vector &u) {
    Vector values(2 * size(polygon) - 1);
    values.head(size(polygon)) = u.segment(first, size(polygon));
    for (Index e = 0; e + 1 < size(polygon); ++e)
      values[size(polygon) + e] = (u[first + e] + u[first + e + 1]) / 2;
    return values;
  };
  const Vector u = random.vector(size(slave) + size(master));
  const Vector v = side_by_side(linear(slave, 0, u), linear(master, size(slave), u));
  for (const PairQuadrature rule : {exact, PairQuadrature::direct}) {
    const PairOperators one = couple(slave, master, {vertices, rule}),
                        two =
                            couple(with_middles(slave), with_middles(master), {vertices, rule}, 2);
    EXPECT_LT((one.g - two.g).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_LT((one.weights - two.weights).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_LT((one.b * u - two.b * v).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_EQ(one.paired, two.paired);
    // Partners are found to round-off.
    EXPECT_LT((one.nodal_b * u - two.nodal_b * v).cwiseAbs().maxCoeff(), 2e-15);
    EXPECT_LT((one.nodal_gap - two.nodal_gap).cwiseAbs().maxCoeff(), 1e-15);
  }
}

TEST(QuadraticPair, ConstantPressureGivesTheForcesOfBothSides) {
  Random random(13);
  const auto flat = [](double) { return 0.0; };
  const Curve slave = quadratic(random_curve(random, 7, 0, 1, 0), flat, random),
              master = quadratic(random_curve(random, 10, 0, 1, 0), flat, random);
  const auto forces = [](const Curve &curve) {
    const Index edges = (size(curve) - 1) / 2;
    Vector sum = Vector::Zero(size(curve));
    for (Index e = 0; e < edges; ++e) {
      sum.segment<2>(e).array() += length(curve, e) / 6;
      sum[edges + 1 + e] += length(curve, e) * 2 / 3;
    }
    return sum;
  };
  const Vector expected = side_by_side(-forces(slave), forces(master));
  for (const MultiplierSpace space : {lac, vertices}) {
    const PairOperators pair = couple(slave, master, {space, exact}, 2);
    EXPECT_LT((pair.b.transpose() * Vector::Ones(pair.b.rows()) - expected).cwiseAbs().maxCoeff(),
              1e-15);
  }
}

TEST(QuadraticPair, AMacroEdgeIsOneEdge) {
  EXPECT_EQ(multiplier_count(9, lac, 2), 4);
  EXPECT_EQ(multiplier_count(3, lac, 2), 1);
  EXPECT_EQ(multiplier_count(9, vertices, 2), 5);
  for (Index edge = 0; edge < 4; ++edge)
    EXPECT_EQ(macro_edge_of(edge, 9, 2), edge);
  const Parabolas curves;
  const Curve polygon(curves.slave.begin(), curves.slave.begin() + 8);
  EXPECT_EQ(Matrix(multiplier_product(curves.slave, vertices, 2)),
            Matrix(multiplier_product(polygon, vertices)));
  EXPECT_EQ(multiplier_points(curves.slave, vertices, 2), polygon);
  const SparseMatrix product = multiplier_product(curves.slave, lac, 2);
  const Curve drawn = multiplier_points(curves.slave, lac, 2);
  ASSERT_EQ(drawn.size(), 7u);
  for (Index e = 0; e < 7; ++e) {
    const auto i = static_cast<std::size_t>(e);
    EXPECT_DOUBLE_EQ(product.coeff(e, e), length(polygon, e));
    EXPECT_NEAR(drawn[i][0], (polygon[i][0] + polygon[i + 1][0]) / 2, 1e-15);
    EXPECT_NEAR(drawn[i][1], upper(drawn[i][0]), 1e-14);
  }
}

std::string message(const Curve &slave, int degree) {
  try {
    couple(slave, {{-1, 0, 0}, {3, 0, 0}, {1, 0, 0}}, {}, degree);
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    return error.what();
  }
  return "";
}

TEST(QuadraticPair, RefusesNodesThatDoNotFit) {
  const Curve good{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0.5, 0, 0}, {1.5, 0, 0}};
  EXPECT_EQ(message(good, 2), "");
  const Curve even(good.begin(), good.begin() + 4);
  EXPECT_NE(message(even, 2).find("odd number of nodes, at least 3, not 4"), std::string::npos);
  EXPECT_NE(message({good[0]}, 2).find("at least 3, not 1"), std::string::npos);
  Curve outside = good;
  outside[3][0] = 1.2;
  EXPECT_NE(message(outside, 2).find("node 1 at x = 1 follows x = 1.2"), std::string::npos);
  outside[3][0] = -0.2;
  EXPECT_NE(message(outside, 2).find("node 3 at x = -0.2 follows x = 0"), std::string::npos);
  EXPECT_NE(message(good, 3).find("degree"), std::string::npos);
}

} // namespace
} // namespace rbvi::quadratic_pair_test
