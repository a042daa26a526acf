// The table of the options of rbvi: each is written down there once. What is read, checked, printed
// by -help, kept in models and listed in cases/OPTIONS.md is made from it.
#pragma once

#include "rbvi/tool/options.hpp"

#include <functional>

namespace rbvi {

/// Runs of one kind. An option for these alone is refused on the command line of others.
struct Use {
  const Use *within; ///< of these alone; null: of all
  bool (*in)(const OfflineOptions &options);
  const char *is_for; ///< as the refusal says it: "-hf_method uzawa"
};

/// The outermost use that the run is not of; null: it is of all of them.
const Use *unmet(const Use &use, const OfflineOptions &options);
inline bool is_of(const Use &use, const OfflineOptions &options) {
  return unmet(use, options) == nullptr;
}

namespace use {

extern const Use friction, tresca;
/// Of the mixed formulation: its solvers, its iterations, and how its multipliers are reduced.
extern const Use multipliers, active_set, uzawa, following;
extern const Use dual_basis, law, hats, collocated, rows_apart, tangential_rows;
/// Of Nitsche's method, its terms, and its rules for the curve.
extern const Use nitsche, coulomb_terms, empirical, interpolated;
/// Of models that can be asked by -online_method, and whose method is not the default.
extern const Use online, not_exact, certified;

} // namespace use

enum class OptionKind {
  text,
  file, ///< one that is read
  set,  ///< of parameters, as parse_set reads it: maybe a file that is read
  number,
  integer,
  flag, ///< without a value: yes
  choice
};

struct Choice {
  std::string name;
  std::string is = ""; ///< what it means, for the page; "" where the name says it
};

/// One option. Those of scenes, and their parameters, are described in the same way.
struct Option {
  std::string name;
  OptionKind kind = OptionKind::text;
  std::string help;
  std::string values{};          ///< which there are, in words: "0 to 0.5"
  std::string default_value{};   ///< "" where there is none
  std::vector<Choice> choices{}; ///< of OptionKind::choice
  bool of_command = false;       ///< not kept in the case file of a run
  std::string group{};           ///< heading that it stands below

  /// Reads a value into its place; throws bad_input. Empty: read before all others.
  std::function<void(const std::string &value)> read{};
  std::function<std::string()> shown{}; ///< the value in its place as text
  const Use *use = nullptr;             ///< runs that it is for; null: all
  bool waits = true;         ///< in a case file, for another command line, where it has no effect
  std::string kept_as{};     ///< among the settings of a model of such runs; "": in none
  const Use *kept = nullptr; ///< where these are not the runs whose models keep it
};

/// All options of rbvi that are not a scene's own, those of a group together; their places are in
/// `options`, which has the defaults, and outlives them where it is.
std::vector<Option> options_of(ToolOptions &options);
/// With places of their own: for all but values.
const std::vector<Option> &tool_options();

struct Command {
  std::string name, does, usage;
  bool options = true; ///< of the table
};
/// Those of rbvi but help.
const std::vector<Command> &commands();

/// Whether it is for that command of the table.
bool serves(const Option &option, const std::string &command);

/// The one of this name; null: there is none. A parameter of such a name (mu alone, see
/// taken_names) has no option of its own: -mu mu=VALUE.
const Option *find_option(const std::string &name);

/// Names of options that parameters and choices of a case do not have: all but mu, by which
/// coefficients of friction go.
std::vector<std::string> taken_names();

/// An option of a scene, and a parameter, by the same type.
Option described(const SceneOption &option);
Option described(const Parameter &parameter);

/// The scene with another choice of one option each, and "-bodies one", that choice.
std::vector<std::pair<std::string, Scene>> variants(const SceneEntry &entry);

/// Parameters of the scene, and those that variants add, with "" and that choice.
std::vector<std::pair<Parameter, std::string>> parameters_of(const SceneEntry &entry);

/// Throws bad_input for options that do not go together, or not with the scene.
void check_rules(const OfflineOptions &options);

/// Bases, stability, separation, multipliers and Nitsche's method, in this order.
std::vector<Option> reduction_options(OfflineOptions &options);

} // namespace rbvi
