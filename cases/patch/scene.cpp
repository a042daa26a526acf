// Two elastic blocks, 1 wide and 0.5 high, on top of each other, their meshes not matching. The
// sides do not move sideways, the foot is fixed, the top goes down by the parameter. Exactly:
// uniaxial strain -indentation, pressure E (1 - nu) / ((1 + nu) (1 - 2 nu)) indentation.
#include "scene.hpp"

#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"

namespace rbvi {

namespace {

constexpr double apart = 0.25; ///< of each reference block from the contact line y = 0

Scene make(const SceneOptions &options) {
  Scene scene;
  scene.dim = 2;
  scene.components = 2;
  scene.parameters = all_free({{"indentation", "m", 0.01, 0.1, 0.05}});
  scene.training = "grid:5";
  scene.validation = "random:5:1";
  scene.mesh = {
      "two_blocks", {"upper", "lower"}, {"sides", "top", "bottom", "slave", "master"}, ""};
  scene.map = [](const Mu &, const Point &x) -> Point {
    return {x[0], x[1] - (x[1] > 0 ? apart : -apart), 0};
  };
  scene.fixed = {{"sides", {0}}, {"top", {}}, {"bottom", {}}};
  scene.motion = [](const Mu &mu, const Point &x) -> Point {
    return {0, x[1] > 0 ? -mu[0] : 0, 0};
  };
  scene.pair = PairRecipe{"slave", "master", pair_discretisation(options)};
  scene.a = elasticity("", number_in(options, "young"), number_in(options, "poisson_ratio"));
  scene.a_parameters = std::vector<int>{};
  scene.v_product = h1_product(1, 2);
  return scene;
}

} // namespace

SceneEntry patch() {
  SceneEntry entry{"patch",
                   "patch test: two blocks on top of each other, their meshes not matching",
                   pair_options(), make};
  entry.options.insert(entry.options.end(), {{"young", "15", "Young's modulus", {}},
                                             {"poisson_ratio", "0.35", "Poisson's ratio", {}}});
  return entry;
}

} // namespace rbvi
