#include "rbvi/contact/interface.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/formula.hpp"
#include "rbvi/element/imposed.hpp"

#include <algorithm>

namespace rbvi {

FrictionBound ContactInterface::bound(const FullMu &) const {
  return {};
}

PointConstraint ContactInterface::constraint_at(const FullMu &, const Point &, const Point &,
                                                const Point &) const {
  throw failure("this kind of contact has no constraint at single points");
}

std::vector<Index> ContactInterface::partly_fixed() const {
  std::vector<Index> nodes;
  if (mesh_.components == 1) return nodes;
  for (std::size_t k = 0; k < dual_.vertices.size(); ++k) {
    const auto first = mesh_.dofs.begin() + dual_.vertices[k] * mesh_.components;
    if (std::any_of(first, first + mesh_.components, [](int dof) { return dof < 0; }))
      nodes.push_back(static_cast<Index>(k));
  }
  return nodes;
}

std::vector<int> ContactInterface::free_tangents() const {
  std::vector<int> free(static_cast<std::size_t>(dual_.nodes()), dual_.components - 1);
  for (const Index node : partly_fixed())
    free[node] = 0;
  return free;
}

Curvature ContactInterface::curvature(const FullMu &, const ContactState &, const Vector &) const {
  throw failure("this kind of contact has no curvature");
}

Vector ContactInterface::nodal_forces(const FullMu &, const ContactState &, const Vector &) const {
  throw failure("this kind of contact has no multipliers");
}

SparseMatrix ContactInterface::averages() const {
  throw failure("scene " + scene_.name + ": this contact is not one of nodes");
}

NodalEvaluation ContactInterface::nodal_at(const FullMu &) const {
  throw failure("scene " + scene_.name + ": this contact is not one of nodes");
}

void ContactInterface::set_constraints(const FullMu &mu, const std::vector<Point> &mapped,
                                       const ContactState &state, const WantedNodes &wanted,
                                       ContactOperators &operators) const {
  const auto rows = static_cast<Index>(dual_.vertices.size());
  SparseMatrix b(rows, mesh_.columns);
  b.reserve(rows * mesh_.components);
  operators.nodal_gap = Vector::Zero(rows);
  const Vector imposed = imposed_values(scene_, mu, mesh_.points, mesh_.imposed_by);
  for (Index i = 0; i < rows; ++i) {
    b.startVec(i);
    if (!is_wanted(wanted, i)) continue;
    const Index node = dual_.vertices[i];
    Point displacement{};
    for (int c = 0; c < mesh_.components && state.displacement.size() > 0; ++c) {
      const Index at_node = node * mesh_.components + c;
      const int dof = mesh_.dofs[at_node];
      if (dof >= 0) displacement[c] = state.displacement[dof];
      if (imposed.size() > 0) displacement[c] += imposed[at_node];
    }
    const PointConstraint at = constraint_at(mu, mesh_.points[node], mapped[node], displacement);
    operators.nodal_gap[i] = at.gap;
    for (int c = 0; c < mesh_.components; ++c) {
      const Index at_node = node * mesh_.components + c;
      const double direction = at.direction[c];
      if (const int dof = mesh_.dofs[at_node]; dof >= 0)
        b.insertBackByOuterInnerUnordered(i, dof) = direction;
      if (imposed.size() > 0) operators.nodal_gap[i] -= direction * imposed[at_node];
    }
  }
  b.finalize();
  operators.nodal_b = std::move(b);
}

Vector at_columns(const InterfaceMesh &mesh, const Vector &nodal) {
  Vector result = Vector::Zero(mesh.columns);
  for (std::size_t i = 0; i < mesh.dofs.size(); ++i)
    if (mesh.dofs[i] >= 0) result[mesh.dofs[i]] = nodal[static_cast<Index>(i)];
  return result;
}

Matrix mapped_points(const Scene &scene, const FullMu &mu, const std::vector<Point> &points) {
  Matrix result(static_cast<Index>(points.size()), scene.dim);
  const std::vector<Point> mapped = images(scene.map, mu, points);
  for (Index i = 0; i < result.rows(); ++i)
    for (Index k = 0; k < result.cols(); ++k)
      result(i, k) = mapped[i][k];
  return result;
}

void pressure_outputs(const Vector &images, const Vector &weights, const Vector &lambda,
                      double least, Outputs &outputs) {
  const auto active = lambda.array() > least;
  outputs.normal_force = weights.dot(lambda);
  outputs.contact_measure = active.select(weights, 0).sum();
  outputs.contact_nodes = active.select(images, 0).sum();
  outputs.free_nodes = active.select(0, images).sum();
  outputs.peak_pressure = lambda.maxCoeff();
}

void add_gap(const Vector &gap, const std::vector<Point> &normals, Grid &grid,
             const std::vector<Point> &ways) {
  Vector normal(3 * gap.size()), way(3 * gap.size());
  for (Index i = 0; i < gap.size(); ++i)
    for (Index c = 0; c < 3; ++c) {
      normal[3 * i + c] = normals[i][c];
      way[3 * i + c] = ways.empty() ? gap[i] * normals[i][c] : ways[i][c];
    }
  grid.of_nodes.push_back({"gap", gap, "m"});
  grid.of_nodes.push_back({"normal", normal});
  grid.of_nodes.push_back({"to_partner", way, "m"});
}

Vector moved_nodes(const Scene &scene, const FullMu &mu, const InterfaceMesh &mesh,
                   const Vector &nodal) {
  Vector moved = Vector::Zero(3 * mesh.nodes());
  for (Index i = 0; i < mesh.nodes(); ++i) {
    const Point motion = scene.motion ? scene.motion(mu, mesh.points[i]) : Point{};
    for (Index c = 0; c < mesh.components; ++c)
      moved[3 * i + c] = motion[c] + nodal[i * mesh.components + c];
  }
  return moved;
}

} // namespace rbvi
