// Models whose multipliers are those near contact alone.
#include "disk.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/mor/nodal_dual_basis.hpp"
#include "rbvi/mor/reduction.hpp"
#include "reduced.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace rbvi::near_contact_test {
namespace {

using namespace testing_reduced;

constexpr double everywhere = std::numeric_limits<double>::infinity();

struct Case {
  std::string scene, free;
  SceneOptions options{};
};

const std::vector<Case> cases{{"rigid_disk", "radius", {{"arc_edges", "80"}}},
                              {"rigid_disk", "radius", {{"arc_edges", "80"}, {"normal", "rigid"}}},
                              {"rigid_disk", "friction_coefficient", {{"arc_edges", "80"}}},
                              {"two_disks", "radius", {{"arc_edges", "32"}}},
                              {"roller", "top", {{"arc_edges", "64"}}}};

Scene scene_of(const Case &c) {
  Scene scene = make_scene(c.scene, c.options);
  scene.parameters = free_only(scene.parameters, c.free);
  return scene;
}

ReduceOptions law_within(double ring) {
  ReduceOptions options;
  options.condensed.ring = ring;
  options.multipliers.reduction = MultiplierReduction::condensed;
  return options;
}

/// The model of the nodes near contact of the samples, whether or not its queries are answered.
ReducedModel near_samples(Reduced &r, const ReduceOptions &options) {
  const Scene &scene = r.problem.scene();
  Reduction made;
  Reducing at = start_reducing(r.problem, r.samples, options, made);
  run_stages(stages_of(scene, options), at, "", stage::projection.text);
  EXPECT_GT(made.bases.dropped, 0);
  r.affine = std::move(made.affine);
  return project(r.problem, r.samples, r.affine, made.bases);
}

TEST(NearContact, KeepsWhatIsWithinTheRing) {
  Problem problem(PETSC_COMM_WORLD, disk("radius"), {});
  const Contact &contact = problem.contact();
  const std::vector<Point> points = dual_points(contact);
  const Index nodes = contact.nodes(), first = nodes / 3, last = nodes / 2;
  const auto across = [&](Index i, Index k) {
    const Point &a = points[static_cast<std::size_t>(i)], &b = points[static_cast<std::size_t>(k)];
    return std::hypot(a[0] - b[0], a[1] - b[1]);
  };
  Matrix lambda = Matrix::Zero(2 * nodes, 2);
  for (Index i = first; i <= last; ++i)
    lambda(i, i % 2) = 1;
  lambda(nodes - 1, 0) = 1e-15; // round-off
  const Matrix basis = nodal_dual_basis(problem, lambda);
  ASSERT_EQ(basis.cols(), 2 * nodes);
  const std::vector<Index> kept = columns_near_contact(contact, basis, lambda, 0.25);
  const double reach = 0.25 * across(first, last);
  for (Index i = 0; i < nodes; ++i) {
    const bool near =
        std::min(across(i, first), across(i, last)) <= reach || (i >= first && i <= last);
    EXPECT_EQ(std::binary_search(kept.begin(), kept.end(), i), near) << i;
    EXPECT_EQ(std::binary_search(kept.begin(), kept.end(), nodes + i), near)
        << "a node keeps both multipliers or none";
  }
  EXPECT_EQ(std::ssize(columns_near_contact(contact, basis, lambda, everywhere)), 2 * nodes);
  EXPECT_EQ(std::ssize(columns_near_contact(contact, basis, 0 * lambda, 0.25)), 2 * nodes)
      << "nothing is known of where contact is";
}

TEST(NearContact, GivesTheAnswersOfAllNodes) {
  for (const Case &c : cases) {
    SCOPED_TRACE(c.scene + ", " + c.free);
    Reduced near(scene_of(c), "grid:5");
    ReduceOptions options;
    options.condensed.ring = everywhere;
    near.reduce(options);
    const ReducedModel all = near.model;
    options.condensed.ring = 0.1;
    near.reduce(options);
    check_model(near.model);
    EXPECT_GT(near.bases.dropped, 0);
    EXPECT_EQ(near.model.contact.generators + near.bases.dropped, all.contact.generators);
    const ParameterSpace &space = near.problem.scene().parameters;
    OnlineSolver with_all(all), with_near(near.model);
    for (const Mu &mu : parse_set(space, "random:10:5")) {
      const ReducedAnswer expected = with_all.solve(mu), found = with_near.solve(mu);
      const Vector lambda = with_all.multiplier(expected);
      EXPECT_LE((with_near.multiplier(found) - lambda).norm(), 1e-9 * lambda.norm());
      const Vector u = with_all.field(expected);
      EXPECT_LE((with_near.field(found) - u).norm(), 1e-9 * u.norm());
      EXPECT_NEAR(found.energy, expected.energy, 1e-9 * std::abs(expected.energy));
    }
  }
}

/// The nodes of the model are at one end of the arc, where nothing touches: all of the answer is
/// missing, and is no answer.
TEST(NearContact, SaysWhereBodiesMeetElsewhere) {
  for (const Case &c : {Case{"rigid_disk", "radius", {{"arc_edges", "80"}}},
                        Case{"two_disks", "radius", {{"arc_edges", "32"}}}}) {
    SCOPED_TRACE(c.scene);
    const Scene scene = scene_of(c);
    Reduced r(scene, "grid:3");
    for (Sample &sample : r.samples) {
      sample.lambda.setZero();
      const Index nodes = r.problem.contact().nodes();
      sample.lambda.segment(c.scene == "two_disks" ? nodes - 4 : 0, 4).setOnes();
    }
    const ReducedModel elsewhere = near_samples(r, law_within(1));
    OnlineSolver solver(elsewhere);
    try {
      (void)solver.outputs({1.0}, solver.solve({1.0}));
      FAIL() << "the bodies penetrate";
    } catch (const Error &error) {
      EXPECT_NE(std::string(error.what()).find("far from the nodes"), std::string::npos)
          << error.what();
    }
  }
}

/// Trained where contact is small: a query says so, a reduction takes all nodes.
TEST(NearContact, AnswersNothingWhereItReachesTheEdge) {
  for (const Case &c : {Case{"rigid_disk", "indentation", {{"arc_edges", "80"}}},
                        Case{"two_disks", "radius", {{"arc_edges", "32"}}}}) {
    SCOPED_TRACE(c.scene);
    const Scene scene = scene_of(c);
    const Parameter &d = scene.parameters.at(0);
    const auto at = [&](double part) { return Mu{d.lower + part * (d.upper - d.lower)}; };
    Reduced r(scene, "grid:1");
    r.samples = solve_all(r.problem, {at(0), at(0.02)});
    const ReduceOptions options = law_within(0.15);
    const ReducedModel narrow = near_samples(r, options);
    OnlineSolver solver(narrow);
    EXPECT_NO_THROW(solver.solve(at(0.01)));
    try {
      solver.solve(at(1));
      FAIL() << "contact is far wider there";
    } catch (const Error &error) {
      EXPECT_NE(std::string(error.what()).find("up to the ends of the box"), std::string::npos);
    }
    r.reduce(options);
    EXPECT_EQ(r.bases.dropped, 0);
    EXPECT_NO_THROW(OnlineSolver(r.model).solve(at(1)));
  }
}

} // namespace
} // namespace rbvi::near_contact_test
