// rbvi-online: answers parameters from a reduced model, without MPI.
#pragma once

#include "rbvi/core/scene.hpp"

#include <string>
#include <vector>

namespace rbvi {

struct OnlineArguments {
  /// "" where not given.
  std::string model, mu, queries, out, contact, vtu, pack, fmu, precision, method, threads, only;
  bool extrapolate = false, decorrelated = false, full = false, gradient = false, warm = false,
       json = false, help = false, version = false;
  /// Of the outputs in tables.
  int digits() const { return precision.empty() ? 10 : std::stoi(precision); }
  /// Outputs; empty: all.
  std::vector<std::string> asked() const { return names_in(only); }
  /// Of a table of answers.
  std::size_t thread_count() const { return threads.empty() ? 1 : std::stoul(threads); }
};

/// An option: what it takes ("FILE"; "": it is a flag), what it does, and its place.
struct OnlineOption {
  std::string name, values, help;
  std::string OnlineArguments::*text = nullptr;
  bool OnlineArguments::*flag = nullptr;
};

const std::vector<OnlineOption> &online_options();

/// Reads the arguments behind the program's name; one or two dashes, `--name value` or
/// `--name=value`. Throws bad_input, naming the nearest option.
OnlineArguments parse_online_arguments(const std::vector<std::string> &arguments);

/// The whole program, for models whose scenes and functions the registry has. Returns the exit
/// status.
int rbvi_online_main(int argc, char **argv, const Registry &registry);

} // namespace rbvi
