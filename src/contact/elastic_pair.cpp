#include "rbvi/contact/elastic_pair.hpp"

#include "rbvi/contact/large_pair.hpp"
#include "rbvi/contact/pair.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"

namespace rbvi {

namespace {

std::vector<SceneOption> pair_options() {
  return {{"multiplier",
           "p0",
           "pressure: constant on pairs of edges, of degree 2 on edges (p0), or continuous (p1)",
           {"p0", "p1"}},
          {"integration",
           "intersection",
           "contact integrals: edges intersected, or Gauss points of the upper body alone",
           {"intersection", "direct"}}};
}

} // namespace

PairDiscretisation pair_discretisation(const SceneOptions &options) {
  return {options.at("multiplier") == "p1" ? MultiplierSpace::nodes : MultiplierSpace::macro_edges,
          options.at("integration") == "direct" ? PairQuadrature::direct
                                                : PairQuadrature::intersection};
}

std::vector<SceneOption> elastic_pair_options(int degree, const std::vector<SceneOption> &own) {
  std::vector<SceneOption> options = pair_options();
  options.push_back({"kinematics",
                     "small",
                     "contact of the undeformed bodies along e_y, or (large) where they now are",
                     {"small", "large"}});
  options.push_back({"degree", std::to_string(degree), "of the displacement", {"1", "2"}});
  options.push_back({"young", "15", "Young's modulus", {}, young_range});
  options.push_back({"poisson_ratio", "0.35", "Poisson's ratio", {}, poisson_range});
  options.insert(options.end(), own.begin(), own.end());
  return options;
}

void set_elastic_pair(const SceneOptions &options, std::array<bool, 2> closed_ends, Scene &scene) {
  scene.dim = 2;
  scene.components = 2;
  scene.degree = options.at("degree") == "2" ? 2 : 1;
  const PairDiscretisation discretisation = pair_discretisation(options);
  if (options.at("kinematics") == "small") {
    scene.contacts = {two_bodies({"slave", "master", discretisation, closed_ends})};
  } else {
    if (discretisation.quadrature == PairQuadrature::direct)
      throw bad_input("-integration direct is for small deformations: leave it out with "
                      "-kinematics large");
    scene.contacts = {deformed_bodies({"slave", "master", discretisation.multiplier})};
  }
  const Lame material = lame(number_in(options, "young"), number_in(options, "poisson_ratio"));
  scene.material = everywhere(material);
  scene.a = {exact_term(elasticity("", material, scene.degree))};
  scene.v_product = {exact_term(h1_product(1, 2, scene.degree))};
}

} // namespace rbvi
