#include "rbvi/contact/force_balance.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/formula.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/geometry.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/quadrature.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace rbvi {

namespace {

/// The terms of a force on the motions: itself, and at x force.
void add(const Point &at, const Point &force, double sign, Resultant &sum, Resultant &sizes) {
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t d = (c + 1) % 3, e = (c + 2) % 3;
    const double first = at[d] * force[e], second = at[e] * force[d];
    sum[c] += sign * force[c];
    sum[3 + c] += sign * (first - second);
    sizes[c] += std::abs(force[c]);
    sizes[3 + c] += std::abs(first) + std::abs(second);
  }
}

/// "(1, 2)": the forces.
std::string forces_text(const Scene &scene, const Resultant &sum) {
  std::vector<std::string> parts;
  for (int c = 0; c < scene.dim; ++c)
    parts.push_back(short_number(sum[static_cast<std::size_t>(c)]));
  return "(" + joined(parts) + ")";
}

/// Where the nodes are on the straight, mapped edges.
std::vector<Point> arms(const Scene &scene, const FullMu &mu, const InterfaceMesh &mesh) {
  std::vector<Point> result = images(scene.map, mu, mesh.points);
  for (Index e = 0; e < mesh.count(); ++e)
    for (int middle = mesh.vertices(); middle < mesh.per_entity; ++middle) {
      const auto [i, j] = simplex_edges[middle - mesh.vertices()];
      const int *nodes = mesh.nodes_of(e);
      result[nodes[middle]] = (result[nodes[i]] + result[nodes[j]]) / 2;
    }
  return result;
}

/// Puts what the solver has in place of forces that were evaluated anew, at the nodes that move.
/// Not where several nodes move as one.
void take_solved(const InterfaceMesh &mesh, const Vector &solved, Vector &forces) {
  std::set<int> seen;
  for (const int dof : mesh.dofs)
    if (dof >= 0 && !seen.insert(dof).second) return;
  for (std::size_t k = 0; k < mesh.dofs.size(); ++k)
    if (mesh.dofs[k] >= 0) forces[static_cast<Index>(k)] = solved[mesh.dofs[k]];
}

} // namespace

void TwoRoads::add_point(const Point &at, const Point &force) {
  add(at, force, 1, by_points, sizes);
}

void TwoRoads::add_node(const Point &at, const Point &force) {
  add(at, force, -1, by_nodes, sizes);
}

double TwoRoads::difference() const {
  // A component that vanishes is round-off of the others.
  const std::array scales{std::hypot(sizes[0], sizes[1], sizes[2]),
                          std::hypot(sizes[3], sizes[4], sizes[5])};
  double result = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i)
    if (const double apart = std::abs(by_points[i] - by_nodes[i]); !(apart == 0))
      result = larger(result, apart / scales[i / 3]);
  return result;
}

std::vector<TwoRoads> two_roads(const Scene &scene, ContactInterface &interface, const FullMu &mu,
                                const ContactState &state, const Vector &lambda,
                                const Vector &solved) {
  const InterfaceMesh &mesh = interface.mesh();
  const bool membrane = mesh.components == 1;
  PointForces points = interface.point_forces(mu, state, lambda);
  if (membrane) {
    ContactOperators nodal;
    interface.assemble_nodal(mu, state, lambda, nodal);
    const double onto = interface.constraint_at(mu, mesh.points.front()).direction[0];
    for (Index i = 0; i < nodal.weights.size(); ++i)
      points.push_back({0, {}, {-onto * nodal.weights[i] * lambda[i], 0, 0}});
  }
  if (points.empty()) return {};
  std::vector<TwoRoads> sides(mesh.parts.size());
  for (const auto &[part, at, force] : points)
    sides[part].add_point(at, force);
  Vector forces = interface.nodal_forces(mu, state, lambda);
  if (solved.size() > 0) take_solved(mesh, solved, forces);
  const std::vector<Point> at =
      membrane ? std::vector<Point>(mesh.points.size()) : arms(scene, mu, mesh);
  std::size_t node = 0;
  for (std::size_t part = 0; part < sides.size(); ++part)
    for (int k = 0; k < mesh.parts[part]; ++k, ++node) {
      const Index first = mesh.components * static_cast<Index>(node);
      Point force{};
      for (int c = 0; c < mesh.components; ++c)
        force[c] = forces[first + c];
      sides[part].add_node(at[node], force);
    }
  return sides;
}

