#include "rbvi/contact/large_pair.hpp"

#include "rbvi/contact/two_curves.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// Points of the slave curve as it now is, projected onto the current master curve.
class Projection {
public:
  /// `mirrored`: which ends of the master curve lie on an axis of symmetry, a vertical line: the
  /// mirrored edge takes part in the normal there. Both curves must outlive it.
  Projection(const NodalCurve &slave, const NodalCurve &master, std::array<bool, 2> mirrored);

  const Cuts &cuts() const { return cuts_; }
  /// Sets partner and normal of a point. Throws failure where it has no projection.
  Bend project(PairPoint &point) const;

private:
  CurvePlace place_of(Index master_vertex, int &from) const;

  const NodalCurve &slave_, &master_;
  std::vector<Point> normals_; ///< of the master curve, upwards, of length 1, at every node
  Cuts cuts_;
};

/// A quarter turn to the left of a tangent, of length 1.
Point upwards(const Point &tangent) {
  const double length = norm(tangent);
  if (!(length > 0)) throw failure("an edge of a contact curve has lost its length");
  return {-tangent[1] / length, tangent[0] / length, 0};
}

Point mean(const Point &a, const Point &b) {
  const Point sum = a + b;
  const double length = norm(sum);
  if (!(length > 1e-3)) throw failure("a contact curve has folded back on itself");
  return sum / length;
}

/// At vertices the mean of both edges.
std::vector<Point> nodal_normals(const NodalCurve &curve, std::array<bool, 2> mirrored) {
  std::vector<Point> normals;
  const auto mirror = [](const Point &n) { return Point{-n[0], n[1], 0}; };
  for (Index v = 0; v <= curve.edges(); ++v) {
    const Index left = v - 1, right = v;
    if (v == 0 || v == curve.edges()) {
      const Point n = upwards(v == 0 ? curve.tangent(right, 0) : curve.tangent(left, 1));
      normals.push_back((v == 0 ? mirrored[0] : mirrored[1]) ? mean(n, mirror(n)) : n);
    } else {
      normals.push_back(mean(upwards(curve.tangent(left, 1)), upwards(curve.tangent(right, 0))));
    }
  }
  for (Index e = 0; e < curve.edges() && curve.per_edge() == 3; ++e)
    normals.push_back(upwards(curve.tangent(e, 0.5)));
  return normals;
}

Projection::Projection(const NodalCurve &slave, const NodalCurve &master,
                       std::array<bool, 2> mirrored)
    : slave_(slave), master_(master),
      normals_(nodal_normals(master, mirrored)), cuts_{{}, static_cast<int>(slave.edges())} {
  int from = 0;
  for (Index v = 0; v <= master.edges(); ++v)
    cuts_.places.push_back(place_of(v, from));
}

/// Where the normal of a master vertex meets the slave curve, searched from edge `from` onwards.
CurvePlace Projection::place_of(Index master_vertex, int &from) const {
  const Point &origin = master_.point(master_vertex);
  const Point &n = normals_[master_vertex];
  const auto beside = [&](Index edge, double s) { // > 0: to the right of the normal
    return cross(slave_.at(edge, s) - origin, n)[2];
  };
  const double size = edge_length(slave_.point(0), slave_.point(1));
  const double round_off = 1e-12 * size;
  if (beside(0, 0) > round_off) return {-1};
  while (from + 1 < slave_.edges() && beside(from, 1) <= round_off)
    ++from;
  const double end = beside(from, 1);
  if (end < -round_off) return {cuts_.slave_edges + 1};
  double low = 0, high = 1, s = 0.5; // safeguarded Newton steps
  for (int k = 0; k < 60 && high - low > 1e-15; ++k) {
    const double value = beside(from, s);
    if (std::abs(value) <= 1e-15 * size) break;
    (value > 0 ? high : low) = s;
    const double next = s - value / cross(slave_.tangent(from, s), n)[2];
    s = next > low && next < high ? next : 0.5 * (low + high);
  }
  return {from, s};
}

