// What a run keeps: the model of those samples that there are, the case that a model was made for,
// sets and samples, whatever happens to files and processes.
#include "rbvi/io/write_atomically.hpp"
#include "run.hpp"

#include <fcntl.h>
#include <signal.h>

#include <chrono>
#include <iterator>
#include <thread>

namespace rbvi::kept_test {
namespace {

/// `good` parameters of the membrane, then `bad` ones, at which the solver of Kept::wide needs more
/// iterations than it has: 3900 or more, and 3200 or less at the good ones.
std::string set_with(int good, int bad) {
  std::ostringstream text;
  text << "radius,center_x,center_y\n";
  for (int i = 0; i < good; ++i)
    text << 0.24 + 0.006 * i << "," << 0.05 * (i % 3 - 1) << "," << 0.05 * (i % 2) << "\n";
  for (int i = 0; i < bad; ++i)
    text << 0.14 - 0.02 * i << ",-0.05,-0.05\n";
  return text.str();
}

std::vector<fs::path> files_in(const std::string &directory, const std::string &part) {
  std::vector<fs::path> files;
  for (const auto &entry : fs::directory_iterator(directory))
    if (contains(entry.path().filename().string(), part)) files.push_back(entry.path());
  return files;
}

struct Kept : InDirectory {
  const std::string wide = "offline -case case.yaml -radius 0.1,0.3 -train mu.csv -hf_method uzawa "
                           "-uzawa_tolerance 1e-8 -uzawa_max_iterations 3500 ";

