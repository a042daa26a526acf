// Contact of a curve with something rigid by multipliers: integrals over its edges, which ask at
// each of their points what it faces, and the outputs.
#include "rbvi/contact/contact_area.hpp"
#include "rbvi/contact/entity_sum.hpp"
#include "rbvi/contact/support.hpp"
#include "rbvi/contact/support_outputs.hpp"
#include "rbvi/core/error.hpp"
#include "surface_support.hpp"
#include "trace_points.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

double length_of(const Cell &edge) {
  return edge_length(edge.mapped[0], edge.mapped[1]);
}

/// n . the normal out of the body, as long as the mapped edge.
double outwards(const Cell &edge, const Point &n) {
  const Point &begin = edge.mapped[0], &end = edge.mapped[1];
  return n[0] * (end[1] - begin[1]) - n[1] * (end[0] - begin[0]);
}

class CurveSupport : public EntitySum {
public:
  /// Throws bad_input unless the mesh is a curve with displacements of two components.
  CurveSupport(const Scene &scene, InterfaceMesh mesh, const RigidContact &rigid);

  void integrate(const FullMu &mu, const Cell &edge, EntityValues &values) const override;
  void weigh(const FullMu &, const Cell &edge, EntityValues &values) const override {
    const auto [begin, end] = hat_weights(edge.mapped[0], edge.mapped[1], scene_.axisymmetric);
    values.weights << begin, end;
  }
  FrictionBound bound(const FullMu &mu) const override { return friction_bound(friction_, mu); }
  PointConstraint constraint_at(const FullMu &mu, const Point &x, const Point &,
                                const Point &displacement) const override;
  PointForces point_forces(const FullMu &mu, const ContactState &state,
                           const Vector &lambda) const override;
  void outputs(const FullMu &mu, const ContactOperators &operators, const Vector &lambda,
               double least, Outputs &outputs) const override;
  double gap_error(const FullMu &mu, const Vector &u, const Vector &lambda) const override {
    return rbvi::gap_error(*this, scene_, facing_, mu, u, lambda);
  }
  Grid fields(const FullMu &mu, const Vector &u, const Vector &lambda, bool whole) override;

  const EntitySum *entity_sum() const override { return follows_state() ? nullptr : this; }
  bool follows_state() const override { return facing_.follows_state; }
  bool has_curvature() const override { return follows_state() && !facing_.along_body; }
  Curvature curvature(const FullMu &mu, const ContactState &state,
                      const Vector &lambda) const override;
  bool is_nodal() const override { return has_curvature() && mesh_.imposed_by.empty(); }
  SparseMatrix averages() const override;
  NodalEvaluation nodal_at(const FullMu &mu) const override;

private:
  struct AtRest {
    double measure;
    PlacedPoint point;
  };
  /// The part of an integral over the mapped edge that a point stands for.
  double measure(const Cell &edge, const TracePoint &at) const {
    return at.weight * length_of(edge) *
           circumference(scene_.axisymmetric,
                         at.eta[0] * edge.mapped[0] + at.eta[1] * edge.mapped[1]);
  }
  Cell mapped_edge(const FullMu &mu, Index edge) const;
  Point sum(const Cell &edge, const std::array<double, 3> &coefficients) const;
  Point deformed_normal(const FullMu &mu, const Cell &edge, const TracePoint &at,
                        const Point &x) const;
  FacedPoint faced_at(const FullMu &mu, const Cell &edge, const TracePoint &at) const;
  double tangential_force(const Matrix &mapped, const Vector &lambda) const;
  void add_edge(const FullMu &mu, Index edge, const std::vector<AtRest> &rest, const Vector &state,
                const Vector &x, NodalCondition &condition) const;

  CurveShape shape_; ///< first: it refuses a mesh that is no curve
  Facing facing_;
  Friction friction_;
  std::vector<TracePoint> points_;
  Middle middle_ = Middle::none;
  Vector images_; ///< of the dual nodes
};

