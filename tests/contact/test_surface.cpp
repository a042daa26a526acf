// Contact with a rigid surface at the current position: B and the curvature are derivatives, a
// plane has no curvature, and the slip is that of the angles.
#include "rbvi/contact/contact.hpp"
#include "rbvi/contact/support.hpp"
#include "rbvi/contact/surfaces.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/formula.hpp"
#include "rbvi/core/warnings.hpp"
#include "support_scenes.hpp"

#include <gtest/gtest.h>

namespace rbvi::surface_test {
namespace {

constexpr double step = 1e-6; ///< of central differences: round-off 1e-10, error 1e-12

/// The disk of radius 1 about (mu[1], -2 - 0.01), below the half disk of radius 1; the boundary
/// moves by (0, -mu[0]).
SurfacePoint disk_below(const FullMu &mu, const Point &y) {
  const Point p{y[0] - mu[1], y[1] + 2.01, 0};
  const double r = std::hypot(p[0], p[1]);
  return {r - 1, {p[0] / r, p[1] / r, 0}, 1 / r};
}

/// The line through (0, -0.9) of this normal.
SurfacePoint plane_below(const FullMu &, const Point &y) {
  const Point n{0.28, 0.96, 0};
  return {n[0] * y[0] + n[1] * (y[1] + 0.9), n, 0};
}

struct Surfaces {
  Scene scene;
  RigidSurface surface{.boundary = "support", .surface = disk_below, .large = true};
  InterfaceMesh curve;
  std::unique_ptr<ContactInterface> interface;

