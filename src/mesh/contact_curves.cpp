#include "rbvi/mesh/contact_curves.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/mesh/serial.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
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

} // namespace

std::vector<std::string> contact_curves(const Scene &scene) {
  std::vector<std::string> names;
  for (const ContactRecipe &contact : scene.contacts)
    if (contact.entities.kind != InterfaceEntities::Kind::cells && scene.dim == 2)
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

} // namespace rbvi
