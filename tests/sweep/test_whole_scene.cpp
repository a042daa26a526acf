// Samples and models know the whole scene that they are of, its code among it.
#include "sweep_test.hpp"

#include "rbvi/contact/obstacle.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"
#include "rbvi/model/scene_text.hpp"
#include "tests/catalogue.hpp"

namespace rbvi::whole_scene_test {
namespace {

using namespace testing_sweep;

std::string text_of(const Scene &scene, MPI_Comm comm = PETSC_COMM_SELF) {
  const Problem problem(comm, scene, {});
  return scene_text(problem.scene(), problem.contact());
}

struct Change {
  std::string line; ///< the first that differs
  std::function<void(Scene &)> make;
};

/// Each of the changes leaves name, options and parameters of the scene as they are.
void expect_noticed(const Scene &scene, const std::vector<Change> &changes) {
  const std::string before = text_of(scene);
  for (const Change &change : changes) {
    Scene other = scene;
    change.make(other);
    const std::string found = scene_difference(before, text_of(other), Further::refused);
    EXPECT_TRUE(found.starts_with(change.line + " ")) << change.line << ": " << found;
    EXPECT_EQ(found.find('\n'), std::string::npos);
  }
}

/// The same function, by code, with a factor that its name does not tell.
template <class Signature, class Function>
Named<Signature> disguised(const Named<Signature> &original, Function function) {
  return {function, original.record};
}

Named<Kernel> scaled(const Named<Kernel> &kernel, double factor, int count) {
  return disguised(kernel, [=](const FullMu &mu, const Cell &cell, double *values) {
    kernel(mu, cell, values);
    for (int i = 0; i < count; ++i)
      values[i] *= factor;
  });
}

constexpr double slightly = 1 + 1e-6;

TEST(WholeScene, EveryChangeOfAMembraneIsNoticed) {
  const Scene scene = make_scene("membrane_obstacle", {{"circle_edges", "12"}});
  expect_noticed(
      scene, {{"map values",
               [](Scene &s) {
                 s.map = disguised(s.map, [map = s.map](const FullMu &mu, const Point &x) -> Point {
                   const Point y = map(mu, x);
                   return {slightly * y[0], y[1], y[2]};
                 });
               }},
              {"a_0 values",
               [](Scene &s) { s.a[0].form.kernel = scaled(s.a[0].form.kernel, slightly, 9); }},
              {"f_0 values",
               [](Scene &s) { s.f[0].form.kernel = scaled(s.f[0].form.kernel, slightly, 3); }},
              {"scene.f_0.kernel", [](Scene &s) { s.f[0].form = constant_load("", -25); }},
              {"v_product_0 values", [](Scene &s) { s.v_product[0].form = h1_product(1.001); }},
              {"scene.a_0:parameters",
               [](Scene &s) {
                 s.a[0].parameters = std::vector{0, 1};
               }},
              {"fixed_0", [](Scene &s) { s.fixed[0].components = {0}; }},
              {"contact_0 values",
               [](Scene &s) {
                 const Named<PointValue> height = [](const FullMu &mu, const Point &x) {
                   const double dx = x[0] - mu[1], dy = x[1] - mu[2];
                   return -slightly * 1.25 * (dx * dx + dy * dy) / (mu[0] * mu[0]);
                 };
                 const Record record = s.contacts[0].record;
                 s.contacts[0] = obstacle({"obstacle", height, true});
                 s.contacts[0].record = record;
               }},
              {"mesh 'obstacle' values",
               [](Scene &s) {
                 s.mesh.facts[1].distance = [](const Point &x) {
                   return 1.5 * (std::hypot(x[0], x[1]) - 0.2);
                 };
               }},
              {"curve of 'obstacle' values",
               [](Scene &s) { s.curves["obstacle"] = [](const Point &x) { return x; }; }},
              {"parameter radius", [](Scene &s) { s.parameters.all[0].valid.upper = 0.37; }}});
}

/// Samples and models of another name for a contact serve on.
TEST(WholeScene, NamesOfContactDoNotCount) {
  Scene scene = make_scene("roller", {{"arc_edges", "8"}});
  const std::string before = text_of(scene);
  scene.contacts[0].name = "ceiling";
  EXPECT_EQ(text_of(scene), before);
}

TEST(WholeScene, EveryChangeOfARollerIsNoticed) {
  const Scene scene = make_scene("roller", {{"arc_edges", "8"}});
  expect_noticed(
      scene, {{"material_0 values",
               [](Scene &s) {
                 Named<Material> &own = s.materials[0].of_cell;
                 own = disguised(own, [own](const FullMu &mu, const Point &x) {
                   const Lame at = own(mu, x);
                   return Lame{at.lambda, slightly * at.shear};
                 });
               }},
              {"a_0 values",
               [](Scene &s) { s.a[0].form.kernel = scaled(s.a[0].form.kernel, slightly, 144); }},
              {"scene.motion",
               [](Scene &s) {
                 s.motion = Named<PointMap>([](const FullMu &, const Point &) { return Point{}; });
               }},
              {"scene.a_0.factor_0:parameters",
               [](Scene &s) { s.a[0].theta->front().parameters = {0}; }}});
}

TEST(WholeScene, WhatAUserChoosesIsNoChangeOfIt) {
  const Scene scene = make_scene("rigid_disk", {{"arc_edges", "8"}});
  Scene other = scene;
  other.parameters.all[0].lower = 0.9;
  other.parameters.all[0].upper = 2;
  other.parameters.all[1].value = 0.05;
  other.parameters = free_only(other.parameters, "offset,radius");
  other.training = "grid:3";
  other.check_parameters = [](const FullMu &) {};
  EXPECT_EQ(text_of(other), text_of(scene));
}

TEST(WholeScene, IsTheSameOnEveryRankAndForAnyNumberOfThem) {
  for (const std::string name : {"roller", "rigid_disk"}) {
    const Scene scene = make_scene(name, {{"arc_edges", "16"}});
    EXPECT_EQ(scene_difference(text_of(scene, PETSC_COMM_WORLD), text_of(scene), Further::refused),
              "");
  }
}

TEST(WholeScene, LastDigitsAreNoDifference) {
  const std::string one = "a: 1\nmap values: 1.23456789\n", name = "map values: ";
  EXPECT_EQ(scene_difference(one, "a: 1\n" + name + "1.23456790\n", Further::refused), "");
  EXPECT_EQ(scene_difference(one, "a: 1\n" + name + "1.23456989\n", Further::refused),
            "map values is 1.23456989, it was 1.23456789");
  EXPECT_EQ(scene_difference(one, "a: 1\n" + name + "1.23456789 of 15\n", Further::refused),
            "map values is 1.23456789 of 15, it was 1.23456789");
  EXPECT_EQ(scene_difference(one, "a: 2\n" + name + "2\n", Further::refused), "a is 2, it was 1");
  EXPECT_EQ(scene_difference(one, "a: 1\n", Further::allowed), "");
  EXPECT_EQ(scene_difference(one, "a: 1\n", Further::refused),
            "map values was 1.23456789 and is gone");
  EXPECT_EQ(scene_difference("a: 1\n", one, Further::allowed),
            "map values is 1.23456789, it was not there");
}

TEST_F(SweepTest, SamplesOfAnotherSceneAreRefused) {
  (void)sweep({five[0]});
  Scene other = wide_scene();
  other.a[0].form.kernel = scaled(other.a[0].form.kernel, 1.5, 9);
  const Error error = refusal(other);
  EXPECT_EQ(error.status(), Status::bad_input);
  EXPECT_TRUE(contains(error.what(), "are of another scene: a_0 values is ")) << error.what();
  EXPECT_TRUE(contains(error.what(), "rbvi offline makes them anew in another -out"))
      << error.what();
  EXPECT_EQ(sweep({five[0]}).report.reused, 1);
}

TEST_F(SweepTest, SamplesOfAnotherOrderOfParametersAreRefused) {
  (void)sweep({five[0]});
  Scene turned = wide_scene();
  turned.parameters = free_only(turned.parameters, "center_y,center_x,radius");
  const Error error = refusal(turned);
  EXPECT_EQ(error.status(), Status::bad_input);
  EXPECT_TRUE(contains(error.what(), "parameters = radius,center_x,center_y, now it is center_y"))
      << error.what();
}

TEST_F(SweepTest, TheOrderOfParametersDoesNotChangeAnswers) {
  Scene turned = wide_scene();
  turned.parameters = free_only(turned.parameters, "center_y,radius,center_x");
  const Sweep one = sweep({{0.18, 0.02, -0.01}}),
              other = sweep({{-0.01, 0.18, 0.02}}, 1, turned, {}, "turned");
  EXPECT_EQ(one.samples.front().u, other.samples.front().u);
}

} // namespace
} // namespace rbvi::whole_scene_test
