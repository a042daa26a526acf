// A sweep of a membrane on a coarse mesh, in a directory of its own.
#pragma once

#include "tests/catalogue.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/sweep/sweep.hpp"

#include "../coarse_mesh.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

namespace rbvi::testing_sweep {

namespace fs = std::filesystem;

inline int rank_in_world() {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return rank;
}

inline int ranks_in_world() {
  int size = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  return size;
}

/// A box in which the map inverts cells near radius = 0.6.
inline Scene wide_scene() {
  Scene scene = make_scene("membrane_obstacle");
  scene.parameters.all[0].upper = 0.6;
  return scene;
}

inline const std::vector<Mu> five{
    {0.2, 0, 0}, {0.18, 0.02, -0.01}, {0.17, -0.05, 0.05}, {0.24, 0.05, 0.05}, {0.21, 0, 0.03}};
inline const Mu impossible{0.6, 0.05, 0.05};

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
    return run_sweep(PETSC_COMM_WORLD, groups, problem, options, set, {directory / where});
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

inline bool contains(const std::string &text, const std::string &part) {
  return text.find(part) != std::string::npos;
}

inline double relative(const Vector &a, const Vector &b) {
  return (a - b).norm() / b.norm();
}

} // namespace rbvi::testing_sweep
