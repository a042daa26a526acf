// Sums of exact and of interpolated terms: the coefficients of a query reproduce the operators.
#include "tests/catalogue.hpp"
#include "rbvi/element/facet_forms.hpp"
#include "rbvi/model/affine_coefficients.hpp"
#include "rbvi/mor/affine.hpp"
#include "rbvi/mor/operator_entries.hpp"
#include "rbvi/par/columns.hpp"

#include <gtest/gtest.h>

namespace rbvi::exact_terms_test {
namespace {

/// Four exact terms, and springs and tractions whose facets move with the map.
Scene springy_disk() {
  Scene scene = make_scene("rigid_disk", {{"arc_edges", "20"}});
  scene.parameters = free_only(scene.parameters, "radius,core_stiffness,poisson_ratio");
  scene.a.push_back(mapped_term(spring("arc", 2, 2, 2), std::vector<int>{0}));
  scene.f = {exact_term(pressure_load("contact", 1, 2, 2),
                        {{"kappa", [](const FullMu &mu) { return mu[3]; }, {3}}}),
             mapped_term(traction_load(
                 "arc",
                 [](const FullMu &mu, const Point &x, const Point &) -> Point {
                   return {x[1], mu[4] * x[0] * x[0], 0};
                 },
                 2, 2)),
             mapped_term(traction_load(
                 "contact",
                 [](const FullMu &, const Point &x, const Point &) -> Point { return x; }, 2, 2))};
  return scene;
}

std::vector<Mu> training() {
  std::vector<Mu> set;
  for (const double radius : {0.7, 1.0, 1.3})
    for (const double nu : {0.2, 0.3, 0.4})
      set.push_back({radius, 0.5 + nu, nu});
  return set;
}

/// sum_q theta_q(mu) (term q), the interpolated terms put together from their snapshots.
Vector sum_of_terms(Problem &problem, const Mu &mu, const Vector &theta, const Eim &eim,
                    const std::vector<Vector> &exact,
                    const std::function<Vector()> &interpolated_part) {
  Vector sum = Vector::Zero(exact.front().size());
  for (std::size_t q = 0; q < exact.size(); ++q)
    sum += theta[static_cast<Index>(q)] * exact[q];
  const Vector weights = eim.combination * theta.tail(eim.size());
  for (int i = 0; i < eim.size(); ++i) {
    const int snapshot = eim.snapshots[i];
    problem.assemble(training()[snapshot]);
    sum += weights[i] * interpolated_part();
  }
  problem.assemble(mu);
  return sum;
}

TEST(ExactTerms, MakeTheOperatorsTogetherWithTheInterpolatedOnes) {
  Problem problem(PETSC_COMM_WORLD, springy_disk(), {});
  const Scene &scene = problem.scene();
  const AffineOperators affine = separate(problem, training(), {1e-12, 0});
  EXPECT_EQ(affine.a.size(), 1) << "springs per length scale with the radius";
  EXPECT_EQ(affine.f.size(), 2) << "R^2 of both boundaries, and nu R^3";
  EXPECT_TRUE(affine.a.exact());
  const LowerTriangle triangle(problem.a_terms().total.get(), problem.dofs());
  std::vector<Vector> exact_a, exact_f;
  for (const auto &term : problem.a_terms().exact)
    exact_a.push_back(triangle.values(term.get()));
  for (const auto &term : problem.f_terms().exact)
    exact_f.push_back(local_values(term.get()));
  const AffineTerms a{{}, affine.a.interpolation, affine.sample_a, 0, 4};
  const AffineTerms f{{}, affine.f.interpolation, affine.sample_f, 0, 1};
  for (const Mu &mu : {Mu{0.83, 3.3, 0.44}, Mu{1.21, 0.3, 0.25}}) {
    const FullMu all = expand(scene.parameters, mu);
    const Vector theta_a = affine_coefficients(a, scene.a, scene, all);
    const Vector theta_f = affine_coefficients(f, scene.f, scene, all);
    const Vector sum_a = sum_of_terms(problem, mu, theta_a, affine.a, exact_a, [&] {
      return triangle.values(problem.a_terms().mapped.get());
    });
    const Vector expected_a = triangle.values(problem.a_terms().total.get());
    EXPECT_LE((sum_a - expected_a).norm(), 1e-13 * expected_a.norm());
    const Vector sum_f = sum_of_terms(problem, mu, theta_f, affine.f, exact_f,
                                      [&] { return local_values(problem.f_terms().mapped.get()); });
    const Vector expected_f = local_values(problem.f_terms().total.get());
    EXPECT_LE((sum_f - expected_f).norm(), 1e-13 * expected_f.norm());
  }
}

TEST(ExactTerms, NeverMeetInterpolation) {
  Scene scene = make_scene("rigid_disk", {{"arc_edges", "20"}});
  scene.parameters = free_only(scene.parameters, "radius,core_stiffness,poisson_ratio");
  Problem problem(PETSC_COMM_WORLD, scene, {});
  const AffineOperators affine = separate(problem, training(), {1e-12, 0});
  EXPECT_EQ(affine.a.size() + affine.f.size(), 0);
  for (const SampleMesh &sample : affine.sample_a)
    EXPECT_TRUE(sample.contributions.empty());
  EXPECT_EQ(problem.a_terms().exact.size(), 4U);
}

} // namespace
} // namespace rbvi::exact_terms_test
