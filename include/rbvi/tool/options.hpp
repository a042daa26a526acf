// Options of the rbvi tool: read from PETSc's options database (command line over case file),
// checked before any work starts.
#pragma once

#include "rbvi/mor/reduce.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace rbvi {

struct ToolOptions {
  Scene scene; ///< with its parameters as freed, fixed and bounded by the options
  MeshOptions mesh;
  std::string train, valid; ///< as parse_set reads them
  HfOptions hf;
  ReduceOptions reduce;
  int ranks_per_solve = 1;
  std::filesystem::path out; ///< run directory; "" where none is given
  std::string mu, vtu, csv;
  bool plan = false;
};

/// One option for -help.
struct OptionHelp {
  std::string name, default_value, help;
};

/// All options of rbvi that are not a scene's own.
const std::vector<OptionHelp> &tool_options();

/// "--name" becomes "-name"; what PETSc would take for itself stays. To be called before PETSc
/// starts.
std::vector<std::string> normalised_arguments(int argc, char **argv);

/// Collective. Inserts the case file under the command line and reads everything. Throws bad_input
/// for an unknown option (naming the nearest one), a missing or malformed case file, or a value
/// that does not fit.
ToolOptions read_options(MPI_Comm comm);

/// Throws bad_input if an option with this prefix was given but no PETSc object has asked for it.
void check_used(const std::string &prefix);

/// Prints the usage, the options above and those of the scenes.
void print_help();

} // namespace rbvi
