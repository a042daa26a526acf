#include "rbvi/scene/case.hpp"

#include "reader.hpp"

#include "rbvi/core/text.hpp"

#include <algorithm>
#include <filesystem>

namespace rbvi {

namespace {

const std::vector<std::string> not_alternatives{"default", "says", "sets", "range"};

bool is_number(const CaseNode &choice) {
  return choice.find("sets") != nullptr;
}

const CaseNode *at_path(const CaseNode &root, const std::string &path) {
  const CaseNode *at = &root;
  for (const std::string &name : split(path, '.')) {
    at = at->find(name);
    if (at == nullptr) return nullptr;
  }
  return at;
}

void apply(CaseNode &root, const std::string &path, const CaseNode &value, Defects &defects) {
  if (!replace(root, path, value))
    defects.add(value, "the path " + path + " leads through a value that is no table");
}

/// What an alternative changes is there, but for its last name: a section may be new.
void apply_alternative(CaseNode &root, const std::string &choice, const std::string &path,
                       const CaseNode &value, Defects &defects) {
  const std::vector<std::string> names = split(path, '.');
  const bool takes_away = value.is_value() && value.value.empty();
  if (names.size() > 2 && !takes_away && at_path(root, names[0] + "." + names[1]) == nullptr)
    defects.add(value, "'" + choice + "' is of '" + names[0] + "." + names[1] +
                           "', which this choice of options does not have: leave it out");
  else
    apply(root, path, value, defects);
}

void apply_variant(CaseNode &root, const std::string &name, Defects &defects) {
  const CaseNode *variants = root.find("variants");
  std::vector<std::string> names;
  if (variants != nullptr)
    for (const auto &[own, node] : variants->entries)
      names.push_back(own);
  const auto found = std::ranges::find(names, name);
  if (found == names.end())
    throw bad_input("there is no variant '" + name + "' of this case: it has " +
                    (names.empty() ? "none" : joined(names)));
  const CaseNode variant = *variants->find(name);
  for (const auto &[path, value] : variant.entries) {
    if (path == "says") continue;
    if (value.is_value() && value.value.empty() && at_path(root, path) == nullptr)
      defects.add(value, "there is nothing at '" + path +
                             "' to take away: give it a value (quote a text that has a comma)");
    apply(root, path, value, defects);
  }
}

SceneOption option_of(const Reader &reader, const std::string &name, const CaseNode &choice) {
  SceneOption option{
      name, "", choice.find("says") == nullptr ? "" : choice.find("says")->value, {}};
  if (is_number(choice)) {
    const std::string path = choice.find("sets")->value;
    if (const CaseNode *range = choice.find("range")) {
      const std::vector<double> bounds = numbers_in(reader, *range, 2);
      option.valid = {bounds[0], bounds[1]};
    }
    option.built_in_mesh = path.starts_with("mesh.") && path != "mesh.degree";
    return option;
  }
  for (const auto &[alternative, node] : choice.entries)
    if (std::ranges::find(not_alternatives, alternative) == not_alternatives.end())
      option.choices.push_back(alternative);
  option.default_value = choice_or(choice, "default", "", option.choices);
  if (option.default_value.empty())
    throw bad_input("the choice " + name + " needs a default, one of " + joined(option.choices));
  return option;
}

void apply_values(CaseNode &root, const CaseChanges &changes, Defects &defects) {
  for (const auto &[path, text] : changes.values) {
    CaseNode value;
    value.value = text;
    apply_alternative(root, "-set " + path + "=" + text, path, value, defects);
  }
}

/// Of a parameter without a range.
SceneOption option_of_constant(const Reader &reader, const std::string &name,
                               const CaseNode &node) {
  const CaseNode *says = node.find("says");
  SceneOption option{name, entry(node, "default").value, says == nullptr ? "" : says->value, {}};
  option.unit = unit_of(node);
  if (!option.unit.empty()) option.help += (option.help.empty() ? "in " : ", in ") + option.unit;
  if (const CaseNode *limits = node.find("limits"))
    option.valid = range_in(reader, *limits, option.unit);
  option.may_vary = true;
  return option;
}

/// "10,20": a range; one number: the default.
void apply_constant(CaseNode &root, const std::string &name, const std::string &given,
                    Defects &defects) {
  const std::string path = "parameters." + name;
  CaseNode value = *at_path(root, path);
  value.kind = CaseNode::Kind::value;
  value.entries.clear();
  const std::vector<std::string> numbers = split(given, ',');
  value.value = numbers.front();
  apply(root, path + ".default", value, defects);
  if (numbers.size() != 2) return;
  CaseNode range = value, upper = value;
  upper.value = numbers.back();
  range.kind = CaseNode::Kind::list;
  range.items = {value, upper};
  apply(root, path + ".range", range, defects);
}

/// The file with the chosen alternatives in place.
CaseNode with_choices(const CaseNode &root, const SceneOptions &options, Defects &defects) {
  CaseNode chosen = root;
  const CaseNode *choices = root.find("choices"), *parameters = root.find("parameters");
  for (const auto &[name, choice] : choices == nullptr ? CaseNode().entries : choices->entries) {
    const auto given = options.find(name);
    if (given == options.end() || given->second.empty()) continue;
    const std::string words = "-" + name + " " + given->second;
    if (is_number(choice)) {
      CaseNode value = choice;
      value.kind = CaseNode::Kind::value;
      value.value = given->second;
      value.entries.clear();
      apply_alternative(chosen, words, choice.find("sets")->value, value, defects);
    } else if (const CaseNode *alternative = choice.find(given->second)) {
      for (const auto &[path, value] : alternative->entries)
        apply_alternative(chosen, words, path, value, defects);
    }
  }
  for (const auto &[name, node] : parameters == nullptr ? CaseNode().entries : parameters->entries)
    if (const auto given = options.find(name); given != options.end() && !given->second.empty() &&
                                               given->second != entry(node, "default").value)
      apply_constant(chosen, name, given->second, defects); // alternatives may have set another
  return chosen;
}

void read_requirements(Reader &reader, Scene &scene, Defects &defects) {
  std::vector<Expression> conditions;
  std::vector<std::string> messages;
  const CaseNode &all = section(reader, "require");
  for (const auto &[name, node] : all.entries)
    defects.collect(node, [&, &value = node] {
      conditions.push_back(expression_in(reader, entry(value, "that")));
      messages.push_back(entry(value, "says").value);
    });
  if (!conditions.empty())
    defects.collect(
        all, [&] { scene.check_parameters = check_of(formula_of(reader, conditions), messages); });
}

void read_free(Reader &reader, Scene &scene, Defects &defects) {
  const CaseNode &node = section(reader, "free");
  std::vector<std::string> names;
  if (node.value.empty() && node.items.empty()) {
    for (const auto &[name, parameter] : section(reader, "parameters").entries)
      if (!is_constant(parameter)) names.push_back(name);
  } else {
    defects.collect(node, [&] { names = names_in(node); });
  }
  for (const std::string &name : names) {
    const auto found = std::ranges::find(scene.parameters.all, name, &Parameter::name);
    const CaseNode *declared = section(reader, "parameters").find(name);
    const bool varies = declared != nullptr && !is_constant(*declared);
    if (declared != nullptr && !varies)
      defects.add(node, "the free parameter " + name + " needs a range");
    else if (found == scene.parameters.all.end())
      defects.add(node, varies ? "nothing depends on the free parameter " + name +
                                     ": list the others in 'free:'"
                               : "there is no parameter '" + name + "' that could be free");
    else
      scene.parameters.free.push_back(static_cast<int>(found - scene.parameters.all.begin()));
  }
}

void read_sections(Reader &reader, Scene &scene, Defects &defects) {
  read_parameters(reader, scene, defects);
  read_mesh(reader, scene, defects);
  if (!defects.none()) return;
  read_physics(reader, scene, defects);
  read_symmetry(reader, scene, defects);
  read_motion(reader, scene, defects);
  read_springs(reader, scene, defects);
  read_contact(reader, scene, defects);
  read_outputs(reader, scene, defects);
  read_requirements(reader, scene, defects);
}

/// A list [a, b] as "a,b".
std::string setting_text(const CaseNode &node) {
  std::vector<std::string> items;
  for (const CaseNode &item : node.items)
    items.push_back(item.value);
  return items.empty() ? node.value : joined(items, ",");
}

std::optional<UnitSystem> units_of(const CaseNode &root, Defects &defects) {
  const CaseNode *units = root.find("units");
  if (units == nullptr) return std::nullopt;
  std::map<std::string, std::string> declared;
  for (const auto &[name, node] : units->entries)
    declared[name] = node.value;
  std::optional<UnitSystem> system;
  defects.collect(*units, [&] { system = unit_system(declared); });
  return system;
}

void check_version(const CaseNode &root, Defects &defects) {
  if (const CaseNode *version = root.find("rbvi"); version != nullptr && version->value != "1")
    defects.add(*version, "rbvi is '" + version->value + "': this build reads version 1");
  if (const CaseNode *physics = root.find("physics"); physics != nullptr && physics->is_value())
    defects.collect(*physics, [&] {
      (void)choice_or(root, "physics", "",
                      {"membrane", "plane_strain", "plane_stress", "axisymmetric", "solid"});
    });
}

/// Says `unit:` of parameters whose numbers have one, so that other numbers in their place are in
/// that unit, too.
void settle_units(CaseNode &root) {
  for (auto &[section_name, all] : root.entries)
    if (section_name == "parameters")
      for (auto &[name, parameter] : all.entries)
        if (const std::string unit = unit_of(parameter);
            parameter.find("unit") == nullptr && !unit.empty()) {
          CaseNode own = parameter;
          own.kind = CaseNode::Kind::value;
          own.entries.clear();
          own.value = unit;
          parameter.entries.push_back({"unit", own});
        }
}

/// The scene of a file whose changes are made. Throws its defects.
Scene scene_of(const CaseNode &root, Defects &defects) {
  Reader reader{.root = root, .units = units_of(root, defects)};
  check_version(root, defects);
  check_keys(reader, defects);
  Reader parameters{.root = root, .units = reader.units};
  Scene idle;
  read_parameters(parameters, idle, defects);
  defects.throw_all();
  Scene first;
  read_sections(reader, first, defects); // tells which parameters are used
  defects.throw_all();
  Reader again{.root = root, .units = reader.units, .used = reader.used};
  Scene scene;
  read_sections(again, scene, defects);
  check_limits(again, scene, defects);
  read_free(again, scene, defects);
  read_tests(again, scene, defects);
  defects.throw_all();
  scene.units = reader.units;
  scene.tree = text_of(root);
  scene.training = section(again, "train").value;
  scene.validation = section(again, "validate").value;
  return scene;
}

std::string name_of(const CaseNode &root, const std::string &file) {
  if (const CaseNode *name = root.find("name")) return name->value;
  const std::filesystem::path path(file);
  const std::string folder =
      std::filesystem::absolute(path).lexically_normal().parent_path().filename().string();
  return path.stem() == "case" && !folder.empty() ? folder : path.stem().string();
}

} // namespace

Scene read_scene(const CaseNode &resolved) {
  Defects defects("the stored case");
  return scene_of(resolved, defects);
}

SceneEntry read_case(CaseNode root, const std::string &file, const CaseChanges &changes) {
  Defects defects(file);
  settle_units(root);
  if (!changes.variant.empty()) apply_variant(root, changes.variant, defects);
  apply_values(root, changes, defects);
  settle_units(root);
  SceneEntry scene_entry{name_of(root, file)};
  scene_entry.version = 0;
  if (const CaseNode *says = root.find("says")) scene_entry.summary = says->value;
  const Reader reader{.root = root, .units = units_of(root, defects)};
  scene_entry.units = reader.units;
  for (const char *section_name : {"parameters", "choices"})
    for (const auto &[name, node] : section(reader, section_name).entries)
      if (std::ranges::find(changes.taken, name) != changes.taken.end())
        defects.add(node,
                    "-" + name + " is an option of the program: give '" + name + "' another name");
  for (const auto &[name, choice] : section(reader, "choices").entries)
    defects.collect(choice, [&, &own = name, &node = choice] {
      if (section(reader, "parameters").find(own) != nullptr)
        throw bad_input("there is a parameter '" + own + "' already: call the choice otherwise");
      scene_entry.options.push_back(option_of(reader, own, node));
    });
  for (const auto &[name, node] : section(reader, "parameters").entries)
    if (node.is_table() && is_constant(node))
      defects.collect(node, [&, &own = name, &value = node] {
        scene_entry.options.push_back(option_of_constant(reader, own, value));
      });
  for (const auto &[name, node] : section(reader, "options").entries)
    if (node.is_table())
      defects.add(node, "options are not nested: write '" + name + "_" +
                            (node.entries.empty() ? "..." : node.entries.front().name) +
                            ": value'");
  for (const auto &[name, node] : section(reader, "options").entries)
    scene_entry.settings.push_back({name, setting_text(node), node.line});
  if (const CaseNode *mesh_file = section(reader, "mesh").find("file"))
    scene_entry.settings.push_back({"mesh", mesh_file->value, mesh_file->line});
  scene_entry.mesh_dim = dimensions_of(reader);
  if (const CaseNode *set = section(reader, "mesh").find("set"))
    for (const auto &[name, node] : set->entries)
      defects.collect(node, [&, &own = name, &value = node] {
        scene_entry.mesh_numbers[own] = number_in(reader, value);
      });
  if (const CaseNode *all = root.find("variants"))
    for (const auto &[name, node] : all->entries)
      scene_entry.variants.emplace_back(
          name, node.find("says") == nullptr ? "" : node.find("says")->value);
  defects.throw_all();
  scene_entry.make = [root, file, changes](const SceneOptions &options) {
    Defects own(file);
    CaseNode chosen = with_choices(root, options, own);
    apply_values(chosen, changes, own); // above those of alternatives
    settle_units(chosen);
    std::erase_if(chosen.entries, [](const CaseNode::Entry &section) {
      return section.name == "choices" || section.name == "variants" || section.name == "options";
    });
    own.throw_all();
    return scene_of(chosen, own);
  };
  return scene_entry;
}

} // namespace rbvi