/// Newton's method for (y - y(t)) x nu(t) = 0, from where the point is between the cuts.
Bend Projection::project(PairPoint &point) const {
  const Index master_edge = point.master_edge;
  constexpr double round_off = 1e-13, settled = 1e-8; // what is left is the square of the last step
  const Point y = slave_.at(point.slave_edge, point.s);
  const CurvePlace &begin = cuts_.places[master_edge], &end = cuts_.places[master_edge + 1];
  double t =
      std::clamp(CurvePlace{point.slave_edge, point.s}.minus(begin) / end.minus(begin), 0.0, 1.0);
  double last = 1;
  for (int k = 0; k < 30; ++k) {
    const Point away = y - master_.at(master_edge, t);
    const Point field = master_.sum(master_edge, edge_functions(master_.degree(), t), normals_);
    const Point turn = master_.sum(master_edge, edge_slopes(master_.degree(), t), normals_);
    const Point tangent = master_.tangent(master_edge, t);
    const double size = norm(field);
    const double step = cross(away, field)[2] / (cross(tangent, field) - cross(away, turn))[2];
    if (std::abs(step) > round_off && std::abs(last) > settled) {
      t += std::clamp(step, -0.5, 0.5);
      last = step;
      continue;
    }
    point.t = t;
    point.normal = {field[0] / size, field[1] / size, 0};
    const double stretch = norm(tangent);
    // d nu = -k tau along the curve
    const Point tau{point.normal[1], -point.normal[0], 0};
    return {stretch, -(tau[0] * turn[0] + tau[1] * turn[1]) / (size * stretch)};
  }
  throw failure("the bodies do not face each other at (" + short_number(y[0]) + ", " +
                short_number(y[1]) +
                ") of the upper contact curve, which has no projection onto the lower one there: "
                "try a smaller indentation, or more -nonlinear_load_steps");
}

class LargePairInterface : public TwoCurves {
public:
  LargePairInterface(const Scene &scene, InterfaceMesh mesh, const LargePair &pair);

  bool follows_state() const override { return true; }
  bool has_curvature() const override { return true; }
  Curvature curvature(const FullMu &mu, const ContactState &state,
                      const Vector &lambda) const override;
  void outputs(const FullMu &mu, const ContactOperators &operators, const Vector &lambda,
               double least, Outputs &outputs) const override;

private:
  PairOperators operators_at(const FullMu &mu, const ContactState &state) const override;
  /// Both curves in one configuration, nothing found yet.
  Partners curves(const FullMu &mu, const ContactState &state, bool moved) const;
  /// Where they now are, with four Gauss points on each piece; without gaps.
  Partners partners(const FullMu &mu, const ContactState &state) const;
  double pressure_at(const PairPoint &point, const Vector &lambda) const;
  std::array<bool, 2> mirrored() const;
};

LargePairInterface::LargePairInterface(const Scene &scene, InterfaceMesh interface_mesh,
                                       const LargePair &pair)
    : TwoCurves(scene, std::move(interface_mesh), pair.multiplier) {
  if (scene.axisymmetric)
    throw bad_input("two bodies that are turned (axisymmetric) meet with small kinematics alone: "
                    "leave out kinematics: large");
  if (mesh_.components != 2)
    throw bad_input("two deformed bodies meet with displacements of two components");
}

/// The bodies with their motion, and `moved` by the state.
Partners LargePairInterface::curves(const FullMu &mu, const ContactState &state, bool moved) const {
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
  const NodalCurve rest = slave_at_rest(mu);
  return {{{nodes.begin(), master}, mesh_.degree},
          {{master, nodes.end()}, mesh_.degree},
          rest.lengths(),
          rest.hats(false)};
}

/// Ends of the master curve that move vertically alone.
std::array<bool, 2> LargePairInterface::mirrored() const {
  const auto on_axis = [&](Index vertex) {
    const Index node = mesh_.parts[0] + vertex;
    return mesh_.dofs[2 * node] < 0 && mesh_.dofs[2 * node + 1] >= 0;
  };
  return {on_axis(0), on_axis(vertex_count(mesh_.parts[1], mesh_.degree) - 1)};
}

