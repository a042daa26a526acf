#include "rbvi/core/scene.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"

#include <algorithm>

namespace rbvi {

namespace {

void check_option(const SceneOption &option, const std::string &value) {
  if (option.choices.empty()) {
    check_range(option.valid, parse_number(value, "option " + option.name),
                "option " + option.name);
  } else if (std::find(option.choices.begin(), option.choices.end(), value) ==
             option.choices.end()) {
    throw bad_input("option " + option.name + " is '" + value + "': use one of " +
                    joined(option.choices));
  }
}

/// Throws bad_input in place of what the standard library throws in its code.
Scene made(const SceneEntry &entry, const SceneOptions &options) {
  try {
    return entry.make(options);
  } catch (const std::out_of_range &) {
    throw bad_input("the code of scene " + entry.name +
                    " asks for an option that the scene does not declare, or for a member of a "
                    "list that is not there");
  }
}

} // namespace

bool is_symmetric(const Scene &scene) {
  if (!scene.symmetric || scene.skewed_by < 0) return scene.symmetric;
  const ParameterSpace &space = scene.parameters;
  return std::ranges::find(space.free, scene.skewed_by) == space.free.end() &&
         space.all[static_cast<std::size_t>(scene.skewed_by)].value == 0;
}

bool constant_stiffness(const Scene &scene) {
  return is_constant(scene.a, scene.parameters);
}

double number_in(const SceneOptions &options, const std::string &name) {
  return parse_number(options.at(name), "option " + name);
}

Scene make_scene(const std::string &name, const SceneOptions &options) {
  const auto &catalogue = scene_catalogue();
  const auto entry = std::find_if(catalogue.begin(), catalogue.end(),
                                  [&](const SceneEntry &e) { return e.name == name; });
  if (entry == catalogue.end()) {
    std::vector<std::string> names;
    for (const SceneEntry &e : catalogue)
      names.push_back(e.name);
    throw bad_input("unknown scene '" + name + "': this build has " + joined(names));
  }
  SceneOptions resolved;
  for (const SceneOption &option : entry->options)
    resolved[option.name] = option.default_value;
  for (const auto &[key, value] : options) {
    const auto option = std::find_if(entry->options.begin(), entry->options.end(),
                                     [&key = key](const SceneOption &o) { return o.name == key; });
    if (option == entry->options.end())
      throw bad_input("scene " + name + " has no option '" + key + "'");
    check_option(*option, value);
    resolved[key] = value;
  }
  Scene scene = made(*entry, resolved);
  scene.name = entry->name;
  scene.summary = entry->summary;
  scene.options = resolved;
  return scene;
}

} // namespace rbvi
