// Contact with friction on a rigid disk from snapshots to answers: every reduction, every
// parameter.
#include "disk.hpp"
#include "reduced.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/law_problem.hpp"
#include "rbvi/solve/response_solver.hpp"
#include "rbvi/study/stability_report.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

namespace rbvi::rigid_disk_test {
namespace {

using namespace testing_reduced;

struct Worst {
  double u, lambda, tangential;
};

/// Largest errors at unseen parameters.
Worst errors_of(Reduced &r, const ReduceOptions &options, const std::vector<Sample> &unseen) {
  r.reduce(options);
  check_model(r.model);
  const ModelErrors e = r.errors_at(unseen);
  EXPECT_EQ(e.failed, 0);
  return {e.u.maxCoeff(), e.lambda.maxCoeff(),
          e.tangential.size() > 0 ? e.tangential.maxCoeff() : 0};
}

void expect_condensed(const Scene &scene, const std::string &training, double u = 1e-8) {
  Reduced r(scene, training);
  const auto unseen = solve_all(r.problem, parse_set(r.problem.scene().parameters, "random:6:3"));
  const Worst e = errors_of(r, with(MultiplierReduction::condensed), unseen);
  EXPECT_LE(e.u, u);
  EXPECT_LE(e.lambda, 1e-8);
  EXPECT_LE(e.tangential, 1e-8);
  OnlineSolver online(r.model);
  for (const Sample &truth : unseen) {
    const Outputs found = online.outputs(truth.mu, online.solve(truth.mu));
    for (const auto quantity :
         {&Outputs::energy, &Outputs::normal_force, &Outputs::reaction, &Outputs::peak_pressure,
          &Outputs::centre_pressure, &Outputs::contact_half_width, &Outputs::tangential_force,
          &Outputs::stick_half_width}) {
      ASSERT_EQ((found.*quantity).has_value(), (truth.outputs.*quantity).has_value());
      if (truth.outputs.*quantity) {
        EXPECT_NEAR(*(found.*quantity), *(truth.outputs.*quantity),
                    1e-7 * std::abs(*(truth.outputs.*quantity)) + 1e-12);
      }
    }
    EXPECT_NEAR(*found.max_penetration, *truth.outputs.max_penetration, 1e-7 + 0.1 * e.u);
    EXPECT_LE(found.friction_violation.value_or(0), 1e-12 * *found.peak_pressure);
  }
}

TEST(CondensedModel, AnswersUnseenRadiiToRoundOff) {
  expect_condensed(disk("radius"), "grid:13");
}

TEST(CondensedModel, AnswersEveryLawOfFriction) {
  expect_condensed(disk("radius", {{"friction", "none"}}), "grid:13");
  expect_condensed(disk("radius,friction_threshold", {{"friction", "tresca"}}), "random:30:1");
}

TEST(CondensedModel, AnswersFreeIndentationAndFriction) {
  expect_condensed(disk("radius,indentation,friction_coefficient"), "random:40:1");
}

TEST(CondensedModel, AnswersFreeStiffness) {
  expect_condensed(disk("radius,core_stiffness"), "random:24:1", 1e-5);
  expect_condensed(disk("poisson_ratio"), "grid:9", 1e-5);
}

TEST(CondensedModel, AnswersNormalsOfTheRigidDisk) {
  expect_condensed(disk("radius", {{"normal", "rigid"}}), "grid:21", 1e-4);
}

TEST(CondensedModel, AnswersWithDisplacementsOfDegreeOne) {
  expect_condensed(disk("radius", {{"degree", "1"}}), "grid:13");
}

TEST(CondensedModel, AnswersOnTheWideArc) {
  expect_condensed(disk("radius,indentation", {{"contact_arc", "wide"}}), "random:30:1");
}

/// With few samples the multipliers are as good as with many: nothing of them is learnt.
TEST(CondensedModel, NeedsNoSnapshotOfTheMultipliers) {
  Reduced r(disk("radius"), "grid:3");
  const auto unseen = solve_all(r.problem, parse_set(r.problem.scene().parameters, "random:4:5"));
  ReduceOptions options = with(MultiplierReduction::condensed);
  options.eim.tolerance = 0;
  const Worst few = errors_of(r, options, unseen);
  EXPECT_LE(few.lambda, 1e-2) << "what three radii miss is the gap, not the law";
  EXPECT_LE(few.tangential, 1e-2);
  options.multipliers.exact = false;
  r.reduce(options);
  EXPECT_GT(r.model.body.supremizers, 0)
      << "responses join, whatever is mended of other reductions";
}

/// The full problem with multipliers that are hat functions of the coarser mesh: its body is asked
/// for what it does under those of the model, and the laws are judged at the coarser nodes.
TEST(CondensedModel, KeepsTheLawOnTheHatsOfACoarserMesh) {
  MeshOptions fine;
  fine.refine = 1;
  Reduced r(disk("radius", {{"arc_edges", "20"}}), "grid:13", PETSC_COMM_WORLD, fine);
  ReduceOptions options = with(MultiplierReduction::condensed);
  options.cone.level = 1;
  r.reduce(options);
  check_model(r.model);
  const Problem coarse(PETSC_COMM_WORLD, disk("radius", {{"arc_edges", "20"}}), {});
  const Matrix &hats = r.model.contact.dual_basis;
  const Index nodes = coarse.contact().nodes();
  EXPECT_EQ(hats.cols(), 2 * ((nodes + 1) / 2)) << "pairs of mirror images, of two components";
  EXPECT_EQ(hats.rows(), 2 * (2 * nodes - 1));
  OnlineSolver online(r.model);
  for (const Sample &truth : solve_all(r.problem, {{0.83}, {1.21}})) {
    const ReducedAnswer solution = online.solve(truth.mu);
    const Operators &op = r.problem.assemble(truth.mu);
    ResponseSolver body(op.a, r.problem.trace(), "hf_");
    const Vector lambda = hats * solution.lambda;
    const Vector w = hats.transpose() * (op.g + op.b * body.responses(op.b.transpose() * lambda));
    const Vector &x = solution.lambda;
    const Index k = hats.cols() / 2;
    EXPECT_GE(x.head(k).minCoeff(), 0);
    EXPECT_GE(w.head(k).minCoeff(), -1e-8 * w.maxCoeff());
    EXPECT_LE(x.head(k).cwiseProduct(w.head(k)).cwiseAbs().maxCoeff(),
              1e-8 * x.maxCoeff() * w.maxCoeff());
    for (Index i = 0; i < k; ++i) {
      const double bound = r.problem.contact().interfaces.front()->bound(solution.mu).value(x[i]);
      EXPECT_LE(std::abs(x[k + i]), bound * (1 + 1e-12));
      EXPECT_LE(x[k + i] * w[k + i], 1e-8 * x.maxCoeff() * w.cwiseAbs().maxCoeff())
          << "node " << i << ": friction opposes the slip";
      if (std::abs(x[k + i]) < bound * (1 - 1e-8)) {
        EXPECT_NEAR(w[k + i], 0, 1e-8 * w.cwiseAbs().maxCoeff()) << "node " << i << " sticks";
      }
    }
    const Outputs found = online.outputs(truth.mu, solution);
    EXPECT_NEAR(*found.energy, *truth.outputs.energy, 1e-3 * *truth.outputs.energy);
    EXPECT_NEAR(*found.reaction, *truth.outputs.reaction, 1e-3 * *truth.outputs.reaction);
  }
}

TEST(CondensedModel, DuplicatedSamplesChangeNothing) {
  const Scene scene = disk("radius");
  Reduced once(scene, "grid:7"), twice(scene, "grid:7");
  twice.samples.insert(twice.samples.end(), once.samples.begin(), once.samples.end());
  const auto unseen = solve_all(once.problem, {{0.83}});
  const Worst a = errors_of(once, with(MultiplierReduction::condensed), unseen);
  const Worst b = errors_of(twice, with(MultiplierReduction::condensed), unseen);
  EXPECT_EQ(once.model.body.modes, twice.model.body.modes);
  EXPECT_NEAR(a.u, b.u, 1e-8);
}

TEST(CondensedModel, SurvivesItsFile) {
  Reduced r(disk("radius,core_stiffness"), "random:8:1", PETSC_COMM_SELF);
  r.reduce(with(MultiplierReduction::condensed));
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("rigid_disk." + std::to_string(rank) + ".h5");
  write_model(r.model, path);
  const ReducedModel again = read_model(path, catalogue());
  std::filesystem::remove(path);
  std::filesystem::remove(fields_file(path));
  OnlineSolver a(r.model), b(again);
  for (const Mu &mu : {Mu{0.8, 0.7}, Mu{1.2, 3}}) {
    const ReducedAnswer x = a.solve(mu), y = b.solve(mu);
    EXPECT_EQ(x.lambda, y.lambda);
    EXPECT_EQ(x.u, y.u);
    EXPECT_EQ(b.field(y), a.field(x));
  }
}

/// Where the law is violated at some node, exact steps follow.
TEST(MultiplierReductions, CollocatedIsMendedToTheExactAnswer) {
  Reduced r(disk("radius"), "grid:21");
  const auto unseen = solve_all(r.problem, parse_set(r.problem.scene().parameters, "random:5:2"));
  ReduceOptions options = with(MultiplierReduction::collocated);
  options.multipliers.tangential = 1e-8;
  options.cone.tolerance = 1e-6;
  const Worst e = errors_of(r, options, unseen);
  EXPECT_LE(e.lambda, 1e-5);
  EXPECT_LE(e.tangential, 1e-5);
}

TEST(MultiplierReductions, CollocatedWithoutTheCondensedOperatorIsAsAccurateAsPublishedOrBetter) {
  Reduced r(disk("radius"), "grid:21");
  const auto unseen = solve_all(r.problem, parse_set(r.problem.scene().parameters, "random:5:2"));
  ReduceOptions options = with(MultiplierReduction::collocated);
  options.multipliers.exact = false;
  options.multipliers.tangential = 1e-4;
  options.cone.tolerance = 1e-3;
  const Worst e = errors_of(r, options, unseen);
  EXPECT_EQ(r.model.contact.law->condensed.terms.size(), 0);
  EXPECT_LE(e.u, 1e-2);
  EXPECT_LE(e.lambda, 5e-2);
  EXPECT_LE(e.tangential, 0.39) << "the error published";
  EXPECT_FALSE(r.model.contact.law->basis.nodes.empty());
}

/// A cone of lambda_n and supremizers, no modes of lambda_tau and no collocation nodes: the limit
/// of the coefficient of friction going to zero.
TEST(MultiplierReductions, CollocatedWithoutFriction) {
  Reduced r(disk("radius", {{"friction", "none"}}), "grid:21");
  const auto unseen = solve_all(r.problem, parse_set(r.problem.scene().parameters, "random:5:2"));
  ReduceOptions options = published();
  const Worst reduced = errors_of(r, options, unseen);
  EXPECT_LE(reduced.u, 1e-2);
  EXPECT_LE(reduced.lambda, 5e-2);
  EXPECT_EQ(r.model.contact.law->basis.tangential.size(), 0);
  EXPECT_TRUE(r.model.contact.law->basis.nodes.empty());
  const StabilityCheck check = make_stability_check(r.problem, r.model);
  for (const InfSup &c : infsup_over(PETSC_COMM_WORLD, r.problem, check, at_rest(r.mus()), true))
    EXPECT_GE(c.off, c.hf * (1 - 1e-9)) << "the greedy's tolerance is that of (2.23)";

  options.multipliers.exact = true;
  options.cone.tolerance = 1e-6;
  EXPECT_LE(errors_of(r, options, unseen).lambda, 1e-5) << "mended on the condensed operator";

  Scene scene = disk("radius");
  scene.parameters.all[2].value = 1e-9;
  Reduced slippery(scene, "grid:21");
  slippery.reduce(published());
  r.reduce(published());
  const Matrix &cone = r.model.contact.law->basis.normal;
  ASSERT_EQ(slippery.model.contact.law->basis.normal.cols(), cone.cols());
  EXPECT_LE((slippery.model.contact.law->basis.normal - cone).norm(), 1e-5 * cone.norm());
  OnlineSolver a(r.model), b(slippery.model);
  for (const Sample &truth : unseen) {
    const double force = *a.outputs(truth.mu, a.solve(truth.mu)).normal_force;
    EXPECT_NEAR(*b.outputs(truth.mu, b.solve(truth.mu)).normal_force, force, 1e-6 * force);
  }
}

/// (3.55) to (3.19), and with the bound at every node (3.40): the fixed point is that of the exact
/// solver, and what is left of it is of the order of the last step over the slowest contraction.
TEST(MultiplierReductions, CollocatedByUzawasMethod) {
  Reduced r(disk("radius"), "grid:21");
  ReduceOptions options = published();
  for (const CollocationNodes nodes : {CollocationNodes::best, CollocationNodes::all}) {
    options.gcns.nodes = nodes;
    r.reduce(options);
    const bool all = nodes == CollocationNodes::all;
    EXPECT_EQ(std::ssize(r.model.contact.law->basis.nodes) == r.model.contact.law->normal, all);
    OnlineSolver exact(r.model), steps(r.model, {.method = OnlineMethod::uzawa});
    for (const Mu &mu : {Mu{0.83}, Mu{1.21}}) {
      const ReducedAnswer a = exact.solve(mu), b = steps.solve(mu);
      EXPECT_LE(b.residual, 1e-6);
      EXPECT_GT(b.iterations, 100) << "of fixed step, one gradient each";
      EXPECT_LE((exact.multiplier(a) - steps.multiplier(b)).norm(),
                1e-2 * exact.multiplier(a).norm());
      EXPECT_NEAR(b.energy, a.energy, 1e-3 * a.energy);
      EXPECT_GE(b.lambda.head(r.model.contact.law->normal).minCoeff(), -1e-14);
    }
    EXPECT_THROW(OnlineSolver(r.model, {.method = OnlineMethod::kacanov}), Error);
  }
  r.model.made.settings["online_method"] = "uzawa";
  EXPECT_GT(OnlineSolver(r.model).solve({0.83}).iterations, 100) << "the model's method is taken";
  r.model.made.settings["online_method"] = "newton";
  EXPECT_THROW(OnlineSolver(r.model).solve({0.83}), Error);
}

/// Where b only scales all supremizers are one space, made offline or online: the same answers.
TEST(MultiplierReductions, CollocatedWithOnlineEnrichment) {
  Reduced r(disk("radius"), "grid:21");
  const auto unseen = solve_all(r.problem, parse_set(r.problem.scene().parameters, "random:5:2"));
  ReduceOptions options = published();
  options.pga.tolerance = 1e-9;
  options.infsup_tolerance = false;
  const Worst offline = errors_of(r, options, unseen);
  const std::vector<int> nodes = r.model.contact.law->basis.nodes;
  options.enrichment = Enrichment::online;
  const Worst online = errors_of(r, options, unseen);
  EXPECT_TRUE(r.model.body.online_enriched);
  EXPECT_EQ(r.model.contact.law->basis.nodes, nodes);
  EXPECT_NEAR(online.u, offline.u, 1e-2 * offline.u);
  EXPECT_NEAR(online.lambda, offline.lambda, 1e-2 * offline.lambda);
  EXPECT_NEAR(online.tangential, offline.tangential, 1e-2 * offline.tangential);
}

/// Where every mu has supremizers of its own, the space of a query holds those of its mu: b on it
/// is b, and the displacement lies in it. It is smaller than the offline space, which holds those
/// of all training mu.
TEST(MultiplierReductions, OnlineEnrichmentFollowsTheNormal) {
  Reduced r(disk("radius", {{"normal", "rigid"}}), "grid:21");
  const auto unseen = solve_all(r.problem, parse_set(r.problem.scene().parameters, "random:5:2"));
  ReduceOptions options = published();
  options.enrichment = Enrichment::online;
  const Worst online = errors_of(r, options, unseen);
  EXPECT_LE(online.u, 1e-2);
  EXPECT_LE(online.lambda, 5e-2);
  EXPECT_LE(online.tangential, 5e-2);
  const Matrix functions = multiplier_coefficients(r.model.contact.law->basis);
  OnlineSolver solver(r.model);
  for (const Sample &truth : unseen) {
    const ReducedAnswer answer = solver.solve(truth.mu);
    const Matrix b =
        functions.transpose() * (r.model.contact.b.reduced * answer.theta_b)
                                    .reshaped(r.model.contact.generators, r.model.primal_size());
    const Matrix z = enriched_subspace(b, r.model.body.modes);
    EXPECT_EQ(z.cols(), r.model.body.modes + functions.cols());
    EXPECT_LT(z.cols(), r.model.primal_size());
    EXPECT_LE((z.transpose() * z - Matrix::Identity(z.cols(), z.cols())).norm(), 1e-12);
    EXPECT_LE((b - b * z * z.transpose()).norm(), 1e-12 * b.norm());
    EXPECT_LE((answer.u - z * (z.transpose() * answer.u)).norm(), 1e-12 * answer.u.norm());
  }
}

/// The patch test of one block: tractions on its sides, and the exact pressure (lambda + 2 G)
/// strain.
TEST(MultiplierReductions, CollocatedOrCondensedWithALoad) {
  for (const char *friction : {"coulomb", "none"}) {
    SCOPED_TRACE(friction);
    Scene scene = make_scene("patch", {{"bodies", "one"}, {"degree", "2"}, {"friction", friction}});
    scene.parameters = free_only(scene.parameters, "indentation,shear");
    Reduced r(scene, "grid:3,4");
    ReduceOptions online_enriched = published();
    online_enriched.enrichment = Enrichment::online;
    for (const ReduceOptions &options :
         {published(), online_enriched, with(MultiplierReduction::condensed)}) {
      r.reduce(options);
      EXPECT_EQ(r.model.made.self_check.unanswered, 0);
      OnlineSolver online(r.model);
      for (const Mu &mu : {Mu{0.037, 0.01}, Mu{0.081, 0.19}}) { // sticks, slips
        const Sample truth = solve_all(r.problem, {mu}).front();
        const ReducedAnswer answer = online.solve(mu);
        const Outputs found = online.outputs(mu, answer);
        const double pressure = 15 * (1 - 0.35) / (1.35 * 0.3) * mu[0] / 0.5;
        EXPECT_NEAR(*found.peak_pressure, pressure, 1e-10 * pressure);
        EXPECT_NEAR(*found.energy, *truth.outputs.energy, 1e-10 * std::abs(*truth.outputs.energy));
        EXPECT_LE((online.field(answer) - truth.u).norm(), 1e-10 * truth.u.norm());
        EXPECT_LE((online.multiplier(answer) - truth.lambda).norm(), 1e-10 * truth.lambda.norm());
      }
    }
  }
}

TEST(MultiplierReductions, CollocatedRefusesFunctionsOfEitherSign) {
  Reduced s(disk("radius"), "grid:3");
  ReduceOptions hybrid = with(MultiplierReduction::collocated);
  hybrid.cone.type = ConeType::hybrid;
  EXPECT_THROW(s.reduce(hybrid), Error);
}

TEST(CondensedModel, NoContactAnywhereIsSaid) {
  Scene scene = disk("indentation");
  scene.parameters.all[1].lower = 1e-4;
  scene.parameters.all[1].upper = 9e-4;
  Reduced r(scene, "grid:3");
  try {
    r.reduce(with(MultiplierReduction::condensed));
    FAIL() << "there is nothing to reduce";
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("no contact"), std::string::npos);
  }
}

} // namespace
} // namespace rbvi::rigid_disk_test
