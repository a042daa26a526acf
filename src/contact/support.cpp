#include "rbvi/contact/support.hpp"

#include "rbvi/contact/curve.hpp"
#include "rbvi/contact/surfaces.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/facets.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/quadrature.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// A point of the boundary at rest.
struct AtRest {
  std::function<Surface> surface;
  std::function<PointMap> body_normal; ///< of contact; empty: that of the surface
  Partner partner;

  struct Faced {
    Point normal, way; ///< to the partner
  };
  Faced operator()(const FullMu &mu, const PlacedPoint &point) const {
    if (partner != Partner::closest || body_normal) {
      const Point n = body_normal ? body_normal(mu, point.x) : -1.0 * surface(mu, point.y).normal;
      return {n, to_partner(surface, partner, mu, point.y, n)};
    }
    const SurfacePoint next = surface(mu, point.y);
    return {-1.0 * next.normal, -next.distance * next.normal};
  }
};

Facing faced_at_rest(const RigidSurface &of) {
  const AtRest faced{of.surface, of.along_body ? of.body_normal : std::function<PointMap>(),
                     of.partner};
  Facing facing;
  facing.at = [faced](const FullMu &mu, const PlacedPoint &point, const Point &) {
    const auto [n, way] = faced(mu, point);
    return FacedPoint{n, dot(way, n) - dot(point.motion, n), slip_along(n, point.motion)};
  };
  facing.normal = faced.body_normal;
  if (is_plane(of.surface) && !of.along_body && of.partner == Partner::closest)
    return facing; // its condition is exact wherever the body is
  facing.partner = [faced](const FullMu &mu, const PlacedPoint &point) {
    return point.y + faced(mu, point).way;
  };
  facing.distance = [surface = of.surface](const FullMu &mu, const PlacedPoint &point,
                                           const Point &moved) {
    return surface(mu, point.y + moved).distance;
  };
  return facing;
}

Facing faced_where_it_is(const RigidSurface &of) {
  Facing facing;
  facing.at = [surface = of.surface](const FullMu &mu, const PlacedPoint &point,
                                     const Point &displacement) {
    const SurfacePoint next = surface(mu, point.y + point.motion + displacement);
    const Point n = -1.0 * next.normal;
    return FacedPoint{n, next.distance + dot(n, displacement), slip_along(n, point.motion),
                      next.curvature};
  };
  facing.follows_state = true;
  facing.along_body = of.along_body;
  return facing;
}

/// A quadrature point of every facet with the values of its Lagrange functions.
struct FacetPlace {
  std::array<double, 4> barycentric;
  double weight; ///< they sum to 1
  std::vector<double> values;
};

std::vector<FacetPlace> facet_places(int dim, int degree) {
  std::vector<FacetPlace> places;
  if (dim == 2)
    for (const auto &[s, weight] : edge_quadrature)
      places.push_back({{1 - s, s, 0, 0}, weight, {}});
  else
    for (const auto &[barycentric, weight] : radon_quadrature())
      places.push_back({barycentric, weight, {}});
  for (FacetPlace &place : places) {
    place.values.resize(static_cast<std::size_t>(nodes_per_cell(dim - 1, degree)));
    lagrange_values(dim - 1, degree, place.barycentric, place.values);
  }
  return places;
}

} // namespace

RigidContact rigid_contact(const Support &support) {
  RigidContact rigid{support.boundary, {}, support.friction, support.lumped};
  rigid.facing.at = [normal = support.normal,
                     gap = support.gap](const FullMu &mu, const PlacedPoint &point, const Point &) {
    const Point n = normal(mu, point.x);
    return FacedPoint{n, gap(mu, point.x) - dot(point.motion, n), slip_along(n, point.motion)};
  };
  rigid.facing.normal = support.normal;
  rigid.facing.body_normal = support.body_normal;
  return rigid;
}

RigidContact rigid_contact(const RigidSurface &surface) {
  if (surface.along_body && !surface.body_normal)
    throw bad_input("contact along the normal of the body needs a boundary on a circle ('curves:') "
                    "and a map that does not turn or stretch it");
  if (surface.large && surface.partner != Partner::closest)
    throw bad_input("kinematics: large measures the gap to the next point: leave out gap");
  RigidContact rigid{surface.boundary,
                     surface.large ? faced_where_it_is(surface) : faced_at_rest(surface),
                     surface.friction, surface.lumped};
  rigid.facing.at_rest = surface.at_rest;
  // Where the body is followed its stress acts on the edges (Nitsche's method).
  if (!surface.large || surface.along_body) rigid.facing.body_normal = surface.body_normal;
  return rigid;
}

