#include "tests/catalogue.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/scene/case.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>

namespace rbvi {

namespace {

SceneEntry case_of(const std::string &name, const std::string &variant = "") {
  const std::string file = RBVI_CASES "/" + name + "/case.yaml";
  std::ostringstream text;
  if (!(text << std::ifstream(file).rdbuf())) throw bad_input("cannot read " + file);
  return read_case(text.str(), file, {variant});
}

void add_choices(const SceneEntry &entry, std::vector<Scene> &scenes) {
  scenes.push_back(make_scene(entry));
  for (const SceneOption &option : entry.options)
    for (const std::string &choice : option.choices)
      try {
        scenes.push_back(make_scene(entry, {{option.name, choice}}));
      } catch (const Error &) { // this choice asks for others beside it
      }
}

} // namespace

const Registry &catalogue() {
  static const Registry all = {case_of("membrane_obstacle"), case_of("two_disks"),
                               case_of("rigid_disk"), case_of("roller"), case_of("patch")};
  return all;
}

std::vector<Scene> every_choice() {
  std::vector<Scene> scenes;
  for (const SceneEntry &entry : catalogue())
    add_choices(entry, scenes);
  return scenes;
}

std::vector<Scene> every_variant() {
  std::vector<Scene> scenes;
  for (const auto &folder : std::filesystem::directory_iterator(RBVI_CASES)) {
    if (!std::filesystem::exists(folder.path() / "case.yaml")) continue;
    const std::string name = folder.path().filename().string();
    const SceneEntry plain = case_of(name);
    add_choices(plain, scenes);
    for (const auto &[variant, says] : plain.variants)
      scenes.push_back(make_scene(case_of(name, variant)));
  }
  return scenes;
}

Scene make_scene(const std::string &name, const SceneOptions &options) {
  return make_scene(entry_of(catalogue(), name), options);
}

} // namespace rbvi
