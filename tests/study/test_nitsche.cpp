// Nitsche's method from snapshots to answers: all points of the curve, few of them, or interpolated
// operators; every law, every parameter.
#include "../mesh/gmsh_writer.hpp"
#include "reduced.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/study/output_errors.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace rbvi::nitsche_test {
namespace {

using namespace testing_reduced;

Scene disk(const std::string &friction, const std::string &free = "radius") {
  Scene scene = make_scene(
      "rigid_disk", {{"formulation", "nitsche"}, {"friction", friction}, {"arc_edges", "40"}});
  scene.parameters = free_only(scene.parameters, free);
  return scene;
}

ReduceOptions with(CurveRule rule, PetscInt modes = 0) {
  ReduceOptions options;
  options.pod.tolerance = 1e-9;
  options.pod.max_size = modes;
  options.curve.rule = rule;
  options.curve.eim_tolerance = 1e-10;
  return options;
}

/// The reduced model with all modes against its own snapshots.
void expect_snapshots_back(Reduced &r, CurveRule rule, double tolerance) {
  r.reduce(with(rule));
  check_model(r.model);
  const ModelErrors e = r.errors_at(r.samples);
  EXPECT_EQ(e.failed, 0);
  EXPECT_LE(e.u.maxCoeff(), tolerance);
  EXPECT_LE(e.lambda.maxCoeff(), 100 * tolerance); // stress: derivatives of u
}

/// On each rank by itself: how one problem is shared among ranks is tested with the solver.
struct ReducedAlone : Reduced {
  ReducedAlone(const Scene &scene, const std::string &training)
      : Reduced(scene, training, PETSC_COMM_SELF) {}
};

class NitscheLaws : public ::testing::TestWithParam<const char *> {};
INSTANTIATE_TEST_SUITE_P(Reduced, NitscheLaws, ::testing::Values("none", "tresca", "coulomb"));

TEST_P(NitscheLaws, TheWholeCurveGivesTheSnapshotsBack) {
  Reduced r(disk(GetParam()), "grid:9");
  expect_snapshots_back(r, CurveRule::full, 1e-8);
}

TEST_P(NitscheLaws, FewPointsAddWhatTheToleranceAllows) {
  ReducedAlone r(disk(GetParam()), "grid:13");
  ReduceOptions options = with(CurveRule::empirical, 6);
  for (const double tolerance : {1e-3, 1e-6}) {
    options.curve.tolerance = tolerance;
    options.curve.rule = CurveRule::full;
    r.reduce(options);
    OnlineSolver full(r.model);
    const ReducedModel all = r.model;
    OnlineSolver of_all(all);
    options.curve.rule = CurveRule::empirical;
    r.reduce(options);
    const NitscheModel &curve = *r.model.contact.nitsche;
    EXPECT_GT(curve.factors.minCoeff(), 0);
    EXPECT_LT(curve.points.size(), 160u / 2) << "of 160, half of them mirror images";
    OnlineSolver few(r.model);
    for (const Sample &sample : r.samples) {
      const Vector u = of_all.solve(sample.mu).u;
      EXPECT_LE((few.solve(sample.mu).u - u).norm(), tolerance * u.norm());
    }
  }
}

TEST_P(NitscheLaws, EverySizeAnswersTheWholeBox) {
  ReducedAlone r(disk(GetParam()), "grid:13");
  const auto unseen = solve_all(r.problem, parse_set(r.problem.scene().parameters, "random:6:3"));
  for (const int modes : {1, 2, 5, 9})
    for (const CurveRule rule : {CurveRule::empirical, CurveRule::full}) {
      r.reduce(with(rule, modes));
      const ModelErrors e = r.errors_at(unseen);
      EXPECT_EQ(e.failed, 0) << modes;
      EXPECT_LE(e.u.maxCoeff(), 2 * e.u_floor.maxCoeff()) << modes;
    }
}

/// A roller between two plates, one with friction: each rule takes the points of both arcs.
TEST(NitscheReduced, TwoCurvesGiveTheSnapshotsBack) {
  Scene scene = make_scene("roller", {{"formulation", "nitsche"}, {"arc_edges", "12"}});
  scene.parameters = free_only(scene.parameters, "tilt");
  ReducedAlone r(scene, "grid:7");
  expect_snapshots_back(r, CurveRule::interpolated, 1e-6);
  expect_snapshots_back(r, CurveRule::full, 1e-8);
  EXPECT_TRUE(describe_curve(r.model) == "96 of 96 Gauss points") << describe_curve(r.model);
  OnlineSolver whole(r.model);
  const Sample &last = r.samples.back();
  const Truths truths = make_truths(r.problem, r.model, {last});
  const Index tangential = 13, normal = last.lambda.size() - tangential; // of the lower arc alone
  Vector rubbing = last.lambda;
  rubbing.head(normal).setZero();
  EXPECT_NEAR(truths.tangential_norm[0], std::sqrt(rubbing.dot(r.problem.w_product() * rubbing)),
              1e-14);
  const Outputs outputs = whole.outputs(last.mu, whole.solve(last.mu, true));
  EXPECT_NEAR(*outputs.normal_force, *last.outputs.normal_force, 1e-7 * *outputs.normal_force);
  EXPECT_NEAR(*outputs.tangential_force, *last.outputs.tangential_force,
              1e-7 * *outputs.normal_force);
  r.reduce(with(CurveRule::empirical));
  const auto &points = r.model.contact.nitsche->points;
  EXPECT_LT(points.front(), 48) << "of the upper arc";
  EXPECT_GE(points.back(), 48) << "of the lower one";
  EXPECT_LT(points.size(), 96u);
  EXPECT_LE(r.errors_at(r.samples).u.maxCoeff(), 1e-6);
}

TEST(NitscheReduced, InterpolatedOperatorsGiveTheSnapshotsBack) {
  for (const char *friction : {"none", "coulomb"}) {
    SCOPED_TRACE(friction);
    ReducedAlone r(disk(friction), "grid:7");
    expect_snapshots_back(r, CurveRule::interpolated, 1e-6);
    EXPECT_GT(r.model.contact.nitsche->contact_matrix.size(), 0);
    EXPECT_EQ(r.model.contact.nitsche->friction_vector.size() > 0,
              friction == std::string("coulomb"));
  }
}

ReduceOptions published() {
  ReduceOptions options = with(CurveRule::interpolated);
  options.curve.published_pairs = true;
  return options;
}

/// With Tresca's law B^n + B^tau has one interpolation, over plain steps: what the answers and the
/// terms at the training steps are stays as it is.
TEST(NitscheReduced, TangentsInterpolatedTogetherGiveTheSnapshotsBack) {
  ReducedAlone r(disk("tresca"), "grid:7");
  r.reduce(published());
  check_model(r.model);
  const NitscheModel &curve = *r.model.contact.nitsche;
  EXPECT_EQ(curve.contact_matrix.size(), 0);
  EXPECT_GT(curve.friction_matrix.size(), 0);
  EXPECT_GT(curve.contact_vector.size(), 0);
  EXPECT_TRUE(describe_curve(r.model).starts_with("terms: B^n + B^tau "))
      << describe_curve(r.model);
  const auto &histories = r.model.made.histories;
  EXPECT_FALSE(histories.contains("curve/contact_matrix"));
  EXPECT_LE(histories.at("curve/friction_matrix").back(), 1e-10);
  int pairs = 0;
  NitscheSolver plain(r.problem, {.plain_steps = true});
  for (const Sample &sample : r.samples)
    pairs += plain.solve(r.problem.assemble(sample.mu)).iterations + 1;
  EXPECT_EQ(histories.at("curve/states").front(), pairs);
  const ModelErrors e = r.errors_at(r.samples);
  EXPECT_EQ(e.failed, 0);
  EXPECT_LE(e.u.maxCoeff(), 1e-6);
}

TEST(NitscheReduced, OfCoulombsLawTheEndsOfLoopsAreTaken) {
  ReducedAlone r(disk("coulomb"), "grid:7");
  r.reduce(published());
  int loops = 0;
  NitscheSolver solver(r.problem, {});
  solver.loop_end = [&](const Vector &, const Vector &) { ++loops; };
  for (const Sample &sample : r.samples)
    (void)solver.solve(r.problem.assemble(sample.mu));
  EXPECT_EQ(r.model.made.histories.at("curve/states").front(), loops);
  EXPECT_GT(r.model.contact.nitsche->contact_matrix.size(), 0);
  EXPECT_LE(r.errors_at(r.samples).u.maxCoeff(), 1e-6);
}

/// (4.79) from u_0 goes through the very steps of the training where those are interpolated.
TEST(NitscheReduced, ThePublishedIterationEndsInTheAnswerOfTheOther) {
  for (const char *friction : {"none", "tresca"}) {
    SCOPED_TRACE(friction);
    ReducedAlone r(disk(friction), "grid:7");
    ReduceOptions options = published();
    options.pod.tolerance = 0;
    r.reduce(options);
    OnlineSolver usual(r.model), newton(r.model, {.method = OnlineMethod::newton});
    for (const Sample &sample : r.samples) {
      const ReducedAnswer answer = newton.solve(sample.mu);
      const Vector u = usual.solve(sample.mu).u;
      EXPECT_LE((answer.u - u).norm(), 1e-8 * u.norm());
      EXPECT_GT(answer.iterations, usual.solve(sample.mu).iterations);
    }
  }
}

/// Beyond its training radii it cycles, where the other goes on by the derivative.
TEST(NitscheReduced, ThePublishedIterationHasNoRescue) {
  ReducedAlone r(disk("none"), "grid:13 in radius=0.7,1");
  ReduceOptions options = with(CurveRule::interpolated);
  options.curve.eim_tolerance = 1e-6;
  r.reduce(options);
  OnlineSolver usual(r.model);
  OnlineSolver newton(r.model, {.method = OnlineMethod::newton});
  int lost = 0;
  for (const Mu &mu : parse_set(r.problem.scene().parameters, "grid:21"))
    try {
      EXPECT_LE(usual.solve(mu).residual, 1e-8);
      EXPECT_LE(newton.solve(mu).residual, 1e-8);
    } catch (const Error &error) {
      ++lost;
      EXPECT_NE(std::string(error.what()).find("use the method exact"), std::string::npos);
    }
  EXPECT_GT(lost, 0);
  r.reduce(with(CurveRule::full, 5));
  EXPECT_THROW(OnlineSolver(r.model, {.method = OnlineMethod::newton}), Error);
}

/// Over the training set, they are those that the selection saw.
TEST(NitscheReduced, ErrorsOfTheInterpolationAreMeasuredOverFurtherParameters) {
  ReducedAlone r(disk("none"), "grid:7");
  ReduceOptions options = with(CurveRule::interpolated);
  options.curve.eim_tolerance = 1e-6;
  const auto histories_with = [&](const std::vector<Mu> &others) {
    options.curve.eim_validation = others;
    r.reduce(options);
    return r.model.made.histories;
  };
  const ParameterSpace &space = r.problem.scene().parameters;
  const auto same = histories_with(parse_set(space, "grid:7"));
  const auto unseen = histories_with(parse_set(space, "random:3:5"));
  for (const std::string name : {"curve/contact_matrix", "curve/contact_vector"}) {
    const std::vector<double> &training = same.at(name), &again = same.at(name + "_validation");
    ASSERT_EQ(again.size(), training.size());
    for (std::size_t j = 0; j < training.size(); ++j)
      EXPECT_NEAR(again[j], training[j], 1e-9) << name << ", " << j << " terms";
    EXPECT_GT(unseen.at(name + "_validation").back(), 1e-4);
  }
}

/// Matrices and vectors are interpolated apart, so that one is not the derivative of the other.
TEST(NitscheReduced, RoughlyInterpolatedOperatorsAnswerTheWholeBox) {
  ReducedAlone r(disk("tresca"), "grid:13");
  for (const int modes : {5, 9}) {
    ReduceOptions options = with(CurveRule::interpolated, modes);
    options.curve.eim_tolerance = 1e-2;
    r.reduce(options);
    OnlineSolver online(r.model);
    for (const Mu &mu : parse_set(r.problem.scene().parameters, "grid:61"))
      EXPECT_LE(online.solve(mu).residual, 1e-8) << mu[0]; // (4.26): u within 1e-10
  }
}

/// Contact that follows the displacement: the axes of the points turn with the reduced answer.
TEST_P(NitscheLaws, OfTheDeformedBodyTheWholeCurveGivesTheSnapshotsBackAndFewPointsNearly) {
  Scene scene = make_scene("rigid_disk", {{"formulation", "nitsche"},
                                          {"friction", GetParam()},
                                          {"kinematics", "large"},
                                          {"arc_edges", "40"}});
  scene.parameters = free_only(scene.parameters, "indentation,offset");
  ReducedAlone r(scene, "grid:5,3");
  expect_snapshots_back(r, CurveRule::full, 1e-8);
  EXPECT_EQ(r.model.contact.nitsche->states.cols(), 15);
  const auto unseen = solve_all(r.problem, parse_set(scene.parameters, "random:5:3"));
  for (const int modes : {3, 8}) {
    r.reduce(with(CurveRule::empirical, modes));
    const ModelErrors e = r.errors_at(unseen);
    EXPECT_EQ(e.failed, 0) << modes;
    EXPECT_LE(e.u.maxCoeff(), 2 * e.u_floor.maxCoeff()) << modes;
  }
  EXPECT_THROW(r.reduce(with(CurveRule::interpolated)), Error);
}

/// a_gamma - a is of one term where the map is a similarity, of the three products of two Lame
/// constants (over lambda + 2 shear) with Poisson's ratio.
TEST(NitscheReduced, ConsistencyIsASumOfFewTerms) {
  for (const auto &[free, terms] :
       {std::pair{"radius", 1}, {"radius,core_stiffness", 1}, {"radius,poisson_ratio", 3}}) {
    ReducedAlone r(disk("coulomb", free), free == std::string("radius") ? "grid:4" : "grid:3,4");
    r.reduce(with(CurveRule::full));
    EXPECT_EQ(r.model.contact.nitsche->consistency.size(), terms) << free;
  }
}

TEST(NitscheReduced, EveryParameterIsReduced) {
  for (const auto &[free, error] : {std::pair{"radius,core_stiffness", 5e-3},
                                    {"radius,poisson_ratio", 1e-2},
                                    {"indentation,friction_coefficient", 2e-2}}) {
    SCOPED_TRACE(free);
    ReducedAlone r(disk("coulomb", free), "grid:5,5");
    const auto unseen = solve_all(r.problem, parse_set(r.problem.scene().parameters, "random:5:3"));
    ReduceOptions options = with(CurveRule::empirical);
    options.pod.tolerance = 1e-5;
    r.reduce(options);
    const ModelErrors e = r.errors_at(unseen);
    EXPECT_EQ(e.failed, 0);
    EXPECT_LE(e.u.maxCoeff(), std::max(error, 2 * e.u_floor.maxCoeff()));
  }
}

TEST(NitscheReduced, OutputsAreThoseOfTheSnapshots) {
  ReducedAlone r(disk("coulomb"), "grid:9");
  r.reduce(with(CurveRule::full));
  OnlineSolver online(r.model);
  for (const Sample &truth : r.samples) {
    const ReducedAnswer solution = online.solve(truth.mu);
    const Outputs found = online.outputs(truth.mu, solution);
    for (const auto quantity :
         {&Outputs::energy, &Outputs::normal_force, &Outputs::reaction, &Outputs::tangential_force,
          &Outputs::contact_half_width, &Outputs::peak_pressure, &Outputs::centre_pressure,
          &Outputs::law_error_normal, &Outputs::law_error_tangential})
      EXPECT_NEAR(*(found.*quantity), *(truth.outputs.*quantity),
                  1e-5 * std::abs(*(truth.outputs.*quantity)));
    EXPECT_LE(*found.kkt_residual, 1e-9);
    EXPECT_FALSE(found.quadrature_residual) << "all points are those of the whole curve";
  }
}

/// Energies, forces and pressures at unseen parameters, whatever the points that u comes from.
TEST_P(NitscheLaws, OutputsAreAsAccurateAsTheFields) {
  ReducedAlone r(disk(GetParam()), "grid:13");
  const auto unseen = solve_all(r.problem, parse_set(r.problem.scene().parameters, "random:8:3"));
  std::vector<Mu> set;
  std::vector<Outputs> truth;
  for (const Sample &sample : unseen) {
    set.push_back(sample.mu);
    truth.push_back(sample.outputs);
  }
  for (const CurveRule rule : {CurveRule::empirical, CurveRule::full, CurveRule::interpolated}) {
    r.reduce(with(rule, 8));
    const ModelErrors fields = r.errors_at(unseen);
    const double allowed =
        std::max(1e-4, 10 * std::max(fields.u.maxCoeff(), fields.lambda.maxCoeff()));
    for (const OutputError &error : output_errors(reduced_outputs(r.model, set), truth))
      if (output_column(error.name).kind == OutputKind::quantity) {
        EXPECT_LE(error.max_of_value, allowed) << error.name;
      }
  }
}

/// The answer of few points is compared with the integrals over the whole curve.
TEST(NitscheReduced, OutputsTellHowFarTheIntegralsAreMissed) {
  ReducedAlone r(disk("none"), "grid:13");
  ReduceOptions options = with(CurveRule::empirical, 6);
  double last = 1;
  for (const double tolerance : {1e-2, 1e-4, 1e-7}) {
    options.curve.tolerance = tolerance;
    r.reduce(options);
    OnlineSolver online(r.model);
    const ReducedAnswer solution = online.solve({0.93});
    EXPECT_LE(solution.residual, 1e-9) << "of its own problem";
    const double missed = *online.outputs({0.93}, solution).quadrature_residual;
    EXPECT_LT(missed, last);
    last = missed;
  }
}

TEST(NitscheReduced, AFileGivesTheSameModelAndItsLeadingPart) {
  ReducedAlone r(disk("coulomb"), "grid:9");
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("nitsche_model_" + std::to_string(rank) + ".h5");
  for (const CurveRule rule : {CurveRule::empirical, CurveRule::full, CurveRule::interpolated}) {
    r.reduce(with(rule));
    write_model(r.model, file);
    const ReducedModel read = read_model(file, catalogue());
    const Vector u = OnlineSolver(r.model).solve({0.87}).u;
    EXPECT_EQ(OnlineSolver(read).solve({0.87}).u, u);
    EXPECT_EQ(read.contact.nitsche->points, r.model.contact.nitsche->points);
    const ReducedModel part = leading(read, 3, 0);
    check_model(part);
    if (rule == CurveRule::full) {
      EXPECT_EQ(OnlineSolver(part).solve({0.87}).u.size(), 3);
    }
    std::filesystem::remove(file);
    std::filesystem::remove(fields_file(file));
  }
}

TEST(NitscheReduced, NoContactAnywhereIsAFailureThatSaysSo) {
  Scene scene = disk("none", "radius");
  scene.parameters.all[1].value = 0.0005; // indentation, below the gap
  ReducedAlone r(scene, "grid:3");
  EXPECT_THROW(r.reduce(with(CurveRule::empirical)), Error);
}

/// The half disk with the nodes of its arc turned to one side, as a file of each rank's own.
std::string one_sided_mesh() {
  SerialMesh mesh = half_disc(40);
  for (Point &x : mesh.points) {
    const double r = std::hypot(x[0], x[1]), angle = std::atan2(x[0], -x[1]),
                 part = angle / (std::numbers::pi / 8);
    if (r <= 0.6 || std::abs(part) >= 1) continue;
    const double turned = angle + 0.01 * (r - 0.6) / 0.4 * (1 - part * part);
    x = {r * std::sin(turned), -r * std::cos(turned), 0};
  }
  const std::string file = testing::TempDir() + "rbvi_one_sided_" + std::to_string(getpid());
  std::ofstream(file, std::ios::binary) << written(drawing_of(mesh), {"4.1", true});
  return file;
}

/// One half of the points must not stand for both.
TEST(NitscheMeshes, AMeshThatIsNotSymmetricKeepsThePointsOfBothSides) {
  const std::string file = one_sided_mesh();
  Problem problem(PETSC_COMM_SELF, disk("coulomb"), {file, 0});
  std::filesystem::remove(file);
  const auto samples = solve_all(problem, parse_set(problem.scene().parameters, "grid:5"));
  ReduceOptions options = with(CurveRule::empirical);
  options.curve.tolerance = 1e-7;
  const ReducedModel few = rbvi::reduce(problem, samples, options).model;
  options.curve.rule = CurveRule::full;
  const ReducedModel all = rbvi::reduce(problem, samples, options).model;
  OnlineSolver of_few(few), of_all(all);
  for (const Sample &sample : samples) {
    const Vector u = of_all.solve(sample.mu).u;
    EXPECT_LE((of_few.solve(sample.mu).u - u).norm(), 1e-7 * u.norm());
  }
}

} // namespace
} // namespace rbvi::nitsche_test
