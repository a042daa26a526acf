// The reduced body on its common eigenvectors (one or two terms) and factorised (more),
// against dense solves with the sum of its terms.
#include "rbvi/model/reduced_body.hpp"

#include "synthetic.hpp"

#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

namespace rbvi::reduced_body_test {
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
INSTANTIATE_TEST_SUITE_P(ReducedBody, PerTerms, ::testing::Values(1, 2, 3));

TEST_P(PerTerms, IsThatOfTheSumOfItsTerms) {
  const Scene scene = toy_scene<value>();
  const ReducedModel model = random_model(
      {.modes = 6, .supremizers = 3, .generators = 5, .a = GetParam(), .b = 2}, 7, scene, true);
  const ReducedBody body(model, scene);
  BodyAtMu at_mu(body);
  std::mt19937 random(3);
  const Index n = model.primal_size();
  for (const double t : {0.1, 0.9, 0.5}) {
    FullMu mu;
    for (const Parameter &p : scene.parameters.all)
      mu.push_back(p.lower + t * (p.upper - p.lower));
    at_mu.set(mu);
    const Matrix a = full(model.body.a.reduced * theta(mu, GetParam()), n);
    const Vector theta_b = random_matrix(random, 2, 1), x = random_matrix(random, 5, 1);
    const Vector load = (model.contact.b.reduced * theta_b).reshaped(5, n).transpose() * x;
    const Vector expected = a.llt().solve(load);
    EXPECT_LE((at_mu.response(theta_b, x) - expected).norm(), 1e-12 * expected.norm());
    const Matrix loads = random_matrix(random, n, 4), half = at_mu.half_response(loads);
    const Matrix products = loads.transpose() * a.llt().solve(loads);
    EXPECT_LE((half.transpose() * half - products).norm(), 1e-12 * products.norm());
    EXPECT_LE((at_mu.stiffness() - a).norm(), 1e-14 * a.norm());
    EXPECT_LE((at_mu.times(expected) - load).norm(), 1e-12 * load.norm());
  }
}

TEST_P(PerTerms, AnIndefiniteOneIsSaid) {
  const Scene scene = toy_scene<value>();
  ReducedModel model = random_model({.a = GetParam()}, 5, scene, true);
  model.body.a.reduced *= -1;
  const ReducedBody body(model, scene);
  BodyAtMu at_mu(body);
  FullMu mu;
  for (const Parameter &p : scene.parameters.all)
    mu.push_back(p.upper);
  const auto use = [&] {
    at_mu.set(mu);
    (void)at_mu.response(Vector::Ones(model.primal_size()));
  };
  EXPECT_THROW(use(), Error);
}

/// Two terms whose coefficients keep their ratio at both corners of the box have no common
/// eigenvectors that the corners show: A_N is factorised then.
double same_at_corners(int, int i, const FullMu &mu) {
  const double middle = (mu[0] - 0.5) * (mu[0] - 0.5);
  return i == 0 ? 1 : 1 + middle;
}

TEST(ReducedBody, WhatTheCornersDoNotShowIsFactorised) {
  Scene scene = toy_scene<same_at_corners>();
  scene.parameters = all_free({{"x", "", 0, 1, 0.5}});
  const ReducedModel model = random_model({.a = 2}, 9, scene, true);
  const ReducedBody body(model, scene);
  BodyAtMu at_mu(body);
  at_mu.set({0.3});
  const Vector values{{same_at_corners(0, 0, {0.3}), same_at_corners(0, 1, {0.3})}};
  const Matrix a = full(model.body.a.reduced * values, model.primal_size());
  const Vector x = Vector::Ones(4);
  const Vector expected = a.llt().solve(model.contact.b.reduced.reshaped(4, 5).transpose() * x);
  EXPECT_LE((at_mu.response(Vector::Ones(1), x) - expected).norm(), 1e-12 * expected.norm());
}

} // namespace
} // namespace rbvi::reduced_body_test
