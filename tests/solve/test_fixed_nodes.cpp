// Contact that reaches where the displacement is fixed: no multiplier without a displacement, and
// all that there is of the pressure.
#include "../coarse_mesh.hpp"
#include "../mesh/temporary_file.hpp"
#include "block_on_support.hpp"
#include "rbvi/contact/obstacle.hpp"
#include "rbvi/contact/support.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/facet_forms.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace rbvi::fixed_nodes_test {
namespace {

struct Solved {
  HfSolution solution;
  std::vector<Point> nodes; ///< of the multipliers
  Vector weights;
};

Solved solve(const Scene &scene, const Mu &mu, const std::string &mesh = "", int refine = 0,
             HfMethod method = HfMethod::active_set) {
  Problem problem(PETSC_COMM_WORLD, scene, {mesh, refine}, 0);
  HfOptions options;
  options.method = method;
  options.uzawa.accelerated = true;
  options.uzawa.tolerance = 1e-9;
  Solved result{HighFidelity(problem, options).solve(mu), dual_points(problem.contact()), {}};
  result.weights = problem.assemble(mu).weights;
  return result;
}

Scene membrane(const std::string &lumped) {
  Scene scene = make_scene("membrane_obstacle", {{"lumped", lumped}});
  scene.mesh.facts.clear(); // its region is no disc
  return scene;
}

/// Outside of the disc the obstacle is far below: with or without it there, the answer is the same.
TEST(FixedNodes, AnObstacleUnderAllOfTheMembraneIsThatUnderTheDisc) {
  for (const char *lumped : {"yes", "no"}) {
    const Mu mu{0.18, 0.02, -0.01};
    Solved disc, whole;
    {
      const TemporaryFile file(coarse_gmsh());
      disc = solve(membrane(lumped), mu, file.name());
    }
    const TemporaryFile file(one_region());
    whole = solve(membrane(lumped), mu, file.name());
    EXPECT_LE(whole.solution.kkt.largest(), 1e-12);
    EXPECT_LE((whole.solution.u - disc.solution.u).norm(), 1e-11 * disc.solution.u.norm());
    EXPECT_NEAR(*whole.solution.outputs.normal_force, *disc.solution.outputs.normal_force, 1e-10);
    EXPECT_LT(whole.nodes.size(), 181U) << "the nodes of the boundary have no multiplier";
    EXPECT_GT(whole.nodes.size(), disc.nodes.size());
  }
}

/// A plane that meets the left side, where the membrane is fixed: in contact with it the membrane
/// is straight, and the pressure is the load.
TEST(FixedNodes, ThePressureBesideTheBoundaryIsThatOfTheLoad) {
  const TemporaryFile file(one_region());
  const Mu mu{0.2, 0, 0};
  for (const bool lumped : {true, false}) {
    Scene scene = membrane("no");
    const auto plane = [](const FullMu &, const Point &x) { return -0.1 * (x[0] + 0.5); };
    scene.contacts = {obstacle({"obstacle", plane, lumped})};
    const Solved exact = solve(scene, mu, file.name(), 1);
    const Vector &lambda = exact.solution.lambda;
    EXPECT_LE(exact.solution.kkt.largest(), 1e-12);
    int beside = 0;
    for (std::size_t i = 0; i < exact.nodes.size(); ++i)
      if (exact.nodes[i][0] < -0.4 && std::abs(exact.nodes[i][1]) < 0.1) {
        EXPECT_NEAR(lambda[static_cast<Index>(i)], 25, lumped ? 1e-9 : 2.5) << exact.nodes[i][0];
        ++beside;
      }
    EXPECT_GE(beside, 3);
    const Solved steps = solve(scene, mu, file.name(), 1, HfMethod::uzawa);
    EXPECT_LE((steps.solution.lambda - lambda).norm(), 1e-5 * lambda.norm());
  }
}

/// A block between two walls that hold it, pushed onto a floor from above.
Scene held_block(const std::string &degree, bool friction, bool lumped) {
  Scene scene = block_on_support::block(degree);
  scene.motion = {};
  scene.fixed = {{"sides", {}}};
  const auto down = [](const FullMu &, const Point &, const Point &) { return Point{0, -1, 0}; };
  scene.f = {exact_term(traction_load("top", down, 2, scene.degree))};
  Support floor{"contact", everywhere(Point{0, -1, 0}), everywhere(0.0)};
  if (friction) floor.friction = {FrictionLaw::coulomb, [](const FullMu &mu) { return mu[2]; }};
  floor.lumped = lumped;
  scene.contacts = {rigid_support(floor)};
  return scene;
}

TEST(FixedNodes, ABlockBetweenWallsRestsOnAFloor) {
  const Mu mu{0.05, 0.02, 0.3};
  for (const std::string degree : {"1", "2"})
    for (const bool friction : {false, true})
      for (const bool lumped : {false, true}) {
        SCOPED_TRACE("degree " + degree + (friction ? ", friction" : "") +
                     (lumped ? ", lumped" : ""));
        const Scene scene = held_block(degree, friction, lumped);
        const Solved exact = solve(scene, mu);
        const HfSolution &s = exact.solution;
        EXPECT_LE(s.kkt.largest(), 1e-11);
        EXPECT_GT(*s.outputs.normal_force, 0.3) << "the floor carries most of the load";
        EXPECT_LT(*s.outputs.normal_force, 1) << "the walls carry the rest";
        EXPECT_EQ(exact.nodes.front()[0] > 0 && exact.nodes.back()[0] < 1, true);
        // Vertex quadrature leaves out half an edge at either end.
        EXPECT_NEAR(exact.weights.sum(), 1, lumped ? 0.11 : 1e-12);
        const Solved steps = solve(scene, mu, "", 0, HfMethod::uzawa);
        EXPECT_LE((steps.solution.lambda - s.lambda).norm(), 1e-4 * s.lambda.norm());
        const double finer = *solve(scene, mu, "", 1).solution.outputs.normal_force;
        EXPECT_NEAR(finer, *s.outputs.normal_force, 0.1 * finer);
      }
}

/// The left half of a block, or all of it, whose top is pushed down onto a floor: on the axis the
/// half moves up and down alone.
Scene pressed(const std::string &degree, bool friction, bool lumped, bool half) {
  Scene scene = held_block(degree, friction, lumped);
  scene.mesh.facts.clear(); // it is half as wide
  scene.motion = [](const FullMu &mu, const Point &) { return Point{0, -mu[0], 0}; };
  scene.fixed = {{"top", {}}};
  if (half) scene.fixed.push_back({"sides", {0}});
  scene.f.clear();
  return scene;
}

/// Triangles of [0, 1] x [0, 0.5], mirrored about x = 0.5, or of the left half alone; `sides` is
/// its right side.
std::string rectangle(bool half) {
  const int columns = half ? 8 : 16, rows = 8;
  std::ostringstream nodes, cells;
  const auto number = [&](int i, int j) { return 1 + i * (rows + 1) + j; };
  int count = 0;
  for (int i = 0; i <= columns; ++i)
    for (int j = 0; j <= rows; ++j)
      nodes << number(i, j) << ' ' << i / 16.0 << ' ' << 0.5 * j / rows << " 0\n";
  const auto triangle = [&](int a, int b, int c) {
    cells << ++count << " 2 2 1 1 " << a << ' ' << b << ' ' << c << '\n';
  };
  const auto edge = [&](int of, int a, int b) {
    cells << ++count << " 1 2 " << of << ' ' << of << ' ' << a << ' ' << b << '\n';
  };
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) {
      const int a = number(i, j), b = number(i + 1, j), c = number(i + 1, j + 1),
                d = number(i, j + 1);
      if (i < 8) {
        triangle(a, b, c);
        triangle(a, c, d);
      } else {
        triangle(a, b, d);
        triangle(b, c, d);
      }
    }
  for (int i = 0; i < columns; ++i) {
    edge(3, number(i, rows), number(i + 1, rows));
    edge(4, number(i, 0), number(i + 1, 0));
  }
  for (int j = 0; j < rows; ++j) // the axis of the half
    edge(2, number(columns, j), number(columns, j + 1));
  std::ostringstream text;
  text << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 2 \"sides\"\n1 3 "
          "\"top\"\n1 4 \"contact\"\n$EndPhysicalNames\n$Nodes\n"
       << number(columns, rows) << '\n'
       << nodes.str() << "$EndNodes\n$Elements\n"
       << count << '\n'
       << cells.str() << "$EndElements\n";
  return text.str();
}

