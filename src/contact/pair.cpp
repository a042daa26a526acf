#include "rbvi/contact/pair.hpp"

#include "rbvi/contact/two_curves.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/formula.hpp"

namespace rbvi {

namespace {

class PairInterface : public TwoCurves {
public:
  PairInterface(const Scene &scene, InterfaceMesh mesh, const Pair &pair);

private:
  PairOperators operators_at(const FullMu &mu, const ContactState &) const override;

  PairQuadrature quadrature_;
  std::vector<int> vertical_; ///< the columns of the nodes
};

PairInterface::PairInterface(const Scene &scene, InterfaceMesh interface_mesh, const Pair &pair)
    : TwoCurves(scene, std::move(interface_mesh), pair.discretisation.multiplier),
      quadrature_(pair.discretisation.quadrature) {
  for (Index i = 0; i < mesh_.nodes(); ++i) {
    vertical_.push_back(mesh_.components == 2 ? mesh_.dofs[2 * i + 1] : -1);
    if (vertical_.back() < 0)
      throw bad_input("two bodies meet along curves whose nodes all move vertically");
  }
}

PairOperators PairInterface::operators_at(const FullMu &mu, const ContactState &) const {
  const std::vector<Point> mapped = images(scene_.map, mu, mesh_.points);
  const auto master = mapped.begin() + mesh_.parts[0];
  PairOperators pair;
  try {
    pair = pair_operators(vertical_partners({mapped.begin(), master}, {master, mapped.end()},
                                            quadrature_, mesh_.degree, scene_.axisymmetric),
                          space_, vertical_, mesh_.columns);
  } catch (const Error &error) { // the fault of this mu, not of the input
    throw failure(std::string(error.what()) + ", mapped at " + describe(scene_.parameters, mu));
  }
  if (!scene_.motion) return pair;
  Vector moved = Vector::Zero(mesh_.columns);
  const std::vector<Point> motion = images(scene_.motion, mu, mesh_.points);
  for (Index i = 0; i < mesh_.nodes(); ++i)
    moved[vertical_[i]] = motion[i][1];
  pair.g -= pair.b * moved;
  pair.nodal_gap -= pair.nodal_b * moved;
  return pair;
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
  recipe.record = {"two_bodies",
                   3,
                   {{"linear_pressure", {multiplier == MultiplierSpace::nodes ? 1.0 : 0.0}},
                    {"direct", {quadrature == PairQuadrature::direct ? 1.0 : 0.0}}},
                   {{"slave", pair.slave}, {"master", pair.master}}};
  return recipe;
}

ContactKind two_bodies_kind() {
  return {"two_bodies", 3, [](const Record &record) {
            const bool linear = number(record, "linear_pressure") != 0,
                       direct = number(record, "direct") != 0;
            return two_bodies({text(record, "slave"),
                               text(record, "master"),
                               {linear ? MultiplierSpace::nodes : MultiplierSpace::macro_edges,
                                direct ? PairQuadrature::direct : PairQuadrature::intersection}});
          }};
}

} // namespace rbvi
