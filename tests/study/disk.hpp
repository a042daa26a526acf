// The rigid disk with few edges on its arc, and reductions of its multipliers.
#pragma once

#include "tests/catalogue.hpp"
#include "rbvi/mor/reduce.hpp"

namespace rbvi::testing_reduced {

inline Scene disk(const std::string &free, const SceneOptions &options = {}) {
  SceneOptions all{{"arc_edges", "40"}};
  for (const auto &[name, value] : options)
    all[name] = value;
  Scene scene = make_scene("rigid_disk", all);
  scene.parameters = free_only(scene.parameters, free);
  return scene;
}

inline ReduceOptions with(MultiplierReduction reduction) {
  ReduceOptions options;
  options.pod.tolerance = 1e-7;
  options.eim.tolerance = 1e-10;
  options.multipliers.reduction = reduction;
  options.cone.type = ConeType::mcpg;
  return options;
}

/// The published pair, without the condensed operator.
inline ReduceOptions published() {
  ReduceOptions options = with(MultiplierReduction::collocated);
  options.multipliers.exact = false;
  options.pod.tolerance = 1e-6;
  options.cone.tolerance = 1e-3;
  options.infsup_tolerance = true;
  return options;
}

} // namespace rbvi::testing_reduced
