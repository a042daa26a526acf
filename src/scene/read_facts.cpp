#include "reader.hpp"

#include "rbvi/core/places.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <numbers>

namespace rbvi {

namespace {

/// What polygons beside the curves of a body, or in its holes, may lack or add.
constexpr double tenth = 0.1;

struct PartPlace {
  std::string is = "";
  Place distance{};
};

std::string point_text(double x, double y) {
  return std::string("(").append(short_number(x)).append(", ").append(short_number(y)).append(")");
}

PartPlace box_in(const std::vector<double> &n) {
  if (!(n[0] < n[2] && n[1] < n[3]))
    throw bad_input("a box is [x0, y0, x1, y1]: the lower corner comes first");
  return {"the box [" + short_number(n[0]) + ", " + short_number(n[2]) + "] x [" +
              short_number(n[1]) + ", " + short_number(n[3]) + "]",
          box({n[0], n[1], 0}, {n[2], n[3], 0})};
}

PartPlace disk_in(const std::vector<double> &n) {
  if (!(n[2] > 0)) throw bad_input("the radius of a disk is positive");
  return {"the disk of radius " + short_number(n[2]) + " about " + point_text(n[0], n[1]),
          disk({n[0], n[1], 0}, n[2])};
}

PartPlace segment_in(const std::vector<double> &n) {
  if (n[0] == n[2] && n[1] == n[3]) throw bad_input("the ends of a segment are the same point");
  return {"the segment from " + point_text(n[0], n[1]) + " to " + point_text(n[2], n[3]),
          segment({n[0], n[1], 0}, {n[2], n[3], 0})};
}

PartPlace arc_in(const std::vector<double> &n) {
  constexpr double pi = std::numbers::pi, round_off = 1e-12;
  if (!(n[2] > 0)) throw bad_input("the radius of an arc is positive");
  if (!(n[3] < n[4] && n[4] <= n[3] + 2 * pi + round_off))
    throw bad_input("an arc is [x, y, radius, from, to]: angles in radians, counterclockwise, "
                    "such as 0 and pi");
  const double half = std::min((n[4] - n[3]) / 2, pi);
  return {"the arc of radius " + short_number(n[2]) + " about " + point_text(n[0], n[1]) +
              " from " + short_number(180 / pi * n[3]) + " to " + short_number(180 / pi * n[4]) +
              " degrees",
          arc({n[0], n[1], 0}, n[2], (n[3] + n[4]) / 2, half)};
}

/// A key that says where a part lies.
struct PlaceKey {
  const char *name;
  std::size_t numbers;
  bool of_boundaries;
  PartPlace (*read)(const std::vector<double> &numbers);
};

constexpr std::array place_keys{
    PlaceKey{"box", 4, false, box_in}, PlaceKey{"disk", 3, false, disk_in},
    PlaceKey{"segment", 4, true, segment_in}, PlaceKey{"arc", 5, true, arc_in}};

PartPlace place_in(const Reader &reader, const CaseNode &node, bool boundary) {
  PartPlace place;
  for (const PlaceKey &key : place_keys) {
    const CaseNode *value = node.find(key.name);
    if (value == nullptr) continue;
    if (place.distance)
      throw bad_input("a part has one place: give one of box, disk, segment, arc");
    if (key.of_boundaries && !boundary)
      throw bad_input(std::string(key.name) +
                      " is a place of boundaries: a region has box or disk");
    place = key.read(numbers_in(reader, *value, key.numbers));
  }
  return place;
}

MeshFact fact_in(const Reader &reader, const std::string &part, const CaseNode &node,
                 MeshRecipe &recipe) {
  const bool boundary = std::ranges::find(recipe.boundaries, part) != recipe.boundaries.end();
  const auto [place, distance] = place_in(reader, node, boundary);
  MeshFact fact{part, place, distance};
  const auto add = [&](const std::string &words) {
    fact.is.append(fact.is.empty() ? "" : ", ").append(words);
  };
  if (const CaseNode *within = node.find("within")) {
    if (!boundary) throw bad_input("within is of boundaries: a region has box or disk");
    fact.within = within->value;
    add("a part of '" + fact.within + "'");
    if (std::ranges::find(recipe.boundaries, fact.within) == recipe.boundaries.end())
      recipe.boundaries.push_back(fact.within);
  }
  if (node.find("size") != nullptr) {
    fact.size = number_in(reader, *node.find("size"));
    fact.excess = tenth;
    if (!(fact.size > 0)) throw bad_input("the size of a part is positive");
    add((boundary ? "of length " : "of area ") + short_number(fact.size));
  }
  if (fact.is.empty())
    throw bad_input("nothing is said of it: give box, disk, segment, arc, size or within");
  return fact;
}

} // namespace

void read_facts(const Reader &reader, const CaseNode &mesh, MeshRecipe &recipe, Defects &defects) {
  const CaseNode *facts = mesh.find("facts");
  if (facts == nullptr) return;
  std::vector<std::string> known{"all"};
  known.insert(known.end(), recipe.regions.begin(), recipe.regions.end());
  known.insert(known.end(), recipe.boundaries.begin(), recipe.boundaries.end());
  for (const auto &[name, node] : facts->entries)
    defects.collect(node, [&, &own = name, &value = node] {
      if (std::ranges::find(known, own) == known.end())
        throw bad_input("no section of the case names a part '" + own +
                        "' of the mesh: the nearest is '" + nearest_name(own, known) + "'");
      recipe.facts.push_back(fact_in(reader, own == "all" ? "" : own, value, recipe));
    });
}

} // namespace rbvi
