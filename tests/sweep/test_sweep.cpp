#include "rbvi/core/error.hpp"
#include "rbvi/io/h5.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/io/temporary_files.hpp"
#include "rbvi/sweep/sweep.hpp"

#include "../coarse_mesh.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

namespace rbvi {
namespace {

namespace fs = std::filesystem;

int rank_in_world() {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return rank;
}

int ranks_in_world() {
  int size = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  return size;
}

/// A box in which the map inverts cells near radius = 0.6.
Scene wide_scene() {
  Scene scene = make_scene("membrane_obstacle");
  scene.parameters.all[0].upper = 0.6;
  return scene;
}

const std::vector<Mu> five{
    {0.2, 0, 0}, {0.18, 0.02, -0.01}, {0.17, -0.05, 0.05}, {0.24, 0.05, 0.05}, {0.21, 0, 0.03}};
const Mu impossible{0.6, 0.05, 0.05};

/// A directory for the whole world, with a coarse mesh in it. Collective.
struct SweepTest : testing::Test {
  fs::path directory, samples, mesh;

  void SetUp() override {
    int process = static_cast<int>(getpid());
    MPI_Bcast(&process, 1, MPI_INT, 0, PETSC_COMM_WORLD);
    directory = fs::temp_directory_path() / ("rbvi_sweep_" + std::to_string(process));
    samples = directory / "samples";
    mesh = directory / "coarse.msh";
    alone([&] {
      fs::create_directories(directory);
      std::ofstream(mesh) << coarse_gmsh();
    });
  }
  void TearDown() override {
    alone([&] { fs::remove_all(directory); });
  }

  /// By rank 0, before the others go on.
  void alone(const std::function<void()> &work) const {
    MPI_Barrier(PETSC_COMM_WORLD);
    if (rank_in_world() == 0) work();
    MPI_Barrier(PETSC_COMM_WORLD);
  }

  Sweep sweep(const std::vector<Mu> &set, int ranks_per_group = 1,
              const Scene &scene = wide_scene(), const HfOptions &options = {},
              const std::string &where = "samples") const {
    const Groups groups(PETSC_COMM_WORLD, ranks_per_group);
    Problem problem(groups.comm(), scene, {mesh.string(), 0});
    return run_sweep(PETSC_COMM_WORLD, groups, problem, options, set, directory / where);
  }

  /// What sweeping `five` throws on this rank.
  Error refusal(const Scene &scene = wide_scene(), const HfOptions &options = {}) const {
    try {
      (void)sweep(five, 1, scene, options);
    } catch (const Error &error) {
      return error;
    }
    return {Status::done, "nothing was thrown"};
  }

