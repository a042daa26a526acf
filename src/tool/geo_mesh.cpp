#include "geo_mesh.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/io/checksum.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/par/collective.hpp"

#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>
#include <unistd.h>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

const std::string told = "rbvi: "; ///< before what the probe prints

std::string bytes_of(const fs::path &file) {
  std::ostringstream bytes;
  bytes << std::ifstream(file, std::ios::binary).rdbuf();
  return bytes.str();
}

/// What gmsh says of a mistake.
std::string last_error(const std::string &log) {
  std::istringstream in(log);
  std::string error;
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("Error")) error = line;
  return error.empty() ? "it made no mesh" : trimmed(error.substr(error.find(':') + 1));
}

/// A file beside the mesh that is gone with this.
struct Scratch {
  fs::path file;
  explicit Scratch(const fs::path &name) : file(temporary_name(name, 0)) {}
  ~Scratch() {
    std::error_code ignored;
    fs::remove(file, ignored);
  }
  Scratch(const Scratch &) = delete;
  Scratch &operator=(const Scratch &) = delete;
};

/// One geometry with the numbers that are set in it.
class Geometry {
public:
  Geometry(std::string file, int dim, const std::map<std::string, double> &numbers,
           const fs::path &folder)
      : file_(std::move(file)), dim_(dim), numbers_(numbers), probe_(folder / "probe"),
        log_(folder / "log") {
    std::string lines =
        "General.Terminal = 1;\nGeneral.Verbosity = 5;\n"; // the geometry may say less
    for (const auto &[name, value] : numbers_) {
      check_name(name);
      options_ += " -setnumber " + in_shell_quotes(name) + " " + shortest_number(value);
      const std::string print = "Printf(\"" + told + name + " %.17g\", " + name + ");\n";
      lines += is_option(name) ? print : "If (Exists(" + name + "))\n" + print + "EndIf\n";
    }
    write_atomically(probe_.file, lines);
  }
  /// What is set, as options of gmsh.
  const std::string &options() const { return options_; }
  /// Returns what gmsh prints. Throws bad_input, with what it says, where it makes no mesh.
  std::string mesh(const fs::path &mesh) const {
    const auto [status, log] = run("-" + std::to_string(dim_) + " -order 1 -format msh41" +
                                   options_ + " -o " + in_shell_quotes(mesh.string()));
    std::error_code ignored;
    if (status != 0 || !fs::exists(mesh, ignored))
      throw bad_input("gmsh cannot mesh '" + file_ + "': " + last_error(log));
    return log;
  }
  /// Throws bad_input for a number that is set and does not become one of the geometry: it has
  /// none of that name, or the same one without. `log`: of mesh().
  void check_taken(const std::string &log) const {
    if (numbers_.empty()) return;
    const std::string without = run("-parse_and_exit").second;
    for (const auto &[name, value] : numbers_) {
      const double own = printed(without, name), now = printed(log, name);
      const bool asked = without.find("Unknown variable '" + name + "'") != std::string::npos;
      const std::string define =
          is_option(name) ? "take that out" : "write DefineConstant[" + name + " = ...]; there";
      if (std::isnan(own) && !asked)
        throw bad_input("mesh: set gives " + name + ", a number that '" + file_ +
                        "' does not have: correct the name, or " + define);
      if (now != value && now == own)
        throw bad_input("mesh: set gives " + name + " = " + shortest_number(value) + ", but '" +
                        file_ + "' makes it " + shortest_number(own) + " by itself: " + define);
    }
  }

private:
  /// Of gmsh.
  static bool is_option(const std::string &name) { return name.find('.') != std::string::npos; }
  static void check_name(const std::string &name) {
    static const std::regex wanted("[A-Za-z_][A-Za-z0-9_.]*");
    if (!std::regex_match(name, wanted))
      throw bad_input("mesh: set gives '" + name +
                      "', which is no name of a number in a geometry: letters, digits and _, or "
                      "an option of gmsh such as Mesh.MeshSizeMax");
  }
  /// The status of gmsh and what it prints.
  std::pair<int, std::string> run(const std::string &how) const {
    const int status = std::system(("gmsh " + how + " " + in_shell_quotes(file_) + " " +
                                    in_shell_quotes(probe_.file.string()) + " > " +
                                    in_shell_quotes(log_.file.string()) + " 2>&1 < /dev/null")
                                       .c_str());
    return {status, bytes_of(log_.file)};
  }
  /// What the probe prints of a number; NaN: there is none.
  static double printed(const std::string &log, const std::string &name) {
    const std::string before = told + name + " ";
    const std::size_t at = log.rfind(before);
    return at == std::string::npos ? std::nan("") : std::strtod(&log[at + before.size()], nullptr);
  }

  std::string file_, options_;
  int dim_;
  const std::map<std::string, double> &numbers_;
  Scratch probe_, log_;
};

fs::path mesh_named(const fs::path &folder, std::uint64_t hash) {
  char name[32];
  std::snprintf(name, sizeof name, "%016" PRIx64 ".msh", hash);
  return folder / name;
}

/// The hash that names the mesh in the folder.
std::uint64_t make_mesh(const std::string &geo, int dim,
                        const std::map<std::string, double> &numbers, const fs::path &folder) {
  if (!fs::exists(geo)) throw bad_input("the geometry " + geo + " cannot be read");
  if (std::system("command -v gmsh > /dev/null 2>&1") != 0)
    throw bad_input("'" + geo +
                    "' is a geometry, and there is no program gmsh to mesh it: install "
                    "Debian's package gmsh, or give a mesh (.msh)");
  make_directory(folder);
  remove_stale_temporaries(folder);
  const Geometry geometry(geo, dim, numbers, folder);
  const Scratch part(folder / "part");
  const std::string log = geometry.mesh(part.file),
                    content = bytes_of(part.file) + geometry.options();
  const std::uint64_t hash = fnv1a(content.data(), content.size());
  if (fs::exists(mesh_named(folder, hash))) return hash;
  geometry.check_taken(log);
  fs::rename(part.file, mesh_named(folder, hash));
  return hash;
}

} // namespace

std::string in_shell_quotes(const std::string &text) {
  std::string word = "'";
  for (const char c : text)
    word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

fs::path folder_of_meshes() {
  return fs::temp_directory_path() / ("rbvi_meshes_" + std::to_string(::getuid()));
}

std::string meshed(MPI_Comm comm, const std::string &geo, int dim,
                   const std::map<std::string, double> &numbers, const fs::path &folder) {
  std::uint64_t hash = 0;
  collectively(comm, [&] {
    if (rank_of(comm) == 0) hash = make_mesh(geo, dim, numbers, folder);
  });
  MPI_Bcast(&hash, 1, MPI_UINT64_T, 0, comm);
  return fs::absolute(mesh_named(folder, hash)).lexically_normal().string();
}

} // namespace rbvi
