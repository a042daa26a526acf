#include "rbvi/sweep/sweep.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/checksum.hpp"
#include "rbvi/io/h5.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/interrupt.hpp"
#include "rbvi/par/progress.hpp"
#include "rbvi/par/queue.hpp"
#include "rbvi/solve/methods.hpp"
#include "sample_file.hpp"

#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <set>
#include <thread>

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
/// Returns whether it was solved.
bool solve_sample(HighFidelity &solver, const Groups &groups, const ParameterSpace &space,
                  const Mu &mu, const fs::path &file, const Settings &settings) {
  std::string reason;
  Sample sample;
  try {
    sample = make_sample(mu, solver.solve(mu));
  } catch (const Error &error) {
    if (error.status() == Status::bad_input) throw;
    reason = error.what();
  }
  if (!groups.leads()) return reason.empty();
  if (reason.empty()) {
    write_sample(file, sample, settings);
    fs::remove(failure_file(file));
  } else {
    write_atomically(failure_file(file), reason + ", while solving " + describe(space, mu) + "\n");
  }
  return reason.empty();
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
  std::error_code none;
  for (const auto &entry : fs::directory_iterator(directory, none)) {
    if (entry.path().extension() != ".h5") continue;
    try {
      (void)read_sample(entry.path(), settings);
      return;
    } catch (const DamagedFile &) {
      continue;
    }
  }
}

/// What a sweep is asked for.
struct Wanted {
  const std::vector<Mu> &set;
  const SampleStore &store;
  Settings settings;
};

/// What there is of it.
struct Stock {
  std::vector<int> missing;      ///< 1 where there is no sample, 0 where there is one
  std::vector<fs::path> damaged; ///< files in the way of a sample or of its reason
  std::string damage;            ///< what the first one is
};

Stock take_stock(const Wanted &wanted) {
  const auto &[set, store, settings] = wanted;
  Stock stock{std::vector<int>(set.size(), 1), {}, ""};
  const auto note = [&](const fs::path &file, const std::string &damage) {
    if (stock.damaged.empty()) stock.damage = damage;
    stock.damaged.push_back(file);
  };
  check_directory(store.directory, settings);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const fs::path file = sample_file(store.directory, set[i]), reason = failure_file(file);
    if (fs::is_directory(reason)) note(reason, reason.string() + " is a directory");
    if (!fs::exists(file)) continue;
    try {
      (void)read_sample(file, settings);
      stock.missing[i] = 0;
    } catch (const DamagedFile &error) {
      note(file, error.fact);
    }
  }
  return stock;
}

/// "<file>.damaged", or with a number behind it.
fs::path name_aside(const fs::path &file) {
  fs::path name = file.string() + ".damaged";
  for (int number = 2; fs::exists(fs::symlink_status(name)); ++number)
    name = file.string() + ".damaged." + std::to_string(number);
  return name;
}

/// Renames the damaged files, and says so in one line.
void set_aside(const Stock &stock) {
  if (stock.damaged.empty()) return;
  for (const fs::path &file : stock.damaged) {
    if (!fs::exists(fs::symlink_status(file))) continue; // twice in the set
    while_doing("setting the damaged file " + file.string() + " aside",
                [&] { fs::rename(file, name_aside(file)); });
  }
  const std::string more = stock.damaged.size() == 1
                               ? ""
                               : ", and " + std::to_string(stock.damaged.size() - 1) + " more";
  std::fprintf(stderr, "rbvi: warning: %s%s: set aside under the ending .damaged, solved again\n",
               stock.damage.c_str(), more.c_str());
}

/// By rank 0: makes the directory ready for new samples.
void prepare_directory(const fs::path &directory, const Stock &stock) {
  make_directory(directory);
  remove_stale_temporaries(directory);
  set_aside(stock);
}

