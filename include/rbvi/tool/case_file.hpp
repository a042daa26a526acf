// Files that options and cases come from, and that a run leaves.
#pragma once

#include "rbvi/core/scene.hpp"

#include <mpi.h>

#include <filesystem>

namespace rbvi {

/// How the file of options that a run leaves begins.
inline constexpr const char *run_case_header = "# The options of this run.";
/// The case of a run, beside its options.
inline constexpr const char *scene_of_run = "scene.yaml";

/// The options in the text of a file, in its order. Throws bad_input, naming `file` and the line,
/// unless the text is UTF-8 and one flat YAML map of names of options to values or lists of values,
/// without duplicates. A list [a, b] has the value "a,b"; no value is "".
std::vector<CaseSetting> parse_options(const std::string &text, const std::string &file);

/// "name: value" and a line end, the value quoted where YAML would take it for something else.
std::string case_line(const std::string &name, const std::string &value);
/// Of YAML, whatever the text.
std::string in_quotes(const std::string &text);

/// Collective. Rank 0 alone reads the file; every rank gets its text. Throws bad_input on every
/// rank if there is no such file, it cannot be read or is no text of at most 1 MB.
std::string read_case_text(MPI_Comm comm, const std::filesystem::path &file);

} // namespace rbvi
