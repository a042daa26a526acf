#include "database.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// Options of PETSc itself that it reads only at its end.
const std::vector<std::string> late_options{"options_left", "options_view", "malloc_dump",
                                            "malloc_view",  "objects_dump", "citations"};

} // namespace

bool contains(const std::vector<std::string> &list, const std::string &name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

bool starts_with_any(const std::string &name, const std::vector<std::string> &prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(),
                     [&](const std::string &prefix) { return name.starts_with(prefix); });
}

std::map<std::string, std::string> unread_values(PetscOptions database) {
  PetscInt count = 0;
  char **names = nullptr, **values = nullptr;
  RBVI_CALL(PetscOptionsLeftGet(database, &count, &names, &values));
  std::map<std::string, std::string> unread;
  for (PetscInt i = 0; i < count; ++i)
    unread[names[i]] = values[i] != nullptr ? values[i] : "";
  RBVI_CALL(PetscOptionsLeftRestore(database, &count, &names, &values));
  std::erase_if(unread, [](const auto &option) { return contains(late_options, option.first); });
  return unread;
}

std::vector<std::string> unread_names(const std::vector<std::string> &prefixes) {
  std::vector<std::string> unread;
  for (const auto &[name, value] : unread_values())
    if (starts_with_any(name, prefixes)) unread.push_back(name);
  return unread;
}

bool is_given(const std::string &name) {
  PetscBool set = PETSC_FALSE;
  RBVI_CALL(PetscOptionsHasName(nullptr, nullptr, ("-" + name).c_str(), &set));
  return set == PETSC_TRUE;
}

std::string text_of(const std::string &name) {
  char value[4096];
  PetscBool set = PETSC_FALSE;
  RBVI_CALL(
      PetscOptionsGetString(nullptr, nullptr, ("-" + name).c_str(), value, sizeof value, &set));
  return set == PETSC_TRUE ? value : "";
}

void mark_unread(const std::string &name) {
  const std::string option = "-" + name, value = text_of(name);
  RBVI_CALL(PetscOptionsClearValue(nullptr, option.c_str()));
  RBVI_CALL(PetscOptionsSetValue(nullptr, option.c_str(), value.empty() ? nullptr : value.c_str()));
}

} // namespace rbvi
