// Case files: YAML, one 'option: value' per line.
#pragma once

#include <mpi.h>

#include <filesystem>
#include <string>
#include <vector>

namespace rbvi {

/// How the case file that a run leaves begins.
inline constexpr const char *run_case_header = "# The options of this run.";

/// One line of a case file. A list [a, b] of scalars has the value "a,b"; no value is "".
struct CaseEntry {
  std::string name, value;
  int line = 0; ///< from 1 on
};

/// The options in the text of a case file, in its order. Throws bad_input, naming `file` and the
/// line, unless the text is UTF-8 and one flat YAML map of names of options to scalars or lists of
/// scalars, without duplicates.
std::vector<CaseEntry> parse_case_file(const std::string &text, const std::string &file);

/// "name: value" and a line end, the value quoted where YAML would take it for something else.
std::string case_line(const std::string &name, const std::string &value);

/// Collective. Rank 0 alone reads the file; every rank gets its text. Throws bad_input on every
/// rank if there is no such file, it cannot be read or is no text of at most 1 MB.
std::string read_case_text(MPI_Comm comm, const std::filesystem::path &file);

} // namespace rbvi
