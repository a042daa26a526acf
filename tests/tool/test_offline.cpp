// Offline runs of scenes that make no sense somewhere: refused before anything is written where
// training parameters are concerned, and counted by the self-check where only queries are.
#include "../core/refuses.hpp"
#include "rbvi/contact/support.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/tool/offline_run.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>

namespace rbvi::offline_test {
namespace {

namespace fs = std::filesystem;

/// `inside` where down is between 0.031 and 0.034: between the training parameters 0.01, 0.02, ...
double between_samples(const FullMu &mu, double inside, double elsewhere) {
  return mu[0] > 0.031 && mu[0] < 0.034 ? inside : elsewhere;
}
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A block that is pushed down onto a half-plane by its top, which goes aside as well.
Scene pushed_block() {
  Scene scene = make_scene("patch", {{"bodies", "one"}, {"friction", "none"}});
  const Lame material = lame(15, 0.3);
  scene.parameters = all_free({{"down", "m", 0.01, 0.05, 0.03}, {"aside", "m", -0.02, 0.02, 0}});
  scene.check_parameters = {};
  scene.motion = nullptr;
  scene.f.clear();
  scene.a = {exact_term(elasticity("", material, scene.degree))};
  scene.v_product = {exact_term(h1_product(1, 2, scene.degree))};
  scene.fixed = {{"top", {}, {{[](const FullMu &mu, const Point &) {
                    return Point{mu[1], -mu[0], 0};
                  }}}}};
  scene.contacts = {rigid_surface({"contact", plane_surface({0, -1, 0}, {}, constant(0))})};
  return scene;
}

struct Offline : testing::Test {
  ToolOptions options;
  void SetUp() override {
    int id = static_cast<int>(::getpid());
    MPI_Bcast(&id, 1, MPI_INT, 0, PETSC_COMM_WORLD);
    options.out = fs::path(testing::TempDir()) / ("rbvi_offline_" + std::to_string(id));
    options.train = "grid:5,3";
    options.scene = pushed_block();
    options.reduce.multipliers.reduction = MultiplierReduction::condensed;
  }
  void TearDown() override {
    MPI_Barrier(PETSC_COMM_WORLD);
    if (rank_of(PETSC_COMM_WORLD) == 0) fs::remove_all(options.out);
  }
  OfflineRun run() const {
    const Groups groups(PETSC_COMM_WORLD, 1);
    const std::vector<Mu> training = checked_training(options);
    return run_offline(PETSC_COMM_WORLD, groups, options, training,
                       plan_offline(PETSC_COMM_WORLD, groups, options, training));
  }
  void expect_refused(const std::string &part) const {
    EXPECT_TRUE(refuses(part, [&] { run(); }));
    MPI_Barrier(PETSC_COMM_WORLD);
    EXPECT_FALSE(fs::exists(options.out)) << "something was written";
  }
  /// The model is made, and says that some queries have no answer and why.
  void expect_unanswered(const std::string &part) const {
    const OfflineRun made = run();
    EXPECT_EQ(made.sweep.samples.size(), 15U);
    if (rank_of(PETSC_COMM_WORLD) != 0) return;
    const SelfCheck &check = made.model.made.self_check;
    EXPECT_GT(check.unanswered, 0);
    EXPECT_LT(check.unanswered, check.queries / 4);
    EXPECT_NE(check.reason.find(part), std::string::npos) << check.reason;
    EXPECT_TRUE(fs::exists(options.out / "model.h5"));
  }
};

/// A case with outputs: other ones take the model that is there.
TEST_F(Offline, OtherOutputsTakeNoReduction) {
  const auto scene_with = [](const std::string &outputs) {
    return make_scene(read_case(
        "rbvi: 1\nphysics: plane_strain\nmesh: {built_in: one_block, degree: 2}\n"
        "parameters: {d: {range: [0.01, 0.05], default: 0.03}, k: {range: [1, 2], default: 1}}\n"
        "materials: {rubber: {at: all, E: 15 * k, nu: 0.3}}\n"
        "imposed: {top: {at: top, ux: 0.2 * d, uy: -d}}\n"
        "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}}}\n" +
            outputs,
        "block.yaml"));
  };
  const std::string others = "outputs: {push: {integral: pressure}, hold: {reaction: [0, 1], at: "
                             "top}, inside: {value: sigma_yy, point: [0.3, 0.2]}}\n";
  options.registry = std::make_shared<const Registry>(catalogue());
  options.train = "grid:3,2";
  options.scene = scene_with("outputs: {deep: {min: uy, in: all}}\n");
  const auto reduced = [](const OfflineRun &run) {
    return std::ranges::any_of(run.stages[1],
                               [](const StageRow &row) { return bool(row.seconds); });
  };
  EXPECT_TRUE(reduced(run()));
  EXPECT_TRUE(reduced(run())) << "nothing is other";
  options.scene = scene_with(others);
  const OfflineRun again = run();
  EXPECT_FALSE(reduced(again));
  EXPECT_EQ(again.sweep.report.solved, 0);
  const Mu mu{0.023, 1.4};
  const auto named = [&](const ReducedModel &model) {
    OnlineSolver online(model);
    return online.outputs(mu, online.solve(mu)).named;
  };
  std::vector<NamedOutput> kept;
  if (rank_of(PETSC_COMM_WORLD) == 0)
    kept = named(read_model(options.out / "model.h5", catalogue()));
  options.train = "grid:3,3"; // another model
  const OfflineRun whole = run();
  EXPECT_TRUE(reduced(whole));
  if (rank_of(PETSC_COMM_WORLD) != 0) return;
  const std::vector<NamedOutput> fresh = named(whole.model);
  ASSERT_EQ(kept.size(), 3U);
  ASSERT_EQ(fresh.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(kept[i].name, fresh[i].name);
    EXPECT_NEAR(kept[i].value, fresh[i].value, 1e-8 * std::abs(fresh[i].value));
    EXPECT_NE(kept[i].value, 0);
  }
}

TEST_F(Offline, CountsQueriesAtWhichACoefficientIsNotFinite) {
  options.scene.a.front().theta = {
      {"stiffness", [](const FullMu &mu) { return between_samples(mu, nan, 1); }, {0}}};
  expect_unanswered("the coefficient stiffness is not finite at down=0.03");
}

TEST_F(Offline, CountsQueriesAtWhichAPlaneIsNowhere) {
  const std::function<Coefficient> nowhere = [](const FullMu &mu) {
    return between_samples(mu, nan, 0);
  };
  options.scene.contacts = {rigid_surface({"contact", plane_surface({0, -1, 0}, {}, nowhere)})};
  expect_unanswered("the position or the tilt of a rigid plane is not finite");
}

TEST_F(Offline, RefusesTrainingParametersAtWhichSomethingIsNotFinite) {
  options.train = "grid:6,3"; // one of them is 0.034
  const auto broken = [](const FullMu &mu) { return mu[0] > 0.033 && mu[0] < 0.035 ? nan : 0.3; };
  const std::string where = " is not finite at down=0.034";
  options.scene.a.front().theta = {{"stiffness", broken, {0}}};
  expect_refused("the coefficient stiffness" + where);
  options.scene = pushed_block();
  RigidSurface plane{"contact", plane_surface({0, -1, 0}, {}, constant(0))};
  plane.friction = {FrictionLaw::coulomb, broken};
  options.scene.contacts = {rigid_surface(plane)};
  expect_refused("the coefficient of friction of contact on 'contact'" + where);
  options.scene = pushed_block();
  options.scene.fixed.front().values = {{[broken](const FullMu &mu, const Point &) {
    return Point{0, -broken(mu), 0};
  }}};
  expect_refused("at down=0.034");
}

/// Top and sides agree in most of the box.
TEST_F(Offline, RefusesImposedDisplacementsThatContradictAtATrainingParameter) {
  options.scene.fixed.push_back({"sides", {0}, {{[](const FullMu &mu, const Point &) {
                                   return Point{mu[1] + (mu[0] > 0.045 ? 1e-3 : 0), 0, 0};
                                 }}}});
  options.scene.contacts.front().entities.components = {1}; // x is imposed at the ends
  expect_refused("impose different displacements");
}

} // namespace
/// Of a half-disk whose core is of a stiffness of its own, from a sample in the middle of the box.
ToolOptions greedily(ToolOptions options) {
  options.scene = make_scene("rigid_disk", {{"arc_edges", "24"}, {"friction", "none"}});
  options.scene.parameters = free_only(options.scene.parameters, "radius,core_stiffness");
  options.train = "grid:1,1";
  options.greedy = "grid:5,5";
  options.reduce.certify = true;
  return options;
}

/// The bounds of the last model are met, by few of the pool, and none is solved twice.
TEST_F(Offline, GreedyTakesSamplesUntilTheBoundsAreMet) {
  options = greedily(options);
  options.greedy_tolerance = 1e-4;
  const OfflineRun made = run();
  const std::vector<double> &bounds = made.model.made.histories.at("greedy/bound");
  EXPECT_GT(bounds.front(), 1e-4);
  EXPECT_LE(bounds.back(), 1e-4);
  std::vector<Mu> taken = parameters_of(made.sweep.samples);
  EXPECT_LT(taken.size(), 20U);
  EXPECT_GE(taken.size(), bounds.size());
  std::ranges::sort(taken);
  EXPECT_EQ(std::ranges::adjacent_find(taken), taken.end());
}

TEST_F(Offline, GreedyEndsAtItsMostSamples) {
  options = greedily(options);
  options.greedy_tolerance = 0;
  options.greedy_samples = 4;
  EXPECT_EQ(run().sweep.samples.size(), 4U);
}

TEST_F(Offline, GreedyNeedsBounds) {
  options = greedily(options);
  options.reduce.certify = false;
  expect_refused("add -certify");
}

} // namespace rbvi::offline_test