CurveSupport::CurveSupport(const Scene &scene, InterfaceMesh interface_mesh,
                           const RigidContact &rigid)
    : EntitySum(scene, std::move(interface_mesh), 1),
      shape_(curve_shape(mesh_, 0, "support's boundary")), facing_(on_arcs(rigid.facing, mesh_)),
      friction_(rigid.friction), points_(trace_points(mesh_.degree, rigid.lumped)) {
  if (mesh_.components != 2)
    throw bad_input("scene " + scene.name +
                    ": a rigid support is for displacements of two components");
  check_body_normal(scene, facing_, mesh_);
  const int copies = friction_.law == FrictionLaw::none ? 1 : 2;
  set_dual(shape_.vertices(), copies, rigid.lumped,
           linear_gram(mesh_.points, shape_, copies, scene.axisymmetric));
  images_ = image_counts(scene.mirrors, dual_.points);
  middle_ = middle_of(scene.mirrors, vertices_of(mesh_, shape_), is_one_open_piece(shape_));
}

Cell CurveSupport::mapped_edge(const FullMu &mu, Index e) const {
  Cell edge = reference_entity(e);
  for (std::size_t i = 0; i < 2; ++i)
    edge.mapped[i] = scene_.map(mu, edge.reference[i]);
  return edge;
}

/// Of the displacement at its nodes.
Point CurveSupport::sum(const Cell &edge, const std::array<double, 3> &coefficients) const {
  Point result{};
  for (int k = 0; edge.displacement != nullptr && k < 2 * mesh_.per_entity; ++k)
    result[k % 2] += coefficients[k / 2] * edge.displacement[k];
  return result;
}

/// The tangent at rest is as long as the edge; the slope of the displacement is added to it.
Point CurveSupport::deformed_normal(const FullMu &mu, const Cell &edge, const TracePoint &at,
                                    const Point &x) const {
  const Point rest = facing_.body_normal(mu, x), slope = sum(edge, edge_slopes(mesh_.degree, at.s));
  const double whole = length_of(edge);
  const Point tangent{slope[0] - whole * rest[1], slope[1] + whole * rest[0], 0};
  const double norm = std::hypot(tangent[0], tangent[1]);
  if (!(norm > 1e-3 * whole)) throw failure("an edge of the contact curve has lost its length");
  return {tangent[1] / norm, -tangent[0] / norm, 0};
}

/// At a quadrature point of an edge, which has its displacement.
FacedPoint CurveSupport::faced_at(const FullMu &mu, const Cell &edge, const TracePoint &at) const {
  const PlacedPoint point = place(scene_, facing_, mu, point_on(edge, at));
  const Point displacement = sum(edge, at.phi);
  if (!facing_.along_body) return facing_.at(mu, point, displacement);
  const FacedPoint here = facing_.at(mu, point, displacement);
  const Point n = deformed_normal(mu, edge, at, point.x);
  const double distance = here.gap - dot(here.normal, displacement);
  return {n, dot(n, here.normal) * distance + dot(n, displacement), slip_along(n, point.motion)};
}

PointConstraint CurveSupport::constraint_at(const FullMu &mu, const Point &x, const Point &,
                                            const Point &displacement) const {
  const FacedPoint at = facing_.at(mu, place(scene_, facing_, mu, x), displacement);
  return {at.normal, at.gap};
}

void CurveSupport::integrate(const FullMu &mu, const Cell &edge, EntityValues &values) const {
  const Index columns = values.b.cols(), nodes = columns / 2;
  const bool friction = values.b.rows() > 2;
  values.b.setZero();
  values.g.setZero();
  for (const TracePoint &at : points_) {
    const double weight = measure(edge, at);
    const FacedPoint here = faced_at(mu, edge, at);
    for (Index a = 0; a < 2; ++a) {
      const double eta = weight * at.eta[a];
      for (Index node = 0; node < nodes; ++node)
        for (Index c = 0; c < 2; ++c)
          values.b(a, 2 * node + c) += eta * at.phi[node] * here.normal[c];
      values.g[a] += here.gap * eta;
      if (friction) values.g[2 + a] -= here.slip * eta;
    }
  }
  for (Index a = 0; a < 2 && friction; ++a) // v . tau is v . n with v turned: (v_y, -v_x) . n
    for (Index k = 0; k < columns; k += 2) {
      values.b(2 + a, k) = -values.b(a, k + 1);
      values.b(2 + a, k + 1) = values.b(a, k);
    }
}

