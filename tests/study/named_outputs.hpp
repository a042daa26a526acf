// Outputs of a case's own by name, and a block that has some.
#pragma once

#include "reduced.hpp"

#include "rbvi/model/online.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/case.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>

namespace rbvi::named_outputs_test {

using testing_reduced::Reduced;

inline std::map<std::string, double> values_of(const Outputs &outputs) {
  std::map<std::string, double> values;
  for (const auto &[name, value] : outputs.named)
    values[name] = value;
  return values;
}

/// Pressed onto the floor and sheared by what is imposed on its top, with a load that is fixed
/// there in part, or by a spring; `map` scales it.
inline Scene pressed(const std::string &hold, const std::string &outputs,
                     const std::string &physics, const std::string &map = "",
                     const std::string &friction = ", friction: {coulomb: 0.4}") {
  const std::string text =
      "rbvi: 1\nphysics: " + physics + "\nmesh: {built_in: one_block, degree: 2}\n" + map +
      "parameters: {d: {range: [0.02, 0.1], default: 0.05}, young: {range: [10, 20], default: "
      "15}}\n"
      "materials: {rubber: {at: all, E: young, nu: 0.3}}\n" +
      hold + "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}" +
      friction + "}}\noutputs:\n  pressed: {integral: pressure}\n" +
      (friction.empty() ? "" : "  sheared: {integral: tangential}\n") + outputs;
  return make_scene(read_case(text, "block.yaml"), {});
}

/// The same of a full answer and of a model, at a parameter that was no sample.
inline void compare_balance(const Scene &scene, const Mu &mu,
                            const std::function<void(std::map<std::string, double>)> &expect) {
  {
    Problem problem(PETSC_COMM_WORLD, scene, {});
    expect(values_of(HighFidelity(problem, {}).solve(mu).outputs));
  }
  Reduced made(scene, "grid:3,3");
  made.reduce(testing_reduced::everything());
  if (rank_of(PETSC_COMM_WORLD) != 0) return;
  OnlineSolver online(made.model);
  expect(values_of(online.outputs(mu, online.solve(mu))));
}

} // namespace rbvi::named_outputs_test
