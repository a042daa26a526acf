#include "rbvi/contact/support.hpp"

#include "rbvi/contact/curve.hpp"
#include "rbvi/contact/surfaces.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <cmath>

namespace rbvi {

namespace {

Point normal_of(const HalfPlane &plane, const FullMu &mu) {
  const double angle = plane.tilt ? plane.tilt(mu) : 0;
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * plane.normal[0] - s * plane.normal[1], s * plane.normal[0] + c * plane.normal[1], 0};
}

/// What a point faces along its normal; distance(mu, x, normal) without the motion.
template <class Distance>
auto faced(const std::function<PointMap> &normal, const Distance &distance) {
  return [=](const FullMu &mu, const PlacedPoint &point, const Point &) {
    const Point n = normal(mu, point.x);
    return FacedPoint{n, distance(mu, point.x, n) - dot(point.motion, n),
                      slip_along(n, point.motion)};
  };
}

} // namespace

RigidContact rigid_contact(const Support &support) {
  RigidContact rigid{support.boundary, {}, support.friction, support.lumped};
  if (const auto *to_surface = support.gap.target<GapToSurface>()) { // it needs no other normal
    rigid.facing.at =
        faced(support.normal, [to = *to_surface](const FullMu &mu, const Point &x, const Point &n) {
          return to.along(mu, x, n);
        });
    rigid.facing.distance = [to = *to_surface](const FullMu &mu, const Point &x,
                                               const Point &moved) {
      return to.surface(mu, to.at(mu, x) + moved).distance;
    };
    rigid.facing.partner = [to = *to_surface](const FullMu &mu, const Point &x) {
      return to.partner(mu, x);
    };
  } else {
    rigid.facing.at =
        faced(support.normal, [gap = support.gap](const FullMu &mu, const Point &x, const Point &) {
          return gap(mu, x);
        });
  }
  rigid.facing.normal = support.normal;
  rigid.facing.asks_place = false;
  rigid.facing.body_normal = support.body_normal;
  return rigid;
}

double gap_error(const ContactInterface &interface, const Scene &scene, const Facing &facing,
                 const FullMu &mu, const Vector &u, const Vector &lambda) {
  if (!facing.distance) return 0;
  const std::vector<Index> &vertices = interface.dual().vertices;
  GapErrors errors(lambda.head(std::ssize(vertices)));
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Index node = vertices[k];
    const Point &x = interface.mesh().points[node],
                moved = Point{u[2 * node], u[2 * node + 1], 0} +
                        (scene.motion ? scene.motion(mu, x) : Point{});
    const auto [normal, gap] = interface.constraint_at(mu, x);
    const double way = dot(normal, moved),
                 left = gap - normal[0] * u[2 * node] - normal[1] * u[2 * node + 1];
    try {
      errors.add(lambda[static_cast<Index>(k)], way, left, facing.distance(mu, x, moved));
    } catch (const Error &) { // nothing is faced from there
    }
  }
  return errors.largest();
}

