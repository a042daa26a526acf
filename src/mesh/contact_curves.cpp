#include "rbvi/mesh/contact_curves.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rbvi {

namespace {

/// An edge from left to right, vertices of the mesh.
struct Edge {
  int left, right;
};

std::string place(const Point &x) {
  return std::string("(").append(short_number(x[0])) + ", " + short_number(x[1]) + ")";
}

/// `what`: "the contact boundary 'arc' of the built-in mesh".
void check_curve(const SerialMesh &mesh, const std::string &name, const std::string &what) {
  const auto at = [&](int vertex) -> const Point & { return mesh.points[vertex]; };
  std::vector<Edge> edges;
  for (const auto &facet : mesh.boundary.at(name)) {
    const auto [left, right] =
        std::ranges::minmax({facet[0], facet[1]}, {}, [&](int vertex) { return at(vertex)[0]; });
    edges.push_back({left, right});
    if (at(facet[0])[0] == at(facet[1])[0])
      throw bad_input(what + " is no graph over x: its edge from " + place(at(facet[0])) + " to " +
                      place(at(facet[1])) +
                      " is upright; contact is along curves with one y for each x");
  }
  std::ranges::sort(edges, {}, [&](const Edge &edge) { return at(edge.left)[0]; });
  for (std::size_t e = 1; e < edges.size(); ++e) {
    const int end = edges[e - 1].right, begin = edges[e].left;
    if (begin == end || (edges[e - 1].left == begin && edges[e].right == end)) continue;
    if (at(begin)[0] < at(end)[0])
      throw bad_input(what + " is no graph over x: two of its edges lie above each other near " +
                      place(at(begin)) + "; contact is along curves with one y for each x");
    throw bad_input(what + " is in several pieces: nothing of it is between " + place(at(end)) +
                    " and " + place(at(begin)) +
                    "; give each piece a boundary and a contact of its own");
  }
}

/// The angle of a cell at its vertex number i.
double angle_at(const SerialMesh &mesh, const std::array<int, 4> &cell, std::size_t i) {
  const Point &at = mesh.points[cell[i]];
  const Point a = mesh.points[cell[(i + 1) % 3]] - at, b = mesh.points[cell[(i + 2) % 3]] - at;
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

} // namespace

std::vector<std::string> contact_curves(const Scene &scene) {
  std::vector<std::string> names;
  for (const ContactRecipe &contact : scene.contacts)
    if (contact.entities.kind != InterfaceEntities::Kind::cells && scene.dim == 2)
      names.insert(names.end(), contact.entities.parts.begin(), contact.entities.parts.end());
  return names;
}

void check_contact_curves(const SerialMesh &mesh, const Scene &scene, const std::string &source) {
  for (const std::string &name : contact_curves(scene))
    check_curve(mesh, name, "the contact boundary '" + name + "' of " + source);
}

std::array<bool, 2> closed_ends(const SerialMesh &mesh, const std::string &boundary) {
  // Between the turn of a circle of 12 edges, 30 degrees, and that of a chamfer, 45.
  constexpr double least_turn = 36 * std::numbers::pi / 180;
  std::vector<int> vertices;
  for (const auto &facet : mesh.boundary.at(boundary))
    vertices.insert(vertices.end(), {facet[0], facet[1]});
  const auto [first, last] =
      std::ranges::minmax(vertices, {}, [&](int vertex) { return mesh.points[vertex][0]; });
  std::array<double, 2> angle{};
  for (const auto &cell : mesh.cells)
    for (std::size_t i = 0; i < 3; ++i) {
      if (cell[i] == first) angle[0] += angle_at(mesh, cell, i);
      if (cell[i] == last) angle[1] += angle_at(mesh, cell, i);
    }
  constexpr double widest = std::numbers::pi - least_turn;
  return {angle[0] < widest, angle[1] < widest};
}

} // namespace rbvi
