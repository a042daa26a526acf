// Niakh (2022): Figure 2.1, Remark 2.4.2, Lemma 2.4.1.
#include "../linear_algebra.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/method/nonnegative_qp.hpp"
#include "rbvi/mor/published/greedy_cones.hpp"

#include "multipliers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace rbvi::cones_test {
using namespace rbvi::testing_multipliers;

namespace {

void expect_cone(const Cone &cone, const SparseMatrix &product) {
  const Matrix &generators = cone.basis.generators;
  const auto count = static_cast<std::size_t>(generators.cols());
  ASSERT_GT(count, 0u);
  EXPECT_GE(generators.minCoeff(), 0);
  for (const auto &column : generators.colwise())
    EXPECT_NEAR(norm(column, product), 1, 1e-12);
  const ConeHistory &history = cone.history;
  ASSERT_EQ(history.error.size(), count + 1);
  ASSERT_EQ(history.size.size(), count + 1);
  for (std::size_t r = 0; r <= count; ++r)
    EXPECT_EQ(history.size[r], static_cast<int>(r));
  ASSERT_EQ(history.e_orth.size(), count);
  ASSERT_EQ(history.selected.size(), count);
  ASSERT_EQ(history.gram_condition.size(), count);
  EXPECT_EQ(history.error.front(), 1);
  EXPECT_NEAR(history.e_orth.front(), 1, 1e-14);
  EXPECT_LE(*std::max_element(history.e_orth.begin(), history.e_orth.end()), 1 + 1e-14);
  EXPECT_TRUE(std::is_sorted(history.error.rbegin(), history.error.rend()));
  EXPECT_FALSE(history.reason.empty());
}

ConeBasis leading(const ConeBasis &basis, Index r) {
  return {basis.generators.leftCols(r)};
}

/// Everything that holds for a cone built without clipping.
void expect_strict_properties(const Matrix &snapshots, const SparseMatrix &product, ConeType type) {
  const Cone cone = build_cone(snapshots, product, {.type = type, .tolerance = 1e-3});
  expect_cone(cone, product);
  EXPECT_EQ(cone.history.reason, "tolerance reached");
  const auto &selected = cone.history.selected;
  for (Index r = 1; r <= cone.basis.generators.cols(); r += 7) {
    const auto at = static_cast<std::size_t>(r);
    const ConeBasis part = leading(cone.basis, r);
    EXPECT_NEAR(largest_distance(snapshots, part, product), cone.history.error[at], 1e-12);
    // Remark 2.4.1: the snapshots taken so far lie in the cone.
    const std::vector<int> taken(selected.begin(), selected.begin() + r);
    EXPECT_LT(largest_distance(snapshots(Eigen::all, taken), part, product), 1e-12);
    if (at < cone.history.e_orth.size()) {
      EXPECT_NEAR(largest_distance(cone.basis.generators.col(r), part, product),
                  cone.history.e_orth[at], 1e-11);
    }
    const Matrix gram = part.generators.transpose() * (product * part.generators);
    const Vector eigenvalues = symmetric_eigenvalues(gram);
    EXPECT_NEAR(cone.history.gram_condition[at - 1] * eigenvalues[0] / eigenvalues[r - 1], 1, 1e-6);
  }
}

} // namespace

TEST(Cones, ExactExampleInThePlane) {
  // Angles 0, 30, 60 degrees, lengths 3, 1, 2. CPG takes the first, then the last (its distance is
  // 2 sin 60 > sin 30), and the one between lies in their cone.
  const double s = std::sqrt(3.0) / 2;
  const Matrix snapshots{{3, s, 1}, {0, 0.5, 2 * s}};
  const Cone cpg = build_cone(snapshots, identity(2), {.type = ConeType::cpg, .tolerance = 1e-9});
  EXPECT_EQ(cpg.history.selected, (std::vector<int>{0, 2}));
  EXPECT_NEAR(cpg.history.error[1], 2 * s / 3, 1e-15);
  EXPECT_NEAR(cpg.history.error[2], 0, 1e-15);
  EXPECT_NEAR(cpg.history.e_orth[1], s, 1e-15);
  EXPECT_NEAR(cpg.history.gram_condition[0], 1, 1e-14);
  EXPECT_NEAR(cpg.history.gram_condition[1], 3, 1e-13); // (1 + cos 60) / (1 - cos 60)
  EXPECT_LT((cpg.basis.generators - Matrix{{1, 0.5}, {0, s}}).norm(), 1e-15);
  // mCPG removes (1, 0) from (1, sqrt 3): the axes remain.
  const Cone mcpg = build_cone(snapshots, identity(2), {.type = ConeType::mcpg, .tolerance = 1e-9});
  EXPECT_EQ(mcpg.history.selected, (std::vector<int>{0, 2}));
  EXPECT_LT((mcpg.basis.generators - Matrix::Identity(2, 2)).norm(), 1e-15);
  EXPECT_NEAR(mcpg.history.e_orth[1], 1, 1e-15);
}

