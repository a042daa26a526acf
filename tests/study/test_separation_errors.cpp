// B^n and B^tau interpolated apart, from snapshots to answers; what the terms of a model leave.
#include "reduced.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/model/affine_coefficients.hpp"
#include "rbvi/model/law_problem.hpp"
#include "rbvi/mor/published/reductions.hpp"
#include "rbvi/mor/reduction.hpp"
#include "rbvi/study/separation_errors.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <filesystem>

namespace rbvi::separation_errors_test {
namespace {

using namespace testing_reduced;

Scene rigid_disk() {
  Scene scene = make_scene("rigid_disk", {{"arc_edges", "40"}, {"normal", "rigid"}});
  scene.parameters = free_only(scene.parameters, "radius");
  return scene;
}

ReduceOptions published() {
  ReduceOptions options;
  options.pod.tolerance = 1e-6;
  options.eim.tolerance = 1e-10;
  options.cone.type = ConeType::mcpg;
  options.cone.tolerance = 1e-3;
  options.multipliers.reduction = MultiplierReduction::collocated;
  options.multipliers.exact = false;
  return options;
}

/// The training mu into the model, as the tool does.
void name_training(Reduced &r) {
  const std::vector<Mu> set = r.mus();
  r.model.made.trained_mu.resize(static_cast<Index>(set.front().size()),
                                 static_cast<Index>(set.size()));
  for (std::size_t p = 0; p < set.size(); ++p)
    std::copy(set[p].begin(), set[p].end(),
              r.model.made.trained_mu.col(static_cast<Index>(p)).begin());
}

/// Models of the same bases and nodes, with the one or the other separation of B.
struct Pair {
  ReducedModel joint, apart;
  AffineOperators separated;
};

Pair with_both(Reduced &r, const ReduceOptions &options, const RowOptions &rows) {
  const Scene &scene = r.problem.scene();
  const AffineOperators joint = separate(r.problem, r.mus(), options.eim);
  Pair pair{{}, {}, separate(r.problem, r.mus(), options.eim, rows)};
  Reduction made;
  made.affine = separate(r.problem, r.mus(), options.eim);
  Reducing at = start_reducing(r.problem, r.samples, options, made);
  run_stages(stages_of(scene, options), at, stage::pod.text, stage::projection.text);
  const ReducedBases &bases = made.bases;
  pair.joint = project(r.problem, r.samples, joint, bases);
  pair.apart = project(r.problem, r.samples, pair.separated, bases);
  (void)collocate(pair.joint, r.problem, r.samples, options.gcns);
  pair.apart.contact.law->basis.nodes = pair.joint.contact.law->basis.nodes;
  check_model(pair.joint);
  check_model(pair.apart);
  return pair;
}

/// Largest difference of u and of the multipliers at some radii, relative.
double difference(const ReducedModel &one, const ReducedModel &other) {
  OnlineSolver a(one), b(other);
  double largest = 0;
  for (const double radius : {0.713, 0.86, 1.027, 1.288}) {
    const ReducedAnswer x = a.solve({radius}), y = b.solve({radius});
    largest = rbvi::largest({largest, (x.u - y.u).norm() / x.u.norm(),
                             (a.multiplier(x) - b.multiplier(y)).norm() / a.multiplier(x).norm()});
  }
  return largest;
}

TEST(RowsApart, AnswersAreThoseOfOneInterpolationWithinTheTolerance) {
  Reduced r(rigid_disk(), "grid:21");
  const ReduceOptions options = published();
  for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
    SCOPED_TRACE(tolerance);
    const Pair pair = with_both(r, options, {{.tolerance = tolerance}, {.tolerance = 1e-10}});
    EXPECT_EQ(pair.apart.contact.law->apart.normal, pair.separated.b.size());
    EXPECT_EQ(pair.apart.contact.b.size(), pair.separated.b_size());
    EXPECT_EQ(pair.joint.contact.law->apart.normal, 0);
    EXPECT_LE(difference(pair.joint, pair.apart), 20 * tolerance);
  }
  const Pair alike = with_both(r, options, {{.tolerance = 1e-10}, {.tolerance = 1e-10}});
  EXPECT_LE(difference(alike.joint, alike.apart), 1e-7);
}

/// The reduced b of a query is the projection of the full one, in the rows of both multipliers.
TEST(RowsApart, TermsSumUpToTheProjectionOfB) {
  Reduced r(rigid_disk(), "grid:21");
  ReduceOptions options = published();
  options.eim_normal = 1e-3;
  options.eim_tangential = 1e-9;
  r.reduce(options);
  const ReducedModel &model = r.model;
  EXPECT_LE(model.contact.law->apart.normal_error, 1e-3);
  EXPECT_LE(model.contact.law->apart.tangential_error, 1e-9);
  EXPECT_EQ(model.contact.b.error, model.contact.law->apart.normal_error);
  EXPECT_EQ(model.made.histories.count("eim/b"), 0U);
  EXPECT_EQ(model.made.histories.at("eim/b_normal").back(), model.contact.law->apart.normal_error);
  const Index n = model.contact.law->normal;
  const std::vector<PetscInt> &contact_dofs = r.problem.places().natural_dofs;
  Operators op;
  OnlineSolver online(model);
  for (const double radius : {0.77, 1.19}) {
    r.problem.assemble_contact({radius}, op);
    const FullMu all = expand(r.problem.scene().parameters, {radius});
    const Vector theta =
        contact_coefficients(model.contact.b, Part::b, r.problem.contact(), r.problem.scene(), all);
    const Matrix found =
        (model.contact.b.reduced * theta).reshaped(model.contact.generators, model.primal_size());
    const Matrix exact = model.contact.dual_basis.transpose() *
                         (op.b * model.fields.basis(contact_dofs, Eigen::all));
    EXPECT_LE((found - exact).topRows(n).norm(), 1e-2 * exact.norm());
    EXPECT_LE((found - exact).bottomRows(n).norm(), 1e-8 * exact.norm());
    // The work on a unit vertical displacement has no error of separation.
    Vector up = Vector::Zero(op.b.cols());
    for (Index i = 1; i < up.size(); i += 2)
      up[i] = 1;
    const ReducedAnswer answer = online.solve({radius});
    const double reaction = online.multiplier(answer).dot(op.b * up);
    EXPECT_NEAR(*online.outputs({radius}, answer).reaction, -reaction, 1e-12 * std::abs(reaction));
  }
}

/// Mended answers are exact where both tolerances are small: the condensed operator is that of all
/// terms.
TEST(RowsApart, TheCondensedOperatorHasBoth) {
  Reduced r(rigid_disk(), "grid:21");
  const auto unseen = solve_all(r.problem, {{0.74}, {0.99}, {1.23}});
  ReduceOptions options = published();
  options.multipliers.exact = true;
  options.cone.tolerance = 1e-6;
  options.multipliers.tangential = 1e-8;
  r.reduce(options);
  check_model(r.model);
  const Index terms = r.model.contact.b.size();
  EXPECT_EQ(r.model.contact.law->condensed.terms.cols(), terms * (terms + 1) / 2);
  const ModelErrors e = r.errors_at(unseen);
  EXPECT_EQ(e.failed, 0);
  EXPECT_LE(e.lambda.maxCoeff(), 1e-5);
  EXPECT_LE(e.tangential.maxCoeff(), 1e-5);
  ReduceOptions condensed = options;
  condensed.multipliers.reduction = MultiplierReduction::condensed;
  r.reduce(condensed);
  EXPECT_EQ(r.model.contact.law->apart.normal, 0) << "there one interpolation serves both";
}

TEST(RowsApart, SurviveTheirFile) {
  Reduced r(rigid_disk(), "grid:9", PETSC_COMM_SELF);
  ReduceOptions options = published();
  options.eim_normal = 1e-4;
  r.reduce(options);
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("rows_apart." + std::to_string(rank) + ".h5");
  write_model(r.model, path);
  ReducedModel again = read_model(path, catalogue());
  std::filesystem::remove(path);
  std::filesystem::remove(fields_file(path));
  const TermsApart &was = r.model.contact.law->apart, &is = again.contact.law->apart;
  EXPECT_GT(was.normal, 0);
  EXPECT_EQ(is.normal, was.normal);
  EXPECT_EQ(is.normal_error, was.normal_error);
  EXPECT_EQ(is.tangential_error, was.tangential_error);
  EXPECT_EQ(difference(r.model, again), 0);
  again.contact.law->apart.normal = again.contact.b.size();
  EXPECT_THROW(check_model(again), Error);
  again = r.model;
  again.contact.b.interpolation(again.contact.b.size() - 1, 0) = 0.5;
  EXPECT_THROW(check_model(again), Error);
}

/// Over the training set they are those of the greedy, and over any set those of the definition.
void expect_training_errors(Reduced &r, const std::vector<std::string> &names) {
  name_training(r);
  const std::vector<SeparationErrors> found = separation_errors(r.problem, r.model, r.mus());
  ASSERT_EQ(found.size(), names.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_EQ(found[k].name, names[k]);
    ASSERT_EQ(found[k].training.size(), found[k].validation.size());
    for (std::size_t j = 0; j < found[k].training.size(); ++j)
      EXPECT_NEAR(found[k].validation[j], found[k].training[j], 1e-5 * found[k].training[j] + 1e-13)
          << names[k] << ", " << j << " terms";
  }
}

TEST(SeparationErrors, OverTheTrainingSetAreThoseOfTheGreedy) {
  Reduced r(rigid_disk(), "grid:21");
  r.reduce(published());
  expect_training_errors(r, {"b_normal", "b_tangential", "g"}); // A is an exact sum
  ReduceOptions condensed = published();
  condensed.multipliers.reduction = MultiplierReduction::condensed;
  r.reduce(condensed);
  expect_training_errors(r, {"b", "g"});
  ReduceOptions obstacle;
  obstacle.eim.tolerance = 1e-3;
  Reduced membrane({{"disc_map", "graded"}, {"circle_edges", "24"}}, "grid:3,2,2", obstacle);
  expect_training_errors(membrane, {"a", "b", "f", "g"});
}

TEST(SeparationErrors, OverOtherParametersAreThoseOfTheModelsOwnSum) {
  Reduced r(rigid_disk(), "grid:21");
  ReduceOptions options = published();
  options.eim_normal = 1e-3;
  options.eim_tangential = 1e-6;
  r.reduce(options);
  name_training(r);
  const std::vector<Mu> unseen{{0.715}, {0.92}, {1.11}};
  for (const SeparationErrors &e : separation_errors(r.problem, r.model, unseen)) {
    if (!e.name.starts_with("b_")) continue;
    const bool normal = e.name == "b_normal";
    const Eim &eim = normal ? r.affine.b : r.affine.b_tangential;
    ASSERT_EQ(static_cast<int>(e.validation.size()), eim.size() + 1);
    double left = 0, scale = 0;
    for (const Mu &mu : unseen) {
      Operators op;
      r.problem.assemble_contact(mu, op);
      const Matrix b = op.b;
      Vector theta(eim.size());
      for (int j = 0; j < eim.size(); ++j) {
        const EntryKey key = eim.entries[j];
        theta[j] = b(key.row, key.column);
      }
      eim.interpolation.triangularView<Eigen::UnitLower>().solveInPlace(theta);
      const Vector weights = eim.combination * theta;
      Matrix rest = b;
      for (int i = 0; i < eim.size(); ++i) {
        r.problem.assemble_contact(r.samples[eim.snapshots[i]].mu, op);
        rest -= weights[i] * Matrix(op.b);
      }
      const Index half = b.rows() / 2, first = normal ? 0 : half;
      left = larger(left, rest.middleRows(first, half).cwiseAbs().maxCoeff());
      scale = std::max(scale, b.middleRows(first, half).cwiseAbs().maxCoeff());
    }
    EXPECT_NEAR(e.validation.back(), left / scale, 1e-6 * left / scale + 1e-13);
    EXPECT_LE(e.validation.back(), 2 * e.training.back()) << "as good at unseen radii";
  }
}

} // namespace
} // namespace rbvi::separation_errors_test