TwoRoads two_roads(const NitscheLayer &layer, const FullMu &mu,
                   const std::vector<NitscheFace> &faces, const Matrix &pressures,
                   const Vector &bounds) {
  TwoRoads roads;
  const Vector slopes = terms_of(faces).weighted(&PointTerm::slope, pressures, bounds);
  Index i = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const NitscheFace &face = faces[f];
    Cell straight = layer.cells[f].cell; // whose nodes are between mapped vertices
    map_cell(layer.scene, mu, straight);
    straight.reference = straight.mapped;
    const std::vector<Point> nodes = node_points(2, layer.scene.degree, straight);
    const auto [first, second] = simplex_edges[layer.cells[f].edge];
    for (std::size_t q = 0; q < face.points.size(); ++q, ++i) {
      const NitschePoint &point = face.points[q];
      const double s = edge_quadrature[q].s, bound = bounds.size() > 0 ? bounds[i] : 0;
      roads.add_point((1 - s) * nodes[first] + s * nodes[second],
                      nitsche_force(point, pressures(i, 0), pressures(i, 1), std::max(0.0, bound)));
      NitschePoint::Row row = slopes[i] * point.normal(face.gamma);
      if (bounds.size() > 0) row += slopes[pressures.rows() + i] * point.tangential(face.gamma);
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        const auto at_node = row.segment<2>(2 * static_cast<Index>(k));
        roads.add_node(nodes[k], {at_node[0], at_node[1], 0});
      }
    }
  }
  return roads;
}

void check_forces(const Scene &scene, const Contact &contact, const FullMu &mu,
                  const ContactState &state, const Vector &lambda, const SparseMatrix *b,
                  double tolerance) {
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    ContactInterface &interface = *contact.interfaces[i];
    const Index first = contact.first_row[i], count = interface.dual().size();
    const Vector own = lambda.segment(first, count);
    // B of contact that follows the displacement may be that of the iterate before.
    const Vector solved = b == nullptr || interface.follows_state()
                              ? Vector()
                              : b->middleRows(first, count).transpose() * own;
    const std::vector<TwoRoads> sides = two_roads(scene, interface, mu, state, own, solved);
    for (std::size_t side = 0; side < sides.size(); ++side)
      if (const double apart = sides[side].difference(); !(apart <= tolerance))
        throw failure("the forces of '" + contact.names[i] + "' on the body of the boundary '" +
                      scene.contacts[i].entities.parts[side] + "' do not balance: by pressures " +
                      "and normals they are " + forces_text(scene, sides[side].by_points) +
                      ", by the equations that were solved " +
                      forces_text(scene, sides[side].by_nodes) + ", " + short_number(apart) +
                      " of their terms apart, moments counted: does each function of this contact "
                      "return the same each time that it is asked?");
  }
}

void check_forces(const NitscheLayer &layer, const FullMu &mu, const Vector &u, double tolerance) {
  const std::vector<NitscheFace> faces = nitsche_faces(layer, mu, layer.cells, u);
  const Matrix pressures = nitsche_pressures(faces, u);
  const Vector bounds = nitsche_bounds(faces, pressures);
  Outputs outputs;
  nitsche_outputs(layer, mu, faces, u, pressures, bounds, outputs);
  TwoRoads roads = two_roads(layer, mu, faces, pressures, bounds);
  if (layer.scene.axisymmetric) // the others are no rigid motions
    for (const std::size_t motion : {0U, 5U})
      roads.by_points[motion] = roads.by_nodes[motion];
  const int images = image_count(layer.scene.mirrors);
  if (outputs.horizontal_reaction) roads.by_points[0] = *outputs.horizontal_reaction / images;
  if (outputs.reaction) roads.by_points[1] = *outputs.reaction / images;
  const auto text = [&](const Resultant &sum) {
    return forces_text(layer.scene, sum) + " with the moment " + short_number(sum[5]);
  };
  if (const double apart = roads.difference(); !(apart <= tolerance))
    throw failure("the forces of contact by Nitsche's method do not balance: by outputs they are " +
                  text(roads.by_points) + ", by the equations that were solved " +
                  text(roads.by_nodes) + ", " + short_number(apart) + " of their terms apart");
}

} // namespace rbvi
