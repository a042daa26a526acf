// Membrane over an obstacle. On the square (-1/2, 1/2)^2, mu = (radius r, centre c):
//
//   -Laplace u = load,   u = frame_height + frame_tilt x on the boundary (by default 0),
//   u >= psi(mu) = -1.25 |x - c|^2 / r^2   on the disc of centre c and radius r,
//
// held by a pressure lambda >= 0 that lives on the disc (2.36). The load -25 on the unit square
// gives the contact of the published basis sizes.
#include "scene.hpp"

#include "rbvi/contact/obstacle.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/places.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/scalar_forms.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rbvi {

namespace {

constexpr double reference_radius = 0.2;
constexpr int lumped_edges = 60;    ///< of the circle, with vertex quadrature
constexpr int quadratic_edges = 36; ///< of the circle, of degree 2
constexpr double transition = 0.3; ///< width of the ring over which the map turns into the identity

// Along its radii the ring is stretched by 1 + phi' (r - 0.2 + c . e) > 0, with |phi'| <= 1.5 /
// 0.3: r + |c| < 0.4. This leaves a tenth of each cell.
constexpr double farthest = 0.38;
constexpr Range radii{0.02, farthest}, centres{0.02 - farthest, farthest - 0.02};

/// Outside the disc: carry the circle's motion to zero at distance `transition`.
Point map_outside(const FullMu &mu, const Point &x, double rho) {
  const double s = std::clamp((rho - reference_radius) / transition, 0.0, 1.0);
  const double phi = (1 - s) * (1 - s) * (1 + 2 * s);
  const double stretch = 1 + phi * (mu[0] - reference_radius) / rho;
  return {stretch * x[0] + phi * mu[1], stretch * x[1] + phi * mu[2], 0};
}

/// x -> c + (r / 0.2) x on the disc.
Point similarity(const FullMu &mu, const Point &x) {
  const double rho = std::hypot(x[0], x[1]);
  if (rho > reference_radius) return map_outside(mu, x, rho);
  const double scale = mu[0] / reference_radius;
  return {mu[1] + scale * x[0], mu[2] + scale * x[1], 0};
}

/// The same disc, graded along its radii by an amount that depends on mu and on the direction:
/// not a similarity, so that the mass matrix of the disc does not separate.
Point graded(const FullMu &mu, const Point &x) {
  const double rho = std::hypot(x[0], x[1]);
  if (rho > reference_radius) return map_outside(mu, x, rho);
  const double s = rho / reference_radius;
  const double kappa =
      0.05 * ((mu[0] - 0.2) / 0.04 + (mu[1] * x[0] + mu[2] * x[1]) / (0.05 * reference_radius));
  const double scale = (mu[0] / reference_radius) * (1 + kappa * (1 - s * s));
  return {mu[1] + scale * x[0], mu[2] + scale * x[1], 0};
}

const auto slope =
    plain<PointMap>("membrane_obstacle/slope", 1, [](const FullMu &, const Point &x) {
      return Point{x[0], 0, 0};
    });

/// The frame that holds the membrane, lifted and tilted about the y axis.
std::vector<ImposedTerm> frame() {
  constexpr int lift = 3, tilt = 4; // positions of the parameters
  return {
      {everywhere(Point{1, 0, 0}), std::vector{Factor{"frame_height", parameter(lift), {lift}}}},
      {slope(), std::vector{Factor{"frame_tilt", parameter(tilt), {tilt}}}}};
}

/// psi(mu) of the obstacle.
double height(const FullMu &mu, const Point &x) {
  const double dx = x[0] - mu[1], dy = x[1] - mu[2];
  return -1.25 * (dx * dx + dy * dy) / (mu[0] * mu[0]);
}

MeshRecipe mesh(int circle_edges) {
  const Place square = box({-0.5, -0.5, 0}, {0.5, 0.5, 0});
  const double disc = std::numbers::pi * reference_radius * reference_radius;
  MeshRecipe recipe{"square_with_disc", {"obstacle"}, {"boundary"}, {}, circle_edges};
  recipe.facts = {{"", "the square of side 1 m about the origin", square, 1},
                  {"obstacle", "the disk of radius 0.2 m about the origin",
                   disk({0, 0, 0}, reference_radius), disc},
                  {"boundary", "all four sides of the square", rim(square), 4}};
  return recipe;
}

/// Edges of the circle in the graded mesh; 0 is the mesh of the published answers.
int circle_edges(const SceneOptions &options, bool lumped, int degree) {
  const double edges = number_in(options, "circle_edges");
  if (std::fmod(edges, 12) != 0)
    throw bad_input("option circle_edges is " + options.at("circle_edges") +
                    ": it must be a multiple of 12, or 0");
  if (edges != 0) return static_cast<int>(edges);
  return degree == 2 ? quadratic_edges : lumped ? lumped_edges : 0;
}

/// Throws bad_input unless the disc of radius all[0] about (all[1], all[2]) is far enough from the
/// edge of the square for the ring around it not to fold.
void check_disc_in_square(const FullMu &all) {
  const double reach = all[0] + std::hypot(all[1], all[2]);
  if (reach > farthest + 1e-12)
    throw bad_input("the disc reaches " + short_number(reach) +
                    " from the middle of the square, beyond " + short_number(farthest) +
                    ", and folds the mesh around it: make the radius or the centre's distance "
                    "smaller");
}

const auto similarity_map = plain<PointMap>("membrane_obstacle/similarity", 1, similarity);
const auto graded_map = plain<PointMap>("membrane_obstacle/graded", 1, graded);
const auto obstacle_height = plain<PointValue>("membrane_obstacle/height", 1, height);
const auto disc_check = plain<Check>("membrane_obstacle/disc_in_square", 1, check_disc_in_square);

Scene make(const SceneOptions &options) {
  Scene scene;
  scene.dim = 2;
  scene.components = 1;
  scene.degree = options.at("degree") == "2" ? 2 : 1;
  scene.parameters = free_only(all_free({{"radius", "m", 0.16, 0.24, 0.2, radii},
                                         {"center_x", "m", -0.05, 0.05, 0, centres},
                                         {"center_y", "m", -0.05, 0.05, 0, centres},
                                         {"frame_height", "m", -0.1, 0.1, 0, {-1, 1}},
                                         {"frame_tilt", "", -0.5, 0.5, 0, {-2, 2}}}),
                               "radius,center_x,center_y");
  scene.check_parameters = disc_check();
  scene.training = "grid:5,5,5";
  scene.validation = "random:64:1";
  const bool lumped = options.at("lumped") == "yes";
  scene.mesh = mesh(circle_edges(options, lumped, scene.degree));
  scene.map = options.at("disc_map") == "graded" ? graded_map() : similarity_map();
  scene.snap = [](const Point &x) -> Point {
    const double scale = reference_radius / std::hypot(x[0], x[1]);
    return {scale * x[0], scale * x[1], 0};
  };
  scene.fixed = {{"boundary", {}, frame()}};
  scene.contacts = {obstacle({"obstacle", obstacle_height(), lumped})};
  const std::vector<int> on_disc{0, 1, 2}; // radius and centre: the map of the domain
  const double load = number_in(options, "load");
  scene.a = {mapped_term(laplace("", scene.degree), on_disc)};
  if (load != 0) scene.f = {mapped_term(constant_load("", load, scene.degree), on_disc)};
  scene.v_product = {exact_term(h1_product(1, 1, scene.degree))};
  return scene;
}

} // namespace

SceneEntry membrane_obstacle() {
  return {
      "membrane_obstacle",
      "elastic membrane pushed onto a disc-shaped obstacle of free radius and centre",
      {{"load", "-25", "load per unit area", {}, {-1e6, 1e6}},
       {"disc_map", "similarity", "how the reference disc is mapped", {"similarity", "graded"}},
       {"lumped",
        "yes",
        "vertex quadrature in b and g; no: exact quadrature, the published method",
        {"no", "yes"}},
       {"degree",
        "1",
        "of the displacement; 2 is for -lumped no, as vertex quadrature leaves it at order 1",
        {"1", "2"}},
       {"circle_edges",
        "0",
        "edges of the disc's circle in the graded mesh, a multiple of 12; 0: 60, with -lumped no "
        "the published mesh, of degree 2 36",
        {},
        {0, 240},
        true}},
      make,
      {similarity_map, graded_map, slope, obstacle_height, disc_check}};
}

} // namespace rbvi
