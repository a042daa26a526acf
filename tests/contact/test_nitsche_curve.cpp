// Nitsche's terms along a curve: against differences of their energies, and the fields and outputs
// of states that are known.
#include "nitsche_strip.hpp"
#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

namespace rbvi::nitsche_curve_test {
namespace {

struct Example {
  std::vector<NitscheFace> faces;
  Index dofs = 0;
  explicit Example(int degree) {
    const SupportScene scene = half_disk(degree);
    const Strip s = strip(degree, arc(6, 0.5));
    faces = nitsche_faces(layer_of(scene, s), {1.1}, s.cells);
    dofs = 2 * static_cast<Index>(s.nodes.size());
  }
  /// Some points are then in contact and others are not, some stick and others slip.
  Vector some_state(Random &random) const { return 0.05 * random.vector(dofs); }
};

Vector product(const std::vector<NitscheFace> &faces, const std::vector<FaceBlock> &blocks,
               const Vector &v) {
  Vector result = Vector::Zero(v.size());
  for (std::size_t f = 0; f < blocks.size(); ++f)
    for (Index i = 0; i < 12; ++i)
      for (Index j = 0; j < 12; ++j) {
        const int row = faces[f].dofs[i];
        const int column = faces[f].dofs[j];
        if (row >= 0 && column >= 0) result[row] += blocks[f](i, j) * v[column];
      }
  return result;
}

const NitscheLaw laws_of_tests[] = {{},
                                    FrictionBound{0, 0.4, false},
                                    FrictionBound{0, 0.4, true},
                                    FrictionBound{0.3, 0, false},
                                    FrictionBound{0.3, 0, false, 0.4}};

/// The bounds of friction that a state tells.
Vector bounds_of(const Example &e, const Vector &u, const NitscheLaw &law) {
  std::vector<NitscheFace> faces = e.faces;
  for (NitscheFace &face : faces)
    face.law = law;
  return nitsche_bounds(faces, nitsche_pressures(faces, u));
}

class NitscheStrip : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degree, NitscheStrip, ::testing::Values(1, 2));

TEST_P(NitscheStrip, GammaIsThatOfTheMaterialAndTheReferenceEdge) {
  const Strip s = strip(GetParam(), arc(6, 0.5));
  const SupportScene scene = half_disk(GetParam());
  const auto faces = nitsche_faces(layer_of(scene, s), {1.1}, s.cells);
  ASSERT_EQ(faces.size(), 6u);
  const double edge = 2 * std::sin(0.5 / 6);
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const double centre = between(s.nodes[k], s.nodes[k + 1], 0.5)[0];
    EXPECT_NEAR(faces[k].gamma, 0.3 * (9 + 3 * centre + 2 * 4) / edge, 1e-12 * faces[k].gamma);
    EXPECT_EQ(faces[k].dofs, s.cells[k].dofs);
  }
}

/// The tests below depend on it.
TEST_P(NitscheStrip, StatesOfTheTestsAreOnBothSidesOfTheKinks) {
  const Example e(GetParam());
  Random random(11);
  const Matrix pressures = nitsche_pressures(e.faces, e.some_state(random));
  const Index contact = (pressures.col(0).array() < 0).count();
  const Index stick = (pressures.col(1).array().abs() < 0.4).count();
  EXPECT_GT(contact, 0);
  EXPECT_LT(contact, pressures.rows());
  EXPECT_GT(stick, 0);
  EXPECT_LT(stick, pressures.rows());
}

/// Directional derivatives of the energy and of the residual, the bounds being fixed.
TEST_P(NitscheStrip, ResidualAndTangentAreDerivativesOfTheEnergy) {
  const Example e(GetParam());
  Random random(11);
  for (const NitscheLaw &law : laws_of_tests) {
    const Vector u = e.some_state(random), v = random.vector(e.dofs);
    const Vector bounds = bounds_of(e, u, law);
    constexpr double h = 1e-7;
    const double slope =
        (nitsche_energy(e.faces, u + h * v, bounds) - nitsche_energy(e.faces, u - h * v, bounds)) /
        (2 * h);
    const Vector residual = nitsche_residual(e.faces, u, bounds);
    EXPECT_NEAR(residual.dot(v), slope, 1e-6 * std::abs(slope));
    const Vector change = (nitsche_residual(e.faces, u + h * v, bounds) -
                           nitsche_residual(e.faces, u - h * v, bounds)) /
                          (2 * h);
    const auto blocks = nitsche_tangent(e.faces, nitsche_pressures(e.faces, u), bounds);
    ASSERT_EQ(blocks.size(), e.faces.size());
    EXPECT_LE((product(e.faces, blocks, v) - change).norm(), 1e-6 * change.norm());
  }
}

