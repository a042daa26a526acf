// Contact with a rigid half-plane that moves and tilts: operators in closed form, the condition at
// single nodes, friction, what files store, and planes that cannot be.
#include "../core/refuses.hpp"
#include "rbvi/contact/support.hpp"
#include "rbvi/core/validity.hpp"
#include "support_scenes.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace rbvi::half_plane_test {
namespace {

enum Position { push, tilt, friction };

/// A body mapped to twice its size over a plane that is pushed in, tilts, and may rub.
Scene scene_of(int degree) {
  Scene scene;
  scene.components = 2;
  scene.degree = degree;
  scene.parameters =
      all_free({{"push", "", -1, 1, 0}, {"tilt", "", -1, 1, 0}, {"friction", "", 0, 1, 0.3}});
  scene.map = [](const FullMu &, const Point &x) { return Point{2 * x[0], 2 * x[1], 0}; };
  return scene;
}

const Point untilted{0.6, -0.8, 0}, pivot{0.3, -0.2, 0};
std::function<Coefficient> position() {
  return affine(0.7, -1, push);
}

RigidSurface tilted_plane(FrictionLaw law = FrictionLaw::none) {
  RigidSurface plane{"foot", plane_surface(untilted, pivot, position(), parameter(tilt))};
  if (law != FrictionLaw::none) plane.friction = {law, parameter(friction)};
  return plane;
}

const FullMu mu{0.1, 0.35, 0.25};

/// The normal of the plane, turned counterclockwise, and its distance from a mapped point.
Point normal_at(const FullMu &at) {
  const double c = std::cos(at[tilt]), s = std::sin(at[tilt]);
  return {0.6 * c + 0.8 * s, 0.6 * s - 0.8 * c, 0};
}

double gap_at(const FullMu &at, const Point &x) {
  return 0.7 - at[push] - dot({x[0] - 0.3, x[1] + 0.2, 0}, normal_at(at));
}

Point twice(const Point &x) {
  return {2 * x[0], 2 * x[1], 0};
}

std::unique_ptr<ContactInterface> made_on(const RigidSurface &plane, const Scene &scene,
                                          const InterfaceMesh &curve) {
  return rigid_surface(plane).make(scene, curve);
}

ContactOperators operators_of(const RigidSurface &plane, const Scene &scene,
                              const InterfaceMesh &curve, const FullMu &at = mu) {
  ContactOperators operators;
  made_on(plane, scene, curve)->assemble_all(at, {}, operators);
  return operators;
}

/// Integrals of p times each hat over the mapped edges, by Simpson's rule: exact for p of degree 2.
template <class Function> Vector against_hats(const Curve &vertices, Function p) {
  Vector sum = Vector::Zero(size(vertices));
  for (std::size_t e = 0; e + 1 < vertices.size(); ++e) {
    const Point &a = vertices[e], &b = vertices[e + 1];
    const double h = 2 * length({a, b}), middle = 2 * p(between(a, b, 0.5));
    sum.segment<2>(static_cast<Index>(e)) += h / 6 * Vector{{p(a) + middle, middle + p(b)}};
  }
  return sum;
}

Vector below(const Vector &upper, const Vector &lower) {
  return (Vector(upper.size() + lower.size()) << upper, lower).finished();
}

/// The normal is the same on all edges, whatever their direction; the gap is linear on each.
TEST(RigidPlane, OperatorsAreIntegralsInClosedForm) {
  Random random(4);
  const Curve vertices = random_curve(random, 7, -0.4, 1.1, -0.5);
  const Point n = normal_at(mu), tau = turned(n);
  const Vector none = Vector::Zero(size(vertices));
  for (const int degree : {1, 2})
    for (const FrictionLaw law : {FrictionLaw::none, FrictionLaw::coulomb}) {
      SCOPED_TRACE(degree);
      const bool rubs = law != FrictionLaw::none;
      const InterfaceMesh curve = support_curve(vertices, degree);
      const Scene scene = scene_of(degree);
      const ContactOperators of = operators_of(tilted_plane(law), scene, curve);
      for (int power = 0; power <= degree; ++power) {
        const auto p = [power](const Point &x) { return std::pow(x[0] - 0.3, power); };
        const auto along = [&](const Point &direction) {
          return nodal(curve, [&](const Point &x) {
            return Point{p(x) * direction[0], p(x) * direction[1], 0};
          });
        };
        const Vector exact = against_hats(vertices, p);
        EXPECT_LT((of.b * along(n) - (rubs ? below(exact, none) : exact)).norm(), 1e-14);
        EXPECT_LT((of.b * along(tau) - (rubs ? below(none, exact) : none)).norm(), 1e-14);
      }
      const Vector gap =
          against_hats(vertices, [](const Point &x) { return gap_at(mu, twice(x)); });
      EXPECT_LT((of.g - (rubs ? below(gap, none) : gap)).norm(), 1e-14);
    }
}

TEST(RigidPlane, TheConditionAtNodesIsItsOwn) {
  Random random(5);
  const Curve vertices = random_curve(random, 6, -0.4, 1.1, -0.5);
  for (const int degree : {1, 2}) {
    const InterfaceMesh curve = support_curve(vertices, degree);
    const Scene scene = scene_of(degree);
    RigidSurface plane = tilted_plane();
    for (const bool lumped : {false, true}) {
      plane.lumped = lumped;
      const auto interface = made_on(plane, scene, curve);
      const ContactOperators of = operators_of(plane, scene, curve);
      const Vector v = random.vector(of.b.cols());
      const Vector at_nodes = of.nodal_b * v, rows = of.b * v;
      for (Index k = 0; k < size(vertices); ++k) {
        const Point &x = vertices[k], n = normal_at(mu);
        const PointConstraint here = interface->constraint_at(mu, x, twice(x), {});
        EXPECT_NEAR(here.direction[0], n[0], 1e-15);
        EXPECT_NEAR(here.direction[1], n[1], 1e-15);
        EXPECT_NEAR(here.gap, gap_at(mu, twice(x)), 1e-14);
        EXPECT_NEAR(of.nodal_gap[k], here.gap, 1e-15);
        const double pushed = v[2 * k] * n[0] + v[2 * k + 1] * n[1];
        EXPECT_NEAR(at_nodes[k], pushed, 1e-14);
        if (!lumped) continue;
        EXPECT_NEAR(rows[k], of.weights[k] * pushed, 1e-14) << "a bound at the vertex";
        EXPECT_NEAR(of.g[k], of.weights[k] * here.gap, 1e-14);
      }
    }
  }
}

/// Pushed in along the normal it is nearer everywhere by as much; of no tilt and of the normal
/// turned beforehand it is the same plane.
TEST(RigidPlane, MovesAlongItsNormalAndTurnsAboutThePointBesideItsPivot) {
  Random random(6);
  const InterfaceMesh curve = support_curve(random_curve(random, 5, -0.4, 1.1, -0.5), 2);
  const Scene scene = scene_of(2);
  const ContactOperators of = operators_of(tilted_plane(FrictionLaw::coulomb), scene, curve),
                         pushed = operators_of(tilted_plane(FrictionLaw::coulomb), scene, curve,
                                               {mu[push] + 0.2, mu[tilt], mu[friction]});
  EXPECT_LT((of.g - pushed.g - 0.2 * below(of.weights, Vector::Zero(6))).norm(), 1e-14);
  EXPECT_EQ(Matrix(of.b), Matrix(pushed.b));
  RigidSurface turned_before = tilted_plane(FrictionLaw::coulomb);
  turned_before.surface = plane_surface(normal_at(mu), pivot, position());
  const ContactOperators same = operators_of(turned_before, scene, curve);
  EXPECT_LT((Matrix(same.b) - Matrix(of.b)).norm(), 1e-14);
  EXPECT_LT((same.g - of.g).norm(), 1e-14);
}

/// Where the body's surface is given, its points count instead of those of the edges.
TEST(RigidPlane, MeasuresTheGapFromTheSurfaceOfTheBody) {
  const Curve vertices = arc(6, 0.5);
  const InterfaceMesh curve = support_curve(vertices, 1);
  const Scene scene = scene_of(1);
  RigidSurface plane = tilted_plane();
  plane.at_rest = [](const FullMu &, const Point &x) {
    const double r = std::hypot(x[0], x[1]) / 2;
    return Point{x[0] / r, x[1] / r, 0};
  };
  const auto interface = made_on(plane, scene, curve);
  const Point x = between(vertices[2], vertices[3], 0.5);
  const double r = std::hypot(x[0], x[1]);
  EXPECT_NEAR(interface->constraint_at(mu, x, twice(x), {}).gap,
              gap_at(mu, {2 * x[0] / r, 2 * x[1] / r, 0}), 1e-14);
}

/// d / (n . t) along a line t, of which contact along the normal of the body sees a part.
TEST(RigidPlane, PartnersAreWhereTheLineMeetsThePlane) {
  const InterfaceMesh curve = support_curve(arc(6, 0.5), 1);
  const Scene scene = scene_of(1);
  RigidSurface plane = tilted_plane();
  plane.body_normal = radial;
  for (const bool along_body : {false, true})
    for (const Partner partner : {Partner::closest, Partner::ray, Partner::vertical}) {
      plane.along_body = along_body;
      plane.partner = partner;
      const auto interface = made_on(plane, scene, curve);
      for (const Point &x : curve.points) {
        const Point of_plane = normal_at(mu), n = along_body ? radial(mu, x) : of_plane,
                    line = partner == Partner::closest ? of_plane
                           : partner == Partner::ray   ? n
                                                       : Point{0, -1, 0};
        const double way = gap_at(mu, twice(x)) / dot(of_plane, line);
        EXPECT_NEAR(interface->constraint_at(mu, x, twice(x), {}).gap, way * dot(line, n), 1e-13);
      }
    }
}

TEST(RigidPlane, TheBoundOfFrictionIsThatOfItsParameter) {
  const InterfaceMesh curve = support_curve(arc(4, 0.5), 1);
  const Scene scene = scene_of(1);
  const auto bound = [&](FrictionLaw law) {
    return made_on(tilted_plane(law), scene, curve)->bound(mu);
  };
  EXPECT_EQ(bound(FrictionLaw::coulomb).coefficient, mu[friction]);
  EXPECT_EQ(bound(FrictionLaw::tresca).threshold, mu[friction]);
  EXPECT_EQ(bound(FrictionLaw::none).coefficient, 0);
  EXPECT_EQ(made_on(tilted_plane(), scene, curve)->dual().components, 1);
  EXPECT_EQ(made_on(tilted_plane(FrictionLaw::coulomb), scene, curve)->dual().components, 2);
}

TEST(RigidPlane, RefusesANormalThatIsNotOne) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Point &normal : {Point{0, -2, 0}, Point{}, Point{nan, 1, 0}, Point{0, 0.6, 0.9}})
    EXPECT_TRUE(refuses("the normal of a rigid plane is (",
                        [&] { plane_surface(normal, pivot, position()); }));
}

