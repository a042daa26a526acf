#include "kinds.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/par/petsc.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace rbvi {

namespace {

std::string shown(double value) {
  return formatted("%g", value);
}

std::vector<std::string> names_of(const std::vector<Choice> &choices) {
  std::vector<std::string> names;
  for (const Choice &choice : choices)
    names.push_back(choice.name);
  return names;
}

} // namespace

double number_of(const std::string &name, const std::string &value, const Range &range) {
  const double number = parse_number(value, "option -" + name);
  if (number < range.lower || number > range.upper)
    throw bad_input("option -" + name + " is " + value + ": use a number from " +
                    shown(range.lower) + " to " + shown(range.upper));
  return number;
}

int integer_of(const std::string &name, const std::string &value, const Range &range) {
  const double number = number_of(name, value, range);
  if (number != std::floor(number)) throw bad_input("option -" + name + " must be an integer");
  return static_cast<int>(number);
}

std::vector<int> rising_of(const std::string &name, const std::string &value, const Range &range) {
  std::vector<int> numbers;
  for (const std::string &part : split(value, ',')) {
    numbers.push_back(integer_of(name, part, range));
    if (numbers.size() > 1 && numbers.back() <= numbers[numbers.size() - 2])
      throw bad_input("option -" + name + " is '" + value + "': give rising numbers");
  }
  return numbers;
}

bool flag_of(const std::string &name, const std::string &value) {
  PetscBool flag = PETSC_TRUE;
  if (!value.empty() && PetscOptionsStringToBool(value.c_str(), &flag) != 0)
    throw bad_input("option -" + name + " is '" + value + "': use yes or no");
  return flag == PETSC_TRUE;
}

int choice_of(const std::string &name, const std::string &value, const std::vector<Choice> &all) {
  const std::vector<std::string> names = names_of(all);
  const auto found = std::find(names.begin(), names.end(), value);
  if (found == names.end())
    throw bad_input("option -" + name + " is '" + value + "': use one of " + joined(names));
  return static_cast<int>(found - names.begin());
}

std::string plain(double number) {
  std::string text = shortest_number(number);
  for (const char *padded : {"e-0", "e+0", "e+"})
    if (const std::size_t at = text.find(padded); at != std::string::npos)
      text.replace(at, std::strlen(padded), padded[1] == '-' ? "e-" : "e");
  return text;
}

std::string in_words(const Range &range) {
  if (range.upper >= 1e300) return "at least " + plain(range.lower);
  return plain(range.lower) + " to " + plain(range.upper);
}

std::vector<Choice> choices(const std::vector<std::string> &names,
                            const std::vector<std::string> &meanings) {
  std::vector<Choice> result;
  for (std::size_t i = 0; i < names.size(); ++i)
    result.push_back({names[i], meanings.at(i)});
  return result;
}

Option described(const SceneOption &option) {
  Option result{option.name, OptionKind::choice, option.help, "", option.default_value};
  for (const std::string &name : option.choices)
    result.choices.push_back({name});
  if (!option.choices.empty()) return result;
  result.kind = OptionKind::number;
  result.values = describe(option.valid);
  return result;
}

Option described(const Parameter &parameter) {
  const std::string unit = parameter.unit.empty() ? "" : " (" + parameter.unit + ")";
  const std::string how = find_option(parameter.name) == nullptr
                              ? ": bounds a,b or a fixed value"
                              : ": by -mu " + parameter.name + "=VALUE";
  return {parameter.name, OptionKind::number, "parameter" + unit + how, describe(parameter.valid),
          parameter.lower < parameter.upper
              ? short_number(parameter.lower) + "," + short_number(parameter.upper)
              : short_number(parameter.value)};
}

std::vector<std::pair<std::string, Scene>> variants(const SceneEntry &entry) {
  std::vector<std::pair<std::string, Scene>> found;
  for (const SceneOption &option : entry.options)
    for (const std::string &choice : option.choices) {
      if (choice == option.default_value) continue;
      try {
        found.emplace_back(std::string("-").append(option.name).append(" ").append(choice),
                           make_scene(entry, {{option.name, choice}}));
      } catch (const Error &) { // this choice asks for others beside it
      }
    }
  return found;
}

std::vector<std::pair<Parameter, std::string>> parameters_of(const SceneEntry &entry) {
  std::vector<std::pair<Parameter, std::string>> all;
  std::vector<std::pair<std::string, Scene>> scenes = variants(entry);
  scenes.insert(scenes.begin(), {"", make_scene(entry)});
  for (const auto &[choice, scene] : scenes)
    for (const Parameter &parameter : scene.parameters.all)
      if (std::none_of(all.begin(), all.end(),
                       [&](const auto &known) { return known.first.name == parameter.name; }))
        all.emplace_back(parameter, choice);
  return all;
}

Option never_waits(Option option) {
  option.waits = false;
  return option;
}

Option only(const Use &use, Option option) {
  option.use = &use;
  return option;
}

std::vector<Option> only(const Use &use, std::vector<Option> options) {
  for (Option &option : options)
    if (option.use == nullptr) option.use = &use;
  return options;
}

Option kept(Option option, const std::string &as) {
  option.kept_as = as.empty() ? option.name : as;
  return option;
}

Option kept(const Use &runs, Option option) {
  option.kept = &runs;
  return kept(std::move(option));
}

Option otherwise(const std::string &value, Option option) {
  option.default_value = value;
  return option;
}

void add(const char *group, std::vector<Option> options, std::vector<Option> &all) {
  for (Option &option : options) {
    option.group = group;
    all.push_back(std::move(option));
  }
}

} // namespace rbvi
