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
#include <cctype>
#include <cmath>
#include <cstdio>
#include <set>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

/// A name or a path, plain where YAML takes it for one.
std::string in_flow(const std::string &text) {
  const bool plain = std::ranges::all_of(text, [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("_./-").find(char(c)) != std::string_view::npos;
  });
  return plain && !text.starts_with('-') && text != "null" ? text : in_quotes(text);
}

/// A boundary of a mesh that is all of its surface.
struct Side {
  std::string name;
  std::set<int> vertices, bodies;
  std::vector<std::array<Point, 2>> edges;
  double height = 0; ///< mean of its edges

  bool meets(const Side &other) const {
    return std::ranges::any_of(vertices, [&](int v) { return other.vertices.contains(v); });
  }
};

std::vector<Side> sides_of(const SerialMesh &mesh, const Scene &scene) {
  const std::vector<int> bodies = bodies_of(mesh);
  const MeshSurface surface = surface_of(mesh, scene);
  std::vector<Side> sides;
  for (const auto &[name, ignored] : mesh.boundary) {
    Side side{name, {}, {}, {}};
    for (const SerialFacet &facet : facets_with_cells(mesh, name)) {
      side.vertices.insert(facet.vertices.begin(), facet.vertices.begin() + 2);
      side.bodies.insert(bodies[facet.cell]);
      side.edges.push_back({mesh.points[facet.vertices[0]], mesh.points[facet.vertices[1]]});
      side.height += (side.edges.back()[0][1] + side.edges.back()[1][1]) / 2;
    }
    side.height /= static_cast<double>(side.edges.size());
    if (std::ranges::count(surface.groups.at(name), true) == std::ssize(side.edges))
      sides.push_back(std::move(side));
  }
  return sides;
}

double distance_to(const Point &x, const std::array<Point, 2> &edge) {
  const Point along = edge[1] - edge[0];
  const double t = std::clamp(dot(x - edge[0], along) / dot(along, along), 0.0, 1.0);
  return norm(x - (edge[0] + t * along));
}

/// Whether the middle of some edge of one lies on the other, which is of other bodies.
bool touch(const Side &one, const Side &other, double tolerance) {
  if (std::ranges::any_of(one.bodies, [&](int b) { return other.bodies.contains(b); }))
    return false;
  return std::ranges::any_of(one.edges, [&](const auto &edge) {
    const Point middle = 0.5 * (edge[0] + edge[1]);
    return std::ranges::any_of(
        other.edges, [&](const auto &of) { return distance_to(middle, of) <= tolerance; });
  });
}

/// Contact where bodies touch, else of the lowest side with a floor; each body held at the side
/// that is farthest from it, those above the lowest contact pushed down.
class CaseOfMesh {
public:
  CaseOfMesh(const SerialMesh &mesh, const Scene &scene, const std::string &file)
      : extent_(extent_of(mesh)), sides_(sides_of(mesh, scene)) {
    if (sides_.size() < 2)
      throw bad_input("the mesh " + file + " has too few named boundaries (" +
                      std::to_string(sides_.size()) + ")" +
                      ": a case needs one that is held and one that touches, as physical curves");
    find_contacts(mesh);
    for (int body = 0; body <= std::ranges::max(bodies_of(mesh)); ++body)
      hold(body);
  }
  std::string contacts, imposed;
  double depth() const { return 0.01 * extent_; }

private:
  void find_contacts(const SerialMesh &mesh) {
    for (const Side &one : sides_)
      for (const Side &other : sides_)
        if (one.height >= other.height && &one != &other && free(one) && free(other) &&
            (touch(one, other, 1e-6 * extent_) || touch(other, one, 1e-6 * extent_)))
          add_contact("contact " + std::to_string(contact_.size() / 2 + 1), in_flow(other.name),
                      {&one, &other});
    if (!contact_.empty()) return;
    const Side &lowest = *std::ranges::min_element(sides_, {}, &Side::height);
    double position = -lowest.height;
    for (const int v : lowest.vertices)
      position = std::max(position, -mesh.points[v][1]);
    add_contact("floor",
                "{plane: {normal: [0, -1], position: " + shortest_number(position + 0.0) + "}}",
                {&lowest});
  }
  bool free(const Side &side) const { return std::ranges::find(contact_, &side) == contact_.end(); }
  void add_contact(const std::string &name, const std::string &against,
                   const std::vector<const Side *> &sides) {
    contacts +=
        "  " + name + ": {at: " + in_flow(sides.front()->name) + ", against: " + against + "}\n";
    contact_.insert(contact_.end(), sides.begin(), sides.end());
  }
  void hold(int body) {
    const Side *best = nullptr;
    const auto rank = [&](const Side &side) {
      const bool meets =
          std::ranges::any_of(contact_, [&](const Side *other) { return side.meets(*other); });
      return std::pair(!meets, std::abs(side.height - contact_.back()->height));
    };
    for (const Side &side : sides_)
      if (side.bodies.contains(body) && free(side) && !held_.contains(&side) &&
          (best == nullptr || rank(side) > rank(*best)))
        best = &side;
    if (best == nullptr) return; // by contact alone
    held_.insert(best);
    imposed += "  held " + std::to_string(held_.size()) + ": {at: " + in_flow(best->name) +
               ", ux: 0, uy: " + (best->height > contact_.back()->height ? "-depth" : "0") + "}\n";
  }

  double extent_;
  std::vector<Side> sides_;
  std::vector<const Side *> contact_;
  std::set<const Side *> held_;
};

std::string list(const std::vector<std::string> &names) {
  return names.empty() ? "none" : joined(names);
}

/// A mesh or a geometry as a case in a folder.
std::string case_of(const std::string &file, const fs::path &folder) {
  Scene scene;
  scene.name = folder.filename().string();
  scene.dim = 2;
  const std::string mesh_file =
      file.ends_with(".geo") ? meshed(MPI_COMM_SELF, file, {}, folder_of_meshes()) : file;
  const auto [regions, boundaries] = parts_of_gmsh(mesh_file, 2);
  scene.contacts.emplace_back().entities.parts = boundaries; // these may lie on each other
  const CaseOfMesh made(mesh_with_groups(scene, mesh_file), scene, file);
  const fs::path beside =
      fs::absolute(file).lexically_normal().lexically_relative(fs::absolute(folder));
  return new_case(in_flow(beside.string()),
                  "Regions of the mesh: " + list(regions) + "; boundaries: " + list(boundaries) +
                      ".",
                  made.imposed, made.contacts, made.depth());
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
