// The options of a run in PETSc's options database, and their values. They throw bad_input.
#pragma once

#include "rbvi/par/petsc.hpp"
#include "rbvi/tool/options.hpp"

namespace rbvi {

/// The options (without dash) that nothing has asked for yet and that are not of PETSc itself, and
/// their values ("": none). To be called before anything asks for an option. `database` null: the
/// run's.
std::map<std::string, std::string> unread_values(PetscOptions database = nullptr);

/// An option that the run has from outside: from one of PETSc's files (.petscrc) or variables.
struct Foreign {
  std::string name, value;
  std::string from; ///< "/home/me/.petscrc", "PETSC_OPTIONS"
};

/// Those that PETSc has not taken for itself, with the last place that each stands in. To be called
/// before anything asks for an option. Collective.
std::vector<Foreign> foreign_options(MPI_Comm comm);

/// The options that begin with one of the prefixes and that nothing has asked for.
std::vector<std::string> unread_names(const std::vector<std::string> &prefixes);

/// Objects of ours that take PETSc's or SLEPc's options.
struct SolverPrefix {
  std::string prefix;
  std::vector<std::string> kinds; ///< of objects, as their options begin: "ksp_"
  std::string of;                 ///< what they solve
};
const std::vector<SolverPrefix> &solver_objects();

/// How their options begin, of those of these kinds.
std::vector<std::string> prefixes_of(const std::vector<std::string> &kinds);

/// How the options of SLEPc's objects begin.
const std::vector<std::string> &eigen_prefixes();

bool contains(const std::vector<std::string> &list, const std::string &name);
bool starts_with_any(const std::string &name, const std::vector<std::string> &prefixes);

bool is_given(const std::string &name);
/// Its value; "" where it has none or is not given.
std::string text_of(const std::string &name);

/// Forgets that an option was asked for.
void mark_unread(const std::string &name);

/// Where an option stands: " (line 2 of case.yaml)", " (PETSC_OPTIONS)"; none on the command line.
using Origin = std::map<std::string, std::string>;

/// Refuses names that are neither ours, of the scene nor of a solver of PETSc's, and options of
/// ours without a value that need one.
void check_names(const std::vector<std::string> &names, const Origin &origin, const Scene &scene,
                 const Registry &registry);

/// "needs -bodies one", what an option or parameter of that name is missing in this scene; "" where
/// nothing knows it.
std::string what_needs(const std::string &name, const Scene &scene, const Registry &registry);

/// Refuses options on the command line that are of another command.
void check_command(const std::string &command, const std::vector<std::string> &command_line);

} // namespace rbvi
