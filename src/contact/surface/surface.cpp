#include "rbvi/contact/surface/surface.hpp"

#include "rbvi/contact/support/curve_support.hpp"
#include "rbvi/core/error.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// Where the point is now.
Point moved(const Scene &scene, const RigidSurface &surface, const FullMu &mu, const Point &x,
            const Point &displacement) {
  Point y = surface.at_rest ? surface.at_rest(mu, x) : scene.map(mu, x);
  const Point motion = scene.motion ? scene.motion(mu, x) : Point{};
  for (std::size_t c = 0; c < 2; ++c)
    y[c] += motion[c] + displacement[c];
  return y;
}

/// The condition along n, linearised.
SupportPoint facing(const Scene &scene, const FullMu &mu, const Point &x, const SurfacePoint &at,
                    const Point &n, const Point &state) {
  const double towards = -(n[0] * at.normal[0] + n[1] * at.normal[1]);
  SupportPoint point{n, towards * at.distance + n[0] * state[0] + n[1] * state[1], 0, at.curvature};
  if (!scene.motion) return point;
  const Point motion = scene.motion(mu, x);
  point.slip = motion[1] * n[0] - motion[0] * n[1];
  return point;
}

/// Derivatives of the displacement's functions on an edge by s: vertices, middle.
std::array<double, 3> slopes(int degree, double s) {
  if (degree == 1) return {-1, 1, 0};
  return {4 * s - 3, 4 * s - 1, 4 - 8 * s};
}

class SurfaceInterface : public CurveSupport {
public:
  SurfaceInterface(const Scene &scene, InterfaceMesh interface_mesh, RigidSurface surface)
      : CurveSupport(scene, std::move(interface_mesh), surface.friction, surface.lumped),
        surface_(std::move(surface)) {
    find_side();
  }

  bool follows_state() const override { return true; }
  const EntitySum *entity_sum() const override { return nullptr; }
  bool has_curvature() const override { return !surface_.body_normal; }
  Curvature curvature(const FullMu &mu, const ContactState &state,
                      const Vector &lambda) const override;
  bool is_nodal() const override { return !surface_.body_normal && mesh_.imposed_by.empty(); }
  SparseMatrix averages() const override;
  NodalEvaluation nodal_at(const FullMu &mu) const override;
  PointConstraint constraint_at(const FullMu &mu, const Point &x, const Point &,
                                const Point &displacement) const override {
    const SupportPoint at = surface_point(scene_, surface_, mu, x, displacement);
    return {at.normal, at.gap};
  }

protected:
  SupportPoint support_at(const FullMu &mu, const Cell &edge, const TracePoint &at,
                          const Point &x) const override;
  Point normal_at(const FullMu &mu, const Cell &edge, const TracePoint &at,
                  const Point &x) const override {
    return support_at(mu, edge, at, x).normal;
  }

private:
  struct AtRest {
    double length = 0;         ///< of the edge, mapped
    std::vector<Point> points; ///< of quadrature
    std::vector<Point> motion; ///< there
  };
  AtRest at_rest(const FullMu &mu, Index edge) const;
  void add_edge(const FullMu &mu, Index edge, const AtRest &rest, const Vector &state,
                const Vector &x, NodalCondition &condition) const;
  Point displacement_at(const Cell &edge, const TracePoint &at) const;
  Point body_normal(const FullMu &mu, const Cell &edge, const TracePoint &at, const Point &x) const;

  RigidSurface surface_;
};

Point SurfaceInterface::displacement_at(const Cell &edge, const TracePoint &at) const {
  Point result{};
  for (int node = 0; node < mesh_.per_entity && edge.displacement != nullptr; ++node)
    for (std::size_t c = 0; c < 2; ++c)
      result[c] += at.phi[node] * edge.displacement[2 * static_cast<std::size_t>(node) + c];
  return result;
}

/// Of the deformed curve: the tangent at rest, as long as the edge, and the slope of the
/// displacement.
Point SurfaceInterface::body_normal(const FullMu &mu, const Cell &edge, const TracePoint &at,
                                    const Point &x) const {
  const Point rest = surface_.body_normal(mu, x);
  const double length = length_of(edge);
  Point tangent{-length * rest[1], length * rest[0], 0};
  const std::array<double, 3> slope = slopes(mesh_.degree, at.s);
  for (int node = 0; node < mesh_.per_entity && edge.displacement != nullptr; ++node)
    for (std::size_t c = 0; c < 2; ++c)
      tangent[c] += slope[node] * edge.displacement[2 * static_cast<std::size_t>(node) + c];
  const double norm = std::hypot(tangent[0], tangent[1]);
  if (!(norm > 1e-3 * length)) throw failure("an edge of the contact curve has lost its length");
  return {tangent[1] / norm, -tangent[0] / norm, 0};
}

