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

} // namespace

bool constant_stiffness(const Scene &scene) {
  return is_constant(scene.a, scene.parameters);
}

std::vector<SceneOption> pair_options() {
  return {{"multiplier",
           "p0",
           "pressure: constant on pairs of edges, of degree 2 on edges (p0), or continuous (p1)",
           {"p0", "p1"}},
          {"integration",
           "intersection",
           "contact integrals: edges intersected, or Gauss points of the upper body alone",
           {"intersection", "direct"}}};
}

PairDiscretisation pair_discretisation(const SceneOptions &options) {
  return {options.at("multiplier") == "p1" ? MultiplierSpace::nodes : MultiplierSpace::macro_edges,
          options.at("integration") == "direct" ? PairQuadrature::direct
                                                : PairQuadrature::intersection};
}

std::vector<SceneOption> nitsche_options() {
  return {{"formulation",
           "mixed",
           "of contact: with multipliers, or by Nitsche's method",
           {"mixed", "nitsche"}},
          {"nitsche_gamma0",
           "11.54",
           "Nitsche's gamma is this times (lambda + 2 shear modulus) over the length of an edge",
           {},
           {0.1, 2000}}};
}

std::optional<NitscheRecipe> nitsche_recipe(const SceneOptions &options) {
  const double gamma0 = number_in(options, "nitsche_gamma0");
  if (options.at("formulation") == "mixed") return std::nullopt;
  return NitscheRecipe{gamma0};
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
  Scene scene = entry->make(resolved);
  scene.name = entry->name;
  scene.summary = entry->summary;
  scene.options = resolved;
  return scene;
}

} // namespace rbvi
