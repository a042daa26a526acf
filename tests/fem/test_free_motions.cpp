// Bodies that nothing holds are refused with their name and their motion.
#include "../core/refuses.hpp"
#include "../cube_mesh.hpp"
#include "../mesh/temporary_file.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/facet_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"
#include "rbvi/fem/free_motions.hpp"
#include "rbvi/fem/problem.hpp"
#include "rbvi/scene/case.hpp"
#include "tests/catalogue.hpp"

namespace rbvi::free_motions_test {
namespace {

Scene with_fixed(Scene scene, std::vector<FixedBoundary> fixed) {
  scene.fixed = std::move(fixed);
  scene.f.clear();
  return scene;
}

Scene block(std::vector<FixedBoundary> fixed) {
  return with_fixed(make_scene("patch", {{"bodies", "one"}}), std::move(fixed));
}

std::string motions(const Scene &scene, const Mesh &mesh) {
  const std::vector<FreeBody> bodies =
      free_bodies(scene, mesh, number_dofs(mesh, scene.components, scene.fixed));
  const Index count = motions_of(bodies);
  return describe(bodies, mesh.dim, Matrix::Identity(count, count));
}

std::string motions(const Scene &scene) {
  return motions(scene, make_mesh(PETSC_COMM_WORLD, scene, {}));
}

TEST(FreeMotions, OfABlockAreNamed) {
  const auto expect = [](const std::string &motion, std::vector<FixedBoundary> fixed) {
    EXPECT_EQ(motions(block(std::move(fixed))), "the body can " + motion);
  };
  expect("move and turn", {});
  expect("move along (0, 1)", {{"sides", {0}}});
  expect("move along (1, 0)", {{"top", {1}}});
  // The scene is drawn where it moves to: its top is at 0.5.
  expect("move along (0, 1) and turn about (0.5, 0.5)", {{"top", {0}}});
  EXPECT_EQ(motions(block({{"sides", {0}}, {"top", {1}}})), "");
  EXPECT_EQ(motions(block({{"sides", {1}}, {"top", {0}}})), "");
}

TEST(FreeMotions, OneOfTwoBodiesMayBeFree) {
  Scene scene = with_fixed(make_scene("patch"), {{"bottom", {}}});
  EXPECT_EQ(motions(scene), "the body 'upper' between (0, 0) and (1, 0.5) can move and turn");
  scene.mesh.regions.clear();
  scene.mesh.facts.clear();
  EXPECT_EQ(motions(scene), "the body between (0, 0) and (1, 0.5) can move and turn");
  EXPECT_EQ(motions(with_fixed(make_scene("patch"), {{"sides", {0}}})),
            "the body 'upper' between (0, 0) and (1, 0.5) can move along (0, 1), the body 'lower' "
            "between (0, -0.5) and (1, 0) can move along (0, 1)");
}

/// Refused are those that no contact can prevent.
TEST(FreeMotions, ThatNoContactPreventsAreRefused) {
  const auto make = [](const Scene &scene) { Problem(PETSC_COMM_WORLD, scene, {}); };
  EXPECT_NO_THROW(make(block({})));
  EXPECT_TRUE(refuses("the body can move along (1, 0): impose displacements that prevent it", [&] {
    make(with_fixed(make_scene("patch", {{"bodies", "one"}, {"friction", "none"}}), {}));
  }));
  EXPECT_TRUE(
      refuses("the body 'upper' between (0, 0) and (1, 0.5) can move along (1, 0): impose", [&] {
        make(with_fixed(make_scene("patch"), {{"bottom", {}}}));
      }));
  EXPECT_TRUE(refuses("can move and turn: impose", [&] {
    make(with_fixed(make_scene("patch"), {}));
  })) << "both together";
  EXPECT_TRUE(refuses("the body can move: impose", [&] {
    make(with_fixed(make_scene("membrane_obstacle", {{"circle_edges", "12"}}), {}));
  }));
}

/// The upper quarter of a disk, where the map takes it.
TEST(FreeMotions, ATurnIsAboutThePointWhereItsLinesCross) {
  const Scene scene =
      with_fixed(make_scene("two_disks", {{"arc_edges", "8"}}), {{"axis", {1}}, {"top", {0}}});
  EXPECT_NE(motions(scene).find(" and (1, 1.001) can turn about (0, 1.001), the body"),
            std::string::npos);
}

TEST(FreeMotions, OfAMembraneIsTheConstant) {
  const Scene scene = make_scene("membrane_obstacle", {{"circle_edges", "12"}});
  EXPECT_EQ(motions(with_fixed(scene, {})), "the body can move");
}

TEST(FreeMotions, TermsOfAHoldABody) {
  Scene scene = block({});
  scene.a.push_back(exact_term(spring("sides", 1e-9, 2, 1)));
  EXPECT_EQ(motions(scene), "");
  // A force on the displacement alone, without one on its slope.
  Scene membrane = with_fixed(make_scene("membrane_obstacle", {{"circle_edges", "12"}}), {});
  membrane.a.push_back(exact_term(spring("boundary", 1, 1, 1)));
  EXPECT_EQ(motions(membrane), "");
  // Of two bodies the springs hold one.
  Scene two = with_fixed(make_scene("patch"), {});
  two.a.push_back(exact_term(spring("bottom", 1, 2, 1)));
  EXPECT_EQ(motions(two), "the body 'upper' between (0, 0) and (1, 0.5) can move and turn");
}

/// What holds a body holds it in the whole box.
TEST(FreeMotions, ASpringWithoutStiffnessSomewhereIsRefused) {
  const auto made = [](const std::string &stiffness, const std::string &other) {
    return make_scene(
        read_case("rbvi: 1\nphysics: plane_strain\nmesh: {built_in: one_block, degree: 1}\n"
                  "parameters: {k: {range: [0, 2], default: 1}}\n"
                  "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
                  "imposed: {top: {at: top, uy: -0.01}}\nsprings:\n"
                  "  side: {at: sides, direction: [1, 0], stiffness: '" +
                      stiffness + "'}\n" + other +
                      "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: "
                      "0}}}}\n",
                  "case.yaml"),
        {});
  };
  const auto make = [&](const std::string &stiffness, const std::string &other = "") {
    Problem(PETSC_COMM_WORLD, made(stiffness, other), {});
  };
  EXPECT_NO_THROW(make("k + 1"));
  EXPECT_NO_THROW(make("k", "  foot: {at: contact, direction: [1, 0], stiffness: 1}\n"));
  EXPECT_TRUE(refuses("the spring on 'sides' has no stiffness at k=0, and nothing else holds the "
                      "body: let the stiffness stay above 0",
                      [&] { make("k"); }));
}

TEST(FreeMotions, OfABodyInSpaceAreNamed) {
  Scene scene = make_scene("membrane_obstacle");
  scene.dim = scene.components = 3;
  scene.mesh = {"", {"core"}, {"boundary"}};
  scene.curves = {};
  scene.contacts = {};
  scene.f = {};
  scene.map = [](const FullMu &, const Point &x) { return x; };
  for (const int degree : {1, 2}) {
    scene.degree = degree;
    scene.a = {exact_term(elasticity("", lame(1, 0.3), degree))};
    const TemporaryFile file(cube_mesh(3, 0.1));
    const Mesh mesh = make_mesh(PETSC_COMM_WORLD, scene, {file.name(), 0});
    const auto expect = [&](const std::string &motion, const std::vector<FixedBoundary> &fixed) {
      scene.fixed = fixed;
      EXPECT_EQ(motions(scene, mesh), motion.empty() ? "" : "the body can " + motion);
    };
    expect("move and turn", {});
    expect("move at right angles to (1, 0, 0) and turn about an axis along (1, 0, 0)",
           {{"boundary", {0}}});
    expect("move along (0, 1, 0)", {{"boundary", {0, 2}}});
    expect("", {{"boundary", {}}});
  }
}

} // namespace
} // namespace rbvi::free_motions_test
