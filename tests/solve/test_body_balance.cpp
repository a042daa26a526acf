// All forces on a body as outputs print them: they balance where every kind of term acts, and a
// wrong one is named with the body.
#include "../coarse_mesh.hpp"
#include "../mesh/temporary_file.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/scalar_forms.hpp"
#include "rbvi/fem/body_balance.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::body_balance_test {
namespace {

Scene scene_of(const std::string &text) {
  return make_scene(read_case("rbvi: 1\n"
                              "parameters: {d: {range: [0.02, 0.1], default: 0.05}}\n" +
                                  text,
                              "case.yaml"),
                    {});
}

/// What is left of each sum over its sizes, and how many there are.
std::vector<double> shares_left(Problem &problem, const Mu &mu, const Outputs &outputs) {
  std::vector<double> shares;
  for (const BodyForces &forces :
       forces_on_bodies(problem, expand(problem.scene().parameters, mu))) {
    const auto [left, sizes] = left_of(forces, outputs);
    shares.push_back(std::abs(left) / sizes);
  }
  return shares;
}

/// The sums of a case balance, so many of them; one force that is a thousandth off is refused.
void expect_balance(const Scene &scene, std::size_t sums, const std::string &named) {
  Problem problem(PETSC_COMM_WORLD, scene, {});
  const Mu mu{0.047};
  const HfSolution s = HighFidelity(problem, {}).solve(mu);
  const std::vector<double> shares = shares_left(problem, mu, s.outputs);
  EXPECT_EQ(shares.size(), sums);
  for (const double share : shares)
    EXPECT_LT(share, 1e-12);
  const FullMu all = expand(problem.scene().parameters, mu);
  check_balance(problem, all, s.outputs, 1e-10, 0);
  Outputs wrong = s.outputs;
  const auto output = std::ranges::find(wrong.named, named, &NamedOutput::name);
  ASSERT_NE(output, wrong.named.end());
  EXPECT_GT(std::abs(output->value), 1e-3);
  output->value *= 1.001;
  try {
    check_balance(problem, all, wrong, 1e-10, 0);
    ADD_FAILURE() << "a wrong " << named << " passes";
  } catch (const Error &error) {
    EXPECT_EQ(std::string(error.what()).find("the forces on the body of the boundary"), 0U)
        << error.what();
  }
}

/// One block with a map, imposed values, a motion, loads on cells and edges, a thermal strain, a
/// spring and two contacts.
TEST(BodyBalance, HoldsWhereEverythingActs) {
  const Scene scene = scene_of(
      "physics: plane_strain\nmesh: {built_in: one_block, degree: 2}\nmap: [1.2*x, 1.1*y]\n"
      "materials: {rubber: {at: all, E: 15, nu: 0.3, expansion: 0.01, temperature: 20*d}}\n"
      "motion: [0, -d]\nimposed: {top: {at: top, ux: -0.3*d*x, uy: motion}}\n"
      "loads:\n  weight: {at: all, force: [0, -2*d]}\n  edge: {at: top, traction: [0.5, 0]}\n"
      "  sides: {at: sides, pressure: 0.2*d}\n"
      "springs: {bolt: {at: contact, direction: [1, 0], stiffness: 3, pretension: d}}\n"
      "contact:\n  floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}, "
      "friction: {coulomb: 0.4}}\n"
      "  wall: {at: sides, against: {plane: {normal: [1, 0], position: 1.2 - 0.1*d}}}\n"
      "outputs:\n  up: {reaction: [0, 1], at: top}\n  aside: {reaction: [1, 0], at: top}\n"
      "  bolt: {spring: bolt}\n");
  expect_balance(scene, 2, "up");
  expect_balance(scene, 2, "bolt");
}

/// Two bodies on two boundaries each, in rows of both: one pushes the other.
std::string joint(const std::string &symmetry, const std::string &outputs) {
  return "physics: plane_strain\nmesh: {built_in: two_blocks, degree: 2}\n" + symmetry +
         "map: [x, 'y > 0 ? y - 0.25 : y + 0.25']\n"
         "materials: {rubber: {at: all, E: 15, nu: 0.35}}\n"
         "imposed: {top: {at: top, ux: 0, uy: -d}, bottom: {at: bottom, ux: 0, uy: 0}}\n"
         "loads: {side: {at: sides, traction: [0.1*x, d]}}\n"
         "contact: {faces: {at: slave, against: master, friction: {coulomb: 0.3}}}\n"
         "outputs:\n" +
         outputs;
}

TEST(BodyBalance, IsThatOfEachOfTwoBodies) {
  const std::string vertical =
      "  up: {reaction: [0, 1], at: top}\n  down: {reaction: [0, -1], at: bottom}\n";
  expect_balance(scene_of(joint("", vertical)), 2, "down");
  expect_balance(scene_of(joint("", vertical + "  aside: {reaction: [1, 0], at: top}\n")), 3, "up");
  expect_balance(scene_of(joint("", "  oblique: {reaction: [0.6, 0.8], at: top}\n")), 1, "oblique");
}

/// What no output has is not known, and nothing is said.
TEST(BodyBalance, OfUnknownForcesThereIsNone) {
  Problem problem(PETSC_COMM_WORLD, scene_of(joint("", "  wide: {mean: ux, at: top}\n")), {});
  EXPECT_TRUE(forces_on_bodies(problem, expand(problem.scene().parameters, {0.05})).empty());
}

/// Held in two places, of whose rows both reactions are.
const std::string beam =
    "physics: PHYSICS\nmesh: {built_in: one_block, degree: 2}\nMIRROR"
    "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
    "imposed: {top: {at: top, uy: -d}, axis: {at: sides, ux: 0}}\n"
    "loads: {weight: {at: all, force: [0, -d]}}\n"
    "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}"
    "FORMULATION}}\noutputs: {up: {reaction: [0, 1], at: top}}\n";

std::string with(std::string text, const std::string &key, const std::string &value) {
  return text.replace(text.find(key), key.size(), value);
}

TEST(BodyBalance, IsOfTheWholeOfHalfModelsAndTurnedBodiesAndByNitsche) {
  for (const std::string physics : {"plane_strain", "axisymmetric"})
    for (const std::string mirror : {"", "mirror: {x: 0}\n"})
      for (const std::string formulation : {"", ", formulation: nitsche"}) {
        if (physics == "axisymmetric" && !mirror.empty()) continue;
        SCOPED_TRACE(physics + mirror + formulation);
        expect_balance(scene_of(with(with(with(beam, "PHYSICS", physics), "MIRROR", mirror),
                                     "FORMULATION", formulation)),
                       1, "up");
      }
}

/// Of a square of area 1 over an obstacle in its middle.
Scene membrane(const std::string &more) {
  return scene_of("physics: membrane\nmesh: {built_in: square_with_disc, edges: 24, degree: 1}\n" +
                  more);
}

const std::string tilted = "imposed: {frame: {at: boundary, u: d + 0.3*x}}\n";

/// An answer on a membrane.
struct Pushed {
  Problem problem;
  const Mu mu{0.047};
  const FullMu all = expand(problem.scene().parameters, mu);
  HfSolution s = HighFidelity(problem, {}).solve(mu);
  explicit Pushed(const Scene &scene, const std::string &mesh = "")
      : problem(PETSC_COMM_WORLD, scene, {mesh}) {}
  MembraneForces forces() const {
    return forces_on_membrane(problem, all, s.u, s.lambda, s.outputs).value();
  }
  double share_left() const { return std::abs(forces().left()) / forces().sizes; }
};

/// Without contact the frame carries the load, and a plane carries nothing, whatever its tilt.
TEST(BodyBalance, AFrameCarriesTheLoadOfItsMembrane) {
  const Pushed loaded(membrane(
      tilted +
      "loads: {weight: {at: all, force: -25}}\ncontact: {far: {at: obstacle, above: -9}}\n"));
  EXPECT_NEAR(loaded.forces().load, -25, 1e-12 * 25);
  EXPECT_NEAR(loaded.forces().flux, 25, 1e-12 * 25);
  EXPECT_EQ(loaded.forces().contact, 0);
  const Pushed plane(membrane(tilted + "contact: {far: {at: obstacle, above: -9}}\n"));
  EXPECT_GT(plane.forces().sizes, 0.3) << "it pulls up here and down there";
  EXPECT_NEAR(plane.forces().flux, 0, 1e-12 * plane.forces().sizes);
}

/// With contact and a map; in the middle, and on the whole of the membrane, where nodes of the
/// frame have no multiplier (lumped) or share that of a node beside them.
TEST(BodyBalance, IsThatOfAMembraneWithContact) {
  for (const bool lumped : {true, false})
    for (const bool whole : {true, false}) {
      Scene scene = membrane(
          tilted + "map: [1.1*x + d*y, y + 0.2*x*y]\n" +
          "loads: {weight: {at: all, force: -20 - 5*x}}\n" +
          "contact: {table: {at: obstacle, above: d - 0.05 - 0.6*x*x - 0.4*y*y, lumped: " +
          (lumped ? "yes" : "no") + "}}\noutputs: {rim: {reaction: [1, 0], at: boundary}}\n");
      scene.mesh.facts.clear(); // the region is no disc
      const TemporaryFile file(whole ? one_region() : coarse_gmsh());
      Pushed pushed(scene, file.name());
      EXPECT_GT(pushed.forces().contact, 1) << "there is something to compare";
      EXPECT_LT(pushed.share_left(), 1e-13);
      EXPECT_NEAR(pushed.s.outputs.named.front().value, pushed.forces().flux,
                  1e-12 * pushed.forces().sizes);
      const std::vector<double> shares = shares_left(pushed.problem, pushed.mu, pushed.s.outputs);
      ASSERT_EQ(shares.size(), 1U);
      EXPECT_LT(shares.front(), 1e-13);
      const double right = *pushed.s.outputs.normal_force;
      pushed.s.outputs.normal_force = -right;
      EXPECT_GT(pushed.share_left(), 0.01) << "a wrong sign of contact";
      pushed.s.outputs.normal_force = right;
      pushed.s.u -= pushed.problem.imposed_displacement(pushed.mu);
      EXPECT_GT(pushed.share_left(), 1e-3) << "imposed values are left out";
    }
}

/// A row of the rim that is dropped, and the name in what is said.
TEST(BodyBalance, NamesAMembraneThatDoesNotBalance) {
  Pushed pushed(membrane("imposed: {frame: {at: boundary, u: 0}}\n"
                         "loads: {weight: {at: all, force: -25}}\n"
                         "contact: {table: {at: obstacle, above: -0.2 - 0.1*d}}\n"));
  const auto check = [&] {
    check_membrane(pushed.problem, pushed.all, pushed.s.u, pushed.s.lambda, pushed.s.outputs, 1e-10,
                   0);
  };
  check();
  const Mesh &mesh = pushed.problem.mesh();
  for (std::size_t node = 0; node < mesh.points.size(); ++node) // in one corner no flux is left
    if (const Point &x = mesh.points[node]; x[0] > 0.35 && x[1] > 0.35)
      pushed.s.u[mesh.natural_node[node]] = 0;
  try {
    check();
    ADD_FAILURE() << "a dropped row passes";
  } catch (const Error &error) {
    EXPECT_EQ(std::string(error.what()).find("the forces on the membrane of 'table' do not"), 0U)
        << error.what();
  }
}

/// Springs of so much per area carry a part that no row tells: nothing is said.
TEST(BodyBalance, OfAMembraneOnABedNothingIsKnown) {
  Scene scene = membrane("imposed: {frame: {at: boundary, u: 0}}\n"
                         "loads: {weight: {at: all, force: -25}}\n"
                         "contact: {table: {at: obstacle, above: -0.2 - 0.1*d}}\n");
  scene.a.push_back(exact_term(h1_product(0, 1, 1)));
  scene.tree.clear();
  const Pushed pushed(scene);
  EXPECT_FALSE(forces_on_membrane(pushed.problem, pushed.all, pushed.s.u, pushed.s.lambda,
                                  pushed.s.outputs));
}

} // namespace
} // namespace rbvi::body_balance_test
