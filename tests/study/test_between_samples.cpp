// Models of bodies whose shape is a parameter, sampled at few shapes: what their answers miss at
// shapes between the samples.
#include "reduced.hpp"

#include "rbvi/scene/case.hpp"

#include <gtest/gtest.h>

namespace rbvi::between_samples_test {
namespace {

using testing_reduced::Reduced;

/// The largest errors of u and of the multipliers at shapes between the samples, relative.
ModelErrors errors_between(const std::string &text, const std::string &training,
                           double interpolation) {
  Reduced made(make_scene(read_case("rbvi: 1\nphysics: plane_strain\n" + text, "case.yaml"), {}),
               training);
  ReduceOptions options;
  options.multipliers.reduction = MultiplierReduction::condensed;
  options.eim.tolerance = interpolation;
  made.reduce(options);
  return made.errors_at(testing_reduced::solve_all(
      made.problem, parse_set(made.problem.scene().parameters, "random:6:3")));
}

double worst(const Vector &errors) {
  return errors.size() == 0 ? 1 : errors.maxCoeff();
}

/// The middle and the ends of the height are sampled; contact alone holds the block, or its lid.
TEST(BetweenSamples, ABlockWhoseHeightVaries) {
  for (const std::string held : {"ux: 0", "ux: 0, uy: -0.01"}) {
    SCOPED_TRACE(held);
    const ModelErrors errors = errors_between(
        "mesh: {built_in: one_block, degree: 2}\nmap: [x, c*y]\n"
        "parameters: {c: {range: [0.7, 1.4], default: 1}, q: {range: [1, 2], default: 1.5}}\n"
        "materials: {r: {at: all, E: 1000, nu: 0.3}}\nimposed: {lid: {at: top, " +
            held +
            "}}\nloads: {p: {at: sides, traction: [0, '-q*(1 + 2*x)']}, weight: {at: all, force: "
            "[0, -1]}}\n"
            "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}}}\n",
        "grid:3,3", 1e-4);
    EXPECT_LE(worst(errors.u), 1e-4);
    EXPECT_LE(worst(errors.lambda), 1e-7);
  }
}

/// B is interpolated, with as many terms as its tolerance asks for.
TEST(BetweenSamples, ABlockWhoseWidthVariesUnevenly) {
  const ModelErrors errors = errors_between(
      "mesh: {built_in: one_block, degree: 2}\nmap: [x + 0.1*sin(c*x), y]\n"
      "parameters: {c: {range: [1, 3], default: 2}, d: {range: [0.01, 0.1], default: 0.05}}\n"
      "materials: {r: {at: all, E: 100, nu: 0.3}}\n"
      "imposed: {lid: {at: top, ux: 0.1*d, uy: -d}}\nsmall: yes\n"
      "contact: {floor: {at: contact, against: {plane: {normal: [0.28, -0.96], position: "
      "0.25}}, friction: {coulomb: 0.3}}}\n",
      "grid:9,3", 1e-5);
  EXPECT_LE(worst(errors.u), 1e-3);
  EXPECT_LE(worst(errors.lambda), 1e-3);
}

/// A thin beam of any curvature: its stiffness in bending is a small rest of large entries.
TEST(BetweenSamples, ABeamWhoseCurvatureVaries) {
  const ModelErrors errors = errors_between(
      "mesh: {built_in: one_block, degree: 2}\nsmall: yes\n"
      "map: ['(1/k - 0.1*y)*sin(k*(x - 0.5))', '1/k - (1/k - 0.1*y)*cos(k*(x - 0.5))']\n"
      "parameters: {k: {range: [0.5, 1.5], default: 1}, q: {range: [1, 2], default: 1.5}}\n"
      "materials: {r: {at: all, E: 1e3, nu: 0.3}}\n"
      "imposed: {ends: {at: sides, ux: 0, uy: 0}}\nloads: {p: {at: top, traction: [0, -q]}}\n"
      "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: 0.002}}}}\n",
      "grid:9,3", 1e-4);
  EXPECT_LE(worst(errors.u), 1e-4);
  EXPECT_LE(worst(errors.lambda), 5e-4) << "b and g are interpolated to 1e-4";
}

} // namespace
} // namespace rbvi::between_samples_test
