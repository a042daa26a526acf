#include "brute_force.hpp"

#include "rbvi/contact/contact_area.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/affine_coefficients.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/model/packed.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

namespace rbvi::online_test {
namespace {

using namespace brute;

/// One solver that goes through many parameters gives the answer found by brute force.
template <synthetic::Value value> void expect_exact(const synthetic::Sizes &sizes) {
  int active = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    const ReducedModel model = toy_model(sizes, seed);
    OnlineSolver solver(model, synthetic::toy_scene<value>());
    for (const Mu &mu : parse_set(model.scene.parameters, "random:12:" + std::to_string(seed))) {
      const ReducedAnswer solution = solver.solve(mu);
      const Operators o = assemble(model, value, mu);
      const Vector u = brute_force(o);
      EXPECT_LE((solution.u - u).norm(), 1e-10 * (u.norm() + 1e-3));
      EXPECT_GE(solution.lambda.minCoeff(), 0);
      EXPECT_LE((o.a * solution.u + o.b.transpose() * solution.lambda - o.f).norm(),
                1e-11 * o.f.norm());
      EXPECT_NEAR(solution.energy, 0.5 * u.dot(o.a * u) - o.f.dot(u), 1e-10 * std::abs(o.f.dot(u)));
      EXPECT_LE(solution.residual, 1e-11);
      active += (solution.lambda.array() > 0).any();
    }
  }
  EXPECT_GT(active, 20) << "the constraints were hardly ever tested";
}

TEST(OnlineSolver, AgreesWithBruteForce) {
  expect_exact<smooth>({3, 3, 5, 3, 2, 2, 2});
}
TEST(OnlineSolver, OneTermOfA) {
  expect_exact<smooth>({3, 3, 5, 1, 2, 2, 2});
}
TEST(OnlineSolver, OneTermOfB) {
  expect_exact<smooth>({3, 3, 5, 3, 1, 2, 2});
}
TEST(OnlineSolver, OneTermOfBoth) {
  expect_exact<smooth>({3, 3, 5, 1, 1, 2, 2});
}
TEST(OnlineSolver, OneTermOfBothSignsChange) {
  expect_exact<flipping>({4, 2, 5, 1, 1, 2, 2});
}
/// The terms of A by one matrix and what differs on two functions; a leading part, too.
TEST(OnlineSolver, StiffnessThatChangesOnFewFunctions) {
  const synthetic::Sizes sizes{4, 4, 6, 3, 1, 2, 2};
  const Index n = 8, r = 2;
  for (unsigned seed = 0; seed < 4; ++seed) {
    ReducedModel model = toy_model(sizes, seed), changed = model;
    std::mt19937 random(seed);
    changed.body.a.reduced = pack(synthetic::random_spd(random, n));
    StiffnessChange &change = changed.body.a_change;
    change.range = synthetic::random_matrix(random, n, r);
    change.scales = Vector::LinSpaced(3, 0.4, 0.9);
    change.cores.resize(r * (r + 1) / 2, 3);
    for (Index q = 0; q < 3; ++q) {
      change.cores.col(q) = pack(synthetic::random_spd(random, r));
      Matrix lower(n, n);
      stiffness_of(changed, Vector::Unit(3, q), lower);
      model.body.a.reduced.col(q) = pack(lower);
    }
    check_model(changed);
    OnlineSolver solver(model, synthetic::toy_scene<smooth>()),
        other(changed, synthetic::toy_scene<smooth>());
    const int size = seed % 2 == 0 ? 6 : 1; // fewer functions than the change has, too
    const ReducedModel part = leading(model, size, 4), part_of_changed = leading(changed, size, 4);
    OnlineSolver part_solver(part, synthetic::toy_scene<smooth>()),
        other_part(part_of_changed, synthetic::toy_scene<smooth>());
    for (const Mu &mu : parse_set(model.scene.parameters, "random:8:" + std::to_string(seed))) {
      const ReducedAnswer a = solver.solve(mu), b = other.solve(mu);
      EXPECT_LE((a.u - b.u).norm(), 1e-11 * a.u.norm());
      EXPECT_LE((a.lambda - b.lambda).norm(), 1e-10 * a.lambda.norm());
      EXPECT_NEAR(a.energy, b.energy, 1e-11 * std::abs(a.energy));
      EXPECT_LE(b.residual, 1e-11);
      const Vector u = part_solver.solve(mu).u;
      EXPECT_LE((other_part.solve(mu).u - u).norm(), 1e-11 * u.norm());
    }
    changed.body.a_change.cores *= -1e3;
    EXPECT_THROW(OnlineSolver(changed, synthetic::toy_scene<smooth>()).solve({0.2, 0, 0}), Error);
  }
}

/// Gaps are known where the model has displacements.
TEST(OnlineSolver, TraceOfSomeNodes) {
  const ReducedModel model = toy_model({3, 3, 3, 2, 2, 2, 2}, 5);
  ReducedModel partial = model;
  partial.contact.trace_dofs = {0, 2};
  partial.contact.trace = model.contact.trace({0, 2}, Eigen::all).eval();
  check_model(partial);
  OnlineSolver solver(model, synthetic::toy_scene<smooth>()),
      other(partial, synthetic::toy_scene<smooth>());
  const ReducedAnswer a = solver.solve({0.2, 0, 0}), b = other.solve({0.2, 0, 0});
  EXPECT_EQ(a.u, b.u);
  const Vector all = solver.contact_gap(a), some = other.contact_gap(b);
  EXPECT_DOUBLE_EQ(some[0], all[0]);
  EXPECT_DOUBLE_EQ(some[2], all[2]);
  EXPECT_EQ(some[1], std::numeric_limits<double>::infinity());
  EXPECT_NEAR(*other.outputs({0.2, 0, 0}, b).max_penetration, std::max({0.0, -all[0], -all[2]}),
              1e-14);
}

TEST(OnlineSolver, NoLoad) {
  const ReducedModel model = toy_model({3, 3, 5, 3, 2, 0, 1}, 1);
  OnlineSolver solver(model, synthetic::toy_scene<smooth>());
  EXPECT_EQ(solver.solve({0.2, 0, 0}).u.norm(), 0); // g > 0: rest is feasible
}

TEST(OnlineSolver, MoreConstraintsThanUnknowns) {
  ReducedModel model = toy_model({2, 0, 8, 2, 1, 2, 1}, 3);
  model.contact.b.reduced(4, 0) = model.contact.b.reduced(0, 0); // two equal generators
  model.contact.b.reduced(8 + 4, 0) = model.contact.b.reduced(8, 0);
  model.contact.g.reduced(4, 0) = model.contact.g.reduced(0, 0);
  OnlineSolver solver(model, synthetic::toy_scene<smooth>());
  for (const Mu &mu : parse_set(model.scene.parameters, "grid:5,5,1")) {
    const Vector u = brute_force(assemble(model, smooth, mu));
    EXPECT_LE((solver.solve(mu).u - u).norm(), 1e-10 * u.norm());
  }
}

TEST(OnlineSolver, ContradictingConstraintsAreAFailure) {
  ReducedModel model = toy_model({3, 0, 2, 1, 1, 1, 1}, 2);
  for (int j = 0; j < 3; ++j)
    model.contact.b.reduced(2 * j + 1, 0) = -model.contact.b.reduced(2 * j, 0);
  model.contact.g.reduced.setConstant(-1); // b u <= -1 and -b u <= -1
  OnlineSolver solver(model, synthetic::toy_scene<smooth>());
  try {
    solver.solve({0.2, 0, 0});
    FAIL() << "accepted";
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::failed);
    const std::string message = error.what();
    EXPECT_NE(message.find("contradict"), std::string::npos) << message;
    EXPECT_NE(message.find("radius=0.2"), std::string::npos) << message;
  }
}

