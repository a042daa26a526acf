#include "rbvi/sweep/sweep.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/h5.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/progress.hpp"
#include "sample_file.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <set>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

fs::path failure_file(const fs::path &sample) {
  return fs::path(sample).replace_extension("failed");
}

/// Solves one sample; its file, or the file with the reason of its failure, is there afterwards.
void solve_sample(HighFidelity &solver, const Groups &groups, const ParameterSpace &space,
                  const Mu &mu, const fs::path &file, const Settings &settings) {
  std::string reason;
  Sample sample{mu, {}, {}, {}};
  try {
    HfSolution solution = solver.solve(mu);
    sample.u = std::move(solution.u);
    sample.lambda = std::move(solution.lambda);
    sample.outputs = solution.outputs;
  } catch (const Error &error) {
    if (error.status() == Status::bad_input) throw;
    reason = error.what();
  }
  if (!groups.leads()) return;
  if (reason.empty()) {
    write_sample(file, sample, settings);
    fs::remove(failure_file(file));
  } else {
    write_atomically(failure_file(file), reason + ", while solving " + describe(space, mu) + "\n");
  }
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// "12.3 ms each, "
std::string each(double seconds) {
  char text[48];
  std::snprintf(text, sizeof text, "%.1f ms each, ", 1e3 * seconds);
  return text;
}

/// One sample tells what all of a directory were made with, those of other sets included.
void check_directory(const fs::path &directory, const Settings &settings) {
  for (const auto &entry : fs::directory_iterator(directory)) {
    if (entry.path().extension() != ".h5") continue;
    (void)read_sample(entry.path(), settings);
    return;
  }
}

/// The numbers of `set` that have no sample yet, agreed by rank 0 for all.
std::vector<int> missing_samples(MPI_Comm world, const std::vector<Mu> &set,
                                 const fs::path &directory, const Settings &settings) {
  std::vector<int> missing(set.size(), 1);
  collectively(world, [&] {
    int rank = 0;
    MPI_Comm_rank(world, &rank);
    if (rank != 0) return;
    std::error_code error;
    fs::create_directories(directory, error);
    if (error)
      throw failure("cannot make the directory " + directory.string() + ": " + error.message());
    check_directory(directory, settings);
    for (std::size_t i = 0; i < set.size(); ++i)
      missing[i] = !fs::exists(sample_file(directory, set[i]));
  });
  MPI_Bcast(missing.data(), static_cast<int>(missing.size()), MPI_INT, 0, world);
  std::vector<int> numbers;
  for (std::size_t i = 0; i < set.size(); ++i)
    if (missing[i] != 0) numbers.push_back(static_cast<int>(i));
  return numbers;
}

/// The samples that are there, and the reasons of those that are not. Collective.
void collect(MPI_Comm world, const std::vector<Mu> &set, const fs::path &directory,
             const Settings &settings, Sweep &sweep) {
  collectively(world, [&] {
    for (const Mu &mu : set) {
      const fs::path file = sample_file(directory, mu);
      if (fs::exists(file)) {
        sweep.samples.push_back(read_sample(file, settings));
      } else {
        std::ifstream stream(failure_file(file));
        std::string reason;
        std::getline(stream, reason);
        sweep.report.failed.emplace_back(mu, reason);
      }
    }
  });
}

/// Each group solves its share of the missing samples.
void solve_missing(MPI_Comm world, const Groups &groups, Problem &problem, const HfOptions &options,
                   const std::vector<Mu> &set, const std::vector<int> &missing,
                   const fs::path &directory, const Settings &settings) {
  const auto total = static_cast<int>(missing.size());
  const int begin = total * groups.mine() / groups.count();
  const int end = total * (groups.mine() + 1) / groups.count();
  int rank = 0;
  MPI_Comm_rank(world, &rank);
  // The first group tells of all: it knows its own share, and takes the others to be as far.
  Progress progress(groups.count() == 1
                        ? "samples"
                        : "samples (about), " + std::to_string(groups.count()) + " groups",
                    total, rank == 0);
  HighFidelity solver(problem, options);
  collectively(world, [&] {
    const double start = MPI_Wtime();
    for (int k = begin; k < end; ++k) {
      const Mu &mu = set[static_cast<std::size_t>(missing[static_cast<std::size_t>(k)])];
      collectively(groups.comm(), [&] {
        solve_sample(solver, groups, problem.scene().parameters, mu, sample_file(directory, mu),
                     settings);
      });
      const int done = k + 1 - begin;
      progress.update(total * done / (end - begin), each((MPI_Wtime() - start) / done));
    }
  });
}

double median_seconds(const std::vector<Sample> &samples, const std::vector<Mu> &set,
                      const std::vector<int> &numbers) {
  std::set<Mu> wanted;
  for (const int i : numbers)
    wanted.insert(set[static_cast<std::size_t>(i)]);
  std::vector<double> seconds;
  for (const Sample &sample : samples)
    if (wanted.contains(sample.mu)) seconds.push_back(sample.outputs.seconds.value_or(0));
  return median(std::move(seconds));
}

} // namespace

Settings sample_settings(const Problem &problem, const HfOptions &options) {
  const Scene &scene = problem.scene();
  Settings settings{{"scene", scene.name}, {"mesh", problem.mesh().fingerprint}};
  for (const auto &[name, value] : scene.options)
    settings[name] = value;
  std::string free;
  for (std::size_t i = 0; i < scene.parameters.all.size(); ++i) {
    const Parameter &parameter = scene.parameters.all[i];
    const auto &list = scene.parameters.free;
    if (std::find(list.begin(), list.end(), static_cast<int>(i)) == list.end())
      settings["fixed " + parameter.name] = number(parameter.value);
    else
      free += (free.empty() ? "" : ",") + parameter.name;
  }
  settings["parameters"] = free;
  if (scene.nitsche) {
    settings["nitsche_bounds"] = options.nitsche.nonpenetration ? "nonpenetration" : "none";
    return settings;
  }
  const char *methods[] = {"active_set", "uzawa", "vi"};
  settings["hf_method"] = methods[static_cast<int>(options.method)];
  if (options.method == HfMethod::uzawa)
    settings["uzawa_tolerance"] = number(options.uzawa_tolerance);
  return settings;
}

fs::path sample_file(const fs::path &directory, const Mu &mu) {
  char name[32];
  std::snprintf(name, sizeof name, "%016" PRIx64 ".h5",
                fnv1a(mu.data(), mu.size() * sizeof(double)));
  return directory / name;
}

Sweep run_sweep(MPI_Comm world, const Groups &groups, Problem &problem, const HfOptions &options,
                const std::vector<Mu> &set, const fs::path &directory) {
  const Settings settings = sample_settings(problem, options);
  const std::vector<int> missing = missing_samples(world, set, directory, settings);
  if (missing.size() < set.size()) { // other options are noticed before any work is done
    Sweep present;
    collect(world, set, directory, settings, present);
  }

  MPI_Barrier(world);
  const double start = MPI_Wtime();
  solve_missing(world, groups, problem, options, set, missing, directory, settings);
  Sweep sweep;
  sweep.report.seconds = MPI_Wtime() - start;
  collect(world, set, directory, settings, sweep);
  sweep.report.reused = static_cast<int>(set.size() - missing.size());
  sweep.report.solved = static_cast<int>(missing.size() - sweep.report.failed.size());
  sweep.report.seconds_per_solve = median_seconds(sweep.samples, set, missing);
  return sweep;
}

} // namespace rbvi
