// The separated operators: B^n and B^tau of contact with a rigid support apart.
#include "tests/catalogue.hpp"
#include "rbvi/mor/affine.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace rbvi::affine_test {
namespace {

Scene disk(const SceneOptions &options, const std::string &free = "radius") {
  SceneOptions all{{"arc_edges", "20"}};
  all.insert(options.begin(), options.end());
  Scene scene = make_scene("rigid_disk", all);
  scene.parameters = free_only(scene.parameters, free);
  return scene;
}

const SceneOptions rigid{{"normal", "rigid"}};

std::vector<Mu> radii(int count) {
  std::vector<Mu> set;
  for (int i = 0; i < count; ++i)
    set.push_back({0.7 + 0.6 * i / (count - 1)});
  return set;
}

RowOptions tolerances(double normal, double tangential) {
  return {{.tolerance = normal}, {.tolerance = tangential}};
}

Matrix b_at(Problem &problem, const Mu &mu) {
  Operators op;
  problem.assemble_contact(mu, op);
  return op.b;
}

double at(const Matrix &b, const EntryKey &key) {
  return b(key.row, key.column);
}

/// (B.35)-(B.36) of one group of rows, the others zero.
Matrix interpolant(Problem &problem, const Eim &eim, const std::vector<Mu> &training,
                   const Matrix &b) {
  Vector theta(eim.size());
  for (int j = 0; j < eim.size(); ++j)
    theta[j] = at(b, eim.entries[static_cast<std::size_t>(j)]);
  eim.interpolation.triangularView<Eigen::UnitLower>().solveInPlace(theta);
  const Vector weights = eim.combination * theta;
  Matrix sum = Matrix::Zero(b.rows(), b.cols());
  for (int i = 0; i < eim.size(); ++i)
    sum += weights[i] *
           b_at(problem,
                training[static_cast<std::size_t>(eim.snapshots[static_cast<std::size_t>(i)])]);
  return sum;
}

/// Each is exact at its own entries for any mu, and at its own mu for all of its rows, not at those
/// of the other.
TEST(RowsApart, EachIsExactAtItsOwnPoints) {
  Problem problem(PETSC_COMM_WORLD, disk(rigid), {});
  const std::vector<Mu> training = radii(21);
  const AffineOperators affine = separate(problem, training, {}, tolerances(1e-2, 1e-6));
  ASSERT_GT(affine.b_tangential.size(), affine.b.size());
  for (const auto &[eim, first, count] : rows_of_b(affine, problem)) {
    for (const EntryKey &key : eim.entries) {
      EXPECT_GE(key.row, first);
      EXPECT_LT(key.row, first + count);
    }
    for (const double radius : {0.777, 1.111}) {
      const Matrix b = b_at(problem, {radius}), sum = interpolant(problem, eim, training, b);
      for (const EntryKey &key : eim.entries)
        EXPECT_NEAR(at(sum, key), at(b, key), 1e-13 * b.cwiseAbs().maxCoeff());
    }
    for (const int p : eim.snapshots) {
      const Matrix b = b_at(problem, training[static_cast<std::size_t>(p)]);
      const Matrix left = interpolant(problem, eim, training, b) - b;
      EXPECT_LE(left.middleRows(first, count).cwiseAbs().maxCoeff(),
                1e-13 * b.cwiseAbs().maxCoeff());
    }
  }
}

TEST(RowsApart, EachKeepsItsOwnTolerance) {
  Problem problem(PETSC_COMM_WORLD, disk(rigid), {});
  const std::vector<Mu> training = radii(21);
  const AffineOperators rough = separate(problem, training, {}, tolerances(1e-2, 1e-8));
  const AffineOperators fine = separate(problem, training, {}, tolerances(1e-8, 1e-2));
  for (const AffineOperators *affine : {&rough, &fine}) {
    for (const auto &[eim, first, count] : rows_of_b(*affine, problem)) {
      double left = 0, scale = 0;
      for (const Mu &mu : training) {
        const Matrix b = b_at(problem, mu);
        const auto rows = b.middleRows(first, count);
        const Matrix sum = interpolant(problem, eim, training, b);
        left = std::max(left, (rows - sum.middleRows(first, count)).cwiseAbs().maxCoeff());
        scale = std::max(scale, rows.cwiseAbs().maxCoeff());
      }
      const bool first_rows = first == 0;
      EXPECT_LE(left, (first_rows == (affine == &fine) ? 1e-8 : 1e-2) * scale);
      EXPECT_NEAR(left / scale, eim.error.back(), 1e-3 * eim.error.back() + 1e-13);
    }
  }
  EXPECT_LT(rough.b.size(), fine.b.size());
  EXPECT_GT(rough.b_tangential.size(), fine.b_tangential.size());
  const auto count = static_cast<std::size_t>(rough.b.size());
  EXPECT_TRUE(std::equal(rough.b.entries.begin(), rough.b.entries.end(), fine.b.entries.begin()))
      << "the first " << count << " terms of B^n do not depend on the tolerance of B^tau";
}

/// v . tau is v . n of the turned v: both need the same number of terms for the same error.
TEST(RowsApart, AreAlikeInTheirErrors) {
  Problem problem(PETSC_COMM_WORLD, disk(rigid), {});
  const AffineOperators affine = separate(problem, radii(21), {}, tolerances(1e-9, 1e-9));
  ASSERT_EQ(affine.b.size(), affine.b_tangential.size());
  for (std::size_t j = 0; j < affine.b.error.size(); ++j)
    EXPECT_NEAR(affine.b.error[j], affine.b_tangential.error[j], 1e-6 * affine.b.error[j] + 1e-14);
}

TEST(RowsApart, StayOneWhereBIsAMultipleOfOneFormOrHasNormalRowsAlone) {
  const std::vector<Mu> training = radii(7);
  Problem scaled(PETSC_COMM_WORLD, disk({}), {});
  const AffineOperators one = separate(scaled, training, {1e-10, 0}, tolerances(1e-3, 1e-3));
  const AffineOperators joint = separate(scaled, training, {1e-10, 0});
  EXPECT_EQ(one.b_size(), 1);
  EXPECT_EQ(one.b_tangential.size(), 0);
  EXPECT_EQ(one.b.entries, joint.b.entries);
  EXPECT_EQ(one.b.snapshots, joint.b.snapshots);
  EXPECT_EQ(rows_of_b(one, scaled).front().count, scaled.dual_size());

  SceneOptions frictionless = rigid;
  frictionless["friction"] = "none";
  Problem normal(PETSC_COMM_WORLD, disk(frictionless), {});
  const AffineOperators own = separate(normal, training, {1e-2, 0}, tolerances(1e-6, 1e-2));
  EXPECT_EQ(own.b_tangential.size(), 0);
  EXPECT_LE(own.b.error.back(), 1e-6);
  EXPECT_EQ(own.b.entries, separate(normal, training, {1e-6, 0}).b.entries);
}

TEST(RowsApart, DoNotDependOnTheNumberOfRanks) {
  Problem shared(PETSC_COMM_WORLD, disk(rigid), {}), own(PETSC_COMM_SELF, disk(rigid), {});
  const AffineOperators one = separate(shared, radii(21), {}, tolerances(1e-4, 1e-7));
  const AffineOperators other = separate(own, radii(21), {}, tolerances(1e-4, 1e-7));
  for (const auto part : {&AffineOperators::b, &AffineOperators::b_tangential}) {
    const Eim &x = one.*part, &y = other.*part;
    EXPECT_EQ(x.snapshots, y.snapshots);
    EXPECT_EQ(x.entries, y.entries);
    EXPECT_EQ(x.interpolation, y.interpolation);
    EXPECT_EQ(x.error, y.error);
  }
  ASSERT_EQ(one.sample_b.size(), 1U);
  EXPECT_EQ(one.sample_b.front().vertices, other.sample_b.front().vertices);
}

} // namespace
} // namespace rbvi::affine_test
