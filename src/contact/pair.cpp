#include "rbvi/contact/pair.hpp"

#include "rbvi/contact/contact_area.hpp"
#include "rbvi/contact/facing.hpp"
#include "rbvi/contact/support_outputs.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/formula.hpp"
#include "rbvi/core/functions.hpp"
#include "rbvi/element/imposed.hpp"

#include <algorithm>
#include <optional>

namespace rbvi {

namespace {

bool is_vertical(const Pair &pair) {
  return pair.discretisation.projection == PairProjection::vertical;
}

bool is_of_heights(const Pair &pair) {
  return is_vertical(pair) && pair.friction.law == FrictionLaw::none;
}

class PairInterface : public ContactInterface {
public:
  PairInterface(const Scene &scene, InterfaceMesh mesh, const Pair &pair);

  void assemble(const FullMu &mu, const ContactState &state, const WantedNodes &,
                ContactOperators &operators) override {
    operators = operators_at(mu, state);
  }
  bool follows_state() const override { return pair_.large; }
  bool has_curvature() const override { return pair_.large; }
  Curvature curvature(const FullMu &mu, const ContactState &state,
                      const Vector &lambda) const override;
  FrictionBound bound(const FullMu &mu) const override {
    return friction_bound(pair_.friction, mu);
  }
  std::vector<Index> partly_fixed() const override;
  Vector nodal_forces(const FullMu &mu, const ContactState &at, const Vector &of) const override {
    return rbvi::nodal_forces(partners(mu, at), multipliers_, of);
  }
  PointForces point_forces(const FullMu &mu, const ContactState &at, const Vector &of) const final {
    Partners found = partners(mu, at);
    const Curves rest = curves(images(scene_.map, mu, mesh_.points)); // of the arms
    if (pair_.large) found.slave = rest.slave, found.master = rest.master;
    return rbvi::point_forces(found, multipliers_, of);
  }
  void outputs(const FullMu &mu, const ContactOperators &operators, const Vector &lambda,
               double least, Outputs &outputs) const override;
  double gap_error(const FullMu &mu, const Vector &u, const Vector &lambda) const override;
  Grid fields(const FullMu &mu, const Vector &u, const Vector &lambda, bool whole) override;

private:
  struct Curves {
    NodalCurve slave, master;
  };
  Curves curves(const std::vector<Point> &nodes) const;
  std::vector<Point> moves(const FullMu &mu) const;
  Partners search(const FullMu &mu, const ContactState &state,
                  const std::vector<Point> &moved) const;
  Partners partners(const FullMu &mu, const ContactState &state) const;
  ContactOperators operators_of(const Partners &found, const ContactState &state) const;
  ContactOperators operators_at(const FullMu &mu, const ContactState &state) const;
  std::vector<std::array<bool, 2>> closed_ends() const;
  bool friction() const { return pair_.friction.law != FrictionLaw::none; }

