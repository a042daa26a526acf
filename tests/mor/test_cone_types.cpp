#include "../linear_algebra.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/mor/cones.hpp"

#include "multipliers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace rbvi::cone_types_test {
using namespace rbvi::testing_multipliers;

namespace {

/// (cos, sin) of the angles, in degrees, times the lengths.
Matrix plane_vectors(const Vector &angles, const Vector &lengths) {
  const auto radians = angles.array() * std::numbers::pi / 180;
  Matrix result(2, angles.size());
  result << (radians.cos() * lengths.array()).transpose(),
      (radians.sin() * lengths.array()).transpose();
  return result;
}

SparseMatrix lumped(const SparseMatrix &product) {
  return sparse(Vector(product * Vector::Ones(product.cols())).asDiagonal());
}

/// Objective of the factorisation with the best coefficients for these generators, relative to the
/// largest squared norm of a snapshot.
double objective(const Matrix &snapshots, const ConeBasis &basis, const SparseMatrix &product) {
  return distances_to_cone(snapshots, basis, lumped(product)).squaredNorm();
}

Matrix random_nonnegative(Index rows, Index columns, double zeros, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  return Matrix::NullaryExpr(rows, columns, [&] {
    const double value = uniform(engine);
    return uniform(engine) < zeros ? 0.0 : value;
  });
}

Cone build(ConeType type, const Matrix &snapshots, const SparseMatrix &product, double tolerance,
           int max_size = 0) {
  return build_cone(snapshots, product,
                    {.type = type, .tolerance = tolerance, .max_size = max_size});
}

} // namespace

TEST(ConeTypes, NamesAreInTheOrderOfTheType) {
  const auto &names = cone_type_names();
  ASSERT_EQ(names.size(), 6u);
  const auto name = [&](ConeType type) { return names[static_cast<std::size_t>(type)]; };
  EXPECT_EQ(name(ConeType::cpg), "cpg");
  EXPECT_EQ(name(ConeType::mcpg), "mcpg");
  EXPECT_EQ(name(ConeType::angle_greedy), "angle_greedy");
  EXPECT_EQ(name(ConeType::nmf), "nmf");
  EXPECT_EQ(name(ConeType::nodal), "nodal");
  EXPECT_EQ(name(ConeType::hybrid), "hybrid");
}

TEST(ConeTypes, AllIsGeneratorsThenModes) {
  Cone cone{{Matrix{{1, 2}, {3, 4}}}, {}, {}};
  EXPECT_EQ(cone.all(), cone.basis.generators);
  cone.modes.columns = Matrix{{5}, {6}};
  EXPECT_EQ(cone.all(), (Matrix{{1, 2, 5}, {3, 4, 6}}));
  EXPECT_EQ(cone.size(), 3);
}

TEST(ConeTypes, EveryTypeKeepsItsPromises) {
  const SparseMatrix product = grid_mass(13);
  const Matrix snapshots = moving_bumps(13, 3, 0.08);
  const Matrix copy = snapshots;
  for (const ConeType type :
       {ConeType::cpg, ConeType::mcpg, ConeType::angle_greedy, ConeType::nmf, ConeType::nodal}) {
    SCOPED_TRACE(cone_type_names()[static_cast<std::size_t>(type)]);
    const Cone cone = build(type, snapshots, product, 2e-2);
    const Matrix &generators = cone.basis.generators;
    EXPECT_EQ(snapshots, copy);
    EXPECT_EQ(cone.modes.columns.cols(), 0);
    EXPECT_GE(generators.minCoeff(), 0);
    for (const auto &column : generators.colwise())
      EXPECT_NEAR(norm(column, product), 1, 1e-12);
    const ConeHistory &history = cone.history;
    ASSERT_EQ(history.error.size(), history.size.size());
    ASSERT_EQ(history.gram_condition.size() + 1, history.size.size());
    EXPECT_EQ(history.size.front(), 0);
    EXPECT_EQ(history.error.front(), 1);
    EXPECT_TRUE(std::is_sorted(history.size.begin(), history.size.end()));
    EXPECT_EQ(history.size.back(), generators.cols());
    EXPECT_NEAR(largest_distance(snapshots, cone.basis, product), history.error.back(), 1e-12);
    const Matrix gram = generators.transpose() * (product * generators);
    const Vector eigenvalues = symmetric_eigenvalues(gram);
    // The eigenvalues of the Gram matrix carry the condition number times round-off.
    const double condition = history.gram_condition.back();
    EXPECT_NEAR(condition * eigenvalues.minCoeff() / eigenvalues.maxCoeff(), 1,
                1e-14 * condition + 1e-10);
    EXPECT_EQ(history.reason, type == ConeType::nodal ? "round-off reached" : "tolerance reached");
  }
}

