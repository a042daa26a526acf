#include "rbvi/contact/support/support.hpp"

#include "rbvi/contact/curve.hpp"
#include "rbvi/contact/support/support_outputs.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/quadrature.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// A quadrature point of every edge; the weights sum to 1.
struct TracePoint {
  double weight;
  std::array<double, 2> eta; ///< of both multipliers: 1 - s and s
  std::array<double, 3> phi; ///< of the displacements: vertices, middle
};

TracePoint trace_point(int degree, const EdgePoint &at) {
  TracePoint point{at.weight, {1 - at.s, at.s}, {}};
  lagrange_values(1, degree, point.eta, point.phi);
  return point;
}

/// Four Gauss points, or the two vertices: there only the vertex itself moves, a middle is free.
std::vector<TracePoint> trace_points(int degree, bool lumped) {
  if (lumped) return {trace_point(degree, {0, 0.5}), trace_point(degree, {1, 0.5})};
  std::vector<TracePoint> points;
  for (const EdgePoint &at : edge_quadrature)
    points.push_back(trace_point(degree, at));
  return points;
}

double length(const std::array<Point, 4> &edge) {
  return std::hypot(edge[1][0] - edge[0][0], edge[1][1] - edge[0][1]);
}

class SupportInterface : public EntitySum {
public:
  SupportInterface(const Scene &scene, InterfaceMesh interface_mesh, Support support)
      : EntitySum(scene, std::move(interface_mesh), 1), support_(std::move(support)),
        points_(trace_points(mesh_.degree, support_.lumped)) {
    const Index vertices = check_curve(mesh_, 0, "support's boundary");
    if (mesh_.components != 2)
      throw bad_input("scene " + scene.name +
                      ": a rigid support is for displacements of two "
                      "components");
    const std::vector<Point> points(mesh_.points.begin(), mesh_.points.begin() + vertices);
    const int copies = support_.friction.law == FrictionLaw::none ? 1 : 2;
    set_dual(vertices, copies, support_.lumped, linear_gram(points, copies));
  }

  void integrate(const FullMu &mu, const Cell &edge, EntityValues &values) const override;
  void weigh(const FullMu &, const Cell &edge, EntityValues &values) const override {
    values.weights.setConstant(length(edge.mapped) / 2);
  }
  FrictionBound bound(const FullMu &mu) const override {
    return friction_bound(support_.friction, mu);
  }
  PointConstraint constraint_at(const FullMu &mu, const Point &x, const Point &) const override {
    const SupportPoint at = support_point(scene_, support_, mu, x);
    return {at.normal, at.gap};
  }

  void outputs(const FullMu &mu, const ContactOperators &operators, const Vector &lambda,
               double least, Outputs &outputs) const override;
  Grid fields(const FullMu &mu, const Vector &u, const Vector &lambda) override {
    return support_fields(scene_, mu, *this, u, lambda);
  }

private:
  Vector lift(const FullMu &mu, const Matrix &mapped, const Vector &lambda) const;

  Support support_;
  std::vector<TracePoint> points_;
};