  Pair pair_;
  std::shared_ptr<const CurveShape> slave_, master_;
  PairMultipliers multipliers_;
  std::vector<CurveSection> sections_; ///< of the master curve
  std::vector<int> fixed_;             ///< per node of the master: bits of its components
  bool imposes_;                       ///< values on displacements that the kernels see
  std::optional<Partners> at_rest_;    ///< small displacements, of a mesh that no parameter moves
};

PairInterface::PairInterface(const Scene &scene, InterfaceMesh interface_mesh, const Pair &pair)
    : ContactInterface(scene, std::move(interface_mesh)), pair_(pair),
      slave_(std::make_shared<CurveShape>(curve_shape(mesh_, 0, "slave curve"))),
      master_(std::make_shared<CurveShape>(curve_shape(mesh_, 1, "master curve"))),
      multipliers_(*slave_, pair.discretisation.multiplier, mesh_.degree),
      imposes_(!is_of_heights(pair) &&
               std::ranges::any_of(mesh_.imposed_by, [](int boundary) { return boundary >= 0; })) {
  if (mesh_.components != 2)
    throw bad_input("two bodies meet with displacements of two components");
  if (scene.axisymmetric && pair.large)
    throw bad_input("two bodies that are turned (axisymmetric) meet with small kinematics alone: "
                    "leave out kinematics: large");
  for (Index i = 0; i < mesh_.nodes(); ++i) {
    const int *dofs = mesh_.dofs.data() + 2 * i;
    if (is_of_heights(pair) && dofs[1] < 0)
      throw bad_input("two bodies meet along curves whose nodes all move vertically");
    if (i >= mesh_.parts[0]) fixed_.push_back((dofs[0] < 0 ? 1 : 0) + (dofs[1] < 0 ? 2 : 0));
  }
  Curves reference = curves(mesh_.points);
  sections_ = sections_of(reference.master, is_vertical(pair));
  if (is_vertical(pair)) {
    try {
      reference = {as_graph(reference.slave, "slave"), as_graph(reference.master, "master")};
    } catch (const Error &error) {
      throw bad_input(std::string(error.what()) +
                      ": 'projection: vertical' is for a boundary above another one, each with one "
                      "y for each x; use 'projection: normal'");
    }
  }
  dual_.points = multipliers_.points(reference.slave);
  dual_.components = friction() ? 2 : 1;
  dual_.gram = multipliers_.gram(reference.slave, dual_.components, scene.axisymmetric);
  if (!pair.large && is_identity(scene_.map)) at_rest_ = search({}, {}, {});
}

PairInterface::Curves PairInterface::curves(const std::vector<Point> &nodes) const {
  const auto master = nodes.begin() + mesh_.parts[0];
  return {{{nodes.begin(), master}, mesh_.degree, slave_},
          {{master, nodes.end()}, mesh_.degree, master_}};
}

/// Of the nodes: the motion and the imposed values; empty: none.
std::vector<Point> PairInterface::moves(const FullMu &mu) const {
  if (!scene_.motion && !imposes_) return {};
  std::vector<Point> result(mesh_.points.size(), Point{});
  if (scene_.motion) result = images(scene_.motion, mu, mesh_.points);
  if (!imposes_) return result;
  const Vector imposed = imposed_values(scene_, mu, mesh_.points, mesh_.imposed_by);
  for (Index k = 0; k < imposed.size(); ++k)
    result[k / 2][k % 2] += imposed[k];
  return result;
}

/// With gaps but for the displacements of the columns, and for `moved` where they are small.
Partners PairInterface::search(const FullMu &mu, const ContactState &state,
                               const std::vector<Point> &moved) const {
  const std::vector<Point> rest = images(scene_.map, mu, mesh_.points);
  Curves at_rest = curves(rest);
  const HatWeights hats = at_rest.slave.hats(scene_.axisymmetric);
  const bool vertical = is_vertical(pair_);
  if (vertical)
    at_rest = {as_graph(std::move(at_rest.slave), "slave"),
               as_graph(std::move(at_rest.master), "master")};
  const auto found_between = [&](Curves at) {
    MasterField field{sections_,
                      vertical ? vertical_normals(at.master)
                               : averaged_normals(at.master, sections_, fixed_),
                      vertical};
    return find_partners(std::move(at.slave), std::move(at.master), pair_.discretisation,
                         std::move(field), hats);
  };
  if (!pair_.large) return found_between(std::move(at_rest));
  std::vector<Point> nodes = rest;
  for (std::size_t k = 0; k < 2 * nodes.size(); ++k) {
    if (!moved.empty()) nodes[k / 2][k % 2] += moved[k / 2][k % 2];
    if (const int dof = mesh_.dofs[k]; dof >= 0 && state.displacement.size() > 0)
      nodes[k / 2][k % 2] += state.displacement[dof];
  }
  Partners found = found_between(curves(nodes));
  for (std::vector<PairPoint> *points : {&found.points, &found.vertices, &found.cuts})
    set_gaps(at_rest.slave, at_rest.master, *points);
  return found;
}

/// With gaps and slips but for the displacements of the columns.
Partners PairInterface::partners(const FullMu &mu, const ContactState &state) const {
  const std::vector<Point> moved = moves(mu);
  Partners found = at_rest_ ? *at_rest_ : search(mu, state, moved);
  if (moved.empty()) return found;
  const Curves by = curves(moved);
  for (std::vector<PairPoint> *points : {&found.points, &found.vertices, &found.cuts})
    for (PairPoint &p : *points) {
      const Point apart = by.slave.at(p.slave_edge, p.s) - by.master.at(p.master_edge, p.t);
      p.gap += dot(p.normal, apart);
      p.slip = p.normal[1] * apart[0] - p.normal[0] * apart[1];
    }
  return found;
}

ContactOperators PairInterface::operators_of(const Partners &found,
                                             const ContactState &state) const {
  ContactOperators operators =
      pair_operators(found, multipliers_, mesh_.dofs, mesh_.columns, friction());
  if (!pair_.large) return operators;
  operators.segments = found.segments;
  operators.state = state;
  return operators;
}

ContactOperators PairInterface::operators_at(const FullMu &mu, const ContactState &state) const {
  try {
    return operators_of(partners(mu, state), state);
  } catch (const Error &error) { // the fault of this mu, not of the input
    if (pair_.large) throw;
    throw failure(std::string(error.what()) + ", mapped at " + describe(scene_.parameters, mu));
  }
}

std::vector<Index> PairInterface::partly_fixed() const {
  std::vector<Index> result;
  if (multipliers_.space() == MultiplierSpace::nodes && friction())
    for (Index i = 0; i < multipliers_.count(); ++i)
      if (mesh_.dofs[2 * i] < 0 || mesh_.dofs[2 * i + 1] < 0) result.push_back(i);
  return result;
}

Curvature PairInterface::curvature(const FullMu &mu, const ContactState &state,
                                   const Vector &lambda) const {
  const Partners now = partners(mu, state);
  DifferenceRows along_tau(now, mesh_.dofs, mesh_.columns);
  std::vector<double> rates;
  std::vector<Eigen::Triplet<double>> of_partners;
  for (std::size_t i = 0; i < now.points.size(); ++i) {
    const PairPoint &p = now.points[i];
    const auto [stretch, bend] = now.bends[i];
    const double pressure = multipliers_.sum(lambda, p.slave_edge, p.s);
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

/// At vertices of the slave. Throws failure where the deformed bodies do not face each other.
double PairInterface::gap_error(const FullMu &mu, const Vector &u, const Vector &lambda) const {
  if (pair_.large) return 0;
  std::vector<Point> nodes = images(scene_.map, mu, mesh_.points), moved(nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const auto first = static_cast<Index>(2 * k);
    moved[k] = Point{u[first], u[first + 1], 0} +
               (scene_.motion ? scene_.motion(mu, mesh_.points[k]) : Point{});
    nodes[k] = nodes[k] + moved[k];
  }
  const Partners rest = at_rest_ ? *at_rest_ : search(mu, {}, {});
  Curves by = curves(moved), at = curves(nodes);
  MasterField field{sections_, averaged_normals(at.master, sections_, fixed_)};
  const Partners now =
      find_partners(std::move(at.slave), std::move(at.master), {}, std::move(field), rest.hats);
  const auto vertex = [&](const PairPoint &p) {
    return slave_->ends[p.slave_edge][p.s > 0.5 ? 1 : 0];
  };
  GapErrors errors(lambda.head(multipliers_.count()));
  for (const PairPoint &p : rest.vertices) {
    const auto found = std::ranges::find(now.vertices, vertex(p), vertex);
    if (found == now.vertices.end()) continue;
    const double slave = dot(p.normal, by.slave.at(p.slave_edge, p.s)),
                 master = dot(p.normal, by.master.at(p.master_edge, p.t));
    errors.add(multipliers_.sum(lambda, p.slave_edge, p.s),
               std::max(std::abs(slave), std::abs(master)), p.gap + slave - master, found->gap);
  }
  return errors.largest();
}

/// Of each piece of the slave curve, then whether all of the master curve are.
std::vector<std::array<bool, 2>> PairInterface::closed_ends() const {
  const std::size_t pieces = slave_->pieces.size();
  std::vector<std::array<bool, 2>> closed(pieces + 1, {true, true});
  for (std::size_t k = 0; k < pieces + master_->pieces.size(); ++k)
    for (std::size_t end = 0; end < 2; ++end)
      if (!mesh_.closed(k)[end]) closed[std::min(k, pieces)][end] = false;
  return closed;
}

void PairInterface::outputs(const FullMu &mu, const ContactOperators &operators,
                            const Vector &lambda, double least, Outputs &outputs) const {
  const Vector pressure = lambda.head(multipliers_.count());
  const Vector copies = image_counts(scene_.mirrors, dual_.points);
  pressure_outputs(copies, operators.weights, pressure, least, outputs);
  const Vector whole = multipliers_.whole_weights(
      curves(images(scene_.map, mu, mesh_.points)).slave.hats(scene_.axisymmetric));
  const Vector shares = operators.weights.cwiseQuotient(whole);
  outputs.ends_in_contact =
      image_count(scene_.mirrors) *
      ends_in_contact(multipliers_, *slave_, shares, pressure, least, closed_ends());
  if (is_of_heights(pair_)) return;
  const Partners found = partners(mu, operators.state);
  if (friction())
    friction_outputs(copies, tangential_force(found, multipliers_, lambda.tail(pressure.size())),
                     operators.weights, lambda, bound(mu), outputs);
  Point force{}; // on the slave
  for (const PointForce &at : rbvi::point_forces(found, multipliers_, lambda))
    if (at.part == 0) force = force + at.force;
  outputs.reaction = force[1];
  outputs.horizontal_reaction = force[0];
  if (scene_.axisymmetric) drop_plane_outputs(outputs);
}

Grid PairInterface::fields(const FullMu &mu, const Vector &u, const Vector &lambda, bool whole) {
  const Vector state = at_columns(mesh_, u), moved = moved_nodes(scene_, mu, mesh_, u);
  const Partners found = partners(mu, {state});
  const SlaveLines of = slave_lines(found, whole);
  Grid grid = polyline(scene_, mu, mesh_, of.places, of.cells, u,
                       whole ? middles_of(of) : std::vector<CurvePlace>());
  std::vector<Point> free(mesh_.points.size(), Point{}), all(mesh_.points.size());
  for (std::size_t k = 0; k < 2 * free.size(); ++k) {
    if (mesh_.dofs[k] >= 0) free[k / 2][k % 2] = state[mesh_.dofs[k]];
    all[k / 2][k % 2] = moved[3 * static_cast<Index>(k / 2) + static_cast<Index>(k % 2)];
  }
  const Curves by_free = curves(free), by_all = curves(all);
  const auto apart = [](const Curves &by, const PairPoint &p) {
    return by.slave.at(p.slave_edge, p.s) - by.master.at(p.master_edge, p.t);
  };
  const auto gap_at = [&](const auto &p) { return p.gap + dot(p.normal, apart(by_free, p)); };
  const auto slip_at = [&](const auto &p) { return slip_along(-1.0 * p.normal, apart(by_all, p)); };
  const bool constant = multipliers_.space() == MultiplierSpace::macro_edges;
  const Index nodes = std::ssize(of.places), edges = std::ssize(of.faced),
              values = constant ? edges : nodes, count = multipliers_.count();
  Vector gap = Vector::Constant(nodes, std::numeric_limits<double>::quiet_NaN()), slip = gap,
         pressure = Vector::Zero(values), shear = pressure;
  const auto put_stress = [&](Index k, const CurvePlace &at) {
    pressure[k] = multipliers_.sum(lambda.head(count), at.edge, at.s);
    if (friction()) shear[k] = multipliers_.sum(lambda.tail(count), at.edge, at.s);
  };
  std::vector<Point> normals(of.places.size(), Point{});
  for (Index k = 0; k < nodes; ++k)
    if (const PairPoint *p = of.partners[k]) {
      normals[k] = -1.0 * p->normal;
      gap[k] = gap_at(*p);
      slip[k] = slip_at(*p);
      if (!constant) put_stress(k, of.places[k]);
    }
  for (Index k = 0; k < edges && constant; ++k) {
    const auto [edge, s] = of.places[of.cells[2 * k]]; // of a vertex the end of the edge before
    if (of.faced[k]) put_stress(k, {s < 1 ? edge : edge + 1, 0});
  }
  add_gap(gap, normals, grid);
  grid.of_nodes.push_back({"slip", slip, "m"});
  add_stress("pressure", pressure, constant, grid);
  if (friction()) add_stress("tangential_stress", shear, constant, grid);
  if (!whole) return grid;
  grid.of_cells.push_back({"gap_middle", fitted_middles(found, of, gap, gap_at), "m"});
  grid.of_cells.push_back({"slip_middle", fitted_middles(found, of, slip, slip_at), "m"});
  return grid;
}

} // namespace

ContactRecipe two_bodies(Pair pair) {
  if (pair.large && pair.friction.law != FrictionLaw::none)
    throw bad_input("two bodies have friction with kinematics: small alone: leave it out, or use "
                    "small");
  if (pair.large && is_vertical(pair))
    throw bad_input("projection: vertical is for small deformations: leave it out with "
                    "kinematics: large");
  if (pair.large && pair.discretisation.quadrature == PairQuadrature::direct)
    throw bad_input("integration: direct is for small deformations: leave it out with "
                    "kinematics: large");
  // There is no traction through the air, nor where no partner is faced.
  pair.friction.only_in_contact = pair.friction.law == FrictionLaw::tresca;
  ContactRecipe recipe;
  recipe.entities = {InterfaceEntities::Kind::facets, {pair.slave, pair.master}, {}, true};
  if (is_of_heights(pair)) recipe.entities.components = {1};
  add_friction(pair.friction, recipe);
  recipe.separable = false;
  recipe.follows_state = pair.large;
  recipe.keeps_nodes = true;
  recipe.make = [pair](const Scene &scene, InterfaceMesh mesh) {
    return std::make_unique<PairInterface>(scene, std::move(mesh), pair);
  };
  return recipe;
}

} // namespace rbvi
