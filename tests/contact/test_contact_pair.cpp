// Contact operators of two curves: against brute force, by balance of forces and exactness, and
// where meshes coincide, slide past each other or overlap in part.
#include "../couple.hpp"
#include "../linear_algebra.hpp"
#include "curves.hpp"
#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rbvi::contact_pair_test {
namespace {

constexpr auto lac = MultiplierSpace::macro_edges;
constexpr auto nodes = MultiplierSpace::nodes;
constexpr auto exact = PairQuadrature::intersection;
constexpr auto direct = PairQuadrature::direct;

/// Values of the multipliers at the point of slave edge `edge` with those hats.
Vector multipliers(MultiplierSpace space, Index edge, const Vector &slave_hats) {
  if (space == nodes) return slave_hats;
  const Index count = multiplier_count(slave_hats.size(), lac);
  return Vector::Unit(count, std::min(edge / 2, count - 1));
}

struct Dense {
  Matrix b;
  Vector g, weights;
};

/// Sums over `rule` on [0, 1] (abscissa, weight), applied between successive cuts of the slave.
Dense brute_force(const Curve &slave, const Curve &master, MultiplierSpace space,
                  std::vector<double> cuts, const std::vector<std::array<double, 2>> &rule) {
  const Index count = multiplier_count(size(slave), space);
  Dense sum{Matrix::Zero(count, size(slave) + size(master)), Vector::Zero(count),
            Vector::Zero(count)};
  std::ranges::sort(cuts);
  for (Index edge = 0; edge + 1 < size(slave); ++edge)
    for (std::size_t cut = 0; cut + 1 < cuts.size(); ++cut)
      for (const auto &[at, weight] : rule) {
        const auto e = static_cast<std::size_t>(edge);
        const double x = cuts[cut] + at * (cuts[cut + 1] - cuts[cut]);
        if (x < slave[e][0] || x >= slave[e + 1][0]) continue;
        const Vector on_slave = hats(slave, x), on_master = hats(master, x);
        if (on_master.sum() == 0) continue;
        const Vector eta = multipliers(space, edge, on_slave) * weight *
                           (cuts[cut + 1] - cuts[cut]) * length(slave, edge) /
                           (slave[e + 1][0] - slave[e][0]);
        sum.b.leftCols(size(slave)) -= eta * on_slave.transpose();
        sum.b.rightCols(size(master)) += eta * on_master.transpose();
        sum.g += eta * (on_slave.dot(heights(slave)) - on_master.dot(heights(master)));
        sum.weights += eta;
      }
  return sum;
}

std::vector<double> abscissae(const Curve &curve) {
  std::vector<double> x;
  for (const Point &p : curve)
    x.push_back(p[0]);
  return x;
}

Dense brute_force(const Curve &slave, const Curve &master, const PairDiscretisation &with) {
  std::vector<double> cuts = abscissae(slave);
  if (with.quadrature == direct)
    return brute_force(slave, master, with.multiplier, cuts,
                       {{0.5 - std::sqrt(1.0 / 12), 0.5}, {0.5 + std::sqrt(1.0 / 12), 0.5}});
  for (const Point &p : master)
    cuts.push_back(p[0]);
  const double a = std::sqrt(5 - 2 * std::sqrt(10.0 / 7)) / 6,
               b = std::sqrt(5 + 2 * std::sqrt(10.0 / 7)) / 6;
  const double wa = (322 + 13 * std::sqrt(70.0)) / 1800, wb = (322 - 13 * std::sqrt(70.0)) / 1800;
  return brute_force(
      slave, master, with.multiplier, cuts,
      {{0.5 - b, wb}, {0.5 - a, wa}, {0.5, 64.0 / 225}, {0.5 + a, wa}, {0.5 + b, wb}});
}

const std::vector<PairDiscretisation> all{
    {lac, exact}, {nodes, exact}, {lac, direct}, {nodes, direct}};

void expect_equal(const PairOperators &got, const Dense &expected, double tolerance) {
  ASSERT_EQ(got.b.rows(), expected.b.rows());
  ASSERT_EQ(got.b.cols(), expected.b.cols());
  EXPECT_LT((Matrix(got.b) - expected.b).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_LT((got.g - expected.g).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_LT((got.weights - expected.weights).cwiseAbs().maxCoeff(), tolerance);
}

TEST(Couple, AgreesWithBruteForceOnRandomCurves) {
  Random random(1);
  for (const Index slave_edges : {1, 2, 3, 8, 13})
    for (const Index master_edges : {1, 2, 7, 40})
      for (const auto &[begin, end] :
           {std::array{0.0, 1.0}, std::array{-0.2, 1.3}, std::array{0.25, 0.6},
            std::array{-0.5, 0.4}, std::array{0.7, 1.9}, std::array{1.5, 2.0}}) {
        const Curve slave = random_curve(random, slave_edges, 0, 1, 0.5);
        const Curve master = random_curve(random, master_edges, begin, end, 0);
        for (const PairDiscretisation &with : all) {
          const PairOperators pair = couple(slave, master, with);
          expect_equal(pair, brute_force(slave, master, with), 1e-14);
          expect_sorted(pair.b);
          expect_sorted(pair.nodal_b);
          EXPECT_LT((pair.b * Vector::Ones(pair.b.cols())).cwiseAbs().maxCoeff(), 1e-15)
              << "balance of forces";
        }
      }
}

TEST(Couple, AgreesWithARiemannSum) {
  Random random(2);
  const Curve slave = random_curve(random, 5, 0, 1, 0.5),
              master = random_curve(random, 4, 0.1, 1.2, 0);
  std::vector<double> cuts;
  for (int i = 0; i <= 20000; ++i)
    cuts.push_back(i / 20000.0);
  for (const MultiplierSpace space : {lac, nodes})
    expect_equal(couple(slave, master, {space, exact}),
                 brute_force(slave, master, space, cuts, {{0.5, 1.0}}), 2e-4);
}

TEST(Couple, DirectQuadratureConvergesToTheIntersection) {
  Random random(3);
  const Curve master = random_curve(random, 6, -0.1, 1.1, 0);
  for (const MultiplierSpace space : {lac, nodes}) {
    const Curve slave = line(400, 0, 1, 0.5);
    const PairOperators a = couple(slave, master, {space, exact}),
                        b = couple(slave, master, {space, direct});
    const double worst = Matrix(a.b - b.b).cwiseAbs().maxCoeff();
    EXPECT_LT(worst, 1e-2 / 400);
    EXPECT_GT(worst, 1e-8);
  }
}

TEST(Couple, WeightsSumToThePairedLengthAndLinearFunctionsAreExact) {
  Random random(4);
  const Curve slave = random_curve(random, 9, 0, 1, 0.5),
              master = random_curve(random, 14, -0.1, 1.2, 0);
  Vector linear(size(slave) + size(master)), jump(linear.size());
  Vector moments = Vector::Zero(2); // over the slave curve: of 1, of x
  for (Index i = 0; i < size(slave); ++i)
    linear[i] = 2 - 3 * slave[i][0];
  for (Index i = 0; i < size(master); ++i)
    linear[size(slave) + i] = 2 - 3 * master[i][0];
  jump << Vector::Zero(size(slave)), linear.tail(size(master));
  for (Index e = 0; e + 1 < size(slave); ++e) {
    const auto i = static_cast<std::size_t>(e);
    moments += length(slave, e) * Vector{{1, (slave[i][0] + slave[i + 1][0]) / 2}};
  }
  for (const PairDiscretisation &with : all) {
    const PairOperators pair = couple(slave, master, with);
    EXPECT_NEAR(pair.weights.sum(), length(slave), 1e-14);
    EXPECT_LT((pair.b * linear).cwiseAbs().maxCoeff(), 1e-15) << "equal displacements: no jump";
    EXPECT_NEAR((pair.b * jump).sum(), 2 * moments[0] - 3 * moments[1], 1e-14);
  }
}

TEST(Couple, ConstantPressurePassesThePatchTestByIntersectionOnly) {
  Random random(5);
  Curve slave = random_curve(random, 11, 0, 1, 0), master = random_curve(random, 8, 0, 1, 0);
  for (Point &p : slave)
    p[1] = 0.25;
  for (Point &p : master)
    p[1] = 0;
  Vector forces = Vector::Zero(size(slave) + size(master)); // int N ds of each side
  for (Index e = 0; e + 1 < size(slave); ++e)
    forces.segment(e, 2).array() -= length(slave, e) / 2;
  for (Index e = 0; e + 1 < size(master); ++e)
    forces.segment(size(slave) + e, 2).array() += length(master, e) / 2;
  for (const PairDiscretisation &with : all) {
    const PairOperators pair = couple(slave, master, with);
    const Vector error = pair.b.transpose() * Vector::Ones(pair.b.rows()) - forces;
    EXPECT_NEAR(pair.g.sum(), 0.25, 1e-14);
    if (with.quadrature == exact)
      EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-14);
    else
      EXPECT_GT(error.cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST(Couple, CoincidingMeshesGiveOppositeMassMatrices) {
  Random random(6);
  Curve slave = random_curve(random, 10, 0, 1, 0), master = slave;
  for (const PairQuadrature quadrature : {exact, direct}) {
    const PairOperators pair = couple(slave, master, {nodes, quadrature});
    const Matrix mass = multiplier_product(slave, nodes), b = pair.b;
    EXPECT_LT((b.leftCols(11) + mass).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_LT((b.rightCols(11) - mass).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_LT(pair.g.cwiseAbs().maxCoeff(), 1e-16);
    EXPECT_EQ(pair.paired.size(), 11u);
    EXPECT_LT(pair.nodal_gap.cwiseAbs().maxCoeff(), 1e-16);
  }
}

TEST(Couple, RoundOffInCoincidingNodesDoesNotMatter) {
  Random random(7);
  const Curve slave = random_curve(random, 10, 0, 1, 0.1), master = slave;
  for (const PairDiscretisation &with : all) {
    const PairOperators reference = couple(slave, master, with);
    for (const double size : {1e-16, 1e-15, 3e-15})
      for (int repeat = 0; repeat < 20; ++repeat) {
        Curve a = slave, b = master;
        for (Curve *curve : {&a, &b})
          for (Point &p : *curve)
            p[0] += size * random();
        const PairOperators pair = couple(a, b, with);
        EXPECT_LT(Matrix(pair.b - reference.b).cwiseAbs().maxCoeff(), 1e-13);
        EXPECT_LT((pair.g - reference.g).cwiseAbs().maxCoeff(), 1e-13);
        ASSERT_EQ(pair.paired, reference.paired);
        EXPECT_LT(Matrix(pair.nodal_b - reference.nodal_b).cwiseAbs().maxCoeff(), 1e-12);
      }
  }
}

TEST(Couple, SlidingChangesTheOperatorsContinuously) {
  // Equal spacing: at every multiple of 1/12 all nodes pass one another at once.
  const Curve slave = line(12, 0, 1, 0.3);
  Curve master = line(36, -1, 2, 0);
  for (std::size_t i = 0; i < master.size(); ++i)
    master[i][1] = 0.05 * std::sin(3.0 * static_cast<double>(i));
  for (const PairDiscretisation &with : all)
    for (const double start : {0.0, 1.0 / 12, -0.5, 0.5 / 12, 0.7})
      for (const double delta : {1e-15, 1e-12, 1e-9, 1e-6, 1e-4}) {
        const PairOperators before = couple(slave, moved(master, start - delta), with),
                            after = couple(slave, moved(master, start + delta), with);
        // |db| <= 2 delta |N'| int eta ds = 2 delta * 12 * weight, per node
        EXPECT_LE(Matrix(after.b - before.b).cwiseAbs().maxCoeff(), 4 * delta + 1e-15);
        EXPECT_LE((after.g - before.g).cwiseAbs().maxCoeff(), 4 * delta + 1e-15);
      }
}

TEST(Couple, ExactIntegralsSlideContinuouslyPastTheEnds) {
  const Curve slave = line(6, 0, 1, 0.3), master = line(5, 0, 1, 0);
  for (const MultiplierSpace space : {lac, nodes})
    for (const double start : {0.0, 1.0 / 6, -0.5, 0.9, 1.0, -1.0})
      for (const double delta : {1e-15, 1e-12, 1e-8, 1e-5}) {
        const PairOperators before = couple(slave, moved(master, start - delta), {space, exact}),
                            after = couple(slave, moved(master, start + delta), {space, exact});
        EXPECT_LE(Matrix(after.b - before.b).cwiseAbs().maxCoeff(), 5 * delta + 1e-14);
        EXPECT_LE((after.weights - before.weights).cwiseAbs().maxCoeff(), 5 * delta + 1e-14);
      }
}

TEST(Couple, PartialOverlapCountsThePairedPartOnly) {
  const Curve slave = line(8, 0, 1, 0.3);
  const Curve shorter = line(5, 0.3, 0.8, 0), longer = line(7, -0.4, 1.4, 0);
  for (const MultiplierSpace space : {lac, nodes}) {
    const PairOperators inside = couple(slave, shorter, {space, exact});
    EXPECT_NEAR(inside.weights.sum(), 0.5, 1e-15);
    EXPECT_EQ(inside.paired, (std::vector<Index>{3, 4, 5, 6})); // x = 3/8, ..., 6/8
    const PairOperators outside = couple(slave, longer, {space, exact});
    EXPECT_NEAR(outside.weights.sum(), 1, 1e-15);
    EXPECT_EQ(outside.paired.size(), 9u);
  }
  const PairOperators left = couple(slave, line(3, -1, 0.6, 0), {lac, exact});
  EXPECT_LT((left.weights - Vector{{0.25, 0.25, 0.1, 0}}).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_EQ(left.b.innerVector(3).nonZeros(), 0) << "no partner, no entries";
  const PairOperators right = couple(slave, line(3, 0.6, 2, 0), {lac, direct});
  EXPECT_EQ(right.weights[0], 0);
  EXPECT_EQ(right.paired, (std::vector<Index>{5, 6, 7, 8}));
}

TEST(Couple, CurvesApartHaveNoEntries) {
  const Curve slave = line(4, 0, 1, 0.3);
  for (const PairDiscretisation &with : all)
    for (const double shift : {-5.0, -1.5, 1.5, 5.0}) {
      const PairOperators pair = couple(slave, moved(slave, shift), with);
      EXPECT_EQ(pair.b.rows(), multiplier_count(5, with.multiplier));
      EXPECT_EQ(pair.b.cols(), 10);
      EXPECT_EQ(pair.b.nonZeros(), 0);
      EXPECT_EQ(pair.weights, Vector::Zero(pair.b.rows()));
      EXPECT_EQ(pair.g, Vector::Zero(pair.b.rows()));
      EXPECT_TRUE(pair.paired.empty());
      EXPECT_EQ(pair.nodal_b.rows(), 0);
      EXPECT_EQ(pair.nodal_b.cols(), 10);
      EXPECT_EQ(pair.nodal_gap.size(), 0);
    }
}

TEST(Couple, NodalConstraintsInterpolateTheMaster) {
  Random random(8);
  const Curve slave = random_curve(random, 9, 0, 1, 0.5),
              master = random_curve(random, 6, 0.2, 0.9, 0);
  const PairOperators pair = couple(slave, master, {});
  ASSERT_EQ(pair.nodal_b.rows(), static_cast<Index>(pair.paired.size()));
  std::vector<Index> expected;
  for (Index node = 0; node < size(slave); ++node) {
    const Vector at = hats(master, slave[node][0]);
    if (at.sum() == 0) continue;
    const auto row = static_cast<Index>(expected.size());
    expected.push_back(node);
    ASSERT_LT(row, pair.nodal_b.rows());
    Vector constraint(size(slave) + size(master));
    constraint << -Vector::Unit(size(slave), node), at;
    EXPECT_LT((Matrix(pair.nodal_b).row(row).transpose() - constraint).norm(), 1e-14);
    EXPECT_NEAR(pair.nodal_gap[row], slave[node][1] - at.dot(heights(master)), 1e-14);
  }
  EXPECT_EQ(pair.paired, expected);
}

TEST(Multipliers, MacroEdgesTakeTwoEdgesAndTheLastAThirdIfOdd) {
  EXPECT_EQ(multiplier_count(2, lac), 1);
  EXPECT_EQ(multiplier_count(3, lac), 1);
  EXPECT_EQ(multiplier_count(4, lac), 1);
  EXPECT_EQ(multiplier_count(5, lac), 2);
  EXPECT_EQ(multiplier_count(6, lac), 2);
  EXPECT_EQ(multiplier_count(561, lac), 280);
  EXPECT_EQ(multiplier_count(561, nodes), 561);
  const Curve odd = line(5, 0, 5, 0);
  // Where vertices of the master are along the slave is found to round-off.
  EXPECT_LT((couple(odd, odd, {lac, exact}).weights - Vector{{2, 3}}).norm(), 1e-14);
  const Curve one = line(1, 0, 3, 0);
  EXPECT_NEAR(couple(one, odd, {lac, exact}).weights[0], 3, 1e-14);
  EXPECT_NEAR(couple(one, one, {nodes, direct}).weights[1], 1.5, 1e-15);
}

TEST(Multipliers, ProductIsTheGramMatrix) {
  Random random(9);
  for (const Index edges : {1, 2, 3, 6, 7}) {
    const Curve slave = random_curve(random, edges, 0, 1, 0.5);
    for (const MultiplierSpace space : {lac, nodes}) {
      const SparseMatrix product = multiplier_product(slave, space);
      const Index count = multiplier_count(size(slave), space);
      ASSERT_EQ(product.rows(), count);
      EXPECT_EQ(product.nonZeros(), 3 * count - 2) << "neighbours";
      expect_sorted(product);
      const Matrix dense = product;
      EXPECT_EQ(dense, dense.transpose());
      EXPECT_NEAR(dense.sum(), length(slave), 1e-14);
      EXPECT_GT(symmetric_eigenvalues(dense)[0], 0);
      EXPECT_EQ(dense.isDiagonal(0), space == lac);
      const PairOperators self = couple(slave, slave, {space, exact});
      EXPECT_LT((dense.rowwise().sum() - self.weights).norm(), 1e-14);
    }
  }
}

TEST(Multipliers, AreDrawnAtTheMiddleOfTheirMacroEdge) {
  const Curve corner{{0, 1, 0}, {3, 5, 0}, {6, 1, 0}, {7, 1, 0}, {9, 1, 0}, {10, 1, 0}};
  const Curve points = multiplier_points(corner, lac); // edges of length 5, 5 | 1, 2, 1
  ASSERT_EQ(points.size(), 2u);
  EXPECT_NEAR(points[0][0], 3, 1e-15);
  EXPECT_NEAR(points[0][1], 5, 1e-15);
  EXPECT_NEAR(points[1][0], 8, 1e-15);
  EXPECT_EQ(multiplier_points(corner, nodes), corner);
  EXPECT_NEAR(multiplier_points(line(1, 0, 3, 0), lac)[0][0], 1.5, 1e-15);
}

std::string message(const Curve &slave, const Curve &master) {
  try {
    couple(slave, master, {});
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    return error.what();
  }
  return "";
}

TEST(Couple, RefusesCurvesThatAreNotGraphs) {
  const Curve good = line(4, 0, 1, 0);
  Curve folded = good, vertical = good, undefined = good;
  std::swap(folded[2], folded[3]);
  vertical[2][0] = vertical[1][0];
  undefined[4][0] = std::nan("");
  EXPECT_NE(message(folded, good).find("slave curve, but node 3"), std::string::npos);
  EXPECT_NE(message(good, vertical).find("master curve, but node 2"), std::string::npos);
  EXPECT_NE(message(good, undefined).find("node 4"), std::string::npos);
  EXPECT_NE(message(good, {good[0]}).find("master"), std::string::npos);
  EXPECT_NE(message({}, good).find("slave"), std::string::npos);
  EXPECT_THROW(multiplier_product(folded, nodes), Error);
  EXPECT_THROW(multiplier_points(folded, lac), Error);
}

TEST(MacroEdges, HoldTwoEdgesEachAndTheLastAThirdIfTheirNumberIsOdd) {
  for (const Index count : {2, 3, 4, 9, 10}) {
    std::vector<Index> edges(
        static_cast<std::size_t>(multiplier_count(count, MultiplierSpace::macro_edges)), 0);
    for (Index edge = 0; edge + 1 < count; ++edge)
      ++edges[macro_edge_of(edge, count)];
    for (std::size_t i = 0; i < edges.size(); ++i)
      EXPECT_EQ(edges[i], i + 1 < edges.size() ? 2 : count - 1 - 2 * Index(i)) << count;
  }
}

} // namespace
} // namespace rbvi::contact_pair_test
