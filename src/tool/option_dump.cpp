// What pages are made of (cases/pages.py): options, keys of cases, scenes, as one JSON object.
#include "database.hpp"
#include "table.hpp"

#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/model/online_tool.hpp"
#include "rbvi/tool/cases.hpp"

namespace rbvi {

namespace {

/// Of a JSON object: name -> JSON.
using Members = std::vector<std::pair<std::string, std::string>>;

std::string quoted(const std::string &text) {
  std::string json = "\"";
  for (const char letter : text)
    json.append(letter == '"' || letter == '\\' ? "\\" : "").append(1, letter);
  return json + "\"";
}

std::string object(const Members &members) {
  std::vector<std::string> parts;
  for (const auto &[name, value] : members)
    parts.push_back(quoted(name) + ": " + value);
  return "{" + joined(parts) + "}";
}

/// A list of what `of` makes of each item.
template <class Items, class Of> std::string list(const Items &items, const Of &of) {
  std::vector<std::string> parts;
  for (const auto &item : items)
    parts.push_back(of(item));
  return "[" + joined(parts, ",\n") + "]";
}

std::string of_choice(const Choice &choice) {
  return object({{"name", quoted(choice.name)}, {"is", quoted(choice.is)}});
}

std::string of_option(const Option &option) {
  return object({{"group", quoted(option.group)},
                 {"name", quoted(option.name)},
                 {"default", quoted(option.default_value)},
                 {"values", quoted(option.values)},
                 {"help", quoted(option.help)},
                 {"choices", list(option.choices, of_choice)}});
}

std::string of_command(const Command &command) {
  std::vector<std::string> names;
  for (const Option &option : tool_options())
    if (command.options && serves(option, command.name)) names.push_back(option.name);
  return object({{"name", quoted(command.name)},
                 {"does", quoted(command.does)},
                 {"usage", quoted(command.usage)},
                 {"options", list(names, quoted)}});
}

std::string of_key(const CaseKey &key) {
  return object({{"table", quoted(key.table)},
                 {"name", quoted(key.name)},
                 {"value", quoted(key.value)},
                 {"says", quoted(key.says)},
                 {"needed", key.needed ? "true" : "false"}});
}

/// `with`: the choice of an option that adds it; "": it is always there.
std::string of_parameter(const Parameter &p, const std::string &with) {
  return object({{"name", quoted(p.name)},
                 {"unit", quoted(p.unit)},
                 {"box", quoted(p.lower < p.upper ? describe(Range{p.lower, p.upper}) : "")},
                 {"value", quoted(short_number(p.value))},
                 {"valid", quoted(describe(p.valid))},
                 {"with", quoted(with)}});
}

std::string of_scene(const SceneEntry &entry) {
  const Scene scene = make_scene(entry);
  return object(
      {{"name", quoted(entry.name)},
       {"summary", quoted(entry.summary)},
       {"options", list(entry.options,
                        [](const SceneOption &option) { return of_option(described(option)); })},
       {"parameters",
        list(parameters_of(entry), [](const auto &p) { return of_parameter(p.first, p.second); })},
       {"free", quoted(names_of(scene.parameters))},
       {"training", quoted(scene.training)},
       {"validation", quoted(scene.validation)}});
}

std::string of_solver(const SolverPrefix &solver) {
  return object({{"prefix", quoted(solver.prefix)},
                 {"kinds", list(solver.kinds, quoted)},
                 {"of", quoted(solver.of)}});
}

std::string of_online(const OnlineOption &option) {
  return object({{"name", quoted(option.name)},
                 {"values", quoted(option.values)},
                 {"help", quoted(option.help)}});
}

} // namespace

std::string options_dump(const Registry &registry) {
  std::vector<SceneEntry> scenes = registry;
  for (SceneEntry &entry : cases_in("cases"))
    scenes.push_back(std::move(entry));
  return object({{"commands", list(commands(), of_command)},
                 {"options", list(tool_options(), of_option)},
                 {"keys", list(case_keys(), of_key)},
                 {"scenes", list(scenes, of_scene)},
                 {"solvers", list(solver_objects(), of_solver)},
                 {"online", list(online_options(), of_online)}}) +
         "\n";
}

} // namespace rbvi
