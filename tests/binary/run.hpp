// Runs the tools from outside, as a user does, and keeps what they print.
#pragma once

#include "../coarse_mesh.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

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

/// `name` tells apart commands that run at the same time. A command that hangs ends after a minute
/// with status 124.
inline Finished shell(const std::string &command, const std::string &name = "last") {
  const std::string out = name + ".stdout", err = name + ".stderr";
  const int status =
      std::system(("timeout 60 " + command + " >" + out + " 2>" + err + " </dev/null").c_str());
  Finished run{WIFEXITED(status) ? WEXITSTATUS(status) : -1, slurp(out), slurp(err)};
  fs::remove(out);
  fs::remove(err);
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

/// A directory of its own with a coarse mesh and a case of 8 training parameters, in which the
/// commands run.
struct InDirectory : testing::Test {
  fs::path before = fs::current_path();
  fs::path directory = fs::path(testing::TempDir()) / ("rbvi_binary_" + std::to_string(getpid()));

  void SetUp() override {
    fs::create_directories(directory);
    fs::current_path(directory);
    spill("coarse.msh", coarse_gmsh());
    spill("case.yaml", "scene: membrane_obstacle\n"
                       "mesh: coarse.msh\n"
                       "train: grid:2,2,2\n"
                       "valid: random:3:1\n");
  }
  void TearDown() override {
    fs::current_path(before);
    fs::remove_all(directory);
  }
};

} // namespace rbvi
