// Two bodies as an interface: the operators of couple() on mapped curves, with the motion, at the
// columns of the problem.
#include "../core/refuses.hpp"
#include "../couple.hpp"
#include "curves.hpp"
#include "rbvi/contact/pair.hpp"
#include "rbvi/contact/support_outputs.hpp"

#include <gtest/gtest.h>

namespace rbvi::pair_test {
namespace {

constexpr PairDiscretisation constant{MultiplierSpace::macro_edges, PairQuadrature::intersection,
                                      PairProjection::vertical},
    linear{MultiplierSpace::nodes, PairQuadrature::intersection, PairProjection::vertical};

/// The slave is longer than the master by mu[0]; both move.
Scene scene_of(const PairDiscretisation &discretisation, int degree) {
  Scene scene;
  scene.components = 2;
  scene.degree = degree;
  scene.parameters.all = {{"shift", "", -1, 1, 0}};
  scene.map = [](const FullMu &mu, const Point &x) {
    return Point{x[1] > 0 ? x[0] : x[0] - mu[0], x[1] + 0.1 * x[0], 0};
  };
  scene.motion = [](const FullMu &mu, const Point &x) { return Point{5, x[0] * mu[0] - x[1], 0}; };
  scene.contacts = {two_bodies({"slave", "master", discretisation})};
  return scene;
}

/// 8 and 6 edges; the vertical displacement of node i is column i.
InterfaceMesh two_curves(int degree) {
  Random random(5);
  InterfaceMesh mesh = curve_mesh(random_curve(random, 8, 0, 2, 1), degree);
  const InterfaceMesh lower = curve_mesh(random_curve(random, 6, 0, 2, -0.5), degree);
  mesh.components = 2;
  mesh.parts = {static_cast<int>(mesh.nodes()), static_cast<int>(lower.nodes())};
  for (const int node : lower.entities)
    mesh.entities.push_back(mesh.parts[0] + node);
  mesh.points.insert(mesh.points.end(), lower.points.begin(), lower.points.end());
  mesh.columns = mesh.nodes();
  for (int i = 0; i < mesh.columns; ++i)
    mesh.dofs.insert(mesh.dofs.end(), {-1, i});
  return mesh;
}

/// Columns in another order among more of them, the horizontal displacements too.
InterfaceMesh scattered(InterfaceMesh mesh) {
  mesh.columns = 2 * mesh.nodes() + 3;
  for (int i = 0; i < 2 * static_cast<int>(mesh.nodes()); ++i)
    mesh.dofs[i] = static_cast<int>(mesh.columns) - 2 - i;
  return mesh;
}

PairOperators coupled(const Scene &scene, const InterfaceMesh &mesh,
                      const PairDiscretisation &discretisation, const FullMu &mu) {
  Curve curves[2];
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    curves[static_cast<int>(i) < mesh.parts[0] ? 0 : 1].push_back(scene.map(mu, mesh.points[i]));
  return couple(curves[0], curves[1], discretisation, mesh.degree);
}

ContactOperators at(const Scene &scene, const InterfaceMesh &mesh, const FullMu &mu) {
  ContactOperators operators;
  scene.contacts.front().make(scene, mesh)->assemble_all(mu, {}, operators);
  return operators;
}

TEST(PairInterface, IsThePairOfTheMappedCurvesWithTheMotion) {
  for (const int degree : {1, 2})
    for (const PairDiscretisation &how : {constant, linear})
      for (const FullMu &mu : {FullMu{0}, FullMu{0.3}}) {
        const Scene scene = scene_of(how, degree);
        const InterfaceMesh mesh = two_curves(degree);
        const PairOperators pair = coupled(scene, mesh, how, mu);
        const ContactOperators op = at(scene, mesh, mu);
        Vector motion(mesh.nodes());
        for (Index i = 0; i < motion.size(); ++i)
          motion[i] = scene.motion(mu, mesh.points[i])[1];
        EXPECT_EQ(Matrix(op.b), Matrix(pair.b));
        EXPECT_EQ(op.weights, pair.weights);
        EXPECT_EQ(Matrix(op.nodal_b), Matrix(pair.nodal_b));
        EXPECT_LE((op.g - (pair.g - pair.b * motion)).norm(), 1e-15);
        EXPECT_LE((op.nodal_gap - (pair.nodal_gap - pair.nodal_b * motion)).norm(), 1e-14);
      }
}

TEST(PairInterface, ColumnsAreThoseOfTheProblem) {
  for (const int degree : {1, 2}) {
    const Scene scene = scene_of(linear, degree);
    const InterfaceMesh mesh = two_curves(degree), other = scattered(mesh);
    const FullMu mu{0.3};
    const ContactOperators op = at(scene, mesh, mu), moved = at(scene, other, mu);
    ASSERT_EQ(moved.b.cols(), other.columns);
    // The share of the motion is a sum over columns, whose order is another.
    EXPECT_LE((moved.g - op.g).norm(), 1e-15);
    EXPECT_EQ(moved.weights, op.weights);
    EXPECT_LE((moved.nodal_gap - op.nodal_gap).norm(), 1e-15);
    EXPECT_EQ(moved.b.nonZeros(), op.b.nonZeros()) << "and nothing elsewhere";
    EXPECT_EQ(moved.nodal_b.nonZeros(), op.nodal_b.nonZeros());
    for (Index i = 0; i < mesh.nodes(); ++i) {
      const int column = other.dofs[2 * i + 1];
      EXPECT_EQ(Vector(moved.b.col(column)), Vector(op.b.col(i)));
      EXPECT_EQ(Vector(moved.nodal_b.col(column)), Vector(op.nodal_b.col(i)));
    }
    expect_sorted(moved.b);
  }
}

/// The master ends at 2 - mu[0]: multipliers beyond it, or across its end, face no partner
/// everywhere.
TEST(PairInterface, NamesTheMultipliersThatDoNotFaceAPartnerEverywhere) {
  for (const PairDiscretisation &how : {constant, linear}) {
    const Scene scene = scene_of(how, 1);
    const InterfaceMesh mesh = two_curves(1);
    EXPECT_TRUE(at(scene, mesh, {0}).uncovered.empty());
    const ContactOperators op = at(scene, mesh, {0.6});
    // The first and the last point of the support of each multiplier.
    std::vector<Index> expected;
    const bool macro = how.multiplier == MultiplierSpace::macro_edges;
    const Index count = macro ? 4 : 9;
    for (Index i = 0; i < count; ++i) {
      const Index last = macro ? 2 * i + 2 : std::min<Index>(i + 1, 8);
      if (mesh.points[last][0] > 2 - 0.6) expected.push_back(i);
    }
    EXPECT_GT(expected.size(), 0U);
    EXPECT_LT(expected.size(), static_cast<std::size_t>(count));
    EXPECT_EQ(op.uncovered, expected);
  }
}

TEST(PairInterface, TheDualSpaceIsThatOfTheReferenceSlave) {
  const InterfaceMesh mesh = two_curves(1);
  const Curve slave(mesh.points.begin(), mesh.points.begin() + 9);
  for (const PairDiscretisation &how : {constant, linear}) {
    const Scene scene = scene_of(how, 1);
    const auto interface = scene.contacts.front().make(scene, mesh);
    EXPECT_EQ(interface->dual().points, multiplier_points(slave, how.multiplier));
    EXPECT_EQ(Matrix(interface->dual().gram), Matrix(multiplier_product(slave, how.multiplier)));
    EXPECT_EQ(interface->dual().components, 1);
    EXPECT_EQ(interface->entity_sum(), nullptr);
    EXPECT_EQ(interface->nitsche(), nullptr);
  }
}

TEST(PairInterface, OutputsAreThoseOfTheMirrorImagesTogether) {
  Scene scene = scene_of(constant, 1);
  scene.mirrors = {{0, -9}};
  const InterfaceMesh mesh = two_curves(1);
  const ContactOperators op = at(scene, mesh, {0});
  const Vector lambda{{3, 0, 1, 1e-5}};
  Outputs out;
  scene.contacts.front().make(scene, mesh)->outputs({0}, op, lambda, 1e-3, out);
  make_whole(scene.mirrors, out);
  EXPECT_DOUBLE_EQ(*out.normal_force, 2 * op.weights.dot(lambda));
  EXPECT_DOUBLE_EQ(*out.contact_measure, 2 * (op.weights[0] + op.weights[2]));
  EXPECT_EQ(*out.contact_nodes, 4);
  EXPECT_EQ(*out.peak_pressure, 3);
}

/// The upper curve has no end to speak of where the body ends with it.
TEST(PairInterface, ContactAtAnEndIsCountedUnlessItIsClosed) {
  InterfaceMesh mesh = two_curves(1);
  for (const PairDiscretisation &how : {constant, linear})
    for (const bool closed : {false, true}) {
      const Scene scene = scene_of(how, 1);
      mesh.closed_ends = {closed ? 1 : 0, 0, 0, 0};
      const ContactOperators op = at(scene, mesh, {0});
      const auto interface = scene.contacts.front().make(scene, mesh);
      const auto ends = [&](Index row) {
        Vector lambda = Vector::Zero(interface->dual().nodes());
        lambda[row] = 1;
        Outputs out;
        interface->outputs({0}, op, lambda, 1e-3, out);
        return *out.ends_in_contact;
      };
      const Index last = interface->dual().nodes() - 1;
      EXPECT_EQ(ends(0), closed ? 0 : 1);
      EXPECT_EQ(ends(1), 0);
      EXPECT_EQ(ends(last), 1);
    }
}

/// The lower body moves to the left until the upper one has nothing below it at its right end.
TEST(PairInterface, ContactAtAnEndOfTheLowerCurveIsCountedUnlessItIsClosed) {
  InterfaceMesh mesh = two_curves(1);
  for (const PairDiscretisation &how : {constant, linear})
    for (const bool closed : {false, true}) {
      const Scene scene = scene_of(how, 1);
      mesh.closed_ends = {1, 1, 0, closed ? 1 : 0};
      const auto interface = scene.contacts.front().make(scene, mesh);
      Outputs out;
      interface->outputs({0.6}, at(scene, mesh, {0.6}), Vector::Ones(interface->dual().nodes()),
                         1e-3, out);
      EXPECT_EQ(*out.ends_in_contact, closed ? 0 : 1);
    }
}

/// Where the bodies are beside each other.
TEST(PairInterface, WithoutPartnersThereIsNothingToDraw) {
  const Scene scene = scene_of(constant, 1);
  const InterfaceMesh mesh = two_curves(1);
  const auto interface = scene.contacts.front().make(scene, mesh);
  const Vector u = Vector::Zero(2 * mesh.nodes()), lambda = Vector::Zero(4);
  const Grid grid = interface->fields({0}, u, lambda, false);
  EXPECT_EQ(grid.cells.size(), 16U);
  const auto normal = std::ranges::find(grid.of_nodes, "normal", &Field::name);
  ASSERT_NE(normal, grid.of_nodes.end());
  for (Index i = 0; i < 9; ++i)
    EXPECT_EQ(Vector(normal->values.segment<3>(3 * i)), (Vector{{0, -1, 0}})) << "out of the slave";
  EXPECT_TRUE(interface->fields({3}, u, lambda, false).cells.empty());
}

TEST(PairInterface, HasNoConstraintAtPointsByThemselves) {
  const Scene scene = scene_of(constant, 1);
  const auto interface = scene.contacts.front().make(scene, two_curves(1));
  EXPECT_THROW((void)interface->constraint_at({0}, {0.5, 1, 0}), Error);
}

TEST(PairInterface, AMapThatLeavesNoCurveIsAFailureOfThisMu) {
  Scene scene = scene_of(constant, 1);
  scene.map = [](const FullMu &mu, const Point &x) { return Point{mu[0] * x[0], x[1], 0}; };
  try {
    (void)at(scene, two_curves(1), {0});
    FAIL() << "accepted";
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::failed);
    EXPECT_NE(std::string(error.what()).find("mapped at shift=0"), std::string::npos);
  }
}

TEST(PairInterface, NeedsCurvesThatMoveVertically) {
  const Scene scene = scene_of(constant, 1);
  const auto made_with = [&](auto change) {
    return [&scene, change] {
      InterfaceMesh mesh = two_curves(1);
      change(mesh);
      (void)scene.contacts.front().make(scene, mesh);
    };
  };
  EXPECT_TRUE(refuses("all move vertically", made_with([](InterfaceMesh &m) { m.dofs[7] = -1; })));
  EXPECT_TRUE(refuses("of two components", made_with([](InterfaceMesh &m) { m.components = 1; })));
  EXPECT_TRUE(refuses("master curve", made_with([](InterfaceMesh &m) { m.parts.pop_back(); })));
}

} // namespace
} // namespace rbvi::pair_test
