// Several interfaces of one problem: blocks of B, g, weights and the Gram matrix, outputs as sums
// and maxima, and what only a single interface may have.
#include "../core/refuses.hpp"
#include "rbvi/contact/contact.hpp"
#include "rbvi/contact/nitsche_support.hpp"
#include "rbvi/contact/pair.hpp"
#include "support_scenes.hpp"

#include <gtest/gtest.h>

namespace rbvi::contact_test {
namespace {

constexpr double push = 0.2;

/// On top of each other: a support above, and a pair of curves below it, which are in contact
/// between x = 0 and 1.5 (the master is shorter).
struct Stack {
  Scene scene = crooked(1);
  InterfaceMesh above, pair;
  std::vector<InterfaceMesh> meshes;

  explicit Stack(bool friction = false) {
    SupportScene flat = support_scene(1, {0, 1, 0});
    if (!friction) flat.support.friction = {};
    scene = flat;
    scene.motion = [](const FullMu &mu, const Point &x) {
      return Point{0, x[1] > 0.5 ? -push * mu[0] : push, 0};
    };
    scene.contacts = {rigid_support(flat.support),
                      two_bodies({"slave", "master", {.projection = PairProjection::vertical}})};
    above = support_curve(line(5, 0, 2, 2), 1);
    for (std::size_t e = 0; e < 5; ++e) // the body is below
      std::swap(above.entities[2 * e], above.entities[2 * e + 1]);
    pair = support_curve(line(4, 0, 2, 1), 1);
    const InterfaceMesh lower = support_curve(line(3, 0, 1.5, 0), 1);
    for (const int node : lower.entities)
      pair.entities.push_back(5 + node);
    pair.points.insert(pair.points.end(), lower.points.begin(), lower.points.end());
    pair.parts = {5, 4};
    pair.dofs.clear();
    for (int node = 0; node < 9; ++node)
      pair.dofs.insert(pair.dofs.end(), {-1, 12 + node});
    above.columns = pair.columns = 12 + 9;
    meshes = {above, pair};
  }
  /// One interface by itself.
  ContactOperators alone(std::size_t i, const FullMu &mu) const {
    ContactOperators operators;
    scene.contacts[i].make(scene, meshes[i])->assemble_all(mu, {}, operators);
    return operators;
  }
};

TEST(Contact, RowsOfAnInterfaceFollowThoseOfTheOther) {
  const Stack stack;
  const Contact contact = make_contact(stack.scene, stack.meshes);
  ASSERT_EQ(contact.interfaces.size(), 2U);
  EXPECT_EQ(contact.first_row, (std::vector<Index>{0, 6, 8}));
  EXPECT_EQ(contact.dual_size(), 8);
  EXPECT_EQ(contact.nodes(), 8);
  const Matrix gram = contact.w_product();
  ASSERT_EQ(gram.rows(), 8);
  EXPECT_EQ(gram.topLeftCorner(6, 6), Matrix(contact.interfaces[0]->dual().gram));
  EXPECT_EQ(gram.bottomRightCorner(2, 2), Matrix(contact.interfaces[1]->dual().gram));
  EXPECT_EQ(gram.topRightCorner(6, 2).norm() + gram.bottomLeftCorner(2, 6).norm(), 0);
  const std::vector<Point> points = dual_points(contact);
  ASSERT_EQ(points.size(), 8U);
  EXPECT_EQ(points[5], stack.above.points[5]);
  EXPECT_EQ(points[6], (Point{0.5, 1, 0})) << "the middle of the first macro-edge";
}

TEST(Contact, OperatorsAreStacked) {
  const Stack stack;
  const Contact contact = make_contact(stack.scene, stack.meshes);
  for (const FullMu &mu : {FullMu{1}, FullMu{1.7}}) {
    const ContactOperators first = stack.alone(0, mu), second = stack.alone(1, mu);
    ContactOperators all, nodal;
    assemble(contact, mu, {}, all);
    ASSERT_EQ(all.b.rows(), 8);
    ASSERT_EQ(all.b.cols(), 21);
    EXPECT_EQ(Matrix(all.b.topRows(6)), Matrix(first.b));
    EXPECT_EQ(Matrix(all.b.bottomRows(2)), Matrix(second.b));
    EXPECT_EQ(all.b.topRows(6).rightCols(9).norm() + all.b.bottomRows(2).leftCols(12).norm(), 0);
    EXPECT_EQ(all.g, (Vector(8) << first.g, second.g).finished());
    EXPECT_EQ(all.weights, (Vector(8) << first.weights, second.weights).finished());
    ASSERT_EQ(all.nodal_b.rows(), first.nodal_b.rows() + second.nodal_b.rows());
    EXPECT_EQ(Matrix(all.nodal_b.topRows(6)), Matrix(first.nodal_b));
    EXPECT_EQ(Matrix(all.nodal_b.bottomRows(second.nodal_b.rows())), Matrix(second.nodal_b));
    EXPECT_EQ(all.nodal_gap.head(6), first.nodal_gap);
    EXPECT_EQ(all.nodal_gap.tail(second.nodal_gap.size()), second.nodal_gap);
    EXPECT_EQ(second.uncovered, std::vector<Index>{1}) << "the slave is longer";
    EXPECT_EQ(all.uncovered, std::vector<Index>{7});
    expect_sorted(all.b);
    assemble_nodal(contact, mu, {}, {}, nodal);
    EXPECT_EQ(nodal.weights, all.weights);
    EXPECT_EQ(Matrix(nodal.nodal_b), Matrix(all.nodal_b));
    EXPECT_EQ(nodal.nodal_gap, all.nodal_gap);
  }
}

/// Assembled again at another mu nothing of the first is left.
TEST(Contact, OperatorsMayBeUsedAgain) {
  const Stack stack;
  const Contact contact = make_contact(stack.scene, stack.meshes);
  ContactOperators again, once;
  assemble(contact, {0.4}, {}, again);
  assemble(contact, {1.7}, {}, again);
  assemble(contact, {1.7}, {}, once);
  EXPECT_EQ(Matrix(again.b), Matrix(once.b));
  EXPECT_EQ(again.g, once.g);
  EXPECT_EQ(again.weights, once.weights);
  EXPECT_EQ(again.nodal_gap, once.nodal_gap);
  EXPECT_EQ(again.uncovered, once.uncovered);
}

TEST(Contact, OutputsAreSumsAndMaxima) {
  const Stack stack;
  const Contact contact = make_contact(stack.scene, stack.meshes);
  EXPECT_EQ(contact.names, (std::vector<std::string>{"contact 1", "contact 2"}));
  const FullMu mu{1};
  ContactOperators all;
  assemble(contact, mu, {}, all);
  const Vector lambda{{0, 1, 4, 0, 0, 0.5, 3, 0}};
  Outputs out, first, second;
  contact_outputs(contact, mu, all, lambda, 0, out);
  contact.interfaces[0]->outputs(mu, stack.alone(0, mu), lambda.head(6), 0, first);
  contact.interfaces[1]->outputs(mu, stack.alone(1, mu), lambda.tail(2), 0, second);
  EXPECT_NEAR(*out.normal_force, all.weights.dot(lambda), 1e-14);
  EXPECT_EQ(*out.normal_force, *first.normal_force + *second.normal_force);
  EXPECT_EQ(*out.contact_measure, *first.contact_measure + *second.contact_measure);
  EXPECT_EQ(*out.contact_nodes, 4);
  EXPECT_EQ(*out.peak_pressure, 4);
  EXPECT_EQ(*out.reaction, *first.reaction) << "the pair has none";
  EXPECT_FALSE(out.contact_half_width) << "neither a sum nor a maximum";
  EXPECT_FALSE(out.centre_pressure);
  EXPECT_FALSE(out.friction_violation);
  ASSERT_EQ(out.interfaces.size(), 2U);
  EXPECT_EQ(out.interfaces[1].name, "contact 2");
}

/// Of one interface all is as the interface says it, friction and half-widths too.
TEST(Contact, OfOneInterfaceIsThatInterface) {
  Stack stack(true);
  stack.scene.contacts.pop_back();
  const Contact contact = make_contact(stack.scene, {stack.above});
  const FullMu mu{1};
  const ContactOperators alone = stack.alone(0, mu);
  ContactOperators op;
  assemble(contact, mu, {}, op);
  EXPECT_EQ(contact.dual_size(), 12);
  EXPECT_EQ(contact.nodes(), 6);
  EXPECT_EQ(Matrix(op.b), Matrix(alone.b));
  EXPECT_EQ(op.g, alone.g);
  const Vector lambda = Vector::LinSpaced(12, 0, 1);
  Outputs out, expected;
  contact_outputs(contact, mu, op, lambda, 0, out);
  contact.interfaces[0]->outputs(mu, alone, lambda, 0, expected);
  EXPECT_EQ(*out.contact_half_width, *expected.contact_half_width);
  EXPECT_EQ(*out.tangential_force, *expected.tangential_force);
  EXPECT_EQ(*out.friction_violation, *expected.friction_violation);
}

TEST(Contact, LawsAreThoseOfEachInterface) {
  const Stack sticky(true);
  const Contact contact = make_contact(sticky.scene, sticky.meshes);
  const FullMu mu{1};
  const NodeLaws laws = laws_at(contact, mu);
  check(laws);
  ASSERT_EQ(laws.rows, contact.dual_size());
  Index node = 0;
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    const DualSpace &dual = contact.interfaces[i]->dual();
    for (Index k = 0; k < dual.nodes(); ++k, ++node) {
      const auto at = static_cast<std::size_t>(node);
      EXPECT_EQ(laws.normal[at], contact.first_row[i] + k);
      EXPECT_EQ(laws.has_tangent(node), dual.components > 1);
      EXPECT_EQ(laws.bound[at].coefficient, contact.interfaces[i]->bound(mu).coefficient);
      const DualRow row = dual_row(contact, laws.normal[at]);
      EXPECT_TRUE(row.interface == i && row.node == k && row.normal);
      if (!laws.has_tangent(node)) continue;
      const DualRow tangent = dual_row(contact, laws.tangent[at]);
      EXPECT_TRUE(tangent.interface == i && tangent.node == k && !tangent.normal);
    }
  }
  EXPECT_EQ(node, contact.nodes());
}

TEST(Contact, MultipliersByNodeAreThoseOfTheRows) {
  const Stack sticky(true);
  const Contact contact = make_contact(sticky.scene, sticky.meshes);
  const Vector lambda = Vector::LinSpaced(contact.dual_size(), 1, 2);
  const Matrix nodal = by_node(contact, lambda);
  ASSERT_EQ(nodal.rows(), contact.nodes());
  Matrix expected = Matrix::Zero(contact.nodes(), 2);
  for (Index row = 0; row < contact.dual_size(); ++row) {
    const DualRow at = dual_row(contact, row);
    const Index first = at.interface == 0 ? 0 : contact.interfaces[0]->dual().nodes();
    expected(first + at.node, at.normal ? 0 : 1) = lambda[row];
  }
  EXPECT_EQ(nodal, expected);
}

TEST(Contact, NitschesMethodIsNotBesideMultipliers) {
  Stack stack;
  stack.scene.contacts[0] = by_nitsche(rigid_contact(Support{"above", {}, {}}), 10);
  stack.scene.contacts[0].name = "ceiling";
  const auto refused = [&](const std::string &says) {
    return refuses(says, [&] { make_contact(stack.scene, stack.meshes); });
  };
  EXPECT_TRUE(refused(
      "contact 'ceiling' on 'above' by Nitsche's method and contact on 'slave' by multipliers"));
}

TEST(Contact, NeedsAMeshForEveryRecipe) {
  const Stack stack;
  for (const std::vector<InterfaceMesh> &meshes :
       {std::vector<InterfaceMesh>{}, std::vector{stack.above}})
    EXPECT_TRUE(refuses("has 2 contact interfaces", [&] { make_contact(stack.scene, meshes); }));
  EXPECT_TRUE(refuses("slave curve", [&] {
    make_contact(stack.scene, {stack.above, InterfaceMesh{}});
  }));
}

/// What solvers ask of a scene is so where it is so of all of its interfaces, friction of any.
TEST(ContactRecipes, AreAskedTogether) {
  const Stack stack, sticky(true);
  EXPECT_FALSE(has_friction(stack.scene));
  EXPECT_TRUE(has_friction(sticky.scene));
  EXPECT_FALSE(separable_contact(stack.scene)) << "a pair is not";
  EXPECT_TRUE(keeps_nodes(stack.scene));
  EXPECT_TRUE(has_multipliers(stack.scene));
  EXPECT_FALSE(bounds_nodes(stack.scene));
  Scene one = stack.scene;
  one.contacts.pop_back();
  EXPECT_TRUE(separable_contact(one));
  one.contacts.front().keeps_nodes = false;
  EXPECT_FALSE(keeps_nodes(one));
  one.contacts.front().nodal = true;
  EXPECT_TRUE(bounds_nodes(one));
  one.contacts.front().friction = FrictionLaw::coulomb;
  EXPECT_FALSE(bounds_nodes(one));
  one.contacts = {by_nitsche(rigid_contact(Support{}), 10)};
  EXPECT_FALSE(has_multipliers(one));
}

} // namespace
} // namespace rbvi::contact_test
