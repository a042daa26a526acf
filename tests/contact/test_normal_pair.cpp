// Two bodies at rest by partners along averaged normals: turned, touching, in pieces, closed, with
// friction.
#include "../core/refuses.hpp"
#include "curves.hpp"
#include "rbvi/contact/pair.hpp"
#include "rbvi/core/largest.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace rbvi::normal_pair_test {
namespace {

const MultiplierSpace spaces[] = {MultiplierSpace::macro_edges, MultiplierSpace::nodes};

/// One piece of a boundary: its vertices.
struct Piece {
  Curve vertices;
  bool loop = false;
};

/// A mesh of these pieces, the second boundary after the first: column node * 2 + component.
InterfaceMesh mesh_of(const std::vector<Piece> &slave, const std::vector<Piece> &master,
                      int degree) {
  InterfaceMesh mesh;
  mesh.degree = degree;
  mesh.per_entity = degree + 1;
  mesh.components = 2;
  for (const auto *boundary : {&slave, &master}) {
    const std::size_t first = mesh.points.size();
    std::vector<std::array<int, 2>> edges;
    for (const Piece &piece : *boundary) {
      const auto begin = static_cast<int>(mesh.points.size()),
                 count = static_cast<int>(piece.vertices.size());
      mesh.points.insert(mesh.points.end(), piece.vertices.begin(), piece.vertices.end());
      for (int k = 0; k + (piece.loop ? 0 : 1) < count; ++k)
        edges.push_back({begin + k, begin + (k + 1) % count});
      mesh.closed_ends.insert(mesh.closed_ends.end(), 2, piece.loop ? 1 : 0);
    }
    for (const auto &[a, b] : edges) {
      mesh.entities.insert(mesh.entities.end(), {a, b});
      if (degree == 1) continue;
      mesh.entities.push_back(static_cast<int>(mesh.points.size()));
      mesh.points.push_back((mesh.points[a] + mesh.points[b]) / 2);
    }
    mesh.parts.push_back(static_cast<int>(mesh.points.size() - first));
  }
  mesh.columns = 2 * mesh.nodes();
  for (int dof = 0; dof < mesh.columns; ++dof)
    mesh.dofs.push_back(dof);
  return mesh;
}

Curve straight(Random &random, Index edges, double begin, double end, double height) {
  Curve curve = random_curve(random, edges, begin, end, height);
  for (Point &x : curve)
    x[1] = height;
  return curve;
}

Curve circle(Index edges, double radius, double from) {
  Curve curve;
  for (Index k = 0; k < edges; ++k) {
    const double angle =
        from + 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(edges);
    curve.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
  }
  return curve;
}

/// Turned by mu[0]; the first boundary moves by mu[1] along x before that.
Scene scene_of(int degree) {
  Scene scene;
  scene.components = 2;
  scene.degree = degree;
  scene.parameters.all = {{"angle", "", -4, 4, 0}};
  scene.map = [](const FullMu &mu, const Point &x) {
    const double c = std::cos(mu[0]), s = std::sin(mu[0]);
    return Point{c * x[0] - s * x[1], s * x[0] + c * x[1], 0};
  };
  return scene;
}

ContactRecipe pair_of(MultiplierSpace space, bool friction) {
  Pair pair{"slave", "master", {space}};
  if (friction) pair.friction = {FrictionLaw::coulomb, [](const FullMu &) { return 0.3; }};
  return two_bodies(pair);
}

ContactOperators at(const Scene &scene, const ContactRecipe &recipe, const InterfaceMesh &mesh,
                    const FullMu &mu = {0}) {
  ContactOperators op;
  recipe.make(scene, mesh)->assemble_all(mu, {}, op);
  return op;
}

/// Of nodes: the field where the scene puts them.
template <class Field>
Vector nodal(const Scene &scene, const FullMu &mu, const InterfaceMesh &mesh, const Field &field) {
  Vector v(2 * mesh.nodes());
  for (Index i = 0; i < mesh.nodes(); ++i) {
    const Point value = field(scene.map(mu, mesh.points[i]), i < mesh.parts[0]);
    v.segment<2>(2 * i) << value[0], value[1];
  }
  return v;
}

TEST(NormalPair, TurnsWithTheBodies) {
  for (const int degree : {1, 2})
    for (const MultiplierSpace space : spaces) {
      Random random(degree);
      const Scene scene = scene_of(degree);
      const InterfaceMesh mesh = mesh_of({{random_curve(random, 7, 0, 1.9, 0.3)}},
                                         {{random_curve(random, 5, -0.1, 2, 0)}}, degree);
      const ContactRecipe recipe = pair_of(space, true);
      const ContactOperators op = at(scene, recipe, mesh);
      for (const double degrees : {37.0, 90.0, 180.0}) {
        const double angle = degrees * std::numbers::pi / 180;
        const double c = std::cos(angle), s = std::sin(angle);
        const ContactOperators turned = at(scene, recipe, mesh, {angle});
        EXPECT_LT((op.g - turned.g).norm(), 1e-13);
        EXPECT_LT((op.weights - turned.weights).norm(), 1e-13);
        EXPECT_EQ(op.uncovered, turned.uncovered);
        Matrix expected = Matrix::Zero(op.b.rows(), op.b.cols());
        for (Index i = 0; i < mesh.nodes(); ++i) {
          const Vector x = Matrix(op.b).col(2 * i), y = Matrix(op.b).col(2 * i + 1);
          expected.col(2 * i) = c * x - s * y;
          expected.col(2 * i + 1) = s * x + c * y;
        }
        EXPECT_LT((Matrix(turned.b) - expected).norm(), 1e-12);
      }
    }
}

/// On flat curves vertical pairing is the same, with friction too.
TEST(NormalPair, IsVerticalPairingOnFlatCurves) {
  for (const int degree : {1, 2})
    for (const MultiplierSpace space : spaces) {
      Random random(degree + 3);
      const InterfaceMesh mesh =
          mesh_of({{straight(random, 7, 0, 2, 0.3)}}, {{straight(random, 5, 0.1, 2, 0)}}, degree);
      Pair vertical{"slave", "master", {.multiplier = space}};
      vertical.discretisation.projection = PairProjection::vertical;
      vertical.friction = {FrictionLaw::coulomb, [](const FullMu &) { return 0.3; }};
      Scene scene = scene_of(degree);
      scene.motion = [](const FullMu &, const Point &x) { return Point{x[1], 0.1 * x[1], 0}; };
      const ContactOperators op = at(scene, two_bodies(vertical), mesh),
                             other = at(scene, pair_of(space, true), mesh);
      EXPECT_LT((op.g - other.g).norm(), 1e-14);
      EXPECT_LT((Matrix(op.b) - Matrix(other.b)).norm(), 1e-13);
      EXPECT_EQ(op.uncovered, other.uncovered);
    }
}

/// Flat boundaries at the same place, upright too, with other vertices or the same ones: no gap,
/// everything faces a partner, and a jump along the interface is the slip.
TEST(NormalPair, WhereTheBodiesTouchTheJumpIsNormalAndSlip) {
  for (const int degree : {1, 2})
    for (const MultiplierSpace space : spaces)
      for (const bool matching : {true, false})
        for (const double angle : {0.0, std::numbers::pi / 2, 2.5}) {
          Random random(degree + 5);
          const Scene scene = scene_of(degree);
          const Curve upper = straight(random, 6, 0, 2, 0);
          const InterfaceMesh mesh =
              mesh_of({{upper}}, {{matching ? upper : straight(random, 9, 0, 2, 0)}}, degree);
          const FullMu mu{angle};
          const ContactOperators op = at(scene, pair_of(space, true), mesh, mu);
          EXPECT_LT(op.g.norm(), 1e-14);
          EXPECT_LT(op.nodal_gap.norm(), 1e-14);
          EXPECT_TRUE(op.uncovered.empty());
          EXPECT_NEAR(op.weights.sum(), 2, 1e-13);
          const Point n{std::sin(angle), -std::cos(angle), 0}, tau{-n[1], n[0], 0};
          const Vector jump = nodal(scene, mu, mesh, [&](const Point &x, bool slave) {
            const Point common{1 + 2 * x[0], x[1] - 3, 0};
            return slave ? common + 0.5 * n + 0.25 * tau : common;
          });
          const Vector excess = op.b * jump;
          const Index count = op.weights.size();
          EXPECT_LT((excess.head(count) - 0.5 * op.weights).norm(), 1e-13);
          EXPECT_LT((excess.tail(count) - 0.25 * op.weights).norm(), 1e-13);
        }
}

/// What the scene moves is a slip and a smaller gap before anything is deformed.
TEST(NormalPair, TheMotionOfTheSceneIsInGapAndSlip) {
  for (const MultiplierSpace space : spaces) {
    Random random(4);
    Scene scene = scene_of(1);
    const InterfaceMesh mesh =
        mesh_of({{straight(random, 6, 0, 2, 0.1)}}, {{straight(random, 4, 0, 2, 0)}}, 1);
    scene.motion = [](const FullMu &, const Point &x) {
      return x[1] > 0.05 ? Point{0.3, -0.02, 0} : Point{0.1, 0.01, 0};
    };
    const ContactOperators op = at(scene, pair_of(space, true), mesh);
    const Index count = op.weights.size();
    EXPECT_LT((op.g.head(count) - 0.07 * op.weights).norm(), 1e-14);
    EXPECT_LT((op.g.tail(count) + 0.2 * op.weights).norm(), 1e-14) << "tau = e_x";
  }
}

/// Two pieces of each boundary are two interfaces of one piece: nothing joins them.
TEST(NormalPair, PiecesAreAsInterfacesOfTheirOwn) {
  for (const int degree : {1, 2})
    for (const MultiplierSpace space : spaces) {
      Random random(degree + 11);
      const Scene scene = scene_of(degree);
      const Piece a{straight(random, 5, 0, 1, 0.2)}, b{straight(random, 4, 1.2, 2, 0.1)},
          below_a{straight(random, 4, 0, 1, 0)}, below_b{straight(random, 6, 1.2, 2, 0)};
      const ContactRecipe recipe = pair_of(space, true);
      // The order of the pieces of the second boundary does not matter.
      const ContactOperators both = at(scene, recipe, mesh_of({a, b}, {below_b, below_a}, degree)),
                             one = at(scene, recipe, mesh_of({a}, {below_a}, degree)),
                             other = at(scene, recipe, mesh_of({b}, {below_b}, degree));
      const Index m = one.weights.size(), n = other.weights.size();
      ASSERT_EQ(both.weights.size(), m + n);
      EXPECT_LT((both.weights.head(m) - one.weights).norm(), 1e-15);
      EXPECT_LT((both.weights.tail(n) - other.weights).norm(), 1e-15);
      EXPECT_LT((both.g.head(m) - one.g.head(m)).norm(), 1e-14);
      EXPECT_LT((both.g.segment(m, n) - other.g.head(n)).norm(), 1e-14);
      EXPECT_NEAR(Matrix(both.b).squaredNorm(),
                  Matrix(one.b).squaredNorm() + Matrix(other.b).squaredNorm(), 1e-13);
      EXPECT_EQ(both.nodal_gap.size(), one.nodal_gap.size() + other.nodal_gap.size());
    }
}

/// A shaft in a hole, and a roller on a plate: closed curves, of a body inside and outside.
TEST(NormalPair, ClosedCurvesHaveNoEnds) {
  const Scene scene = scene_of(1);
  for (const MultiplierSpace space : spaces)
    for (const bool shaft_first : {true, false}) {
      // The first boundary with its body on the left, the second one with it on the right.
      Curve shaft = circle(24, 1, 0.1), hole = circle(36, 1.05, 0.7);
      if (!shaft_first) {
        std::ranges::reverse(shaft);
        std::ranges::reverse(hole);
      }
      const InterfaceMesh mesh = shaft_first ? mesh_of({{shaft, true}}, {{hole, true}}, 1)
                                             : mesh_of({{hole, true}}, {{shaft, true}}, 1);
      const ContactRecipe recipe = pair_of(space, false);
      const ContactOperators op = at(scene, recipe, mesh);
      const Curve &slave = shaft_first ? shaft : hole;
      const double round = length(slave) + norm(slave.front() - slave.back());
      EXPECT_TRUE(op.uncovered.empty());
      EXPECT_NEAR(op.weights.sum(), round, 1e-12);
      EXPECT_NEAR(op.g.sum() / round, 0.05, 0.01);
      EXPECT_EQ(op.nodal_gap.size(), size(slave));
      Outputs out;
      const auto interface = recipe.make(scene, mesh);
      interface->outputs({0}, op, Vector::Ones(op.weights.size()), 0, out);
      EXPECT_EQ(*out.ends_in_contact, 0);
      EXPECT_NEAR(*out.reaction, 0, 1e-12) << "a constant pressure has no resultant";
      EXPECT_NEAR(*out.horizontal_reaction, 0, 1e-12);
    }
}

/// The upper half of the roller has the plate behind the body.
TEST(NormalPair, ARollerFacesAPlateWithItsLowerHalf) {
  const Scene scene = scene_of(1);
  Curve roller = circle(40, 1, 0.3);
  for (Point &x : roller)
    x[1] += 1.01;
  for (const Index edges : {1, 2, 50}) {
    const InterfaceMesh mesh = mesh_of({{roller, true}}, {{line(edges, -3, 3, 0)}}, 1);
    const ContactOperators op = at(scene, pair_of(MultiplierSpace::nodes, false), mesh);
    EXPECT_NEAR(op.weights.sum(), std::numbers::pi, 0.2) << edges;
    const InterfaceMesh plate =
        mesh_of({{line(edges, 3, -3, 0)}}, {{Curve(roller.rbegin(), roller.rend()), true}}, 1);
    EXPECT_NEAR(at(scene, pair_of(MultiplierSpace::nodes, false), plate).weights.sum(), 6, 1e-12)
        << edges;
  }
}

/// A block on a larger one, of which all of the outline is given: its corners do not bend normals.
TEST(NormalPair, CornersDoNotBendTheNormals) {
  const Scene scene = scene_of(1);
  Curve outline; // against the clock, so that the body is on the right of the other way
  for (const Point &x : {Point{0, -1, 0}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, -1, 0}, {1, -1, 0}})
    outline.push_back(x);
  for (const MultiplierSpace space : spaces) {
    const InterfaceMesh mesh = mesh_of({{line(6, 0, 2, 0)}}, {{outline, true}}, 1);
    const ContactOperators op = at(scene, pair_of(space, false), mesh);
    EXPECT_TRUE(op.uncovered.empty());
    EXPECT_LT(op.g.norm(), 1e-15);
    for (Index i = 0; i < mesh.nodes(); ++i)
      EXPECT_EQ(Matrix(op.b).col(2 * i).norm(), 0) << "all normals are e_y";
  }
}