TEST(Cones, ExactExampleInSpace) {
  // (2, 2, 0) then (1, 1, 1): all of (1, 1, 0) can be removed, (0, 0, 1) remains; (0, 0.5, 0.5)
  // lies sqrt(1/8) from that cone, and no generator is allowed below it but (0, 0, 1).
  const Matrix snapshots{{2, 1, 0}, {2, 1, 0.5}, {0, 1, 0.5}};
  const Cone cone = build_cone(snapshots, identity(3), {.type = ConeType::mcpg, .tolerance = 0});
  EXPECT_EQ(cone.history.selected, (std::vector<int>{0, 1, 2}));
  const double d = std::sqrt(0.5), scale = std::sqrt(8.0);
  EXPECT_LT((cone.basis.generators - Matrix{{d, 0, 0}, {d, 0, 1}, {0, 1, 0}}).norm(), 1e-14);
  EXPECT_NEAR(cone.history.error[1], 1 / scale, 1e-15);
  EXPECT_NEAR(cone.history.error[2], std::sqrt(0.125) / scale, 1e-15);
  EXPECT_NEAR(cone.history.error[3], 0, 1e-15);
  EXPECT_NEAR(cone.history.e_orth[2], d, 1e-15);
  EXPECT_EQ(cone.history.reason, "round-off reached");
}

TEST(Cones, PropertiesOfMovingBumps) {
  const SparseMatrix product = grid_mass(13);
  const Matrix snapshots = moving_bumps(13, 3, 0.08);
  expect_strict_properties(snapshots, product, ConeType::cpg);
  expect_strict_properties(snapshots, product, ConeType::mcpg);
}

TEST(Cones, AllSnapshotsReproduceThemselves) {
  const SparseMatrix product = grid_mass(11);
  const Matrix snapshots = moving_bumps(11, 3, 0.1);
  for (const ConeType type : {ConeType::cpg, ConeType::mcpg}) {
    const Cone cone = build_cone(snapshots, product, {.type = type, .tolerance = 0});
    expect_cone(cone, product);
    EXPECT_EQ(cone.history.reason, "round-off reached");
    EXPECT_LT(largest_distance(snapshots, cone.basis, product), 1e-12);
  }
}

TEST(Cones, ModifiedGeneratorsAreFartherFromTheCone) {
  const SparseMatrix product = grid_mass(13);
  const Matrix snapshots = moving_bumps(13, 3, 0.1);
  const Cone cpg = build_cone(snapshots, product, {.type = ConeType::cpg, .tolerance = 0});
  const Cone mcpg = build_cone(snapshots, product, {.type = ConeType::mcpg, .tolerance = 0});
  const auto mean = [](const std::vector<double> &values) {
    double sum = 0;
    for (const double value : values)
      sum += value;
    return sum / static_cast<double>(values.size());
  };
  EXPECT_GT(mean(mcpg.history.e_orth), mean(cpg.history.e_orth));
  EXPECT_LT(mcpg.history.gram_condition.back(), cpg.history.gram_condition.back());
}

TEST(Cones, FeasibilityToleranceClipsAndTellsTheTruth) {
  const SparseMatrix product = grid_mass(13);
  const Matrix snapshots = moving_bumps(13, 3, 0.05);
  for (const double feasibility : {1e-3, 5e-2, 0.3}) {
    const Cone cone =
        build_cone(snapshots, product,
                   {.type = ConeType::mcpg, .tolerance = 1e-3, .feasibility = feasibility});
    expect_cone(cone, product);
    EXPECT_NEAR(largest_distance(snapshots, cone.basis, product), cone.history.error.back(), 1e-12);
    EXPECT_LE(cone.basis.generators.cols(), snapshots.cols());
    EXPECT_EQ(cone.history.reason == "tolerance reached", cone.history.error.back() <= 1e-3);
  }
}

