// Samples of a set, by any groups of ranks.
#include "sweep_test.hpp"

#include "rbvi/io/parameter_sets.hpp"
#include "tests/catalogue.hpp"

namespace rbvi::sweep_test {
namespace {

using namespace testing_sweep;

TEST_F(SweepTest, SameSamplesForAnyGroups) {
  std::vector<HfSolution> alone_solved;
  {
    Problem problem(PETSC_COMM_SELF, wide_scene(), {mesh.string(), 0});
    HighFidelity solver(problem, {});
    for (const Mu &mu : five)
      alone_solved.push_back(solver.solve(mu));
  }
  for (int k = 1; k <= ranks_in_world(); ++k) {
    if (ranks_in_world() % k != 0) continue;
    const Sweep result = sweep(five, k, wide_scene(), {}, "groups_of_" + std::to_string(k));
    EXPECT_EQ(result.report.solved, 5);
    EXPECT_EQ(result.report.reused, 0);
    EXPECT_GT(result.report.seconds_per_solve, 0);
    ASSERT_EQ(result.samples.size(), five.size());
    for (std::size_t i = 0; i < five.size(); ++i) {
      const Sample &sample = result.samples[i];
      EXPECT_EQ(sample.mu, five[i]);
      EXPECT_LE(relative(sample.u, alone_solved[i].u), 1e-10) << k << " ranks per group";
      EXPECT_LE(relative(sample.lambda, alone_solved[i].lambda), 1e-10) << k << " ranks per group";
      EXPECT_NEAR(*sample.outputs.energy, *alone_solved[i].outputs.energy, 1e-10);
    }
  }
}

// Read again from their files, too.
TEST_F(SweepTest, SamplesTellTheirLoadStepsAndTheEndsOfContact) {
  Scene scene = make_scene("rigid_disk",
                           {{"friction", "none"}, {"kinematics", "large"}, {"arc_edges", "20"}});
  scene.parameters = free_only(scene.parameters, "radius,indentation,offset");
  const std::vector<Mu> set{{1, 0.05, 0}, {0.7, 0.35, 0.3}, {1, 0.03, 0}};
  HfOptions options;
  options.nonlinear.method = NonlinearMethod::newton;
  options.nonlinear.max_steps = 4; // enough for the shallow ones
  const Groups groups(PETSC_COMM_WORLD, 1);
  Problem problem(groups.comm(), scene, {});
  for (const int reused : {0, 3}) {
    const Sweep result =
        run_sweep(PETSC_COMM_WORLD, groups, problem, options, set, {directory / "large"});
    EXPECT_EQ(result.report.reused, reused);
    ASSERT_EQ(result.samples.size(), 3U) << result.report.failed.front().second;
    for (const Sample &sample : result.samples) {
      const bool deep = sample.mu == set[1];
      if (deep)
        EXPECT_EQ(*sample.outputs.load_steps, 8);
      else
        EXPECT_TRUE(sample.outputs.load_steps);
      EXPECT_EQ(*sample.outputs.ends_in_contact, deep ? 1 : 0);
    }
  }
}

TEST_F(SweepTest, FieldsAreReadFromTheirFilesWhenAsked) {
  const Sweep held = sweep(five);
  const Groups groups(PETSC_COMM_WORLD, 1);
  Problem problem(groups.comm(), wide_scene(), {mesh.string(), 0});
  const Sweep left = run_sweep(PETSC_COMM_WORLD, groups, problem, {}, five,
                               {directory / "samples", [] {}, Fields::in_files});
  ASSERT_EQ(left.samples.size(), five.size());
  for (std::size_t i = 0; i < five.size(); ++i) {
    EXPECT_EQ(left.samples[i].u.size(), 0);
    EXPECT_TRUE(left.samples[i].lambda == held.samples[i].lambda);
    EXPECT_TRUE(displacement(PETSC_COMM_WORLD, left.samples[i]) == held.samples[i].u);
  }
  alone([&] { fs::remove(left.samples[2].file); });
  EXPECT_THROW((void)displacement(PETSC_COMM_WORLD, left.samples[2]), Error) << "on every rank";
  EXPECT_TRUE(displacement(PETSC_COMM_WORLD, held.samples[2]) == held.samples[2].u);
}

/// On the built-in mesh, in an order without neighbours: starts differ, answers do not.
TEST_F(SweepTest, SameSamplesOfARandomSetForAnyGroups) {
  const Scene scene = make_scene("membrane_obstacle");
  const std::vector<Mu> nine = parse_set(scene.parameters, "random:9:1");
  Problem problem(PETSC_COMM_SELF, scene, {});
  HighFidelity solver(problem, {});
  std::vector<HfSolution> alone_solved;
  for (const Mu &mu : nine)
    alone_solved.push_back(solver.solve(mu));
  for (int k = 1; k <= ranks_in_world(); ++k) {
    if (ranks_in_world() % k != 0) continue;
    const Groups groups(PETSC_COMM_WORLD, k);
    Problem shared(groups.comm(), scene, {});
    const Sweep result = run_sweep(PETSC_COMM_WORLD, groups, shared, {}, nine,
                                   {directory / ("nine_" + std::to_string(k))});
    ASSERT_EQ(result.samples.size(), nine.size());
    for (std::size_t i = 0; i < nine.size(); ++i) {
      EXPECT_EQ(result.samples[i].mu, nine[i]);
      EXPECT_LE(relative(result.samples[i].u, alone_solved[i].u), 1e-9) << k;
      EXPECT_LE(relative(result.samples[i].lambda, alone_solved[i].lambda), 1e-9) << k;
    }
  }
}

/// A set that no group can go on with: one meets bad input, all end with it, and soon.
TEST_F(SweepTest, BadInputInOneGroupEndsAll) {
  Scene scene = wide_scene();
  scene.map = [map = scene.map](const FullMu &mu, const Point &x) {
    if (mu[0] == 0.17) throw bad_input("the map of this scene stops at 0.17");
    return map(mu, x);
  };
  std::vector<Mu> set;
  for (int i = 0; i < 200; ++i)
    set.push_back({0.17 + 0.0002 * i, 0, 0});
  for (int k = 1; k <= ranks_in_world(); ++k) {
    if (ranks_in_world() % k != 0) continue;
    const fs::path where = directory / ("ended_" + std::to_string(k));
    try {
      (void)sweep(set, k, scene, {}, where.filename());
      ADD_FAILURE() << "nothing was thrown";
    } catch (const Error &error) {
      EXPECT_EQ(error.status(), Status::bad_input);
      EXPECT_TRUE(contains(error.what(), "stops at 0.17")) << error.what();
    }
    alone([&] {
      const auto made = std::distance(fs::directory_iterator(where), fs::directory_iterator());
      EXPECT_LE(made, 100) << k << ": the others went on";
    });
  }
}

TEST_F(SweepTest, GroupsMustDivideTheRanks) {
  EXPECT_THROW((void)sweep(five, ranks_in_world() + 1), Error);
  EXPECT_THROW((void)sweep(five, 0), Error);
  if (ranks_in_world() == 3) {
    EXPECT_THROW((void)sweep(five, 2), Error);
  }
}

TEST_F(SweepTest, FewerSamplesThanGroups) {
  EXPECT_EQ(sweep({five[0]}).samples.size(), 1u);
  EXPECT_EQ(sweep({five[0]}).report.reused, 1);
}

} // namespace
} // namespace rbvi::sweep_test
