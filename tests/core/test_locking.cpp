// Where elements of degree 1 lock, it is said; nowhere else.
#include "rbvi/core/locking.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

namespace rbvi::locking_test {
namespace {

/// A material with this Poisson's ratio to the right of x = 0, 0.3 to the left.
Scene scene_of(double poisson, int degree) {
  Scene scene;
  scene.degree = degree;
  scene.materials = {{{}, [poisson](const FullMu &mu, const Point &x) {
                        const double nu = x[0] > 0 ? poisson : 0.3, shear = mu[0];
                        return Lame{2 * shear * nu / (1 - 2 * nu), shear};
                      }}};
  return scene;
}

const std::vector<MaterialPoint> left{{{-1, 0, 0}}}, both{{{-1, 0, 0}}, {{1, 0, 0}}};

TEST(Locking, BeginsAtAPoissonRatioOfFortyNineHundredths) {
  for (const double poisson : {0.48, 0.49, 0.499, 0.4999})
    EXPECT_NEAR(locking_ratio(scene_of(poisson, 1), {7}, both), poisson, 1e-12);
  EXPECT_EQ(locking_ratio(scene_of(0.479, 1), {7}, both), 0);
}

TEST(Locking, IsOfTheMaterialBesideContactAndOfDegreeOneAlone) {
  EXPECT_EQ(locking_ratio(scene_of(0.499, 1), {7}, left), 0);
  EXPECT_EQ(locking_ratio(scene_of(0.499, 2), {7}, both), 0);
  EXPECT_EQ(locking_ratio(Scene{}, {7}, both), 0) << "no material, no locking";
}

TEST(Locking, IsToldInOneLineWithTheRemedy) {
  std::ostringstream out, silent;
  warn_of_elements({}, 0.499, out);
  EXPECT_TRUE(out.str().starts_with("warning: Poisson's ratio is 0.499"));
  EXPECT_TRUE(out.str().ends_with("use -degree 2\n"));
  EXPECT_EQ(std::ranges::count(out.str(), '\n'), 1);
  warn_of_elements({}, 0, silent);
  EXPECT_EQ(silent.str(), "");
}

TEST(Overshoot, IsToldOfRegionsByExactQuadrature) {
  const auto told = [](ContactRecipe contact) {
    Scene scene;
    scene.contacts = {std::move(contact)};
    std::ostringstream out;
    warn_of_elements(scene, 0, out);
    return out.str();
  };
  using enum InterfaceEntities::Kind;
  EXPECT_NE(told({.entities = {cells, {}}}).find("lumped: yes"), std::string::npos);
  EXPECT_EQ(told({.entities = {cells, {}}, .nodal = true}), "");
  EXPECT_EQ(told({.entities = {facets, {}}}), "");
}

TEST(Vertices, AreNotEnoughForDegreeTwoOnABoundary) {
  using enum InterfaceEntities::Kind;
  for (const int degree : {1, 2}) {
    Scene scene;
    scene.degree = degree;
    scene.contacts = {{.entities = {facets, {}}, .nodal = true}};
    std::ostringstream out;
    warn_of_elements(scene, 0, out);
    EXPECT_EQ(out.str().find("sink in") != std::string::npos, degree == 2);
  }
}

} // namespace
} // namespace rbvi::locking_test
