#include "rbvi/contact/large_pair/large_pair.hpp"

#include "facing.hpp"
#include "rbvi/contact/curve.hpp"
#include "rbvi/contact/interface.hpp"
#include "rbvi/core/error.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

class LargePairInterface : public ContactInterface {
public:
  LargePairInterface(const Scene &scene, InterfaceMesh mesh, LargePair pair);

  bool follows_state() const override { return true; }
  bool has_curvature() const override { return true; }
  void assemble(const FullMu &mu, const ContactState &state, const WantedNodes &wanted,
                ContactOperators &operators) override;
  Curvature curvature(const FullMu &mu, const ContactState &state,
                      const Vector &lambda) const override;
  void outputs(const FullMu &mu, const ContactOperators &operators, const Vector &lambda,
               double least, Outputs &outputs) const override;
  Grid fields(const FullMu &mu, const Vector &u, const Vector &lambda) override;

private:
  /// Both curves in one configuration.
  struct Curves {
    CurrentCurve slave, master;
  };
  Curves curves(const FullMu &mu, const ContactState &state, bool moved) const;
  Index node_of(const CurrentCurve &curve, bool of_master, Index edge, Index local) const {
    return (of_master ? mesh_.parts[0] : 0) + curve.node(edge, local);
  }
  /// The multipliers of a point, and their values there.
  std::array<std::pair<Index, double>, 2> multipliers(const Facing &point) const;
  double length(const FullMu &mu, Index slave_edge) const;
  /// The integral of each multiplier's function over the whole slave curve.
  Vector whole_weights(const FullMu &mu) const;
  MirroredEnds mirrored(bool of_master = true) const;
  /// Adds factor * direction . (v(x) - v(xi)) to a row.
  void add_difference(const Curves &now, const Facing &point, const Point &direction, double factor,
                      Index row, Triplets &entries) const;
  void set_nodal(const Projection &projection, const Curves &rest, const Curves &now,
                 ContactOperators &operators) const;
  /// Contact dofs only.
  void add(Index row, Index node, const Point &values, double factor, Triplets &entries) const;

  LargePair pair_;
  std::vector<Point> slave_; ///< reference nodes
};

LargePairInterface::LargePairInterface(const Scene &scene, InterfaceMesh interface_mesh,
                                       LargePair pair)
    : ContactInterface(scene, std::move(interface_mesh)), pair_(std::move(pair)) {
  (void)check_curve(mesh_, 0, "slave curve");
  (void)check_curve(mesh_, 1, "master curve");
  if (mesh_.components != 2)
    throw bad_input("two deformed bodies meet with displacements of two components");
  slave_.assign(mesh_.points.begin(), mesh_.points.begin() + mesh_.parts[0]);
  dual_.points = multiplier_points(slave_, pair_.multiplier, mesh_.degree);
  dual_.gram = multiplier_product(slave_, pair_.multiplier, mesh_.degree);
}

/// The bodies with their motion, and `moved` by the state.
LargePairInterface::Curves LargePairInterface::curves(const FullMu &mu, const ContactState &state,
                                                      bool moved) const {
  std::vector<Point> nodes;
  nodes.reserve(mesh_.points.size());
  for (std::size_t i = 0; i < mesh_.points.size(); ++i) {
    Point y = scene_.map(mu, mesh_.points[i]);
    const Point motion = scene_.motion ? scene_.motion(mu, mesh_.points[i]) : Point{};
    for (std::size_t c = 0; c < 2; ++c) {
      y[c] += motion[c];
      const int dof = mesh_.dofs[2 * i + c];
      if (moved && dof >= 0 && state.displacement.size() > 0) y[c] += state.displacement[dof];
    }
    nodes.push_back(y);
  }
  const auto master = nodes.begin() + mesh_.parts[0];
  return {{{nodes.begin(), master}, mesh_.degree}, {{master, nodes.end()}, mesh_.degree}};
}

Vector LargePairInterface::whole_weights(const FullMu &mu) const {
  Vector whole = Vector::Zero(dual_.nodes());
  const Index edges = vertex_count(mesh_.parts[0], mesh_.degree) - 1;
  for (Index e = 0; e < edges; ++e)
    for (const auto &[row, value] : multipliers({e, 0, 0.5, 0, 0, {}, 0, 0}))
      if (row >= 0) whole[row] += value * length(mu, e);
  return whole;
}

