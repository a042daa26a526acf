// Responses to the answers of the law in place of those to the loads of all multipliers.
#include "../method/random_matrix.hpp"
#include "reduced.hpp"

#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/mor/answered_responses.hpp"
#include "rbvi/par/columns.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/solve/vectors.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

namespace rbvi::answered_responses_test {
namespace {

using namespace testing_reduced;

Scene scene_of(const std::string &name, const SceneOptions &options) {
  Scene scene = make_scene(name, options);
  scene.parameters = free_only(scene.parameters, "radius");
  return scene;
}

/// Largest distance of the samples to the span of the basis, relative, in V.
double distance(Problem &problem, const std::vector<Sample> &samples, const LinearBasis &basis) {
  double largest = 0, scale = 0;
  for (const Sample &sample : samples) {
    const Handle<Vec> u = from_natural(problem.dofs(), sample.u), product = like(u.get());
    Vector inside(basis.size());
    RBVI_CALL(BVDotVec(basis.columns.get(), u.get(), inside.data()));
    const auto squared = [&] {
      double value = 0;
      RBVI_CALL(MatMult(problem.v_product(), u.get(), product.get()));
      RBVI_CALL(VecDot(u.get(), product.get(), &value));
      return value;
    };
    scale = std::max(scale, squared());
    RBVI_CALL(BVMultVec(basis.columns.get(), -1, 1, u.get(), inside.data()));
    largest = std::max(largest, squared());
  }
  return std::sqrt(largest / scale);
}

TEST(ResponseDirections, AreAsFewAsTheAnswersNeed) {
  constexpr Index size = 30, rank = 4;
  constexpr double small = 1e-4;
  Random random(1);
  const Matrix root = random.matrix(size, size);
  const Matrix compliance = root.transpose() * root + Matrix::Identity(size, size);
  const Matrix factors = random.matrix(size, rank), numbers = random.matrix(rank, 40);
  Matrix answers = factors * numbers;
  ResponseDirections directions(compliance);
  directions.add(answers.leftCols(20), 1e-8);
  const Matrix few = directions.coefficients(1e-8);
  EXPECT_EQ(few.cols(), rank);
  EXPECT_LE((few.transpose() * compliance * few - Matrix::Identity(rank, rank)).norm(), 1e-10)
      << "orthonormal in the energy";
  EXPECT_LE(directions.left(answers.rightCols(20)), 1e-8);

  // One more direction, which counts from its size on.
  answers.col(30) += small * random.vector(size);
  const double left = directions.left(answers.rightCols(20));
  EXPECT_GT(left, 0.01 * small);
  directions.add(answers.rightCols(20), 0.01 * left);
  EXPECT_LE(directions.left(answers), 0.01 * left);
  EXPECT_EQ(directions.coefficients(2 * left).cols(), rank);
  const Matrix all = directions.coefficients(0.01 * left);
  EXPECT_EQ(all.cols(), rank + 1);
  const Matrix rest = answers - all * (all.transpose() * (compliance * answers));
  EXPECT_LE(std::sqrt((rest.transpose() * compliance * rest).diagonal().maxCoeff()),
            0.02 * left *
                std::sqrt((answers.transpose() * compliance * answers).diagonal().maxCoeff()));
  EXPECT_THROW(ResponseDirections(-compliance), Error);
}

/// Every displacement is there to the tolerance, also where no sample was.
TEST(AnsweredResponses, HoldTheDisplacementsOfAllParameters) {
  struct Case {
    std::string scene;
    SceneOptions options;
  };
  for (const Case &c : {Case{"rigid_disk", {{"arc_edges", "60"}}},
                        Case{"rigid_disk", {{"arc_edges", "60"}, {"kinematics", "large"}}},
                        Case{"two_disks", {{"arc_edges", "16"}}},
                        Case{"two_disks", {{"arc_edges", "16"}, {"kinematics", "large"}}}}) {
    SCOPED_TRACE(c.scene + (c.options.contains("kinematics") ? ", large" : ""));
    constexpr double tolerance = 1e-4;
    Reduced r(scene_of(c.scene, c.options), "grid:5");
    ReduceOptions options;
    options.condensed.responses = 0; // the modes alone
    r.reduce(options);
    const auto unseen = solve_all(r.problem, parse_set(r.problem.scene().parameters, "random:6:3"));
    EXPECT_GT(distance(r.problem, unseen, r.bases.pod.basis), 5 * tolerance);
    const CondensedLoads loads = condensed_loads(r.problem, r.affine, r.mus(),
                                                 multipliers_of(r.samples), r.bases.nodal_dual);
    const int appended =
        append_answered_responses(r.problem, loads, r.model, tolerance, r.bases.pod.basis)
            .functions;
    EXPECT_GT(appended, 0);
    EXPECT_LT(appended, loads.joining());
    EXPECT_LE(distance(r.problem, unseen, r.bases.pod.basis), 2 * tolerance)
        << "in V; the tolerance is one of the energy";
  }
}

/// The basis is that of two samples, and misses what contact does elsewhere: at the contact dofs
/// the compliance behind the law knows it.
TEST(AnsweredResponses, GapsAreThoseOfTheLawWhateverTheBasis) {
  Reduced r(scene_of("two_disks", {{"arc_edges", "16"}}), "grid:2");
  ReduceOptions options;
  options.condensed.responses = 0;
  r.reduce(options);
  OnlineSolver solver(r.model);
  for (const Mu &mu : parse_set(r.problem.scene().parameters, "random:4:3")) {
    const ReducedAnswer answer = solver.solve(mu);
    const ContactOperators &op = answer.contact;
    Vector u = r.model.contact.trace * answer.u;
    const Vector of_basis = op.b * u - op.g;
    u(r.model.contact.law->condensed.dofs) += answer.beyond_basis;
    const Vector left = op.b * u - op.g, lambda = solver.multiplier(answer);
    const double size = op.g.cwiseAbs().maxCoeff();
    EXPECT_GT(of_basis.maxCoeff(), 1e-4 * size);
    EXPECT_LE(left.maxCoeff(), 1e-10 * size);
    for (Index row = 0; row < left.size(); ++row)
      if (lambda[row] > 0) EXPECT_NEAR(left[row], 0, 1e-10 * size);
    const Outputs full = HighFidelity(r.problem, {}).solve(mu).outputs;
    EXPECT_NEAR(*solver.outputs(mu, answer).max_penetration, *full.max_penetration,
                1e-9 * *full.max_penetration)
        << "between the nodes";
  }
}

TEST(AnsweredResponses, TakeThePlaceOfLargeFields) {
  Reduced r(scene_of("rigid_disk", {{"arc_edges", "160"}}), "grid:7");
  const auto unseen = solve_all(r.problem, parse_set(r.problem.scene().parameters, "random:5:3"));
  for (const bool large : {false, true}) {
    ReduceOptions options;
    options.eim.tolerance = 1e-10; // of g
    if (large) options.condensed.large_fields = 1e6;
    r.reduce(options);
    check_model(r.model);
    const Index loads = r.bases.nodal_dual.cols();
    EXPECT_FALSE(r.bases.awaiting.has_value());
    EXPECT_EQ(r.model.body.supremizers, r.bases.responses);
    if (large) {
      EXPECT_LT(r.bases.responses, loads / 2);
    } else {
      EXPECT_GT(r.bases.responses, loads / 2);
    }
    const ModelErrors errors = r.errors_at(unseen);
    EXPECT_LE(errors.u.maxCoeff(), large ? 2e-5 : 1e-8);
    EXPECT_LE(errors.lambda.maxCoeff(), 1e-8) << "the multipliers are exact with both";
    const BorrowedColumns basis(r.bases.pod.basis.columns.get());
    const Matrix trace = restrict_to(r.problem.trace(), basis.get());
    for (Index j = 0; j < trace.cols(); ++j) {
      const double size = trace.col(j).lpNorm<Eigen::Infinity>(),
                   off = (trace.col(j) - r.model.contact.trace.col(j)).lpNorm<Eigen::Infinity>();
      EXPECT_LE(off, large ? 0.1 * options.condensed.answers * size : 0) << j;
      if (large) EXPECT_GT(off, 1e-3 * options.condensed.answers * size) << "digits go, " << j;
    }
  }
}

/// Where A changes, the answers' responses are there for all A, and multipliers as exact as ever.
TEST(AnsweredResponses, ServeEveryStiffness) {
  Scene disk = make_scene("rigid_disk", {{"arc_edges", "40"}});
  disk.parameters = free_only(disk.parameters, "indentation,core_stiffness,poisson_ratio");
  Reduced r(disk, "random:25:2");
  std::vector<Mu> set = corners_and_faces(disk.parameters);
  for (Mu &mu : parse_set(disk.parameters, "random:5:3"))
    set.push_back(std::move(mu));
  const auto unseen = solve_all(r.problem, set);
  ReduceOptions options;
  options.condensed.responses = 0; // the modes alone
  r.reduce(options);
  EXPECT_GT(r.errors_at(unseen).u.maxCoeff(), 1e-3);
  options.condensed = {};
  options.condensed.large_fields = 1e4;
  r.reduce(options);
  check_model(r.model);
  EXPECT_GT(r.bases.factorisations, r.model.contact.law->condensed.grid.size());
  const ModelErrors errors = r.errors_at(unseen);
  EXPECT_LE(errors.u.maxCoeff(), 2e-4);
  EXPECT_LE(errors.lambda.maxCoeff(), 1e-8);
}

/// A wheel, its top held and its halves of two materials, pressed on a floor by a body force, or by
/// the displacement of its top alone where it has no weight.
Scene pressed_wheel(bool heavy) {
  const std::string text =
      "rbvi: 1\nphysics: plane_strain\nmesh: {built_in: annulus, edges: 16}\n"
      "parameters: {e: {range: [5, 20], default: 10}, n: {range: [0.2, 0.4], default: 0.3},\n"
      "  w: {range: [0.5, 2], default: 1}}\n"
      "materials: {rubber: {at: all, E: 'x < 0 ? e : 10', nu: n}}\n"
      "imposed: {top: {at: top, ux: 0, uy: -0.02}}\n"
      "loads: {weight: {at: all, force: [0.2*w, -w]}}\n"
      "contact: {floor: {at: bottom, against: {plane: {normal: [0, -1], position: 1}}, friction: "
      "{coulomb: 0.2}}}\n";
  Scene scene = make_scene(read_case(text, "case.yaml"), {});
  if (heavy) return scene;
  scene.parameters = free_only(scene.parameters, "e,n");
  scene.parameters.all.back().value = 0;
  return scene;
}

/// Where a displacement costs a factor of A_N, fewer functions have it as exactly: multipliers keep
/// every digit that the gap under the load has, displacements what is wanted of them.
TEST(AnsweredDisplacements, LeaveOutWhatNoAnswerNeeds) {
  Scene disk = make_scene("rigid_disk", {{"arc_edges", "40"}});
  disk.parameters = free_only(disk.parameters, "core_stiffness,poisson_ratio");
  for (const Scene &scene : {disk, pressed_wheel(true)}) {
    Reduced r(scene, "random:25:2");
    ReduceOptions options;
    options.eim.tolerance = 1e-10;
    r.reduce(options);
    check_model(r.model);
    ASSERT_TRUE(factorises_for_displacements(r.problem, r.model));
    EXPECT_EQ(r.model.body.supremizers, r.bases.responses);
    EXPECT_EQ(r.bases.pod.basis.size(), r.model.primal_size());
    EXPECT_EQ(answered_displacements(r.problem, r.model).size(), 0) << "what is left is needed";
    std::vector<Mu> set = corners_and_faces(scene.parameters);
    for (Mu &mu : parse_set(scene.parameters, "random:5:3"))
      set.push_back(std::move(mu));
    const ModelErrors errors = r.errors_at(solve_all(r.problem, set));
    EXPECT_LE(errors.u.maxCoeff(), 2e-6);
    EXPECT_LE(errors.lambda.maxCoeff(), 1e-7);
  }
}

/// Where contact reaches the edge of the nodes near it everywhere, nothing is answered before all
/// nodes are kept; the load is zero.
TEST(AnsweredDisplacements, WaitForAModelThatAnswers) {
  Reduced r(pressed_wheel(false), "random:25:2");
  r.reduce({});
  const auto unseen = solve_all(r.problem, parse_set(r.problem.scene().parameters, "random:3:3"));
  EXPECT_LE(r.errors_at(unseen).u.maxCoeff(), 1e-5);
}

} // namespace
} // namespace rbvi::answered_responses_test
