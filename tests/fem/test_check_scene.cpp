// Each mistake of whoever writes a scene is refused in one line; the scenes of this build have
// none.
#include "../core/refuses.hpp"
#include "rbvi/contact/obstacle.hpp"
#include "rbvi/contact/support.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/facet_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"
#include "rbvi/fem/check_scene.hpp"
#include "rbvi/par/collective.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

namespace rbvi::check_scene_test {
namespace {

void check(const Scene &scene) {
  const Problem problem(PETSC_COMM_WORLD, scene, {});
  check_scene(problem);
}

/// A mistake is made in the scene; the refusal contains `part`.
template <class Mistake>
testing::AssertionResult refused(Scene scene, const std::string &part, Mistake mistake) {
  mistake(scene);
  return refuses(part, [&] { check(scene); });
}

Scene block() {
  return make_scene("patch", {{"bodies", "one"}, {"friction", "none"}});
}

Scene membrane() {
  return make_scene("membrane_obstacle", {{"circle_edges", "12"}});
}

Scene disk() {
  return make_scene("rigid_disk", {{"arc_edges", "8"}, {"friction", "none"}});
}

/// On small meshes.
SceneOptions with(const SceneEntry &entry, SceneOptions options) {
  for (const SceneOption &option : entry.options)
    if (option.name == "arc_edges" || option.name == "circle_edges")
      options[option.name] = option.name == "arc_edges" ? "16" : "12";
  return options;
}

TEST(CheckScene, EverySceneWithEachOfItsChoicesPasses) {
  if (ranks_of(PETSC_COMM_WORLD) > 1) GTEST_SKIP() << "on one rank, for the time that it takes";
  for (const SceneEntry &entry : catalogue()) {
    EXPECT_NO_THROW(check(make_scene(entry.name, with(entry, {})))) << entry.name;
    for (const SceneOption &option : entry.options)
      for (const std::string &choice : option.choices) {
        Scene scene;
        try {
          scene = make_scene(entry.name, with(entry, {{option.name, choice}}));
        } catch (const Error &) { // this choice asks for others beside it
          continue;
        }
        EXPECT_NO_THROW(check(scene)) << entry.name << " -" << option.name << ' ' << choice;
      }
  }
}

TEST(CheckScene, FormulationsOfSeveralChoicesPass) {
  const std::vector<std::pair<std::string, SceneOptions>> scenes{
      {"patch", {{"bodies", "one"}}},
      {"patch", {{"bodies", "one"}, {"formulation", "nitsche"}, {"degree", "2"}}},
      {"rigid_disk", {{"kinematics", "large"}, {"normal", "body"}}},
      {"rigid_disk", {{"kinematics", "large"}, {"formulation", "nitsche"}}},
      {"rigid_disk", {{"normal", "rigid"}, {"gap", "vertical"}}},
      {"membrane_obstacle", {{"degree", "2"}, {"lumped", "no"}, {"disc_map", "graded"}}}};
  for (const auto &[name, options] : scenes)
    EXPECT_NO_THROW(check(make_scene(name, options))) << name;
  Scene framed = membrane();
  framed.parameters = free_only(framed.parameters, "frame_tilt,radius,frame_height");
  EXPECT_NO_THROW(check(framed));
}

TEST(CheckScene, NormalsOfLengthOneOutOfTheBody) {
  const auto normal = [](double y) {
    return [y](Scene &s) {
      s.contacts = {rigid_support({"contact", everywhere({0, y, 0}), everywhere(0.0)})};
    };
  };
  EXPECT_TRUE(refused(block(), "has a normal of the length 2", normal(-2)));
  EXPECT_TRUE(refused(block(), "normals that point into the body", normal(1)));
  EXPECT_FALSE(refused(block(), "", normal(-1)));
}

/// The sides of a body ten times larger, far from the disk that the middle touches.
TEST(CheckScene, APartFarAwayMayFaceARigidBodyFromBehind) {
  Scene scene = make_scene("rigid_disk", {{"kinematics", "large"}, {"arc_edges", "16"}});
  Parameter &radius = scene.parameters.all.front();
  radius.lower = 5;
  radius.upper = radius.value = 10;
  EXPECT_NO_THROW(check(scene));
}

TEST(CheckScene, TheNormalOfASurfaceIsTheGradientOfItsDistance) {
  const auto ground = [](double slope, double y) {
    return [=](Scene &s) {
      const std::function<Surface> surface = [=](const FullMu &, const Point &x) {
        return SurfacePoint{slope * x[1], {0, y, 0}, 0};
      };
      s.contacts = {rigid_surface({.boundary = "contact", .surface = surface, .large = true})};
    };
  };
  EXPECT_TRUE(refused(block(), "no gradient of the distance", ground(1, -1)));
  EXPECT_TRUE(refused(block(), "no gradient of the distance", ground(2, 1)));
  EXPECT_TRUE(refused(block(), "has a normal of the length 2", ground(1, 2)));
  EXPECT_FALSE(refused(block(), "", ground(1, 1)));
}

TEST(CheckScene, ParametersAreDeclared) {
  EXPECT_TRUE(refused(block(), "the factor 'k' of f depends on the parameter shear", [](Scene &s) {
    s.f[0].theta->push_back({"k", parameter(1), {0}});
  }));
  EXPECT_TRUE(refused(membrane(), "term 1 of a depends on the parameter center_y", [](Scene &s) {
    s.a[0].parameters = std::vector{0, 1};
  }));
  EXPECT_TRUE(refused(
      membrane(), "imposed on 'boundary' depends on the parameter frame_tilt", [](Scene &s) {
        const std::function<PointMap> tilted = [](const FullMu &mu, const Point &x) {
          return Point{mu[4] * x[0], 0, 0};
        };
        s.fixed[0].values = {{tilted, std::nullopt, std::vector{3}}};
      }));
  EXPECT_TRUE(refused(membrane(), "frame_tilt: take that into a factor", [](Scene &s) {
    s.fixed[0].values[0].value = [](const FullMu &mu, const Point &) { return Point{mu[4], 0, 0}; };
  }));
  EXPECT_TRUE(refused(block(), "declares parameter number 9",
                      [](Scene &s) { s.f[0].theta->front().parameters = {9}; }));
  EXPECT_TRUE(refused(block(), "'k' of f asks for a parameter", [](Scene &s) {
    s.f[0].theta->push_back({"k", parameter(7), {0}});
  }));
}

TEST(CheckScene, FactorsOfOneNameAreOneFunctionAndCoordinatesHaveInverses) {
  EXPECT_TRUE(refused(disk(), "give each function a name of its own",
                      [](Scene &s) { s.a[2].theta->back().name = s.a[1].theta->back().name; }));
  EXPECT_TRUE(refused(disk(), "inverse to each other", [](Scene &s) {
    s.coordinates = {{3, {logarithm(), logarithm()}}};
  }));
}

/// Neither verify nor any solver shows these.
TEST(CheckScene, ExactTermsFollowTheMap) {
  EXPECT_TRUE(refused(membrane(), "term 1 of a is exact, but the map deforms its cells",
                      [](Scene &s) { s.a = {exact_term(laplace(""))}; }));
  EXPECT_TRUE(refused(membrane(), "term 1 of f is exact, but the map deforms its cells",
                      [](Scene &s) { s.f = {exact_term(constant_load("", -25))}; }));
  const auto pressure = [](std::vector<Factor> factors) {
    return [factors](Scene &s) { s.f = {exact_term(pressure_load("top", 1, 2, 2), factors)}; };
  };
  EXPECT_TRUE(refused(disk(), "changes with the parameter radius by the map", pressure({})));
  EXPECT_FALSE(refused(disk(), "", pressure({{"radius", parameter(0), {0}}})));
  EXPECT_TRUE(
      refused(block(), "is exact, and its kernel depends on the parameter shear", [](Scene &s) {
        const std::function<Traction> traction = [](const FullMu &mu, const Point &,
                                                    const Point &) {
          return Point{mu[1], 0, 0};
        };
        s.f = {exact_term(traction_load("sides", traction, 2, 1))};
      }));
}

TEST(CheckScene, FormsHaveTheComponentsAndTheDegreeOfTheScene) {
  EXPECT_TRUE(
      refused(disk(), "fills 36 values where 2 components of degree 2 have 144", [](Scene &s) {
        s.a = {exact_term(elasticity("", {1, 1}, 1))};
      }));
  EXPECT_TRUE(refused(block(), "term 1 of f fills 2 values",
                      [](Scene &s) { s.f = {exact_term(pressure_load("sides", 1, 1, 1))}; }));
  EXPECT_TRUE(refused(block(), "the product of V fills 9 values",
                      [](Scene &s) { s.v_product = {exact_term(h1_product(1, 1, 1))}; }));
  const auto with_kernel = [](double upper, double lower) {
    return [=](Scene &s) {
      const std::function<Kernel> kernel = [=](const FullMu &, const Cell &, double *values) {
        for (int i = 0; i < 6; ++i)
          for (int j = 0; j < 6; ++j)
            values[6 * i + j] = i < j ? upper : lower;
      };
      s.motion = {};
      s.a = {exact_term({"", kernel})};
    };
  };
  EXPECT_TRUE(refused(block(), "term 1 of a is not symmetric", with_kernel(1, 2)));
  EXPECT_TRUE(refused(block(), "values are not finite", with_kernel(NAN, NAN)));
}

TEST(CheckScene, TheMotionIsOneOfARigidBody) {
  EXPECT_TRUE(refused(block(), "does work with the motion", [](Scene &s) {
    s.motion = [](const FullMu &mu, const Point &x) { return Point{0, -mu[0] * x[1], 0}; };
  }));
  EXPECT_TRUE(refused(block(), "stretch no spring",
                      [](Scene &s) { s.a.push_back(exact_term(spring("sides", 1, 2, 1))); }));
}

TEST(CheckScene, FunctionsAreSet) {
  EXPECT_TRUE(refused(block(), "scene patch has no map", [](Scene &s) { s.map = {}; }));
  EXPECT_TRUE(refused(block(), "has no contact", [](Scene &s) { s.contacts.clear(); }));
  EXPECT_TRUE(refused(block(), "no kind of contact made", [](Scene &s) { s.contacts = {{}}; }));
  EXPECT_TRUE(refused(block(), "has no term in a", [](Scene &s) { s.a.clear(); }));
  EXPECT_TRUE(
      refused(block(), "term 2 of f has no kernel", [](Scene &s) { s.f[1].form.kernel = {}; }));
  EXPECT_TRUE(refused(block(), "the factor 'k' of f is not set", [](Scene &s) {
    s.f[0].theta->push_back({"k", {}, {0}});
  }));
  EXPECT_TRUE(refused(
      block(), "contact on 'contact' is not set, or asks for a function that is not", [](Scene &s) {
        s.contacts = {rigid_support({"contact", {}, everywhere(0.0)})};
      }));
  EXPECT_TRUE(refused(block(), "speaks of 'wall', which is no region or boundary",
                      [](Scene &s) { s.fixed[0].name = "wall"; }));
  EXPECT_TRUE(refused(block(), "speaks of 'wall', which is no region or boundary",
                      [](Scene &s) { s.a[0].form.region = "wall"; }));
}

} // namespace
} // namespace rbvi::check_scene_test
