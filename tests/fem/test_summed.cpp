// Operators summed from kept terms: against an assembly of the whole at each mu, and on facets
// against integrals in closed form.
#include "../core/refuses.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/facet_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"
#include "rbvi/fem/problem.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace rbvi::summed_test {
namespace {

Scene disk(const std::string &free) {
  Scene scene = make_scene("rigid_disk", {{"arc_edges", "20"}});
  scene.parameters = free_only(scene.parameters, free);
  return scene;
}

Vector image(Problem &problem, const Mu &mu) {
  const Operators &op = problem.assemble(mu);
  Vector x(problem.dofs().total);
  for (Index i = 0; i < x.size(); ++i)
    x[i] = std::sin(static_cast<double>(i));
  const Handle<Vec> in = from_natural(problem.dofs(), x), out = make_vector(problem.dofs());
  RBVI_CALL(MatMultAdd(op.a, in.get(), op.f, out.get()));
  return to_natural(problem.dofs(), out.get());
}

void expect_same(Problem &one, Problem &other, const std::vector<Mu> &set) {
  for (const Mu &mu : set) {
    const Vector expected = image(other, mu);
    EXPECT_LE((image(one, mu) - expected).norm(), 1e-13 * expected.norm());
  }
}

TEST(Summed, IsTheStiffnessOfTheMappedBodyForEveryMaterial) {
  for (const auto &[free, set, groups] :
       {std::tuple{"radius,core_stiffness,poisson_ratio",
                   std::vector<Mu>{{1, 1, 0.35}, {0.7, 0.2, 0.45}, {1.3, 5, 0.2}, {1, 1, 0.35}}, 4},
        {"core_stiffness", {{0.3}, {4}}, 2},
        {"poisson_ratio", {{0.2}, {0.44}}, 2},
        {"radius", {{0.8}, {1.2}}, 1}}) {
    Scene whole = disk(free);
    whole.a = {mapped_term(elasticity("", whole.materials[0].of_cell, 2))};
    Problem terms(PETSC_COMM_WORLD, disk(free), {}), anew(PETSC_COMM_WORLD, whole, {});
    EXPECT_EQ(std::ssize(terms.a_terms().exact), groups) << free;
    expect_same(terms, anew, set);
  }
}

TEST(Summed, KeepsNoTermBesideASumThatDoesNotVary) {
  Problem problem(PETSC_COMM_WORLD, disk("radius"), {});
  EXPECT_EQ(problem.a_terms().total.get(), problem.a_terms().exact.front().get());
}

/// Springs, tractions and mapped terms beside exact ones; a region that is a part of the body.
Scene mixed_scene() {
  Scene scene = disk("radius,core_stiffness,poisson_ratio");
  scene.a.push_back(mapped_term(spring("contact", 2.5, 2, 2), std::vector<int>{0}));
  scene.a.push_back(exact_term(spring("arc", 1.5, 2, 2)));
  scene.f = {exact_term(pressure_load("contact", 1, 2, 2),
                        {{"kappa", [](const FullMu &mu) { return mu[3]; }, {3}}}),
             mapped_term(traction_load(
                 "arc",
                 [](const FullMu &mu, const Point &x, const Point &) -> Point {
                   return {x[1], mu[4] * x[0], 0};
                 },
                 2, 2))};
  return scene;
}

TEST(Summed, DoesNotDependOnTheNumberOfRanks) {
  Problem world(PETSC_COMM_WORLD, mixed_scene(), {}), alone(PETSC_COMM_SELF, mixed_scene(), {});
  expect_same(world, alone, {{0.8, 3, 0.3}, {1.2, 0.5, 0.4}});
}

/// The sum of the values of F in one direction, on the whole boundary "arc" but its fixed ends.
TEST(Summed, FacetsOfABoundaryAreIntegratedOnce) {
  Scene scene = disk("radius");
  scene.fixed = {};
  scene.motion = {};
  scene.a.push_back(exact_term(spring("arc", 1, 2, 2))); // the body is held
  scene.f = {mapped_term(traction_load(
      "arc",
      [](const FullMu &, const Point &, const Point &) -> Point {
        return {1, 0, 0};
      },
      2, 2))};
  Problem problem(PETSC_COMM_WORLD, scene, {});
  PetscScalar sum = 0;
  RBVI_CALL(VecSum(problem.assemble({1.2}).f, &sum));
  EXPECT_NEAR(sum, 1.2 * std::numbers::pi, 2e-3) << "the length of the half circle";
  scene.f = {mapped_term(pressure_load("arc", 1, 2, 2))};
  Problem pushed(PETSC_COMM_WORLD, scene, {});
  const Vector f = to_natural(pushed.dofs(), pushed.assemble({1.2}).f);
  double up = 0, across = 0;
  for (Index i = 0; i < f.size(); i += 2) {
    across += f[i];
    up += f[i + 1];
  }
  EXPECT_NEAR(up, 2 * 1.2, 1e-12) << "the length of the flat side";
  EXPECT_NEAR(across, 0, 1e-12);
}

/// A load or a stiffness that is no number at some point, or infinite, at some parameter; refused
/// each time, and not at the others.
TEST(Summed, WhatIsNotFiniteIsRefused) {
  for (const double bad : {std::nan(""), 1 / 0.0}) {
    Scene scene = disk("radius");
    scene.f = {mapped_term(traction_load(
        "arc",
        [bad](const FullMu &mu, const Point &x, const Point &) -> Point {
          return {0, mu[0] > 1.2 && x[0] > 0.5 ? bad : 1, 0};
        },
        2, 2))};
    Problem loaded(PETSC_COMM_WORLD, scene, {});
    for (int times = 0; times < 2; ++times)
      EXPECT_TRUE(
          refuses("the load is not finite at radius=1.25", [&] { (void)loaded.assemble({1.25}); }));
    EXPECT_NO_THROW((void)loaded.assemble({1.1}));
    scene.f = {};
    scene.a.push_back(mapped_term({"", [bad](const FullMu &mu, const Cell &, double *values) {
                                     std::fill_n(values, 144, mu[0] > 1.2 ? bad : 0);
                                   }}));
    Problem stiff(PETSC_COMM_WORLD, scene, {});
    EXPECT_TRUE(refuses("the stiffness is not finite", [&] { (void)stiff.assemble({1.25}); }));
    EXPECT_NO_THROW((void)stiff.assemble({1.1}));
  }
}

TEST(Summed, ABoundaryThatIsNotThereIsRefused) {
  Scene scene = disk("radius");
  scene.f = {exact_term(pressure_load("nowhere", 1, 2, 2))};
  try {
    Problem problem(PETSC_COMM_WORLD, scene, {});
    FAIL() << "it has no such boundary";
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    EXPECT_NE(std::string(error.what()).find("'nowhere'"), std::string::npos);
  }
}

} // namespace
} // namespace rbvi::summed_test
