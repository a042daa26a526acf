// Snapshots: high-fidelity solves at many mu, shared among groups of ranks, one file per sample.
//
// Each sample is committed by itself (write, fsync, rename), so that an interrupted sweep resumes
// and recomputes only what is missing. A sample that fails leaves its reason, the others go on. A
// damaged file is set aside and its sample solved again. Niakh (2022): (1.20), (2.8), (2.9).
#pragma once

#include "rbvi/par/groups.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace rbvi {

/// One solved parameter.
struct Sample {
  Mu mu;
  Vector u;      ///< all dofs, natural order; empty where it is read when asked (displacement)
  Vector lambda; ///< dual dofs
  Outputs outputs;
  /// Where contact follows the displacement: contact dofs x steps, HfSolution::states; else empty.
  Matrix states{};
  std::filesystem::path file{}; ///< that has it; empty: none
};

/// What a solve at mu leaves.
Sample make_sample(const Mu &mu, HfSolution solution);

/// Its u, from its file where it is not held, on every rank. Throws DamagedFile if that has
/// changed. Collective on `comm`.
Vector displacement(MPI_Comm comm, const Sample &sample);

/// Their parameters.
std::vector<Mu> parameters_of(const std::vector<Sample> &samples);

/// Where their contact was evaluated: at each mu, or at each state (mu, k) of the iterations.
std::vector<ContactPoint> contact_points(const std::vector<Sample> &samples);

/// Everything that a sample depends on beside mu: name -> value.
using Settings = std::map<std::string, std::string>;
inline constexpr const char *whole_scene = "whole scene"; ///< the setting that is Scene::tree

/// The settings of a problem and its solver: scene, its options, fixed parameters, mesh, method and
/// tolerances.
Settings sample_settings(const Problem &problem, const HfOptions &options);

struct SweepReport {
  int reused = 0, solved = 0;
  int set_aside = 0;                              ///< damaged files, now "<name>.damaged"
  std::vector<std::pair<Mu, std::string>> failed; ///< with their reasons, in order of the set
  double seconds = 0;                             ///< wall time of the sweep
  double seconds_per_solve = 0;                   ///< median over the samples solved now
};

struct Sweep {
  std::vector<Sample> samples; ///< in order of the set, failed ones left out; on every rank
  SweepReport report;
};

/// Of the samples of a sweep: held on every rank, all of them, or left in their files.
enum class Fields { held, in_files };

/// Where a sweep keeps its samples, and what it does with them.
struct SampleStore {
  std::filesystem::path directory;
  /// Called on every rank once it is known that there are no samples of other settings, before
  /// anything is written.
  std::function<void()> begin = [] {};
  Fields fields = Fields::held;
};

/// `samples/<hash of mu>.h5`
std::filesystem::path sample_file(const std::filesystem::path &directory, const Mu &mu);

/// Throws bad_input where samples in the directory were made with other settings than run_sweep's:
/// to be told before anything else is.
void check_samples(const Problem &problem, const HfOptions &options,
                   const std::filesystem::path &directory);

/// Collective on `world`. `problem` lives on the communicator of this rank's group. Samples that
/// are there already are reused; throws bad_input, naming the setting and both values, if one was
/// made with other settings. What remains there of killed runs is removed.
Sweep run_sweep(MPI_Comm world, const Groups &groups, Problem &problem, const HfOptions &options,
                const std::vector<Mu> &set, const SampleStore &store);

} // namespace rbvi
