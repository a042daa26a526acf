// Two deformed bodies as an interface: on flat curves that of undeformed bodies, wherever they are
// moved and turned together; between circles the distance; its curvature is a derivative.
#include "curves.hpp"
#include "rbvi/contact/pair.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/largest.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace rbvi::large_pair_test {
namespace {

/// An upper curve, then a lower one: column node * 2 + component.
InterfaceMesh two_curves(const Curve &upper, const Curve &lower, int degree) {
  InterfaceMesh mesh = curve_mesh(upper, degree);
  const InterfaceMesh below = curve_mesh(lower, degree);
  mesh.components = 2;
  mesh.parts = {static_cast<int>(mesh.nodes()), static_cast<int>(below.nodes())};
  for (const int node : below.entities)
    mesh.entities.push_back(mesh.parts[0] + node);
  mesh.points.insert(mesh.points.end(), below.points.begin(), below.points.end());
  mesh.columns = 2 * mesh.nodes();
  for (int dof = 0; dof < mesh.columns; ++dof)
    mesh.dofs.push_back(dof);
  return mesh;
}

Curve line(Random &random, Index edges, double begin, double end, double height) {
  Curve curve = random_curve(random, edges, begin, end, height);
  for (Point &x : curve)
    x[1] = height;
  return curve;
}

Scene scene_of(int degree) {
  Scene scene;
  scene.components = 2;
  scene.degree = degree;
  scene.parameters.all = {{"angle", "", -1, 1, 0}};
  scene.map = [](const FullMu &mu, const Point &x) {
    const double c = std::cos(mu[0]), s = std::sin(mu[0]);
    return Point{c * x[0] - s * x[1], s * x[0] + c * x[1], 0};
  };
  return scene;
}

ContactOperators at(ContactInterface &interface, const FullMu &mu, const Vector &state) {
  ContactOperators op;
  interface.assemble_all(mu, {state}, op);
  return op;
}

ContactRecipe large(MultiplierSpace space = MultiplierSpace::macro_edges) {
  return two_bodies({"slave", "master", {space}, true});
}

const MultiplierSpace spaces[] = {MultiplierSpace::macro_edges, MultiplierSpace::nodes};

TEST(LargePair, OnFlatCurvesItIsThePairAtRestAndTurnsWithTheBodies) {
  for (const int degree : {1, 2})
    for (const MultiplierSpace space : spaces) {
      Random random(degree);
      const InterfaceMesh mesh =
          two_curves(line(random, 7, 0, 1.9, 0.2), line(random, 5, 0, 2, 0), degree);
      const Scene scene = scene_of(degree);
      const auto pair = large(space).make(scene, mesh);
      const ContactOperators op = at(*pair, {0}, {});
      for (const auto projection : {PairProjection::vertical, PairProjection::normal}) {
        ContactOperators small;
        two_bodies({"slave", "master", {space, PairQuadrature::intersection, projection}})
            .make(scene, mesh)
            ->assemble_all({0}, {}, small);
        EXPECT_LT((op.g - small.g).norm(), 1e-14);
        EXPECT_LT((op.weights - small.weights).norm(), 1e-14);
        EXPECT_LT((Matrix(op.b) - Matrix(small.b)).norm(), 1e-14);
        EXPECT_LT((op.nodal_gap - small.nodal_gap).norm(), 1e-14);
      }
      EXPECT_TRUE(op.uncovered.empty());
      // All turned by 30 degrees: the forces turn, the gaps stay.
      const double angle = std::numbers::pi / 6, c = std::cos(angle), s = std::sin(angle);
      const ContactOperators turned = at(*pair, {angle}, {});
      EXPECT_LT((op.g - turned.g).norm(), 1e-14);
      Matrix expected = Matrix::Zero(op.b.rows(), op.b.cols());
      for (Index i = 0; i < mesh.nodes(); ++i) {
        const Vector x = Matrix(op.b).col(2 * i), y = Matrix(op.b).col(2 * i + 1);
        expected.col(2 * i) = c * x - s * y;
        expected.col(2 * i + 1) = s * x + c * y;
      }
      EXPECT_LT((Matrix(turned.b) - expected).norm(), 1e-13);
    }
}

// A motion of the upper body along the interface, however far, changes its partners alone.
TEST(LargePair, PartnersFollowTheDisplacement) {
  for (const int degree : {1, 2}) {
    Random random(degree + 7);
    const Curve upper = line(random, 6, -0.7, 0.6, 0.1), lower = line(random, 5, 0, 2, 0);
    Curve moved = upper;
    for (Point &x : moved)
      x[0] += 0.9;
    const Scene scene = scene_of(degree);
    const InterfaceMesh mesh = two_curves(upper, lower, degree);
    Vector state = Vector::Zero(mesh.columns);
    for (Index i = 0; i < mesh.parts[0]; ++i)
      state[2 * i] = 0.9;
    const auto pair = large().make(scene, mesh);
    const ContactOperators op = at(*pair, {0}, state);
    const ContactOperators there =
        at(*large().make(scene, two_curves(moved, lower, degree)), {0}, {});
    EXPECT_LT((Matrix(op.b) - Matrix(there.b)).norm(), 1e-13);
    EXPECT_LT((op.g - there.g).norm(), 1e-14);
    EXPECT_TRUE(op.uncovered.empty());
    EXPECT_FALSE(at(*pair, {0}, {}).uncovered.empty()) << "at rest a part faces nothing";
  }
}

// Forces of a pressure on both bodies are opposite, and act along one line: no work on any rigid
// motion of both together.
TEST(LargePair, RigidMotionsDoNoWorkWhereTheBodiesTouch) {
  for (const int degree : {1, 2}) {
    Random random(degree + 3);
    Curve upper, lower;
    for (Index i = 0; i <= 12; ++i) {
      const double x = static_cast<double>(i) / 12;
      upper.push_back({0.9 * x, 0.02 * x * x, 0});
      lower.push_back({x, 0, 0});
    }
    const InterfaceMesh mesh = two_curves(upper, lower, degree);
    const Scene scene = scene_of(degree);
    const auto pair = large().make(scene, mesh);
    const Vector state = 0.01 * random.vector(mesh.columns);
    const ContactOperators op = at(*pair, {0}, state);
    Vector across = Vector::Zero(mesh.columns), up = across, turn = across;
    for (Index i = 0; i < mesh.nodes(); ++i) {
      const Point &x = mesh.points[i];
      across[2 * i] = up[2 * i + 1] = 1;
      turn[2 * i] = -x[1] - state[2 * i + 1];
      turn[2 * i + 1] = x[0] + state[2 * i];
    }
    EXPECT_LT((op.b * across).norm(), 1e-14);
    EXPECT_LT((op.b * up).norm(), 1e-14);
    EXPECT_LT((op.b * turn).norm(), 1e-13) << "y - y(xi) is along nu";
  }
}

Curve circle(double centre, double radius, double side, Index edges) {
  Curve curve;
  for (Index i = 0; i <= edges; ++i) {
    const double angle = 0.6 * (2.0 * static_cast<double>(i) / static_cast<double>(edges) - 1);
    curve.push_back({radius * std::sin(angle), centre - side * radius * std::cos(angle), 0});
  }
  return curve;
}

/// Middles of degree 2 on their circles, as Scene::curves has them.
InterfaceMesh two_circles(Index edges, double gap, int degree) {
  InterfaceMesh mesh = two_curves(circle(2 + gap, 2, 1, edges), circle(-1, 1, -1, edges), degree);
  for (Index i = 0; i < mesh.nodes(); ++i) {
    Point &x = mesh.points[i];
    const bool upper = i < mesh.parts[0];
    const double y = upper ? 2 + gap : -1, r = upper ? 2 : 1;
    const double scale = r / std::hypot(x[0], x[1] - y);
    x = {scale * x[0], y + scale * (x[1] - y), 0};
  }
  return mesh;
}

TEST(LargePair, BetweenCirclesTheGapIsTheDistanceAtFourthOrder) {
  const Scene scene = scene_of(2);
  double last = 0;
  for (const Index edges : {8, 16, 32}) {
    const InterfaceMesh mesh = two_circles(edges, 0.1, 2);
    const auto pair = large().make(scene, mesh);
    const ContactOperators op = at(*pair, {0}, {});
    double error = 0; // at the vertices that face the lower circle
    for (Index i = 0; i < op.nodal_gap.size(); ++i) {
      double gap = -1;
      for (Index v = 0; v <= edges; ++v) {
        const Point &x = mesh.points[v];
        const double distance = std::hypot(x[0], x[1] + 1) - 1;
        if (gap < 0 || std::abs(distance - op.nodal_gap[i]) < std::abs(gap - op.nodal_gap[i]))
          gap = distance;
      }
      error = larger(error, std::abs(gap - op.nodal_gap[i]));
    }
    EXPECT_GT(op.nodal_gap.size(), edges / 4);
    if (last > 0) {
      EXPECT_LT(error, last / 8);
    }
    last = error;
  }
  EXPECT_LT(last, 1e-6);
}

// Where the bodies touch, and up to the error of a normal field between vertices.
TEST(LargePair, ItsCurvatureIsTheDerivativeOfTheReaction) {
  constexpr double step = 1e-5;
  const Scene scene = scene_of(2);
  const InterfaceMesh mesh = two_circles(40, 0, 2);
  const auto pair = large().make(scene, mesh);
  Vector state = Vector::Zero(mesh.columns), v = state;
  for (Index i = 0; i < mesh.nodes(); ++i) { // the upper body moulded onto the lower one
    const Point &x = mesh.points[i];
    if (i < mesh.parts[0]) state[2 * i + 1] = std::sqrt(std::max(0.0, 1 - x[0] * x[0])) - 1 - x[1];
    v[2 * i] = std::sin(3 * x[0]) + (i < mesh.parts[0] ? 0.5 : 0);
    v[2 * i + 1] = std::cos(2 * x[0] + 1);
  }
  Vector lambda = Vector::Zero(pair->dual().nodes());
  for (Index i = 14; i < 26; ++i) // all faces the lower body
    lambda[i] = 1 + 0.1 * static_cast<double>(i);
  const Curvature curvature = pair->curvature({0}, {state}, lambda);
  const Vector product =
      -(curvature.s.transpose() * (curvature.e * v) + curvature.e.transpose() * (curvature.s * v));
  const Vector difference = (at(*pair, {0}, state + step * v).b.transpose() * lambda -
                             at(*pair, {0}, state - step * v).b.transpose() * lambda) /
                            (2 * step);
  // Tested with smooth fields: single nodes see the kinks of the field of normals.
  for (const double k : {0.0, 1.0, 2.0}) {
    Vector w = Vector::Zero(mesh.columns);
    for (Index i = 0; i < mesh.nodes(); ++i) {
      const Point &x = mesh.points[i];
      w[2 * i] = std::cos(k * x[0]) * (i < mesh.parts[0] ? 1 : 0.3);
      w[2 * i + 1] = std::sin(k * x[0] + 0.3);
    }
    EXPECT_NEAR(w.dot(product), w.dot(difference), 2e-3 * std::abs(w.dot(difference)) + 1e-4);
  }
}

/// A state that moves the upper body sideways.
Vector aside(const InterfaceMesh &mesh, double by) {
  Vector state = Vector::Zero(mesh.columns);
  for (Index i = 0; i < mesh.parts[0]; ++i)
    state[2 * i] = by;
  return state;
}

// As vertices of one curve pass those of the other B and g change by as little as elsewhere: an
// iteration needs no segments that are held.
TEST(LargePair, OperatorsAreContinuousWhereVerticesPassEachOther) {
  constexpr int steps = 400;
  for (const int degree : {1, 2})
    for (const MultiplierSpace space : spaces) {
      const Scene scene = scene_of(degree);
      const InterfaceMesh mesh = two_circles(16, 0.01, degree);
      const auto pair = large(space).make(scene, mesh);
      ContactOperators last = at(*pair, {0}, aside(mesh, -0.3));
      double largest = 0, sum = 0;
      int passed = 0;
      for (int k = 1; k <= steps; ++k) {
        const ContactOperators op = at(*pair, {0}, aside(mesh, 0.6 * k / steps - 0.3));
        const double change =
            (Matrix(op.b) - Matrix(last.b)).norm() + (op.g - last.g).norm() / 0.01;
        largest = larger(largest, change);
        sum += change;
        if (op.segments != last.segments) ++passed;
        last = op;
      }
      EXPECT_GT(passed, 20);
      EXPECT_LT(largest, 3 * sum / steps) << degree;
    }
}

/// Ends with pressure where the multipliers of `rows` carry.
double ends(const ContactInterface &interface, const ContactOperators &op,
            const std::vector<Index> &rows) {
  Vector lambda = Vector::Zero(interface.dual().nodes());
  lambda(rows).setOnes();
  Outputs outputs;
  interface.outputs({0}, op, lambda, 0, outputs);
  return *outputs.ends_in_contact;
}

// The upper curve ends at 0 and 2, the lower one at 1.6: between vertices of the upper one.
TEST(LargePair, ContactAtAnEndOfEitherCurveIsCounted) {
  Curve upper, lower;
  for (Index i = 0; i <= 8; ++i)
    upper.push_back({0.25 * static_cast<double>(i), 0, 0});
  for (Index i = 0; i <= 6; ++i)
    lower.push_back({0.3 * static_cast<double>(i) - 0.2, 0, 0});
  const Scene scene = scene_of(2);
  InterfaceMesh mesh = two_curves(upper, lower, 2);
  const auto edges = large(spaces[0]).make(scene, mesh), nodes = large(spaces[1]).make(scene, mesh);
  const ContactOperators on_edges = at(*edges, {0}, {}), on_nodes = at(*nodes, {0}, {});
  EXPECT_EQ(ends(*edges, on_edges, {1, 2, 3, 4, 5}), 0);
  EXPECT_EQ(ends(*edges, on_edges, {5, 6}), 1) << "the last with a partner";
  EXPECT_EQ(ends(*edges, on_edges, {0, 1}), 1);
  EXPECT_EQ(ends(*edges, on_edges, {0, 6}), 2);
  EXPECT_EQ(ends(*nodes, on_nodes, {1, 2, 3, 4, 5}), 0);
  EXPECT_EQ(ends(*nodes, on_nodes, {6}), 1) << "the last vertex with a partner";
  EXPECT_EQ(ends(*nodes, on_nodes, {7}), 1) << "its function has a partner in part";
  EXPECT_EQ(ends(*nodes, on_nodes, {0, 6}), 2);
  mesh.closed_ends = {1, 0, 0, 0}; // the upper body ends there
  const auto half = large(spaces[0]).make(scene, mesh);
  EXPECT_EQ(ends(*half, at(*half, {0}, {}), {0, 1}), 0);
  EXPECT_EQ(ends(*half, at(*half, {0}, {}), {0, 6}), 1);
  mesh.closed_ends = {0, 1, 0, 1}; // the lower body ends at 1.6
  const auto rim = large(spaces[0]).make(scene, mesh);
  EXPECT_EQ(ends(*rim, at(*rim, {0}, {}), {5, 6}), 0);
  EXPECT_EQ(ends(*rim, at(*rim, {0}, {}), {0, 6}), 1);
}

TEST(LargePair, ACurveThatFoldsIsAFailureOfThisState) {
  Random random(2);
  const InterfaceMesh mesh = two_curves(line(random, 4, 0, 1, 0.1), line(random, 4, 0, 1, 0), 1);
  const Scene scene = scene_of(1);
  const auto pair = large().make(scene, mesh);
  Vector state = Vector::Zero(mesh.columns);
  const Index node = mesh.parts[0] + 2;
  state[2 * node] = mesh.points[static_cast<std::size_t>(node) - 1][0] -
                    mesh.points[node][0]; // two vertices at one place
  EXPECT_THROW((void)at(*pair, {0}, state), Error);
}

} // namespace
} // namespace rbvi::large_pair_test
