// Two bodies from snapshots to answers: reproduction, errors, stability, ranks, and training sets
// with little or no contact.
#include "../mor/stability_bound.hpp"
#include "reduced.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/mor/high_fidelity_pair.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/small_svd.hpp"
#include "rbvi/solve/linear.hpp"
#include "rbvi/study/stability_report.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

namespace rbvi::two_disks_test {
namespace {

using namespace testing_reduced;

/// Nine radii of two_disks and four others, solved once.
struct NineDisks : testing::Test {
  static inline std::unique_ptr<Reduced> r;
  static inline std::vector<Sample> unseen;

  static void SetUpTestSuite() {
    r = std::make_unique<Reduced>(make_scene("two_disks"), "grid:9");
    unseen = solve_all(r->problem, parse_set(r->problem.scene().parameters, "random:4:7"));
  }
  static void TearDownTestSuite() { r.reset(); }
};

ReduceOptions with(ConeType type, double pod = 1e-12, double cone = 0) {
  ReduceOptions options;
  options.multipliers.reduction = MultiplierReduction::cone;
  options.pod.tolerance = pod;
  options.cone.type = type;
  options.cone.tolerance = cone;
  return options;
}

TEST_F(NineDisks, ABasisOfAllSnapshotsReturnsThem) {
  for (const ConeType type : {ConeType::nodal, ConeType::hybrid, ConeType::mcpg}) {
    SCOPED_TRACE(cone_type_names()[static_cast<std::size_t>(type)]);
    r->reduce(with(type));
    EXPECT_EQ(r->model.body.modes, 9);
    ASSERT_EQ(r->model.contact.interfaces.size(), 1U);
    EXPECT_EQ(r->model.contact.interfaces.front().mesh.parts, std::vector<int>(2, 281))
        << "of degree 2 on 140 edges";
    EXPECT_EQ(r->model.body.a.size(), 1);
    EXPECT_EQ(r->model.contact.b.size() + r->model.contact.g.size() + r->model.body.f.size(), 0);
    EXPECT_NO_THROW(check_model(r->model));
    const ModelErrors errors = r->errors_at(r->samples);
    EXPECT_EQ(errors.failed, 0);
    EXPECT_LE(errors.u.maxCoeff(), 1e-9);
    EXPECT_LE(errors.lambda.maxCoeff(), 1e-6);
    EXPECT_LE(errors.kkt_residual, 1e-10);
    OnlineSolver online(r->model);
    for (const Sample &sample : r->samples) {
      const ReducedAnswer answer = online.solve(sample.mu);
      const Outputs out = online.outputs(sample.mu, answer);
      EXPECT_NEAR(*out.energy, *sample.outputs.energy, 1e-8);
      EXPECT_NEAR(*out.normal_force, *sample.outputs.normal_force, 1e-7);
      EXPECT_NEAR(*out.peak_pressure, *sample.outputs.peak_pressure, 1e-5);
      EXPECT_NEAR(*out.max_penetration, *sample.outputs.max_penetration, 1e-7);
      EXPECT_LE((online.field(answer) - sample.u).norm(), 1e-8 * sample.u.norm());
    }
  }
}

TEST_F(NineDisks, UnseenRadiiAreAnswered) {
  struct Expected {
    ConeType type;
    double u, lambda;
  };
  for (const Expected &e :
       {Expected{ConeType::mcpg, 2e-3, 0.02}, Expected{ConeType::hybrid, 2e-3, 0.012}}) {
    SCOPED_TRACE(cone_type_names()[static_cast<std::size_t>(e.type)]);
    r->reduce(with(e.type, 1e-4, 1e-4));
    EXPECT_EQ(r->model.contact.free_modes > 0, e.type == ConeType::hybrid);
    const ModelErrors errors = r->errors_at(unseen);
    EXPECT_EQ(errors.failed, 0);
    EXPECT_LE(errors.u.maxCoeff(), e.u);
    EXPECT_LE(errors.lambda.maxCoeff(), e.lambda);
    EXPECT_LE(errors.kkt_residual, 1e-10);
    EXPECT_TRUE((errors.u.array() * (1 + 1e-9) >= errors.u_floor.array()).all());
    EXPECT_TRUE((errors.lambda.array() + 1e-9 >= errors.lambda_floor.array()).all());
  }
}

/// B changes with mu by more than a factor; the sharp bound holds all the same.
TEST_F(NineDisks, TheSharpBoundHoldsAtEveryRadius) {
  for (const double fraction : {0.5, 0.9}) {
    ReduceOptions options = with(ConeType::hybrid, 1e-4, 1e-4);
    options.pga.stability = fraction;
    r->reduce(options);
    ASSERT_GT(r->model.body.supremizers, 0);
    const StabilityCheck check = make_stability_check(r->problem, r->model);
    for (const Mu &mu : r->mus()) {
      const Matrix t = supremizers_at(r->problem, check.space, check.dual, {{mu, {}}}).front();
      const StabilityBound bound = stability_bound(check.coordinates, t);
      EXPECT_GE(infsup_constant(check.coordinates, t), (1 - 1e-9) * bound.sharp);
      EXPECT_GE(bound.sharp, (fraction - 1e-9) * bound.on);
    }
    const std::vector<Mu> others = parse_set(r->problem.scene().parameters, "random:6:2");
    const BoundCheck bound = check_bound(PETSC_COMM_WORLD, r->problem, check, at_rest(others));
    EXPECT_EQ(bound.exceptions, 0);
    EXPECT_GE(bound.smallest, 1 - 1e-9);
  }
}

void expect_samples_returned(Reduced &r, double u, double lambda) {
  const ModelErrors errors = r.errors_at(r.samples);
  EXPECT_EQ(errors.failed, 0);
  EXPECT_LE(errors.u.maxCoeff(), u);
  EXPECT_LE(errors.lambda.maxCoeff(), lambda);
}

TEST(ReducedDisks, AnswersDoNotDependOnTheNumberOfRanks) {
  const Scene scene = make_scene("two_disks");
  Reduced alone(scene, "grid:4", PETSC_COMM_SELF), world(scene, "grid:4");
  for (const ConeType type : {ConeType::mcpg, ConeType::hybrid}) {
    alone.reduce(with(type, 1e-4, 1e-4));
    world.reduce(with(type, 1e-4, 1e-4));
    EXPECT_EQ(alone.model.primal_size(), world.model.primal_size());
    EXPECT_EQ(alone.model.contact.generators, world.model.contact.generators);
    OnlineSolver a(alone.model), w(world.model);
    for (const Mu &mu : parse_set(scene.parameters, "random:5:9")) {
      const ReducedAnswer one = a.solve(mu), many = w.solve(mu);
      EXPECT_LE((a.field(one) - w.field(many)).norm(), 1e-9 * a.field(one).norm());
      EXPECT_LE((a.multiplier(one) - w.multiplier(many)).norm(), 1e-8 * a.multiplier(one).norm());
    }
  }
}

TEST(ReducedDisks, OtherDiscretisationsReduceAsWell) {
  for (const auto &[multiplier, integration] :
       {std::pair{"p1", "intersection"}, std::pair{"p0", "direct"}, std::pair{"p1", "direct"}}) {
    SCOPED_TRACE(std::string(multiplier) + " " + integration);
    Reduced r(make_scene("two_disks", {{"degree", "1"},
                                       {"arc_edges", "280"},
                                       {"multiplier", multiplier},
                                       {"integration", integration}}),
              "grid:3");
    r.reduce(with(ConeType::hybrid));
    EXPECT_EQ(r.model.contact.dual_basis.rows(), std::string(multiplier) == "p1" ? 281 : 140);
    expect_samples_returned(r, 1e-9, 1e-6);
  }
}

/// What both ways find at the centre of a scene's box.
struct BothWays {
  explicit BothWays(const Scene &scene)
      : problem(PETSC_COMM_WORLD, scene, {}),
        space(make_riesz_space(problem.v_product(), problem.trace())),
        v(make_direct_solver(PETSC_COMM_WORLD, "v_")) {
    problem.assemble_contact(box_centre(problem.scene().parameters), op);
    set_operator(v.get(), problem.v_product());
  }
  PairConstants dense() const { return dense_constants(problem, space, op); }
  PairConstants iterated() { return iterated_constants(problem, v.get(), op); }

