// rbvi new: a case to begin with, of a block or of a mesh.
#include "geo_mesh.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/mesh/serial.hpp"
#include "rbvi/mesh/surface.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/tool/case_file.hpp"
#include "rbvi/tool/commands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <set>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

/// A boundary of a mesh that is all of its surface.
struct Side {
  std::string name; ///< in quotes
  int body = 0;
  std::set<int> vertices{};
  std::vector<std::array<Point, 2>> edges{}; ///< of a solid the first of each triangle
  double height = 0;                         ///< along the last axis, mean of its facets
};

std::vector<Side> sides_of(const SerialMesh &mesh, const Scene &scene) {
  const std::vector<int> bodies = bodies_of(mesh);
  const MeshSurface surface = surface_of(mesh, scene);
  const auto up = static_cast<std::size_t>(mesh.dim - 1);
  std::vector<Side> sides;
  for (const auto &[name, ignored] : mesh.boundary) {
    Side side{in_quotes(name)};
    for (const auto &[cell, vertices] : facets_with_cells(mesh, name)) {
      side.body = bodies[cell];
      side.vertices.insert(vertices.begin(), vertices.begin() + mesh.dim);
      side.edges.push_back({mesh.points[vertices[0]], mesh.points[vertices[1]]});
      for (int i = 0; i < mesh.dim; ++i)
        side.height += mesh.points[vertices[static_cast<std::size_t>(i)]][up];
    }
    side.height /= mesh.dim * static_cast<double>(side.edges.size());
    if (std::ranges::count(surface.groups.at(name), true) == std::ssize(side.edges))
      sides.push_back(std::move(side));
  }
  return sides;
}

/// Whether the middle of some edge of one lies on the other, which is of another body.
bool touches(const Side &one, const Side &other, double tolerance) {
  const auto is_at = [&](const Point &x, const std::array<Point, 2> &edge) {
    const Point along = edge[1] - edge[0];
    const double t = std::clamp(dot(x - edge[0], along) / dot(along, along), 0.0, 1.0);
    return norm(x - (edge[0] + t * along)) <= tolerance;
  };
  return one.body != other.body && std::ranges::any_of(one.edges, [&](const auto &edge) {
           return std::ranges::any_of(
               other.edges, [&](const auto &of) { return is_at(0.5 * (edge[0] + edge[1]), of); });
         });
}

/// Contact where bodies touch, else of the lowest side with a floor; each body held at the side
/// that is farthest from it, those above the last contact pushed down.
struct CaseOfMesh {
  std::vector<Side> sides;
  std::vector<const Side *> in_contact{}, held{};
  std::string contact = "", imposed = "";

  static bool is_in(const std::vector<const Side *> &list, const Side &side) {
    return std::ranges::find(list, &side) != list.end();
  }
  void find_contact(const SerialMesh &mesh) {
    const double tolerance = 1e-6 * extent_of(mesh);
    const bool plane = mesh.dim == 2; // two solids do not meet yet
    for (const Side &one : sides)
      for (const Side &other : sides)
        if (plane && one.height >= other.height && !is_in(in_contact, one) &&
            !is_in(in_contact, other) &&
            (touches(one, other, tolerance) || touches(other, one, tolerance))) {
          in_contact.insert(in_contact.end(), {&one, &other});
          contact += "  contact " + std::to_string(in_contact.size() / 2) + ": {at: " + one.name +
                     ", against: " + other.name + "}\n";
        }
    if (!in_contact.empty()) return;
    in_contact = {&*std::ranges::min_element(sides, {}, &Side::height)};
    double position = -in_contact[0]->height;
    for (const int v : in_contact[0]->vertices)
      position = std::max(position, -mesh.points[v][plane ? 1 : 2]);
    contact = "  floor: {at: " + in_contact[0]->name + ", against: {plane: {normal: [" +
              (plane ? "0, -1" : "0, 0, -1") + "], position: " + shortest_number(position + 0.0) +
              "}}}\n";
  }
  /// Best where it shares no vertex with contact. A body without such a side is left to contact.
  void hold(int body, const SerialMesh &mesh) {
    const double height = in_contact.back()->height;
    const auto worth = [&](const Side &side) {
      const bool apart = std::ranges::none_of(in_contact, [&](const Side *other) {
        return std::ranges::any_of(side.vertices,
                                   [&](int v) { return other->vertices.contains(v); });
      });
      return std::pair(apart, std::abs(side.height - height));
    };
    const Side *best = nullptr;
    for (const Side &side : sides)
      if (side.body == body && !is_in(in_contact, side) &&
          (best == nullptr || worth(side) > worth(*best)))
        best = &side;
    if (best == nullptr) return;
    held.push_back(best);
    imposed += "  held " + std::to_string(held.size()) + ": {at: " + best->name +
               (mesh.dim == 2 ? ", ux: 0, uy: " : ", ux: 0, uy: 0, uz: ") +
               (best->height > height ? "-depth" : "0") + "}\n";
  }
};

/// A mesh or a geometry as a case in a folder.
std::string case_of(const std::string &file, const fs::path &folder) {
  Scene scene;
  scene.name = folder.filename().string();
  const std::string mesh_file =
      file.ends_with(".geo") ? meshed(MPI_COMM_SELF, file, 3, {}, folder_of_meshes()) : file;
  scene.dim = dimension_of_gmsh(mesh_file);
  const auto [regions, boundaries] = parts_of_gmsh(mesh_file, scene.dim);
  scene.contacts.emplace_back().entities.parts = boundaries; // these may lie on each other
  const SerialMesh mesh = mesh_with_groups(scene, mesh_file);
  CaseOfMesh made{sides_of(mesh, scene)};
  if (made.sides.size() < 2)
    throw bad_input("the mesh " + file + " has too few named boundaries (" +
                    std::to_string(made.sides.size()) +
                    "): a case needs one that is held and one that touches, as physical curves, of "
                    "a solid surfaces");
  made.find_contact(mesh);
  for (int body = 0; body <= std::ranges::max(bodies_of(mesh)); ++body)
    made.hold(body, mesh);
  const fs::path beside =
      fs::absolute(file).lexically_normal().lexically_relative(fs::absolute(folder));
  return new_case(scene.dim == 2 ? "plane_strain" : "solid", in_quotes(beside.string()),
                  "Regions of the mesh: " + joined(regions) +
                      "; boundaries: " + joined(boundaries) + ".",
                  made.imposed, made.contact, 0.01 * extent_of(mesh));
}

} // namespace

void command_new(const std::string &name, const std::string &mesh) {
  const fs::path file = fs::path(name) / "case.yaml";
  if (fs::exists(file)) throw bad_input(file.string() + " is there already: give another name");
  const std::string text = mesh.empty() ? new_case() : case_of(mesh, name);
  make_directory(name);
  write_atomically(file, text);
  std::printf("wrote %s: rbvi check %s\n", file.c_str(), file.c_str());
}

} // namespace rbvi
