#include "rbvi/contact/two_curves.hpp"

#include "rbvi/core/formula.hpp"

namespace rbvi {

TwoCurves::TwoCurves(const Scene &scene, InterfaceMesh interface_mesh, MultiplierSpace space)
    : ContactInterface(scene, std::move(interface_mesh)), space_(space) {
  (void)check_curve(mesh_, 0, "slave curve");
  (void)check_curve(mesh_, 1, "master curve");
  slave_.assign(mesh_.points.begin(), mesh_.points.begin() + mesh_.parts[0]);
  dual_.points = multiplier_points(slave_, space, mesh_.degree);
  dual_.gram = multiplier_product(slave_, space, mesh_.degree, scene.axisymmetric);
}

NodalCurve TwoCurves::slave_at_rest(const FullMu &mu) const {
  return {images(scene_.map, mu, slave_), mesh_.degree};
}

void TwoCurves::outputs(const FullMu &mu, const ContactOperators &operators, const Vector &lambda,
                        double least, Outputs &outputs) const {
  pressure_outputs(scene_.mirror_images, operators.weights, lambda, least, outputs);
  const Vector whole =
      whole_weights(slave_at_rest(mu).hats(scene_.axisymmetric), space_, mesh_.degree);
  outputs.ends_in_contact =
      ends_in_contact(whole, operators.weights, lambda, least, {mesh_.closed(0), mesh_.closed(1)});
}

Grid TwoCurves::fields(const FullMu &mu, const Vector &u, const Vector &lambda) {
  const Vector state = at_columns(mesh_, u);
  const PairOperators pair = operators_at(mu, {state});
  const Index count = std::ssize(pair.paired);
  if (count < 2) return {};
  Grid grid = polyline(scene_, mu, mesh_, pair.paired, u);
  add_gap(pair.nodal_gap - pair.nodal_b * state, pair.normals, grid);
  const bool constant = space_ == MultiplierSpace::macro_edges;
  Vector pressure(constant ? count - 1 : count);
  for (Index k = 0; k < pressure.size(); ++k) {
    const Index node = pair.paired[k];
    pressure[k] = lambda[constant ? macro_edge_of(node, mesh_.parts[0], mesh_.degree) : node];
  }
  add_pressure(pressure, grid);
  return grid;
}

} // namespace rbvi
