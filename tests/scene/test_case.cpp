// Case files: what becomes of what they say.
#include "../contact/curves.hpp"
#include "../contact/support_scenes.hpp"
#include "block_case.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/output_units.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/scene/case.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::case_test {
namespace {

SceneEntry entry_in(const std::map<std::string, std::string> &other,
                    const CaseChanges &changes = {}) {
  return read_case(block_case(other), "block.yaml", changes);
}

Scene scene_of(const std::map<std::string, std::string> &other = {},
               const SceneOptions &options = {}, const CaseChanges &changes = {}) {
  return make_scene(entry_in(other, changes), options);
}

std::vector<std::string> names_in(const Scene &scene) {
  std::vector<std::string> names;
  for (const Parameter &parameter : scene.parameters.all)
    names.push_back(parameter.name);
  return names;
}

using Names = std::vector<std::string>;

TEST(Case, IsAScene) {
  const Scene scene = scene_of();
  EXPECT_EQ(scene.name, "block");
  EXPECT_EQ(scene.degree, 2);
  EXPECT_EQ(scene.components, 2);
  EXPECT_EQ(names_in(scene), (Names{"depth", "k", "nu"}));
  EXPECT_EQ(scene.parameters.size(), 3);
  ASSERT_EQ(scene.fixed.size(), 1U);
  EXPECT_TRUE(scene.fixed[0].values.empty()) << "the block moves as a whole";
  EXPECT_EQ(scene.motion({0.07, 1, 0.3}, {}), (Point{0, -0.07, 0}));
  const auto [lambda, shear] = scene.materials[0].of_cell({0.05, 2, 0.25}, {});
  EXPECT_NEAR(shear, 30 / 2.5, 1e-14);
  EXPECT_NEAR(lambda, 30 * 0.25 / (1.25 * 0.5), 1e-14);
}

TEST(Case, AStiffnessIsExactWhereItSeparates) {
  const Scene scene = scene_of();
  ASSERT_EQ(scene.a.size(), 2U);
  for (const Term &term : scene.a)
    EXPECT_TRUE(term.theta);
  const Term &first = scene.a.front();
  ASSERT_EQ(first.theta->size(), 3U);
  EXPECT_EQ(first.theta->front().parameters, std::vector<int>{1});
  EXPECT_EQ(first.theta->at(1).value({0.05, 2, 0.25}), 15);
  EXPECT_EQ(scene.coordinates.count(1), 1U) << "more than a decade: logarithmic";
  EXPECT_EQ(scene.coordinates.count(2), 1U) << "a Poisson's ratio";
  EXPECT_EQ(scene.coordinates.count(0), 0U);
  EXPECT_EQ(first.theta->back().parameters, std::vector<int>{2});
  const Scene by_place =
      scene_of({{"materials", "{rubber: {at: all, E: 'young * (x < 0.5 ? k : 1)', nu: nu}}"}});
  EXPECT_EQ(by_place.a.size(), 4U);
  const Scene turned =
      scene_of({{"map", "['(x*cos(k) - y*sin(k)) * depth', '(x*sin(k) + y*cos(k)) * depth + k']"}});
  EXPECT_FALSE(turned.a.front().theta) << "components of u do not turn with the body";
  EXPECT_TRUE(scene_of({{"map", "[x*depth, y*depth + k]"}}).a.front().theta) << "a scale";
  const Scene sheared = scene_of({{"map", "[x + depth*y, y]"}});
  ASSERT_EQ(sheared.a.size(), 1U);
  EXPECT_FALSE(sheared.a.front().theta);
  EXPECT_EQ(sheared.a.front().parameters, (std::vector<int>{0, 1, 2}));
  const Scene tangled = scene_of({{"materials", "{rubber: {at: all, E: young*exp(k*x), nu: nu}}"}});
  EXPECT_FALSE(tangled.a.front().theta);
}

TEST(Case, AMapThatChangesASmallPieceFarAwayIsNoSimilarity) {
  const std::string far = "y > 98765.4 and y < 98765.5 ? 2*y : y";
  EXPECT_FALSE(scene_of({{"map", "[x, '" + far + "']"}}).a.front().theta);
  EXPECT_FALSE(scene_of({{"map", "[x, 'max(y, 3*y - 2e5)']"}}).a.front().theta);
  // Pieces that are similar each, by a condition that both components have.
  const std::string pieces = "['y > 98765 ? 2*x : x', 'y > 98765 ? 2*y : y']";
  EXPECT_TRUE(scene_of({{"map", pieces}}).a.front().theta);
}

TEST(Case, LoadsAreExactWhereTheDomainIsFixed) {
  const std::string load = "{own: {at: all, force: [0, -k*(1 + x)]}, "
                           "side: {at: sides, pressure: depth}}";
  const Scene fixed = scene_of({{"loads", load}});
  ASSERT_EQ(fixed.f.size(), 3U) << "one component of the force, two of the pressure";
  for (const Term &term : fixed.f)
    EXPECT_TRUE(term.theta);
  const Scene moved = scene_of({{"loads", load}, {"map", "{scale: 1 + depth}"}});
  for (const Term &term : moved.f)
    EXPECT_FALSE(term.theta);
  EXPECT_TRUE(scene_of({{"loads", "{none: {at: all, force: [0, 0]}}"}}).f.empty());
}

TEST(Case, WhatIsImposedIsASumOfProducts) {
  const Scene scene = scene_of({{"imposed", "{top: {at: top, uy: -depth*(1 + k*x)}}"}});
  ASSERT_EQ(scene.fixed.size(), 1U);
  EXPECT_EQ(scene.fixed[0].components, std::vector<int>{1});
  EXPECT_FALSE(scene.motion);
  double sum = 0;
  const FullMu mu{0.1, 2, 0.3};
  for (const ImposedTerm &term : scene.fixed[0].values) {
    ASSERT_TRUE(term.theta);
    double theta = 1;
    for (const Factor &factor : *term.theta)
      theta *= factor.value(mu);
    EXPECT_EQ(term.value({}, {0.25, 0, 0})[0], 0);
    sum += theta * term.value({}, {0.25, 0, 0})[1];
  }
  EXPECT_NEAR(sum, -0.15, 1e-15);
}

TEST(Case, AMotionTakesWhatIsImposedWithIt) {
  const Scene scene = scene_of({{"motion", "[0, -depth]"},
                                {"imposed", "{top: {at: top, ux: 0, uy: motion}, "
                                            "sides: {at: sides, ux: 0, uy: 0}}"}});
  EXPECT_TRUE(scene.fixed[0].values.empty());
  ASSERT_EQ(scene.fixed[1].values.size(), 1U);
  EXPECT_NEAR(scene.fixed[1].values[0].theta->front().value({0.05, 1, 0.3}) *
                  scene.fixed[1].values[0].value({}, {})[1],
              0.05, 1e-16);
}

/// A thin plate that is stretched: sigma_xx = E eps, eps_yy = -nu eps, in lambda of plane stress.
TEST(Case, PlaneStressIsThatOfAThinPlate) {
  const Scene plate = scene_of({{"physics", "plane_stress"}}), thick = scene_of();
  const FullMu mu{0.05, 1, 0.3};
  const auto [lambda, shear] = plate.materials[0].of_cell(mu, {});
  const double eps = 1e-3, across = -0.3 * eps;
  EXPECT_NEAR(lambda * (eps + across) + 2 * shear * eps, 15 * eps, 1e-15);
  EXPECT_NEAR(lambda * (eps + across) + 2 * shear * across, 0, 1e-15);
  EXPECT_NEAR(plate.a.front().theta->back().value(mu), lambda / 15, 1e-14);
  EXPECT_TRUE(is_plane_stress(plate.materials[0].of_cell));
  EXPECT_FALSE(is_plane_stress(thick.materials[0].of_cell));
}

/// By both pairs of constants the same, exact where they separate; in plane stress lambda is no
/// sum.
TEST(Case, LamesConstantsAreAMaterial) {
  const FullMu mu{0.05, 2, 0.3};
  for (const std::string physics : {"plane_strain", "plane_stress", "axisymmetric"}) {
    const auto made = [&](const std::string &constants) {
      return scene_of({{"physics", physics},
                       {"materials", "{rubber: {at: all, " + constants + "}}"},
                       {"require", "{all: {that: k + nu > 0, says: no}}"}});
    };
    const Scene one = made("E: young*k, nu: nu"),
                other = made("lambda: young*k*nu/((1+nu)*(1-2*nu)), mu: young*k/(2*(1+nu))");
    const auto [lambda, shear] = one.materials[0].of_cell(mu, {});
    const Lame found = other.materials[0].of_cell(mu, {});
    EXPECT_NEAR(found.lambda, lambda, 1e-12);
    EXPECT_NEAR(found.shear, shear, 1e-12);
    ASSERT_EQ(other.a.size(), 2U);
    double sum = 0;
    for (const Term &term : other.a) {
      double theta = 1;
      for (const Factor &factor : *term.theta)
        theta *= factor.value(mu);
      sum += theta;
    }
    EXPECT_NEAR(sum, lambda + shear, 1e-12) << physics;
    // k; in plane stress lambda has all of mu but its 15.
    EXPECT_DOUBLE_EQ(common_coefficient(other.a, other.parameters, mu),
                     physics == "plane_stress" ? 2 / (2 * 1.3) : 2);
    EXPECT_EQ(common_coefficient(one.a, one.parameters, mu), 2) << physics;
    EXPECT_EQ(is_plane_stress(other.materials[0].of_cell), physics == "plane_stress");
  }
  const Scene placed = scene_of(
      {{"physics", "plane_stress"}, {"materials", "{rubber: {at: all, lambda: k*x, mu: nu}}"}});
  EXPECT_FALSE(placed.a.front().theta);
}

TEST(Case, AnAxisymmetricStiffnessScalesWithTheBody) {
  const auto turned = [](const std::string &map) {
    return scene_of({{"physics", "axisymmetric"}, {"map", map}});
  };
  const Scene still = turned(""), scaled = turned("{scale: depth}"), raised = turned("[x, y + k]");
  EXPECT_TRUE(still.axisymmetric);
  EXPECT_EQ(still.fixed.front().name, axis_of_turning);
  EXPECT_EQ(still.a.front().theta->size(), 3U) << "k, 15, lambda of nu";
  ASSERT_EQ(scaled.a.size(), 2U);
  for (const Term &term : scaled.a)
    EXPECT_EQ(term.theta->back().value({0.07, 1, 0.3}), 0.07);
  EXPECT_FALSE(raised.a.front().theta);
  EXPECT_FALSE(scene_of().axisymmetric);
}

/// Where the map turns or stretches a circle, its normals are not those of the body.
TEST(Case, NormalsOfCirclesAreTakenWhereTheMapKeepsThem) {
  // Of the curve, at a point whose normal of the disk is another.
  const auto is_of_body = [](const std::string &map, const std::string &against) {
    const Scene scene = scene_of({{"mesh", "{built_in: half_disc, degree: 1}"},
                                  {"map", map},
                                  {"contact", "{s: {at: contact, " + against + "}}"}});
    const auto interface = scene.contacts.front().make(scene, support_curve(arc(4, 0.5), 1));
    const Point x{std::sin(0.25), -std::cos(0.25), 0};
    return norm(interface->constraint_at({0.05, 1, 0.3}, x).direction - x) < 1e-12;
  };
  const auto against_disk = [&](const std::string &map, const std::string &choice) {
    return is_of_body(map,
                      "normal: " + choice + ", against: {disk: {center: [0, -2.1], radius: 1}}");
  };
  EXPECT_FALSE(is_of_body("", "against: {level_set: y + 1.5}"));
  const std::string stretched = "[x, y*k]", turned = "[x*cos(k) - y*sin(k), x*sin(k) + y*cos(k)]";
  EXPECT_TRUE(against_disk("{scale: k}", "auto"));
  EXPECT_TRUE(against_disk("[k*x + depth, k*y]", "auto"));
  for (const std::string &map : {stretched, turned}) {
    EXPECT_FALSE(against_disk(map, "auto"));
    EXPECT_THROW(against_disk(map, "body"), Error);
  }
}

TEST(Case, ConstantsMayBeChangedOrFreed) {
  EXPECT_NEAR(scene_of({}, {{"young", "30"}}).materials[0].of_cell({0.05, 1, 0}, {}).shear, 15,
              1e-14);
  const Scene freed = scene_of({}, {{"young", "10,30"}});
  EXPECT_EQ(names_in(freed), (Names{"depth", "k", "nu", "young"}));
  EXPECT_EQ(freed.parameters.all[3].upper, 30);
  EXPECT_TRUE(freed.a.front().theta);
  EXPECT_THROW((void)scene_of({}, {{"young", "101"}}), Error);
  EXPECT_THROW((void)scene_of({}, {{"young", "1,2,3"}}), Error);
}

TEST(Case, UnitsAreThoseOfTheSystem) {
  const Scene scene = scene_of({{"units", "{length: mm, force: N}"},
                                {"parameters", "{depth: {range: [10 um, 1 mm], default: 0.05 cm}}"},
                                {"materials", "{steel: {at: all, E: 205 GPa, nu: 0.25}}"}});
  EXPECT_EQ(scene.parameters.all[0].unit, "cm") << "that of the default";
  EXPECT_NEAR(scene.parameters.all[0].lower, 0.001, 1e-18);
  EXPECT_EQ(scene.parameters.all[0].value, 0.05);
  EXPECT_NEAR(scene.motion({0.05}, {})[1], -0.5, 1e-16);
  EXPECT_NEAR(scene.materials[0].of_cell({0.5}, {}).shear, 205000 / 2.5, 1e-9);
}

/// A block whose parameters are in other units than the case.
const std::map<std::string, std::string> in_units{
    {"units", "{length: mm, force: N}"},
    {"parameters", "{depth: {range: [10, 100], default: 0.05 mm, unit: um, limits: [1, 1 mm]}, "
                   "young: {range: [1 GPa, 20 GPa], default: 2 GPa}, "
                   "tilt: {range: [-10, 10], default: 1, unit: deg}, "
                   "thickness: {default: 500 um, limits: [100, 2*500]}}"},
    {"let", "{half: thickness/2}"},
    {"map", "[x, y*(1 + half)]"},
    {"materials", "{rubber: {at: all, E: young, nu: 0.25}}"},
    {"contact", "{floor: {at: contact, against: {plane: {normal: [0, -1], position: 0, "
                "tilt: tilt}}}}"},
    {"require", "{deep: {that: depth < 0.08, says: 'a depth of {depth} mm'}}"},
    {"tests", "{known: {at: {depth: 60, tilt: 0.01 rad}, expect: {energy: 1}, tolerance: 1}}"}};

/// Values are in the units of parameters, what functions see of them is in those of the case.
TEST(Case, ParametersAreInTheirUnits) {
  const Scene scene = scene_of(in_units);
  const std::vector<Parameter> &all = scene.parameters.all;
  ASSERT_EQ(names_in(scene), (Names{"depth", "young", "tilt"}));
  EXPECT_EQ(all[0].unit + " " + all[1].unit + " " + all[2].unit, "um GPa deg");
  EXPECT_EQ(std::vector({all[0].lower, all[0].value, all[0].upper, all[0].valid.lower}),
            (std::vector<double>{10, 50, 100, 1}));
  EXPECT_EQ(all[0].valid.upper, 1000);
  EXPECT_EQ(all[1].lower, 1);
  EXPECT_NEAR(all[1].valid.lower, 1e-9, 1e-24) << "of a modulus 1e-6 MPa";
  const FullMu mu{50, 2, 1};
  EXPECT_EQ(scene.motion(mu, {0, 1, 0})[1], -0.05);
  EXPECT_NEAR(scene.materials[0].of_cell(mu, {}).shear, 2000 / 2.5, 1e-12);
  EXPECT_NEAR(scene.map(mu, {1, 1, 0})[1], 1.25, 1e-15);
  ASSERT_TRUE(scene.a.front().form.kernel);
  EXPECT_NO_THROW(scene.check_parameters(mu));
  EXPECT_THROW(scene.check_parameters({90, 2, 1}), Error) << "0.09 mm are not less than 0.08";
  EXPECT_EQ(scene.tests.at(0).at.at("depth"), 60);
  EXPECT_NEAR(scene.tests.at(0).at.at("tilt"), 0.01 * 180 / M_PI, 1e-15);
}

/// What a run, a choice or a variant gives without a unit is in that of the parameter, too.
TEST(Case, ValuesInPlaceOfOthersKeepTheUnit) {
  const auto map_of = [](const SceneOptions &options, const CaseChanges &changes = {}) {
    std::map<std::string, std::string> other = in_units;
    other["variants"] = "{thick: {parameters.thickness.default: 800}}";
    return make_scene(entry_in(other, changes), options).map({50, 2, 1, 300}, {1, 1, 0})[1];
  };
  EXPECT_NEAR(map_of({{"thickness", "800"}}), 1.4, 1e-15);
  EXPECT_NEAR(map_of({{"thickness", "0.8 mm"}}), 1.4, 1e-15);
  EXPECT_NEAR(map_of({{"thickness", "200,0.9 mm"}}), 1.15, 1e-15);
  EXPECT_NEAR(map_of({}, {"thick", {}}), 1.4, 1e-15);
  EXPECT_NEAR(map_of({}, {"", {{"parameters.thickness.default", "800"}}}), 1.4, 1e-15);
  EXPECT_THROW(map_of({{"thickness", "1100"}}), Error);
  EXPECT_THROW(map_of({{"thickness", "0.8"}}), Error) << "0.8 um";
}

const std::map<std::string, std::string> chosen{
    {"let", "{stiff: 1}"},
    {"materials", "{rubber: {at: all, E: young*k*stiff, nu: nu}}"},
    {"choices",
     "{law: {default: none, none: {}, coulomb: {contact.floor.friction: {coulomb: 0.3}}}, "
     "stiffness: {sets: let.stiff, range: [0, 10]}}"},
    {"variants", "{hard: {says: harder, let.stiff: 4, choices.law.default: coulomb, "
                 "options: {pod_tolerance: 1e-3}, train: grid:2}}"}};

TEST(Case, FactsOfAMeshArePlacesAndSizesOfItsParts) {
  const Scene scene = scene_of(
      {{"units", "{length: mm, force: N}"},
       {"mesh",
        "{file: a.msh, facts: {all: {size: 0.5}, core: {disk: [0, 1, 0.25]}, contact: {segment: "
        "[0, 0, 1 mm, 0], within: rim}, top: {arc: [0, 0, 1, 0, 90 deg], size: pi/2}}}"},
       {"materials", "{rubber: {at: [all, core], E: young*k, nu: nu}}"}});
  const std::vector<MeshFact> &facts = scene.mesh.facts;
  ASSERT_EQ(facts.size(), 4U);
  EXPECT_EQ(facts[0].part, "");
  EXPECT_EQ(facts[0].is, "of area 0.5");
  EXPECT_EQ(facts[0].size, 0.5);
  EXPECT_EQ(facts[0].excess, 0.1);
  EXPECT_FALSE(facts[0].distance);
  EXPECT_EQ(facts[1].is, "the disk of radius 0.25 about (0, 1)");
  EXPECT_DOUBLE_EQ(facts[1].distance({0, 0.9, 0}), -0.15);
  EXPECT_EQ(facts[2].is, "the segment from (0, 0) to (1, 0), a part of 'rim'");
  EXPECT_EQ(facts[2].within, "rim");
  EXPECT_DOUBLE_EQ(facts[2].distance({2, 0, 0}), 1);
  EXPECT_EQ(facts[3].is, "the arc of radius 1 about (0, 0) from 0 to 90 degrees, of length 1.571");
  EXPECT_NEAR(facts[3].distance({-1, 0, 0}), std::sqrt(2), 1e-15);
  EXPECT_EQ(scene.mesh.boundaries, (Names{"top", "contact", "rim"})) << "with the outer one";
  const Scene boxed = scene_of({{"mesh", "{file: a.msh, facts: {all: {box: [0, 0, 1, 0.5]}}}"}});
  EXPECT_EQ(boxed.mesh.facts[0].is, "the box [0, 1] x [0, 0.5]");
  EXPECT_DOUBLE_EQ(boxed.mesh.facts[0].distance({0.5, 0.25, 0}), -0.25);
}

TEST(Case, UnitsAreAllowedOnWhatARunGives) {
  const Scene scene =
      scene_of({{"units", "{length: mm, force: N}"},
                {"parameters", "{depth: {range: [0.01, 0.1], default: 0.05}, k: {range: [0.5, 20], "
                               "default: 1}, nu: {range: [0.1, 0.4], default: 0.3}, "
                               "young: {default: 15, unit: MPa}}"}},
               {{"young", "1 MPa,2 GPa"}});
  EXPECT_EQ(scene.parameters.all[3].lower, 1);
  EXPECT_EQ(scene.parameters.all[3].upper, 2000);
  EXPECT_TRUE(scene.units);
  EXPECT_FALSE(scene_of().units);
}

TEST(Case, ChoicesVariantsAndPathsChangeIt) {
  EXPECT_FALSE(has_friction(scene_of(chosen)));
  EXPECT_TRUE(has_friction(scene_of(chosen, {{"law", "coulomb"}})));
  EXPECT_THROW((void)scene_of(chosen, {{"law", "glue"}}), Error);
  const auto shear = [](const Scene &scene) {
    return scene.materials[0].of_cell({0, 1, 0}, {}).shear;
  };
  EXPECT_NEAR(shear(scene_of(chosen, {{"stiffness", "2"}})), 15, 1e-14);
  const SceneEntry hard = entry_in(chosen, {"hard", {}});
  EXPECT_EQ(hard.variants.front().second, "harder");
  EXPECT_EQ(hard.settings.front().value, "1e-3");
  const Scene scene = make_scene(hard, {});
  EXPECT_NEAR(shear(scene), 30, 1e-14);
  EXPECT_TRUE(has_friction(scene));
  EXPECT_EQ(scene.training, "grid:2");
  EXPECT_NEAR(shear(make_scene(hard, {{"stiffness", "1"}})), 7.5, 1e-14);
  EXPECT_NEAR(shear(scene_of(chosen, {{"stiffness", "2"}}, {"hard", {{"let.stiff", "8"}}})), 60,
              1e-13);
  std::map<std::string, std::string> constant = chosen;
  constant["choices"] = "{metal: {default: no, no: {}, yes: {parameters.young.default: 60}}}";
  EXPECT_NEAR(shear(scene_of(constant, {{"metal", "yes"}})), 30, 1e-13);
  EXPECT_NEAR(shear(scene_of(constant, {{"metal", "yes"}, {"young", "30"}})), 15, 1e-14);
  EXPECT_THROW((void)entry_in(chosen, {"soft", {}}), Error);
  EXPECT_THROW((void)entry_in(chosen, {"", {{"contact.wall.lumped", "yes"}}}), Error);
}

TEST(Case, TestsAreThoseOfTheChoicesAndVariant) {
  std::map<std::string, std::string> with = chosen;
  with["tests"] = "{pressed: {at: {depth: 0.05}, expect: {energy: 2 - 1, reaction: 0}, "
                  "tolerance: 1e-3}}";
  with["choices"] = "{law: {default: none, none: {}, "
                    "coulomb: {contact.floor.friction: {coulomb: 0.3}, tests: }}}";
  with["variants"] = "{hard: {let.stiff: 4, tests.pressed.expect.energy: 4}}";
  const std::vector<SceneTest> tests = scene_of(with).tests;
  ASSERT_EQ(tests.size(), 1U);
  EXPECT_EQ(tests[0].name, "pressed");
  EXPECT_EQ(tests[0].at, (std::map<std::string, double>{{"depth", 0.05}}));
  EXPECT_EQ(tests[0].expected, (std::map<std::string, double>{{"energy", 1}, {"reaction", 0}}));
  EXPECT_EQ(tests[0].tolerance, 1e-3);
  EXPECT_TRUE(scene_of(with, {{"law", "coulomb"}}).tests.empty());
  EXPECT_EQ(scene_of(with, {}, {"hard", {}}).tests.at(0).expected.at("energy"), 4);
  with["materials"] = "{rubber: {at: all, E: young*stiff, nu: nu}}";
  with["free"] = "depth";
  with["tests"] = "{pressed: {at: {k: 2}, expect: {energy: 1}, tolerance: 1e-3}}";
  EXPECT_TRUE(scene_of(with).tests.at(0).at.empty()) << "nothing depends on k";
}

TEST(Case, TestsHaveUnits) {
  const Scene scene = scene_of({{"units", "{length: mm, force: N}"},
                                {"parameters", "{depth: {range: [10 um, 1 mm], default: 0.5, "
                                               "limits: [0, 2], unit: mm}}"},
                                {"materials", "{steel: {at: all, E: 205 GPa, nu: 0.25}}"},
                                {"tests", "{deep: {at: {depth: 0.15 cm}, "
                                          "expect: {peak_pressure: 2 GPa}, tolerance: 1e-2}}"}});
  ASSERT_EQ(scene.tests.size(), 1U);
  EXPECT_NEAR(scene.tests[0].at.at("depth"), 1.5, 1e-15) << "within its limits";
  EXPECT_NEAR(scene.tests[0].expected.at("peak_pressure"), 2000, 1e-12);
}

TEST(Case, NamesOfContactAreKept) {
  EXPECT_EQ(scene_of().contacts.front().name, "floor");
  const Scene roller = make_scene("roller");
  EXPECT_EQ(contact_name(roller, 1), "lower plate");
  EXPECT_EQ(described(roller.contacts[0]), "contact 'upper plate' on 'top'");
}

/// The page of choices: without vertex quadrature the peak overshoots at any mesh.
TEST(Case, AnObstacleHasVertexQuadratureUnlessTheCaseSaysNo) {
  const auto lumped = [](const std::string &more) {
    return scene_of({{"physics", "membrane"},
                     {"mesh", "{built_in: square_with_disc}"},
                     {"materials", ""},
                     {"parameters", "{depth: {range: [0.01, 0.1], default: 0.05}}"},
                     {"imposed", "{frame: {at: boundary, u: 0}}"},
                     {"contact", "{o: {at: obstacle, above: -depth" + more + "}}"}})
        .contacts.front()
        .nodal;
  };
  EXPECT_TRUE(lumped(""));
  EXPECT_TRUE(lumped(", lumped: yes"));
  EXPECT_FALSE(lumped(", lumped: no"));
}

TEST(Case, ParametersThatNothingUsesAreLeftOut) {
  const std::map<std::string, std::string> other{
      {"materials", "{rubber: {at: all, E: young, nu: nu}}"}};
  EXPECT_THROW((void)scene_of(other), Error) << "k would be free";
  std::map<std::string, std::string> fixed = other;
  fixed["free"] = "depth";
  EXPECT_EQ(names_in(scene_of(fixed)), (Names{"depth", "nu"}));
  EXPECT_EQ(scene_of(fixed).parameters.size(), 1);
}

TEST(Case, TheCasesOfTheRepositoryAndTheirVariantsAreScenes) {
  for (const SceneEntry &entry : catalogue()) {
    EXPECT_NO_THROW((void)make_scene(entry, {})) << entry.name;
    EXPECT_FALSE(entry.summary.empty());
  }
  EXPECT_NO_THROW((void)make_scene(read_case(new_case(), "new.yaml"), {}));
}

TEST(Case, OutputsHaveUnitsWhereTheyAreKnown) {
  const auto units = [](const std::string &physics,
                        const std::map<std::string, std::string> &more) {
    std::map<std::string, std::string> sections{
        {"physics", physics},
        {"materials", "{rubber: {at: all, E: 15 MPa, nu: 0.3}}"},
        {"parameters", "{depth: {range: [0.01, 0.1], default: 0.05, unit: mm}}"},
        {"outputs", "{pull: {integral: pressure, at: floor, says: what it carries}, "
                    "lever: {integral: pressure * (x - 1), at: floor}, "
                    "wide: {measure: pressure > 0, at: floor}, worst: {max: von_mises, in: all}, "
                    "stored: {integral: strain_energy, in: all}, twice: {max: 2 * ux, in: all}}"}};
    for (const auto &[name, text] : more)
      sections[name] = text;
    const Scene scene = scene_of(sections);
    std::map<std::string, std::string> found;
    for (const char *name : {"energy", "normal_force", "peak_pressure", "contact_measure",
                             "iterations", "pull", "lever", "wide", "worst", "stored", "twice"})
      found[name] = unit_of(scene, output_column(name));
    EXPECT_EQ(says_of(scene, output_column("pull")), "what it carries");
    EXPECT_EQ(says_of(scene, output_column("energy")), output_column("energy").says);
    return found;
  };
  using Units = std::map<std::string, std::string>;
  const std::pair<const std::string, std::string> millimetres{"units", "{length: mm, force: N}"};
  EXPECT_EQ(units("plane_strain", {millimetres}), (Units{{"energy", "N"},
                                                         {"normal_force", "N/mm"},
                                                         {"peak_pressure", "MPa"},
                                                         {"contact_measure", "mm"},
                                                         {"iterations", ""},
                                                         {"pull", "N/mm"},
                                                         {"lever", "N"},
                                                         {"wide", "mm"},
                                                         {"worst", "MPa"},
                                                         {"stored", "N"},
                                                         {"twice", ""}})); // 2 may have any
  const Units turned =
      units("axisymmetric", {millimetres, {"imposed", "{top: {at: top, uy: -depth}}"}});
  EXPECT_EQ(turned.at("energy"), "mm*N");
  EXPECT_EQ(turned.at("normal_force"), "N");
  EXPECT_EQ(turned.at("contact_measure"), "mm^2");
  EXPECT_EQ(turned.at("stored"), "mm*N");
  EXPECT_EQ(turned.at("pull"), "N");
}

} // namespace
} // namespace rbvi::case_test