TEST(NormalPair, WhatCannotBeIsRefused) {
  Pair pair{"slave", "master", {}, true, {FrictionLaw::tresca, [](const FullMu &) { return 1.0; }}};
  EXPECT_TRUE(refuses("friction with kinematics: small alone", [&] { (void)two_bodies(pair); }));
  pair.friction = {};
  pair.discretisation.projection = PairProjection::vertical;
  EXPECT_TRUE(refuses("projection: vertical is for small", [&] { (void)two_bodies(pair); }));
  pair.large = false;
  const InterfaceMesh mesh =
      mesh_of({{line(4, 0, 1, 0)}}, {{Curve{{0, -1, 0}, {0, 0, 0}}}}, 1); // upright
  EXPECT_TRUE(
      refuses("use 'projection: normal'", [&] { (void)two_bodies(pair).make(scene_of(1), mesh); }));
}

/// Plates behind a shorter one, which hides the middle of them.
TEST(NormalPair, WhatLiesBehindIsNotSeen) {
  const Piece near{line(3, 0.3, 0.6, -0.1)}, far{line(3, -1, 2, -0.5)};
  for (const auto &plates : {std::vector{near, far}, {far, near}}) {
    const InterfaceMesh mesh = mesh_of({{line(5, 0, 1, 0)}}, plates, 1);
    const ContactOperators op = at(scene_of(1), pair_of(spaces[1], false), mesh);
    EXPECT_TRUE(op.uncovered.empty());
    EXPECT_NEAR(op.weights.sum(), 1, 1e-14) << "each place has one partner";
    EXPECT_NEAR(op.g.sum(), 0.3 * 0.1 + 0.7 * 0.5, 1e-14);
  }
}

} // namespace
} // namespace rbvi::normal_pair_test
