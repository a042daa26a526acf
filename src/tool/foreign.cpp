// Options that PETSc takes from files and variables of its own.
#include "database.hpp"

#include <algorithm>
#include <array>

namespace rbvi {

namespace {

using Values = std::map<std::string, std::string>;

/// Options apart from those of the run.
class Database {
public:
  Database() { RBVI_CALL(PetscOptionsCreate(&options_)); }
  ~Database() { (void)PetscOptionsDestroy(&options_); }
  Database(const Database &) = delete;
  Database &operator=(const Database &) = delete;
  PetscOptions get() const { return options_; }

private:
  PetscOptions options_ = nullptr;
};

Values on_command_line() {
  int count = 0;
  char **arguments = nullptr;
  Database found;
  RBVI_CALL(PetscGetArgs(&count, &arguments));
  RBVI_CALL(PetscOptionsInsertArgs(found.get(), count, arguments));
  return unread_values(found.get());
}

Values in_file(MPI_Comm comm, const std::string &file) {
  Database found;
  RBVI_CALL(PetscOptionsInsertFile(comm, found.get(), file.c_str(), PETSC_FALSE));
  return unread_values(found.get());
}

Values in_variable(MPI_Comm comm, const char *variable, bool yaml) {
  std::array<char, 4096> text{};
  PetscBool set = PETSC_FALSE;
  Database found;
  RBVI_CALL(PetscOptionsGetenv(comm, variable, text.data(), text.size(), &set));
  if (set == PETSC_FALSE) return {};
  if (yaml)
    RBVI_CALL(PetscOptionsInsertStringYAML(found.get(), text.data()));
  else
    RBVI_CALL(PetscOptionsInsertString(found.get(), text.data()));
  return unread_values(found.get());
}

/// In the order in which PETSc reads them: the last one wins.
std::vector<std::pair<std::string, Values>> sources(MPI_Comm comm) {
  std::array<char, 4096> home{};
  RBVI_CALL(PetscGetHomeDirectory(home.data(), home.size()));
  std::vector<std::pair<std::string, Values>> all;
  for (const std::string &file :
       {std::string(home.data()) + "/.petscrc", std::string(".petscrc"), std::string("petscrc")})
    all.emplace_back(file, in_file(comm, file));
  all.emplace_back("PETSC_OPTIONS", in_variable(comm, "PETSC_OPTIONS", false));
  all.emplace_back("PETSC_OPTIONS_YAML", in_variable(comm, "PETSC_OPTIONS_YAML", true));
  return all;
}

} // namespace

std::vector<Foreign> foreign_options(MPI_Comm comm) {
  Values unread = unread_values(nullptr);
  const Values own = on_command_line();
  std::erase_if(unread, [&](const auto &option) { return own.contains(option.first); });
  std::vector<Foreign> foreign;
  if (unread.empty()) return foreign;
  const auto all = sources(comm);
  for (const auto &[name, value] : unread) {
    const auto from = std::find_if(all.rbegin(), all.rend(), [&name = name](const auto &source) {
      return source.second.contains(name);
    });
    if (from != all.rend()) foreign.push_back({name, value, from->first});
  }
  return foreign;
}

} // namespace rbvi