/// The numbers of `set` that have no sample yet, agreed by rank 0 for all; the directory is ready
/// for them. Collective.
std::vector<int> missing_samples(MPI_Comm world, const Wanted &wanted, SweepReport &report) {
  const int rank = rank_of(world);
  const std::vector<Mu> &set = wanted.set;
  Stock stock{std::vector<int>(set.size(), 1), {}, ""};
  collectively(world, [&] {
    if (rank == 0) stock = take_stock(wanted);
  });
  wanted.store.begin();
  collectively(world, [&] {
    if (rank == 0) prepare_directory(wanted.store.directory, stock);
  });
  report.set_aside = static_cast<int>(stock.damaged.size());
  MPI_Bcast(&report.set_aside, 1, MPI_INT, 0, world);
  MPI_Bcast(stock.missing.data(), static_cast<int>(stock.missing.size()), MPI_INT, 0, world);
  std::vector<int> numbers;
  for (std::size_t i = 0; i < set.size(); ++i)
    if (stock.missing[i] != 0) numbers.push_back(static_cast<int>(i));
  return numbers;
}

/// The samples that are there, and the reasons of those that are not. Collective.
void collect(MPI_Comm world, const Problem &problem, const Wanted &wanted, Sweep &sweep) {
  collectively(world, [&] {
    for (const Mu &mu : wanted.set) {
      const fs::path file = sample_file(wanted.store.directory, mu);
      if (fs::exists(file)) {
        Sample sample;
        try {
          sample = read_sample(file, wanted.settings);
        } catch (const DamagedFile &error) { // since the sweep began
          throw failure(error.what());
        }
        try { // outputs of the case may be others than when it was solved
          add_named_outputs(problem, expand(problem.scene().parameters, mu), sample.u,
                            sample.lambda, sample.outputs);
        } catch (const Error &error) {
          sweep.report.failed.emplace_back(mu, error.what());
          continue;
        }
        if (wanted.store.fields == Fields::in_files) sample.u = Vector();
        sweep.samples.push_back(std::move(sample));
      } else {
        std::ifstream stream(failure_file(file));
        std::string reason;
        std::getline(stream, reason);
        sweep.report.failed.emplace_back(mu, reason);
      }
    }
  });
}

/// What is said of a sweep that is interrupted: how far all groups came, also after its queue. From
/// memory, not from files: where a slow disk holds them up, mpirun may kill before they are
/// counted.
class ToldWhenInterrupted {
public:
  ToldWhenInterrupted(const SharedQueue &queue, std::size_t samples)
      : queue_(queue), samples_(samples) {
    say_when_interrupted([this] { return text(); });
  }
  ~ToldWhenInterrupted() {
    say_when_interrupted([last = text()] { return last; });
  }
  ToldWhenInterrupted(const ToldWhenInterrupted &) = delete;
  ToldWhenInterrupted &operator=(const ToldWhenInterrupted &) = delete;

private:
  std::string text() const {
    const std::size_t left = static_cast<std::size_t>(queue_.count() - queue_.solved_here());
    return " after " + std::to_string(samples_ - left) + " of " + std::to_string(samples_) +
           " samples: the same command goes on from there";
  }

  const SharedQueue &queue_;
  std::size_t samples_;
};

/// The line that tells how far all groups are. Returns whether they are at the end.
bool tell(Progress &progress, const SharedQueue &queue, const Groups &groups) {
  const QueueState state = queue.state();
  if (state.done > 0)
    progress.update(state.done, seconds_left(state, queue.count(), groups.count()),
                    each(state.seconds / state.done));
  return state.stopped || state.done == queue.count();
}