Term adhesive_load(const RigidContact &rigid, const Scene &scene) {
  const auto kernel = [adhesion = rigid.friction.adhesion, facing = rigid.facing, map = scene.map,
                       turned = scene.axisymmetric, places = facet_places(scene.dim, scene.degree)](
                          const FullMu &mu, const Cell &facet, double *values) {
    const auto dim = static_cast<std::size_t>(facet.dim);
    const double size = adhesion(mu) * facet_measure(facet.dim, facet.mapped).size;
    std::fill_n(values, places.front().values.size() * dim, 0.0);
    for (const FacetPlace &place : places) {
      const Point x = point_at(facet.reference, place.barycentric, facet.dim),
                  y = facing.at_rest ? facing.at_rest(mu, x) : map(mu, x),
                  n = facing.at(mu, {x, {}, y}, {}).normal;
      const double weight =
          size * place.weight *
          circumference(turned, point_at(facet.mapped, place.barycentric, facet.dim));
      for (std::size_t k = 0; k < place.values.size() * dim; ++k)
        values[k] += weight * place.values[k / dim] * n[k % dim];
    }
  };
  return mapped_term({"", kernel, rigid.boundary});
}

double gap_error(const ContactInterface &interface, const Scene &scene, const Facing &facing,
                 const FullMu &mu, const Vector &u, const Vector &lambda) {
  if (!facing.distance) return 0;
  const std::vector<Index> &vertices = interface.dual().vertices;
  GapErrors errors(lambda.head(std::ssize(vertices)));
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Index node = vertices[k];
    const Point &x = interface.mesh().points[node];
    Point by{};
    for (Index c = 0; c < interface.mesh().components; ++c)
      by[c] = u[interface.mesh().components * node + c];
    const Point moved = by + (scene.motion ? scene.motion(mu, x) : Point{});
    const auto [normal, gap] = interface.constraint_at(mu, x);
    const double way = dot(normal, moved),
                 left = gap - normal[0] * by[0] - normal[1] * by[1] - normal[2] * by[2];
    try {
      errors.add(lambda[static_cast<Index>(k)], way, left,
                 facing.distance(mu, place(scene, facing, mu, x), moved));
    } catch (const Error &) { // nothing is faced from there
    }
  }
  return errors.largest();
}

namespace {

/// Gap and slip at the middles of edges.
void add_middles(const ContactInterface &interface, const CurveShape &shape,
                 const std::vector<int> &vertices, const FullMu &mu, const Vector &u, Grid &grid) {
  const InterfaceMesh &mesh = interface.mesh();
  const Vector moved = grid.of_cells.front().values;
  Vector gap(shape.edges()), slip(shape.edges());
  const auto of_node = [&](int node) { return Point{u[2 * node], u[2 * node + 1], 0}; };
  for (Index e = 0; e < shape.edges(); ++e) {
    const int begin = vertices[shape.ends[e][0]], end = vertices[shape.ends[e][1]];
    const Point x = (mesh.points[begin] + mesh.points[end]) / 2,
                here = mesh.degree == 2 ? of_node(middle_node(mesh, e))
                                        : (of_node(begin) + of_node(end)) / 2;
    const PointConstraint at = interface.constraint_at(mu, x, here);
    gap[e] = at.gap - dot(at.direction, here);
    slip[e] = slip_along(at.direction, {moved[3 * e], moved[3 * e + 1], 0});
  }
  grid.of_cells.push_back({"gap_middle", gap, "m"});
  grid.of_cells.push_back({"slip_middle", slip, "m"});
}

} // namespace

Grid support_fields(const ContactInterface &interface, const Scene &scene, const Facing &facing,
                    const std::vector<std::array<Index, 2>> &duals, const FullMu &mu,
                    const Vector &u, const Vector &lambda, bool whole) {
  const InterfaceMesh &mesh = interface.mesh();
  const auto [vertices, shape] = first_curve(mesh);
  std::vector<CurvePlace> places, middles;
  std::vector<int> cells, shown(vertices.size(), -1);
  std::vector<Index> dual_of; // of each place
  for (Index e = 0; e < shape.edges(); ++e) {
    if (whole) middles.push_back({e, 0.5});
    for (const std::size_t end : {0, 1}) {
      int &node = shown[shape.ends[e][end]];
      if (node < 0 || dual_of[node] != duals[e][end]) { // a pressure may end at a vertex
        node = static_cast<int>(std::ssize(places));
        places.push_back({e, static_cast<double>(end)});
        dual_of.push_back(duals[e][end]);
      }
      cells.push_back(node);
    }
  }
  Grid grid = polyline(scene, mu, mesh, places, std::move(cells), u, middles);
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
      ways.push_back(
          facing.partner(mu, place(scene, facing, mu, x)) -
          Point{grid.points(k, 0) + moved[3 * k], grid.points(k, 1) + moved[3 * k + 1], 0});
    pressure[k] = dual_of[k] < 0 ? 0 : lambda[dual_of[k]];
    shear[k] = dual_of[k] < 0 || lambda.size() == of_dual ? 0 : lambda[of_dual + dual_of[k]];
  }
  add_gap(gap, normals, grid, ways);
  grid.of_nodes.push_back({"slip", slip, "m"});
  add_stress("pressure", pressure, false, grid);
  if (lambda.size() > of_dual) add_stress("tangential_stress", shear, false, grid);
  if (whole) add_middles(interface, shape, vertices, mu, u, grid);
  return grid;
}

} // namespace rbvi
