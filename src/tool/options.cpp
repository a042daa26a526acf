#include "rbvi/tool/options.hpp"

#include "database.hpp"
#include "geo_mesh.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/fem/check_scene.hpp"
#include "rbvi/mor/reduction.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/case_file.hpp"
#include "rbvi/tool/cases.hpp"
#include "run_directory.hpp"
#include "table.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <fstream>

namespace rbvi {

namespace {

Scene given_scene(const SceneEntry &entry) {
  SceneOptions options;
  for (const SceneOption &option : entry.options)
    if (find_option(option.name) == nullptr && is_given(option.name))
      options[option.name] = text_of(option.name);
  return make_scene(entry, options);
}

enum class Given { nothing, value, bounds };

/// "-radius 0.2" fixes a parameter, "-radius 0.18,0.22" frees it between bounds.
Given adapt_parameter(Parameter &parameter, const std::optional<UnitSystem> &units) {
  const bool has_option = find_option(parameter.name) == nullptr;
  const std::string text = has_option ? text_of(parameter.name) : "";
  const std::vector<std::string> parts = split(text, ',');
  const std::string what = "option -" + parameter.name;
  const auto number = [&](const std::string &part) {
    if (!parameter.choices.empty()) return parse_value(parameter, part, what);
    return parse_given(part, units, parameter.unit, what);
  };
  if (text.empty()) return Given::nothing;
  if (parts.size() == 1) {
    parameter.value = number(parts[0]);
    check_range(parameter.valid, parameter.value, what);
    return Given::value;
  }
  if (parts.size() != 2)
    throw bad_input(what + " is '" + text + "': give one value, or two bounds");
  parameter.lower = number(parts[0]);
  parameter.upper = number(parts[1]);
  if (parameter.lower == parameter.upper)
    throw bad_input(what + " is '" + text + "': both bounds are the same; one value fixes it");
  if (!(parameter.lower < parameter.upper))
    throw bad_input(what + " is '" + text + "': the lower bound comes first");
  check_range(parameter.valid, parameter.lower, what + ", lower bound,");
  check_range(parameter.valid, parameter.upper, what + ", upper bound,");
  parameter.value = std::clamp(parameter.value, parameter.lower, parameter.upper);
  return Given::bounds;
}

/// "-parameters" says which are free; without it those with two bounds and those that the scene
/// frees, less those with one value.
void adapt_parameters(Scene &scene, const Registry &registry) {
  ParameterSpace &space = scene.parameters;
  std::string unfixed;
  std::vector<std::string> fixed;
  for (int i = 0; i < static_cast<int>(space.all.size()); ++i) {
    Parameter &parameter = space.all[i];
    const Given given = adapt_parameter(parameter, scene.units);
    const bool free = std::find(space.free.begin(), space.free.end(), i) != space.free.end();
    if (given == Given::value)
      fixed.push_back(parameter.name);
    else if (free || given == Given::bounds)
      unfixed += (unfixed.empty() ? "" : ",") + parameter.name;
  }
  const std::string named = text_of("parameters");
  for (const std::string &part : split(named, ',')) {
    const std::string name = trimmed(part);
    const std::string needed = what_needs(name, scene, registry);
    if (scene.options.contains(name))
      throw bad_input("parameter '" + name + "' is a constant of this case: free it by -" + name +
                      " LOWER,UPPER");
    if (!needed.empty() && std::ranges::find(space.all, name, &Parameter::name) == space.all.end())
      throw bad_input("parameter '" + name + "' " + needed);
  }
  space = free_only(space, named.empty() ? unfixed : named);
  for (int i = 0; i < space.size(); ++i)
    if (contains(fixed, space.at(i).name))
      throw bad_input("parameter " + space.at(i).name + " is freed by -parameters and fixed by -" +
                      space.at(i).name + " " + text_of(space.at(i).name) + ": give two bounds");
}

/// Corners of the box matter even to a single solve: where they are refused, says what it can do.
void check_box_of_run(const Scene &scene) {
  try {
    check_box(scene);
  } catch (const Error &error) {
    if (text_of("mu").empty()) throw;
    throw Error(error.status(),
                error.what() + ("; for a single solve narrow the box around -mu (-" +
                                scene.parameters.at(0).name +
                                " LOWER,UPPER) or fix parameters (-NAME VALUE)"));
  }
}

/// The options as a file, without those of one command. `of_case`: the case stands beside it.
std::string as_option_file(const std::vector<std::string> &names, bool of_case) {
  std::string text = std::string(run_case_header) + "\n";
  if (of_case) text += case_line("case", scene_of_run);
  for (const std::string &name : names) {
    if (const Option *option = find_option(name); option != nullptr && option->of_command) continue;
    text += case_line(name, value_in_run(name, text_of(name)));
    // What a solver must ask for is unread until it does: check_solver_options.
    if (starts_with_any(name, solver_prefixes())) mark_unread(name);
  }
  return text;
}

/// Every option that is given, into its place.
void read_table(const std::vector<Option> &table, RunFiles &files) {
  for (const Option &option : table) {
    if (!option.read || !is_given(option.name)) continue;
    const std::string value = text_of(option.name);
    option.read(value);
    if (option.kind == OptionKind::set && is_set_file(value)) files.set_files[option.name] = value;
  }
}

/// A run leaves its own case file, which may be the one that another run left there.
void check_case_of_run(const RunFiles &files) {
  if (files.case_name.empty() || files.out.empty()) return;
  std::string first_line;
  std::getline(std::ifstream(files.case_name) >> std::ws, first_line);
  if (first_line == run_case_header) return;
  check_overwriting({"-out " + files.out.string() + ": its", case_of_run(files.out)},
                    {{"the case file", files.case_name}});
}

} // namespace

bool is_option(const std::string &word) {
  return word.size() > 1 && word[0] == '-' &&
         std::isalpha(static_cast<unsigned char>(word[1])) != 0;
}

std::filesystem::path case_of_run(const std::filesystem::path &out) {
  return out / "case.yaml";
}

std::vector<std::string> normalised_arguments(int argc, char **argv) {
  std::vector<std::string> arguments(argv, argv + argc);
  for (std::string &argument : arguments)
    if (argument.starts_with("--") && is_option(argument.substr(1))) argument.erase(0, 1);
  return arguments;
}

namespace {

/// "-young 20 (PETSC_OPTIONS)" for each, those that a case file beats with its line, too.
std::string described(const std::vector<Foreign> &foreign, const Origin &case_file) {
  std::string text;
  for (const Foreign &option : foreign) {
    const auto beaten = case_file.find(option.name);
    text += (text.empty() ? "-" : ", -") + option.name + (option.value.empty() ? "" : " ") +
            option.value + " (" + option.from + ")" +
            (beaten == case_file.end() ? "" : ", not used for that" + beaten->second);
  }
  return text;
}

/// A geometry becomes its mesh, in the run directory or for the moment.
void mesh_geometry(MPI_Comm comm, const std::filesystem::path &out, Setup &setup) {
  if (!setup.mesh.file.ends_with(".geo")) return;
  const std::filesystem::path folder = out.empty() ? folder_of_meshes() : out / "mesh";
  const SceneEntry &entry = entry_of(*setup.registry, setup.scene.name);
  setup.mesh.file = meshed(comm, setup.mesh.file, entry.mesh_dim, entry.mesh_numbers, folder);
}

/// Everything but where it comes from. `names`: all options that are given.
ToolOptions read_values(const std::vector<std::string> &names, const GivenCase &given,
                        const std::vector<std::string> &command_line) {
  ToolOptions options;
  const std::vector<Option> table = options_of(options);
  options.registry = given.registry;
  options.command_line = command_line;
  options.scene = given_scene(entry_of(*given.registry, given.scene));
  options.scene_text = given.text;
  check_names(names, given.origin, options.scene, *given.registry);
  options.case_file = as_option_file(names, !given.text.empty());
  adapt_parameters(options.scene, *given.registry);
  check_functions(options.scene);
  check_box_of_run(options.scene);
  options.train = options.scene.training;
  options.valid = options.scene.validation;
  read_table(table, options);
  MultiplierReduction &reduction = options.reduce.multipliers.reduction;
  const ReductionWay &way = way_of(options.scene, reduction);
  reduction = way.reduction;
  check_rules(options);
  if (!is_of(use::online, options)) options.reduce.online_method = OnlineMethod::exact;
  if (way.law && !is_given("cone_type"))
    options.reduce.cone.type = ConeType::mcpg; // hybrid has functions of either sign
  return options;
}

} // namespace

ToolOptions read_options(MPI_Comm comm, const std::string &command, const Registry &registry) {
  const std::vector<Foreign> foreign = foreign_options(comm);
  std::vector<std::string> command_line;
  for (const auto &[name, value] : unread_values())
    if (std::ranges::find(foreign, name, &Foreign::name) == foreign.end())
      command_line.push_back(name);
  std::string outside = described(foreign, {});
  try {
    check_command(command, command_line);
    GivenCase given = insert_case(comm, command_line, registry);
    Origin &origin = given.origin;
    outside = described(foreign, origin);
    if (!outside.empty() && rank_of(comm) == 0)
      std::printf("Options from outside: %s\n", outside.c_str());
    for (const Foreign &option : foreign)
      origin.try_emplace(option.name, " (" + option.from + ")");
    std::vector<std::string> names = command_line;
    for (const auto &[name, where] : origin)
      names.push_back(name);
    ToolOptions options = read_values(names, given, command_line);
    if (command == "run" && options.out.empty())
      options.out = std::filesystem::path("run") / options.scene.name;
    mesh_geometry(comm, options.out, options);
    return options;
  } catch (const Error &error) {
    if (outside.empty()) throw;
    throw Error(error.status(), error.what() + ("; options from outside: " + outside));
  }
}

void check_outputs(MPI_Comm comm, const RunFiles &files, const std::string &mesh_file,
                   const std::vector<NamedFile> &outputs) {
  std::vector<NamedFile> inputs{{"the case file", files.case_name},
                                {"the file of -mesh", mesh_file}};
  for (const auto &[name, file] : files.set_files)
    inputs.push_back({"the file of -" + name, file});
  collectively(comm, [&] {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      check_overwriting(outputs[i], inputs);
      check_overwriting(outputs[i], {outputs.begin(), outputs.begin() + static_cast<long>(i)});
    }
    check_case_of_run(files);
  });
}

} // namespace rbvi
