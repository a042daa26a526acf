// What samples and models keep of a scene: it is the same when made again from its tree, and the
// first value that answers depend on tells two of them apart.
#include "../core/refuses.hpp"
#include "block_case.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/scene/stored_scene.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

namespace rbvi::stored_scene_test {
namespace {

Scene made_again(const Scene &scene) {
  return scene_in(scene.tree, scene.options, {});
}

/// All parameters, no two of the same kind of place in their boxes.
FullMu somewhere(const Scene &scene) {
  FullMu mu;
  double part = 0.3;
  for (const Parameter &p : scene.parameters.all) {
    mu.push_back(p.lower + part * (p.upper - p.lower));
    part = 0.9 - 0.7 * part;
  }
  return mu;
}

std::vector<double> values_of(const Scene &scene, const Term &term, const FullMu &mu) {
  Cell cell{2, {{{0.3, 0.51, 0}, {0.35, 0.52, 0}, {0.31, 0.56, 0}}}, {}};
  for (std::size_t v = 0; v < 3; ++v)
    cell.mapped[v] = scene.map(mu, cell.reference[v]);
  std::vector<double> values(144, 0);
  if (term.form.kernel) term.form.kernel(mu, cell, values.data());
  return values;
}

void expect_same(const Sum &one, const Sum &two, const Scene &scene) {
  const FullMu mu = somewhere(scene);
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].form.region, two[i].form.region);
    EXPECT_EQ(one[i].form.boundary, two[i].form.boundary);
    EXPECT_EQ(values_of(scene, one[i], mu), values_of(scene, two[i], mu));
    ASSERT_EQ(one[i].theta.has_value(), two[i].theta.has_value());
    for (std::size_t k = 0; one[i].theta && k < one[i].theta->size(); ++k)
      EXPECT_EQ(one[i].theta->at(k).value(mu), two[i].theta->at(k).value(mu));
  }
}

void expect_same(const Scene &one, const Scene &two) {
  const FullMu mu = somewhere(one);
  const Point x{0.3, 0.51, 0};
  EXPECT_EQ(one.map(mu, x), two.map(mu, x));
  ASSERT_EQ(static_cast<bool>(one.motion), static_cast<bool>(two.motion));
  if (one.motion) {
    EXPECT_EQ(one.motion(mu, x), two.motion(mu, x));
  }
  ASSERT_EQ(one.materials.size(), two.materials.size());
  for (std::size_t m = 0; m < one.materials.size(); ++m)
    EXPECT_EQ(one.materials[m].of_cell(mu, x).shear, two.materials[m].of_cell(mu, x).shear);
  ASSERT_EQ(one.contacts.size(), two.contacts.size());
  for (std::size_t i = 0; i < one.contacts.size(); ++i) {
    EXPECT_EQ(described(one.contacts[i]), described(two.contacts[i]));
    ASSERT_EQ(one.contacts[i].coefficients.size(), two.contacts[i].coefficients.size());
    for (std::size_t k = 0; k < one.contacts[i].coefficients.size(); ++k)
      EXPECT_EQ(one.contacts[i].coefficients[k].value(mu),
                two.contacts[i].coefficients[k].value(mu));
  }
  EXPECT_EQ(has_friction(one), has_friction(two));
  EXPECT_EQ(separable_contact(one), separable_contact(two));
  EXPECT_EQ(one.outputs.size(), two.outputs.size());
  EXPECT_EQ(one.units, two.units);
  expect_same(one.a, two.a, one);
  expect_same(one.f, two.f, one);
}

TEST(StoredScene, IsTheSameWhenMadeAgain) {
  const std::vector<Scene> scenes = every_variant();
  EXPECT_GT(scenes.size(), 80U);
  for (const Scene &scene : scenes) {
    SCOPED_TRACE(scene.name);
    const Scene again = made_again(scene);
    EXPECT_EQ(again.tree, scene.tree);
    EXPECT_EQ(scene_difference(again.tree, scene.tree, Compared::answers_and_outputs), "");
    expect_same(scene, again);
  }
}

TEST(StoredScene, RefusesWhatTheSceneRefuses) {
  int asked = 0;
  for (const Scene &scene : every_variant()) {
    if (!scene.check_parameters) continue;
    const Scene again = made_again(scene);
    const auto refusal = [&](const Scene &of, FullMu mu) -> std::string {
      for (double &value : mu)
        value *= 3;
      try {
        of.check_parameters(mu);
      } catch (const Error &error) {
        return error.what();
      }
      return "";
    };
    EXPECT_EQ(refusal(again, somewhere(scene)), refusal(scene, somewhere(scene)));
    asked += refusal(scene, somewhere(scene)).empty() ? 0 : 1;
  }
  EXPECT_GT(asked, 0);
}