/// Of the edges with multipliers that are not zero.
PointForces CurveSupport::point_forces(const FullMu &mu, const ContactState &state,
                                       const Vector &lambda) const {
  PointForces forces;
  std::vector<double> displacement;
  for (Index e = 0; e < mesh_.count(); ++e) {
    const std::span<const int> rows = rows_of(e);
    if (std::ranges::none_of(rows, [&](Index row) { return row >= 0 && lambda[row] != 0; }))
      continue;
    Cell edge = mapped_edge(mu, e);
    if (follows_state()) set_displacement(mu, e, state, edge, displacement);
    const auto sum_of = [&](const TracePoint &at, std::size_t first) {
      double sum = 0;
      for (std::size_t a = 0; a < 2 && first < rows.size(); ++a)
        if (rows[first + a] >= 0) sum += at.eta[a] * lambda[rows[first + a]];
      return sum;
    };
    for (const TracePoint &at : points_) {
      const Point n = facing_.normal ? facing_.normal(mu, curve_point(facing_, point_on(edge, at)))
                                     : faced_at(mu, edge, at).normal;
      const double pressure = sum_of(at, 0), shear = sum_of(at, 2);
      // Tresca's traction acts without pressure, too.
      if (pressure > 0) check_pressed_side(outwards(edge, n), point_on(edge, at));
      const Point traction = pressure * n + shear * Point{-n[1], n[0], 0};
      forces.push_back({0, at.eta[0] * edge.mapped[0] + at.eta[1] * edge.mapped[1],
                        -measure(edge, at) * traction});
    }
  }
  return forces;
}

double CurveSupport::tangential_force(const Matrix &mapped, const Vector &lambda) const {
  double sum = 0;
  for (Index e = 0; e < mesh_.count() && dual_.components == 2; ++e) {
    const std::span<const int> rows = rows_of(e);
    const auto shear = [&](std::size_t a) { return rows[2 + a] < 0 ? 0 : lambda[rows[2 + a]]; };
    const std::array<double, 2> ends{shear(0), shear(1)};
    if (ends == std::array<double, 2>{}) continue;
    const auto vertex = [&](int i) {
      const int node = mesh_.nodes_of(e)[i];
      return Point{mapped(node, 0), mapped(node, 1), 0};
    };
    sum += integral_of_magnitude(hat_weights(vertex(0), vertex(1), scene_.axisymmetric), ends);
  }
  return sum;
}

Grid CurveSupport::fields(const FullMu &mu, const Vector &u, const Vector &lambda, bool whole) {
  std::vector<std::array<Index, 2>> duals;
  for (Index e = 0; e < mesh_.count(); ++e) {
    const std::span<const int> rows = rows_of(e);
    const std::size_t first = mesh_.nodes_of(e)[0] == shape_.ends[e][0] ? 0 : 1;
    duals.push_back({rows[first], rows[1 - first]});
  }
  return support_fields(*this, scene_, facing_, duals, mu, u, lambda, whole);
}

