// From snapshots to a reduced model: it reproduces its own training set, and what verify measures
// is what a direct computation gives.
#include "../mor/stability_bound.hpp"
#include "reduced.hpp"

#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/mor/high_fidelity_pair.hpp"
#include "rbvi/study/stability_report.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>

namespace rbvi::reduce_test {
namespace {

using namespace testing_reduced;

/// What holds on every mesh is tested on a coarse one.
const char *const coarse = "24";

class BothMaps : public testing::TestWithParam<const char *> {
protected:
  static SceneOptions options() { return {{"disc_map", GetParam()}, {"circle_edges", coarse}}; }
  /// With a basis of all snapshots, reduced once.
  static Reduced &whole() {
    std::unique_ptr<Reduced> &r = wholes[GetParam()];
    if (!r) r = std::make_unique<Reduced>(options(), "grid:2,2,2", everything());
    return *r;
  }
  static void TearDownTestSuite() { wholes.clear(); }

private:
  static inline std::map<std::string, std::unique_ptr<Reduced>> wholes;
};
INSTANTIATE_TEST_SUITE_P(Maps, BothMaps, testing::Values("similarity", "graded"));

TEST_P(BothMaps, ABasisOfAllSnapshotsReturnsThem) {
  Reduced &r = whole();
  const Truths truths = make_truths(r.problem, r.model, r.samples);
  const ModelErrors errors = model_errors(r.model, {}, truths, r.problem.w_product());
  EXPECT_LE(errors.u.maxCoeff(), 1e-9);
  EXPECT_LE(errors.lambda.maxCoeff(), 1e-7);
  EXPECT_LE(errors.kkt_residual, 1e-12);
}

TEST_P(BothMaps, OutputsOfTheReducedModelAreThoseOfItsSnapshots) {
  const Reduced &r = whole();
  OnlineSolver online(r.model);
  for (const Sample &sample : r.samples) {
    const ReducedAnswer answer = online.solve(sample.mu);
    const Outputs outputs = online.outputs(sample.mu, answer);
    EXPECT_NEAR(*outputs.energy, *sample.outputs.energy, 1e-9 * std::abs(*sample.outputs.energy));
    EXPECT_NEAR(*outputs.normal_force, *sample.outputs.normal_force, 1e-7);
    EXPECT_NEAR(*outputs.peak_pressure, *sample.outputs.peak_pressure, 1e-4);
    EXPECT_NEAR(*outputs.max_penetration, *sample.outputs.max_penetration, 1e-8);
    EXPECT_LE((online.field(answer) - sample.u).norm(), 1e-8 * sample.u.norm());
  }
}

/// Displacements of degree 2, by both quadratures.
TEST(QuadraticModel, ReturnsItsSnapshotsAndAnswersBetweenThem) {
  for (const char *lumped : {"no", "yes"}) {
    SCOPED_TRACE(lumped);
    const SceneOptions scene{{"degree", "2"}, {"lumped", lumped}, {"circle_edges", coarse}};
    Reduced all(scene, "grid:2,2,2", everything());
    const ModelErrors own = all.errors_at(all.samples);
    EXPECT_LE(own.u.maxCoeff(), 1e-9);
    EXPECT_LE(own.lambda.maxCoeff(), 1e-7);
    Reduced model(scene, "grid:4,4,4", {});
    const auto unseen = parse_set(model.problem.scene().parameters, "random:8:7");
    const ModelErrors between = model.errors_at(solve_all(model.problem, unseen));
    EXPECT_LE(between.u.maxCoeff(), 1e-4);
    EXPECT_LE(between.lambda.maxCoeff(), 1e-4);
  }
}

/// The membrane with some parameters free, its frame lifted and tilted among them.
Scene framed(const std::string &free, const SceneOptions &options) {
  Scene scene = make_scene("membrane_obstacle", options);
  scene.parameters = free_only(scene.parameters, free);
  return scene;
}

void expect_same_outputs(const OnlineSolver &online, const ReducedAnswer &answer,
                         const Sample &sample, double tolerance) {
  const Outputs outputs = online.outputs(sample.mu, answer);
  EXPECT_NEAR(*outputs.energy, *sample.outputs.energy,
              tolerance * std::abs(*sample.outputs.energy));
  EXPECT_NEAR(*outputs.normal_force, *sample.outputs.normal_force,
              tolerance * *sample.outputs.normal_force);
  EXPECT_LE((online.field(answer) - sample.u).norm(), tolerance * sample.u.norm());
}

/// Imposed displacements: those of the frame are in the load, in the energy and in the field.
TEST(ImposedModel, ReturnsItsSnapshotsWithTheirFrame) {
  for (const char *degree : {"1", "2"}) {
    const SceneOptions options{{"degree", degree}, {"circle_edges", "24"}};
    Reduced r(framed("radius,frame_height,frame_tilt", options), "grid:2,2,3");
    r.reduce(everything());
    EXPECT_EQ(r.model.body.imposed_energy.size(), 1) << "all of it is integrated online";
    EXPECT_FALSE(r.model.fields.imposed_by.empty());
    OnlineSolver online(r.model);
    for (const Sample &sample : r.samples)
      expect_same_outputs(online, online.solve(sample.mu), sample, 1e-9);
  }
}

TEST(ImposedModel, AnswersBetweenItsSnapshots) {
  Reduced r(framed("radius,frame_height", {{"circle_edges", "24"}}), "grid:7,7");
  r.reduce({});
  const auto unseen = parse_set(r.problem.scene().parameters, "random:8:7");
  const std::vector<Sample> truth = solve_all(r.problem, unseen);
  const ModelErrors errors = r.errors_at(truth);
  EXPECT_LE(errors.u.maxCoeff(), 2e-4);
  EXPECT_LE(errors.lambda.maxCoeff(), 2e-4);
  OnlineSolver online(r.model);
  for (const Sample &sample : truth)
    expect_same_outputs(online, online.solve(sample.mu), sample, 2e-4);
}

/// Without an imposed value at any mu the model has nothing of it.
TEST(ImposedModel, IsThatOfTheSceneWhereTheFrameIsFixedAtZero) {
  Reduced r({{"circle_edges", "24"}}, "grid:2,2,2", everything());
  EXPECT_EQ(r.model.body.imposed_energy.size(), 0);
  EXPECT_TRUE(r.model.fields.imposed_by.empty());
  EXPECT_TRUE(r.model.contact.interfaces.front().mesh.imposed_by.empty());
  EXPECT_TRUE(r.model.body.f.samples.front().imposed_by.empty());
}

/// Two disks whose flat sides are moved by imposed values, which are a load, or by the motion of
/// the scene, which is none.
TEST(ImposedModel, OfARigidMotionIsThatOfTheMotion) {
  std::vector<Outputs> outputs;
  std::vector<Vector> pressures;
  for (const bool imposed : {false, true}) {
    Scene scene = make_scene("two_disks", {{"degree", "1"}, {"arc_edges", "40"}});
    const auto motion = scene.motion;
    if (imposed) {
      scene.motion = nullptr;
      const auto at = [motion](const FullMu &, const Point &x) { return motion({}, x); };
      for (FixedBoundary &boundary : scene.fixed)
        boundary.values = {{at, std::vector<Factor>{}}};
    }
    Reduced r(scene, "grid:9");
    r.reduce(everything());
    OnlineSolver online(r.model, r.problem.scene());
    for (const Mu &mu : {Mu{0.775}, Mu{1.3}}) {
      const ReducedAnswer answer = online.solve(mu);
      outputs.push_back(online.outputs(mu, answer));
      pressures.push_back(online.multiplier(answer));
    }
  }
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(*outputs[i + 2].energy, *outputs[i].energy, 1e-8 * *outputs[i].energy);
    EXPECT_NEAR(*outputs[i + 2].normal_force, *outputs[i].normal_force,
                1e-8 * *outputs[i].normal_force);
    EXPECT_LE((pressures[i + 2] - pressures[i]).norm(), 1e-7 * pressures[i].norm());
  }
}

TEST_P(BothMaps, TheSharpBoundHoldsAtEveryTrainingParameter) {
  ReduceOptions options;
  options.pod.tolerance = 1e-4;
  for (const double fraction : {0.3, 0.9}) {
    options.pga.stability = fraction;
    Reduced r(BothMaps::options(), "grid:3,3,3", options);
    const StabilityCheck check = make_stability_check(r.problem, r.model);
    for (const Sample &sample : r.samples) {
      const Matrix t =
          supremizers_at(r.problem, check.space, check.dual, {{sample.mu, {}}}).front();
      const StabilityBound bound = stability_bound(check.coordinates, t);
      const double off = infsup_constant(check.coordinates, t);
      EXPECT_GE(off, (1 - 1e-9) * bound.sharp);
      EXPECT_GE(off, bound.classic);
      EXPECT_GE(bound.sharp, (fraction - 1e-9) * bound.on);
    }
  }
}

TEST_P(BothMaps, ConstantsComeInTheirOrder) {
  Reduced r(make_scene("membrane_obstacle", options()), "grid:3,2,2");
  for (const ConeType type : {ConeType::mcpg, ConeType::hybrid}) {
    SCOPED_TRACE(cone_type_names()[static_cast<std::size_t>(type)]);
    ReduceOptions options;
    options.pod.tolerance = 1e-3;
    options.cone.type = type;
    r.reduce(options);
    const StabilityCheck check = make_stability_check(r.problem, r.model);
    const std::vector<Mu> set = parse_set(r.problem.scene().parameters, "random:6:3");
    for (const InfSup &c : infsup_over(PETSC_COMM_WORLD, r.problem, check, at_rest(set), false)) {
      EXPECT_GE(c.on * (1 + 1e-9), c.off);
      EXPECT_GE(c.off * (1 + 1e-9), c.dec);
      EXPECT_GE(c.on * (1 + 1e-9), c.hf);
      EXPECT_GE(c.c_hf * (1 + 1e-9), c.on);
      EXPECT_GT(c.off, 0);
    }
    const BoundCheck bound = check_bound(PETSC_COMM_WORLD, r.problem, check, at_rest(set));
    EXPECT_EQ(bound.exceptions, 0);
    EXPECT_GE(bound.smallest, 1 - 1e-9);
  }
}

/// So many multipliers that beta_HF and c_HF are iterated; where b only scales, supremizers are
/// then those of the loads alone.
TEST(ReducedMembrane, ConstantsOfManyMultipliersAreThoseOfTheDenseMatrices) {
  ReduceOptions options;
  options.pod.tolerance = 1e-2;
  options.cone.type = ConeType::mcpg;
  Reduced r({{"circle_edges", "72"}}, "grid:3,1,1", options);
  ASSERT_TRUE(iterates_constants(r.problem));
  const StabilityCheck few = make_stability_check(r.problem, r.model);
  const RieszSpace all = make_riesz_space(r.problem.v_product(), r.problem.trace());
  ASSERT_GT(few.space.loads.size(), 0);
  const std::vector<Mu> set = parse_set(r.problem.scene().parameters, "random:2:3");
  const auto found = infsup_over(PETSC_COMM_WORLD, r.problem, few, at_rest(set), true);
  for (std::size_t p = 0; p < set.size(); ++p) {
    Operators op;
    r.problem.assemble_contact(set[p], op);
    const PairConstants dense = dense_constants(r.problem, all, op);
    EXPECT_NEAR(found[p].hf, dense.beta, 1e-8 * dense.beta);
    EXPECT_NEAR(found[p].c_hf, dense.c, 1e-8 * dense.c);
    const Matrix t = supremizer_coordinates(all, op.b, few.dual);
    EXPECT_NEAR(found[p].on, singular_values(t)(t.cols() - 1), 1e-8 * found[p].on);
    EXPECT_GE(found[p].on * (1 + 1e-9), found[p].off);
    EXPECT_GT(found[p].off, 0);
  }
}

TEST_P(BothMaps, TheFewestSupremizersAreJustEnough) {
  ReduceOptions options;
  options.pod.tolerance = 1e-2; // few modes, so that supremizers are needed
  options.pga.tolerance = 1e-3;
  Reduced r(BothMaps::options(), "grid:3,3,2", options);
  const StabilityCheck check = make_stability_check(r.problem, r.model);
  const std::vector<Mu> set = parse_set(r.problem.scene().parameters, "random:7:5");
  const MPI_Comm world = PETSC_COMM_WORLD;
  const int fewest = fewest_supremizers(world, r.problem, check, at_rest(set), 0.9);
  ASSERT_GT(fewest, 0);
  const std::vector<StabilityRow> rows = stability_along(
      world, r.problem, check, at_rest(set), {fewest - 1, fewest, r.model.body.supremizers});
  EXPECT_LT(rows[0].ratio, 0.9);
  EXPECT_GE(rows[1].ratio, 0.9);
  for (const StabilityRow &row : rows) {
    EXPECT_GE(row.ratio, (1 - 1e-9) * row.bound);
    EXPECT_NEAR(row.bound, std::sqrt(1 - row.sigma * row.sigma), 1e-6);
  }
  EXPECT_EQ(fewest_supremizers(world, r.problem, check, at_rest(set), 1 + 1e-6), -1);
  const BoundCheck bound = check_bound(world, r.problem, check, at_rest(set));
  EXPECT_EQ(bound.exceptions, 0);
  EXPECT_GE(bound.smallest, 1 - 1e-9);
}

TEST(Reduce, ErrorsAgreeWithADirectComputation) {
  ReduceOptions options;
  options.pod.tolerance = 1e-2;
  options.cone.tolerance = 0.1;
  Reduced r({{"circle_edges", coarse}}, "grid:3,2,2", options);
  const std::vector<Sample> valid = solve_all(r.problem, {{0.21, 0.01, 0.02}});
  const Truths truths = make_truths(r.problem, r.model, valid);
  const ModelErrors errors = model_errors(r.model, {}, truths, r.problem.w_product());
  OnlineSolver online(r.model);
  const ReducedAnswer answer = online.solve(valid[0].mu);
  const auto norm = [&](const Vector &natural) {
    const Handle<Vec> x = from_natural(r.problem.dofs(), natural),
                      y = make_vector(r.problem.dofs());
    PetscScalar value = 0;
    RBVI_CALL(MatMult(r.problem.v_product(), x.get(), y.get()));
    RBVI_CALL(VecDot(x.get(), y.get(), &value));
    return std::sqrt(value);
  };
  const double direct = norm(online.field(answer) - valid[0].u) / norm(valid[0].u);
  EXPECT_NEAR(errors.u[0], direct, 1e-9 * direct);
  EXPECT_LE(errors.u_floor[0], errors.u[0] * (1 + 1e-12));
  EXPECT_LE(errors.lambda_floor[0], errors.lambda[0] * (1 + 1e-9));
}

TEST(Reduce, AnEnrichedPairOfFullSizeIsTheModelItself) {
  ReduceOptions options;
  options.pod.tolerance = 1e-3;
  options.pga.tolerance = 1e-9;
  Reduced r({{"circle_edges", coarse}}, "grid:3,2,2", options);
  const SubModel pair = enriched_pair(r.model, r.model.body.modes, r.model.contact.generators);
  const Truths truths =
      make_truths(r.problem, r.model, solve_all(r.problem, {{0.17, -0.04, 0.03}}));
  const ModelErrors whole = model_errors(r.model, {}, truths, r.problem.w_product());
  const ModelErrors part = model_errors(pair.model, pair.embedding, truths, r.problem.w_product());
  EXPECT_NEAR(part.u[0], whole.u[0], 1e-6 * whole.u[0]);
  EXPECT_NEAR(part.lambda[0], whole.lambda[0], 1e-6 * whole.lambda[0]);
}

TEST(Reduce, APairKeepsItsAnswersAtTheSamples) {
  const Reduced r({{"circle_edges", coarse}}, "grid:2,2,2", ReduceOptions{});
  const Matrix &starts = r.model.contact.starts;
  ASSERT_EQ(starts.cols(), std::ssize(r.samples));
  OnlineSolver online(r.model);
  for (std::size_t p = 0; p < r.samples.size(); ++p) {
    const Vector lambda = online.solve(r.samples[p].mu).lambda;
    EXPECT_LE((starts.col(static_cast<Index>(p)) - lambda).norm(), 1e-10 * lambda.norm());
  }
}

TEST(Separate, RanksAreThoseOfTheMaps) {
  const std::vector<Mu> set = parse_set(make_scene("membrane_obstacle").parameters, "grid:3,3,3");
  Problem similarity(PETSC_COMM_WORLD, make_scene("membrane_obstacle"), {});
  const AffineOperators affine = separate(similarity, set, {1e-3, 0});
  EXPECT_EQ(affine.b.size(), 1); // b and g scale with the area of the disc
  EXPECT_EQ(affine.g.size(), 1);
  EXPECT_GT(affine.a.size(), 5);
  Problem graded(PETSC_COMM_WORLD, make_scene("membrane_obstacle", {{"disc_map", "graded"}}), {});
  EXPECT_GT(separate(graded, set, {1e-3, 0}).b.size(), 3);
}

} // namespace
} // namespace rbvi::reduce_test
