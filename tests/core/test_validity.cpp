// Ranges of validity of every scene's parameters and options, alone and together.
#include "refuses.hpp"

#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "tests/catalogue.hpp"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

namespace rbvi::validity_test {
namespace {

TEST(Validity, EveryParameterHasARangeThatHoldsItsBox) {
  for (Scene scene : every_choice()) {
    SCOPED_TRACE(scene.name);
    EXPECT_NO_THROW(check_box(scene));
    scene.parameters.free.clear();
    for (std::size_t i = 0; i < scene.parameters.all.size(); ++i)
      if (scene.parameters.all[i].lower < scene.parameters.all[i].upper)
        scene.parameters.free.push_back(static_cast<int>(i));
    EXPECT_NO_THROW(check_box(scene)) << "all parameters with a range free";
    for (const Parameter &p : scene.parameters.all) {
      EXPECT_TRUE(std::isfinite(p.valid.lower) && std::isfinite(p.valid.upper)) << p.name;
      EXPECT_LE(p.valid.lower, p.value) << p.name;
      EXPECT_GE(p.valid.upper, p.value) << p.name;
    }
  }
}

TEST(Validity, EveryNumericOptionHasARange) {
  for (const SceneEntry &entry : catalogue())
    for (const SceneOption &option : entry.options) {
      if (!option.choices.empty()) continue;
      SCOPED_TRACE(entry.name + " " + option.name);
      EXPECT_TRUE(std::isfinite(option.valid.lower) && std::isfinite(option.valid.upper));
      for (const std::string text : {"1e300", "-1e300", "nan", "inf"})
        EXPECT_TRUE(refuses(option.name, [&] {
          (void)make_scene(entry.name, {{option.name, text}});
        })) << text;
    }
}

TEST(Validity, ABoxThatLeavesItsRangeIsRefused) {
  const auto refused = [](double lower, double upper, const std::string &part) {
    Scene scene = make_scene("membrane_obstacle");
    scene.parameters.all[0].lower = lower;
    scene.parameters.all[0].upper = upper;
    return refuses(part, [&] { check_box(scene); });
  };
  const std::string range = "range of validity is [0.02, 0.38]";
  EXPECT_TRUE(refused(-1, 0.2, range));
  EXPECT_TRUE(refused(0.16, 1e300, range));
  EXPECT_TRUE(refused(0.16, std::nan(""), range));
  EXPECT_TRUE(refused(0.2, 0.2, range));
  EXPECT_TRUE(refused(0.24, 0.16, range));
  EXPECT_TRUE(refused(0.16, 0.38, "the corner radius=0.38 center_x=-0.05"));
  Scene fixed = make_scene("membrane_obstacle");
  fixed.parameters = free_only(fixed.parameters, "center_x");
  fixed.parameters.all[0].value = 5;
  EXPECT_TRUE(refuses("parameter radius is 5", [&] { check_box(fixed); }));
}

/// The disc with the ring around it stays inside the square: the determinant of the map is positive
/// wherever radius and centre are valid together, and close to zero where they are not.
TEST(Validity, TheRingAroundTheDiscFoldsJustBeyondTheRange) {
  const Scene scene = make_scene("membrane_obstacle");
  const auto smallest_stretch = [&](const FullMu &mu) {
    double smallest = 1e300;
    for (double rho = 0.2; rho < 0.5; rho += 1e-3) {
      const Point inner = scene.map(mu, {-rho, 0, 0}), outer = scene.map(mu, {-rho - 1e-6, 0, 0});
      smallest = std::min(smallest, (inner[0] - outer[0]) / 1e-6);
    }
    return smallest;
  };
  for (const double radius : {0.02, 0.1, 0.2, 0.3, 0.37}) {
    const double centre = 0.38 - radius;
    EXPECT_NO_THROW(check_together(scene, {radius, -centre, 0, 0, 0}));
    EXPECT_GT(smallest_stretch({radius, -centre, 0}), 0.05) << radius;
    EXPECT_TRUE(refuses("folds the mesh", [&] {
      check_together(scene, {radius, -centre - 0.001, 0, 0, 0});
    }));
    EXPECT_LT(smallest_stretch({radius, -centre - 0.02, 0}), 1e-3) << radius;
  }
}

TEST(Validity, AnIndentationIsSmallBesideTheRadius) {
  const Scene disk = make_scene("rigid_disk");
  EXPECT_NO_THROW(check_together(disk, {0.7, 0.09, 0.2, 1, 0.35, 0}));
  EXPECT_TRUE(refuses("an indentation of 0.09 is above 0.13 of the radius 0.6", [&] {
    check_together(disk, {0.6, 0.09, 0.2, 1, 0.35, 0});
  }));
  EXPECT_EQ(make_scene("two_disks", {{"indentation", "0.1"}}).parameters.all[0].valid.lower, 0.5);
}

TEST(Validity, QueriesOutsideTheBoxStayInTheRange) {
  const Scene scene = make_scene("membrane_obstacle");
  EXPECT_NO_THROW(check_query(scene, {0.3, 0, 0}, true));
  EXPECT_TRUE(refuses("outside [0.16, 0.24]", [&] { check_query(scene, {0.3, 0, 0}, false); }));
  EXPECT_TRUE(refuses("outside its range of validity [0.02, 0.38]", [&] {
    check_query(scene, {5, 0, 0}, true);
  }));
  EXPECT_TRUE(refuses("folds the mesh", [&] { check_query(scene, {0.3, 0.2, 0}, true); }));
}

TEST(Validity, OptionsOfScenesThatMakeNoSense) {
  const auto refused = [](const std::string &scene, const std::string &name,
                          const std::string &value) {
    const std::string says = name.ends_with("edges") ? "edges is " : "option " + name + " is ";
    return refuses(says, [&] { (void)make_scene(scene, {{name, value}}); });
  };
  EXPECT_TRUE(refused("two_disks", "young", "0"));
  EXPECT_TRUE(refused("two_disks", "poisson_ratio", "0.5"));
  EXPECT_TRUE(refused("two_disks", "indentation", "-0.1"));
  EXPECT_TRUE(refused("patch", "poisson_ratio", "-1"));
  EXPECT_TRUE(refused("rigid_disk", "nitsche_gamma0", "0"));
  for (const char *edges : {"7", "9", "6", "8.5", "-8", "1e9"})
    EXPECT_TRUE(refused("rigid_disk", "arc_edges", edges)) << edges;
  for (const char *edges : {"6", "18", "12.5", "-12", "252", "1e9"})
    EXPECT_TRUE(refused("membrane_obstacle", "circle_edges", edges)) << edges;
}

TEST(Describe, Ranges) {
  EXPECT_EQ(describe(Range{-0.5, 1e6}), "[-0.5, 1e+06]");
  EXPECT_EQ(describe(Range{0, HUGE_VAL}), "at least 0");
  EXPECT_EQ(describe(Range{-HUGE_VAL, 1}), "at most 1");
  EXPECT_EQ(describe(Range{}), "any number");
}

TEST(NearestName, CompletionsFirst) {
  const std::vector<std::string> names{"plan", "pod_max_size", "pod_tolerance", "pga_tolerance"};
  EXPECT_EQ(nearest_name("pod_tol", names), "pod_tolerance");
  EXPECT_EQ(nearest_name("pod_m", names), "pod_max_size");
  EXPECT_EQ(nearest_name("pod_tolernace", names), "pod_tolerance");
  EXPECT_EQ(nearest_name("plam", names), "plan");
  EXPECT_EQ(nearest_name("pod_tols", {"out", "load", "pod_tolerance"}), "pod_tolerance");
  EXPECT_EQ(nearest_name("tolerance", names), "pod_tolerance");
  EXPECT_EQ(nearest_name("x", {}), "");
}

struct Overwriting : testing::Test {
  std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::path directory = std::filesystem::path(testing::TempDir()) /
                                    ("rbvi_overwriting_" + std::to_string(::getpid()));
  void SetUp() override {
    std::filesystem::create_directories(directory / "sub");
    std::filesystem::current_path(directory);
    std::ofstream("mu.csv") << "radius\n";
    std::filesystem::create_symlink("mu.csv", "link.csv");
    std::filesystem::create_hard_link("mu.csv", "hard.csv");
  }
  void TearDown() override {
    std::filesystem::current_path(before);
    std::filesystem::remove_all(directory);
  }
};

TEST_F(Overwriting, AnInputIsFoundHoweverItIsSpelt) {
  const std::vector<NamedFile> inputs{{"the file of queries", "mu.csv"}, {"the model", "no.h5"}};
  for (const std::string &name :
       {std::string("mu.csv"), std::string("./mu.csv"), std::string("sub/../mu.csv"),
        (directory / "mu.csv").string(), std::string("link.csv"), std::string("hard.csv")})
    EXPECT_TRUE(refuses("--out " + name + " would overwrite the file of queries", [&] {
      check_overwriting({"--out", name}, inputs);
    }));
  EXPECT_TRUE(refuses("overwrite the model", [&] {
    check_overwriting({"--out", "sub/../no.h5"}, inputs);
  }));
  EXPECT_NO_THROW(check_overwriting({"--out", "out.csv"}, inputs));
  EXPECT_NO_THROW(check_overwriting({"--out", ""}, inputs));
  EXPECT_NO_THROW(check_overwriting({"--out", "grid:5"}, {{"the file of queries", ""}}));
}

TEST(Validity, ASetWithACoefficientThatIsNotFiniteIsRefused) {
  Scene scene = make_scene("rigid_disk");
  scene.a.push_back(exact_term(
      {}, {{"pole", [](const FullMu &mu) { return 1 / (mu[0] - 1); }, std::vector<int>{0}}}));
  EXPECT_NO_THROW(check_set(scene, {{0.9}, {1.1}}));
  EXPECT_TRUE(refuses("pole is not finite at radius=1 ", [&] {
    check_set(scene, {{0.9}, {1}, {1.1}});
  }));
}

} // namespace
} // namespace rbvi::validity_test