  Problem problem;
  RieszSpace space;
  Handle<KSP> v;
  Operators op;
};

/// beta_HF and c_HF by iterations over the ranks are those of dense matrices, with multipliers
/// without a partner, too.
TEST(HighFidelityPair, TheIterationsAgreeWithDenseMatrices) {
  for (const std::string name : {"membrane_obstacle", "two_disks", "rigid_disk"}) {
    SCOPED_TRACE(name);
    BothWays ways(make_scene(name));
    EXPECT_FALSE(iterates_constants(ways.problem)) << "few multipliers";
    const PairConstants dense = ways.dense(), iterated = ways.iterated();
    EXPECT_GT(dense.beta, 0);
    EXPECT_NEAR(iterated.beta, dense.beta, 1e-8 * dense.beta);
    EXPECT_NEAR(iterated.c, dense.c, 1e-9 * dense.c);
  }
}

/// How many solvers of SLEPc of a kind, "eps" or "svd", this rank prints while `work` runs.
template <class Work> long shown(const std::string &kind, const Work &work) {
  const std::string option = "-infsup_" + kind + "_view";
  RBVI_CALL(PetscOptionsSetValue(nullptr, option.c_str(), nullptr));
  testing::internal::CaptureStdout();
  work();
  const std::string text = testing::internal::GetCapturedStdout();
  RBVI_CALL(PetscOptionsClearValue(nullptr, option.c_str()));
  const std::string object = kind == "eps" ? "EPS Object: (infsup_)" : "SVD Object: (infsup_)";
  long objects = 0;
  for (auto at = text.find(object); at != std::string::npos; at = text.find(object, at + 1))
    ++objects;
  return objects;
}

/// The prefix infsup_ reaches beta_HF and c_HF in either way.
TEST(HighFidelityPair, FollowsTheOptionsOfSlepc) {
  BothWays ways(make_scene("two_disks", {{"arc_edges", "20"}}));
  // A large matrix lets the SVD object of the prefix go, which keeps the options of its first call.
  singular_values(Matrix::Identity(320, 320), "infsup_");
  EXPECT_EQ(shown("svd", [&] { ways.dense(); }), 1);
  singular_values(Matrix::Identity(320, 320), "infsup_");
  const long objects = shown("eps", [&] { ways.iterated(); });
  EXPECT_EQ(objects, rank_of(PETSC_COMM_WORLD) == 0 ? 2 : 0) << "beta_HF and c_HF";
  RBVI_CALL(PetscOptionsSetValue(nullptr, "-infsup_eps_max_it", "1"));
  RBVI_CALL(PetscOptionsSetValue(nullptr, "-infsup_eps_ncv", "3"));
  std::string message;
  try {
    ways.iterated();
  } catch (const Error &error) {
    message = error.what();
  }
  RBVI_CALL(PetscOptionsClearValue(nullptr, "-infsup_eps_max_it"));
  RBVI_CALL(PetscOptionsClearValue(nullptr, "-infsup_eps_ncv"));
  EXPECT_NE(message.find("raise -infsup_eps_max_it"), std::string::npos) << message;
}

TEST(ReducedDisks, ASingleSampleReturnsItself) {
  Reduced r(make_scene("two_disks"), "grid:1");
  for (const ConeType type : {ConeType::cpg, ConeType::mcpg, ConeType::angle_greedy, ConeType::nmf,
                              ConeType::nodal, ConeType::hybrid}) {
    SCOPED_TRACE(cone_type_names()[static_cast<std::size_t>(type)]);
    r.reduce(with(type));
    EXPECT_EQ(r.model.body.modes, 1);
    EXPECT_GE(r.model.contact.generators, 1);
    expect_samples_returned(r, 1e-9, 1e-7);
  }
}

/// Every snapshot twice: there are no more generators than different snapshots.
TEST(ReducedDisks, AGreedyStopsAtTheRankOfItsSnapshots) {
  Reduced r(make_scene("two_disks"), "grid:3");
  const std::vector<Sample> once = r.samples;
  r.samples.insert(r.samples.end(), once.begin(), once.end());
  for (const ConeType type : {ConeType::cpg, ConeType::mcpg, ConeType::angle_greedy}) {
    SCOPED_TRACE(cone_type_names()[static_cast<std::size_t>(type)]);
    r.reduce(with(type, 0, 0));
    EXPECT_EQ(r.model.body.modes, 3);
    EXPECT_EQ(r.model.contact.generators, 3);
    EXPECT_TRUE(r.bases.cone.history.reason == "round-off reached" ||
                r.bases.cone.history.reason == "tolerance reached")
        << r.bases.cone.history.reason;
    EXPECT_LE(r.errors_at(r.samples).lambda.maxCoeff(), 1e-7);
  }
}

/// The blocks of the patch test, drawn apart by 0.04: below that indentation nothing touches.
Scene blocks_apart() {
  Scene scene = make_scene("patch");
  scene.map = [touching = scene.map](const FullMu &mu, const Point &x) {
    Point image = touching(mu, x);
    if (x[1] > 0) image[1] += 0.04;
    return image;
  };
  return scene;
}

TEST(ReducedBlocks, SamplesWithoutContactTakePart) {
  Reduced r(blocks_apart(), "grid:7"); // indentation 0.01, 0.025, 0.04 (just touching), ..., 0.1
  EXPECT_EQ(r.samples.front().lambda.norm(), 0);
  EXPECT_GT(r.samples.back().lambda.minCoeff(), 0);
  for (const ConeType type : {ConeType::mcpg, ConeType::nodal, ConeType::hybrid}) {
    SCOPED_TRACE(cone_type_names()[static_cast<std::size_t>(type)]);
    r.reduce(with(type));
    EXPECT_EQ(r.model.body.modes, 1) << "u is proportional to the approach that is left";
    EXPECT_EQ(r.model.contact.free_modes, 0) << "no node is always in contact";
    OnlineSolver online(r.model, r.problem.scene());
    for (const double indentation : {0.01, 0.03, 0.039, 0.041, 0.07, 0.1}) {
      const ReducedAnswer answer = online.solve({indentation});
      const double pressure = 15 * 0.65 / (1.35 * 0.3) * std::max(0.0, indentation - 0.04);
      const Vector lambda = online.multiplier(answer);
      EXPECT_LE((lambda.array() - pressure).abs().maxCoeff(), 1e-8) << indentation;
      const Outputs out = online.outputs({indentation}, answer);
      EXPECT_NEAR(*out.normal_force, pressure, 1e-8);
      EXPECT_LE(*out.max_penetration, 1e-9);
    }
  }
}

/// One direction of u and one of lambda: a model of one mode is exact. Every node is always in
/// contact, so that a hybrid cone is modes alone.
TEST(ReducedBlocks, OfThePatchTestAreExact) {
  Reduced r(make_scene("patch"), "grid:3");
  for (const ConeType type : {ConeType::mcpg, ConeType::hybrid}) {
    r.reduce(with(type));
    EXPECT_EQ(r.model.body.modes, 1);
    EXPECT_EQ(r.model.contact.generators, 1);
    EXPECT_EQ(r.model.contact.free_modes, type == ConeType::hybrid ? 1 : 0);
    const std::vector<Sample> unseen = solve_all(r.problem, {{0.0123}, {0.077}});
    const ModelErrors errors = r.errors_at(unseen);
    EXPECT_LE(errors.u.maxCoeff(), 1e-10);
    EXPECT_LE(errors.lambda.maxCoeff(), 1e-10);
  }
}

TEST(ReducedDisks, WithoutAnyContactThereIsNoModel) {
  Reduced r(make_scene("two_disks", {{"initial_gap", "0.5"}}), "grid:2");
  try {
    r.reduce({});
    FAIL() << "accepted";
  } catch (const Error &error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos);
    EXPECT_NE(message.find("no contact"), std::string::npos) << message;
  }
}

/// Between nine random radii the edge of contact moves further than a ring of one layer.
TEST(TwoDisks, AHybridConeWidensUntilEveryRandomQueryIsAnswered) {
  Reduced r(make_scene("two_disks"), "random:9:1");
  const ReduceOptions options = with(ConeType::hybrid, 1e-3, 1e-3);
  const Reduction made = reduce(r.problem, r.samples, options);
  EXPECT_GT(made.ring, options.cone.ring);
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank == 0) {
    EXPECT_TRUE(made.model.made.self_check.clean());
    EXPECT_EQ(made.model.made.self_check.queries, 202);
  }
  const Sample truth = solve_all(r.problem, {{0.8}}).front();
  OnlineSolver online(made.model);
  const Outputs found = online.outputs({0.8}, online.solve({0.8}));
  EXPECT_NEAR(*found.normal_force, *truth.outputs.normal_force, 1e-2 * *truth.outputs.normal_force);
}

} // namespace
} // namespace rbvi::two_disks_test
