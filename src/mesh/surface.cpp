#include "rbvi/mesh/surface.hpp"

#include "axis.hpp"
#include "facets.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <tuple>

namespace rbvi {

Facet sorted_facet(Facet facet) {
  std::sort(facet.begin(), facet.end(), std::greater<>());
  return facet;
}

std::vector<Facet> outer_facets(const SerialMesh &mesh) {
  std::vector<Facet> all, outer;
  for (const auto &cell : mesh.cells)
    for (int opposite = 0; opposite <= mesh.dim; ++opposite) {
      Facet facet{-1, -1, -1};
      std::size_t count = 0;
      for (int i = 0; i <= mesh.dim; ++i)
        if (i != opposite) facet[count++] = cell[i];
      all.push_back(sorted_facet(facet));
    }
  std::sort(all.begin(), all.end());
  for (std::size_t i = 0; i < all.size(); ++i)
    if ((i == 0 || all[i - 1] != all[i]) && (i + 1 == all.size() || all[i + 1] != all[i]))
      outer.push_back(all[i]);
  return outer;
}

std::vector<Facet> facets_of(const SerialMesh &mesh, const std::string &boundary) {
  std::vector<Facet> facets;
  for (const auto &facet : mesh.boundary.at(boundary))
    facets.push_back(sorted_facet(facet));
  std::sort(facets.begin(), facets.end());
  facets.erase(std::unique(facets.begin(), facets.end()), facets.end());
  return facets;
}

namespace {

/// Boundaries that the scene says something of.
std::set<std::string> named_boundaries(const Scene &scene) {
  std::set<std::string> names;
  for (const FixedBoundary &fixed : scene.fixed)
    names.insert(fixed.name);
  for (const Sum *sum : {&scene.a, &scene.f})
    for (const Term &term : *sum) {
      names.insert(term.form.boundary);
      for (const Mean &mean : term.form.means)
        names.insert(mean.boundary);
    }
  for (const ContactRecipe &contact : scene.contacts)
    if (contact.entities.kind != InterfaceEntities::Kind::cells)
      names.insert(contact.entities.parts.begin(), contact.entities.parts.end());
  names.erase("");
  return names;
}

/// The box about some facets.
std::string box_about(const SerialMesh &mesh, const std::vector<Facet> &facets) {
  std::vector<std::string> sides;
  for (std::size_t c = 0; c < static_cast<std::size_t>(mesh.dim); ++c) {
    Range side{mesh.points[facets[0][0]][c], mesh.points[facets[0][0]][c]};
    for (const Facet &facet : facets)
      for (int i = 0; i < mesh.dim; ++i) {
        side.lower = std::min(side.lower, mesh.points[facet[i]][c]);
        side.upper = std::max(side.upper, mesh.points[facet[i]][c]);
      }
    sides.push_back(std::string("[")
                        .append(short_number(side.lower))
                        .append(", ")
                        .append(short_number(side.upper))
                        .append("]"));
  }
  return joined(sides, " x ");
}

} // namespace

SerialMesh mesh_with_groups(const Scene &scene, const std::string &file) {
  Scene whole = scene;
  if (!file.empty())
    std::tie(whole.mesh.regions, whole.mesh.boundaries) = parts_of_gmsh(file, scene.dim);
  std::vector<SerialMesh> levels;
  return undistributed_mesh(whole, {file}, levels);
}

MeshSurface surface_of(const SerialMesh &mesh, const Scene &scene) {
  MeshSurface surface{outer_facets(mesh), {}, {}};
  const auto at_axis = [&, extent = extent_of(mesh)](int vertex) {
    return on_axis(mesh.points[vertex][0], extent);
  };
  for (const Facet &facet : surface.facets) // the axis is inside of the body in space
    surface.free.push_back(!scene.axisymmetric || !at_axis(facet[0]) || !at_axis(facet[1]));
  const std::set<std::string> named = named_boundaries(scene);
  for (const auto &[name, ignored] : mesh.boundary) {
    std::vector<bool> &in = surface.groups[name];
    const std::vector<Facet> own = facets_of(mesh, name);
    for (std::size_t i = 0; i < surface.facets.size(); ++i) {
      in.push_back(std::ranges::binary_search(own, surface.facets[i]));
      if (in.back() && named.contains(name)) surface.free[i] = false;
    }
  }
  return surface;
}

std::vector<std::string> free_parts(const SerialMesh &mesh, const MeshSurface &surface) {
  std::vector<std::string> parts;
  std::vector<bool> grouped(surface.facets.size(), false);
  for (const auto &[name, in] : surface.groups) {
    long free = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
      free += in[i] && surface.free[i] ? 1 : 0;
      grouped[i] = grouped[i] || in[i];
    }
    const long all = std::ranges::count(in, true);
    if (free > 0)
      parts.push_back(free == all ? name
                                  : name + " (" + std::to_string(free) + " of " +
                                        counted(all, "facet") + ")");
  }
  std::vector<Facet> rest;
  for (std::size_t i = 0; i < grouped.size(); ++i)
    if (!grouped[i]) rest.push_back(surface.facets[i]);
  if (!rest.empty())
    parts.push_back(counted(std::ssize(rest), "facet") + " in no group, in " +
                    box_about(mesh, rest));
  return parts;
}

} // namespace rbvi
