// What model files hold of scenes: every function of every scene has a name, and is the same when
// made again from it.
#include "../core/refuses.hpp"
#include "rbvi/contact/registry.hpp"
#include "rbvi/model/scene_record.hpp"
#include "tests/catalogue.hpp"

#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>
#include <set>

namespace rbvi::scene_record_test {
namespace {

Scene made_again(const Scene &scene) {
  Scene again = scene_in({record_in(lines_of(record_of(scene))), &catalogue()});
  again.parameters = scene.parameters;
  return again;
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

/// A cell inside of every body.
Cell cell_of(const Scene &scene, const FullMu &mu) {
  Cell cell{2, {{{0.3, 0.51, 0}, {0.35, 0.52, 0}, {0.31, 0.56, 0}}}, {}};
  for (std::size_t v = 0; v < 3; ++v)
    cell.mapped[v] = scene.map(mu, cell.reference[v]);
  return cell;
}

std::vector<double> values_of(const Scene &scene, const Term &term, const FullMu &mu) {
  std::vector<double> values(144, 0);
  term.form.kernel(mu, cell_of(scene, mu), values.data());
  return values;
}

TEST(SceneRecord, EveryFunctionOfEverySceneHasAName) {
  for (const Scene &scene : every_choice())
    EXPECT_TRUE(is_complete(record_of(scene)))
        << scene.name << ": " << first_unnamed(record_of(scene));
}

TEST(SceneRecord, LinesHoldTheWholeRecord) {
  for (const Scene &scene : every_choice()) {
    const auto lines = lines_of(record_of(scene));
    EXPECT_EQ(lines_of(record_in(lines)), lines) << scene.name;
    EXPECT_EQ(lines_of(record_of(made_again(scene))), lines) << scene.name;
  }
}

/// Records of before have none.
TEST(SceneRecord, ContactsKeepTheirNames) {
  Record record = record_of(make_scene("roller"));
  EXPECT_EQ(contact_name(scene_in({record, &catalogue()}), 1), "lower plate");
  for (const char *contact : {"contact_0", "contact_1"})
    record.parts.at(contact).texts.erase("name");
  EXPECT_EQ(contact_name(scene_in({record, &catalogue()}), 1), "contact 2");
  EXPECT_EQ(contact_name(make_scene("patch"), 0), "blocks");
  record = record_of(make_scene("patch"));
  record.parts.at("contact_0").texts.erase("name");
  EXPECT_EQ(contact_name(scene_in({record, &catalogue()}), 0), "contact");
}

TEST(SceneRecord, FunctionsMadeAgainAreTheSame) {
  for (const Scene &scene : every_choice()) {
    const Scene again = made_again(scene);
    const FullMu mu = somewhere(scene);
    const Point x{0.3, 0.51, 0};
    EXPECT_EQ(again.map(mu, x), scene.map(mu, x)) << scene.name;
    ASSERT_EQ(static_cast<bool>(again.motion), static_cast<bool>(scene.motion));
    if (scene.motion) {
      EXPECT_EQ(again.motion(mu, x), scene.motion(mu, x)) << scene.name;
    }
    ASSERT_EQ(again.materials.size(), scene.materials.size());
    for (std::size_t m = 0; m < scene.materials.size(); ++m) {
      const auto &material = again.materials[m], &wanted = scene.materials[m];
      EXPECT_EQ(material.regions, wanted.regions);
      EXPECT_EQ(material.of_cell(mu, x).shear, wanted.of_cell(mu, x).shear) << scene.name;
    }
    EXPECT_EQ(again.symmetric, scene.symmetric);
    EXPECT_EQ(image_count(again.mirrors), image_count(scene.mirrors));
    EXPECT_EQ(has_multipliers(again), has_multipliers(scene));
    EXPECT_EQ(has_friction(again), has_friction(scene));
    EXPECT_EQ(separable_contact(again), separable_contact(scene));
    EXPECT_EQ(keeps_nodes(again), keeps_nodes(scene));
    EXPECT_EQ(bounds_nodes(again), bounds_nodes(scene));
  }
}

TEST(SceneRecord, CoefficientsAndKernelsMadeAgainAreTheSame) {
  const auto expect_same = [](const Scene &scene, const Scene &again, const Sum Scene::*sum) {
    const FullMu mu = somewhere(scene);
    ASSERT_EQ((again.*sum).size(), (scene.*sum).size());
    for (std::size_t i = 0; i < (scene.*sum).size(); ++i) {
      const Term &one = (scene.*sum)[i], &two = (again.*sum)[i];
      ASSERT_EQ(one.theta.has_value(), two.theta.has_value());
      if (!one.theta) {
        EXPECT_EQ(values_of(scene, one, mu), values_of(again, two, mu)) << scene.name;
        continue;
      }
      ASSERT_EQ(one.theta->size(), two.theta->size());
      for (std::size_t k = 0; k < one.theta->size(); ++k)
        EXPECT_EQ((*one.theta)[k].value(mu), (*two.theta)[k].value(mu)) << scene.name;
    }
    const SplitSum split = split_sum(scene.*sum, scene.parameters);
    EXPECT_EQ(exact_coefficients(scene.*sum, split, scene.parameters, mu),
              exact_coefficients(again.*sum, split_sum(again.*sum, scene.parameters),
                                 scene.parameters, mu));
  };
  for (const Scene &scene : every_choice()) {
    const Scene again = made_again(scene);
    expect_same(scene, again, &Scene::a);
    expect_same(scene, again, &Scene::f);
  }
}

TEST(SceneRecord, ConstantsTellFunctionsOfOneNameApart) {
  const FullMu mu{0.25, 4};
  const auto again = []<class Signature>(const Named<Signature> &function) {
    return made<Signature>({function.record, &catalogue()});
  };
  EXPECT_EQ(again(parameter(1))(mu), 4);
  EXPECT_EQ(again(affine(1, -2, 0))(mu), 0.5);
  EXPECT_EQ(again(constant(0.1 + 0.2))(mu), 0.1 + 0.2);
  EXPECT_EQ(again(everywhere(Point{1, 2, 3}))(mu, {}), (Point{1, 2, 3}));
  EXPECT_EQ(again(everywhere(7.0))(mu, {}), 7);
}

TEST(SceneRecord, AFunctionWithoutANameIsFound) {
  Scene scene = make_scene("roller");
  scene.map = [](const FullMu &, const Point &x) { return x; };
  EXPECT_EQ(first_unnamed(record_of(scene)), "map");
  EXPECT_EQ(made_again(make_scene("roller")).contacts.size(), 2U);
  scene = make_scene("rigid_disk");
  scene.a[0].theta->front().value = [](const FullMu &) { return 1.0; };
  EXPECT_EQ(first_unnamed(record_of(scene)), "a_0/factor_0/value");
}

TEST(SceneRecord, WhatThisBuildDoesNotHaveIsNamed) {
  const auto refusal = [](const auto &change) -> std::string {
    Record record = record_of(make_scene("two_disks"));
    change(record);
    try {
      (void)scene_in({record, &catalogue()});
    } catch (const Error &error) {
      EXPECT_EQ(error.status(), Status::bad_input);
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal([](Record &) {}), "");
  EXPECT_NE(refusal([](Record &r) {
              r.parts["map"].name = "three_disks/placed";
            }).find("function 'three_disks/placed' version 1 is not in this build"),
            std::string::npos);
  EXPECT_NE(refusal([](Record &r) {
              r.parts["map"].version = 7;
            }).find("'expression' version 7 is not in this build, which has version 1"),
            std::string::npos);
  EXPECT_NE(refusal([](Record &r) {
              r.parts["contact_0"].name = "glue";
            }).find("contact 'glue' version 4 is not in this build"),
            std::string::npos);
  EXPECT_NE(refusal([](Record &r) {
              r.parts["map"].numbers.clear();
            }).find("the record of 'expression' lacks 'positions'"),
            std::string::npos);
}

TEST(SceneRecord, ARegistryHasTheFunctionsOfTheLibraryAndOfItsScenes) {
  const Registry none = registry_of({});
  const Record own = record_of(make_scene("two_disks"));
  EXPECT_NO_THROW((void)scene_in({own, &none}));
  const auto half =
      plain<PointMap>("own/half", 1, [](const FullMu &, const Point &x) { return 0.5 * x; });
  const Registry with = registry_of({{"own", "", {}, {}, {half}}});
  EXPECT_EQ(made<PointMap>({half().record, &with})({}, {2, 0, 0})[0], 1);
  EXPECT_TRUE(refuses("function 'own/half' version 1 is not in this build", [&] {
    (void)made<PointMap>({half().record, &none});
  }));
  EXPECT_TRUE(refuses("contact 'two_bodies' version 4 is not in this build",
                      [&] { (void)contact_in({own.parts.at("contact_0")}); }));
  EXPECT_EQ(made<Coefficient>({parameter(1).record, &none})(FullMu{0.25, 4}), 4);
  EXPECT_TRUE(refuses("unknown scene 'roller': this build has none",
                      [&] { (void)entry_of(none, "roller"); }));
}

TEST(SceneRecord, MakersHaveNamesOfTheirOwn) {
  std::set<std::pair<std::size_t, std::string>> names;
  for (const AnyMaker &maker : catalogue().functions)
    EXPECT_TRUE(
        names.emplace(maker.index(), std::visit([](const auto &m) { return m.name; }, maker))
            .second)
        << std::visit([](const auto &m) { return m.name; }, maker);
}

} // namespace
} // namespace rbvi::scene_record_test
