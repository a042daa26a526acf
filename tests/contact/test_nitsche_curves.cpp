// Several curves by Nitsche's method in one layer: together they answer as each by itself.
#include "nitsche_strip.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rbvi::nitsche_curves_test {
namespace {

Vector stacked(const Vector &a, const Vector &b) {
  return (Vector(a.size() + b.size()) << a, b).finished();
}

/// Two curves without common dofs, each with a law of its own, and both as one layer.
struct TwoCurves {
  SupportScene scene = half_disk(2);
  Strip first = strip(2, arc(6, 0.5)), second = strip(2, arc(5, 0.4));
  NitscheLayer one = layer_of(scene, first), other = layer_of(scene, second),
               both{scene, one.curves, one.cells};
  FullMu mu{1.1};
  Vector u, v; ///< of the two curves

  TwoCurves(const Friction &of_first, const Friction &of_second) {
    scene.contacts.resize(2);
    scene.contacts[1].name = "lower";
    one.curves.front().law = both.curves.front().law = of_first;
    other.curves.front().law = of_second;
    both.curves.push_back(other.curves.front());
    const auto dofs = 2 * static_cast<int>(first.nodes.size());
    for (CurveCell cell : other.cells) {
      cell.curve = 1;
      for (int &dof : cell.dofs)
        if (dof >= 0) dof += dofs;
      both.cells.push_back(cell);
    }
    Random random(41);
    u = 0.05 * random.vector(dofs);
    v = 0.05 * random.vector(2 * static_cast<Index>(second.nodes.size()));
  }
  std::vector<NitscheFace> faces(const NitscheLayer &layer) const {
    return nitsche_faces(layer, mu, layer.cells);
  }
};

const auto constant = [](double value) { return [=](const FullMu &) { return value; }; };

TEST(NitscheCurves, TogetherAnswerAsEachByItself) {
  for (const Friction &law : {Friction{}, Friction{FrictionLaw::tresca, constant(0.4)}}) {
    const TwoCurves two(law, {FrictionLaw::coulomb, constant(0.3)});
    const auto one = two.faces(two.one), other = two.faces(two.other), both = two.faces(two.both);
    const Vector w = stacked(two.u, two.v);
    const Matrix p = nitsche_pressures(one, two.u), q = nitsche_pressures(other, two.v),
                 all = nitsche_pressures(both, w);
    EXPECT_EQ(all, (Matrix(p.rows() + q.rows(), 2) << p, q).finished());
    const Vector of_one = nitsche_bounds(one, p), of_other = nitsche_bounds(other, q),
                 bounds = nitsche_bounds(both, all);
    EXPECT_TRUE(bounds_move(both));
    EXPECT_FALSE(bounds_move(one));
    EXPECT_EQ(bounds.tail(q.rows()), of_other);
    EXPECT_EQ(nitsche_residual(both, w, bounds), stacked(nitsche_residual(one, two.u, of_one),
                                                         nitsche_residual(other, two.v, of_other)));
    const double energy =
        nitsche_energy(one, two.u, of_one) + nitsche_energy(other, two.v, of_other);
    EXPECT_NEAR(nitsche_energy(both, w, bounds), energy, 1e-14 * energy);
    const auto tangent = nitsche_tangent(both, all, bounds),
               of_first = nitsche_tangent(one, p, of_one);
    EXPECT_TRUE(std::equal(of_first.begin(), of_first.end(), tangent.begin()));
    const auto consistency = nitsche_consistency(both), apart = nitsche_consistency(one);
    EXPECT_TRUE(std::equal(apart.begin(), apart.end(), consistency.begin()));
    EXPECT_EQ(nitsche_multiplier(two.both, two.mu, w),
              stacked(nitsche_multiplier(two.one, two.mu, two.u),
                      nitsche_multiplier(two.other, two.mu, two.v)));
  }
}

/// Points that touch without friction and lift off with it: at some bound between them pressure and
/// bound agree. Others touch, or do not, with any bound.
TEST(NitscheCurves, BoundsThatTurnBackAndForthSettle) {
  const NitscheLaw law = FrictionBound{0, 0.5, true};
  const std::vector<NitscheLaw> laws(4, law);
  const Vector without{{-0.03, -0.02, -2, 1}};
  const Matrix by_bounds{
      {0.13, 0.02, 0.01, 0}, {0.05, 0.12, 0, 0.02}, {0.3, 0.1, 0.2, 0}, {0, 0.1, 0.1, 0.3}};
  FollowingBounds following;
  Matrix pressures = Matrix::Zero(4, 2);
  Vector bounds = Vector::Zero(4), before;
  int loops = 0;
  do {
    before = bounds;
    pressures.col(0) = without + by_bounds * bounds;
    bounds = following.next(laws, pressures, bounds);
  } while ((bounds - before).norm() > 1e-13 && ++loops < 60);
  EXPECT_LE(loops, 15);
  EXPECT_EQ(bounds[2], law->threshold);
  EXPECT_EQ(bounds[3], 0);
  for (const Index i : {0, 1}) {
    EXPECT_GT(bounds[i], 0.01);
    EXPECT_LT(bounds[i], law->threshold);
    EXPECT_NEAR(nitsche_bound(law, pressures(i, 0)), bounds[i], 1e-9);
  }
}

Outputs outputs_of(const NitscheLayer &layer, const FullMu &mu, const Vector &u) {
  Outputs outputs;
  const auto faces = nitsche_faces(layer, mu, layer.cells);
  const Matrix pressures = nitsche_pressures(faces, u);
  nitsche_outputs(layer, mu, faces, u, pressures, nitsche_bounds(faces, pressures), outputs);
  return outputs;
}

TEST(NitscheCurves, OutputsAreSumsAndMaxima) {
  const TwoCurves two({}, {FrictionLaw::coulomb, constant(0.3)});
  const Outputs one = outputs_of(two.one, two.mu, two.u),
                other = outputs_of(two.other, two.mu, two.v),
                both = outputs_of(two.both, two.mu, stacked(two.u, two.v));
  EXPECT_NEAR(*both.normal_force, *one.normal_force + *other.normal_force, 1e-14);
  EXPECT_NEAR(*both.reaction, *one.reaction + *other.reaction, 1e-14);
  EXPECT_EQ(*both.contact_nodes, *one.contact_nodes + *other.contact_nodes);
  EXPECT_EQ(*both.max_penetration, std::max(*one.max_penetration, *other.max_penetration));
  EXPECT_EQ(*both.peak_pressure, std::max(*one.peak_pressure, *other.peak_pressure));
  EXPECT_EQ(*both.tangential_force, *other.tangential_force);
  EXPECT_FALSE(one.tangential_force);
  EXPECT_FALSE(both.contact_half_width) << "there is no such thing of two curves";
  ASSERT_EQ(both.interfaces.size(), 2U);
  EXPECT_EQ(both.interfaces[0].name, "contact 1");
  EXPECT_EQ(both.interfaces[1].name, "lower");
}

/// A curve that nothing touches has no stress but what its free edge is off by.
TEST(NitscheCurves, ErrorsOfTheLawsAreRelativeToTheStressOfAllCurves) {
  const TwoCurves two({}, {FrictionLaw::coulomb, constant(0.3)});
  const Vector small = 1e-6 * two.u, slight = 1e-6 * two.v;
  for (const auto &[u, v] : {std::pair{two.u, two.v}, {small, two.v}, {two.u, slight}}) {
    const CurveFields one = nitsche_fields(two.one, 0, two.mu, u),
                      other = nitsche_fields(two.other, 0, two.mu, v);
    const Outputs both = outputs_of(two.both, two.mu, stacked(u, v));
    const Vector sigma = stacked(one.sigma_n, other.sigma_n), p = stacked(one.p_n, other.p_n);
    EXPECT_NEAR(*both.law_error_normal, (sigma - p.cwiseMin(0)).norm() / sigma.norm(), 1e-13);
    const Outputs rubs = outputs_of(two.other, two.mu, v);
    EXPECT_NEAR(*both.law_error_tangential, *rubs.law_error_tangential, 1e-13);
    EXPECT_NEAR(*both.law_error_tau_over_n * sigma.norm(),
                *rubs.law_error_tangential * other.sigma_tau.norm(), 1e-12);
  }
}

TEST(NitscheCurves, TheMultiplierIsMinusTheStress) {
  const TwoCurves two({}, {FrictionLaw::coulomb, constant(0.3)});
  const CurveFields one = nitsche_fields(two.one, 0, two.mu, two.u),
                    other = nitsche_fields(two.other, 0, two.mu, two.v);
  EXPECT_EQ(nitsche_multiplier(two.one, two.mu, two.u), -one.sigma_n);
  EXPECT_EQ(nitsche_multiplier(two.other, two.mu, two.v), -stacked(other.sigma_n, other.sigma_tau));
}

/// Axes turn on the curve that follows the displacement alone.
TEST(NitscheCurves, OneMayFollowTheDisplacement) {
  TwoCurves two({}, {FrictionLaw::coulomb, constant(0.3)});
  Facing turning{.at = [](const FullMu &, const PlacedPoint &, const Point &displacement) {
    const double angle = 0.3 + 2 * displacement[0];
    return FacedPoint{
        {std::sin(angle), -std::cos(angle), 0}, 0.02 - 0.5 * displacement[1], displacement[0], 0.7};
  }};
  turning.follows_state = true;
  two.other.curves.front().facing = two.both.curves.back().facing = turning;
  EXPECT_TRUE(two.both.follows_state());
  EXPECT_FALSE(two.one.follows_state());
  const Vector w = stacked(two.u, two.v);
  const auto at = [&](const NitscheLayer &layer, const Vector &state) {
    return nitsche_faces(layer, two.mu, layer.cells, state);
  };
  const auto one = two.faces(two.one), other = at(two.other, two.v), both = at(two.both, w);
  const auto residual = [](const std::vector<NitscheFace> &faces, const Vector &u) {
    return nitsche_residual(faces, u, nitsche_bounds(faces, nitsche_pressures(faces, u)));
  };
  EXPECT_EQ(residual(both, w), stacked(residual(one, two.u), residual(other, two.v)));
  const auto at_rest = two.faces(two.other);
  EXPECT_GT((residual(other, two.v) - residual(at_rest, two.v)).norm(),
            0.01 * residual(other, two.v).norm());
}

} // namespace
} // namespace rbvi::nitsche_curves_test
