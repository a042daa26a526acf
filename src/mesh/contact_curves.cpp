#include "rbvi/mesh/contact_curves.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>

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

} // namespace

void check_contact_curves(const SerialMesh &mesh, const Scene &scene, const std::string &source) {
  if (mesh.dim != 2) return;
  for (const ContactRecipe &contact : scene.contacts)
    if (contact.entities.kind != InterfaceEntities::Kind::cells)
      for (const std::string &name : contact.entities.parts)
        check_curve(mesh, name, "the contact boundary '" + name + "' of " + source);
}

} // namespace rbvi