/// Ends of a curve that move vertically alone.
MirroredEnds LargePairInterface::mirrored(bool of_master) const {
  const auto on_axis = [&](Index vertex) {
    const auto node = static_cast<std::size_t>((of_master ? mesh_.parts[0] : 0) + vertex);
    return mesh_.dofs[2 * node] < 0 && mesh_.dofs[2 * node + 1] >= 0;
  };
  return {on_axis(0), on_axis(vertex_count(mesh_.parts[of_master ? 1 : 0], mesh_.degree) - 1)};
}

std::array<std::pair<Index, double>, 2> LargePairInterface::multipliers(const Facing &point) const {
  if (pair_.multiplier == MultiplierSpace::macro_edges)
    return {{{macro_edge_of(point.slave_edge, mesh_.parts[0], mesh_.degree), 1}, {-1, 0}}};
  return {{{point.slave_edge, 1 - point.s}, {point.slave_edge + 1, point.s}}};
}

/// Of the straight slave edge, undeformed.
double LargePairInterface::length(const FullMu &mu, Index slave_edge) const {
  const Point a = scene_.map(mu, slave_[slave_edge]),
              b = scene_.map(mu, slave_[static_cast<std::size_t>(slave_edge) + 1]);
  return std::sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]));
}

void LargePairInterface::add(Index row, Index node, const Point &values, double factor,
                             Triplets &entries) const {
  for (std::size_t c = 0; c < 2; ++c)
    if (const int dof = mesh_.dofs[2 * static_cast<std::size_t>(node) + c]; dof >= 0)
      entries.emplace_back(row, dof, factor * values[c]);
}

