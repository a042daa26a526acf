#include "rbvi/core/error.hpp"
#include "rbvi/mesh/contact_curves.hpp"
#include "rbvi/mesh/serial.hpp"

#include <string_view>

namespace rbvi {

namespace {

struct Generator {
  std::string_view name;
  SerialMesh (*make)(const MeshRecipe &);
  bool takes_edges = false;
};

constexpr std::array generators{
    Generator{"square_with_disc",
              [](const MeshRecipe &recipe) {
                return recipe.edges == 0 ? square_with_disc() : square_with_disc(recipe.edges);
              },
              true},
    Generator{"two_quarter_discs", [](const MeshRecipe &) { return two_quarter_discs(); }},
    Generator{"two_graded_quarter_discs",
              [](const MeshRecipe &recipe) { return two_graded_quarter_discs(recipe.edges); },
              true},
    Generator{"two_blocks", [](const MeshRecipe &) { return two_blocks(); }},
    Generator{"half_disc",
              [](const MeshRecipe &recipe) {
                return recipe.edges == 0 ? half_disc() : half_disc(recipe.edges);
              },
              true},
    Generator{"wide_half_disc",
              [](const MeshRecipe &recipe) {
                return recipe.edges == 0 ? wide_half_disc() : wide_half_disc(recipe.edges);
              },
              true},
    Generator{"one_block", [](const MeshRecipe &) { return one_block(); }},
    Generator{"annulus",
              [](const MeshRecipe &recipe) {
                return recipe.edges == 0 ? annulus() : annulus(recipe.edges);
              },
              true}};

/// Throws bad_input if a built-in mesh lacks a name of the scene's recipe.
void check_labels(const SerialMesh &mesh, const Scene &scene) {
  const std::string lacks =
      "the mesh generator '" + scene.mesh.generator + "' that scene " + scene.name + " asks for ";
  for (const std::string &name : scene.mesh.regions)
    if (!mesh.region.contains(name)) throw bad_input(lacks + "makes no region '" + name + "'");
  for (const std::string &name : scene.mesh.boundaries)
    if (!mesh.boundary.contains(name)) throw bad_input(lacks + "makes no boundary '" + name + "'");
}

/// Throws bad_input if this build does not have the scene's generator, or not with its edges.
SerialMesh generated_mesh(const Scene &scene) {
  std::string names;
  for (const Generator &generator : generators) {
    names.append(names.empty() ? "" : ", ").append(generator.name);
    if (generator.name != scene.mesh.generator) continue;
    if (scene.mesh.edges != 0 && !generator.takes_edges)
      throw bad_input("scene " + scene.name + " asks for " + std::to_string(scene.mesh.edges) +
                      " contact edges: the number of the mesh generator '" + scene.mesh.generator +
                      "' is fixed");
    SerialMesh mesh = generator.make(scene.mesh);
    check_labels(mesh, scene);
    return mesh;
  }
  throw bad_input("scene " + scene.name + " asks for the mesh generator '" + scene.mesh.generator +
                  "': this build has " + names);
}

/// The given mesh refined so many times; those on the way are left in `levels`.
SerialMesh refined_mesh(SerialMesh mesh, int times, const Scene &scene, const std::string &source,
                        std::vector<SerialMesh> &levels) {
  for (int level = 1; level <= times; ++level) {
    SerialMesh finer = refined(mesh);
    levels.push_back(std::move(mesh));
    mesh = std::move(finer);
    snap_curves(mesh, scene);
    const std::string name = source + ", refined " + std::to_string(level) + " times";
    check_volumes(mesh, name);
    // Facts of a case's own mesh are those of its file: edges on an arc stay straight.
    if (!scene.mesh.generator.empty()) check_places(mesh, scene, name);
  }
  return mesh;
}

} // namespace

SerialMesh undistributed_mesh(const Scene &scene, const MeshOptions &options,
                              std::vector<SerialMesh> &levels) {
  if (options.refine < 0) throw bad_input("the number of mesh refinements is negative");
  const std::string source =
      options.file.empty() ? "the built-in mesh" : "mesh file '" + options.file + "'";
  SerialMesh mesh;
  if (options.levels) {
    mesh = options.levels->at(options.refine);
  } else {
    mesh = options.file.empty() ? generated_mesh(scene) : read_gmsh(options.file, scene);
    check_mesh(mesh, source);
    check_facts(mesh, scene, source);
    check_curves(mesh, scene, source);
    for (const std::string &name : contact_boundaries(scene))
      if (scene.dim == 2) (void)curve_pieces(mesh, name, source);
    mesh = refined_mesh(std::move(mesh), options.refine, scene, source, levels);
  }
  balance_inclusion(mesh, scene);
  check_volumes(mesh, source);
  return mesh;
}

} // namespace rbvi
