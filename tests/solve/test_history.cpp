// Steps of friction one after the other: the slip that a step leaves is what the next one starts
// from.
#include "block_on_support.hpp"
#include "rbvi/contact/history.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/facet_forms.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

namespace rbvi::history_test {
namespace {

/// The block whose sides carry the shear stress that the last parameter says.
Scene block_along_a_path(const std::string &degree) {
  Scene scene = block_on_support::block(degree);
  scene.parameters.all.push_back({"stress", "Pa", -5, 5, 0});
  scene.parameters = all_free(scene.parameters.all);
  const auto along = [](const FullMu &, const Point &, const Point &n) -> Point {
    return {0, n[0], 0};
  };
  scene.f[1] =
      exact_term(traction_load("sides", along, 2, scene.degree), {{"stress", parameter(3), {3}}});
  return scene;
}

/// What the block does next: the foot slips until its stress is within the bound.
struct Foot {
  double slip = 0, stress = 0;
  void move(double indentation, double shear, double coefficient) {
    const Lame material = lame(15, 0.35);
    const double stiffness = material.shear / block_on_support::height;
    const double most = coefficient * (material.lambda + 2 * material.shear) * indentation /
                        block_on_support::height;
    stress = std::clamp(stiffness * (shear - slip), -most, most);
    slip = shear - stress / stiffness;
  }
};

/// (indentation, shear): slips, sticks on the way back, slips backwards, sticks, loses pressure.
const std::vector<std::pair<double, double>> path{{0.05, 0.1},   {0.05, 0.08}, {0.05, -0.06},
                                                  {0.06, -0.05}, {0.03, 0.0},  {0.03, 0.07}};

void expect_path(const std::string &degree, const HfOptions &options, double tolerance) {
  Problem problem(PETSC_COMM_WORLD, block_along_a_path(degree), {}, 0);
  HighFidelity solver(problem, options);
  Foot foot;
  Vector history;
  bool slipped_back = false;
  for (const auto &[indentation, shear] : path) {
    SCOPED_TRACE("shear " + std::to_string(shear));
    const double before = foot.slip;
    foot.move(indentation, shear, 0.3);
    slipped_back = slipped_back || foot.slip < before - 1e-3;
    const HfSolution s = solver.solve({indentation, shear, 0.3, foot.stress}, history);
    ASSERT_EQ(s.slip.size(), s.lambda.size() / 2);
    EXPECT_LE((s.slip.array() - foot.slip).abs().maxCoeff(), tolerance);
    EXPECT_LE((s.lambda.tail(s.slip.size()).array() - foot.stress).abs().maxCoeff(),
              100 * tolerance);
    EXPECT_LE(s.kkt.largest(), std::max(1e-11, tolerance));
    history = s.slip;
  }
  EXPECT_TRUE(slipped_back);
}

TEST(History, ABlockPushedToAndFroSlipsAsFarAsItsPathSays) {
  for (const std::string degree : {"1", "2"})
    for (const HfContact contact : {HfContact::condensed, HfContact::eliminated}) {
      SCOPED_TRACE(degree);
      HfOptions options;
      options.contact = contact;
      expect_path(degree, options, 1e-11);
    }
}

TEST(History, IsTakenInOverTheRanks) {
  HfOptions options;
  options.method = HfMethod::uzawa;
  options.uzawa.accelerated = true;
  options.uzawa.tolerance = 1e-11;
  expect_path("1", options, 1e-7);
}

Scene small_disk(const std::string &kinematics, const std::string &law) {
  return make_scene("rigid_disk",
                    {{"arc_edges", "40"}, {"kinematics", kinematics}, {"friction", law}});
}

/// The middle of the box.
Mu middle(const Scene &scene) {
  Mu mu;
  for (int i = 0; i < scene.parameters.size(); ++i)
    mu.push_back((scene.parameters.at(i).lower + scene.parameters.at(i).upper) / 2);
  return mu;
}

/// A step that ends where it starts: with the slip behind it, no traction within the bounds does
/// work, so that displacement, traction and slip stay what they are.
TEST(History, AStepToWhereTheBodyIsChangesNothing) {
  std::vector<Scene> scenes{make_scene("roller", {{"arc_edges", "16"}})};
  for (const char *law : {"tresca", "coulomb"})
    for (const char *kinematics : {"small", "large"})
      scenes.push_back(small_disk(kinematics, law));
  for (const Scene &scene : scenes)
    for (const NonlinearMethod method : {NonlinearMethod::automatic, NonlinearMethod::kacanov}) {
      SCOPED_TRACE(scene.name + (scene.contacts.back().follows_state ? ", large" : ""));
      if (method != NonlinearMethod::automatic && !scene.contacts.back().follows_state) continue;
      const Mu mu = middle(scene);
      Problem problem(PETSC_COMM_WORLD, scene, {});
      HfOptions options;
      options.nonlinear.method = method;
      HighFidelity solver(problem, options);
      const HfSolution first = solver.solve(mu);
      solver.forget();
      const HfSolution again = solver.solve(mu, first.slip);
      EXPECT_GT(first.slip.cwiseAbs().maxCoeff(), 0);
      EXPECT_LE((again.u - first.u).norm(), 1e-8 * first.u.norm());
      EXPECT_LE((again.lambda - first.lambda).norm(), 1e-7 * first.lambda.norm());
      EXPECT_LE((again.slip - first.slip).norm(), 1e-8 * first.slip.norm());
    }
}

/// To and back by less: what has slipped does not return, and the bodies keep a traction.
TEST(History, TheWayBackIsAnotherOne) {
  for (const char *kinematics : {"small", "large"}) {
    SCOPED_TRACE(kinematics);
    Scene scene = small_disk(kinematics, "coulomb");
    scene.parameters.all[2].value = 0.05; // so that some of it slips
    scene.parameters = free_only(scene.parameters, "indentation");
    Problem problem(PETSC_COMM_WORLD, scene, {});
    HighFidelity solver(problem, {});
    const Parameter &depth = problem.scene().parameters.at(0);
    const Mu deep{depth.upper}, less{0.5 * (depth.lower + depth.upper)};
    const HfSolution at_once = solver.solve(less),
                     back = solver.solve(less, solver.solve(deep).slip);
    EXPECT_LE(back.kkt.largest(), 1e-9);
    const Index nodes = problem.contact().nodes();
    const Vector one = at_once.lambda.tail(nodes), other = back.lambda.tail(nodes);
    EXPECT_GT((one - other).norm(), 0.1 * one.norm());
    EXPECT_LT((at_once.lambda.head(nodes) - back.lambda.head(nodes)).norm(),
              0.1 * at_once.lambda.norm());
  }
}

TEST(History, NoneAndZeroAreTheSameToTheLastBit) {
  for (const char *kinematics : {"small", "large"}) {
    const Scene scene = small_disk(kinematics, "coulomb");
    Problem problem(PETSC_COMM_SELF, scene, {}); // over ranks solves differ by round-off
    const HfSolution without = HighFidelity(problem, {}).solve(middle(scene));
    const HfSolution with =
        HighFidelity(problem, {}).solve(middle(scene), Vector::Zero(without.slip.size()));
    EXPECT_EQ(without.u, with.u);
    EXPECT_EQ(without.lambda, with.lambda);
  }
}

TEST(History, SaysWhatItCannotTake) {
  const auto refuses = [](const Scene &scene, const Vector &slip, const std::string &text) {
    Problem problem(PETSC_COMM_WORLD, scene, {});
    HighFidelity solver(problem, {});
    try {
      solver.solve(middle(scene), slip);
    } catch (const Error &error) {
      return error.status() == Status::bad_input &&
             std::string(error.what()).find(text) != std::string::npos;
    }
    return false;
  };
  const Scene disk = small_disk("small", "coulomb");
  EXPECT_TRUE(refuses(disk, Vector::Zero(3), "has 3 values instead of"));
  EXPECT_TRUE(
      refuses(disk, Vector::Constant(41, std::numeric_limits<double>::quiet_NaN()), "not finite"));
  EXPECT_TRUE(refuses(small_disk("small", "none"), Vector::Zero(41), "instead of 0"));
  const Scene nitsche = make_scene("rigid_disk", {{"arc_edges", "40"}, {"formulation", "nitsche"}});
  Problem problem(PETSC_COMM_WORLD, nitsche, {});
  EXPECT_TRUE(
      refuses(nitsche, Vector::Zero(tangential_size(problem.contact())), "use -formulation mixed"));
}

} // namespace
} // namespace rbvi::history_test
