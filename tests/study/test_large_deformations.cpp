// Reduced models of contact that follows the displacement, against high-fidelity answers at
// parameters that they have not seen; stability over all pairs of a parameter and a step.
#include "reduced.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/study/bench.hpp"
#include "rbvi/study/separation_errors.hpp"
#include "rbvi/study/stability_report.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <unistd.h>

namespace rbvi::large_deformations_test {
namespace {

using namespace testing_reduced;

Scene large_disk(const std::string &friction, const std::string &free,
                 SceneOptions options = {{"arc_edges", "60"}}) {
  options["kinematics"] = "large";
  options["friction"] = friction;
  Scene scene = make_scene("rigid_disk", options);
  scene.parameters = free_only(scene.parameters, free);
  return scene;
}

ReduceOptions by(MultiplierReduction reduction) {
  ReduceOptions options;
  options.multipliers.reduction = reduction;
  return options;
}

/// Over parameters inside the box of the training samples; the largest of each.
void expect_errors(Reduced &r, const std::string &set, double u, double lambda) {
  const std::vector<Sample> unseen =
      solve_all(r.problem, parse_set(r.problem.scene().parameters, set));
  const ModelErrors errors = r.errors_at(unseen);
  EXPECT_EQ(errors.failed, 0);
  EXPECT_LE(errors.u.maxCoeff(), u);
  EXPECT_LE(errors.lambda.maxCoeff(), lambda);
  if (errors.tangential.size() > 0) {
    EXPECT_LE(errors.tangential.maxCoeff(), lambda);
  }
  OnlineSolver online(r.model);
  for (const Sample &sample : unseen) {
    const Outputs outputs = online.outputs(sample.mu, online.solve(sample.mu));
    EXPECT_NEAR(*outputs.energy, *sample.outputs.energy, u * *sample.outputs.energy);
    EXPECT_NEAR(*outputs.reaction, *sample.outputs.reaction, lambda * *sample.outputs.reaction);
    EXPECT_NEAR(*outputs.horizontal_reaction, *sample.outputs.horizontal_reaction,
                lambda * *sample.outputs.reaction);
  }
}

// The law at every node: exact, with friction and without, with loads of a stiffness that varies.
TEST(LargeModel, TheLawAtEveryNodeIsExact) {
  for (const char *friction : {"none", "coulomb", "tresca"}) {
    SCOPED_TRACE(friction);
    Reduced r(large_disk(friction, "radius,indentation,offset"), "grid:3,3,3");
    r.reduce(by(MultiplierReduction::automatic));
    EXPECT_TRUE(r.model.contact.law);
    EXPECT_EQ(r.model.contact.law->states.cols(), 27);
    expect_errors(r, "random:8:3", 1e-6, 1e-9);
    const ModelErrors again = r.errors_at(r.samples);
    EXPECT_LE(again.lambda.maxCoeff(), 1e-9);
  }
}

TEST(LargeModel, WithDisplacementsOfDegreeOne) {
  Reduced r(
      large_disk("coulomb", "radius,indentation,offset", {{"arc_edges", "40"}, {"degree", "1"}}),
      "grid:3,3,3");
  r.reduce(by(MultiplierReduction::automatic));
  expect_errors(r, "random:8:3", 1e-6, 1e-9);
}

TEST(LargeModel, WhereTheStiffnessVariesToo) {
  Reduced r(large_disk("none", "indentation,core_stiffness", {{"arc_edges", "40"}}), "grid:3,4");
  r.reduce(by(MultiplierReduction::condensed));
  EXPECT_GT(r.model.contact.law->condensed.terms.cols(), 1);
  expect_errors(r, "random:6:3", 1e-2, 1e-7);
}

TEST(LargeModel, ASymmetricSceneNeedsHalfTheMultipliers) {
  Reduced half(large_disk("coulomb", "indentation"), "grid:9");
  half.reduce(by(MultiplierReduction::condensed));
  EXPECT_EQ(half.model.contact.generators, 62);
  expect_errors(half, "random:5:2", 1e-6, 1e-9);
}

// The published way: a cone, and supremizers for every training mu and every step of its iteration.
TEST(LargeModel, APairIsStableAlongTheIterations) {
  Reduced r(large_disk("none", "indentation,offset", {{"arc_edges", "40"}}), "grid:7,7");
  r.reduce(by(MultiplierReduction::cone));
  const std::vector<ContactPoint> points = contact_points(r.samples);
  EXPECT_GT(points.size(), 3 * r.samples.size());
  const StabilityCheck check = make_stability_check(r.problem, r.model);
  for (const InfSup &at : infsup_over(PETSC_COMM_WORLD, r.problem, check, points, false)) {
    EXPECT_GE(at.off, 0.9 * at.on);
    EXPECT_GE(at.on, (1 - 1e-10) * at.hf);
    EXPECT_LE(at.dec, at.off);
  }
  const BoundCheck bound = check_bound(PETSC_COMM_WORLD, r.problem, check, points);
  EXPECT_EQ(bound.exceptions, 0);
  expect_errors(r, "random:6:4", 1e-3, 1e-2);
  const ModelErrors again = r.errors_at(r.samples);
  EXPECT_EQ(again.failed, 0);
  EXPECT_LE(again.u.maxCoeff(), 1e-4);
}

/// No sum of terms is shorter than the rank; over the states that it comes from the validation's
/// error is the training's.
TEST(LargeModel, InterpolationOverStatesTakesAtLeastTheRank) {
  Reduced r(large_disk("none", "indentation", {{"arc_edges", "24"}}), "grid:5");
  const std::vector<ContactPoint> points = contact_points(r.samples);
  const auto over = [&](const std::vector<ContactPoint> &training, double tolerance) {
    return separation_over_states(r.problem.contact(), r.problem.scene().parameters, training,
                                  points, tolerance);
  };
  EXPECT_EQ(over({points.back()}, 1e-6).svd_rank, 1);
  int before = 0;
  for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
    SCOPED_TRACE(tolerance);
    const auto [errors, rank, multipliers] = over(points, tolerance);
    EXPECT_GE(multipliers, 1);
    EXPECT_LE(multipliers,
              std::min<Index>(std::ssize(errors.training) - 1, r.problem.contact().dual_size()));
    EXPECT_GT(rank, before);
    EXPECT_LE(rank, std::ssize(errors.training) - 1);
    EXPECT_LE(errors.training.back(), tolerance);
    EXPECT_NEAR(errors.validation.back(), errors.training.back(), 1e-10);
    before = rank;
  }
}

/// Appendix A as printed: (A.7) to (A.9) without acceleration has the answers of Newton's method on
/// the law at every node, in more steps, and those of Anderson's with friction and on a pair.
TEST(LargeModel, KacanovsIterationAloneHasTheSameAnswers) {
  const auto expect_same = [](const ReducedModel &model) {
    OnlineSolver usual(model), plain(model, {.method = OnlineMethod::kacanov});
    for (const Mu &mu : {Mu{0.13, 0.04}, Mu{0.19, -0.07}}) {
      const ReducedAnswer a = usual.solve(mu), b = plain.solve(mu);
      EXPECT_LE((a.lambda - b.lambda).norm(), 1e-7 * a.lambda.norm());
      EXPECT_LE((a.u - b.u).norm(), 1e-7 * a.u.norm());
      if (model.contact.law && !has_friction(model.scene)) {
        EXPECT_GT(b.iterations, a.iterations);
        EXPECT_GT(b.contraction, 0.1) << "linear";
      }
    }
  };
  Reduced r(large_disk("none", "indentation,offset", {{"arc_edges", "40"}}), "grid:4,4");
  r.reduce(by(MultiplierReduction::condensed));
  expect_same(r.model);
  EXPECT_THROW(OnlineSolver(r.model, {.method = OnlineMethod::uzawa}), Error);
  r.reduce(by(MultiplierReduction::cone));
  expect_same(r.model);
  Reduced rough(large_disk("coulomb", "indentation,offset", {{"arc_edges", "24"}}), "grid:4,4");
  rough.reduce(by(MultiplierReduction::condensed));
  expect_same(rough.model);
}

TEST(LargeModel, OnlineEnrichmentFollowsTheState) {
  Reduced r(large_disk("none", "indentation,offset", {{"arc_edges", "24"}}), "grid:4,4");
  ReduceOptions options = by(MultiplierReduction::cone);
  options.enrichment = Enrichment::online;
  r.reduce(options);
  EXPECT_TRUE(r.model.body.online_enriched);
  const ModelErrors again = r.errors_at(r.samples);
  EXPECT_EQ(again.failed, 0);
  EXPECT_LE(again.u.maxCoeff(), 1e-4);
}

TEST(LargeModel, TwoBodiesKeepTheirLaw) {
  SceneOptions options{{"kinematics", "large"}, {"arc_edges", "40"}};
  Reduced r(make_scene("two_disks", options), "grid:5");
  r.reduce(by(MultiplierReduction::automatic));
  const std::vector<Sample> unseen =
      solve_all(r.problem, parse_set(r.problem.scene().parameters, "random:6:1"));
  const ModelErrors errors = r.errors_at(unseen);
  EXPECT_EQ(errors.failed, 0);
  EXPECT_LE(errors.u.maxCoeff(), 1e-6);
  EXPECT_LE(errors.lambda.maxCoeff(), 1e-8);
}

TEST(LargeModel, AFileGivesTheSameModelWithoutTheScenesCode) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("large" + std::to_string(getpid()) + ".h5");
  Reduced r(large_disk("coulomb", "indentation,offset", {{"arc_edges", "24"}}), "grid:3,3",
            PETSC_COMM_SELF);
  r.reduce(by(MultiplierReduction::automatic));
  write_model(r.model, path);
  const ReducedModel read = read_model(path, catalogue());
  std::filesystem::remove(path);
  std::filesystem::remove(fields_file(path));
  OnlineSolver one(r.model), other(read);
  const Mu mu{0.13, 0.04};
  const ReducedAnswer here = one.solve(mu), there = other.solve(mu);
  EXPECT_EQ(here.u, there.u);
  EXPECT_EQ(here.lambda, there.lambda);
  EXPECT_EQ(read.contact.law->states, r.model.contact.law->states);
}

TEST(LargeModel, IterationsAreTimedByTheMethodsThatTheLawHas) {
  for (const std::string friction : {"none", "coulomb"}) {
    Reduced r(large_disk(friction, "indentation", {{"arc_edges", "24"}}), "grid:2");
    std::vector<std::string> names;
    for (const BenchRow &row : bench_iterations(r.problem, r.samples)) {
      names.push_back(row.method);
      EXPECT_GT(row.queries, 0);
    }
    const bool has_newton = std::ranges::count(names, "iteration: newton, from rest") == 1;
    EXPECT_EQ(has_newton, friction == "none");
    EXPECT_EQ(std::ranges::count(names, "iteration: kacanov, from rest"), 1);
  }
}

TEST(LargeModel, OtherReductionsAreRefused) {
  Reduced r(large_disk("coulomb", "indentation", {{"arc_edges", "24"}}), "grid:2");
  for (const MultiplierReduction reduction :
       {MultiplierReduction::cone, MultiplierReduction::collocated})
    EXPECT_THROW(r.reduce(by(reduction)), Error);
}

} // namespace
} // namespace rbvi::large_deformations_test