/// The energy that the consistency terms of the points add up to.
double consistency_energy(const std::vector<NitscheFace> &faces, const Vector &u, bool friction) {
  double energy = 0;
  for (const NitscheFace &face : faces) {
    NitschePoint::Row here = NitschePoint::Row::Zero();
    for (std::size_t i = 0; i < face.dofs.size(); ++i)
      if (face.dofs[i] >= 0) here[static_cast<Index>(i)] = u[face.dofs[i]];
    for (const NitschePoint &point : face.points) {
      energy += point.weight * consistency_term(point.sigma_n.dot(here), face.gamma).energy;
      if (friction)
        energy += point.weight * consistency_term(point.sigma_tau.dot(here), face.gamma).energy;
    }
  }
  return energy;
}

/// E(u + v) - E(u) - E(v) is the bilinear form of a quadratic energy E.
TEST_P(NitscheStrip, ConsistencyIsTheHessianOfItsEnergy) {
  const Example e(GetParam());
  Random random(5);
  const Vector u = random.vector(e.dofs), v = random.vector(e.dofs);
  for (const bool friction : {false, true}) {
    const auto energy = [&](const Vector &x) { return consistency_energy(e.faces, x, friction); };
    std::vector<NitscheFace> faces = e.faces;
    for (NitscheFace &face : faces)
      face.whole_stress = friction;
    const auto blocks = nitsche_consistency(faces);
    EXPECT_NEAR(u.dot(product(e.faces, blocks, v)), energy(u + v) - energy(u) - energy(v),
                1e-12 * std::abs(energy(u)));
    EXPECT_LT(energy(u), 0);
  }
}

TEST_P(NitscheStrip, LinearisedTermsAreTheTangentPlaneOfTheResidual) {
  const Example e(GetParam());
  Random random(17);
  for (const NitscheLaw &law : laws_of_tests) {
    const Vector at = e.some_state(random), u = random.vector(e.dofs);
    const Vector bounds = bounds_of(e, at, law);
    const Matrix pressures = nitsche_pressures(e.faces, at);
    const Vector residual = nitsche_residual(e.faces, at, bounds);
    EXPECT_EQ(nitsche_linearised(e.faces, at, pressures, bounds), residual);
    const auto blocks = nitsche_tangent(e.faces, pressures, bounds);
    const Vector plane = residual + product(e.faces, blocks, u - at);
    EXPECT_LE((nitsche_linearised(e.faces, u, pressures, bounds) - plane).norm(),
              1e-12 * plane.norm());
    EXPECT_GT((nitsche_residual(e.faces, u, bounds) - plane).norm(), 0.1 * plane.norm())
        << "u is in contact and sticks elsewhere";
  }
}

TEST_P(NitscheStrip, TheSlopeOfALineIsTheDerivativeOfTheEnergy) {
  const Example e(GetParam());
  Random random(23);
  for (const NitscheLaw &law : laws_of_tests) {
    const Vector u = e.some_state(random), d = e.some_state(random);
    const Vector bounds = bounds_of(e, u, law);
    const NitscheLine line = nitsche_line(e.faces, u, d, bounds);
    for (const double t : {0.0, 0.37, 1.0, 5.0}) {
      constexpr double h = 1e-6;
      const double difference = nitsche_energy(e.faces, u + (t + h) * d, bounds) -
                                nitsche_energy(e.faces, u + (t - h) * d, bounds);
      EXPECT_NEAR(line.slope(t), difference / (2 * h), 1e-6 * std::abs(line.slope(t)));
    }
  }
}

