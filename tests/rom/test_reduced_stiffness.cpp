// The reduced stiffness on its common eigenvectors (one or two terms) and factorised (more),
// against dense solves with the sum of its terms.
#include "rbvi/rom/law/reduced_stiffness.hpp"

#include "synthetic.hpp"

#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

namespace rbvi::reduced_stiffness_test {
namespace {

using namespace synthetic;

/// Positive, and of different shapes in mu for different i.
double value(int, int i, const FullMu &mu) {
  return i == 0 ? 1 : std::exp(i * mu[0]) + i * mu[1] * mu[1];
}

Matrix full(const Vector &packed, Index n) {
  Matrix a(n, n);
  for (Index j = 0, at = 0; j < n; at += n - j, ++j) {
    a.col(j).tail(n - j) = packed.segment(at, n - j);
    a.row(j).tail(n - j) = packed.segment(at, n - j).transpose();
  }
  return a;
}

Vector theta(const FullMu &mu, int terms) {
  return Vector::NullaryExpr(terms, [&](Index q) { return value(0, static_cast<int>(q), mu); });
}

class PerTerms : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(ReducedStiffness, PerTerms, ::testing::Values(1, 2, 3));

TEST_P(PerTerms, IsThatOfTheSumOfItsTerms) {
  const Scene scene = toy_scene<value>();
  const ReducedModel model = random_model(
      {.modes = 6, .supremizers = 3, .generators = 5, .a = GetParam(), .b = 2}, 7, scene, true);
  ReducedStiffness stiffness(model, scene);
  std::mt19937 random(3);
  const Index n = model.primal_size();
  for (const double t : {0.1, 0.9, 0.5}) {
    FullMu mu;
    for (const Parameter &p : scene.parameters.all)
      mu.push_back(p.lower + t * (p.upper - p.lower));
    stiffness.set(mu);
    const Matrix a = full(model.a.reduced * theta(mu, GetParam()), n);
    const Vector theta_b = random_matrix(random, 2, 1), x = random_matrix(random, 5, 1);
    const Vector load = (model.b.reduced * theta_b).reshaped(5, n).transpose() * x;
    const Vector expected = a.llt().solve(load);
    EXPECT_LE((stiffness.response(theta_b, x) - expected).norm(), 1e-12 * expected.norm());
    const Matrix loads = random_matrix(random, n, 4), half = stiffness.half_response(loads);
    const Matrix products = loads.transpose() * a.llt().solve(loads);
    EXPECT_LE((half.transpose() * half - products).norm(), 1e-12 * products.norm());
  }
}

TEST_P(PerTerms, AnIndefiniteOneIsSaid) {
  const Scene scene = toy_scene<value>();
  ReducedModel model = random_model({.a = GetParam()}, 5, scene, true);
  model.a.reduced *= -1;
  ReducedStiffness stiffness(model, scene);
  FullMu mu;
  for (const Parameter &p : scene.parameters.all)
    mu.push_back(p.upper);
  EXPECT_THROW(stiffness.set(mu), Error);
}

/// Two terms whose coefficients keep their ratio at both corners of the box have no common
/// eigenvectors that the corners show: A_N is factorised then.
double same_at_corners(int, int i, const FullMu &mu) {
  const double middle = (mu[0] - 0.5) * (mu[0] - 0.5);
  return i == 0 ? 1 : 1 + middle;
}

TEST(ReducedStiffness, WhatTheCornersDoNotShowIsFactorised) {
  Scene scene = toy_scene<same_at_corners>();
  scene.parameters = all_free({{"x", "", 0, 1, 0.5}});
  const ReducedModel model = random_model({.a = 2}, 9, scene, true);
  ReducedStiffness stiffness(model, scene);
  stiffness.set({0.3});
  const Vector values{{same_at_corners(0, 0, {0.3}), same_at_corners(0, 1, {0.3})}};
  const Matrix a = full(model.a.reduced * values, model.primal_size());
  const Vector x = Vector::Ones(4);
  const Vector expected = a.llt().solve(model.b.reduced.reshaped(4, 5).transpose() * x);
  EXPECT_LE((stiffness.response(Vector::Ones(1), x) - expected).norm(), 1e-12 * expected.norm());
}

} // namespace
} // namespace rbvi::reduced_stiffness_test
