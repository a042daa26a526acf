// A body with a part that a parameter scales: one factorisation for every value of it, against a
// factorisation for each.
#include "rbvi/core/error.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/solve/methods.hpp"
#include "rbvi/solve/scaled_part.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

namespace rbvi::scaled_part_test {
namespace {

Scene disk(const std::string &free, const SceneOptions &options = {{"arc_edges", "40"}}) {
  Scene scene = make_scene("rigid_disk", options);
  scene.parameters = free_only(scene.parameters, free);
  return scene;
}

Vector natural(const Problem &problem, Vec u) {
  return to_natural(problem.dofs(), u);
}

double relative(const Matrix &found, const Matrix &expected) {
  return (found - expected).norm() / expected.norm();
}

void expect_agreement(Problem &problem, const std::vector<Mu> &set) {
  ScaledPart part(problem);
  const Handle<KSP> ksp = make_direct_solver(problem.comm(), "hf_");
  std::vector<Index> which;
  for (Index i = 0; i < problem.dual_size(); i += 3)
    which.push_back(i);
  for (const Mu &mu : set) {
    SCOPED_TRACE(mu.back());
    const Operators &op = problem.assemble(mu);
    RBVI_CALL(KSPSetOperators(ksp.get(), op.a, op.a));
    part.set(op);
    FactoredBody body(ksp.get(), problem.trace(), ColumnsLast::for_one_b);
    body.set(op.a);
    EXPECT_LE(relative(condensed_columns(part, op.b, which), condensed_columns(body, op.b, which)),
              1e-11);
    EXPECT_EQ(condensed_columns(part, op.b, {}).cols(), 0);
    FactoredBody columns(ksp.get(), problem.trace(), ColumnsLast::for_one_mu);
    columns.set(op.a);
    for (FullBody *of : {static_cast<FullBody *>(&part), static_cast<FullBody *>(&columns)})
      of->require({2, 0, 5});
    for (const Index dof : {0, 2, 5})
      EXPECT_LE(relative(part.column(dof), columns.column(dof)), 1e-11);
    EXPECT_THROW(part.column(1), Error);
    const Vector lambda = Vector::LinSpaced(problem.dual_size(), -1, 3);
    Handle<Vec> expected, found;
    RBVI_CALL(VecDuplicate(op.f, expected.put()));
    RBVI_CALL(VecDuplicate(op.f, found.put()));
    body.displacement(op, lambda, expected.get());
    part.displacement(op, lambda, found.get());
    EXPECT_LE(relative(natural(problem, found.get()), natural(problem, expected.get())), 1e-11);
  }
}

TEST(ScaledPart, IsTheBodyOfEveryStiffness) {
  Problem problem(PETSC_COMM_WORLD, disk("radius,core_stiffness"), {});
  expect_agreement(problem, {{1, 0.2}, {0.8, 1}, {1.3, 3.3}, {0.7, 5}, {1, 0.05}, {1, 40}});
}

TEST(ScaledPart, MayReachWhereContactIs) {
  Scene scene = disk("radius,core_stiffness");
  const auto part = [](bool below) { // y = -0.8
    return elasticity(
        "",
        [below](const FullMu &, const Point &centre) {
          return (centre[1] < -0.8) == below ? lame(15, 0.35) : Lame{0, 0};
        },
        2);
  };
  scene.a = {exact_term(part(false)),
             exact_term(part(true), {{"scale", [](const FullMu &mu) { return mu[3]; }, {3}}})};
  Problem problem(PETSC_COMM_WORLD, scene, {});
  expect_agreement(problem, {{1, 0.3}, {1.1, 4}});
}

/// The first solve factorises, the others use the part: all as single solves find them.
TEST(ScaledPart, ChangesNoAnswerOfASweep) {
  Scene every_time = disk("radius,core_stiffness");
  every_time.a = {
      mapped_term(elasticity("", every_time.materials[0].of_cell, 2))}; // from the mapped mesh
  Problem with(PETSC_COMM_WORLD, disk("radius,core_stiffness"), {}),
      without(PETSC_COMM_WORLD, every_time, {});
  HighFidelity eliminates(with, {}), factorises(without, {});
  for (const Mu &mu : {Mu{0.9, 1}, Mu{0.7, 0.2}, Mu{1.3, 5}, Mu{1, 1}, Mu{1, 1}}) {
    const HfSolution part = eliminates.solve(mu), whole = factorises.solve(mu);
    EXPECT_EQ(part.active, whole.active);
    EXPECT_LE(relative(part.lambda, whole.lambda), 1e-10);
    EXPECT_LE(relative(part.u, whole.u), 1e-10);
    EXPECT_LE(part.kkt.largest(), 1e-11);
  }
}

TEST(ScaledPart, FitsWhereNothingElseChangesInTheStiffness) {
  EXPECT_TRUE(ScaledPart::fits(disk("core_stiffness")));
  EXPECT_TRUE(ScaledPart::fits(disk("radius,core_stiffness,friction_coefficient")));
  EXPECT_FALSE(ScaledPart::fits(disk("core_stiffness,poisson_ratio")));
  EXPECT_FALSE(ScaledPart::fits(disk("poisson_ratio")));
  EXPECT_FALSE(ScaledPart::fits(disk("radius"))) << "nothing of A changes";
  EXPECT_FALSE(ScaledPart::fits(make_scene("membrane_obstacle")));
  EXPECT_FALSE(ScaledPart::fits(make_scene("two_disks")));
  Scene loaded = disk("core_stiffness");
  loaded.f = loaded.a;
  EXPECT_FALSE(ScaledPart::fits(loaded));
}

TEST(ScaledPart, AScaleOfNothingIsSaid) {
  Scene scene = disk("core_stiffness");
  scene.a.pop_back();
  scene.a.back().form = elasticity("", Lame{0, 0}, 2);
  Problem problem(PETSC_COMM_WORLD, scene, {});
  EXPECT_THROW(ScaledPart{problem}, Error);
}

} // namespace
} // namespace rbvi::scaled_part_test
