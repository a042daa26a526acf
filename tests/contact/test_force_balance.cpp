// Forces of contact on two roads: they agree where both have the same normals, and a wrong normal
// on one of them is seen, with the name of the contact.
#include "../core/refuses.hpp"
#include "nitsche_strip.hpp"
#include "rbvi/contact/force_balance.hpp"
#include "rbvi/contact/obstacle.hpp"
#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

namespace rbvi::force_balance_test {
namespace {

const FullMu mu{1};

/// An arc about the origin on something rigid, by the normals of a circle.
SupportScene on_circle(int degree, const Point &centre) {
  SupportScene scene = support_scene(degree);
  scene.support.normal = [centre](const FullMu &, const Point &x) {
    const Point away = x - centre;
    return away / norm(away);
  };
  scene.contacts = {rigid_support(scene.support)};
  return scene;
}

/// Pressures and shear stresses of both signs, so that no component cancels.
Vector tractions(Index nodes) {
  Vector lambda(2 * nodes);
  for (Index i = 0; i < nodes; ++i) {
    lambda[i] = 1 + 0.5 * static_cast<double>(i);
    lambda[nodes + i] = 0.2 - 0.1 * static_cast<double>(i % 3);
  }
  return lambda;
}

/// The contact of a scene on an arc.
Contact contact_on(const SupportScene &scene, int degree) {
  Contact contact;
  contact.interfaces.push_back(
      scene.contacts.front().make(scene, support_curve(arc(8, 0.6), degree)));
  contact.names = {"foot"};
  contact.first_row = {0, contact.interfaces.front()->dual().size()};
  return contact;
}

TEST(ForceBalance, BothRoadsAgree) {
  for (const auto &[degree, turned] : {std::pair{1, false}, {2, false}, {2, true}}) {
    SupportScene scene = on_circle(degree, {});
    scene.axisymmetric = turned;
    if (turned) scene.map = [](const FullMu &, const Point &x) { return Point{x[0] + 1, x[1], 0}; };
    const Contact contact = contact_on(scene, degree);
    ContactInterface &interface = *contact.interfaces.front();
    const Vector lambda = tractions(interface.dual().nodes());
    ContactOperators operators;
    interface.assemble_all(mu, {}, operators);
    const Vector solved = operators.b.transpose() * lambda;
    for (const Vector &by_solver : {Vector(), solved}) {
      const std::vector<TwoRoads> sides = two_roads(scene, interface, mu, {}, lambda, by_solver);
      ASSERT_EQ(sides.size(), 1U);
      EXPECT_LT(sides.front().difference(), 1e-14);
      for (const std::size_t term : {0U, 1U, 5U}) // two forces and a moment
        EXPECT_GT(std::abs(sides.front().by_points[term]), 0.05) << "there is something to compare";
      EXPECT_GT(sides.front().by_points[1], 1) << "upwards, onto the body";
    }
    check_forces(scene, contact, mu, {}, lambda, &operators.b);
  }
}

/// The normals of another circle, whose centre is farther away: those of the nearest of two named
/// circles that is not the boundary's.
TEST(ForceBalance, AWrongNormalIsSeen) {
  for (const int degree : {1, 2}) {
    const SupportScene scene = on_circle(degree, {}), other = on_circle(degree, {0.1, 2, 0});
    const Contact contact = contact_on(scene, degree);
    const Vector lambda = tractions(contact.nodes());
    ContactOperators wrong;
    contact_on(other, degree).interfaces.front()->assemble_all(mu, {}, wrong);
    try {
      check_forces(scene, contact, mu, {}, lambda, &wrong.b);
      ADD_FAILURE() << "a wrong normal passes";
    } catch (const Error &error) {
      EXPECT_EQ(std::string(error.what())
                    .find("the forces of 'foot' on the body of the boundary "
                          "'support' do not balance"),
                0U)
          << error.what();
    }
  }
}

/// Two triangles of a membrane, of which one node is held.
TEST(ForceBalance, AMembraneIsPushedWithItsPressures) {
  Scene scene;
  scene.parameters.all = {{"size", "", 0, 2, 1}};
  scene.map = [](const FullMu &, const Point &x) { return Point{2 * x[0], x[1], 0}; };
  InterfaceMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.entities = {0, 1, 2, 0, 2, 3};
  mesh.per_entity = 3;
  mesh.parts = {4};
  mesh.dofs = {0, -1, 1, 2};
  mesh.columns = 3;
  for (const bool lumped : {false, true}) {
    const ContactRecipe recipe =
        obstacle({"", [](const FullMu &, const Point &x) { return x[0]; }, lumped});
    const auto interface = recipe.make(scene, mesh);
    ContactOperators operators;
    interface->assemble_all(mu, {}, operators);
    const Vector lambda = Vector::LinSpaced(interface->dual().size(), 1, 3);
    const auto difference = [&](const SparseMatrix &b) {
      return two_roads(scene, *interface, mu, {}, lambda, b.transpose() * lambda)
          .at(0)
          .difference();
    };
    EXPECT_LT(difference(operators.b), 1e-14);
    EXPECT_GT(difference(1.001 * operators.b), 1e-4) << "a wrong weight";
  }
}

/// The terms of Nitsche's method push with what outputs say, with friction and on an arc.
TEST(ForceBalance, NitschesTermsPushWithTheForcesOfOutputs) {
  for (const int degree : {1, 2}) {
    SupportScene scene = half_disk(degree);
    const Strip s = strip(degree, arc(8, 0.6));
    const Vector u = nodal(scene, mu, s, [](const Point &x) {
      return Point{0.01 * x[0], -0.02 + 0.01 * x[0], 0};
    });
    const NitscheLayer layer = layer_of(scene, s);
    check_forces(layer, mu, u);
    std::vector<NitscheFace> faces = nitsche_faces(layer, mu, layer.cells);
    const Matrix pressures = nitsche_pressures(faces, u);
    const Vector bounds = nitsche_bounds(faces, pressures);
    const TwoRoads right = two_roads(faces, pressures, bounds);
    EXPECT_GT(right.by_nodes[1], 0.1) << "there is something to compare";
    faces[3].points[1].n *= 1.01;
    TwoRoads wrong = two_roads(faces, pressures, bounds);
    wrong.by_points = right.by_nodes;
    EXPECT_GT(wrong.difference(), 1e-5);
  }
}

/// The circle is that of the boundary, and the body is inside of it.
TEST(ForceBalance, TheNormalOfTheBodyIsThatOfItsEdges) {
  const auto make = [](const Point &centre, double sign) {
    SupportScene scene = on_circle(2, {});
    scene.support.body_normal = [=](const FullMu &, const Point &x) {
      const Point away = x - centre;
      return sign / norm(away) * away;
    };
    scene.contacts = {rigid_support(scene.support)};
    contact_on(scene, 2);
  };
  EXPECT_NO_THROW(make({}, 1));
  EXPECT_TRUE(refuses("and that of its edge", [&] { make({0.1, 0, 0}, 1); }));
  EXPECT_TRUE(refuses("or is it that of a hole?", [&] { make({}, -1); }));
}

TEST(ForceBalance, WhatIsNotFiniteIsNoBalance) {
  TwoRoads roads;
  EXPECT_EQ(roads.difference(), 0) << "nothing touches";
  roads.add_point({1, 0, 0}, {0, std::numeric_limits<double>::quiet_NaN(), 0});
  EXPECT_FALSE(roads.difference() <= 1e-10);
}

} // namespace
} // namespace rbvi::force_balance_test