Partners LargePairInterface::partners(const FullMu &mu, const ContactState &state) const {
  Partners now = curves(mu, state, true);
  const Projection projection(now.slave, now.master, mirrored());
  now.cuts = projection.cuts();
  now.points = now.cuts.on_pieces(edge_quadrature);
  now.vertices = now.cuts.at_vertices();
  for (PairPoint &p : now.points) {
    now.bends.push_back(projection.project(p));
    p.weight *= now.lengths[p.slave_edge];
  }
  for (PairPoint &p : now.vertices)
    (void)projection.project(p);
  return now;
}

PairOperators LargePairInterface::operators_at(const FullMu &mu, const ContactState &state) const {
  Partners now = partners(mu, state);
  const Partners rest = curves(mu, state, false);
  for (std::vector<PairPoint> *points : {&now.points, &now.vertices})
    for (PairPoint &p : *points) {
      const Point x = rest.slave.at(p.slave_edge, p.s), xi = rest.master.at(p.master_edge, p.t);
      p.gap = p.normal[0] * (x[0] - xi[0]) + p.normal[1] * (x[1] - xi[1]);
    }
  PairOperators operators = pair_operators(now, space_, mesh_.dofs, mesh_.columns);
  operators.segments = now.cuts.segments();
  operators.state = state;
  return operators;
}

/// Of the multipliers on the slave curve.
double LargePairInterface::pressure_at(const PairPoint &p, const Vector &lambda) const {
  if (space_ == MultiplierSpace::macro_edges)
    return lambda[macro_edge_of(p.slave_edge, mesh_.parts[0], mesh_.degree)];
  return (1 - p.s) * lambda[p.slave_edge] + p.s * lambda[p.slave_edge + 1];
}

Curvature LargePairInterface::curvature(const FullMu &mu, const ContactState &state,
                                        const Vector &lambda) const {
  const Partners now = partners(mu, state);
  DifferenceRows along_tau(now, mesh_.dofs, mesh_.columns);
  std::vector<double> rates;
  std::vector<Eigen::Triplet<double>> of_partners;
  for (std::size_t i = 0; i < now.points.size(); ++i) {
    const PairPoint &p = now.points[i];
    const auto [stretch, bend] = now.bends[i];
    const double pressure = pressure_at(p, lambda);
    if (pressure == 0) continue;
    PairPoint tangential = p;
    tangential.normal = {p.normal[1], -p.normal[0], 0};
    along_tau.add(tangential, 1);
    along_tau.end_row();
    const double weight = p.weight * pressure;
    const std::array<double, 3> slopes = edge_slopes(mesh_.degree, p.t);
    for (Index k = 0; k < now.master.per_edge(); ++k)
      for (Index c = 0; c < 2; ++c)
        if (const int dof =
                mesh_.dofs[2 * (mesh_.parts[0] + now.master.node(p.master_edge, k)) + c];
            dof >= 0)
          of_partners.emplace_back(std::ssize(rates), dof,
                                   weight * slopes[k] / stretch * p.normal[c]);
    rates.push_back(-weight * bend / 2);
  }
  Curvature result{along_tau.matrix(), SparseMatrix(std::ssize(rates), mesh_.columns)};
  result.e.setFromTriplets(of_partners.begin(), of_partners.end());
  result.e += Eigen::Map<const Vector>(rates.data(), std::ssize(rates)).asDiagonal() * result.s;
  return result;
}

void LargePairInterface::outputs(const FullMu &mu, const ContactOperators &operators,
                                 const Vector &lambda, double least, Outputs &outputs) const {
  TwoCurves::outputs(mu, operators, lambda, least, outputs);
  double vertical = 0;
  for (const PairPoint &p : partners(mu, operators.state).points)
    vertical += p.weight * pressure_at(p, lambda) * p.normal[1];
  outputs.reaction = scene_.mirror_images * vertical;
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