/// |u|^2 / 2 with contact and friction, along the direction of steepest descent times `length`.
struct Descent {
  double linear, quadratic;
  NitscheLine line;
  Descent(const Example &e, const Vector &u, const Vector &bounds, double length)
      : Descent(e, u, bounds, Vector(-length * (u + nitsche_residual(e.faces, u, bounds)))) {}
  double slope(double t) const { return linear + t * quadratic + line.slope(t); }
  double minimum() const { return line_minimum(linear, quadratic, line); }

private:
  Descent(const Example &e, const Vector &u, const Vector &bounds, const Vector &d)
      : linear(u.dot(d)), quadratic(d.dot(d)), line(nitsche_line(e.faces, u, d, bounds)) {}
};

TEST_P(NitscheStrip, ALineMinimumIsFoundWhereverItIs) {
  const Example e(GetParam());
  Random random(29);
  for (const NitscheLaw &law : laws_of_tests) {
    const Vector u = e.some_state(random);
    const Vector bounds = bounds_of(e, u, law);
    const double unit = Descent(e, u, bounds, 1).minimum();
    for (const double expected : {0.01, 0.3, 5.0}) { // where it is, roughly
      const Descent descent(e, u, bounds, unit / expected);
      ASSERT_LT(descent.slope(0), 0);
      const double t = descent.minimum();
      EXPECT_LE(std::abs(descent.slope(t)), 0.01 * std::abs(descent.slope(0))) << expected;
      EXPECT_EQ(t > 1, expected > 1);
    }
    EXPECT_EQ(Descent(e, u, bounds, 1e-3 * unit).minimum(), 16) << "it goes no farther";
  }
}

TEST(NitscheLines, AFullStepThatIsTheMinimumIsTaken) {
  const Example e(2);
  const Vector apart = Vector::Zero(e.dofs); // out of reach of the support
  std::vector<NitscheFace> faces = e.faces;
  for (NitscheFace &face : faces)
    for (NitschePoint &point : face.points)
      point.facing.gap = 1;
  EXPECT_EQ(line_minimum(-2, 2, nitsche_line(faces, apart, apart, {})), 1);
}

TEST(NitscheLaws, BoundsAreThoseOfTheLaw) {
  const auto bounds = [](const NitscheLaw &law) {
    return Vector({{nitsche_bound(law, -2), nitsche_bound(law, 0), nitsche_bound(law, 1)}});
  };
  EXPECT_EQ(bounds(laws_of_tests[0]), Vector({{-1, -1, -1}})) << "none";
  EXPECT_EQ(bounds(laws_of_tests[1]), Vector::Constant(3, 0.4));
  EXPECT_EQ(bounds(laws_of_tests[2]), Vector({{0.4, 0, 0}}));
  EXPECT_EQ(bounds(laws_of_tests[3]), Vector({{0.6, 0, 0}}));
  EXPECT_EQ(bounds(laws_of_tests[4]), Vector({{0.4, 0, 0}}));
  EXPECT_EQ(friction_term(0.3, -1, 2).energy, 0);
  EXPECT_EQ(friction_term(0, -1, 2).curvature, 0);
}

TEST(NitscheLaws, AreThoseOfTheSceneAndNotNegative) {
  const auto value = [](const FullMu &mu) { return mu[0]; };
  const Scene scene;
  const auto law_of = [&](const Friction &friction, const FullMu &mu) {
    return NitscheCurve{friction, {}, 1}.law_at(mu);
  };
  const NitscheLaw none = law_of({FrictionLaw::none, value}, {-1});
  EXPECT_FALSE(none);
  EXPECT_FALSE(moves(none));
  const NitscheLaw coulomb = law_of({FrictionLaw::coulomb, value}, {0.3});
  EXPECT_EQ(coulomb->coefficient, 0.3);
  EXPECT_TRUE(moves(coulomb));
  EXPECT_FALSE(moves(law_of({FrictionLaw::tresca, value}, {0.3})));
  EXPECT_TRUE(moves(law_of({FrictionLaw::tresca, value, true}, {0.3})));
  EXPECT_THROW(law_of({FrictionLaw::coulomb, value}, {-0.1}), Error);
  EXPECT_THROW(law_of({FrictionLaw::tresca, value}, {std::nan("")}), Error);
  EXPECT_THROW(law_of({FrictionLaw::coulomb, constant(0.3), false, value}, {-0.1}), Error);
}

