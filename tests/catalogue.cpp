#include "tests/catalogue.hpp"

#include "rbvi/contact/registry.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/scene/case.hpp"

#include <fstream>
#include <sstream>

namespace rbvi {

namespace {

SceneEntry case_of(const std::string &name) {
  const std::string file = RBVI_CASES "/" + name + "/case.yaml";
  std::ostringstream text;
  if (!(text << std::ifstream(file).rdbuf())) throw bad_input("cannot read " + file);
  return read_case(text.str(), file);
}

} // namespace

const Registry &catalogue() {
  static const Registry all =
      registry_of({case_of("membrane_obstacle"), case_of("two_disks"), case_of("rigid_disk"),
                   case_of("roller"), case_of("patch")});
  return all;
}

std::vector<Scene> every_choice() {
  std::vector<Scene> scenes;
  for (const SceneEntry &entry : catalogue().scenes) {
    scenes.push_back(make_scene(entry));
    for (const SceneOption &option : entry.options)
      for (const std::string &choice : option.choices)
        try {
          scenes.push_back(make_scene(entry, {{option.name, choice}}));
        } catch (const Error &) { // this choice asks for others beside it
        }
  }
  return scenes;
}

Scene make_scene(const std::string &name, const SceneOptions &options) {
  return make_scene(entry_of(catalogue(), name), options);
}

} // namespace rbvi
