// The options of a run in PETSc's options database, and their values. They throw bad_input.
#pragma once

#include "rbvi/tool/options/options.hpp"

namespace rbvi {

/// The options (without dash) that nothing has asked for yet and that are not of PETSc itself. To
/// be called before anything asks for an option.
std::vector<std::string> unread_names();

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

/// Where an option stands: " (line 2 of case.yaml)"; "" on the command line.
using Origin = std::map<std::string, std::string>;

/// Refuses names that are neither ours, of the scene nor of a solver of PETSc's, and options of
/// ours without a value that need one.
void check_names(const std::vector<std::string> &names, const Origin &origin, const Scene &scene);

} // namespace rbvi