void SupportInterface::integrate(const FullMu &mu, const Cell &edge, EntityValues &values) const {
  const Point &begin = edge.reference[0], &end = edge.reference[1];
  const double whole = length(edge.mapped);
  const Index columns = values.b.cols(), nodes = columns / 2;
  const bool friction = values.b.rows() > 2;
  values.b.setZero();
  values.g.setZero();
  for (const TracePoint &at : points_) {
    const double weight = at.weight * whole;
    const Point x{at.eta[0] * begin[0] + at.eta[1] * end[0],
                  at.eta[0] * begin[1] + at.eta[1] * end[1], 0};
    const SupportPoint here = support_point(scene_, support_, mu, x);
    for (Index a = 0; a < 2; ++a) {
      const double eta = weight * at.eta[static_cast<std::size_t>(a)];
      for (Index node = 0; node < nodes; ++node)
        for (Index c = 0; c < 2; ++c)
          values.b(a, 2 * node + c) += eta * at.phi[static_cast<std::size_t>(node)] *
                                       here.normal[static_cast<std::size_t>(c)];
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

/// The work of multipliers on a unit vertical displacement, B e_y, where `lambda` is not zero.
/// `mapped`: the vertices.
Vector SupportInterface::lift(const FullMu &mu, const Matrix &mapped, const Vector &lambda) const {
  Vector result = Vector::Zero(dual_.size());
  for (Index e = 0; e < mesh_.count(); ++e) {
    const std::span<const Index> rows = rows_of(e);
    if (std::ranges::none_of(rows, [&](Index row) { return row >= 0 && lambda[row] != 0; }))
      continue;
    const Cell edge = reference_entity(e);
    const double whole = (mapped.row(e + 1) - mapped.row(e)).norm();
    for (const TracePoint &at : points_) {
      const Point &begin = edge.reference[0], &end = edge.reference[1];
      const Point n = support_.normal(mu, {at.eta[0] * begin[0] + at.eta[1] * end[0],
                                           at.eta[0] * begin[1] + at.eta[1] * end[1], 0});
      for (std::size_t a = 0; a < 2; ++a) {
        if (rows[a] < 0) continue;
        const double eta = at.weight * whole * at.eta[a];
        result[rows[a]] += eta * n[1];
        if (dual_.components > 1) result[rows[2 + a]] += eta * n[0];
      }
    }
  }
  return result;
}

void SupportInterface::outputs(const FullMu &mu, const ContactOperators &operators,
                               const Vector &lambda, double, Outputs &outputs) const {
  const std::vector<Point> vertices(mesh_.points.begin(), mesh_.points.begin() + mesh_.count() + 1);
  const Matrix mapped = mapped_points(scene_, mu, vertices);
  support_outputs({lambda, operators.weights, lift(mu, mapped, lambda), bound(mu),
                   mapped(dual_.vertices, Eigen::all)},
                  outputs);
}

} // namespace

SupportPoint support_point(const Scene &scene, const Support &support, const FullMu &mu,
                           const Point &x) {
  const Point n = support.normal(mu, x);
  SupportPoint point{n, support.gap(mu, x), 0};
  if (scene.motion) {
    const Point motion = scene.motion(mu, x);
    point.gap -= motion[0] * n[0] + motion[1] * n[1];
    point.slip = motion[1] * n[0] - motion[0] * n[1];
  }
  return point;
}

Grid support_fields(const Scene &scene, const FullMu &mu, const ContactInterface &interface,
                    const Vector &u, const Vector &lambda) {
  const InterfaceMesh &mesh = interface.mesh();
  const std::vector<Index> &vertices = interface.dual().vertices;
  const auto count = static_cast<Index>(vertices.size());
  Grid grid = polyline(scene, mu, mesh, vertices, u);
  Vector gap(count);
  for (Index k = 0; k < count; ++k) {
    const Index node = vertices[static_cast<std::size_t>(k)];
    const PointConstraint at =
        interface.constraint_at(mu, mesh.points[static_cast<std::size_t>(node)]);
    gap[k] = at.gap - at.direction[0] * u[2 * node] - at.direction[1] * u[2 * node + 1];
  }
  grid.of_nodes.push_back({"gap", gap, "m"});
  grid.of_nodes.push_back({"pressure", lambda.head(count), "Pa"});
  if (lambda.size() > count)
    grid.of_nodes.push_back({"tangential_stress", lambda.tail(count), "Pa"});
  return grid;
}

ContactRecipe rigid_support(Support support) {
  ContactRecipe recipe;
  recipe.entities = {InterfaceEntities::Kind::curves, {support.boundary}};
  recipe.friction = support.friction.law;
  recipe.nodal = support.lumped;
  recipe.keeps_nodes = true;
  recipe.make = [support](const Scene &scene, InterfaceMesh mesh) {
    return std::make_unique<SupportInterface>(scene, std::move(mesh), support);
  };
  recipe.record = record_of(support);
  return recipe;
}

ContactKind rigid_support_kind() {
  return {"rigid_support", 1,
          [](const Record &record) { return rigid_support(support_in(record)); }};
}

Record record_of(const Support &support) {
  Record record{"rigid_support",
                1,
                {{"lumped", {support.lumped ? 1.0 : 0.0}}},
                {{"boundary", support.boundary}},
                {{"normal", support.normal.record}, {"gap", support.gap.record}}};
  add_friction(support.friction, record);
  return record;
}

Support support_in(const Record &record) {
  return {text(record, "boundary"), made<PointMap>(part(record, "normal")),
          made<PointValue>(part(record, "gap")), friction_in(record),
          number(record, "lumped") != 0};
}

} // namespace rbvi
