#include "rbvi/contact/pair/pair.hpp"

#include "rbvi/contact/curve.hpp"
#include "rbvi/core/error.hpp"

namespace rbvi {

namespace {

class PairInterface : public ContactInterface {
public:
  PairInterface(const Scene &scene, InterfaceMesh mesh, Pair pair);

  void assemble(const FullMu &mu, const ContactState &, const WantedNodes &,
                ContactOperators &operators) override {
    PairOperators coupled = couple_at(mu);
    operators.b = at_contact_dofs(std::move(coupled.b));
    operators.g = std::move(coupled.g);
    operators.weights = std::move(coupled.weights);
    operators.nodal_b = at_contact_dofs(std::move(coupled.nodal_b));
    operators.nodal_gap = std::move(coupled.nodal_gap);
    operators.uncovered = std::move(coupled.uncovered);
  }
  void outputs(const FullMu &mu, const ContactOperators &operators, const Vector &lambda,
               double least, Outputs &outputs) const override {
    pressure_outputs(scene_.mirror_images, operators.weights, lambda, least, outputs);
    outputs.ends_in_contact = rbvi::ends_in_contact(whole_weights(mu), operators.weights, lambda,
                                                    least, pair_.closed_ends);
  }
  Grid fields(const FullMu &mu, const Vector &u, const Vector &lambda) override;

private:
  PairOperators couple_at(const FullMu &mu) const;
  SparseMatrix at_contact_dofs(SparseMatrix b) const;
  Vector whole_weights(const FullMu &mu) const;

  Pair pair_;
  bool alone_;               ///< node i is contact dof i of the problem
  std::vector<Point> slave_; ///< reference nodes of the slave curve
};

PairInterface::PairInterface(const Scene &scene, InterfaceMesh interface_mesh, Pair pair)
    : ContactInterface(scene, std::move(interface_mesh)), pair_(std::move(pair)) {
  (void)check_curve(mesh_, 0, "slave curve");
  (void)check_curve(mesh_, 1, "master curve");
  alone_ = mesh_.columns == mesh_.nodes();
  for (Index i = 0; i < mesh_.nodes(); ++i) {
    const int dof = mesh_.components == 2 ? mesh_.dofs[2 * i + 1] : -1;
    if (dof < 0) throw bad_input("two bodies meet along curves whose nodes all move vertically");
    alone_ = alone_ && dof == i;
  }
  slave_.assign(mesh_.points.begin(), mesh_.points.begin() + mesh_.parts[0]);
  const MultiplierSpace space = pair_.discretisation.multiplier;
  dual_.points = multiplier_points(slave_, space, mesh_.degree);
  dual_.gram = multiplier_product(slave_, space, mesh_.degree);
}

/// From columns by nodes to those of the problem.
SparseMatrix PairInterface::at_contact_dofs(SparseMatrix b) const {
  if (alone_) return b;
  std::vector<Eigen::Triplet<double>> entries;
  for (Index row = 0; row < b.rows(); ++row)
    for (SparseMatrix::InnerIterator entry(b, row); entry; ++entry)
      entries.emplace_back(row, mesh_.dofs[2 * entry.col() + 1], entry.value());
  SparseMatrix result(b.rows(), mesh_.columns);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

/// Of the multipliers, whether they have a partner or not.
Vector PairInterface::whole_weights(const FullMu &mu) const {
  std::vector<Point> mapped;
  for (const Point &x : slave_)
    mapped.push_back(scene_.map(mu, x));
  return multiplier_product(mapped, pair_.discretisation.multiplier, mesh_.degree) *
         Vector::Ones(dual_.nodes());
}

PairOperators PairInterface::couple_at(const FullMu &mu) const {
  std::vector<Point> mapped;
  mapped.reserve(mesh_.points.size());
  for (const Point &x : mesh_.points)
    mapped.push_back(scene_.map(mu, x));
  const auto master = mapped.begin() + mesh_.parts[0];
  PairOperators pair;
  try {
    pair = couple({mapped.begin(), master}, {master, mapped.end()}, pair_.discretisation,
                  mesh_.degree);
  } catch (const Error &error) { // the fault of this mu, not of the input
    throw failure(std::string(error.what()) + ", mapped at " + describe(scene_.parameters, mu));
  }
  if (!scene_.motion) return pair;
  Vector motion(mesh_.nodes());
  for (Index i = 0; i < motion.size(); ++i)
    motion[i] = scene_.motion(mu, mesh_.points[i])[1];
  pair.g -= pair.b * motion;
  pair.nodal_gap -= pair.nodal_b * motion;
  return pair;
}

/// The slave curve; without cells where nothing of it faces the master curve.
Grid PairInterface::fields(const FullMu &mu, const Vector &u, const Vector &lambda) {
  const PairOperators pair = couple_at(mu);
  const auto count = static_cast<Index>(pair.paired.size());
  if (count < 2) return {};
  Grid grid = polyline(scene_, mu, mesh_, pair.paired, u);
  grid.of_nodes.push_back(
      {"gap", pair.nodal_gap - at_contact_dofs(pair.nodal_b) * at_columns(mesh_, u), "m"});
  const bool constant = pair_.discretisation.multiplier == MultiplierSpace::macro_edges;
  Vector pressure(constant ? count - 1 : count);
  for (Index k = 0; k < pressure.size(); ++k) {
    const Index node = pair.paired[k];
    pressure[k] = lambda[constant ? macro_edge_of(node, mesh_.parts[0], mesh_.degree) : node];
  }
  add_pressure(pressure, grid);
  return grid;
}

} // namespace

ContactRecipe two_bodies(Pair pair) {
  ContactRecipe recipe;
  recipe.entities = {InterfaceEntities::Kind::curves, {pair.slave, pair.master}, {1}, true};
  recipe.separable = false;
  recipe.keeps_nodes = true;
  recipe.make = [pair](const Scene &scene, InterfaceMesh mesh) {
    return std::make_unique<PairInterface>(scene, std::move(mesh), pair);
  };
  const auto &[multiplier, quadrature] = pair.discretisation;
  recipe.record = {
      "two_bodies",
      2,
      {{"linear_pressure", {multiplier == MultiplierSpace::nodes ? 1.0 : 0.0}},
       {"direct", {quadrature == PairQuadrature::direct ? 1.0 : 0.0}},
       {"closed_ends", {pair.closed_ends[0] ? 1.0 : 0.0, pair.closed_ends[1] ? 1.0 : 0.0}}},
      {{"slave", pair.slave}, {"master", pair.master}}};
  return recipe;
}

ContactKind two_bodies_kind() {
  return {"two_bodies", 2, [](const Record &record) {
            const std::vector<double> &closed = numbers(record, "closed_ends");
            const bool linear = number(record, "linear_pressure") != 0,
                       direct = number(record, "direct") != 0;
            return two_bodies({text(record, "slave"),
                               text(record, "master"),
                               {linear ? MultiplierSpace::nodes : MultiplierSpace::macro_edges,
                                direct ? PairQuadrature::direct : PairQuadrature::intersection},
                               {closed.front() != 0, closed.back() != 0}});
          }};
}

} // namespace rbvi