SupportPoint SurfaceInterface::support_at(const FullMu &mu, const Cell &edge, const TracePoint &at,
                                          const Point &x) const {
  const Point displacement = displacement_at(edge, at);
  if (!surface_.body_normal) return surface_point(scene_, surface_, mu, x, displacement);
  const SurfacePoint below = surface_.surface(mu, moved(scene_, surface_, mu, x, displacement));
  return facing(scene_, mu, x, below, body_normal(mu, edge, at, x), displacement);
}

Curvature SurfaceInterface::curvature(const FullMu &mu, const ContactState &state,
                                      const Vector &lambda) const {
  const Index rows = mesh_.count() * static_cast<Index>(points().size());
  const Index per_row = mesh_.per_entity * 2;
  Curvature result{SparseMatrix(rows, mesh_.columns), SparseMatrix(rows, mesh_.columns)};
  result.s.reserve(Eigen::VectorXi::Constant(rows, static_cast<int>(per_row)));
  result.e.reserve(Eigen::VectorXi::Constant(rows, static_cast<int>(per_row)));
  std::vector<double> displacement;
  Index row = 0;
  for (Index e = 0; e < mesh_.count(); ++e) {
    const std::span<const int> dual = rows_of(e);
    const auto pressure = [&](std::size_t a) { return dual[a] < 0 ? 0 : lambda[dual[a]]; };
    if (pressure(0) == 0 && pressure(1) == 0) continue;
    Cell edge = reference_entity(e);
    for (std::size_t i = 0; i < 2; ++i)
      edge.mapped[i] = scene_.map(mu, edge.reference[i]);
    set_displacement(mu, e, state, edge, displacement);
    const std::vector<Index> columns = columns_of(e);
    for (const TracePoint &at : points()) {
      const Point x = point_on(edge, at);
      const SurfacePoint below =
          surface_.surface(mu, moved(scene_, surface_, mu, x, displacement_at(edge, at)));
      const double weight = at.weight * length_of(edge) * below.curvature *
                            (at.eta[0] * pressure(0) + at.eta[1] * pressure(1)) / 2;
      const Point tau{below.normal[1], -below.normal[0], 0};
      for (std::size_t k = 0; k < columns.size(); ++k) {
        if (columns[k] < 0) continue;
        const double value = at.phi[k / 2] * tau[k % 2];
        result.s.insert(row, columns[k]) = value;
        result.e.insert(row, columns[k]) = weight * value;
      }
      ++row;
    }
  }
  result.s.conservativeResize(row, mesh_.columns);
  result.e.conservativeResize(row, mesh_.columns);
  return result;
}