/// The stiffness turns negative in a part of the box.
double negative_beyond(int form, int i, const FullMu &mu) {
  return form == 0 && mu[0] > 0.22 ? -smooth(form, i, mu) : smooth(form, i, mu);
}

TEST(OnlineSolver, IndefiniteStiffnessIsAFailureAndForgotten) {
  for (const int terms : {1, 2, 3}) {
    const ReducedModel model = toy_model({3, 3, 5, terms, 1, 1, 1}, 4);
    OnlineSolver solver(model, synthetic::toy_scene<negative_beyond>());
    const Mu mu{0.2, 0, 0};
    for (int round = 0; round < 2; ++round) {
      EXPECT_THROW(solver.solve({0.23, 0, 0}), Error);
      EXPECT_LE((solver.solve(mu).u - brute_force(assemble(model, smooth, mu))).norm(), 1e-10);
    }
  }
}

TEST(OnlineSolver, TheBoxIsKeptUnlessExtrapolating) {
  const ReducedModel model = toy_model({}, 5);
  OnlineSolver solver(model, synthetic::toy_scene<smooth>());
  EXPECT_THROW(solver.solve({0.3, 0, 0}), Error);
  EXPECT_THROW(solver.solve({0.2, 0}), Error);
  EXPECT_NO_THROW(solver.solve({0.25, 0, 0}, true));
}

