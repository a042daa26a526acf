#include "rbvi/mesh/contact_curves.hpp"

#include "facets.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/mesh/serial.hpp"
#include "rbvi/mesh/surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>
#include <set>

namespace rbvi {

namespace {

/// The vertex that follows each one on a boundary, the body on the left. Throws bad_input where two
/// follow the same one, or one follows two.
std::map<int, int> followers(const SerialMesh &mesh, const std::string &boundary,
                             const std::string &source) {
  std::map<int, int> next;
  std::set<int> entered;
  for (const auto &[cell, vertices] : facets_with_cells(mesh, boundary)) {
    const auto &corners = mesh.cells[cell];
    const auto at = std::find(corners.begin(), corners.begin() + 3, vertices[0]) - corners.begin();
    const bool forward = corners[(at + 1) % 3] == vertices[1];
    const int begin = vertices[forward ? 0 : 1], end = vertices[forward ? 1 : 0];
    const bool branches = !next.emplace(begin, end).second;
    if (branches || !entered.insert(end).second) {
      const Point &x = mesh.points[branches ? begin : end];
      throw bad_input("the contact boundary '" + boundary + "' of " + source +
                      " meets itself at (" + short_number(x[0]) + ", " + short_number(x[1]) +
                      "): give what meets there boundaries and contacts of their own");
    }
  }
  return next;
}

/// Per vertex the angle of all cells there.
std::vector<double> angles(const SerialMesh &mesh) {
  std::vector<double> result(mesh.points.size(), 0.0);
  for (const auto &cell : mesh.cells)
    for (std::size_t i = 0; i < 3; ++i) {
      const Point &at = mesh.points[cell[i]];
      const Point a = mesh.points[cell[(i + 1) % 3]] - at, b = mesh.points[cell[(i + 2) % 3]] - at;
      result[cell[i]] += std::atan2(norm(cross(a, b)), dot(a, b));
    }
  return result;
}

using VertexPair = std::pair<int, int>; ///< the smaller one first

/// Per edge of the rim of a boundary in three dimensions the angle of all cells there.
std::map<VertexPair, double> rim_angles(const SerialMesh &mesh, const std::string &boundary) {
  const std::vector<Facet> own = facets_of(mesh, boundary);
  std::map<VertexPair, std::array<bool, 2>> beside; // facets of the boundary, others
  for (const Facet &facet : outer_facets(mesh))
    for (std::size_t i = 0; i < 3; ++i)
      beside[std::minmax(facet[i], facet[(i + 1) % 3])]
            [std::ranges::binary_search(own, facet) ? 0 : 1] = true;
  std::map<VertexPair, double> angles;
  for (const auto &[edge, both] : beside)
    if (both[0] && both[1]) angles[edge] = 0;
  constexpr std::array<std::array<std::size_t, 4>, 6> edges{
      {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}}};
  for (const auto &cell : mesh.cells)
    for (const auto &[a, b, c, d] : edges) {
      const auto found = angles.find(std::minmax(cell[a], cell[b]));
      if (found == angles.end()) continue;
      const auto at = [&](std::size_t i) { return mesh.points[cell[i]] - mesh.points[cell[a]]; };
      const Point one = cross(at(b), at(c)), other = cross(at(b), at(d));
      found->second += std::atan2(norm(cross(one, other)), dot(one, other));
    }
  return angles;
}

/// The largest distance of an edge of a piece that is on no curve of the case from the arc through
/// its vertices, where it turns alike at both of them: what turns once is a corner.
double off_its_arc(const SerialMesh &mesh, const CurvePiece &piece,
                   const std::set<std::pair<PetscInt, PetscInt>> &curved) {
  constexpr double straight = 1e-3; // radians
  double away = 0, last_turn = 0;
  for (std::size_t v = 2; v < piece.vertices.size(); ++v) {
    const auto at = [&](std::size_t k) { return mesh.points[piece.vertices[k]]; };
    const Point before = at(v - 1) - at(v - 2), after = at(v) - at(v - 1);
    const double turn = std::atan2(cross(before, after)[2], dot(before, after));
    const double both = std::min(std::abs(turn), std::abs(last_turn));
    if (both > straight && std::max(std::abs(turn), std::abs(last_turn)) < sharp_turn &&
        turn * last_turn > 0 &&
        !curved.contains(std::minmax(piece.vertices[v - 2], piece.vertices[v - 1])))
      away = std::max(away, norm(before) * both / 8);
    last_turn = turn;
  }
  return away;
}

} // namespace