/// All groups together solve the missing samples, each the next ones when it has none. What one
/// group throws ends all of them, the others after the sample that they are at.
void solve_missing(MPI_Comm world, const Groups &groups, Problem &problem, const HfOptions &options,
                   const Wanted &wanted, const std::vector<int> &missing) {
  const int rank = rank_of(world);
  SharedQueue queue(world, groups, static_cast<int>(missing.size()));
  const ToldWhenInterrupted told(queue, wanted.set.size());
  Progress progress(groups.count() == 1 ? "samples"
                                        : "samples, " + std::to_string(groups.count()) + " groups",
                    queue.count(), rank == 0);
  std::vector<Mu> unsolved;
  for (const int k : missing)
    unsolved.push_back(wanted.set[k]);
  HfOptions of_all = options;
  of_all.samples = static_cast<int>(wanted.set.size()) / groups.count();
  collectively(world, [&] {
    try {
      HighFidelity solver(problem, of_all);
      solver.share_columns(groups, unsolved);
      while (const std::optional<int> k = queue.next()) {
        const Mu &mu = unsolved[*k];
        bool solved = false;
        collectively(groups.comm(), [&] {
          solved = solve_sample(solver, groups, problem.scene().parameters, mu,
                                sample_file(wanted.store.directory, mu), wanted.settings);
        });
        queue.finish(solved);
        if (progress.due()) (void)tell(progress, queue, groups);
      }
    } catch (...) {
      queue.stop();
      throw;
    }
    while (rank == 0 && !tell(progress, queue, groups))
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
}

double median_seconds(const std::vector<Sample> &samples, const std::vector<Mu> &set,
                      const std::vector<int> &numbers) {
  std::set<Mu> wanted;
  for (const int i : numbers)
    wanted.insert(set[i]);
  std::vector<double> seconds;
  for (const Sample &sample : samples)
    if (wanted.contains(sample.mu)) seconds.push_back(sample.outputs.seconds.value_or(0));
  return median(std::move(seconds));
}

} // namespace

Sample make_sample(const Mu &mu, HfSolution solution) {
  Sample sample{mu, std::move(solution.u), std::move(solution.lambda), solution.outputs, {}};
  if (!solution.states.empty())
    sample.states.resize(solution.states.front().size(), std::ssize(solution.states));
  for (std::size_t k = 0; k < solution.states.size(); ++k)
    sample.states.col(k) = solution.states[k];
  return sample;
}

std::vector<Mu> parameters_of(const std::vector<Sample> &samples) {
  std::vector<Mu> set;
  for (const Sample &sample : samples)
    set.push_back(sample.mu);
  return set;
}

std::vector<ContactPoint> contact_points(const std::vector<Sample> &samples) {
  std::vector<ContactPoint> points;
  for (const Sample &sample : samples) {
    if (sample.states.size() == 0) points.push_back({sample.mu, {}});
    for (const auto &state : sample.states.colwise())
      points.push_back({sample.mu, {state}});
  }
  return points;
}

Settings sample_settings(const Problem &problem, const HfOptions &options) {
  const Scene &scene = problem.scene();
  Settings settings{{"mesh", problem.mesh().fingerprint}};
  for (const auto &[name, value] : scene.options)
    settings[name] = value;
  for (std::size_t i = 0; i < scene.parameters.all.size(); ++i) {
    const Parameter &parameter = scene.parameters.all[i];
    const auto &list = scene.parameters.free;
    if (std::find(list.begin(), list.end(), static_cast<int>(i)) == list.end())
      settings["fixed " + parameter.name] = number(parameter.value);
  }
  settings["parameters"] = names_of(scene.parameters);
  settings[whole_scene] = scene.tree;
  if (!has_multipliers(scene)) {
    settings["nitsche_bounds"] = options.nitsche.nonpenetration ? "nonpenetration" : "none";
    return settings;
  }
  settings["hf_method"] = hf_method_names()[static_cast<std::size_t>(options.method)];
  if (options.method == HfMethod::uzawa)
    settings["uzawa_tolerance"] = number(options.uzawa.tolerance);
  if (follows_state(scene)) settings["nonlinear_tolerance"] = number(options.nonlinear.tolerance);
  return settings;
}

fs::path sample_file(const fs::path &directory, const Mu &mu) {
  char name[32];
  std::snprintf(name, sizeof name, "%016" PRIx64 ".h5",
                fnv1a(mu.data(), mu.size() * sizeof(double)));
  return directory / name;
}

void check_samples(const Problem &problem, const HfOptions &options, const fs::path &directory) {
  check_directory(directory, sample_settings(problem, options));
}

Sweep run_sweep(MPI_Comm world, const Groups &groups, Problem &problem, const HfOptions &options,
                const std::vector<Mu> &set, const SampleStore &store) {
  const Wanted wanted{set, store, sample_settings(problem, options)};
  Sweep sweep;
  const std::vector<int> missing = missing_samples(world, wanted, sweep.report);
  MPI_Barrier(world);
  const double start = MPI_Wtime();
  solve_missing(world, groups, problem, options, wanted, missing);
  sweep.report.seconds = MPI_Wtime() - start;
  collect(world, problem, wanted, sweep);
  sweep.report.reused = static_cast<int>(set.size() - missing.size());
  sweep.report.solved = static_cast<int>(std::ranges::count_if(
      missing, [&](int k) { return fs::exists(sample_file(store.directory, set[k])); }));
  sweep.report.seconds_per_solve = median_seconds(sweep.samples, set, missing);
  return sweep;
}

} // namespace rbvi