class NitscheFieldsOf : public ::testing::TestWithParam<std::tuple<int, Side>> {};
INSTANTIATE_TEST_SUITE_P(DegreeAndSide, NitscheFieldsOf,
                         ::testing::Combine(::testing::Values(1, 2),
                                            ::testing::Values(Side::above, Side::below)));

/// u = m x: the same stress in every cell, whichever way its edge is listed.
TEST_P(NitscheFieldsOf, ALinearFieldHasItsStress) {
  const auto [degree, side] = GetParam();
  const FullMu mu{1.1};
  const Lame material{9, 4};
  SupportScene scene = half_disk(degree);
  scene.materials = {{{}, [=](const FullMu &, const Point &) { return material; }}};
  const Curve curve = arc(7, 0.5);
  const Strip s = strip(degree, curve, side);
  Eigen::Matrix2d m;
  m << 0.3, -0.2, 0.7, 0.1;
  const Eigen::Matrix2d strain = (m + m.transpose()) / 2;
  const Eigen::Matrix2d stress =
      material.lambda * strain.trace() * Eigen::Matrix2d::Identity() + 2 * material.shear * strain;
  const PointField linear = [&](const Point &x) {
    const Eigen::Vector2d value = m * Eigen::Vector2d(x[0], x[1]);
    return Point{value[0], value[1], 0};
  };
  const CurveFields fields = nitsche_fields(layer_of(scene, s), 0, mu, nodal(scene, mu, s, linear));
  ASSERT_EQ(fields.sigma_n.size(), 8);
  const double gamma = 0.3 * (9 + 2 * 4) / length(curve, 0);
  for (Index i = 0; i < 8; ++i) {
    const Point &x = curve[i], normal = radial(mu, x);
    const Point u = linear(scene.map(mu, x)), motion = scene.motion(mu, x);
    const Eigen::Vector2d n(normal[0], normal[1]), tau(-n[1], n[0]);
    const double excess = dot(u, normal) + dot(motion, normal) - scene.support.gap(mu, x);
    const double slip = dot(u, turned(normal)) + dot(motion, turned(normal));
    EXPECT_NEAR(fields.sigma_n[i], n.dot(stress * n), 1e-12);
    EXPECT_NEAR(fields.sigma_tau[i], tau.dot(stress * n), 1e-12);
    EXPECT_NEAR(fields.excess[i], excess, 1e-13);
    EXPECT_NEAR(fields.p_n[i], n.dot(stress * n) - gamma * excess, 1e-11);
    EXPECT_NEAR(fields.p_tau[i], tau.dot(stress * n) - gamma * slip, 1e-11);
    EXPECT_NEAR(fields.arc_length[i], 1.1 * length(curve, 0) * (static_cast<double>(i) - 3.5),
                1e-13);
  }
}

/// Where the material jumps.
TEST(NitscheFields, StressAndGammaAreMeansOfTheTwoEdges) {
  SupportScene scene = half_disk(2);
  scene.materials = {{{}, [](const FullMu &, const Point &x) {
                        return x[0] < 0 ? Lame{9, 4} : Lame{18, 8};
                      }}};
  const Strip s = strip(2, line(2, -0.5, 0.5, -1));
  scene.support.normal = scene.support.body_normal = [](const FullMu &, const Point &) {
    return Point{0, -1, 0};
  };
  const FullMu mu{1};
  const Vector u = nodal(scene, mu, s, [](const Point &x) { return Point{0, 0.1 * x[1], 0}; });
  const CurveFields fields = nitsche_fields(layer_of(scene, s), 0, mu, u);
  EXPECT_NEAR(fields.sigma_n[0], 1.7, 1e-13);
  EXPECT_NEAR(fields.sigma_n[1], (1.7 + 3.4) / 2, 1e-13);
  EXPECT_NEAR(fields.sigma_n[2], 3.4, 1e-13);
  EXPECT_NEAR(fields.p_n[1], fields.sigma_n[1] - 0.3 * (17 + 34) / 2 / 0.5 * fields.excess[1],
              1e-12);
}

} // namespace
} // namespace rbvi::nitsche_curve_test
