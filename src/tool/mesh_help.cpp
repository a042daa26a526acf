// What a scene needs of a mesh file, for -help.
#include "table.hpp"

#include <cstdio>

namespace rbvi {

namespace {

std::string what_is(const MeshRecipe &recipe, const std::string &part) {
  for (const MeshFact &fact : recipe.facts)
    if (fact.part == part) return fact.is;
  return "";
}

/// One line per part of the mesh.
std::string contract(const Scene &scene) {
  const MeshRecipe &recipe = scene.mesh;
  std::string text;
  const auto add = [&](const std::string &part, const char *kind) {
    std::array<char, 40> head{};
    std::snprintf(head.data(), head.size(), "    %-16s %-11s", part.c_str(), kind);
    text += head.data() + what_is(recipe, part == "(all)" ? "" : part) + "\n";
  };
  add("(all)", scene.dim == 2 ? "triangles" : "tetrahedra");
  for (const std::string &name : recipe.regions)
    add(name, "region");
  for (const std::string &name : recipe.boundaries)
    add(name, "boundary");
  return text;
}

} // namespace

void print_mesh_contract(const SceneEntry &entry) {
  const std::string own = contract(make_scene(entry));
  std::printf(
      "  A mesh of your own (-mesh FILE: Gmsh 2.2, 4.0 or 4.1, order 1), its parts\n"
      "  by physical name, vertices in place to 1e-6 of the extent, edges along the rims:\n%s",
      own.c_str());
  for (const auto &[choice, scene] : variants(entry))
    if (const std::string other = contract(scene); other != own)
      std::printf("  With %s:\n%s", choice.c_str(), other.c_str());
}

} // namespace rbvi
