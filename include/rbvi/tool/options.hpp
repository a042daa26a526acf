// Options of the rbvi tool: read from PETSc's options database (command line over case file over
// PETSc's files and variables), checked before any work starts.
#pragma once

#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/model/answer.hpp"
#include "rbvi/mor/reduce.hpp"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace rbvi {

/// What is solved, and by which solver.
struct Setup {
  std::shared_ptr<const Registry> registry; ///< of the program, with the scene of the case
  Scene scene; ///< with its parameters as freed, fixed and bounded by the options
  MeshOptions mesh;
  HfOptions hf;
  int contact_gather = static_cast<int>(default_contact_gather);
};

/// Where a run reads and writes, and how it was called.
struct RunFiles {
  std::filesystem::path case_name; ///< of -case; "" where it is that of the run directory
  std::filesystem::path out;       ///< run directory; "" where none is given
  std::string case_file;           ///< all options of the run, for its own file (case_of_run)
  std::string scene_text;          ///< of the case, which stands beside it; "": of the program
  std::vector<std::string> command_line;        ///< names of the options that stand there
  std::map<std::string, std::string> set_files; ///< option -> the file that holds its set
};

/// What a reduced model is made of, and how.
struct OfflineOptions : Setup, RunFiles {
  std::string train;  ///< as parse_set reads it
  std::string greedy; ///< likewise: where bounds of errors may choose further samples; "": nowhere
  double greedy_tolerance = 1e-3;
  int greedy_samples = 200; ///< most of them, with those of `train`
  ReduceOptions reduce;
  int ranks_per_solve = 0;   ///< 0: auto, as group_ranks chooses
  double max_failures = 0.1; ///< share of a set that may fail
  bool plan = false;
};

/// What is measured of it.
struct MeasureOptions : OfflineOptions {
  std::string valid;            ///< as parse_set reads it
  bool stability = true;        ///< verify: inf-sup constants and bounds too
  std::string only;             ///< verify: names of outputs; "": all
  std::vector<int> convergence; ///< bench: refinements on which outputs are compared
  std::vector<int> growth; ///< bench: refinements whose cost is measured; empty: time against error
};

/// A single solve, and what is written of it.
struct SolveOptions {
  std::string mu, vtu, csv;
  bool run_tests = false; ///< check: those of the case
};

struct ToolOptions : MeasureOptions, SolveOptions {};

/// "-name": a dash and a letter, as PETSc sees it.
bool is_option(const std::string &word);

/// "--name" becomes "-name"; what PETSc would take for itself stays. To be called before PETSc
/// starts.
std::vector<std::string> normalised_arguments(int argc, char **argv);

/// Collective. Inserts the options of the case under the command line, above PETSc's files and
/// variables, and reads everything for a command of rbvi; rank 0 prints one line of options from
/// these files and variables. Throws bad_input for an unknown option
/// (naming the nearest one), one of another command, a missing or malformed case file, or a value
/// that does not fit.
ToolOptions read_options(MPI_Comm comm, const std::string &command, const Registry &registry);

/// The options that a model keeps among its settings, by the names that they have there.
std::map<std::string, std::string> kept_settings(const OfflineOptions &options);

/// The case file that a run leaves in its directory, read where no other is named.
std::filesystem::path case_of_run(const std::filesystem::path &out);

/// Collective. Throws bad_input if one of the files that a command will write is one that its
/// options name as input, or another of them, or if the run's case file would replace the user's.
void check_outputs(MPI_Comm comm, const RunFiles &files, const std::string &mesh_file,
                   const std::vector<NamedFile> &outputs);

/// How the options of PETSc objects of ours begin.
const std::vector<std::string> &solver_prefixes();

/// Collective on the communicator of `problem`. Throws bad_input if one of those was given that no
/// PETSc object asks for, or whose value it refuses. Costs nothing where none is given, and one
/// solve where the objects alone cannot tell.
void check_solver_options(Problem &problem, const HfOptions &options);

/// What a command solves with objects of SLEPc that take options.
enum class EigenUse {
  none,
  supremizers, ///< offline: the projected greedy, prefix pga_, and its tolerance, prefix infsup_
  constants,   ///< verify: inf-sup constants, prefix infsup_
  no_constants ///< verify -verify_stability no
};

/// Throws bad_input if one of their options was given that nothing of the run asks for, or whose
/// value SLEPc refuses. Those of another command may stand in a case file, not on the command line.
void check_eigen_options(const OfflineOptions &options, EigenUse use);
/// At the end of a run: a warning for each of the command line that nothing has asked for on the
/// way that the run took. Collective.
void warn_of_eigen_options(MPI_Comm comm, const OfflineOptions &options);

/// Prints the usage, the options above and those of the scenes; or, where one is named, options,
/// parameters and mesh of that scene alone; or, of a command, its usage and its options alone.
/// Throws bad_input for an unknown scene.
void print_help(const Registry &registry, const std::string &scene,
                const std::string &command = "");

/// All commands, options of both programs, keys of case files and scenes, those of the folder cases
/// among them, as JSON.
std::string options_dump(const Registry &registry);

/// Prints the names and facts that a mesh file for the scene must have.
void print_mesh_contract(const SceneEntry &entry);

} // namespace rbvi