TEST(Cones, ManyExtremeRaysOfAThreeDimensionalCone) {
  const int count = 24;
  Matrix snapshots(3, count);
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * k / count;
    const Vector e{{1, -1, 0}}, f{{1, 1, -2}};
    snapshots.col(k) = Vector::Ones(3) +
                       0.6 * (std::cos(angle) * e.normalized() + std::sin(angle) * f.normalized());
  }
  for (const ConeType type : {ConeType::cpg, ConeType::mcpg}) {
    const Cone cone = build_cone(snapshots, identity(3), {.type = type, .tolerance = 0});
    expect_cone(cone, identity(3));
    EXPECT_GT(cone.basis.generators.cols(), 3);
    EXPECT_LT(largest_distance(snapshots, cone.basis, identity(3)), 1e-12);
    EXPECT_GT(cone.history.gram_condition.back(), 1e20);
  }
  const Cone cpg = build_cone(snapshots, identity(3), {.type = ConeType::cpg, .tolerance = 0});
  EXPECT_EQ(cpg.basis.generators.cols(), count);
}

TEST(Cones, TiesGoToTheLowestIndex) {
  // Three mirror images with norms equal but for round-off: the lowest index comes first whichever
  // of them round-off makes the largest.
  Matrix snapshots(4, 3);
  snapshots << 1, 0, 0, 0.5, 1, 0, 0, 0.5, 1, 0, 0, 0.5;
  for (Index favoured = 0; favoured < 3; ++favoured) {
    Matrix perturbed = snapshots;
    perturbed.col(favoured) *= 1 + 1e-13;
    perturbed(0, 0) += 0.75;
    perturbed(3, 2) += 0.75;
    const Cone cone = build_cone(perturbed, identity(4), {.type = ConeType::mcpg, .tolerance = 0});
    const auto norms = perturbed.colwise().norm();
    EXPECT_NEAR(norms[0] / norms[2], std::sqrt(3.3125) / std::sqrt(2.5625), 1e-9);
    EXPECT_EQ(cone.history.selected.front(), 0);
  }
  const Matrix symmetric =
      Matrix::Identity(5, 5) * (Vector::Ones(5) + 1e-12 * Vector{{0, 1, 3, 2, 4}}).asDiagonal();
  const Cone cone = build_cone(symmetric, identity(5), {.type = ConeType::mcpg, .tolerance = 0});
  EXPECT_EQ(cone.history.selected, (std::vector<int>{0, 1, 2, 3, 4}));
}

TEST(Cones, SingleAndDuplicateSnapshots) {
  const SparseMatrix product = grid_mass(9);
  const Matrix bumps = moving_bumps(9, 2, 0.1);
  const Cone single =
      build_cone(bumps.leftCols(1), product, {.type = ConeType::mcpg, .tolerance = 1e-3});
  expect_cone(single, product);
  EXPECT_EQ(single.basis.generators.cols(), 1);
  EXPECT_LT(single.history.error.back(), 1e-14);

  Matrix repeated(bumps.rows(), 3 * bumps.cols() + 1);
  repeated << bumps, 0.5 * bumps, bumps, Vector::Zero(bumps.rows());
  for (const ConeType type : {ConeType::cpg, ConeType::mcpg}) {
    const Cone once = build_cone(bumps, product, {.type = type, .tolerance = 0});
    const Cone thrice = build_cone(repeated, product, {.type = type, .tolerance = 0});
    EXPECT_EQ(once.history.selected, thrice.history.selected);
    EXPECT_LT((once.basis.generators - thrice.basis.generators).norm(), 1e-11);
  }
}

TEST(Cones, DoNotDependOnUnits) {
  const SparseMatrix product = grid_mass(9);
  const Matrix snapshots = moving_bumps(9, 3, 0.1);
  for (const double feasibility : {0.0, 0.01}) {
    const ConeOptions options{
        .type = ConeType::mcpg, .tolerance = 1e-2, .feasibility = feasibility};
    const Cone plain = build_cone(snapshots, product, options);
    const Cone scaled = build_cone(1e-9 * snapshots, 1e8 * product, options);
    EXPECT_EQ(plain.history.selected, scaled.history.selected);
    EXPECT_LT((plain.basis.generators - 1e4 * scaled.basis.generators).norm(), 1e-9);
    for (std::size_t r = 0; r < plain.history.error.size(); ++r)
      EXPECT_NEAR(plain.history.error[r], scaled.history.error[r], 1e-11);
  }
}

