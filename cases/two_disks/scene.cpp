// Two elastic half-disks, one of radius 1 above one of radius mu, pressed together without
// friction. Quarter-disks by symmetry; plane strain; u = (0, -indentation) on the upper flat side,
// (0, +indentation) on the lower one, u_x = 0 on the axis. On the arc of the upper disk within 45
// degrees of its lowest point
//
//   (u_lower o phi - u_upper) . e_y <= (x - phi(x)) . e_y,
//
// phi(x) being the point of the lower disk below x (2.49)-(2.52), held by a pressure lambda >= 0
// per length of the upper arc. In the reference domain both disks have the radius 1 and are drawn
// apart: the upper one is centred at (0, 1.5), the lower one at (0, -1.5). A similarity leaves a
// plane stiffness as it is, so that a does not depend on mu.
#include "scene.hpp"

#include "rbvi/contact/elastic_pair.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/places.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rbvi {

namespace {

constexpr double centre = 1.5;       ///< of the upper reference disk, height
constexpr int quadratic_edges = 140; ///< of each contact arc: as many nodes as 560 of degree 1
constexpr double deepest = 0.2;      ///< indentation over a radius: deformations stay small

/// The upper disk is shifted until it is the initial gap above the origin, the lower one shrinks or
/// grows from its highest point, the origin.
Point placed(double initial_gap, double radius, const Point &x) {
  if (x[1] > 0) return {x[0], x[1] - (centre - 1) + initial_gap, 0};
  return {radius * x[0], radius * (x[1] + (centre - 1)), 0};
}

Point on_circle(const Point &x) {
  const double height = x[1] > 0 ? centre : -centre;
  const double scale = 1 / std::hypot(x[0], x[1] - height);
  return {scale * x[0], height + scale * (x[1] - height), 0};
}

/// Facts of one body: `up` is 1 for the upper one, -1 for the lower one.
std::vector<MeshFact> body_facts(double up) {
  constexpr double quarter = std::numbers::pi / 4;
  const bool upper = up > 0;
  const std::string region = upper ? "upper" : "lower", height = upper ? "1.5" : "-1.5";
  const std::string disk_name = "the disk of radius 1 m about (0, " + height + ")";
  const Point middle{0, up * centre, 0};
  const Place square =
      upper ? box({0, centre - 1, 0}, {1, centre, 0}) : box({0, -centre, 0}, {1, 1 - centre, 0});
  return {
      {region,
       "the quarter x >= 0, y " + std::string(upper ? "<= " : ">= ") + height + " of " + disk_name,
       common_part(disk(middle, 1), square), quarter},
      {upper ? "top" : "bottom", "the flat side y = " + height + ", 0 <= x <= 1",
       segment(middle, {1, up * centre, 0}), 1},
      {upper ? "slave" : "master",
       "the arc of '" + region + "' from the axis to 45 degrees beside it",
       arc(middle, 1, -up * 1.5 * quarter, quarter / 2), quarter, "arc"}};
}

MeshRecipe mesh(int edges) {
  constexpr double quarter = std::numbers::pi / 4;
  const Point up{0, centre, 0}, down{0, -centre, 0};
  MeshRecipe recipe{edges == 0 ? "two_quarter_discs" : "two_graded_quarter_discs",
                    {"upper", "lower"},
                    {"axis", "top", "bottom", "slave", "master", "arc"},
                    {"arc"},
                    edges};
  std::vector<MeshFact> &facts = recipe.facts = body_facts(1);
  for (MeshFact &fact : body_facts(-1))
    facts.push_back(std::move(fact));
  const Place bodies = nearest({facts[0].distance, facts[3].distance});
  facts.insert(facts.begin(), {"", "two quarter disks, 1 m apart", bodies, 2 * quarter});
  facts.push_back({"axis", "the sides x = 0 of both bodies",
                   nearest({segment(up, {0, centre - 1, 0}), segment(down, {0, 1 - centre, 0})}),
                   2});
  facts.push_back({"arc", "the round sides of both bodies, 'slave' and 'master' included",
                   nearest({arc(up, 1, -quarter, quarter), arc(down, 1, quarter, quarter)}),
                   4 * quarter});
  return recipe;
}

int arc_edges(const SceneOptions &options, int degree) {
  const double edges = number_in(options, "arc_edges");
  if (edges != 0 && (edges < 8 || std::fmod(edges, 1) != 0))
    throw bad_input("option arc_edges is " + options.at("arc_edges") +
                    ": it must be a whole number of at least 8, or 0");
  return edges == 0 && degree == 2 ? quadratic_edges : static_cast<int>(edges);
}

const Maker<PointMap> placed_map{
    "two_disks/placed", 1, [](const Record &of) -> std::function<PointMap> {
      return [gap = number(of, "initial_gap")](const FullMu &mu, const Point &x) {
        return placed(gap, mu[0], x);
      };
    }};

/// Towards each other.
const Maker<PointMap> pressed_motion{
    "two_disks/pressed", 1, [](const Record &of) -> std::function<PointMap> {
      return [indentation = number(of, "indentation")](const FullMu &, const Point &x) -> Point {
        return {0, x[1] > 0 ? -indentation : indentation, 0};
      };
    }};

Scene make(const SceneOptions &options) {
  Scene scene;
  set_elastic_pair(options, {true, false}, scene);
  scene.training = "grid:11";
  scene.validation = "random:30:1";
  scene.mesh = mesh(arc_edges(options, scene.degree));
  const double gap = number_in(options, "initial_gap");
  const double indentation = number_in(options, "indentation");
  const Range radii{std::max(0.1, indentation / deepest), 10};
  scene.parameters = all_free({{"radius", "m", 0.7, 1.3, 1, radii}});
  scene.map = placed_map({{"initial_gap", {gap}}});
  scene.snap = on_circle;
  scene.fixed = {{"axis", {0}}, {"top", {}}, {"bottom", {}}};
  scene.motion = pressed_motion({{"indentation", {indentation}}});
  scene.mirror_images = 2;
  return scene;
}

} // namespace

SceneEntry two_disks() {
  return {"two_disks",
          "Hertz contact of two elastic half-disks, the lower one of free radius",
          elastic_pair_options(
              2, {{"indentation",
                   "0.09",
                   "displacement of each flat side towards the other disk",
                   {},
                   {0, deepest}},
                  {"initial_gap", "0.001", "between the undeformed disks", {}, {-deepest, 1}},
                  {"arc_edges",
                   "0",
                   "edges of each contact arc; 0: 140, of degree 1 560",
                   {},
                   {0, 10000},
                   true}}),
          make,
          {placed_map, pressed_motion}};
}

} // namespace rbvi
