// Nitsche's terms at a point against differences of their energies and the laws they stand for, and
// what a point sees of a displacement against fields whose stress is known.
#include "../element/cells.hpp"
#include "rbvi/contact/nitsche_support.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "support_scenes.hpp"

#include <gtest/gtest.h>

namespace rbvi::nitsche_test {
namespace {

constexpr double gamma_of_tests = 7;

/// Central differences of a term and of its slope, at points away from its kinks.
template <class Term> void expect_derivatives(const Term &term, double p) {
  constexpr double h = 1e-6;
  const PointTerm here = term(p), before = term(p - h), after = term(p + h);
  EXPECT_NEAR(here.slope, (after.energy - before.energy) / (2 * h), 1e-8) << p;
  EXPECT_NEAR(here.curvature, (after.slope - before.slope) / (2 * h), 1e-8) << p;
}

TEST(NitscheTerms, SlopesAndCurvaturesAreDerivatives) {
  for (const double p : {-3.1, -0.4, 0.2, 0.9, 2.5}) {
    expect_derivatives([](double x) { return consistency_term(x, gamma_of_tests); }, p);
    expect_derivatives([](double x) { return contact_term(x, gamma_of_tests); }, p);
    for (const double bound : {0.0, 0.5, 10.0})
      expect_derivatives([&](double x) { return friction_term(x, bound, gamma_of_tests); }, p);
  }
}

/// sigma = [sigma - gamma (u - g)]_- is contact (4.14): the slopes of both terms then cancel in
/// sigma.
TEST(NitscheTerms, CancelInTheStressWhereTheLawsHold) {
  const double gap = 0.3;
  for (const auto &[sigma, u] : {std::pair{-2.0, gap}, {0.0, 0.1}, {0.0, -4.0}, {-1e-3, gap}}) {
    const double p = sigma - gamma_of_tests * (u - gap);
    EXPECT_NEAR(contact_term(p, gamma_of_tests).slope +
                    consistency_term(sigma, gamma_of_tests).slope,
                0, 1e-15);
  }
  const double bound = 0.5; // sticks below it, slips against it
  for (const auto &[sigma, u] : {std::pair{0.2, 0.0}, {-0.49, 0.0}, {0.5, -0.7}, {-0.5, 2.0}}) {
    const double p = sigma - gamma_of_tests * u;
    EXPECT_NEAR(friction_term(p, bound, gamma_of_tests).slope +
                    consistency_term(sigma, gamma_of_tests).slope,
                0, 1e-15);
  }
  const NitscheLaw coulomb = FrictionBound{0.3, 0, false};
  EXPECT_EQ(nitsche_bound(coulomb, -2), 0.6);
  EXPECT_EQ(nitsche_bound(coulomb, 1), 0);
}

class PerDegree : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(NitschePoints, PerDegree, ::testing::Values(1, 2));

/// Of edge ab of a triangle with the third vertex c.
Eigen::Vector2d outwards(const Point &a, const Point &b, const Point &c) {
  const Eigen::Vector2d n = Eigen::Vector2d(b[1] - a[1], a[0] - b[0]).normalized();
  return n.dot(Eigen::Vector2d(c[0] - a[0], c[1] - a[1])) < 0 ? n : Eigen::Vector2d(-n);
}

/// u = m x: its strain is constant. The stress acts on the normal of the body, which is not the one
/// of contact: on that of the edge, or on the one that the support names.
TEST_P(PerDegree, SeeTheStressAndTheDisplacementOfALinearField) {
  Random random(3);
  SupportScene scene = crooked(GetParam());
  const Lame material = lame(15, 0.3);
  const FullMu mu{0.4};
  int cells = 0;
  for (int k = 0; k < 6; ++k) {
    const int edge = k % 3;
    if (k == 3) scene.support.body_normal = radial;
    Cell cell{2, random_cell(2, random), {}};
    for (std::size_t v = 0; v < 3; ++v)
      cell.mapped[v] = scene.map(mu, cell.reference[v]);
    if (simplex(2, cell.mapped).volume < 0.05) continue; // the map can invert it
    ++cells;
    const Eigen::Matrix2d m = random_block(2, random).topLeftCorner<2, 2>();
    const Eigen::Matrix2d strain = (m + m.transpose()) / 2;
    const Eigen::Matrix2d stress = material.lambda * strain.trace() * Eigen::Matrix2d::Identity() +
                                   2 * material.shear * strain;
    const auto nodes = nodes_of(2, GetParam(), cell.mapped);
    NitschePoint::Row u = NitschePoint::Row::Zero();
    for (std::size_t i = 0; i < nodes.size(); ++i)
      u.segment<2>(2 * static_cast<Index>(i)) = m * nodes[i].head<2>();
    const auto ends = simplex_edges[edge];
    const auto a = static_cast<std::size_t>(ends[0]), b = static_cast<std::size_t>(ends[1]);
    double length = 0;
    for (std::size_t q = 0; q < 4; ++q) {
      const NitschePoint point = nitsche_points(
          scene, rigid_contact(scene.support).facing, mu,
          {cell, edge, {material.lambda, material.shear}, simplex(2, cell.mapped)})[q];
      constexpr double at[] = {0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                               0.93056815579702629};
      const Point x = between(cell.reference[a], cell.reference[b], at[q]);
      const Point mapped = between(cell.mapped[a], cell.mapped[b], at[q]);
      const Point normal = scene.support.normal(mu, x), motion = scene.motion(mu, x);
      const Eigen::Vector2d n(normal[0], normal[1]), tau(-n[1], n[0]);
      const Eigen::Vector2d value = m * Eigen::Vector2d(mapped[0], mapped[1]);
      const Point named = radial(mu, x);
      const Eigen::Vector2d of_body =
          k < 3 ? outwards(cell.mapped[a], cell.mapped[b], cell.mapped[3 - a - b])
                : Eigen::Vector2d(named[0], named[1]);
      EXPECT_NEAR(point.sigma_n.dot(u), n.dot(stress * of_body), 1e-12 * stress.norm());
      EXPECT_NEAR(point.sigma_tau.dot(u), tau.dot(stress * of_body), 1e-12 * stress.norm());
      EXPECT_NEAR(point.n.dot(u), n.dot(value), 1e-13);
      EXPECT_NEAR(point.tau.dot(u), tau.dot(value), 1e-13);
      EXPECT_NEAR(point.facing.gap, scene.support.gap(mu, x) - dot(motion, normal), 1e-14);
      EXPECT_NEAR(point.facing.slip, dot(motion, turned(normal)), 1e-14);
      length += point.weight;
    }
    EXPECT_NEAR(
        length,
        std::hypot(cell.mapped[b][0] - cell.mapped[a][0], cell.mapped[b][1] - cell.mapped[a][1]),
        1e-14);
  }
  EXPECT_GT(cells, 0);
}

TEST(NitschePoints, AnInvertedCellIsAFailure) {
  const SupportScene scene = hertz(2);
  const Vertices inverted{{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {}}};
  EXPECT_THROW(nitsche_points(scene, rigid_contact(scene.support).facing, {1.0},
                              {{2, inverted, inverted}, 0, {1, 1}, simplex(2, inverted)}),
               Error);
}

} // namespace
} // namespace rbvi::nitsche_test