TEST(ConeAngleGreedy, ExactExampleInThePlane) {
  // At 20 degrees the longest, at 90 the largest angle with it; those at 0 and 60 are in the span
  // of both, but the first is outside their cone: sin 20 from it.
  const Matrix snapshots = plane_vectors(Vector{{0, 20, 60, 90}}, Vector{{1, 3, 2, 0.1}});
  const Cone cone = build(ConeType::angle_greedy, snapshots, identity(2), 1e-9);
  EXPECT_EQ(cone.history.selected, (std::vector<int>{1, 3}));
  EXPECT_EQ(cone.history.size, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(cone.history.reason, "stagnation");
  const auto sine = [](double angle) { return std::sin(angle * std::numbers::pi / 180); };
  EXPECT_NEAR(cone.history.error[1], 2 * sine(40) / 3, 1e-15);
  EXPECT_NEAR(cone.history.error[2], sine(20) / 3, 1e-15);
  EXPECT_NEAR(cone.history.e_orth[1], sine(70), 1e-15);
  EXPECT_NEAR(cone.history.gram_condition[1], (1 + sine(20)) / (1 - sine(20)), 1e-13);
  const Matrix expected = plane_vectors(Vector{{20, 90}}, Vector{{1, 1}});
  EXPECT_LT((cone.basis.generators - expected).norm(), 1e-15);
  // Within a tolerance of sin 20 / 3 the same cone is good enough.
  EXPECT_EQ(build(ConeType::angle_greedy, snapshots, identity(2), 0.115).history.reason,
            "tolerance reached");
}

TEST(ConeAngleGreedy, LengthDecidesTheFirstAlone) {
  // The first is the longest; 45, 60 and 90 degrees from it the others, shorter and shorter.
  const Matrix snapshots{{9, 5, 1, 0}, {0, 5, std::sqrt(3.0), 0}, {0, 0, 0, 1e-3}};
  const Cone cone = build(ConeType::angle_greedy, snapshots, identity(3), 0);
  EXPECT_EQ(cone.history.selected, (std::vector<int>{0, 3, 2}));
  EXPECT_EQ(cone.history.reason, "round-off reached");
}

TEST(ConeAngleGreedy, TakesTheLargestAngleWithTheSpan) {
  const SparseMatrix product = grid_mass(11);
  const Matrix factor = product_factor(product);
  const Matrix snapshots = moving_bumps(11, 3, 0.1);
  const Cone cone = build(ConeType::angle_greedy, snapshots, product, 1e-3);
  const Matrix unit = (factor * snapshots).colwise().normalized();
  const auto &selected = cone.history.selected;
  ASSERT_GT(selected.size(), 5u);
  for (std::size_t r = 1; r < selected.size(); ++r) {
    const std::vector<int> taken(selected.begin(), selected.begin() + static_cast<long>(r));
    const Matrix span = unit(Eigen::all, taken);
    const Vector sines = (unit - span * least_squares(span, unit)).colwise().norm();
    EXPECT_GE(sines[selected[r]], sines.maxCoeff() - 1e-9);
    EXPECT_LT((cone.basis.generators.col(static_cast<Index>(r)) -
               snapshots.col(selected[r]) / norm(snapshots.col(selected[r]), product))
                  .norm(),
              1e-12);
  }
}

TEST(ConeAngleGreedy, IgnoresMultiplesZerosAndNoise) {
  const SparseMatrix product = grid_mass(9);
  const Matrix bumps = moving_bumps(9, 2, 0.1);
  Matrix more(bumps.rows(), 2 * bumps.cols() + 2);
  more << bumps, 0.5 * bumps, Vector::Zero(bumps.rows()),
      1e-14 * random_nonnegative(bumps.rows(), 1, 0.5, 1);
  const Cone plain = build(ConeType::angle_greedy, bumps, product, 0);
  const Cone same = build(ConeType::angle_greedy, more, product, 0, 8);
  EXPECT_EQ(plain.history.selected, same.history.selected);
  EXPECT_EQ(plain.basis.generators.cols(), bumps.cols());
  EXPECT_EQ(plain.history.reason, "round-off reached");
  const Cone three = build(ConeType::angle_greedy, bumps, product, 0, 3);
  EXPECT_EQ(three.history.reason, "size reached");
  EXPECT_EQ(three.history.selected,
            std::vector<int>(plain.history.selected.begin(), plain.history.selected.begin() + 3));
}

TEST(ConeNmf, RecoversASeparableCone) {
  // The extreme rays are among the snapshots and longer than the mixtures: the start is exact, and
  // must stay so.
  const SparseMatrix product = grid_mass(5);
  Matrix rays = random_nonnegative(25, 4, 0.4, 2);
  for (auto column : rays.colwise())
    column /= norm(column, product);
  Matrix weights = random_nonnegative(4, 30, 0.2, 3);
  weights.leftCols(4) = Matrix::Identity(4, 4);
  for (Index p = 4; p < 30; ++p)
    weights.col(p) *= 0.9 / weights.col(p).sum();
  const Cone cone = build(ConeType::nmf, rays * weights, product, 1e-6);
  EXPECT_EQ(cone.basis.generators.cols(), 4);
  EXPECT_EQ(cone.history.reason, "tolerance reached");
  EXPECT_LT(largest_distance(rays, cone.basis, product), 1e-6);
}

TEST(ConeNmf, OneGeneratorIsTheLeadingSingularVector) {
  // The best approximation of rank one of a non-negative matrix is non-negative (Perron-Frobenius):
  // its objective is what the other singular values leave (Eckart-Young). The sweeps end within
  // 1e-4 of the last objective per step, a few of which can be left.
  const SparseMatrix product = grid_mass(7);
  const Matrix snapshots = moving_bumps(7, 3, 0.1);
  const Matrix weighted = Matrix(lumped(product)).diagonal().cwiseSqrt().asDiagonal() * snapshots;
  const Vector squares = thin_svd(weighted).values.array().square();
  const double best = squares.tail(squares.size() - 1).sum();
  const double scale = weighted.colwise().squaredNorm().maxCoeff();
  const Cone cone = build(ConeType::nmf, snapshots, product, 0, 1);
  const double reached = objective(snapshots, cone.basis, product) * scale;
  EXPECT_GE(reached, best * (1 - 1e-12));
  EXPECT_LE(reached, best * (1 + 1e-3));
}

TEST(ConeNmf, BeatsItsStartAndFallsWithTheSize) {
  const SparseMatrix product = grid_mass(13);
  const Matrix snapshots = moving_bumps(13, 4, 0.1);
  double previous = std::numeric_limits<double>::infinity();
  for (const int size : {1, 2, 4, 8, 16, 32}) {
    const Cone cone = build(ConeType::nmf, snapshots, product, 0, size);
    const Cone start = build(ConeType::cpg, snapshots, product, 0, size);
    ASSERT_EQ(cone.basis.generators.cols(), size);
    EXPECT_EQ(cone.history.size, (std::vector<int>{0, size}));
    EXPECT_EQ(cone.history.reason, "size reached");
    const double reached = objective(snapshots, cone.basis, product);
    EXPECT_LT(reached, objective(snapshots, start.basis, product));
    EXPECT_LT(reached, previous);
    previous = reached;
  }
}

TEST(ConeNmf, ClimbsUntilTheToleranceIsMet) {
  const SparseMatrix product = grid_mass(13);
  const Matrix snapshots = moving_bumps(13, 4, 0.1);
  const ConeHistory cpg = build(ConeType::cpg, snapshots, product, 0).history;
  for (const double tolerance : {0.3, 0.05, 1e-2}) {
    const Cone cone = build(ConeType::nmf, snapshots, product, tolerance);
    const ConeHistory &history = cone.history;
    EXPECT_EQ(history.reason, "tolerance reached");
    EXPECT_LE(history.error.back(), tolerance);
    for (std::size_t k = 1; k + 1 < history.size.size(); ++k) {
      EXPECT_GT(history.error[k], tolerance);
      EXPECT_LE(history.size[k + 1], history.size[k] + 1 + history.size[k] / 10);
    }
    EXPECT_LE(history.size.back(), cpg.size.back());
  }
  // Nothing but all snapshots is exact.
  const Cone exact = build(ConeType::nmf, snapshots, product, 0);
  EXPECT_EQ(exact.history.reason, "round-off reached");
  EXPECT_EQ(exact.basis.generators.cols(), cpg.size.back());
}

TEST(ConeNmf, DoesNotDependOnUnitsAndIsBoundedByTheStart) {
  const SparseMatrix product = grid_mass(9);
  const Matrix snapshots = moving_bumps(9, 2, 0.1);
  const Cone plain = build(ConeType::nmf, snapshots, product, 0, 5);
  const Cone scaled = build(ConeType::nmf, 1e-9 * snapshots, 1e8 * product, 0, 5);
  EXPECT_LT((plain.basis.generators - 1e4 * scaled.basis.generators).norm(), 1e-9);
  Matrix twice(snapshots.rows(), 2 * snapshots.cols());
  twice << snapshots, snapshots;
  EXPECT_LE(build(ConeType::nmf, twice, product, 0, 12).basis.generators.cols(), snapshots.cols());
}

TEST(ConeNmf, RefusesAProductThatCannotBeLumped) {
  const SparseMatrix product = sparse(Matrix{{1, -2}, {-2, 5}});
  EXPECT_THROW(build(ConeType::nmf, Matrix::Ones(2, 1), product, 0), Error);
  EXPECT_NO_THROW(build(ConeType::cpg, Matrix::Ones(2, 1), product, 0));
}

TEST(ConeNodal, RingsGrowByNeighbours) {
  const Index side = 7;
  const SparseMatrix product = grid_mass(side);
  const auto nodes_of = [&](const Vector &snapshot, int ring) {
    const Cone cone = build_cone(snapshot, product, {.type = ConeType::nodal, .ring = ring});
    std::vector<Index> nodes;
    for (const auto &column : cone.basis.generators.colwise()) {
      Index node = 0;
      const double value = column.maxCoeff(&node);
      EXPECT_EQ((column.array() != 0).count(), 1);
      EXPECT_NEAR(value, 1 / std::sqrt(product.coeff(node, node)), 1e-12 * value);
      nodes.push_back(node);
    }
    EXPECT_TRUE(std::is_sorted(nodes.begin(), nodes.end()));
    return nodes;
  };
  const auto square = [&](Index from, Index to) {
    std::vector<Index> nodes;
    for (Index i = from; i <= to; ++i)
      for (Index j = from; j <= to; ++j)
        nodes.push_back(i * side + j);
    return nodes;
  };
  const Vector centre = 3.5 * Vector::Unit(side * side, 3 * side + 3);
  for (int ring = 0; ring <= 3; ++ring)
    EXPECT_EQ(nodes_of(centre, ring), square(3 - ring, 3 + ring));
  EXPECT_EQ(nodes_of(centre, 9), square(0, side - 1));
  EXPECT_EQ(nodes_of(Vector::Unit(side * side, 0), 1), square(0, 1));
}

TEST(ConeNodal, ReproducesEverySnapshot) {
  const SparseMatrix product = grid_mass(11);
  const Matrix snapshots = moving_bumps(11, 3, 0.1);
  for (const int ring : {0, 1, 2}) {
    const Cone cone = build_cone(snapshots, product, {.type = ConeType::nodal, .ring = ring});
    EXPECT_EQ(cone.history.error, (std::vector<double>{1, 0}));
    EXPECT_LT(largest_distance(snapshots, cone.basis, product), 1e-13);
    EXPECT_TRUE(cone.history.selected.empty());
    EXPECT_TRUE(cone.history.e_orth.empty());
  }
}

TEST(ConeNodal, NoiseIsNoContact) {
  const Matrix snapshots{{1, 0}, {0, 0.5}, {1e-11, 0}, {0, 1e-9}};
  const Cone cone = build_cone(snapshots, identity(4), {.type = ConeType::nodal, .ring = 0});
  EXPECT_EQ(cone.basis.generators, (Matrix{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 0, 1}}));
  EXPECT_NEAR(cone.history.error.back(), 1e-11, 1e-16);
}

} // namespace rbvi::cone_types_test