/// (B.36) against the cotangent formula: int |grad phi_0|^2 = |opposite edge|^2 / (4 area).
TEST(AffineCoefficients, ReassembleTheSampledEntries) {
  const Scene scene = make_scene("membrane_obstacle");
  std::mt19937 random(7);
  AffineTerms terms = synthetic::random_terms(random, 1, 4, 3);
  terms.interpolation = synthetic::random_matrix(random, 4, 4).triangularView<Eigen::UnitLower>();
  terms.interpolation.triangularView<Eigen::StrictlyUpper>().setZero();
  const FullMu mu{0.23, 0.04, -0.03};
  const Vector theta = affine_coefficients(terms, scene.a, scene, mu);
  for (int entry = 0; entry < 4; ++entry) {
    double expected = 0;
    for (int cell = 3 * entry; cell < 3 * entry + 3; ++cell) {
      Point x[3];
      for (int i = 0; i < 3; ++i)
        x[i] = scene.map(mu, point_of(terms.samples.front().vertices, 3 * cell + i));
      const double edge[2] = {x[2][0] - x[1][0], x[2][1] - x[1][1]};
      const double area = 0.5 * std::abs((x[1][0] - x[0][0]) * (x[2][1] - x[0][1]) -
                                         (x[2][0] - x[0][0]) * (x[1][1] - x[0][1]));
      expected += (edge[0] * edge[0] + edge[1] * edge[1]) / (4 * area);
    }
    EXPECT_NEAR(terms.interpolation.row(entry).dot(theta), expected, 1e-12 * expected);
  }
  EXPECT_EQ(affine_coefficients({}, scene.f, scene, mu).size(), 0);
}

TEST(Outputs, AreIntegralsOverTheContactRegion) {
  ReducedModel model = synthetic::random_model({}, 8);
  model.made.validation_enriched = {10, 1e-3, 2e-3, 3e-3, 4e-3};
  OnlineSolver solver(model);
  const Mu mu{0.19, 0.01, 0.02};
  ReducedAnswer solution = solver.solve(mu);
  solution.lambda << 1, 0, 2, 0;
  const Outputs outputs = solver.outputs(mu, solution);
  const Vector lambda = model.contact.dual_basis.col(0) + 2 * model.contact.dual_basis.col(2);
  // A triangle of area 0.01, scaled from radius 0.2 to 0.19.
  const Vector weights = Vector::Constant(3, 0.01 / 3 * std::pow(0.19 / 0.2, 2));
  EXPECT_NEAR(*outputs.normal_force, lambda.dot(weights), 1e-13 * std::abs(lambda.dot(weights)));
  EXPECT_NEAR(*outputs.peak_pressure, lambda.maxCoeff(), 1e-13 * lambda.maxCoeff());
  const InterfaceModel &contact = model.contact.interfaces.front();
  const double area = contact_area(weights, lambda, contact.mesh.entities, 3);
  EXPECT_LT(std::abs(area), std::abs(weights.sum()));
  EXPECT_NEAR(*outputs.contact_measure, area, 1e-13 * std::abs(area));
  const Vector field = solver.field(solution);
  double deepest = 0;
  for (const int node : contact.nodes) {
    // psi = -1.25 |x - c|^2 / r^2 on the mapped disc is -1.25 |xhat|^2 / 0.2^2 on the reference
    // one.
    const double psi = -1.25 * model.fields.points.row(node).squaredNorm() / 0.04;
    deepest = std::max(deepest, psi - field[node]);
  }
  EXPECT_NEAR(*outputs.max_penetration, deepest, 1e-12);
  EXPECT_EQ(*outputs.expected_error_u, 2e-3);
  EXPECT_EQ(*outputs.expected_error_lambda, 4e-3);
  EXPECT_FALSE(outputs.min_u);
  EXPECT_FALSE(solver.outputs({0.26, 0, 0}, solution).expected_error_u);

  solution.lambda.setZero();
  EXPECT_EQ(*solver.outputs(mu, solution).contact_measure, 0);
}

/// Without vertex quadrature the pressure overshoots along the edge, and tells nothing of the part
/// of a patch that is in contact.
TEST(Outputs, OfAConsistentMassCountWholeWeights) {
  const ReducedModel model =
      synthetic::random_model({}, 8, make_scene("membrane_obstacle", {{"lumped", "no"}}));
  OnlineSolver solver(model);
  const Mu mu{0.19, 0.01, 0.02};
  ReducedAnswer solution = solver.solve(mu);
  solution.lambda << 1, 0, 2, 0;
  const double whole = 0.01 * std::pow(0.19 / 0.2, 2); // of the triangle
  EXPECT_NEAR(*solver.outputs(mu, solution).contact_measure, whole, 1e-13 * std::abs(whole));
}

} // namespace
} // namespace rbvi::online_test