void LargePairInterface::add_difference(const Curves &now, const Facing &point,
                                        const Point &direction, double factor, Index row,
                                        Triplets &entries) const {
  const std::array<double, 3> at_slave = now.slave.values(point.s),
                              at_master = now.master.values(point.t);
  for (Index k = 0; k < now.slave.per_edge(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    add(row, node_of(now.slave, false, point.slave_edge, k), direction, factor * at_slave[i],
        entries);
    add(row, node_of(now.master, true, point.master_edge, k), direction, -factor * at_master[i],
        entries);
  }
}

void LargePairInterface::set_nodal(const Projection &projection, const Curves &rest,
                                   const Curves &now, ContactOperators &operators) const {
  const std::vector<Facing> vertices = projection.vertices();
  const auto count = static_cast<Index>(vertices.size());
  Triplets entries;
  operators.nodal_gap.resize(count);
  for (Index i = 0; i < count; ++i) {
    const Facing &p = vertices[i];
    const Point x = rest.slave.at(p.slave_edge, p.s), xi = rest.master.at(p.master_edge, p.t);
    operators.nodal_gap[i] = p.normal[0] * (x[0] - xi[0]) + p.normal[1] * (x[1] - xi[1]);
    add_difference(now, p, p.normal, -1, i, entries);
  }
  operators.nodal_b.resize(count, mesh_.columns);
  operators.nodal_b.setFromTriplets(entries.begin(), entries.end());
}

void LargePairInterface::assemble(const FullMu &mu, const ContactState &state, const WantedNodes &,
                                  ContactOperators &operators) {
  const Curves rest = curves(mu, state, false), now = curves(mu, state, true);
  const Projection projection(now.slave, now.master, mirrored());
  const std::vector<Facing> points = projection.gauss_points();
  Triplets entries;
  operators.g = operators.weights = Vector::Zero(dual_.nodes());
  for (const Facing &p : points) {
    const Point x = rest.slave.at(p.slave_edge, p.s), xi = rest.master.at(p.master_edge, p.t);
    const double gap = p.normal[0] * (x[0] - xi[0]) + p.normal[1] * (x[1] - xi[1]);
    const double weight = p.weight * length(mu, p.slave_edge);
    for (const auto &[row, value] : multipliers(p)) {
      if (row < 0) continue;
      operators.g[row] += weight * value * gap;
      operators.weights[row] += weight * value;
      add_difference(now, p, p.normal, -weight * value, row, entries);
    }
  }
  operators.b.resize(dual_.nodes(), mesh_.columns);
  operators.b.setFromTriplets(entries.begin(), entries.end());
  set_nodal(projection, rest, now, operators);
  operators.uncovered.clear();
  const Vector whole = whole_weights(mu);
  for (Index row = 0; row < dual_.nodes(); ++row)
    if (is_partial(operators.weights[row], whole[row])) operators.uncovered.push_back(row);
  operators.segments = projection.segments();
  operators.state = state;
}

Curvature LargePairInterface::curvature(const FullMu &mu, const ContactState &state,
                                        const Vector &lambda) const {
  const Curves now = curves(mu, state, true);
  const Projection projection(now.slave, now.master, mirrored());
  Triplets of_s, of_e;
  Index row = 0;
  for (const Facing &p : projection.gauss_points()) {
    double pressure = 0;
    for (const auto &[multiplier, value] : multipliers(p))
      if (multiplier >= 0) pressure += value * lambda[multiplier];
    if (pressure == 0) continue;
    const double weight = -p.weight * length(mu, p.slave_edge) * pressure;
    const Point tau{p.normal[1], -p.normal[0], 0};
    add_difference(now, p, tau, 1, row, of_s);
    add_difference(now, p, tau, weight * p.curvature / 2, row, of_e);
    const std::array<double, 3> slopes = now.master.slopes(p.t);
    for (Index k = 0; k < now.master.per_edge(); ++k)
      add(row, node_of(now.master, true, p.master_edge, k), p.normal,
          weight * slopes[k] / p.stretch, of_e);
    ++row;
  }
  Curvature result{SparseMatrix(row, mesh_.columns), SparseMatrix(row, mesh_.columns)};
  result.s.setFromTriplets(of_s.begin(), of_s.end());
  result.e.setFromTriplets(of_e.begin(), of_e.end());
  return result;
}

void LargePairInterface::outputs(const FullMu &mu, const ContactOperators &operators,
                                 const Vector &lambda, double least, Outputs &outputs) const {
  pressure_outputs(scene_.mirror_images, operators.weights, lambda, least, outputs);
  const Curves now = curves(mu, operators.state, true);
  const Projection projection(now.slave, now.master, mirrored());
  double vertical = 0;
  for (const Facing &p : projection.gauss_points())
    for (const auto &[row, value] : multipliers(p))
      if (row >= 0)
        vertical += p.weight * length(mu, p.slave_edge) * value * lambda[row] * p.normal[1];
  outputs.reaction = scene_.mirror_images * vertical;
  const MirroredEnds axis = mirrored(false);
  outputs.ends_in_contact =
      ends_in_contact(whole_weights(mu), operators.weights, lambda, least, {axis.first, axis.last});
}

Grid LargePairInterface::fields(const FullMu &mu, const Vector &u, const Vector &lambda) {
  const ContactState state{at_columns(mesh_, u)};
  const Curves now = curves(mu, state, true);
  const Projection projection(now.slave, now.master, mirrored());
  const std::vector<Facing> vertices = projection.vertices();
  if (vertices.size() < 2) return {};
  std::vector<Index> nodes;
  const bool constant = pair_.multiplier == MultiplierSpace::macro_edges;
  Vector gap(static_cast<Index>(vertices.size())), pressure(gap.size() - (constant ? 1 : 0));
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Facing &p = vertices[k];
    nodes.push_back(static_cast<Index>(std::lround(p.weight)));
    const Point y = now.slave.at(p.slave_edge, p.s), xi = now.master.at(p.master_edge, p.t);
    gap[static_cast<Index>(k)] = p.normal[0] * (y[0] - xi[0]) + p.normal[1] * (y[1] - xi[1]);
  }
  for (Index k = 0; k < pressure.size(); ++k) {
    const Index node = nodes[k];
    pressure[k] = lambda[constant ? macro_edge_of(node, mesh_.parts[0], mesh_.degree) : node];
  }
  Grid grid = polyline(scene_, mu, mesh_, nodes, u);
  grid.of_nodes.push_back({"gap", gap, "m"});
  add_pressure(pressure, grid);
  return grid;
}

} // namespace

ContactRecipe deformed_bodies(LargePair pair) {
  ContactRecipe recipe;
  recipe.entities = {InterfaceEntities::Kind::curves, {pair.slave, pair.master}, {}, true};
  recipe.separable = false;
  recipe.follows_state = true;
  recipe.keeps_nodes = true;
  recipe.make = [pair](const Scene &scene, InterfaceMesh mesh) {
    return std::make_unique<LargePairInterface>(scene, std::move(mesh), pair);
  };
  recipe.record = {"deformed_bodies",
                   1,
                   {{"linear_pressure", {pair.multiplier == MultiplierSpace::nodes ? 1.0 : 0.0}}},
                   {{"slave", pair.slave}, {"master", pair.master}}};
  return recipe;
}

ContactKind deformed_bodies_kind() {
  return {"deformed_bodies", 1, [](const Record &record) {
            const bool linear = number(record, "linear_pressure") != 0;
            return deformed_bodies(
                {text(record, "slave"), text(record, "master"),
                 linear ? MultiplierSpace::nodes : MultiplierSpace::macro_edges});
          }};
}

} // namespace rbvi