  explicit Surfaces(int degree, bool friction = true) : curve(support_curve(arc(6, 0.7), degree)) {
    scene.components = 2;
    scene.degree = degree;
    scene.parameters.all = {{"depth", "", 0, 2, 0.1}, {"offset", "", -1, 1, 0}};
    scene.map = identity();
    scene.motion = [](const FullMu &mu, const Point &) { return Point{0, -mu[0], 0}; };
    if (friction) surface.friction = {FrictionLaw::coulomb, [](const FullMu &) { return 0.3; }};
  }
  void make() { interface = rigid_surface(surface).make(scene, curve); }
  ContactOperators at(const FullMu &mu, const Vector &state) const {
    ContactOperators op;
    interface->assemble_all(mu, {state}, op);
    return op;
  }
};

/// int eta distance(y) of every vertex: g - B s, as the linearisation is exact where it is made.
Vector weighted_distance(const Surfaces &of, const FullMu &mu, const Vector &state) {
  const ContactOperators op = of.at(mu, state);
  const Index count = op.weights.size();
  return (op.g - op.b * state).head(count);
}

const FullMu skew{0.1, 0.07};

TEST(RigidSurface, ItsConditionIsTheLinearisedDistance) {
  for (const int degree : {1, 2}) {
    Random random(degree);
    Surfaces of(degree);
    of.make();
    const Vector state = 0.05 * random.vector(of.curve.columns);
    const ContactOperators op = of.at(skew, state);
    const Index count = op.weights.size();
    for (int k = 0; k < 3; ++k) {
      const Vector v = random.vector(of.curve.columns);
      const Vector difference = (weighted_distance(of, skew, state + step * v) -
                                 weighted_distance(of, skew, state - step * v)) /
                                (2 * step);
      EXPECT_LT((difference + (op.b * v).head(count)).norm(), 1e-9);
    }
    EXPECT_EQ(op.state.displacement, state);
    // At a vertex the distance itself.
    const Vector gap = op.nodal_gap - op.nodal_b * state;
    for (Index i = 0; i < count; ++i) {
      const Point &x = of.curve.points[i];
      const Point y{x[0] + state[2 * i], x[1] - skew[0] + state[2 * i + 1], 0};
      EXPECT_NEAR(gap[i], disk_below(skew, y).distance, 1e-15);
    }
  }
}

TEST(RigidSurface, ItsCurvatureIsTheDerivativeOfTheReaction) {
  for (const int degree : {1, 2}) {
    Random random(degree);
    Surfaces of(degree, false);
    of.make();
    const Vector state = 0.05 * random.vector(of.curve.columns);
    Vector lambda = random.vector(of.interface->dual().size()).cwiseAbs();
    lambda.head(2).setZero();
    const Curvature curvature = of.interface->curvature(skew, {state}, lambda);
    for (int k = 0; k < 3; ++k) {
      const Vector v = random.vector(of.curve.columns);
      const Vector difference = (of.at(skew, state + step * v).b.transpose() * lambda -
                                 of.at(skew, state - step * v).b.transpose() * lambda) /
                                (2 * step);
      const Vector product = -(curvature.s.transpose() * (curvature.e * v) +
                               curvature.e.transpose() * (curvature.s * v));
      EXPECT_LT((difference - product).norm(), 1e-9);
      EXPECT_GT(difference.norm(), 1e-2);
      EXPECT_LE(v.dot(product), 0) << "a convex surface curves away";
    }
  }
}

// Without B: w = g - B s and B^T lambda, all of them or those of some nodes; A times an alike
// displacement is that displacement.
TEST(RigidSurface, ItsNodalFormIsThatOfTheOperators) {
  for (const int degree : {1, 2})
    for (const bool friction : {false, true}) {
      Random random(degree);
      Surfaces of(degree, friction);
      of.make();
      ASSERT_TRUE(of.interface->is_nodal());
      const Vector state = 0.05 * random.vector(of.curve.columns);
      Vector lambda = random.vector(of.interface->dual().size());
      const Index nodes = of.interface->dual().nodes();
      const NodalEvaluation evaluate = of.interface->nodal_at(skew);
      const ContactOperators op = of.at(skew, state);
      NodalCondition all, some;
      evaluate(state, lambda, {}, all);
      EXPECT_LT((all.w - (op.g - op.b * state)).norm(), 1e-14);
      EXPECT_LT((all.load - op.b.transpose() * lambda).norm(), 1e-14);
      Vector alike = Vector::Zero(of.curve.columns);
      for (Index k = 0; k < alike.size(); ++k)
        alike[k] = k % 2 == 0 ? 0.3 : -0.7;
      const Vector averaged = of.interface->averages() * alike;
      EXPECT_LT((averaged - alike.head(averaged.size())).norm(), 1e-14);
      EXPECT_LT((all.normal.transpose() * Vector{{0.3, -0.7}} - (op.b * alike).head(nodes)).norm(),
                1e-14);

      std::vector<bool> near(nodes);
      near[2] = near[3] = true;
      for (Index row = 0; row < lambda.size(); ++row)
        if (row % nodes != 2) lambda[row] = 0;
      evaluate(state, lambda, near, some);
      EXPECT_LT((some.load - op.b.transpose() * lambda).norm(), 1e-14);
      for (const Index node : {2, 3}) {
        EXPECT_NEAR(some.w[node], all.w[node], 1e-15);
        EXPECT_LT((some.normal.col(node) - all.normal.col(node)).norm(), 1e-15);
      }
    }
}

TEST(RigidSurface, APlaneIsASupportWhereverTheBodyIs) {
  Random random(3);
  Surfaces of(2);
  of.surface.surface = plane_below;
  of.make();
  const Point n{-0.28, -0.96, 0};
  Support support{"support", [n](const FullMu &, const Point &) { return n; },
                  [](const FullMu &mu, const Point &x) { return plane_below(mu, x).distance; },
                  of.surface.friction};
  ContactOperators flat;
  rigid_support(support).make(of.scene, of.curve)->assemble_all(skew, {}, flat);
  for (const double size : {0.0, 0.3}) {
    const Vector state = size * random.vector(of.curve.columns);
    const ContactOperators op = of.at(skew, state);
    EXPECT_LT((Matrix(op.b) - Matrix(flat.b)).norm(), 1e-15);
    EXPECT_LT((op.g - flat.g).norm(), 1e-15);
    const Vector lambda = random.vector(op.g.size()).cwiseAbs();
    EXPECT_EQ(of.interface->curvature(skew, {state}, lambda).e.norm(), 0);
  }
}

// u . tau(y) = |x - c| sin(theta(y) - theta(x)), theta and tau clockwise from the top of the disk,
// u the whole displacement; by vertex quadrature the slip of a row is that of its vertex.
TEST(RigidSurface, TheSlipIsThatOfTheAngles) {
  Random random(4);
  Surfaces of(2);
  of.surface.lumped = true;
  of.make();
  const Vector state = 0.1 * random.vector(of.curve.columns);
  const ContactOperators op = of.at(skew, state);
  const Index count = op.weights.size();
  const Vector slip = (op.b * state - op.g).tail(count).cwiseQuotient(op.weights);
  const auto theta = [](const Point &p) { return std::atan2(p[0], p[1]); };
  for (Index i = 0; i < count; ++i) {
    const Point &at = of.curve.points[i];
    const Point x{at[0] - skew[1], at[1] + 2.01, 0};
    const Point y{x[0] + state[2 * i], x[1] + state[2 * i + 1] - skew[0], 0};
    EXPECT_NEAR(slip[i], std::hypot(x[0], x[1]) * std::sin(theta(y) - theta(x)), 1e-14);
  }
}

TEST(RigidSurface, TheNormalOfTheBodyTurnsWithIt) {
  for (const int degree : {1, 2}) {
    Surfaces of(degree);
    of.surface.body_normal = radial;
    of.surface.along_body = true;
    of.surface.lumped = true; // normals of single vertices
    of.make();
    EXPECT_FALSE(of.interface->has_curvature());
    const double angle = 0.2, c = std::cos(angle), s = std::sin(angle);
    const Vector turn = nodal(of.curve, [&](const Point &x) {
      return Point{(c - 1) * x[0] - s * x[1], s * x[0] + (c - 1) * x[1], 0};
    });
    const ContactOperators rest = of.at(skew, 0 * turn), turned = of.at(skew, turn);
    const double tolerance = 5e-3; // the displacement is that of chords of 0.23, the arc is not
    for (Index i = 0; i < rest.weights.size(); ++i) {
      const double x = rest.b.coeff(i, 2 * i), y = rest.b.coeff(i, 2 * i + 1);
      EXPECT_NEAR(std::hypot(x, y), rest.weights[i], 1e-14);
      EXPECT_NEAR(turned.b.coeff(i, 2 * i), c * x - s * y, tolerance * rest.weights[i]);
      EXPECT_NEAR(turned.b.coeff(i, 2 * i + 1), s * x + c * y, tolerance * rest.weights[i]);
    }
  }
}

TEST(RigidSurface, ReactionsAreTheWorkOfItsForces) {
  Random random(5);
  Surfaces of(2);
  of.make();
  const Vector state = 0.05 * random.vector(of.curve.columns);
  const ContactOperators op = of.at(skew, state);
  const Vector lambda = random.vector(op.g.size()).cwiseAbs();
  Outputs out;
  of.interface->outputs(skew, op, lambda, 0, out);
  const auto along = [&](double x, double y) {
    return -lambda.dot(op.b * nodal(of.curve, [=](const Point &) { return Point{x, y, 0}; }));
  };
  EXPECT_NEAR(*out.reaction, along(0, 1), 1e-14);
  EXPECT_NEAR(*out.horizontal_reaction, along(1, 0), 1e-14);
  EXPECT_EQ(*out.ends_in_contact, 2);
  EXPECT_NE(resolution_warning(out).find("end of its boundary"), std::string::npos);
}

/// Beyond the centre of the disk the next point of it is behind the body.
TEST(RigidSurface, ABodyThatIsPressedFromInsideIsRefused) {
  Surfaces of(2);
  of.make();
  const ContactOperators op = of.at({1.2, 0}, {});
  Vector lambda = Vector::Zero(op.g.size());
  Outputs out;
  EXPECT_NO_THROW(of.interface->outputs({1.2, 0}, op, lambda, 0, out));
  lambda[op.weights.size() + 3] = 1; // friction without pressure, as Tresca's law has it
  EXPECT_NO_THROW(of.interface->outputs({1.2, 0}, op, lambda, 0, out));
  lambda[3] = 1; // the lowest vertex
  EXPECT_THROW(of.interface->outputs({1.2, 0}, op, lambda, 0, out), Error);
  EXPECT_NO_THROW(of.interface->outputs({0.9, 0}, of.at({0.9, 0}, {}), lambda, 0, out));
}

TEST(RigidSurface, FollowsTheStateAndDoesNotSeparate) {
  Surfaces of(2);
  const ContactRecipe recipe = rigid_surface(of.surface);
  EXPECT_TRUE(recipe.follows_state);
  EXPECT_FALSE(recipe.separable);
}

TEST(RigidSurface, UndeformedIsMinusTheMotion) {
  Surfaces of(2);
  of.scene.contacts = {rigid_surface(of.surface)};
  const Contact contact = make_contact(of.scene, {of.curve});
  EXPECT_TRUE(follows_state(contact));
  EXPECT_TRUE(has_curvature(contact));
  const Vector state = undeformed(contact, of.scene, skew);
  EXPECT_EQ(state, nodal(of.curve, [](const Point &) { return Point{0, skew[0], 0}; }));
}

/// phi as an expression in x, y and the parameters a and b.
std::function<Surface> level(const std::string &phi) {
  return level_set(value_and_gradient_of({{parse_expression(phi)}, {}, {"a", "b"}}));
}

TEST(LevelSet, OfADiskIsTheDisk) {
  for (const std::string phi : {"hypot(x - b, y + 2.01) - 1", "(x - b)^2 + (y + 2.01)^2 - 1"}) {
    const std::function<Surface> surface = level(phi);
    for (const Point &y : {Point{0.3, -0.9, 0}, Point{-0.4, -1.2, 0}, Point{0.07, -0.2, 0}}) {
      const SurfacePoint known = disk_below(skew, y), found = surface(skew, y);
      EXPECT_NEAR(found.distance, known.distance, 1e-13) << phi;
      EXPECT_NEAR(found.normal[0], known.normal[0], 1e-13);
      EXPECT_NEAR(found.normal[1], known.normal[1], 1e-13);
      EXPECT_NEAR(found.curvature, known.curvature, 1e-8);
    }
  }
}

/// The way to the next point is along the normal there, from either side.
TEST(LevelSet, NextPointsOfAGraph) {
  const std::function<Surface> surface = level("y - a*cos(3*x + b)");
  const FullMu mu{0.2, 0.4};
  for (double x = -1; x <= 1; x += 0.1)
    for (const double d : {-0.15, -1e-3, 0.0, 1e-6, 0.1, 0.3}) {
      const double slope = -3 * mu[0] * std::sin(3 * x + mu[1]), stretch = std::hypot(1, slope),
                   bend = -(-9 * mu[0] * std::cos(3 * x + mu[1])) / std::pow(stretch, 3);
      if (1 + bend * d < 0.3) continue; // near the centre of curvature
      const Point n{-slope / stretch, 1 / stretch, 0},
          y = Point{x, mu[0] * std::cos(3 * x + mu[1]), 0} + d * n;
      const SurfacePoint found = surface(mu, y);
      EXPECT_NEAR(found.distance, d, 1e-12) << x;
      EXPECT_NEAR(norm(found.normal - n), 0, 1e-11);
      EXPECT_NEAR(found.curvature, bend / (1 + bend * d), 1e-6);
    }
}

TEST(LevelSet, IsRefusedWhereItHasNoSurface) {
  EXPECT_THROW(level("1 + x^2")({0, 0}, {0.3, 0, 0}), Error);
  EXPECT_THROW(level("a")({0, 0}, {0.3, 0, 0}), Error);
  EXPECT_THROW(level("log(y)")({0, 0}, {0.3, -1, 0}), Error);
}

} // namespace
} // namespace rbvi::surface_test
