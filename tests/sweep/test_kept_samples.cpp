// The files of a sweep: what is used again, set aside, refused.
#include "sweep_test.hpp"

#include "rbvi/core/warnings.hpp"
#include "rbvi/io/h5.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "tests/catalogue.hpp"

#include <chrono>

namespace rbvi::kept_samples_test {
namespace {

using namespace testing_sweep;

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
      std::ofstream(sample_file(samples, five[i])) << "damaged";
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
    (void)run_sweep(PETSC_COMM_WORLD, groups, problem, {}, {five[0]},
                    {samples, [&] {
                       ++begun;
                       EXPECT_EQ(fs::exists(sample_file(samples, five[0])), begun > 1);
                       MPI_Barrier(PETSC_COMM_WORLD);
                     }});
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

/// What warnings look at of each contact by itself.
TEST_F(SweepTest, OutputsOfEachContactAreKept) {
  const Scene scene = make_scene("roller", {{"arc_edges", "8"}});
  Mu mu;
  for (int i = 0; i < scene.parameters.size(); ++i)
    mu.push_back((scene.parameters.at(i).lower + scene.parameters.at(i).upper) / 2);
  const Groups groups(PETSC_COMM_WORLD, ranks_in_world());
  Problem problem(groups.comm(), scene, {});
  const Outputs solved = HighFidelity(problem, {}).solve(mu).outputs;
  const Sweep kept = run_sweep(PETSC_COMM_WORLD, groups, problem, {}, {mu}, {directory / "roller"});
  ASSERT_EQ(kept.samples.size(), 1U);
  const std::vector<Outputs> &found = kept.samples.front().outputs.interfaces;
  ASSERT_EQ(solved.interfaces.size(), 2U);
  ASSERT_EQ(found.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(found[i].name, solved.interfaces[i].name);
    EXPECT_EQ(found[i].contact_nodes, solved.interfaces[i].contact_nodes);
    EXPECT_EQ(found[i].free_nodes, solved.interfaces[i].free_nodes);
    EXPECT_TRUE(found[i].contact_nodes);
  }
  EXPECT_EQ(resolution_warning(kept.samples.front().outputs), resolution_warning(solved));
  const Sweep again =
      run_sweep(PETSC_COMM_WORLD, groups, problem, {}, {mu}, {directory / "roller"});
  ASSERT_EQ(again.report.reused, 1);
  EXPECT_EQ(numbers_of(again.samples.front().outputs), numbers_of(kept.samples.front().outputs));
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
} // namespace rbvi::kept_samples_test
