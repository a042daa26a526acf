#include "rbvi/contact/half_plane/half_plane.hpp"

#include <cmath>

namespace rbvi {

namespace {

Point normal_of(const HalfPlane &plane, const FullMu &mu) {
  const double angle = plane.tilt ? plane.tilt(mu) : 0;
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * plane.normal[0] - s * plane.normal[1], s * plane.normal[0] + c * plane.normal[1], 0};
}

} // namespace

ContactRecipe half_plane(HalfPlane plane) {
  Support support{plane.boundary, {}, {}, plane.friction, plane.lumped};
  support.normal = [plane](const FullMu &mu, const Point &) { return normal_of(plane, mu); };
  ContactRecipe recipe = rigid_support(support);
  recipe.make = [plane, support](const Scene &scene, InterfaceMesh mesh) {
    Support placed = support;
    placed.gap = [plane, &scene](const FullMu &mu, const Point &x) {
      const Point n = normal_of(plane, mu),
                  at = plane.surface ? plane.surface(mu, x) : scene.map(mu, x);
      return plane.position(mu) - (at[0] - plane.pivot[0]) * n[0] - (at[1] - plane.pivot[1]) * n[1];
    };
    return rigid_support(placed).make(scene, std::move(mesh));
  };
  return recipe;
}

} // namespace rbvi