TEST(FixedNodes, HalfOfASymmetricBodyAnswersAsTheWhole) {
  const Mu mu{0.05, 0.02, 0.2};
  for (const std::string degree : {"1", "2"})
    for (const bool friction : {false, true})
      for (const bool lumped : {false, true}) {
        SCOPED_TRACE("degree " + degree + (friction ? ", friction" : "") +
                     (lumped ? ", lumped" : ""));
        const auto answer = [&](bool is_half, HfMethod method = HfMethod::active_set) {
          const TemporaryFile file(rectangle(is_half));
          return solve(pressed(degree, friction, lumped, is_half), mu, file.name(), 0, method);
        };
        const Solved half = answer(true), whole = answer(false);
        const Index nodes = std::ssize(half.nodes), all = std::ssize(whole.nodes);
        ASSERT_EQ(all, 2 * nodes - 1);
        EXPECT_LE(half.solution.kkt.largest(), 1e-11);
        const Vector &one = half.solution.lambda, &other = whole.solution.lambda;
        EXPECT_LE((one.head(nodes) - other.head(nodes)).norm(), 1e-9 * one.norm());
        EXPECT_NEAR(2 * *half.solution.outputs.normal_force, *whole.solution.outputs.normal_force,
                    1e-9);
        if (!friction) continue;
        EXPECT_LE((one.tail(nodes) - other.segment(all, nodes)).norm(), 1e-9 * one.norm());
        EXPECT_GT(one.tail(nodes).norm(), 0.01 * one.norm());
        EXPECT_EQ(one[2 * nodes - 1], 0) << "no traction on the axis";
        if (lumped || degree == "2") continue;
        const Solved steps = answer(true, HfMethod::uzawa);
        EXPECT_LE((steps.solution.lambda - one).norm(), 1e-4 * one.norm());
      }
}

TEST(FixedNodes, ANodeThatCannotMoveAlongItsNormalIsRefused) {
  const TemporaryFile file(rectangle(true));
  Scene scene = pressed("1", false, false, true);
  scene.fixed = {{"sides", {1}}, {"top", {}}};
  try {
    solve(scene, {0.05, 0.02, 0.2}, file.name());
    FAIL() << "accepted";
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    EXPECT_NE(std::string(error.what()).find("fixed along the normal"), std::string::npos);
  }
}

} // namespace
} // namespace rbvi::fixed_nodes_test
