// What -help says of a mesh is what make_mesh asks for.
#include "rbvi/core/error.hpp"
#include "rbvi/tool/finish.hpp"
#include "rbvi/tool/options.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

namespace rbvi::mesh_help_test {
namespace {

std::string printed(const std::string &scene) {
  testing::internal::CaptureStdout();
  print_help(catalogue(), scene);
  std::fflush(stdout);
  return testing::internal::GetCapturedStdout();
}

void expect_contract(const std::string &text, const MeshRecipe &recipe) {
  for (const MeshFact &fact : recipe.facts) {
    EXPECT_NE(text.find(" " + fact.is + "\n"), std::string::npos) << fact.is << "\n" << text;
    EXPECT_NE(text.find(" " + (fact.part.empty() ? "(all)" : fact.part) + " "), std::string::npos);
  }
}

TEST(MeshHelp, OneSceneIsItsOptionsParametersAndMesh) {
  for (const SceneEntry &entry : catalogue()) {
    const std::string text = printed(entry.name), all = printed("");
    const Scene scene = make_scene(entry.name);
    expect_contract(text, scene.mesh);
    for (const SceneOption &option : entry.options)
      EXPECT_NE(text.find("  -" + option.name + " "), std::string::npos) << option.name;
    for (const Parameter &parameter : scene.parameters.all)
      EXPECT_NE(text.find("  -" + parameter.name + " "), std::string::npos) << parameter.name;
    EXPECT_EQ(text.find("-pod_tolerance"), std::string::npos);
    EXPECT_NE(all.find(text), std::string::npos);
  }
}

TEST(MeshHelp, AnOptionThatChangesTheMeshHasItsOwnContract) {
  const std::string text = printed("patch");
  EXPECT_NE(text.find("With -bodies one:\n"), std::string::npos) << text;
  expect_contract(text, make_scene("patch", {{"bodies", "one"}}).mesh);
  EXPECT_NE(printed("rigid_disk").find("With -kinematics large:\n"), std::string::npos);
  EXPECT_EQ(printed("membrane_obstacle").find("With "), std::string::npos);
}

TEST(MeshHelp, AnUnknownSceneIsBadInput) {
  EXPECT_THROW(print_help(catalogue(), "moebius"), Error);
}

TEST(MeshHelp, TheCommandLineNamesTheScene) {
  const auto scene_in = [](std::vector<std::string> words) {
    std::vector<char *> arguments;
    for (std::string &word : words)
      arguments.push_back(word.data());
    const Invocation read = read_invocation(static_cast<int>(arguments.size()), arguments.data());
    EXPECT_EQ(read.command, "help");
    EXPECT_EQ(read.arguments.size(), 1u);
    return read.file;
  };
  EXPECT_EQ(scene_in({"rbvi", "-help", "-scene", "patch"}), "patch");
  EXPECT_EQ(scene_in({"rbvi", "--scene", "patch", "--help"}), "patch");
  EXPECT_EQ(scene_in({"rbvi", "-help", "-scene"}), "");
  EXPECT_EQ(scene_in({"rbvi", "-help"}), "");
}

} // namespace
} // namespace rbvi::mesh_help_test
