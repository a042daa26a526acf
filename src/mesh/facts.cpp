#include "facets.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/mesh/serial.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace rbvi {

namespace {

/// What every check asks of.
struct Subject {
  const SerialMesh &mesh;
  const Scene &scene;
  const std::string &source;
  double tolerance;         ///< a length: 1e-6 of the extent
  std::vector<Facet> outer; ///< facets of one cell alone, sorted
};

std::string text_of(const Subject &s, const Point &x) {
  std::string text;
  for (int c = 0; c < s.mesh.dim; ++c)
    text.append(c == 0 ? "(" : ", ").append(short_number(x[c]));
  return text.append(")");
}

std::string text_of(const Subject &s, const Facet &facet) {
  std::string text = "the facet";
  for (int i = 0; i < s.mesh.dim; ++i)
    text.append(i == 0 ? " from " : " to ").append(text_of(s, s.mesh.points[facet[i]]));
  return text;
}

Point centre_of(const SerialMesh &mesh, const int *vertices, int count) {
  Point centre{};
  for (int i = 0; i < count; ++i)
    centre = centre + mesh.points[vertices[i]] / count;
  return centre;
}

/// Length of an edge, area of a triangle.
double measure(const SerialMesh &mesh, const Facet &facet) {
  const Point &a = mesh.points[facet[0]], &b = mesh.points[facet[1]];
  if (mesh.dim == 2) return distance(a, b);
  const Point &c = mesh.points[facet[2]];
  return 0.5 * norm(cross(b - a, c - a));
}

double measure(const SerialMesh &mesh, int cell) {
  std::array<Point, 4> vertices{};
  for (int i = 0; i <= mesh.dim; ++i)
    vertices[i] = mesh.points[mesh.cells[cell][i]];
  return simplex(mesh.dim, vertices).volume;
}

/// "'top' of mesh file 'x.msh'", or the mesh itself.
std::string part_of(const Subject &s, const MeshFact &fact) {
  return fact.part.empty() ? s.source : "'" + fact.part + "' of " + s.source;
}

[[noreturn]] void refuse(const Subject &s, const MeshFact &fact, const std::string &found) {
  throw bad_input(part_of(s, fact) + " is not " + fact.is + ": " + found +
                  "; rbvi -help -case FILE lists what "
                  "the mesh of a case needs");
}

bool is_region(const Subject &s, const std::string &name) {
  const std::vector<std::string> &regions = s.scene.mesh.regions;
  return std::find(regions.begin(), regions.end(), name) != regions.end();
}

std::vector<int> cells_of(const Subject &s, const std::string &part) {
  if (!part.empty()) return s.mesh.region.at(part);
  std::vector<int> all;
  for (int c = 0; c < static_cast<int>(s.mesh.cells.size()); ++c)
    all.push_back(c);
  return all;
}

std::vector<int> vertices_of_part(const Subject &s, const MeshFact &fact) {
  std::vector<int> vertices;
  if (fact.part.empty() || is_region(s, fact.part)) {
    for (const int cell : cells_of(s, fact.part))
      vertices.insert(vertices.end(), s.mesh.cells[cell].begin(),
                      s.mesh.cells[cell].begin() + s.mesh.dim + 1);
  } else {
    for (const Facet &facet : facets_of(s.mesh, fact.part))
      vertices.insert(vertices.end(), facet.begin(), facet.begin() + s.mesh.dim);
  }
  return vertices;
}

/// The vertex that is farthest from the part's place lies in it.
void check_place(const Subject &s, const MeshFact &fact) {
  double farthest = s.tolerance;
  int worst = -1;
  for (const int v : vertices_of_part(s, fact)) {
    const double away = fact.distance(s.mesh.points[v]);
    if (away <= farthest) continue;
    farthest = away;
    worst = v;
  }
  if (worst >= 0)
    refuse(s, fact,
           "vertex " + text_of(s, s.mesh.points[worst]) + " is " + short_number(farthest) +
               " away from it");
}

/// The region holds every cell in its place, and the mesh fits the rim of that place.
void check_region(const Subject &s, const MeshFact &fact) {
  std::vector<bool> inside(s.mesh.cells.size(), false);
  for (const int cell : s.mesh.region.at(fact.part))
    inside[cell] = true;
  for (std::size_t c = 0; c < inside.size(); ++c) {
    if (inside[c]) continue;
    double deepest = 0, highest = -s.tolerance;
    int worst = -1;
    for (int i = 0; i <= s.mesh.dim; ++i) {
      const double away = fact.distance(s.mesh.points[s.mesh.cells[c][i]]);
      highest = std::max(highest, away);
      if (away < deepest) worst = s.mesh.cells[c][i];
      deepest = std::min(deepest, away);
    }
    if (highest <= s.tolerance)
      refuse(s, fact,
             "the cell about " +
                 text_of(s, centre_of(s.mesh, s.mesh.cells[c].data(), s.mesh.dim + 1)) +
                 " is missing");
    if (deepest < -s.tolerance)
      refuse(s, fact,
             "vertex " + text_of(s, s.mesh.points[worst]) + " of a cell outside lies " +
                 short_number(-deepest) + " inside it: the edges of the mesh must fit its rim");
  }
}

/// An outer facet along the place of a boundary: its vertices in it, its centre beside it.
bool lies_along(const Subject &s, const MeshFact &fact, const Facet &facet) {
  double longest = 0;
  for (int i = 0; i < s.mesh.dim; ++i) {
    const Point &x = s.mesh.points[facet[i]];
    if (fact.distance(x) > s.tolerance) return false;
    for (int j = 0; j < i; ++j)
      longest = std::max(longest, distance(x, s.mesh.points[facet[j]]));
  }
  return fact.distance(centre_of(s.mesh, facet.data(), s.mesh.dim)) <= 0.25 * longest;
}

/// The boundary is exactly the part of the surface in its place.
void check_boundary(const Subject &s, const MeshFact &fact) {
  const std::vector<Facet> facets = facets_of(s.mesh, fact.part);
  for (const Facet &facet : facets)
    if (!std::binary_search(s.outer.begin(), s.outer.end(), facet))
      refuse(s, fact, text_of(s, facet) + " has cells on both sides");
  const std::vector<Facet> around = fact.within.empty() ? facets : facets_of(s.mesh, fact.within);
  for (const Facet &facet : facets)
    if (!std::binary_search(around.begin(), around.end(), facet))
      refuse(s, fact, text_of(s, facet) + " is not in '" + fact.within + "'");
  if (!fact.distance) return;
  int missing = 0;
  const Facet *first = nullptr;
  for (const Facet &facet : s.outer)
    if (!std::binary_search(facets.begin(), facets.end(), facet) && lies_along(s, fact, facet)) {
      if (missing++ == 0) first = &facet;
    }
  if (first != nullptr)
    refuse(s, fact,
           "it has " + std::to_string(facets.size()) + " facets and lacks " +
               std::to_string(missing) + ", " + text_of(s, *first) + " for one");
}

/// Loads and contact are on the surface: inside the body neither has a direction.
void check_outer_boundaries(const Subject &s) {
  const auto check = [&](const std::string &name) {
    if (!name.empty()) check_boundary(s, {name, "on the surface of the body", {}});
  };
  for (const Term &load : s.scene.f)
    check(load.form.boundary);
  for (const ContactRecipe &contact : s.scene.contacts)
    for (const std::string &part : contact.entities.parts)
      if (contact.entities.kind != InterfaceEntities::Kind::cells) check(part);
}

/// Every cell is in a region of the operator.
void check_covered(const Subject &s) {
  std::vector<bool> covered(s.mesh.cells.size(), s.scene.a.empty());
  for (const Term &term : s.scene.a)
    if (term.form.kernel && term.form.boundary.empty())
      for (const int cell : cells_of(s, term.form.region))
        covered[cell] = true;
  const auto bare = std::ranges::find(covered, false);
  if (bare == covered.end()) return;
  const auto cell = static_cast<std::size_t>(bare - covered.begin());
  throw bad_input(s.source + " has cells without a material, " +
                  std::to_string(std::ranges::count(covered, false)) + " of " +
                  std::to_string(covered.size()) + ", that about " +
                  text_of(s, centre_of(s.mesh, s.mesh.cells[cell].data(), s.mesh.dim + 1)) +
                  " for one: name their region in 'at:' of the material, or write 'at: all'");
}

void check_size(const Subject &s, const MeshFact &fact) {
  double size = 0;
  const bool cells = fact.part.empty() || is_region(s, fact.part);
  if (cells)
    for (const int cell : cells_of(s, fact.part))
      size += measure(s.mesh, cell);
  else
    for (const Facet &facet : facets_of(s.mesh, fact.part))
      size += measure(s.mesh, facet);
  const int power = s.mesh.dim - (cells ? 0 : 1);
  const std::string name = power == 1 ? "length" : power == 2 ? "area" : "volume";
  if (size > (1 + fact.excess) * fact.size || size < 0.9 * fact.size)
    refuse(s, fact,
           "its " + name + " is " + short_number(size) + ", not " + short_number(fact.size) +
               (size > fact.size ? ": cells overlap, or it is larger"
                                 : ": it is too coarse, or not whole"));
}

/// The surface of the mesh is the rim of its place.
void check_surface(const Subject &s, const MeshFact &whole) {
  const MeshFact rim{whole.part, whole.is,
                     [&](const Point &x) { return std::abs(whole.distance(x)); }};
  int count = 0;
  const Facet *first = nullptr;
  for (const Facet &facet : s.outer)
    if (!lies_along(s, rim, facet) && count++ == 0) first = &facet;
  if (first != nullptr)
    refuse(s, whole,
           std::to_string(count) + " facets of its surface lie inside, " + text_of(s, *first) +
               " for one: it has a hole, a surface that is not meshed, or parts that are not "
               "glued together (Coherence; in Gmsh)");
}

/// One vertex for all outer ones at the same place.
class CommonVertices {
public:
  explicit CommonVertices(const Subject &s) : subject_(s) {}
  int of(int vertex) {
    const Point &x = subject_.mesh.points[vertex];
    std::array<long long, 3> box{};
    for (std::size_t c = 0; c < 3; ++c)
      box[c] = std::llround(x[c] / (4 * subject_.tolerance));
    for (long long i = -1; i <= 1; ++i)
      for (long long j = -1; j <= 1; ++j)
        for (long long k = -1; k <= 1; ++k) {
          const auto found = vertices_.find({box[0] + i, box[1] + j, box[2] + k});
          if (found == vertices_.end()) continue;
          for (const int other : found->second)
            if (distance(x, subject_.mesh.points[other]) <= subject_.tolerance) return other;
        }
    vertices_[box].push_back(vertex);
    return vertex;
  }

private:
  const Subject &subject_;
  std::map<std::array<long long, 3>, std::vector<int>> vertices_;
};

/// Facets on top of each other without common nodes, but for the two curves of two bodies.
void check_glued(const Subject &s) {
  std::vector<Facet> apart;
  for (const ContactRecipe &contact : s.scene.contacts)
    for (const std::string &name : contact.entities.parts)
      if (contact.entities.parts.size() > 1)
        for (const Facet &facet : facets_of(s.mesh, name))
          apart.push_back(facet);
  std::sort(apart.begin(), apart.end());
  CommonVertices common(s);
  std::vector<std::pair<Facet, Facet>> placed; // by place, by vertex
  for (const Facet &facet : s.outer) {
    if (std::binary_search(apart.begin(), apart.end(), facet)) continue;
    Facet place{-1, -1, -1};
    for (int i = 0; i < s.mesh.dim; ++i)
      place[i] = common.of(facet[i]);
    placed.emplace_back(sorted_facet(place), facet);
  }
  std::sort(placed.begin(), placed.end());
  int pairs = 0;
  Facet first{};
  for (std::size_t i = 1; i < placed.size(); ++i)
    if (placed[i].first == placed[i - 1].first && pairs++ == 0) first = placed[i].second;
  if (pairs > 0)
    throw bad_input(s.source + ": " + std::to_string(pairs) +
                    " facets lie on top of others without common nodes, " + text_of(s, first) +
                    " for one: glue the parts together (Coherence; in Gmsh)");
}

/// Throws bad_input for a scene that speaks of a part its recipe does not name.
void check_recipe(const Scene &scene) {
  std::vector<std::string> known = scene.mesh.regions, used;
  for (const auto &[name, curve] : scene.curves)
    used.push_back(name);
  known.insert(known.end(), scene.mesh.boundaries.begin(), scene.mesh.boundaries.end());
  known.emplace_back("");
  if (scene.axisymmetric) known.emplace_back(axis_of_turning);
  for (const MeshFact &fact : scene.mesh.facts)
    used.insert(used.end(), {fact.part, fact.within});
  for (const ContactRecipe &contact : scene.contacts)
    used.insert(used.end(), contact.entities.parts.begin(), contact.entities.parts.end());
  for (const FixedBoundary &boundary : scene.fixed)
    used.push_back(boundary.name);
  for (const Sum *sum : {&scene.a, &scene.f, &scene.v_product})
    for (const Term &term : *sum) {
      used.insert(used.end(), {term.form.region, term.form.boundary});
      for (const Mean &mean : term.form.means)
        used.push_back(mean.boundary);
    }
  for (const TiedBoundary &boundary : scene.tied)
    used.push_back(boundary.name);
  for (const std::string &name : used)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw bad_input("scene " + scene.name + " speaks of '" + name +
                      "', which is no region or boundary of its mesh");
}

Subject subject_of(const SerialMesh &mesh, const Scene &scene, const std::string &source) {
  return {mesh, scene, source, 1e-6 * extent_of(mesh), {}};
}

} // namespace

void check_places(const SerialMesh &mesh, const Scene &scene, const std::string &source) {
  const Subject s = subject_of(mesh, scene, source);
  for (const MeshFact &fact : scene.mesh.facts)
    if (fact.distance) check_place(s, fact);
}

void check_facts(const SerialMesh &mesh, const Scene &scene, const std::string &source) {
  check_recipe(scene);
  check_places(mesh, scene, source); // names the whole mesh first: a wrong unit shows in each part
  Subject s = subject_of(mesh, scene, source);
  s.outer = outer_facets(mesh);
  check_covered(s);
  check_glued(s);
  check_outer_boundaries(s);
  for (const MeshFact &fact : scene.mesh.facts) {
    if (!fact.part.empty() && !is_region(s, fact.part))
      check_boundary(s, fact);
    else if (fact.distance)
      fact.part.empty() ? check_surface(s, fact) : check_region(s, fact);
  }
  for (const MeshFact &fact : scene.mesh.facts)
    if (fact.size > 0) check_size(s, fact);
}

} // namespace rbvi