Grid support_fields(const ContactInterface &interface, const Scene &scene, const Facing &facing,
                    const std::vector<std::array<Index, 2>> &duals, const FullMu &mu,
                    const Vector &u, const Vector &lambda) {
  const InterfaceMesh &mesh = interface.mesh();
  const auto [vertices, shape] = first_curve(mesh);
  std::vector<CurvePlace> places;
  std::vector<int> cells, shown(vertices.size(), -1);
  std::vector<Index> dual_of; // of each place
  for (Index e = 0; e < shape.edges(); ++e)
    for (const std::size_t end : {0, 1}) {
      int &node = shown[shape.ends[e][end]];
      if (node < 0 || dual_of[node] != duals[e][end]) { // a pressure may end at a vertex
        node = static_cast<int>(std::ssize(places));
        places.push_back({e, static_cast<double>(end)});
        dual_of.push_back(duals[e][end]);
      }
      cells.push_back(node);
    }
  Grid grid = polyline(scene, mu, mesh, places, std::move(cells), u);
  const Vector moved = grid.of_nodes.front().values;
  const Index count = std::ssize(places), of_dual = interface.dual().nodes();
  Vector gap(count), slip(count), pressure(count), shear(count);
  std::vector<Point> normals, ways;
  for (Index k = 0; k < count; ++k) {
    const Index node = vertices[shape.ends[places[k].edge][places[k].s > 0 ? 1 : 0]];
    const Point &x = mesh.points[node];
    const PointConstraint at = interface.constraint_at(mu, x, {u[2 * node], u[2 * node + 1], 0});
    gap[k] = at.gap - at.direction[0] * u[2 * node] - at.direction[1] * u[2 * node + 1];
    slip[k] = slip_along(at.direction, {moved[3 * k], moved[3 * k + 1], 0});
    normals.push_back(at.direction);
    if (facing.partner)
      ways.push_back(facing.partner(mu, x) - Point{grid.points(k, 0) + moved[3 * k],
                                                   grid.points(k, 1) + moved[3 * k + 1], 0});
    pressure[k] = dual_of[k] < 0 ? 0 : lambda[dual_of[k]];
    shear[k] = dual_of[k] < 0 || lambda.size() == of_dual ? 0 : lambda[of_dual + dual_of[k]];
  }
  add_gap(gap, normals, grid, ways);
  grid.of_nodes.push_back({"slip", slip, "m"});
  add_stress("pressure", pressure, false, grid);
  if (lambda.size() > of_dual) add_stress("tangential_stress", shear, false, grid);
  return grid;
}

RigidContact rigid_contact(const HalfPlane &plane) {
  const double length = std::hypot(plane.normal[0], plane.normal[1], plane.normal[2]);
  if (!(std::abs(length - 1) <= 1e-12) || plane.normal[2] != 0)
    throw bad_input("the normal of the half-plane on '" + plane.boundary + "' is (" +
                    short_number(plane.normal[0]) + ", " + short_number(plane.normal[1]) + ", " +
                    short_number(plane.normal[2]) +
                    "): give one of length 1 in the plane of x and y");
  RigidContact rigid{plane.boundary, {}, plane.friction, plane.lumped};
  rigid.facing.at = [plane](const FullMu &mu, const PlacedPoint &point, const Point &) {
    const Point n = normal_of(plane, mu);
    const double gap = plane.position(mu) - (point.y[0] - plane.pivot[0]) * n[0] -
                       (point.y[1] - plane.pivot[1]) * n[1];
    return FacedPoint{n, gap, slip_along(n, point.motion)};
  };
  rigid.facing.normal = [plane](const FullMu &mu, const Point &) { return normal_of(plane, mu); };
  rigid.facing.at_rest = plane.surface;
  rigid.facing.body_normal = plane.body_normal;
  rigid.coefficients.push_back({"position of the half-plane", plane.position});
  if (plane.tilt) rigid.coefficients.push_back({"tilt of the half-plane", plane.tilt});
  return rigid;
}

RigidContact rigid_contact(const RigidSurface &surface) {
  RigidContact rigid{surface.boundary, {}, surface.friction, surface.lumped};
  rigid.facing.at = [faced = surface.surface](const FullMu &mu, const PlacedPoint &point,
                                              const Point &displacement) {
    const SurfacePoint below =
        faced(mu, {point.y[0] + displacement[0], point.y[1] + displacement[1], point.y[2]});
    const Point n{-below.normal[0], -below.normal[1], 0};
    return FacedPoint{n, below.distance + dot(n, displacement), slip_along(n, point.motion),
                      below.curvature};
  };
  rigid.facing.at_rest = surface.at_rest;
  rigid.facing.follows_state = true;
  rigid.facing.body_normal = surface.body_normal;
  rigid.facing.along_body = bool(surface.body_normal);
  return rigid;
}

} // namespace rbvi