  /// One line on standard error and status 1.
  void expect_failure(const Finished &run, const std::string &line) const {
    EXPECT_EQ(run.status, 1) << run.out << run.err;
    EXPECT_EQ(lines_with(run.err, "rbvi: "), 1) << run.err;
    EXPECT_EQ(lines_with(run.err, "rbvi: " + line), 1) << run.err;
  }
};

TEST_F(Kept, AFailedSampleIsNamedByTheModelAndTheStatus) {
  spill("mu.csv", set_with(10, 1));
  for (const int ranks : {1, 2}) {
    fs::remove("run/model.h5");
    const Finished run = shell(rbvi(ranks, wide + "-out run"));
    expect_failure(run, "1 of 11 training samples failed");
    EXPECT_EQ(lines_with(run.out, "  failed at radius=0.14 center_x=-0.05"), 1) << run.out;
    EXPECT_TRUE(contains(run.out, "no convergence in -uzawa_max_iterations")) << run.out;
    const std::string model = output_of(rbvi(1, "inspect run/model.h5"));
    EXPECT_TRUE(contains(line_with(model, "failed samples"), "1 of 11")) << model;
    EXPECT_TRUE(contains(model, "radius=0.14 center_x=-0.05 center_y=-0.05")) << model;
  }
  expect_failure(shell(rbvi(1, wide + "-out strict -sweep_max_failures 0.05")),
                 "1 of 11 training samples failed, more than -sweep_max_failures 0.05");
  EXPECT_FALSE(fs::exists("strict/model.h5"));
}

TEST_F(Kept, ManyFailuresMakeNoModel) {
  spill("mu.csv", set_with(10, 2));
  for (const int ranks : {1, 2}) {
    expect_failure(shell(rbvi(ranks, wide + "-out run")),
                   "2 of 12 training samples failed, more than -sweep_max_failures 0.1");
    EXPECT_FALSE(fs::exists("run/model.h5"));
  }
  expect_failure(shell(rbvi(1, wide + "-out run -sweep_max_failures 0.5")),
                 "2 of 12 training samples failed (");
  EXPECT_TRUE(fs::exists("run/model.h5"));
}

TEST_F(Kept, FailedValidationSamplesLeaveTheOthersMeasured) {
  spill("mu.csv", set_with(10, 1));
  const Finished offline = shell(rbvi(2, wide + "-out run -valid mu.csv"));
  ASSERT_TRUE(fs::exists("run/model.h5")) << offline.err;
  for (const int ranks : {1, 2}) {
    fs::remove_all("run/verify");
    const Finished run = shell(rbvi(ranks, "verify -out run"));
    expect_failure(run, "1 of 11 validation samples failed");
    EXPECT_EQ(lines_with(run.out, "Relative errors over 10 validation mu"), 1) << run.out;
    EXPECT_EQ(lines_with(run.out, "6 of 14 corners and centres of faces have no high-fidelity"), 1)
        << run.out;
    EXPECT_EQ(lines_with(run.out, "wrote run/verify, run/model.h5"), 1) << run.out;
    EXPECT_EQ(lines_with(slurp("run/verify/errors.csv"), ""), 11);
  }
  EXPECT_TRUE(contains(shell(rbvi_online("run/model.h5")).out, "over 18 parameters"));
  EXPECT_TRUE(contains(output_of(rbvi_online("run/model.h5 --mu 0.101,0.049,0.049")),
                       "nearer to a corner or a face of the box"));
  fs::remove_all("run/verify");
  for (const std::string command : {"verify", "bench"})
    expect_failure(shell(rbvi(2, command + " -out run -sweep_max_failures 0")),
                   "1 of 11 validation samples failed, more than");
  EXPECT_FALSE(fs::exists("run/verify"));
  EXPECT_FALSE(fs::exists("run/bench"));
}

/// The case says otherwise: verify measures the model that there is, and says so.
TEST_F(Kept, VerifyUsesTheModelsBoxAndOptions) {
  output_of(rbvi(2, "offline -case case.yaml -out run"));
  const std::string plain = output_of(rbvi(1, "verify -out run"));
  EXPECT_FALSE(contains(plain, "own values")) << plain;
  const std::string errors = slurp("run/verify/errors.csv");
  const std::string out =
      output_of(rbvi(1, "verify -case case.yaml -out run -radius 0.2,0.3 -center_x 0.01 -load -20 "
                        "-mesh_refine 1 -train grid:2,3"));
  const std::string line = line_with(out, "The model is not of this case");
  for (const char *part : {"radius [0.16, 0.24] instead of [0.2, 0.3]",
                           "center_x [-0.05, 0.05] instead of 0.01", "load -25 instead of -20",
                           "mesh_refine 0 instead of 1", "train grid:2,2,2 instead of grid:2,3"})
    EXPECT_TRUE(contains(line, part)) << part << "\n" << line;
  EXPECT_FALSE(contains(line, "center_y")) << line;
  EXPECT_EQ(slurp("run/verify/errors.csv"), errors);
  // A validation point outside the model's box is not extrapolated to.
  spill("wide.csv", "radius,center_x,center_y\n0.3,0,0\n");
  const Finished outside = shell(rbvi(2, "verify -out run -radius 0.2,0.3 -valid wide.csv"));
  EXPECT_EQ(outside.status, 2);
  EXPECT_TRUE(contains(outside.err, "radius = 0.3 is outside [0.16, 0.24]")) << outside.err;
}

TEST_F(Kept, ARunDirectoryIsCompleteAndMayMove) {
  fs::create_directories("mine/elsewhere");
  fs::rename("case.yaml", "mine/case.yaml");
  spill("mine/mu.csv", set_with(8, 0));
  const std::string mine = "-case mine/case.yaml -radius 0.16,0.3 -train mu.csv ";
  spill("mine/case.yaml", slurp("mine/case.yaml") + "nitsche_eim_validation: mu.csv\n");
  // Sets of the command line are the caller's, those of the case file stand beside it.
  EXPECT_TRUE(contains(shell(rbvi(1, "offline " + mine + "-out run")).err, "mu.csv"));
  spill("mine/case.yaml",
        "case: " RBVI_CASES "/membrane_obstacle\nmesh: coarse.msh\nradius: 0.16,0.3\n"
        "train: mu.csv\nvalid: mu.csv\n");
  output_of(rbvi(2, "offline -case mine/case.yaml -out run"));
  output_of("sh -c 'cd mine/elsewhere && " + rbvi(2, "verify -out ../../run") + "'");
  const std::string errors = slurp("run/verify/errors.csv");
  fs::remove("mine/mu.csv");
  fs::rename("run", "mine/moved");
  const std::string again = output_of("sh -c 'cd mine && " + rbvi(1, "verify -out moved") + "'");
  EXPECT_FALSE(contains(again, "own values")) << again;
  EXPECT_EQ(lines_with(slurp("mine/moved/verify/errors.csv"), ""), lines_with(errors, ""));
  const std::string resumed = output_of(rbvi(1, "offline -out mine/moved"));
  EXPECT_TRUE(contains(resumed, "all 8 were there")) << resumed;
}

/// The case, its mesh and its run in one folder.
TEST_F(Kept, AProjectMayBeRenamed) {
  fs::create_directories("mine");
  fs::rename("coarse.msh", "mine/coarse.msh");
  spill("mine/options.yaml", slurp("case.yaml"));
  output_of(rbvi(2, "offline -case mine/options.yaml -out mine/run"));
  fs::rename("mine", "ours");
  EXPECT_FALSE(contains(output_of(rbvi(1, "verify -out ours/run")), "own values"));
  EXPECT_TRUE(contains(output_of(rbvi(1, "offline -out ours/run")), "all 8 were there"));
}

/// Nothing is written for a set that is not there, the one of a later command included.
TEST_F(Kept, MissingSetsAreBadInputFromTheBeginning) {
  expect_all_refused({{"offline -case case.yaml -train no.csv -out run", "no.csv"},
                      {"offline -case case.yaml -valid no.csv -out run", "no.csv"}});
}

TEST_F(Kept, DamagedSamplesAreSolvedAgain) {
  output_of(rbvi(2, "offline -case case.yaml -out run"));
  for (const int ranks : {1, 2})
    for (const bool truncated : {false, true}) {
      const fs::path sample = files_in("run/samples", ".h5").front();
      std::string bytes = slurp(sample);
      bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
      spill(sample, truncated ? bytes.substr(0, 1000) : bytes);
      const Finished run = shell(rbvi(ranks, "offline -case case.yaml -out run"));
      EXPECT_EQ(run.status, 0) << run.err;
      EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
      EXPECT_EQ(lines_with(run.err, "rbvi: warning: " + sample.string() + " is "), 1) << run.err;
      EXPECT_TRUE(contains(run.err, truncated ? "truncated" : "damaged (")) << run.err;
      EXPECT_TRUE(contains(run.out, "1 solved")) << run.out;
      const std::vector<fs::path> aside = files_in("run/samples", ".damaged");
      ASSERT_EQ(aside.size(), 1U);
      fs::remove(aside.front());
    }
  EXPECT_EQ(shell(rbvi(1, "offline -case case.yaml -out run")).err, "");
}

std::vector<pid_t> children_of(pid_t parent) {
  const std::string id = std::to_string(parent);
  std::istringstream text(slurp("/proc/" + id + "/task/" + id + "/children"));
  return {std::istream_iterator<pid_t>(text), {}};
}

std::size_t samples_in(const std::string &run) {
  return fs::exists(run + "/samples") ? files_in(run + "/samples", ".h5").size() : 0;
}

/// Starts `command`, which sweeps into stopped/, and sends it `signal` as soon as 10 samples are
/// there; `to_rank`: to the last of mpirun's ranks instead.
Finished interrupted(const std::string &command, int signal, bool to_rank) {
  const pid_t child = fork();
  if (child == 0) {
    ::signal(signal, SIG_DFL);
    const int out = open("stopped.out", O_WRONLY | O_CREAT | O_TRUNC, 0666),
              err = open("stopped.err", O_WRONLY | O_CREAT | O_TRUNC, 0666);
    dup2(out, 1);
    dup2(err, 2);
    execl("/bin/sh", "sh", "-c", ("exec " + command).c_str(), nullptr);
    _exit(127);
  }
  int status = 0;
  while (samples_in("stopped") < 10 && waitpid(child, &status, WNOHANG) == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const std::vector<pid_t> ranks = children_of(child);
  kill(to_rank && !ranks.empty() ? ranks.back() : child, signal);
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, slurp("stopped.out"), slurp("stopped.err")};
}

struct Interruption {
  int ranks, signal;
  bool to_rank;
  int status;
};

TEST_F(Kept, ASignalEndsInOneLineAndNothingIsLost) {
  // What mpirun hands on before it kills: the default, which the other tests do without.
  setenv("OMPI_MCA_odls_base_sigkill_timeout", "1", 1);
  // Long enough for mpirun to hand the signal on.
  const std::string sweep = "offline -case case.yaml -mesh_refine 2 -train grid:6,6,6 "
                            "-pod_tolerance 1e-3 -cone_type mcpg -cone_tolerance 1e-1 -out stopped";
  for (const Interruption &c :
       {Interruption{1, SIGINT, false, 128 + SIGINT},
        Interruption{1, SIGTERM, false, 128 + SIGTERM},
        Interruption{1, SIGHUP, false, 128 + SIGHUP}, Interruption{2, SIGINT, false, 1},
        Interruption{2, SIGTERM, false, 1}, Interruption{2, SIGTERM, true, 128 + SIGTERM}}) {
    SCOPED_TRACE(std::to_string(c.ranks) + " ranks, signal " + std::to_string(c.signal));
    fs::remove_all("stopped");
    const Finished run = interrupted(rbvi(c.ranks, sweep), c.signal, c.to_rank);
    const std::size_t present = samples_in("stopped");
    EXPECT_LT(present, 216U);
    EXPECT_EQ(run.status, c.status) << run.err;
    EXPECT_EQ(lines_with(run.err, "rbvi: "), 1) << run.err;
    EXPECT_TRUE(contains(run.err, "rbvi: interrupted after ")) << run.err;
    EXPECT_TRUE(contains(run.err, " of 216 samples: the same command goes on from there"));
    EXPECT_FALSE(contains(run.err, "PETSC ERROR")) << run.err;
    // The file in the making when the line is printed is still finished.
    const std::string words = "interrupted after ";
    const std::size_t at = run.err.find(words);
    ASSERT_NE(at, std::string::npos);
    const auto said = static_cast<std::size_t>(std::stoi(run.err.substr(at + words.size())));
    EXPECT_GE(present, said);
    if (c.ranks == 1) {
      EXPECT_LE(present, said + 1);
    }
    if (c.signal != SIGTERM || c.to_rank) continue;
    const Finished resumed = shell(rbvi(c.ranks, "offline -out stopped"));
    EXPECT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_TRUE(contains(resumed.out, "; " + std::to_string(present) + " reused")) << resumed.out;
    EXPECT_TRUE(files_in("stopped/samples", ".tmp.").empty());
  }
}

/// Left by SIGKILL in the middle of a write, in each folder of a run.
TEST_F(Kept, TemporaryFilesOfKilledRunsAreSweptUp) {
  output_of(rbvi(1, "offline -case case.yaml -out run"));
  output_of(rbvi(1, "verify -out run -verify_stability no"));
  const pid_t dead = fork();
  if (dead == 0) _exit(0);
  waitpid(dead, nullptr, 0);
  const auto dotted = [](pid_t process) {
    return std::string(".") + std::to_string(process) + ".";
  };
  const std::string own = dotted(getpid());
  const std::vector<std::string> names{"run/model.h5", "run/samples/a.h5", "run/verify/errors.csv"};
  const auto leave = [&] {
    for (const std::string &name : names) {
      std::string left = temporary_name(name, 0).string();
      spill(left.replace(left.rfind(own), own.size(), dotted(dead)), "half");
    }
  };
  for (const std::string command : {"offline", "verify"}) {
    leave();
    output_of(rbvi(2, command + " -out run"));
    for (const char *folder : {"run", "run/samples", "run/verify"})
      EXPECT_TRUE(files_in(folder, ".tmp.").empty()) << command << " " << folder;
  }
}

} // namespace
} // namespace rbvi::kept_test
