// The options of a run in PETSc's options database, and their values. They throw bad_input.
#pragma once

#include "rbvi/tool/options/options.hpp"

namespace rbvi {

/// The options (without dash) that nothing has asked for yet and that are not of PETSc itself. To
/// be called before anything asks for an option.
std::vector<std::string> unread_names();

/// Those that begin with one of the prefixes and that nothing has asked for.
std::vector<std::string> unread_names(const std::vector<std::string> &prefixes);

/// How the options of SLEPc's objects begin.
const std::vector<std::string> &eigen_prefixes();

bool contains(const std::vector<std::string> &list, const std::string &name);
bool starts_with_any(const std::string &name, const std::vector<std::string> &prefixes);

bool is_given(const std::string &name);
std::string text_of(const std::string &name, const std::string &otherwise = "");

/// Forgets that an option was asked for.
void mark_unread(const std::string &name);

// Options of ours, with the default of tool_options().

/// A number in [lower, upper].
double number_of(const std::string &name, double lower, double upper);
int integer_of(const std::string &name, int lower, int upper);
/// Yes or no; without a value yes.
bool flag_of(const std::string &name);
/// Position of the value among the choices.
int choice_of(const std::string &name, const std::vector<std::string> &choices);

/// Where an option stands: " (line 2 of case.yaml)"; "" on the command line.
using Origin = std::map<std::string, std::string>;

/// Refuses names that are neither ours, of the scene nor of a solver of PETSc's, and options of
/// ours without a value that need one.
void check_names(const std::vector<std::string> &names, const Origin &origin, const Scene &scene);

} // namespace rbvi
