// Two elastic blocks, 1 wide and 0.5 high, on top of each other, their meshes not matching. The
// sides do not move sideways, the foot is fixed, the top goes down by the parameter. Exactly:
// uniaxial strain -indentation, pressure E (1 - nu) / ((1 + nu) (1 - 2 nu)) indentation.
#include "scene.hpp"

#include "rbvi/element/elastic_pair.hpp"

namespace rbvi {

namespace {

constexpr double apart = 0.25; ///< of each reference block from the contact line y = 0

Scene make(const SceneOptions &options) {
  Scene scene;
  set_elastic_pair(options, scene);
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
  return scene;
}

} // namespace

SceneEntry patch() {
  return {"patch", "patch test: two blocks on top of each other, their meshes not matching",
          elastic_pair_options(), make};
}

} // namespace rbvi
