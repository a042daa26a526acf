// Runs the tools from outside, as a user does, and keeps what they print.
#pragma once

#include "../coarse_mesh.hpp"
#include "rbvi/core/parameters.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace rbvi {

namespace fs = std::filesystem;

struct Finished {
  int status = -1;
  std::string out, err;
};

inline std::string slurp(const fs::path &path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

inline void spill(const fs::path &path, const std::string &bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

inline bool contains(const std::string &text, const std::string &part) {
  return text.find(part) != std::string::npos;
}

/// Lines that begin with `start`.
inline int lines_with(const std::string &text, const std::string &start) {
  std::istringstream lines(text);
  int count = 0;
  for (std::string line; std::getline(lines, line);)
    count += line.starts_with(start) ? 1 : 0;
  return count;
}

/// The first line that begins with `start`.
inline std::string line_with(const std::string &text, const std::string &start) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(start)) return line;
  ADD_FAILURE() << "no line " << start << " in\n" << text;
  return "";
}

/// "name value" among the lines of a report.
inline double value_of(const std::string &text, const std::string &name) {
  const std::string line = line_with(text, name + " ");
  std::istringstream words(line);
  std::string first, value;
  words >> first >> value; // an error may stand behind
  return line.empty() ? 0 : parse_number(value, name);
}

/// `name` tells apart commands that run at the same time; each has a directory of its own for Open
/// MPI's files, over which they could trip. A command that hangs ends after a minute with status
/// 124.
inline Finished shell(const std::string &command, const std::string &name = "last") {
  const std::string out = name + ".stdout", err = name + ".stderr";
  const fs::path mpi = fs::temp_directory_path() / (name + "-" + std::to_string(getpid()));
  const std::string line = "OMPI_MCA_orte_tmpdir_base=" + mpi.string() + " timeout 60 " + command +
                           " >" + out + " 2>" + err + " </dev/null";
  const int status = std::system(line.c_str());
  Finished run{WIFEXITED(status) ? WEXITSTATUS(status) : -1, slurp(out), slurp(err)};
  std::error_code ignored; // a daemon of Open MPI may be removing its own files
  for (const fs::path &left : {fs::path(out), fs::path(err), mpi})
    fs::remove_all(left, ignored);
  return run;
}

/// The MPI tool; one rank without mpirun.
inline std::string rbvi(int ranks, const std::string &arguments) {
  const std::string mpirun = RBVI_MPIRUN " -n " + std::to_string(ranks) + " ";
  return (ranks == 1 ? std::string() : mpirun) + RBVI_TOOL " " + arguments;
}

inline std::string rbvi_online(const std::string &arguments) {
  return RBVI_ONLINE " " + arguments;
}

/// What a command prints that must succeed and say nothing on stderr.
inline std::string output_of(const std::string &command) {
  const Finished run = shell(command);
  EXPECT_EQ(run.status, 0) << command << "\n" << run.err;
  EXPECT_EQ(run.err, "") << command;
  return run.out;
}

/// Verifies run/ on 2 ranks: what is printed; the tables must be there.
inline std::string verified() {
  const std::string out = output_of(rbvi(2, "verify -out run"));
  for (const char *table : {"errors", "summary", "error_map", "worst_pressure", "samples"})
    EXPECT_TRUE(fs::exists(std::string("run/verify/") + table + ".csv")) << table;
  return out;
}

inline void expect_fields(const std::string &file, const std::vector<std::string> &names) {
  const std::string written = slurp(file);
  for (const std::string &name : names)
    EXPECT_TRUE(contains(written, "Name=\"" + name + "\"")) << file << " " << name;
}

/// A command of rbvi that is bad input.
struct Refusal {
  std::string arguments;
  std::string part; ///< of the message
  int status = 2;
};

/// One line of ours with the documented status.
inline void expect_refused(const Refusal &c, const Finished &run, int ranks) {
  SCOPED_TRACE("rbvi " + c.arguments + ", " + std::to_string(ranks) + " ranks: status " +
               std::to_string(run.status) + "\n" + run.err);
  EXPECT_EQ(run.status, c.status);
  EXPECT_TRUE(contains(run.err, c.part)) << "expected: " << c.part;
  EXPECT_EQ(lines_with(run.err, "rbvi: "), 1);
  for (const char *noise : {"PETSC ERROR", "WARNING!", "terminate called", "MPI_ABORT"})
    EXPECT_FALSE(contains(run.err, noise));
  if (ranks == 1) {
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1);
  }
}

/// In turns on 1 and 2 ranks; run/ is not made.
inline void expect_all_refused(const std::vector<Refusal> &cases) {
  int ranks = 1;
  for (const Refusal &c : cases) {
    ranks = 3 - ranks;
    expect_refused(c, shell(rbvi(ranks, c.arguments)), ranks);
    EXPECT_FALSE(fs::exists("run")) << c.arguments;
  }
}

/// A directory of its own with a coarse mesh and a case of 8 training parameters, in which the
/// commands run.
struct InDirectory : testing::Test {
  fs::path before = fs::current_path();
  fs::path directory = fs::path(testing::TempDir()) / ("rbvi_binary_" + std::to_string(getpid()));

  void SetUp() override {
    fs::create_directories(directory);
    fs::current_path(directory);
    spill("coarse.msh", coarse_gmsh());
    // Exact quadrature: there Uzawa's method is slow enough to fail where a test wants it to.
    spill("case.yaml", "case: " RBVI_CASES "/membrane_obstacle\n"
                       "mesh: coarse.msh\n"
                       "train: grid:2,2,2\n"
                       "valid: random:3:1\n"
                       "lumped: no\n");
  }
  void TearDown() override {
    fs::current_path(before);
    fs::remove_all(directory);
  }
};

} // namespace rbvi
