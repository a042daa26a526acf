#include "rbvi/io/overwrite.hpp"

#include "rbvi/core/error.hpp"

namespace rbvi {

namespace {

/// Files that are not there yet are compared by their names.
bool same_file(const std::filesystem::path &a, const std::filesystem::path &b) {
  std::error_code error;
  if (std::filesystem::equivalent(a, b, error)) return true;
  const auto first = std::filesystem::weakly_canonical(std::filesystem::absolute(a), error);
  if (error) return false;
  const auto second = std::filesystem::weakly_canonical(std::filesystem::absolute(b), error);
  return !error && first == second;
}

} // namespace

void check_overwriting(const NamedFile &output, const std::vector<NamedFile> &inputs) {
  if (output.path.empty()) return;
  for (const NamedFile &input : inputs)
    if (!input.path.empty() && same_file(output.path, input.path))
      throw bad_input(output.what + " " + output.path.string() + " would overwrite " + input.what +
                      " " + input.path.string() + ": name another file");
}

} // namespace rbvi