void CurveSupport::outputs(const FullMu &mu, const ContactOperators &operators,
                           const Vector &lambda, double, Outputs &outputs) const {
  const Matrix mapped = mapped_points(scene_, mu, vertices_of(mesh_, shape_));
  Point force{};
  for (const PointForce &at : point_forces(mu, operators.state, lambda))
    force = force + at.force;
  const Vector arc = arc_lengths(mapped), s = from_middle(middle_, arc, arc[arc.size() - 1]);
  support_outputs({lambda, operators.weights, force, bound(mu), tangential_force(mapped, lambda),
                   images_, middle_, s.size() > 0 ? Vector(s(dual_.vertices)) : s},
                  outputs);
  if (scene_.axisymmetric) drop_plane_outputs(outputs);
  for (std::size_t k = 0; k < shape_.pieces.size(); ++k) {
    const CurveChain &piece = shape_.pieces[k];
    const auto carries = [&](Index vertex, Index step) { // the next one that has a multiplier
      const Index end = piece.first_vertex + piece.vertices();
      for (; vertex >= piece.first_vertex && vertex < end; vertex += step)
        if (const Index dual = dual_of_vertex()[vertex]; dual >= 0) return lambda[dual] > 0;
      return false;
    };
    const auto [first, last] = mesh_.closed(k);
    if (first && last) continue;
    const int ends = (!first && carries(piece.first_vertex, 1)) +
                     (!last && carries(piece.first_vertex + piece.vertices() - 1, -1));
    outputs.ends_in_contact =
        outputs.ends_in_contact.value_or(0) + ends * image_count(scene_.mirrors);
  }
}

Curvature CurveSupport::curvature(const FullMu &mu, const ContactState &state,
                                  const Vector &lambda) const {
  std::vector<Eigen::Triplet<double>> along_tau;
  std::vector<double> weights, displacement;
  for (Index e = 0; e < mesh_.count(); ++e) {
    const std::span<const int> dual = rows_of(e);
    const auto pressure = [&](std::size_t a) { return dual[a] < 0 ? 0 : lambda[dual[a]]; };
    if (pressure(0) == 0 && pressure(1) == 0) continue;
    Cell edge = mapped_edge(mu, e);
    set_displacement(mu, e, state, edge, displacement);
    const std::vector<Index> columns = columns_of(e);
    for (const TracePoint &at : points_) {
      const FacedPoint here = faced_at(mu, edge, at);
      const Point tau{-here.normal[1], here.normal[0], 0};
      for (std::size_t k = 0; k < columns.size(); ++k)
        if (columns[k] >= 0)
          along_tau.emplace_back(std::ssize(weights), columns[k], at.phi[k / 2] * tau[k % 2]);
      weights.push_back(measure(edge, at) * here.curvature *
                        (at.eta[0] * pressure(0) + at.eta[1] * pressure(1)) / 2);
    }
  }
  Curvature result{SparseMatrix(std::ssize(weights), mesh_.columns), {}};
  result.s.setFromTriplets(along_tau.begin(), along_tau.end());
  result.e = Eigen::Map<const Vector>(weights.data(), result.s.rows()).asDiagonal() * result.s;
  return result;
}

/// On the reference curve.
SparseMatrix CurveSupport::averages() const {
  std::vector<Eigen::Triplet<double>> entries;
  Vector weights = Vector::Zero(dual_.nodes());
  for (Index e = 0; e < mesh_.count(); ++e) {
    const std::vector<Index> columns = columns_of(e);
    const std::span<const int> rows = rows_of(e);
    Cell edge = reference_entity(e);
    edge.mapped = edge.reference;
    for (const TracePoint &at : points_)
      for (std::size_t a = 0; a < 2; ++a) {
        if (rows[a] < 0) continue;
        const double eta = measure(edge, at) * at.eta[a];
        weights[rows[a]] += eta;
        for (std::size_t k = 0; k < columns.size(); ++k)
          if (columns[k] >= 0)
            entries.emplace_back(2 * rows[a] + static_cast<Index>(k % 2), columns[k],
                                 eta * at.phi[k / 2]);
      }
  }
  SparseMatrix result(2 * dual_.nodes(), mesh_.columns);
  result.setFromTriplets(entries.begin(), entries.end());
  for (Index row = 0; row < result.rows(); ++row)
    result.row(row) /= weights[row / 2];
  return result;
}