/// By the name of the function and of the boundary, wherever parameters are checked.
TEST(RigidPlane, RefusesFunctionsThatAreNotFinite) {
  const std::function<Coefficient> broken = [](const FullMu &at) {
    return at[push] > 0.5 ? std::numeric_limits<double>::quiet_NaN() : 0.1;
  };
  const auto expect = [&](const RigidSurface &plane, const std::string &name) {
    Scene scene = scene_of(1);
    scene.contacts = {rigid_surface(plane)};
    const std::string says =
        "the " + name + " of contact on 'foot' is not finite at push=0.6 tilt=0 friction=0.3";
    EXPECT_NO_THROW(check_set(scene, {{0.5, 0, 0.3}}));
    EXPECT_NO_THROW(check_query(scene, {0.5, 0, 0.3}, false));
    EXPECT_TRUE(refuses(says, [&] { check_set(scene, {{0.5, 0, 0.3}, {0.6, 0, 0.3}}); }));
    EXPECT_TRUE(refuses(says, [&] { check_query(scene, {0.6, 0, 0.3}, false); }));
    EXPECT_TRUE(refuses(says, [&] { check_query(scene, {0.6, 0, 0.3}, true); }));
    EXPECT_TRUE(refuses("the " + name + " of contact on 'foot'", [&] { check_box(scene); }));
  };
  const InterfaceMesh curve = support_curve(arc(4, 0.5), 1);
  RigidSurface plane = tilted_plane();
  for (const std::function<Surface> &nowhere :
       {plane_surface(untilted, pivot, broken),
        plane_surface(untilted, pivot, position(), broken)}) {
    plane.surface = nowhere;
    EXPECT_NO_THROW(operators_of(plane, scene_of(1), curve, {0.5, 0, 0.3}));
    EXPECT_THROW(operators_of(plane, scene_of(1), curve, {0.6, 0, 0.3}), Error);
  }
  plane = tilted_plane();
  plane.friction = {FrictionLaw::coulomb, broken};
  expect(plane, "coefficient of friction");
  plane.friction.law = FrictionLaw::tresca;
  expect(plane, "threshold of friction");
}

} // namespace
} // namespace rbvi::half_plane_test