std::vector<std::string> contact_boundaries(const Scene &scene) {
  std::vector<std::string> names;
  for (const ContactRecipe &contact : scene.contacts)
    if (contact.entities.kind != InterfaceEntities::Kind::cells)
      names.insert(names.end(), contact.entities.parts.begin(), contact.entities.parts.end());
  return names;
}

std::vector<CurvePiece> curve_pieces(const SerialMesh &mesh, const std::string &boundary,
                                     const std::string &source) {
  constexpr double widest = std::numbers::pi - sharp_turn;
  std::map<int, int> next = followers(mesh, boundary, source);
  std::set<int> begins;
  for (const auto &[begin, end] : next)
    begins.insert(begin);
  for (const auto &[begin, end] : next)
    begins.erase(end);
  const std::vector<double> angle = angles(mesh);
  std::vector<CurvePiece> pieces;
  while (!next.empty()) {
    const bool loop = begins.empty();
    const int first = loop ? next.begin()->first : *begins.begin();
    begins.erase(first);
    CurvePiece piece{{first}, loop, {true, true}};
    int last = first;
    for (auto edge = next.find(first); edge != next.end(); edge = next.find(last)) {
      last = edge->second;
      next.erase(edge);
      if (last != first) piece.vertices.push_back(last);
    }
    if (!loop) piece.closed_ends = {angle[first] < widest, angle[last] < widest};
    pieces.push_back(std::move(piece));
  }
  std::ranges::sort(pieces, {},
                    [](const CurvePiece &piece) { return std::ranges::min(piece.vertices); });
  return pieces;
}

std::vector<PetscInt> open_rim(const SerialMesh &mesh, const std::string &boundary) {
  constexpr double widest = std::numbers::pi - sharp_turn; // as of curve_pieces
  std::set<PetscInt> vertices;
  for (const auto &[edge, angle] : rim_angles(mesh, boundary))
    if (!(angle < widest)) vertices.insert({edge.first, edge.second});
  return {vertices.begin(), vertices.end()};
}

std::vector<std::pair<std::string, double>> off_arcs(const SerialMesh &mesh, const Scene &scene) {
  std::set<std::pair<PetscInt, PetscInt>> curved;
  for (const auto &[name, curve] : scene.curves)
    if (const auto own = mesh.boundary.find(name); own != mesh.boundary.end())
      for (const auto &facet : own->second)
        curved.insert(std::minmax<PetscInt>(facet[0], facet[1]));
  std::vector<std::pair<std::string, double>> off;
  if (mesh.dim != 2) return off;
  for (const std::string &boundary : contact_boundaries(scene)) {
    double away = 0;
    for (const CurvePiece &piece : curve_pieces(mesh, boundary, scene.name))
      away = std::max(away, off_its_arc(mesh, piece, curved));
    if (away > 0) off.emplace_back(boundary, away);
  }
  return off;
}

void warn_of_edges(const Scene &scene, const std::string &file, std::ostream &out) {
  if (file.empty()) return;
  for (const auto &[boundary, away] : off_arcs(mesh_with_groups(scene, file), scene))
    out << "warning: the contact boundary '" << boundary
        << "' turns smoothly: its straight edges are up to " << formatted("%.1e", away)
        << " off an arc, and so are gaps, on a refined mesh too, where pressures peak at its "
           "corners; if it is one, name it under curves\n";
}

} // namespace rbvi