  std::string bytes(const fs::path &file) const {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
  }
};

bool contains(const std::string &text, const std::string &part) {
  return text.find(part) != std::string::npos;
}

double relative(const Vector &a, const Vector &b) {
  return (a - b).norm() / b.norm();
}

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
  scene.parameters.free = {0, 1, 5};
  const std::vector<Mu> set{{1, 0.05, 0}, {0.7, 0.35, 0.3}, {1, 0.03, 0}};
  HfOptions options;
  options.nonlinear.method = NonlinearMethod::newton;
  options.nonlinear.max_steps = 4; // enough for the shallow ones
  const Groups groups(PETSC_COMM_WORLD, 1);
  Problem problem(groups.comm(), scene, {});
  for (const int reused : {0, 3}) {
    const Sweep result =
        run_sweep(PETSC_COMM_WORLD, groups, problem, options, set, directory / "large");
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
  const Sweep left = run_sweep(
      PETSC_COMM_WORLD, groups, problem, {}, five, directory / "samples", [] {}, Fields::in_files);
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
                                   directory / ("nine_" + std::to_string(k)));
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

TEST_F(SweepTest, ResumeRecomputesOnlyWhatIsMissing) {
  const Sweep first = sweep(five);
  std::vector<std::string> before;
  for (const Mu &mu : five)
    before.push_back(bytes(sample_file(samples, mu)));
  alone([&] {
    fs::remove(sample_file(samples, five[1]));
    fs::remove(sample_file(samples, five[4]));
  });
  const Sweep second = sweep(five);
  EXPECT_EQ(second.report.reused, 3);
  EXPECT_EQ(second.report.solved, 2);
  ASSERT_EQ(second.samples.size(), 5u);
  for (std::size_t i = 0; i < five.size(); ++i) {
    EXPECT_LE(relative(second.samples[i].u, first.samples[i].u), 1e-10);
    // The wall time in the file tells a sample that was solved again.
    EXPECT_EQ(bytes(sample_file(samples, five[i])) == before[i], i != 1 && i != 4) << i;
  }
  const Sweep third = sweep(five);
  EXPECT_EQ(third.report.solved, 0);
  EXPECT_EQ(third.report.seconds_per_solve, 0);
}

TEST_F(SweepTest, OneFilePerSampleAndNothingElse) {
  (void)sweep(five);
  std::size_t files = 0;
  for (const auto &entry : fs::directory_iterator(samples)) {
    EXPECT_EQ(entry.path().extension(), ".h5") << entry.path();
    ++files;
  }
  EXPECT_EQ(files, five.size());
}

/// Every kind of damage: the file is kept under another name, its sample alone is solved again.
TEST_F(SweepTest, DamagedSamplesAreSetAsideAndSolvedAgain) {
  const Sweep whole = sweep(five);
  const fs::path file = sample_file(samples, five[2]), aside = file.string() + ".damaged";
  const std::string good = bytes(file), neighbour = bytes(sample_file(samples, five[1]));
  std::string flipped = good;
  flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 4);
  for (const std::string &content : {good.substr(0, good.size() / 2), flipped, std::string(),
                                     std::string("mu = 0.2\n"), neighbour}) {
    alone([&] {
      fs::remove(aside);
      std::ofstream(file, std::ios::binary) << content;
    });
    const Sweep mended = sweep(five);
    EXPECT_EQ(mended.report.set_aside, 1);
    EXPECT_EQ(mended.report.solved, 1);
    EXPECT_EQ(mended.report.reused, 4);
    ASSERT_EQ(mended.samples.size(), 5u);
    EXPECT_EQ(mended.samples[2].mu, five[2]);
    EXPECT_LE(relative(mended.samples[2].u, whole.samples[2].u), 1e-10);
    alone([&] { EXPECT_EQ(bytes(aside), content); });
  }
  EXPECT_EQ(sweep(five).report.reused, 5);
  EXPECT_EQ(sweep(five).report.set_aside, 0);
}

TEST_F(SweepTest, EveryDamagedFileKeepsANameOfItsOwn) {
  (void)sweep(five);
  const fs::path file = sample_file(samples, five[2]);
  for (const std::string content : {"first", "second", "third"}) {
    alone([&] {
      fs::remove(file);
      std::ofstream(file) << content;
    });
    EXPECT_EQ(sweep(five).report.set_aside, 1);
  }
  alone([&] {
    EXPECT_EQ(bytes(file.string() + ".damaged"), "first");
    EXPECT_EQ(bytes(file.string() + ".damaged.2"), "second");
    EXPECT_EQ(bytes(file.string() + ".damaged.3"), "third");
  });
}

TEST_F(SweepTest, DirectoriesInTheWayOfFilesAreSetAside) {
  const fs::path file = sample_file(samples, five[0]),
                 reason = sample_file(samples, impossible).replace_extension("failed");
  alone([&] {
    fs::create_directories(file / "inside");
    fs::create_directories(reason / "inside");
  });
  const Sweep result = sweep({five[0], impossible});
  EXPECT_EQ(result.report.set_aside, 2);
  EXPECT_EQ(result.samples.size(), 1u);
  EXPECT_EQ(result.report.failed.size(), 1u);
  alone([&] {
    EXPECT_TRUE(fs::is_directory(file.string() + ".damaged/inside"));
    EXPECT_TRUE(fs::is_directory(reason.string() + ".damaged/inside"));
    EXPECT_TRUE(fs::is_regular_file(reason));
  });
}

/// Neither hides what the others were made with.
TEST_F(SweepTest, ADamagedSampleIsNoSampleOfOtherOptions) {
  (void)sweep(five);
  alone([&] {
    for (int i = 0; i < 4; ++i)
      std::ofstream(sample_file(samples, five[static_cast<std::size_t>(i)])) << "damaged";
  });
  const Error error = refusal(make_scene("membrane_obstacle", {{"load", "-20"}}));
  EXPECT_TRUE(contains(error.what(), "load = -25, now it is -20")) << error.what();
  alone([&] { EXPECT_FALSE(fs::exists(sample_file(samples, five[0]).string() + ".damaged")); });
}

/// An older or newer version of the program made it: no damage, and not to be touched.
TEST_F(SweepTest, SamplesOfOtherVersionsAreRefused) {
  (void)sweep({five[0]});
  const fs::path file = sample_file(samples, five[1]);
  alone([&] {
    H5Writer other;
    other.write("mu", five[1]);
    other.commit(file, "sample", 999);
    fs::remove(sample_file(samples, five[0]));
  });
  const Error error = refusal();
  EXPECT_EQ(error.status(), Status::bad_input);
  EXPECT_TRUE(contains(error.what(), "schema version 999")) << error.what();
  EXPECT_TRUE(contains(error.what(), "another -out")) << error.what();
  alone([&] { EXPECT_FALSE(fs::exists(file.string() + ".damaged")); });
}

TEST_F(SweepTest, TemporaryFilesOfKilledRunsAreRemoved) {
  (void)sweep(five);
  const fs::path file = sample_file(samples, five[2]);
  fs::path stale = temporary_name(file, 0); // of this process, but long before it began
  const fs::path own = temporary_name(file, 1);
  alone([&] {
    std::ofstream(stale) << "half";
    fs::last_write_time(stale, fs::file_time_type::clock::now() - std::chrono::hours(24 * 365 * 9));
    std::ofstream(own) << "half";
  });
  EXPECT_EQ(sweep(five).report.reused, 5);
  alone([&] {
    EXPECT_FALSE(fs::exists(stale));
    EXPECT_TRUE(fs::exists(own));
  });
}

/// What a run writes at its beginning is not written for one that is refused.
TEST_F(SweepTest, ARunBeginsOnceItsSamplesAreFoundGood) {
  int begun = 0;
  const auto run = [&](const Scene &scene) {
    const Groups groups(PETSC_COMM_WORLD, 1);
    Problem problem(groups.comm(), scene, {mesh.string(), 0});
    (void)run_sweep(PETSC_COMM_WORLD, groups, problem, {}, {five[0]}, samples, [&] {
      ++begun;
      EXPECT_EQ(fs::exists(sample_file(samples, five[0])), begun > 1);
      MPI_Barrier(PETSC_COMM_WORLD);
    });
  };
  run(wide_scene());
  run(wide_scene());
  EXPECT_EQ(begun, 2);
  EXPECT_THROW(run(make_scene("membrane_obstacle", {{"load", "-20"}})), Error);
  EXPECT_EQ(begun, 2);
}

TEST_F(SweepTest, SamplesOfOtherOptionsAreRefused) {
  (void)sweep({five[0]});
  const Scene other_load = make_scene("membrane_obstacle", {{"load", "-20"}});
  Error error = refusal(other_load);
  EXPECT_EQ(error.status(), Status::bad_input);
  EXPECT_TRUE(contains(error.what(), "load = -25, now it is -20")) << error.what();

  Scene fixed = wide_scene();
  fixed.parameters = free_only(fixed.parameters, "center_x,center_y");
  EXPECT_EQ(refusal(fixed).status(), Status::bad_input);

  HfOptions uzawa;
  uzawa.method = HfMethod::uzawa;
  error = refusal(wide_scene(), uzawa);
  EXPECT_TRUE(contains(error.what(), "hf_method = active_set, now it is uzawa")) << error.what();
  alone([&] { EXPECT_FALSE(fs::exists(sample_file(samples, five[1]))); });
  EXPECT_THROW((void)sweep({five[1]}, 1, other_load), Error) << "no sample of this set is there";
}

TEST_F(SweepTest, AFailingSampleIsRecordedAndRetried) {
  const std::vector<Mu> set{five[0], impossible, five[1], five[2], five[3], five[4]};
  for (int k = 1; k <= ranks_in_world(); ++k) {
    if (ranks_in_world() % k != 0) continue;
    for (int attempt = 0; attempt < 2; ++attempt) {
      const Sweep result = sweep(set, k, wide_scene(), {}, "groups_of_" + std::to_string(k));
      EXPECT_EQ(result.samples.size(), 5u);
      EXPECT_EQ(result.report.solved, attempt == 0 ? 5 : 0);
      ASSERT_EQ(result.report.failed.size(), 1u);
      EXPECT_EQ(result.report.failed[0].first, impossible);
      const std::string &reason = result.report.failed[0].second;
      EXPECT_TRUE(contains(reason, "inverts a cell")) << reason;
      EXPECT_TRUE(contains(reason, "radius=0.6 center_x=0.05 center_y=0.05")) << reason;
    }
  }
}

TEST_F(SweepTest, ARetriedSampleThatSucceedsLosesItsReason) {
  (void)sweep({five[0]});
  const fs::path failed = sample_file(samples, five[1]).replace_extension("failed");
  alone([&] { std::ofstream(failed) << "power cut\n"; });
  const Sweep result = sweep({five[0], five[1]});
  EXPECT_EQ(result.report.solved, 1);
  EXPECT_TRUE(result.report.failed.empty());
  alone([&] { EXPECT_FALSE(fs::exists(failed)); });
}

TEST_F(SweepTest, ADirectoryThatCannotBeMadeFailsEverywhere) {
  try {
    (void)sweep(five, 1, wide_scene(), {}, "coarse.msh/samples");
    FAIL() << "nothing was thrown";
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::failed);
    EXPECT_TRUE(contains(error.what(), "coarse.msh/samples")) << error.what();
  }
}

} // namespace
} // namespace rbvi
