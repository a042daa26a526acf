// The condensed operator of contact with a rigid support, against B A^-1 B^T at single mu.
#include "../linear_algebra.hpp"
#include "rbvi/mor/condensed.hpp"
#include "rbvi/mor/nodal_dual_basis.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/solve/methods.hpp"
#include "tests/catalogue.hpp"
#include "tests/scene/block_case.hpp"

#include <gtest/gtest.h>

namespace rbvi::condensed_test {
namespace {

Scene disk(const std::string &free, const SceneOptions &options = {}) {
  SceneOptions all{{"arc_edges", "20"}};
  all.insert(options.begin(), options.end());
  Scene scene = make_scene("rigid_disk", all);
  scene.parameters = free_only(scene.parameters, free);
  return scene;
}

/// B A^-1 B^T on the basis, from its definition.
Matrix truth(Problem &problem, const Matrix &basis, const Mu &mu) {
  const Operators &op = problem.assemble(mu);
  const Handle<KSP> ksp = make_direct_solver(problem.comm(), "hf_");
  RBVI_CALL(KSPSetOperators(ksp.get(), op.a, op.a));
  FactoredBody body(ksp.get(), problem.trace(), ColumnsLast::for_one_b);
  body.set(op.a);
  std::vector<Index> all(problem.dual_size());
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] = static_cast<Index>(i);
  return basis.transpose() * condensed_columns(body, op.b, all) * basis;
}

/// The sum of the terms at mu, theta of b from its separation.
Matrix interpolated(const Scene &scene, const CondensedOperator &condensed, const Vector &theta,
                    Index m, const Mu &mu) {
  const Vector shape = condensed.shape *
                       grid_functions(scene, condensed.grid, expand(scene.parameters, mu)) /
                       common_coefficient(scene.a, scene.parameters, expand(scene.parameters, mu));
  Vector sum = Vector::Zero(m * m);
  Index at = 0;
  for (Index p = 0; p < theta.size(); ++p)
    for (Index q = p; q < theta.size(); ++q, at += shape.size())
      sum += theta[p] * theta[q] * condensed.terms.middleCols(at, shape.size()) * shape;
  return sum.reshaped(m, m);
}

/// theta of b by least squares on its snapshots: b = sum_p theta_p sum_i b(mu_i) combination(i, p).
Vector theta_of(Problem &problem, const Eim &b, const std::vector<Mu> &training, const Mu &mu) {
  Operators op;
  problem.assemble_contact(mu, op);
  const Vector wanted = Eigen::Map<const Vector>(op.b.valuePtr(), op.b.nonZeros());
  Matrix terms(wanted.size(), b.size());
  for (int i = 0; i < b.size(); ++i) {
    problem.assemble_contact(training[b.snapshots[std::size_t(i)]], op);
    terms.col(i) = Eigen::Map<const Vector>(op.b.valuePtr(), op.b.nonZeros());
  }
  return least_squares(terms * b.combination, wanted);
}

CondensedOperator condensed_operator(Problem &problem, const AffineOperators &affine,
                                     const std::vector<Mu> &training, const Matrix &basis,
                                     const CondensedOptions &options) {
  const CondensedLoads loads = condensed_loads(
      problem, affine, training, Matrix::Zero(problem.dual_size(), std::ssize(training)), basis);
  return condense(problem, loads, expand(problem.scene().parameters, training.front()), options)
      .condensed;
}

void expect_agreement(const Scene &scene, const std::vector<Mu> &training,
                      const std::vector<Mu> &others, const CondensedOptions &options,
                      double tolerance) {
  Problem problem(PETSC_COMM_WORLD, scene, {});
  const AffineOperators affine = separate(problem, training, {1e-12, 0});
  const Matrix basis = nodal_dual_basis(problem, Matrix::Zero(problem.dual_size(), 1));
  const CondensedOperator condensed = condensed_operator(problem, affine, training, basis, options);
  for (const Mu &mu : others) {
    const Matrix expected = truth(problem, basis, mu);
    const Vector theta = theta_of(problem, affine.b, training, mu);
    const Matrix found = interpolated(scene, condensed, theta, basis.cols(), mu);
    EXPECT_LE((found - expected).norm(), tolerance * expected.norm())
        << describe(scene.parameters, mu);
  }
}

TEST(Condensed, OneTermServesAllRadii) {
  expect_agreement(disk("radius"), {{0.7}, {1}, {1.3}}, {{0.85}, {1.21}}, {}, 1e-12);
}

TEST(Condensed, CoreStiffnessIsInterpolatedToTheTolerance) {
  expect_agreement(disk("radius,core_stiffness"), {{0.7, 1}, {1.3, 2}},
                   {{0.85, 0.2}, {1.2, 0.55}, {1, 3.3}, {1, 5}}, {1e-8, 33}, 1e-7);
}

TEST(Condensed, PoissonsRatioIsInterpolatedToTheTolerance) {
  expect_agreement(disk("poisson_ratio"), {{0.2}, {0.4}}, {{0.25}, {0.33}, {0.449}}, {1e-8, 33},
                   1e-7);
}

TEST(Condensed, SeveralTermsOfBMakeAllTheirProducts) {
  std::vector<Mu> training;
  for (int i = 0; i <= 12; ++i)
    training.push_back({0.7 + 0.05 * i});
  expect_agreement(disk("radius", {{"normal", "rigid"}}), training, {{0.83}, {1.17}}, {}, 1e-7);
}

/// One modulus, that beside Poisson's ratio, and a decade of it on a part of the body.
TEST(Condensed, WhatOnlyScalesIsNotSampled) {
  const auto expect = [](const std::string &free, const Sections &other, const Mu &mu, int count) {
    Sections sections = other;
    sections.insert({"parameters", "{depth: {default: 0.05}, k: {range: [1, 10], default: 2}, nu: "
                                   "{range: [0.1, 0.4], default: 0.3}, young: {default: 15}}"});
    Scene scene = make_scene(read_case(block_case(sections), "block.yaml"), {});
    scene.parameters = free_only(scene.parameters, free);
    Problem problem(PETSC_COMM_WORLD, scene, {});
    const AffineOperators affine = separate(problem, {mu}, {});
    const Matrix none = Matrix::Zero(problem.dual_size(), 1),
                 basis = nodal_dual_basis(problem, none);
    const Condensation made = condense(problem, condensed_loads(problem, affine, {mu}, none, basis),
                                       expand(scene.parameters, mu), {});
    EXPECT_EQ(made.factorisations, count) << free;
    EXPECT_LE(made.condensed.error, 1e-9);
    const Matrix expected = truth(problem, basis, mu),
                 found = interpolated(scene, made.condensed, theta_of(problem, affine.b, {mu}, mu),
                                      basis.cols(), mu);
    EXPECT_LE((found - expected).norm(), 1e-8 * expected.norm()) << free;
  };
  expect("k", {}, {3.7}, 1);
  expect("k,nu", {}, {3.7, 0.22}, 13);
  expect("k",
         {{"materials", "{a: {at: all, E: '15 * (y > 0.25 ? k : 1)', nu: 0.3}}"},
          {"parameters", "{depth: {default: 0.05}, k: {range: [1, 10], default: 2}}"}},
         {3.7}, 15);
}

TEST(Condensed, TooFewPointsMakeAModelThatSaysItsError) {
  Problem problem(PETSC_COMM_WORLD, disk("core_stiffness"), {});
  const AffineOperators affine = separate(problem, {{1.0}}, {});
  const Matrix basis = nodal_dual_basis(problem, Matrix::Zero(problem.dual_size(), 1));
  testing::internal::CaptureStderr();
  const CondensedOperator condensed =
      condensed_operator(problem, affine, {{1.0}}, basis, {1e-9, 9});
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_EQ(said.find("-condensed_tolerance") != std::string::npos, rank_of(PETSC_COMM_WORLD) == 0);
  const Matrix expected = truth(problem, basis, {0.3}),
               found =
                   interpolated(problem.scene(), condensed,
                                theta_of(problem, affine.b, {{1.0}}, {0.3}), basis.cols(), {0.3});
  EXPECT_GT(condensed.error, 1e-9);
  EXPECT_LE((found - expected).norm(), 10 * condensed.error * expected.norm());
  EXPECT_THROW(condensed_operator(problem, affine, {{1.0}}, basis, {1e-9, 5}), Error) << "0.01";
}

TEST(NodalDualBasis, FoldsMirrorImagesOfSymmetricMultipliersOnly) {
  Problem problem(PETSC_COMM_WORLD, disk("radius"), {});
  const Index vertices = problem.contact().nodes(), half = (vertices + 1) / 2;
  Matrix lambda = Matrix::Zero(2 * vertices, 1);
  for (Index i = 0; i < vertices; ++i) {
    const double s = static_cast<double>(i) - static_cast<double>(vertices - 1) / 2;
    lambda(i, 0) = 30 - s * s / 4;
    lambda(vertices + i, 0) = s;
  }
  const Matrix folded = nodal_dual_basis(problem, lambda);
  ASSERT_EQ(folded.cols(), 2 * half);
  const Vector coefficients = least_squares(folded, lambda.col(0));
  EXPECT_LE((folded * coefficients - lambda).norm(), 1e-13 * lambda.norm());
  for (Index i = 0; i < half; ++i)
    EXPECT_NEAR(coefficients[i], lambda(i, 0), 1e-12) << "a coefficient is the value at its node";

  lambda(3, 0) += 1;
  EXPECT_EQ(nodal_dual_basis(problem, lambda).cols(), 2 * vertices);
}

/// Values of a linear function at the coarser nodes make it at all nodes, of every component.
TEST(NodalDualBasis, HatsOfACoarserMeshReproduceItsFunctions) {
  MeshOptions fine;
  fine.refine = 1;
  Problem problem(PETSC_COMM_WORLD, disk("radius"), fine);
  const Problem coarse(PETSC_COMM_WORLD, disk("radius"), {});
  Matrix lambda = Matrix::Zero(problem.dual_size(), 1);
  lambda(0, 0) = 1; // not symmetric: nothing is folded
  const Matrix hats = nodal_dual_basis(problem, lambda, 1);
  ASSERT_EQ(hats.cols(), coarse.dual_size());
  EXPECT_GE(hats.minCoeff(), 0);
  EXPECT_LE((hats.rowwise().sum() - Vector::Ones(hats.rows())).cwiseAbs().maxCoeff(), 1e-14);
  const Matrix values = Matrix::Random(hats.cols(), 3);
  EXPECT_LE((nodal_coefficients(hats, hats * values) - values).norm(), 1e-13 * values.norm());
  EXPECT_THROW((void)nodal_dual_basis(problem, lambda, 2), Error);
}

} // namespace
} // namespace rbvi::condensed_test
