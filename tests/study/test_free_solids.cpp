// A heavy cube in space that its floor alone holds, by friction with a direction, or that slips
// against springs: balance, and derivatives of what its model answers.
#include "../cube_mesh.hpp"
#include "../mesh/temporary_file.hpp"
#include "reduced.hpp"

#include "rbvi/model/gradient.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/case.hpp"

#include <gtest/gtest.h>

namespace rbvi::free_solids_test {
namespace {

using testing_reduced::Reduced;

Scene cube(const std::string &more) {
  return make_scene(
      read_case("rbvi: 1\nphysics: solid\nmesh: {file: cube.msh, degree: 2}\nsmall: yes\n"
                "parameters: {gx: {range: [0.02, 0.2], default: 0.1}, gy: {range: [0.02, 0.1], "
                "default: 0.05}}\nmaterials: {m: {at: all, E: 100, nu: 0.3}}\n"
                "loads: {weight: {at: all, force: [gx, gy, -1]}}\n" +
                    more,
                "case.yaml"),
      {});
}

std::string floor_with(const std::string &friction) {
  return "contact: {floor: {at: z0, against: {plane: {normal: [0, 0, -1], position: 0}}, "
         "friction: {coulomb: " +
         friction + "}}}\n";
}

struct OneModel {
  TemporaryFile mesh{cube_mesh(3)};
  Reduced made;
  explicit OneModel(const std::string &more)
      : made(cube(more), "grid:3,3", PETSC_COMM_WORLD, {mesh.name()}) {
    made.reduce(testing_reduced::everything());
  }
};

/// Of every output by every parameter, against differences of fourth order of separate queries.
void expect_derivatives(const OneModel &one, const Mu &mu) {
  OnlineSolver online(one.made.model);
  const auto outputs_at = [&](const Mu &at) { return online.outputs(at, online.solve(at)); };
  const ReducedAnswer answer = online.solve(mu);
  const std::vector<OutputColumn> columns = columns_of({online.outputs(mu, answer)});
  const OutputGradient found = gradient_of(online, mu, answer, columns);
  constexpr double h = 1e-4;
  for (int p = 0; p < 2; ++p)
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (columns[c].kind != OutputKind::quantity) continue;
      double difference = 0;
      for (const auto &[steps, weight] :
           {std::pair{-2, 1.0}, std::pair{-1, -8.0}, std::pair{1, 8.0}, std::pair{2, -1.0}}) {
        Mu moved = mu;
        moved[p] += steps * h;
        difference += weight * columns[c].of(outputs_at(moved)).value() / (12 * h);
      }
      EXPECT_NEAR(found.values(static_cast<Index>(c), p), difference,
                  1e-5 * (1 + std::abs(difference)))
          << columns[c].name;
    }
}

/// What contact bears is the weight; part of the foot slips.
TEST(FreeSolids, ACubeThatFrictionHolds) {
  OneModel one(floor_with("0.25"));
  const Mu mu{0.15, 0.05};
  HighFidelity solver(one.made.problem, {});
  const HfSolution full = solver.solve(mu);
  EXPECT_LE(full.kkt.largest(), 1e-10);
  if (rank_of(PETSC_COMM_WORLD) != 0) return;
  OnlineSolver online(one.made.model);
  for (const Outputs &outputs : {full.outputs, online.outputs(mu, online.solve(mu))}) {
    EXPECT_NEAR(outputs.force_x.value(), -mu[0], 1e-10);
    EXPECT_NEAR(outputs.force_y.value(), -mu[1], 1e-10);
    EXPECT_NEAR(outputs.force_z.value(), 1, 1e-10);
    EXPECT_GT(outputs.stick_nodes.value(), 1);
    EXPECT_LT(outputs.stick_nodes.value(), outputs.contact_nodes.value());
  }
  expect_derivatives(one, mu);
}

/// All of its foot slips, and springs on its top bear the rest; that it does not turn about the
/// vertical is due to tractions that follow the slip.
TEST(FreeSolids, ACubeThatSlipsAgainstSprings) {
  OneModel one("springs:\n  x: {at: z1, stiffness: 1, direction: [1, 0, 0]}\n"
               "  y: {at: z1, stiffness: 2, direction: [0, 1, 0]}\n" +
               floor_with("0.02"));
  const Mu mu{0.11, 0.07};
  const HfSolution full = HighFidelity(one.made.problem, {}).solve(mu);
  EXPECT_LE(full.kkt.largest(), 1e-10);
  EXPECT_EQ(full.outputs.stick_nodes.value(), 0);
  EXPECT_NEAR(full.outputs.normal_force.value(), 1, 1e-10);
  EXPECT_NEAR(full.outputs.tangential_force.value(), 0.02, 1e-5) << "nearly in one direction";
  if (rank_of(PETSC_COMM_WORLD) == 0) expect_derivatives(one, mu);
}

} // namespace
} // namespace rbvi::free_solids_test