void CurveSupport::add_edge(const FullMu &mu, Index e, const std::vector<AtRest> &rest,
                            const Vector &state, const Vector &x, NodalCondition &condition) const {
  const std::span<const int> dual = rows_of(e);
  const int *nodes = mesh_.nodes_of(e);
  const bool friction = dual_.components == 2;
  Eigen::Matrix<double, 2, 3> u = Eigen::Matrix<double, 2, 3>::Zero();
  std::array<double, 6> load{};
  const auto dof = [&](int k) { return mesh_.dofs[2 * nodes[k / 2] + k % 2]; };
  const int dofs = 2 * mesh_.per_entity;
  for (int k = 0; k < dofs; ++k)
    if (const int column = dof(k); column >= 0) u(k % 2, k / 2) = state[column];
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const TracePoint &at = points_[i];
    const Eigen::Vector2d moved = u * Eigen::Vector3d::Map(at.phi.data());
    const Point displacement{moved[0], moved[1], 0};
    const FacedPoint here = facing_.at(mu, rest[i].point, displacement);
    const Point &n = here.normal;
    const double distance = here.gap - dot(n, displacement),
                 slip = here.slip + slip_along(n, displacement);
    double pressure = 0, shear = 0;
    for (std::size_t a = 0; a < 2; ++a) {
      const double eta = rest[i].measure * at.eta[a];
      condition.w[dual[a]] += eta * distance;
      condition.normal(0, dual[a]) += eta * n[0];
      condition.normal(1, dual[a]) += eta * n[1];
      pressure += at.eta[a] * x[dual[a]];
      if (!friction) continue;
      condition.w[dual[2 + a]] -= eta * slip;
      shear += at.eta[a] * x[dual[2 + a]];
    }
    if (pressure == 0 && shear == 0) continue;
    const double weight = rest[i].measure;
    for (std::size_t a = 0; a < 2; ++a)
      condition.rotation[dual[a]] += weight * at.eta[a] * pressure * here.curvature;
    const std::array<double, 2> traction{weight * (pressure * n[0] - shear * n[1]),
                                         weight * (pressure * n[1] + shear * n[0])};
    for (std::size_t k = 0; k < static_cast<std::size_t>(dofs); ++k)
      load[k] += at.phi[k / 2] * traction[k % 2];
  }
  for (int k = 0; k < dofs; ++k)
    if (const int column = dof(k); column >= 0) condition.load[column] += load[k];
}

NodalEvaluation CurveSupport::nodal_at(const FullMu &mu) const {
  return [this, mu, rest = std::vector<std::vector<AtRest>>(mesh_.count())](
             const Vector &state, const Vector &x, const std::vector<bool> &near,
             NodalCondition &condition) mutable {
    condition.w.setZero(dual_.size());
    condition.load.setZero(mesh_.columns);
    condition.normal.setZero(2, dual_.nodes());
    condition.rotation.setZero(dual_.nodes());
    for (Index e = 0; e < mesh_.count(); ++e) {
      const std::span<const int> dual = rows_of(e);
      if (dual[0] < 0 || !(is_wanted(near, dual[0]) || is_wanted(near, dual[1]))) continue;
      if (rest[e].empty()) {
        const Cell cell = mapped_edge(mu, e);
        for (const TracePoint &at : points_)
          rest[e].push_back({measure(cell, at), place(scene_, facing_, mu, point_on(cell, at))});
      }
      add_edge(mu, e, rest[e], state, x, condition);
    }
  };
}

} // namespace

ContactRecipe by_multipliers(const RigidContact &rigid) {
  ContactRecipe recipe;
  recipe.entities = {InterfaceEntities::Kind::facets, {rigid.boundary}, {}, rigid.curved};
  add_friction(rigid.friction, recipe);
  recipe.follows_state = rigid.facing.follows_state;
  recipe.separable = !recipe.follows_state;
  recipe.nodal = rigid.lumped && recipe.separable;
  recipe.keeps_nodes = true;
  recipe.make = [rigid](const Scene &scene,
                        InterfaceMesh mesh) -> std::unique_ptr<ContactInterface> {
    if (scene.dim == 3) return surface_support(scene, std::move(mesh), rigid);
    return std::make_unique<CurveSupport>(scene, std::move(mesh), rigid);
  };
  return recipe;
}

} // namespace rbvi
