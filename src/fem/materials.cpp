#include "rbvi/fem/materials.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/geometry.hpp"
#include "rbvi/fem/assembly.hpp"
#include "rbvi/par/collective.hpp"

#include <algorithm>

namespace rbvi {

namespace {

std::string name_of(const BodyMaterial &material) {
  return "that of " + joined(material.regions);
}

Error no_material(const Scene &scene, const Mesh &mesh, std::size_t cell,
                  const std::vector<int> &found) {
  const Point at = reference_centre(cell_of(mesh, cell));
  const std::string where = "the cell at (" + short_number(at[0]) + ", " + short_number(at[1]) +
                            (mesh.dim == 3 ? ", " + short_number(at[2]) : "") + ")";
  if (found.empty()) return bad_input(where + " is without a material: name its region in one");
  return bad_input(where + " has two materials, " + name_of(scene.materials[found[0]]) + " and " +
                   name_of(scene.materials[found[1]]) + ": their regions overlap");
}

bool is_of(const BodyMaterial &material, const Mesh &mesh, std::size_t cell) {
  return material.regions.empty() ||
         std::ranges::any_of(material.regions, [&](const std::string &region) {
           return mesh.region.at(region)[cell];
         });
}

} // namespace

std::vector<int> materials_of_cells(const Scene &scene, const Mesh &mesh) {
  std::vector<int> result;
  const bool one = scene.materials.size() == 1 && scene.materials.front().regions.empty();
  if (scene.materials.empty() || one) return result;
  collectively(mesh.comm, [&] {
    for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
      std::vector<int> found;
      for (int m = 0; m < std::ssize(scene.materials); ++m)
        if (is_of(scene.materials[m], mesh, k)) found.push_back(m);
      if (found.size() != 1) throw no_material(scene, mesh, k, found);
      result.push_back(found.front());
    }
  });
  if (scene.materials.size() == 1) result.clear();
  return result;
}

std::vector<int> materials_of_entities(const Scene &scene, const Mesh &mesh,
                                       const std::vector<int> &of_cells,
                                       const InterfaceMesh &interface,
                                       const std::vector<PetscInt> &natural) {
  if (scene.materials.size() < 2) return {};
  const bool whole_cells = interface.vertices() == mesh.dim + 1;
  using Vertices = std::vector<PetscInt>;
  std::map<Vertices, std::size_t> entities; // by increasing natural numbers
  for (Index e = 0; e < interface.count(); ++e) {
    Vertices own;
    for (int i = 0; i < interface.vertices(); ++i)
      own.push_back(natural[interface.nodes_of(e)[i]]);
    std::ranges::sort(own);
    entities[own] = static_cast<std::size_t>(e);
  }
  std::vector<int> result(interface.count(), -1);
  for (std::size_t k = 0; k < mesh.cells.size(); ++k)
    for (int opposite = whole_cells ? mesh.dim : 0; opposite <= mesh.dim; ++opposite) {
      Vertices own;
      for (int i = 0; i <= mesh.dim; ++i)
        if (whole_cells || i != opposite) own.push_back(mesh.natural_node[mesh.cells[k][i]]);
      std::ranges::sort(own);
      if (const auto at = entities.find(own); at != entities.end())
        result[at->second] = of_cells[k];
    }
  over_ranks(mesh.comm, MPI_MAX, result);
  return result;
}

} // namespace rbvi
