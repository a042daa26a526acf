#include "database.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace rbvi {

namespace {

/// Options of PETSc itself that it reads only at its end.
const std::vector<std::string> late_options{"options_left", "options_view", "malloc_dump",
                                            "malloc_view",  "objects_dump", "citations"};

const std::string &default_of(const std::string &name) {
  const auto &options = tool_options();
  return std::find_if(options.begin(), options.end(),
                      [&](const OptionHelp &o) { return o.name == name; })
      ->default_value;
}

std::string shown(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

} // namespace

bool contains(const std::vector<std::string> &list, const std::string &name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

bool starts_with_any(const std::string &name, const std::vector<std::string> &prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(),
                     [&](const std::string &prefix) { return name.starts_with(prefix); });
}

std::vector<std::string> unread_names() {
  PetscInt count = 0;
  char **names = nullptr, **values = nullptr;
  RBVI_CALL(PetscOptionsLeftGet(nullptr, &count, &names, &values));
  std::vector<std::string> unread(names, names + count);
  RBVI_CALL(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
  std::erase_if(unread, [](const std::string &name) { return contains(late_options, name); });
  return unread;
}

std::vector<std::string> unread_names(const std::vector<std::string> &prefixes) {
  std::vector<std::string> unread = unread_names();
  std::erase_if(unread, [&](const std::string &name) { return !starts_with_any(name, prefixes); });
  return unread;
}

bool is_given(const std::string &name) {
  PetscBool set = PETSC_FALSE;
  RBVI_CALL(PetscOptionsHasName(nullptr, nullptr, ("-" + name).c_str(), &set));
  return set == PETSC_TRUE;
}

std::string text_of(const std::string &name, const std::string &otherwise) {
  char value[4096];
  PetscBool set = PETSC_FALSE;
  RBVI_CALL(
      PetscOptionsGetString(nullptr, nullptr, ("-" + name).c_str(), value, sizeof value, &set));
  return set == PETSC_TRUE ? value : otherwise;
}

void mark_unread(const std::string &name) {
  const std::string option = "-" + name, value = text_of(name);
  RBVI_CALL(PetscOptionsClearValue(nullptr, option.c_str()));
  RBVI_CALL(PetscOptionsSetValue(nullptr, option.c_str(), value.empty() ? nullptr : value.c_str()));
}

double number_of(const std::string &name, double lower, double upper) {
  const std::string text = text_of(name, default_of(name));
  const double value = parse_number(text, "option -" + name);
  if (value < lower || value > upper)
    throw bad_input("option -" + name + " is " + text + ": use a number from " + shown(lower) +
                    " to " + shown(upper));
  return value;
}

int integer_of(const std::string &name, int lower, int upper) {
  const double value = number_of(name, lower, upper);
  if (value != std::floor(value)) throw bad_input("option -" + name + " must be an integer");
  return static_cast<int>(value);
}

bool flag_of(const std::string &name) {
  PetscBool value = PETSC_FALSE;
  const std::string text = text_of(name, default_of(name));
  if (text.empty()) return true;
  if (PetscOptionsStringToBool(text.c_str(), &value) != 0)
    throw bad_input("option -" + name + " is '" + text + "': use yes or no");
  return value == PETSC_TRUE;
}

int choice_of(const std::string &name, const std::vector<std::string> &choices) {
  const std::string text = text_of(name, default_of(name));
  const auto found = std::find(choices.begin(), choices.end(), text);
  if (found == choices.end()) {
    std::string all;
    for (const std::string &choice : choices)
      all += (all.empty() ? "" : ", ") + choice;
    throw bad_input("option -" + name + " is '" + text + "': use one of " + all);
  }
  return static_cast<int>(found - choices.begin());
}

} // namespace rbvi
