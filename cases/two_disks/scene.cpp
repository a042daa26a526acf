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

#include "rbvi/element/elastic_pair.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

constexpr double centre = 1.5;  ///< of the upper reference disk, height
constexpr double deepest = 0.2; ///< indentation over a radius: deformations stay small

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

Scene make(const SceneOptions &options) {
  Scene scene;
  set_elastic_pair(options, scene);
  scene.training = "grid:81";
  scene.validation = "random:30:1";
  scene.mesh = {"two_quarter_discs",
                {"upper", "lower"},
                {"axis", "top", "bottom", "slave", "master", "arc"},
                "arc"};
  const double gap = number_in(options, "initial_gap");
  const double indentation = number_in(options, "indentation");
  const Range radii{std::max(0.1, indentation / deepest), 10};
  scene.parameters = all_free({{"radius", "m", 0.7, 1.3, 1, radii}});
  scene.map = [gap](const Mu &mu, const Point &x) { return placed(gap, mu[0], x); };
  scene.snap = on_circle;
  scene.fixed = {{"axis", {0}}, {"top", {}}, {"bottom", {}}};
  scene.motion = [indentation](const Mu &, const Point &x) -> Point {
    return {0, x[1] > 0 ? -indentation : indentation, 0};
  };
  scene.mirror_images = 2;
  return scene;
}

} // namespace

SceneEntry two_disks() {
  return {"two_disks", "Hertz contact of two elastic half-disks, the lower one of free radius",
          elastic_pair_options(
              {{"indentation",
                "0.09",
                "displacement of each flat side towards the other disk",
                {},
                {0, deepest}},
               {"initial_gap", "0.001", "between the undeformed disks", {}, {-deepest, 1}}}),
          make};
}

} // namespace rbvi
