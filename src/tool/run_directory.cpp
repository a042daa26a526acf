#include "run_directory.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/case_file.hpp"
#include "table.hpp"

#include <fstream>
#include <sstream>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

bool is_of(OptionKind kind, const std::string &name) {
  const Option *option = find_option(name);
  return option != nullptr && option->kind == kind;
}

fs::path copy_of(const std::string &name) {
  return fs::path("sets") / (name + ".csv");
}

/// The file of that name in the nearest folder around another one: a project that was renamed since
/// it was named. Where there is none, the path as it is.
std::string in_a_folder_around(const fs::path &other, const fs::path &file) {
  std::error_code ignored;
  fs::path folder = fs::absolute(other).lexically_normal().parent_path();
  for (; folder.has_relative_path(); folder = folder.parent_path())
    if (fs::is_regular_file(folder / file.filename(), ignored))
      return (folder / file.filename()).string();
  return file.string();
}

/// Throws bad_input.
std::string read_set_file(const std::string &name, const std::string &file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream bytes;
  if (!(bytes << in.rdbuf()))
    throw bad_input("cannot read '" + file + "', the set of option -" + name +
                    " (grid:5,5, random:200:1, corners or a CSV file)");
  return bytes.str();
}

} // namespace

std::string beside_case(const std::string &name, const std::string &value,
                        const fs::path &case_file) {
  const bool is_file = name == "case" || is_of(OptionKind::file, name) ||
                       (is_of(OptionKind::set, name) && is_set_file(value));
  std::error_code ignored;
  if (!is_file || value.empty()) return value;
  if (fs::path(value).is_absolute())
    return fs::exists(value, ignored) ? value : in_a_folder_around(case_file, value);
  const fs::path beside = (case_file.parent_path() / value).lexically_normal();
  return fs::is_regular_file(beside, ignored) ? beside.string() : value;
}

std::string value_in_run(const std::string &name, const std::string &value) {
  if (is_of(OptionKind::set, name) && is_set_file(value)) return copy_of(name).string();
  if (is_of(OptionKind::file, name) && !value.empty())
    return fs::absolute(value).lexically_normal().string();
  return value;
}

void begin_run(MPI_Comm world, const RunFiles &files) {
  collectively(world, [&] {
    if (rank_of(world) != 0) return;
    std::map<std::string, std::string> sets; // all are read before anything is written
    for (const auto &[name, file] : files.set_files)
      sets[name] = read_set_file(name, file);
    make_directory(files.out);
    sweep_up(files.out);
    for (const auto &[name, bytes] : sets) {
      make_directory((files.out / copy_of(name)).parent_path());
      write_atomically(files.out / copy_of(name), bytes);
    }
    if (!files.scene_text.empty()) write_atomically(files.out / scene_of_run, files.scene_text);
    write_atomically(case_of_run(files.out), files.case_file);
  });
}

void sweep_up(const fs::path &out) {
  for (const char *folder : {"", "samples", "sets", "verify", "bench"})
    remove_stale_temporaries(out / folder);
}

} // namespace rbvi