TEST(StoredScene, IsATreeOfPathsAndValues) {
  const std::string text = "a.b\\.c\\[\\:: 1: 2\na.list[0]: x\na.list[1].y: \nnone[]: \nidle{}: \n";
  const CaseNode root = tree_in(text);
  EXPECT_EQ(text_of(root), text);
  ASSERT_NE(root.find("a"), nullptr);
  EXPECT_EQ(root.find("a")->find("b.c[:")->value, "1: 2");
  EXPECT_EQ(root.find("a")->find("list")->items.size(), 2U);
  EXPECT_EQ(root.find("none")->kind, CaseNode::Kind::list);
  EXPECT_TRUE(root.find("idle")->is_table());
  for (const char *wrong : {"a\n", "a:1\n", "a[0\n", "{a: 1\n", "a..b: 1\n"})
    EXPECT_TRUE(refuses("lines 'path: value'", [&] { (void)tree_in(wrong); })) << wrong;
  EXPECT_TRUE(refuses("a scene without a name", [] { (void)scene_in("", {}, catalogue()); }));
  EXPECT_TRUE(refuses("the stored case", [] {
    (void)scene_in("rbvi: 1\nphysics: plane_strain\n", {}, catalogue());
  })) << "no mesh, no contact";
}

std::string tree_of(const Sections &other, const CaseChanges &changes = {},
                    const SceneOptions &options = {}) {
  return make_scene(read_case(block_case(other), "block.yaml", changes), options).tree;
}

std::string difference(const Sections &theirs, const Sections &mine) {
  return scene_difference(tree_of(theirs), tree_of(mine));
}

TEST(StoredScene, TheFirstDifferenceIsToldInTheWordsOfTheCase) {
  const std::string floor = "against: {plane: {normal: [0, -1], position: 0}}";
  EXPECT_EQ(difference({}, {}), "");
  EXPECT_EQ(difference({}, {{"materials", "{rubber: {at: all, E: k*young, nu: nu}}"}}),
            "E of rubber is k*young, it was young*k");
  EXPECT_EQ(difference({}, {{"imposed", "{top: {at: top, uy: -depth}}"}}),
            "ux of top was 0 and is gone");
  EXPECT_EQ(difference({}, {{"v_length", "2"}}), "v_length is 2, it was not there");
  EXPECT_EQ(difference({}, {{"contact", "{floor: {at: contact, against: {plane: {normal: [0, -1], "
                                        "position: -0.01}}}}"}}),
            "against.plane.position of floor is -0.01, it was 0");
  EXPECT_EQ(scene_difference(tree_of({}), tree_of({}, {}, {{"young", "20"}})),
            "young is 20, it was 15");
  EXPECT_EQ(scene_difference(tree_of({}), tree_of({}, {"", {{"mesh.degree", "1"}}, {}})),
            "mesh.degree is 1, it was not there");
}

TEST(StoredScene, WhatChangesNoAnswerDoesNotCount) {
  const std::string plane = "{at: contact, against: {plane: {normal: [0, -1], position: 0}}}";
  for (const Sections &other :
       {Sections{{"name", "another"}, {"says", "what it is"}},
        {{"parameters",
          "{depth: {range: [0.02, 0.2], default: 0.07, limits: [0, 1], says: how deep}, "
          "k: {range: [0.5, 20], default: 1}, nu: {range: [0.1, 0.4], default: 0.3}, "
          "young: {default: 15}, idle: {default: 3}}"}},
        {{"contact", "{ground: " + plane + "}"}},
        {{"train", "'grid:2,2,2'"}, {"validate", "'random:4:1'"}, {"free", "depth"}},
        {{"outputs", "{p: {integral: twice*pressure}}"}, {"let", "{twice: 2, unused: twice}"}},
        {{"require", "{deep: {that: 'depth < 0.3', says: too deep}}"}},
        {{"options", "{pod_tolerance: 1e-3}"}}}) {
    EXPECT_EQ(difference({}, other), "");
    EXPECT_EQ(difference(other, {}), "");
  }
}

/// The mesh tells them, and the tree keeps them.
TEST(StoredScene, KeepsBodiesThatContactAloneHolds) {
  Scene scene = make_scene(read_case(block_case(), "block.yaml"));
  const std::string before = scene.tree;
  const std::size_t a = scene.a.size(), f = scene.f.size();
  add_held_body(scene, 1);
  add_held_body(scene, -1);
  EXPECT_EQ(scene.a.size(), a + 2);
  EXPECT_EQ(scene.f.size(), f + 1);
  EXPECT_EQ(scene_difference(before, scene.tree), "");
  const Scene again = made_again(scene);
  EXPECT_EQ(again.tree, scene.tree);
  expect_same(scene, again);
  EXPECT_EQ(coefficient_of(again.a[a], somewhere(scene)),
            coefficient_of(scene.a[1], somewhere(scene)));
  EXPECT_EQ(coefficient_of(again.a[a + 1], somewhere(scene)), 1);
}

TEST(StoredScene, OutputsCountWhereTheyAreAskedFor) {
  const auto of = [](const std::string &twice) {
    return tree_of(
        {{"outputs", "{p: {integral: twice*pressure}}"}, {"let", "{twice: " + twice + "}"}});
  };
  const auto between = [](const std::string &theirs, const std::string &mine) {
    return scene_difference(theirs, mine, Compared::answers_and_outputs);
  };
  EXPECT_EQ(scene_difference(of("2"), of("3")), "");
  EXPECT_EQ(between(of("2"), of("3")), "twice is 3, it was 2");
  EXPECT_EQ(between(tree_of({}), of("2")), "twice is 2, it was not there");
}

} // namespace
} // namespace rbvi::stored_scene_test
