// Which options are for which command of rbvi.
#include "database.hpp"
#include "table.hpp"

#include "rbvi/core/error.hpp"

namespace rbvi {

namespace {

struct Use {
  const char *what; ///< an option, or a group of them
  const char *commands;
};

constexpr Use uses[] = {{"mu", "solve"},
                        {"vtu", "solve check run"},
                        {"csv", "solve"},
                        {"plan", "offline"},
                        {"run", "check run"},
                        {"bench_growth", "bench"},
                        {"convergence", "bench"},
                        {"train", "offline run"},
                        {"valid", "verify bench run"},
                        {"only", "verify run"},
                        {"verify_stability", "verify run"},
                        {"online_method", "offline verify bench run"},
                        {"nitsche_quadrature", "offline run"},
                        {"nitsche_quadrature_tolerance", "offline run"},
                        {"nitsche_eim_tolerance", "offline run"},
                        {"nitsche_eim_pairs", "offline run"},
                        {"nitsche_eim_validation", "offline run"},
                        {"greedy", "offline run"},
                        {"greedy_tolerance", "offline run"},
                        {"greedy_samples", "offline run"},
                        {"Sweep", "offline verify bench run"},
                        {"Bounds of errors", "offline run"},
                        {"Bases", "offline run"},
                        {"Stability", "offline run"},
                        {"Separation", "offline run"},
                        {"Multipliers", "offline run"}};

/// "": all.
std::string commands_of(const Option &option) {
  for (const Use &use : uses)
    if (option.name == use.what || option.group == use.what) return use.commands;
  return "";
}

} // namespace

const std::vector<Command> &commands() {
  static const std::vector<Command> all{
      {"run", "check, offline, verify and figures of a case, a line for each",
       "rbvi run FILE [-out DIRECTORY] [options]"},
      {"offline", "snapshots, bases, interpolation, reduced model into -out",
       "rbvi offline -case FILE -out DIRECTORY [options]"},
      {"verify", "reduced against high-fidelity over the validation set",
       "rbvi verify -out DIRECTORY [options]"},
      {"solve", "one high-fidelity solve at -mu", "rbvi solve -case FILE -mu VALUES [options]"},
      {"bench", "run time against error", "rbvi bench -out DIRECTORY [options]"},
      {"compare", "errors, sizes and times of runs that were verified",
       "rbvi compare RUN RUN ... [-csv FILE]", false},
      {"check", "a case, before anything is made of it", "rbvi check FILE [options]"},
      {"new", "a case to begin with, in a folder of its own", "rbvi new NAME [-mesh FILE]", false},
      {"list", "the cases of a folder, by default of cases", "rbvi list [FOLDER]", false},
      {"inspect", "what a model file holds", "rbvi inspect FILE", false}};
  return all;
}

bool serves(const Option &option, const std::string &command) {
  const std::string of = commands_of(option);
  return of.empty() || contains(split(of, ' '), command);
}

void check_command(const std::string &command, const std::vector<std::string> &command_line) {
  for (const std::string &name : command_line) {
    const Option *option = find_option(name);
    if (option != nullptr && option->of_command && !serves(*option, command))
      throw bad_input("-" + name + " has no effect on rbvi " + command + ": it is for rbvi " +
                      commands_of(*option));
  }
}

} // namespace rbvi