/// On the reference curve.
SparseMatrix SurfaceInterface::averages() const {
  std::vector<Eigen::Triplet<double>> entries;
  Vector weights = Vector::Zero(dual_.nodes());
  for (Index e = 0; e < mesh_.count(); ++e) {
    const std::vector<Index> columns = columns_of(e);
    const std::span<const int> rows = rows_of(e);
    Cell edge = reference_entity(e);
    edge.mapped = edge.reference;
    for (const TracePoint &at : points())
      for (std::size_t a = 0; a < 2; ++a) {
        if (rows[a] < 0) continue;
        const double eta = at.weight * length_of(edge) * at.eta[a];
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

SurfaceInterface::AtRest SurfaceInterface::at_rest(const FullMu &mu, Index e) const {
  Cell edge = reference_entity(e);
  for (std::size_t i = 0; i < 2; ++i)
    edge.mapped[i] = scene_.map(mu, edge.reference[i]);
  AtRest rest{length_of(edge), {}, {}};
  for (const TracePoint &at : points()) {
    const Point x = point_on(edge, at);
    rest.points.push_back(moved(scene_, surface_, mu, x, {}));
    rest.motion.push_back(scene_.motion ? scene_.motion(mu, x) : Point{});
  }
  return rest;
}

void SurfaceInterface::add_edge(const FullMu &mu, Index e, const AtRest &rest, const Vector &state,
                                const Vector &x, NodalCondition &condition) const {
  const std::span<const int> dual = rows_of(e);
  const int *nodes = mesh_.nodes_of(e);
  const bool friction = dual_.components == 2;
  std::array<double, 6> u{}, load{};
  const auto dof = [&](int k) { return mesh_.dofs[2 * nodes[k / 2] + k % 2]; };
  const int dofs = 2 * mesh_.per_entity;
  for (int k = 0; k < dofs; ++k)
    if (const int column = dof(k); column >= 0) u[k] = state[column];
  for (std::size_t i = 0; i < points().size(); ++i) {
    const TracePoint &at = points()[i];
    Point displacement{};
    for (std::size_t k = 0; k < static_cast<std::size_t>(dofs); ++k)
      displacement[k % 2] += at.phi[k / 2] * u[k];
    const Point y{rest.points[i][0] + displacement[0], rest.points[i][1] + displacement[1], 0};
    const SurfacePoint below = surface_.surface(mu, y);
    const double n_x = -below.normal[0], n_y = -below.normal[1];
    const double slip =
        n_x * (displacement[1] + rest.motion[i][1]) - n_y * (displacement[0] + rest.motion[i][0]);
    double pressure = 0, shear = 0;
    for (std::size_t a = 0; a < 2; ++a) {
      const double eta = at.weight * rest.length * at.eta[a];
      condition.w[dual[a]] += eta * below.distance;
      condition.normal(0, dual[a]) += eta * n_x;
      condition.normal(1, dual[a]) += eta * n_y;
      pressure += at.eta[a] * x[dual[a]];
      if (!friction) continue;
      condition.w[dual[2 + a]] -= eta * slip;
      shear += at.eta[a] * x[dual[2 + a]];
    }
    if (pressure == 0 && shear == 0) continue;
    const double weight = at.weight * rest.length;
    for (std::size_t a = 0; a < 2; ++a)
      condition.rotation[dual[a]] += weight * at.eta[a] * pressure * below.curvature;
    const std::array<double, 2> traction{weight * (pressure * n_x - shear * n_y),
                                         weight * (pressure * n_y + shear * n_x)};
    for (std::size_t k = 0; k < static_cast<std::size_t>(dofs); ++k)
      load[k] += at.phi[k / 2] * traction[k % 2];
  }
  for (int k = 0; k < dofs; ++k)
    if (const int column = dof(k); column >= 0) condition.load[column] += load[k];
}

NodalEvaluation SurfaceInterface::nodal_at(const FullMu &mu) const {
  return [this, mu, rest = std::vector<AtRest>(mesh_.count())](const Vector &state, const Vector &x,
                                                               const std::vector<bool> &near,
                                                               NodalCondition &condition) mutable {
    condition.w.setZero(dual_.size());
    condition.load.setZero(mesh_.columns);
    condition.normal.setZero(2, dual_.nodes());
    condition.rotation.setZero(dual_.nodes());
    for (Index e = 0; e < mesh_.count(); ++e) {
      const std::span<const int> dual = rows_of(e);
      if (dual[0] < 0 || !(is_wanted(near, dual[0]) || is_wanted(near, dual[1]))) continue;
      AtRest &edge = rest[e];
      if (edge.points.empty()) edge = at_rest(mu, e);
      add_edge(mu, e, edge, state, x, condition);
    }
  };
}

} // namespace

SupportPoint surface_point(const Scene &scene, const RigidSurface &surface, const FullMu &mu,
                           const Point &x, const Point &displacement) {
  const SurfacePoint below = surface.surface(mu, moved(scene, surface, mu, x, displacement));
  return facing(scene, mu, x, below, {-below.normal[0], -below.normal[1], 0}, displacement);
}

Record record_of(const RigidSurface &surface) {
  Record record{"rigid_surface",
                1,
                {{"lumped", {surface.lumped ? 1.0 : 0.0}}},
                {{"boundary", surface.boundary}},
                {{"surface", surface.surface.record}}};
  if (surface.at_rest) record.parts["at_rest"] = surface.at_rest.record;
  if (surface.body_normal) record.parts["body_normal"] = surface.body_normal.record;
  add_friction(surface.friction, record);
  return record;
}

RigidSurface surface_in(const Stored &of) {
  RigidSurface surface{text(of, "boundary"), made<Surface>(part(of, "surface"))};
  if (of.record.parts.contains("at_rest")) surface.at_rest = made<PointMap>(part(of, "at_rest"));
  if (of.record.parts.contains("body_normal"))
    surface.body_normal = made<PointMap>(part(of, "body_normal"));
  surface.friction = friction_in(of);
  surface.lumped = number(of, "lumped") != 0;
  return surface;
}

ContactRecipe rigid_surface(RigidSurface surface) {
  ContactRecipe recipe;
  recipe.entities = {InterfaceEntities::Kind::curves, {surface.boundary}};
  add_friction(surface.friction, recipe);
  recipe.separable = false;
  recipe.follows_state = true;
  recipe.keeps_nodes = true;
  recipe.make = [surface](const Scene &scene, InterfaceMesh mesh) {
    return std::make_unique<SurfaceInterface>(scene, std::move(mesh), surface);
  };
  recipe.record = record_of(surface);
  return recipe;
}

ContactKind rigid_surface_kind() {
  return {"rigid_surface", 1, [](const Stored &of) { return rigid_surface(surface_in(of)); }};
}

} // namespace rbvi
