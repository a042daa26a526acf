// Files that a command reads must not be those that it writes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rbvi {

/// A file and what it is to the user: {"the file of queries", "mu.csv"}.
struct NamedFile {
  std::string what;
  std::filesystem::path path;
};

/// Throws bad_input if `output` ("--out", "answers.csv") is one of `inputs`, however the two are
/// spelt: through links, "./", "..". Empty paths are none.
void check_overwriting(const NamedFile &output, const std::vector<NamedFile> &inputs);

} // namespace rbvi
