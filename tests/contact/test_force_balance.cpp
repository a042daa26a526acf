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

/// A state of a layer, and what its terms push with.
struct NitscheRoads {
  NitscheLayer layer;
  Vector u;
  std::vector<NitscheFace> faces = nitsche_faces(layer, mu, layer.cells, u);
  Matrix pressures = nitsche_pressures(faces, u);
  Vector bounds = nitsche_bounds(faces, pressures);
  TwoRoads roads() const { return two_roads(layer, mu, faces, pressures, bounds); }
};

/// The terms of Nitsche's method push with what outputs say, with friction and on an arc, and turn
/// the body with the same moment.
TEST(ForceBalance, NitschesTermsPushWithTheForcesOfOutputs) {
  for (const int degree : {1, 2}) {
    const SupportScene scene = half_disk(degree);
    const Strip s = strip(degree, arc(8, 0.6));
    const NitscheRoads right{layer_of(scene, s), nodal(scene, mu, s, [](const Point &x) {
                               return Point{0.01 * x[0], -0.02 + 0.01 * x[0], 0};
                             })};
    check_forces(right.layer, mu, right.u);
    EXPECT_LT(right.roads().difference(), 1e-13);
    for (const std::size_t motion : {0U, 1U, 5U})
      EXPECT_GT(std::abs(right.roads().by_nodes[motion]), 0.01) << "there is something to compare";
    NitscheRoads weighed = right, turned = right, dropped = right;
    weighed.faces[3].points[1].n *= 1.01;
    EXPECT_GT(weighed.roads().difference(), 1e-5) << "a wrong weight of a force";
    for (NitscheFace &face : turned.faces)
      for (NitschePoint &point : face.points)
        point.tau *= -1;
    EXPECT_GT(turned.roads().difference(), 1e-3) << "a wrong sign of friction";
    dropped.faces[3].points[1].n.head<2>().setZero();
    EXPECT_GT(dropped.roads().difference(), 1e-5) << "a node is left out";
  }
}

/// A force that acts at another point of its edge leaves the sum of forces as it is, but turns the
/// body.
TEST(ForceBalance, MomentsSeeWhereNitschesForcesAct) {
  const SupportScene scene = half_disk(2);
  const Strip s = strip(2, arc(8, 0.6));
  NitscheRoads wrong{layer_of(scene, s), nodal(scene, mu, s, [](const Point &) {
                       return Point{0, -0.02, 0};
                     })};
  std::swap(wrong.faces[4].points[0], wrong.faces[4].points[3]);
  wrong.pressures = nitsche_pressures(wrong.faces, wrong.u);
  wrong.bounds = nitsche_bounds(wrong.faces, wrong.pressures);
  const TwoRoads roads = wrong.roads();
  for (const std::size_t force : {0U, 1U})
    EXPECT_NEAR(roads.by_points[force], roads.by_nodes[force], 1e-13 * roads.sizes[1]);
  EXPECT_GT(std::abs(roads.by_points[5] - roads.by_nodes[5]), 1e-6 * roads.sizes[5]);
  EXPECT_GT(roads.difference(), 1e-6);
}

/// A body that goes down by d as a whole onto the floor below [1, 3]: no stress, P_n = -gamma d on
/// each edge, and gamma as in GammaIsThatOfTheMaterialAndTheReferenceEdge.
TEST(ForceBalance, NitschesMomentOfARigidBodyIsThatOfItsPressures) {
  const double d = 0.02;
  for (const int degree : {1, 2}) {
    SupportScene scene = support_scene(degree);
    scene.support.friction = {};
    scene.materials = {{{}, [](const FullMu &, const Point &) { return Lame{9, 4}; }}};
    const Strip s = strip(degree, {{1, 0, 0}, {1.5, 0, 0}, {3, 0, 0}});
    const NitscheRoads rigid{layer_of(scene, s), nodal(scene, mu, s, [d](const Point &) {
                               return Point{0, -d, 0};
                             })};
    double force = 0, moment = 0;
    for (const auto &[begin, end] : {std::pair{1.0, 1.5}, {1.5, 3.0}}) {
      const double pressure = 0.3 * (9 + 2 * 4) / (end - begin) * d;
      force += pressure * (end - begin);
      moment += pressure * (end * end - begin * begin) / 2;
    }
    const TwoRoads roads = rigid.roads();
    for (const Resultant &sum : {roads.by_points, roads.by_nodes}) {
      EXPECT_NEAR(sum[0], 0, 1e-14);
      EXPECT_NEAR(sum[1], force, 1e-13 * force);
      EXPECT_NEAR(sum[5], moment, 1e-13 * moment);
    }
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
