#include "geo_mesh.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/io/checksum.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/case_file.hpp"

#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

/// As one word of a shell.
std::string quoted(const std::string &text) {
  std::string word = "'";
  for (const char c : text)
    word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

/// What gmsh says of a mistake.
std::string last_error(const fs::path &log) {
  std::ifstream in(log);
  std::string error;
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("Error")) error = line;
  return error.empty() ? "it made no mesh" : trimmed(error.substr(error.find(':') + 1));
}

void run_gmsh(const std::string &geo, const std::string &numbers, const fs::path &mesh) {
  if (std::system("command -v gmsh > /dev/null 2>&1") != 0)
    throw bad_input("'" + geo +
                    "' is a geometry, and there is no program gmsh to mesh it: install "
                    "Debian's package gmsh, or give a mesh (.msh)");
  make_directory(mesh.parent_path());
  const fs::path part = mesh.string() + ".part.msh", log = mesh.string() + ".log";
  const int status =
      std::system(("gmsh -2 -order 1 -format msh41" + numbers + " -o " + quoted(part.string()) +
                   " " + quoted(geo) + " > " + quoted(log.string()) + " 2>&1 < /dev/null")
                      .c_str());
  const std::string error = last_error(log);
  std::error_code ignored;
  fs::remove(log, ignored);
  if (status != 0 || !fs::exists(part, ignored)) {
    fs::remove(part, ignored);
    throw bad_input("gmsh cannot mesh '" + geo + "': " + error);
  }
  fs::rename(part, mesh);
}

} // namespace

std::string meshed(MPI_Comm comm, const std::string &geo,
                   const std::map<std::string, double> &numbers, const fs::path &folder) {
  collectively(comm, [&] {
    if (!fs::exists(geo)) throw bad_input("the geometry " + geo + " cannot be read");
  });
  std::string options;
  for (const auto &[name, value] : numbers)
    options += " -setnumber " + quoted(name) + " " + shortest_number(value);
  const std::string key = read_case_text(comm, geo) + options;
  char name[32];
  std::snprintf(name, sizeof name, "%016llx.msh",
                static_cast<unsigned long long>(fnv1a(key.data(), key.size())));
  const fs::path mesh = fs::absolute(folder / name).lexically_normal();
  collectively(comm, [&] {
    if (rank_of(comm) == 0 && !fs::exists(mesh)) run_gmsh(geo, options, mesh);
  });
  return mesh.string();
}

} // namespace rbvi