TEST(Cones, StopAtTheSizeAskedFor) {
  const SparseMatrix product = grid_mass(9);
  const Matrix snapshots = moving_bumps(9, 3, 0.1);
  const Cone all = build_cone(snapshots, product, {.type = ConeType::mcpg, .tolerance = 0});
  const Cone five =
      build_cone(snapshots, product, {.type = ConeType::mcpg, .tolerance = 0, .max_size = 5});
  EXPECT_EQ(five.history.reason, "size reached");
  EXPECT_LT((five.basis.generators - all.basis.generators.leftCols(5)).norm(), 1e-15);
  EXPECT_EQ(build_cone(snapshots, product, {.type = ConeType::mcpg, .tolerance = 2})
                .basis.generators.cols(),
            1);
}

TEST(Cones, RefuseWhatIsNoMultiplier) {
  const SparseMatrix product = identity(3);
  const ConeOptions mcpg{.type = ConeType::mcpg};
  EXPECT_THROW(build_cone(Matrix(3, 0), product, mcpg), Error);
  EXPECT_THROW(build_cone(Matrix::Zero(3, 2), product, mcpg), Error);
  EXPECT_THROW(build_cone(Matrix::Ones(2, 2), product, mcpg), Error);
  Matrix negative = Matrix::Ones(3, 2);
  negative(1, 1) = -1e-6;
  EXPECT_THROW(build_cone(negative, product, mcpg), Error);
  negative(1, 1) = -1e-15;
  EXPECT_GE(build_cone(negative, product, mcpg).basis.generators.minCoeff(), 0);
  negative(1, 1) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(build_cone(negative, product, mcpg), Error);
  EXPECT_THROW(build_cone(Matrix::Ones(3, 2), -1.0 * product, mcpg), Error);
}

TEST(LargestPartBelow, SatisfiesTheOptimalityConditions) {
  // Against the variational inequality: no feasible direction towards other feasible points, drawn
  // at random and made feasible by scaling, comes closer.
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto draw = [&] { return uniform(engine); };
  for (int k = 0; k < 60; ++k) {
    const Index n = 3 + k % 10, r = 1 + k % 7;
    Matrix generators = Matrix::NullaryExpr(n, r, draw);
    if (k % 3 == 0) generators = (generators.array() > 0.6).select(generators, 0.0);
    if (k % 4 == 0 && r > 1) generators.col(r - 1) = 2 * generators.col(0);
    const Vector theta = Vector::NullaryExpr(n, draw);
    const Matrix factor = Matrix::NullaryExpr(n, n, draw) + Matrix::Identity(n, n);
    const double slack = k % 2 == 0 ? 0 : 0.05;
    const PartBelow part =
        largest_part_below(theta, slack, generators, factor * generators, factor * theta);
    const Vector &a = part.coefficients;
    const Vector below = generators * a, left = factor * (theta - below);
    EXPECT_GE(a.minCoeff(), 0);
    EXPECT_GE((theta - below).minCoeff() + slack, -1e-12);
    for (const Index i : part.touching)
      EXPECT_NEAR(theta[i] - below[i], -slack, 1e-12);
    for (int trial = 0; trial < 200; ++trial) {
      Vector other = Vector::NullaryExpr(r, draw);
      for (Index j = 0; j < r; ++j)
        if (draw() < 0.5) other[j] = 0;
      const Vector ratios = (theta.array() + slack) / ((generators * other).array() + 1e-300);
      const Vector direction = generators * (other * ratios.minCoeff()) - below;
      EXPECT_LE(left.dot(factor * direction),
                1e-7 * left.norm() * (factor * direction).norm() + 1e-13);
    }
  }
}

TEST(LargestPartBelow, ZerosForbidGenerators) {
  const Matrix generators{{1, 1, 0}, {1, 0, 0}, {0, 0, 1}};
  const Vector theta{{2, 0, 3}};
  const PartBelow strict = largest_part_below(theta, 0, generators, generators, theta);
  EXPECT_LT((strict.coefficients - Vector{{0, 2, 3}}).norm(), 1e-14);
  EXPECT_EQ(strict.coefficients[0], 0);
  // The best multiple of (1, 1, 0) below (2, 0.9 + 0.1, 0.1) is 1.
  const Vector other{{2, 0.9, 0}};
  const Matrix first = generators.leftCols(1);
  const PartBelow one = largest_part_below(other, 0.1, first, first, other);
  EXPECT_NEAR(one.coefficients[0], 1, 1e-14);
  EXPECT_EQ(one.touching, std::vector<Index>{1});
  const Vector zero = Vector::Zero(3);
  EXPECT_EQ(largest_part_below(zero, 0, generators, generators, zero).coefficients, zero);
}

} // namespace rbvi::cones_test
