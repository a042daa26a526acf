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
  const Scene scene = make_scene(entry);
  const std::string own = contract(scene);
  std::printf("  %s (Gmsh 2.2, 4.0 or 4.1, order 1) has these parts as physical groups.\n%s%s",
              scene.mesh.generator.empty() ? "The mesh of the case, mesh: file or -mesh FILE"
                                           : "A mesh of your own, -mesh FILE",
              scene.mesh.facts.empty()
                  ? ""
                  : "  Its vertices are where it says below, to a millionth of its size, and its\n"
                    "  edges run along the rims of regions:\n",
              own.c_str());
  for (const auto &[choice, other_scene] : variants(entry))
    if (const std::string other = contract(other_scene); other != own)
      std::printf("  With %s:\n%s", choice.c_str(), other.c_str());
}

} // namespace rbvi
