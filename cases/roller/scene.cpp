// An elastic roller of radius 1 m on a rigid hub of radius 0.3 m, between two rigid plates. Plane
// strain; u = 0 on the hub. The upper plate is pushed in by `top` and tilted by `tilt`, without
// friction; the lower one is pushed in by `bottom`, with Coulomb friction or none:
//
//   u . n <= 1 - push - x . n   on the arc within 45 degrees of each plate's point, n its normal,
//
// held by pressures lambda_n >= 0, and |lambda_tau| <= nu_F lambda_n on the lower arc, against u .
// tau; or the same by Nitsche's method on both arcs. A does not depend on mu; B of the upper plate
// turns with its tilt.
#include "scene.hpp"

#include "rbvi/contact/nitsche_support.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/places.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"

#include <cmath>
#include <numbers>

namespace rbvi {

namespace {

constexpr double hub = 0.3; // in the mesh a polygon with its vertices on the circle
constexpr Range pushes{-0.2, 0.1}, tilts{-0.25, 0.25}; // from there on contact leaves the arcs

/// Positions of the parameters.
enum Position { top, tilt, bottom, friction };

Point on_circle(double radius, const Point &x) {
  const double scale = radius / std::hypot(x[0], x[1]);
  return {scale * x[0], scale * x[1], 0};
}

/// Onto the nearer one of the two circles.
Point on_circles(const Point &x) {
  return on_circle(std::hypot(x[0], x[1]) < (1 + hub) / 2 ? hub : 1, x);
}

MeshRecipe mesh(int edges) {
  constexpr double pi = std::numbers::pi;
  const Point centre{0, 0, 0};
  const Place outside = [](const Point &x) { return hub - std::hypot(x[0], x[1]); };
  MeshRecipe recipe{"annulus", {}, {"hub", "rim", "top", "bottom"}, {"hub", "rim"}, edges};
  recipe.facts = {
      {"", "the disk of radius 1 m about the origin, without its hub",
       common_part(disk(centre, 1), outside), pi * (1 - 0.9 * hub * hub)},
      {"hub", "the circle of radius 0.3 m about the origin", arc(centre, hub, 0, pi), 2 * pi * hub},
      {"rim", "the circle of radius 1 m about the origin", arc(centre, 1, 0, pi), 2 * pi},
      {"top", "the arc of radius 1 m within 45 degrees of (0, 1)", arc(centre, 1, pi / 2, pi / 4),
       pi / 2, "rim"},
      {"bottom", "the arc of radius 1 m within 45 degrees of (0, -1)",
       arc(centre, 1, -pi / 2, pi / 4), pi / 2, "rim"}};
  return recipe;
}

const auto rim_points = plain<PointMap>(
    "roller/rim", 1, [](const FullMu &, const Point &x) { return on_circle(1, x); });

/// A plate that touches the undeformed roller where nothing is pushed in.
HalfPlane plate(const std::string &boundary, const Point &normal, int push) {
  HalfPlane plane{boundary, normal, {0, 0, 0}, affine(1, -1, push)};
  plane.surface = rim_points();
  plane.body_normal = rim_points(); // of a unit circle: its points are its normals
  return plane;
}

Scene make(const SceneOptions &options) {
  const double edges = number_in(options, "arc_edges");
  if (edges != 0 && (edges < 8 || std::fmod(edges, 1) != 0))
    throw bad_input("option arc_edges is " + options.at("arc_edges") +
                    ": it must be a whole number of at least 8, or 0");
  const bool lumped = options.at("lumped") == "yes";
  HalfPlane upper = plate("top", {0, 1, 0}, top), lower = plate("bottom", {0, -1, 0}, bottom);
  upper.tilt = parameter(tilt);
  upper.lumped = lower.lumped = lumped;
  if (options.at("friction") == "coulomb") {
    lower.friction.law = FrictionLaw::coulomb;
    lower.friction.value = parameter(friction);
  }
  Scene scene;
  scene.components = 2;
  scene.degree = options.at("degree") == "2" ? 2 : 1;
  scene.parameters = all_free({{"top", "m", 0.02, 0.05, 0.04, pushes},
                               {"tilt", "", -0.2, 0.2, 0, tilts},
                               {"bottom", "m", 0.02, 0.05, 0.03, pushes},
                               {"friction_coefficient", "", 0, 0.5, 0.3, friction_range}});
  scene.parameters.free = {top, tilt};
  scene.training = "grid:11,11";
  scene.validation = "random:30:1";
  scene.mesh = mesh(static_cast<int>(edges));
  scene.map = identity();
  scene.snap = on_circles;
  scene.fixed = {{"hub", {}}};
  scene.contacts = {contact_by(options, rigid_contact(upper)),
                    contact_by(options, rigid_contact(lower))};
  const Lame material = lame(number_in(options, "young"), number_in(options, "poisson_ratio"));
  scene.material = everywhere(material);
  scene.a = {exact_term(elasticity("", material, scene.degree))};
  scene.v_product = {exact_term(h1_product(1, 2, scene.degree))};
  return scene;
}

} // namespace

SceneEntry roller() {
  std::vector<SceneOption> options{
      {"friction", "coulomb", "law of friction of the lower plate", {"none", "coulomb"}},
      {"degree", "2", "of the displacement", {"1", "2"}},
      {"lumped", "no", "vertex quadrature in b and g", {"no", "yes"}},
      {"arc_edges", "0", "edges of each contact arc; 0: 48", {}, {0, 10000}, true},
      {"young", "15", "Young's modulus in Pa", {}, young_range},
      {"poisson_ratio", "0.35", "Poisson's ratio", {}, poisson_range}};
  for (SceneOption &option : nitsche_options())
    options.push_back(std::move(option));
  return {"roller",
          "elastic roller on a hub between two plates, one tilted, one with friction",
          std::move(options),
          make,
          {rim_points}};
}

} // namespace rbvi
