// Reduced models of two bodies: contact operators assembled online, outputs and files.
#include "../contact/curves.hpp"
#include "../core/refuses.hpp"
#include "files.hpp"
#include "synthetic_pair.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/model/print.hpp"
#include "tests/catalogue.hpp"

namespace rbvi::two_bodies_test {
namespace {

using synthetic::p0;
using synthetic::p1;
using synthetic::PairSizes;
using synthetic::scene_with;

const std::vector<Mu> radii{{0.7}, {0.83}, {1}, {1.3}};

/// Returns at how many radii there is contact.
int expect_agreement(const ReducedModel &model, const Scene &scene) {
  int touching = 0;
  OnlineSolver solver(model, scene);
  for (const Mu &mu : radii) {
    const ReducedAnswer solution = solver.solve(mu);
    const brute::Operators o = synthetic::pair_operators(model, scene, mu);
    const brute::PairAnswer exact = brute::brute_force_pair(o, model.contact.free_modes);
    touching += exact.x.norm() > 0;
    EXPECT_LE((solution.u - exact.u).norm(), 1e-10 * exact.u.norm());
    EXPECT_LE((solution.lambda - exact.x).norm(), 1e-9 * exact.x.norm());
    EXPECT_NEAR(solution.energy, 0.5 * exact.u.dot(o.a * exact.u), 1e-10 * solution.energy);
    EXPECT_LE(solution.residual, 1e-11);
  }
  return touching;
}

TEST(OnlinePair, AgreesWithDenseOperatorsAndBruteForce) {
  for (const std::string multiplier : {"p0", "p1"})
    for (const std::string integration : {"intersection", "direct"}) {
      const Scene scene = scene_with(multiplier, integration);
      int touching = 0;
      for (unsigned seed = 0; seed < 4; ++seed)
        touching += expect_agreement(synthetic::random_pair_model({}, seed, scene), scene);
      EXPECT_GE(touching, 12);
    }
}

TEST(OnlinePair, WorksWithoutAMotion) {
  Scene scene = make_scene("two_disks", {{"degree", "1"}, {"initial_gap", "-0.1"}});
  scene.motion = nullptr;
  EXPECT_GT(expect_agreement(synthetic::random_pair_model({}, 1, scene), scene), 0);
}

/// Rows that no generator touches are left out of the online products: an answer does not change.
TEST(OnlinePair, RowsThatNoGeneratorTouchesDoNotMatter) {
  ReducedModel model = synthetic::random_pair_model({4, 3, 2}, 3, p1());
  model.contact.dual_basis.topRows(2).setZero();
  model.contact.dual_basis.bottomRows(4).setZero();
  EXPECT_EQ(expect_agreement(model, p1()), 4);
}

/// Free modes close the gap whatever the sign; where they pull, the answer is refused.
TEST(OnlinePair, FreeModesAreEquations) {
  int answered = 0, refused = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    ReducedModel model = synthetic::random_pair_model({5, 3, 4}, seed, p0());
    model.contact.free_modes = 2;
    OnlineSolver solver(model, p0());
    for (const Mu &mu : radii) {
      const brute::Operators o = synthetic::pair_operators(model, p0(), mu);
      const brute::PairAnswer exact = brute::brute_force_pair(o, 2);
      const Vector pressure = model.contact.dual_basis * exact.x;
      if (pressure.minCoeff() < -0.01 * pressure.maxCoeff()) {
        EXPECT_THROW(solver.solve(mu), Error);
        ++refused;
        continue;
      }
      const ReducedAnswer solution = solver.solve(mu);
      EXPECT_LE((solution.lambda - exact.x).norm(), 1e-9 * exact.x.norm());
      EXPECT_LE((o.b * solution.u - o.g).tail(2).norm(), 1e-10 * o.g.norm());
      ++answered;
    }
  }
  EXPECT_GT(answered, 5);
  EXPECT_GT(refused, 5);
}

/// The space of a query is V_N + S_R(mu), S_R(mu) spanned by the rows of B(mu) among the
/// supremizers.
TEST(OnlinePair, OnlineEnrichmentFollowsTheOperatorOfTheQuery) {
  ReducedModel model = synthetic::random_pair_model({3, 6, 3}, 4, p0());
  model.body.online_enriched = true;
  OnlineSolver solver(model, p0());
  for (const Mu &mu : radii) {
    brute::Operators o = synthetic::pair_operators(model, p0(), mu);
    Matrix space = Matrix::Zero(9, 6);
    space.topLeftCorner(3, 3).setIdentity();
    space.bottomRightCorner(6, 3) = o.b.rightCols(6).transpose();
    const brute::Operators small{space.transpose() * o.a * space, o.b * space, Vector::Zero(6),
                                 o.g};
    const brute::PairAnswer exact = brute::brute_force_pair(small);
    const ReducedAnswer solution = solver.solve(mu);
    EXPECT_LE((solution.u - space * exact.u).norm(), 1e-9 * solution.u.norm());
    EXPECT_LE((solution.lambda - exact.x).norm(), 1e-9 * exact.x.norm());
  }
}

TEST(OnlinePair, TheContactGapIsThatOfTheDeformedCurves) {
  const ReducedModel model = synthetic::random_pair_model({}, 5, p0());
  OnlineSolver solver(model, p0());
  for (const Mu &mu : radii) {
    const ReducedAnswer solution = solver.solve(mu);
    const Vector w = solver.field(solution), gap = solver.contact_gap(solution);
    const FullMu all = expand(p0().parameters, mu);
    std::vector<Point> slave, master;
    const auto &[curves, nodes] = model.contact.interfaces.front();
    for (std::size_t i = 0; i < curves.points.size(); ++i) {
      const Point &x = curves.points[i];
      Point moved = p0().map(all, x);
      moved[1] += p0().motion(all, x)[1] + w[2 * nodes[i] + 1];
      (static_cast<int>(i) < curves.parts[0] ? slave : master).push_back(moved);
    }
    const std::vector<Index> paired = synthetic::mapped_pair(model, p0(), all).paired;
    ASSERT_EQ(gap.size(), static_cast<Index>(paired.size()));
    for (Index k = 0; k < gap.size(); ++k) {
      const Point &x = slave[paired[std::size_t(k)]];
      EXPECT_NEAR(gap[k], x[1] - height_at(master, x[0]), 1e-12);
    }
    const Outputs outputs = solver.outputs(mu, solution);
    EXPECT_EQ(*outputs.max_penetration, std::max(0.0, -gap.minCoeff()));
  }
}

/// A quarter is computed: force, energy and contact length are those of both images, the pressure
/// is not doubled.
TEST(OnlinePair, OutputsAreOfTheWholeDisks) {
  const ReducedModel model = synthetic::random_pair_model({}, 6, p0());
  Scene quarter = p0();
  quarter.mirrors.clear();
  OnlineSolver whole_solver(model, p0()), quarter_solver(model, quarter);
  const Mu mu{0.9};
  const ReducedAnswer solution = whole_solver.solve(mu);
  const Outputs whole = whole_solver.outputs(mu, solution),
                part = quarter_solver.outputs(mu, quarter_solver.solve(mu));
  EXPECT_EQ(*whole.energy, 2 * *part.energy);
  EXPECT_EQ(*whole.normal_force, 2 * *part.normal_force);
  EXPECT_EQ(*whole.contact_measure, 2 * *part.contact_measure);
  EXPECT_EQ(*whole.peak_pressure, *part.peak_pressure);
  const Vector lambda = model.contact.dual_basis * solution.lambda;
  EXPECT_EQ(*part.energy, solution.energy);
  EXPECT_NEAR(*part.normal_force, lambda.dot(solution.contact.weights), 1e-14 * *part.normal_force);
  EXPECT_EQ(*part.peak_pressure, lambda.maxCoeff());
  EXPECT_NEAR(*part.contact_measure, solution.contact.weights.sum(), 1e-14)
      << "lambda > 0 everywhere";
  EXPECT_FALSE(whole.min_u);
}

TEST(OnlinePair, ACurveThatDoesNotFitTheMultipliersIsRefused) {
  ReducedModel model = synthetic::random_pair_model({}, 7, p0());
  EXPECT_THROW(OnlineSolver(model, p1()), Error);
  EXPECT_THROW(OnlineSolver(model, make_scene("membrane_obstacle")), Error);
  ReducedModel one_body = synthetic::random_model({}, 7);
  EXPECT_THROW(OnlineSolver(one_body, p0()), Error);
  EXPECT_NO_THROW((OnlineSolver(one_body)));
  one_body.contact.b = one_body.contact.g = {};
  EXPECT_THROW((OnlineSolver(one_body)), Error) << "its b separates";
  EXPECT_NO_THROW(OnlineSolver(model, p0()));
  model.contact.b = model.body.a;
  EXPECT_NO_THROW(check_model(model)) << "of a scene whose b separates it might be";
  EXPECT_TRUE(refuses("does not fit its scene", [&] { OnlineSolver(model, p0()); }));
}

TEST(PrintPairModel, SaysThatTheContactOperatorsAreAssembledOnline) {
  const ReducedModel model = synthetic::random_pair_model({}, 7, p0());
  std::ostringstream out;
  print_model(out, model);
  EXPECT_NE(out.str().find("assembled for each mu on 12 + 9 contact nodes"), std::string::npos)
      << out.str();
  EXPECT_EQ(out.str().find("terms of b"), std::string::npos) << out.str();
}

TEST(CheckPairModel, NamesWhatDoesNotFit) {
  const auto complaint = [](auto change) -> std::string {
    ReducedModel model = synthetic::random_pair_model({}, 8, p0());
    change(model);
    try {
      check_model(model);
    } catch (const Error &error) {
      return error.what();
    }
    return "";
  };
  const auto expect_complaint = [&](const std::string &part, auto change) {
    const std::string message = complaint(change);
    EXPECT_NE(message.find(part), std::string::npos) << part << ": " << message;
  };
  using M = ReducedModel;
  EXPECT_EQ(complaint([](M &) {}), "");
  expect_complaint("g has terms and b has not", [](M &m) { m.contact.g = m.body.a; });
  expect_complaint("contact/trace", [](M &m) { m.contact.trace.conservativeResize(21, 6); });
  expect_complaint("contact/dual_basis",
                   [](M &m) { m.contact.dual_basis.conservativeResize(5, 3); });
  expect_complaint("contact/dual_basis", [](M &m) { m.contact.dual_basis(0, 0) = std::nan(""); });
  expect_complaint("fields/primal_basis", [](M &m) { m.fields.basis.conservativeResize(46, 6); });
}

TEST(CheckPairModel, NamesTheMemberOfAnInterface) {
  const auto complaint = [](auto change) -> std::string {
    ReducedModel model = synthetic::random_pair_model({}, 8, p0());
    change(model.contact.interfaces.front());
    try {
      check_model(model);
    } catch (const Error &error) {
      return error.what();
    }
    return "";
  };
  const auto expect_complaint = [&](const std::string &member, auto change) {
    const std::string message = complaint(change);
    EXPECT_NE(message.find("interfaces/0/" + member), std::string::npos)
        << member << ": " << message;
  };
  using I = InterfaceModel;
  EXPECT_EQ(complaint([](I &) {}), "");
  EXPECT_NE(complaint([](I &i) { i.mesh.dim = 4; }), "");
  expect_complaint("sizes", [](I &i) { i.mesh.degree = 3; });
  expect_complaint("sizes", [](I &i) { i.mesh.components = 0; });
  expect_complaint("sizes", [](I &i) { i.mesh.per_entity = 1; });
  expect_complaint("dofs", [](I &i) { i.mesh.columns = 20; });
  expect_complaint("points", [](I &i) { i.mesh.points[3][1] = std::nan(""); });
  expect_complaint("entities", [](I &i) { i.mesh.entities.clear(); });
  expect_complaint("entities", [](I &i) { i.mesh.entities.pop_back(); });
  expect_complaint("entities", [](I &i) { i.mesh.entities[5] = 21; });
  expect_complaint("entities", [](I &i) { i.mesh.entities[5] = -1; });
  expect_complaint("edges", [](I &i) { i.mesh.edges.assign(18, 0); });
  expect_complaint("edges", [](I &i) { i.mesh.edges.assign(19, 3); });
  expect_complaint("parts", [](I &i) { i.mesh.parts = {12, 8}; });
  expect_complaint("parts", [](I &i) { i.mesh.parts = {22, -1}; });
  expect_complaint("dofs", [](I &i) { i.mesh.dofs.pop_back(); });
  expect_complaint("dofs", [](I &i) { i.mesh.dofs[1] = 21; });
  expect_complaint("dofs", [](I &i) { i.mesh.dofs[1] = -2; });
  expect_complaint("nodes", [](I &i) { i.nodes.pop_back(); });
  expect_complaint("nodes", [](I &i) { i.nodes[0] = 23; });
  expect_complaint("nodes", [](I &i) { i.nodes[0] = -1; });
}

/// What is consistent and yet no pair of curves is bad input of the kind of contact.
TEST(OnlinePair, AnInterfaceThatIsNoPairIsRefused) {
  const auto expect_refusal = [](const std::string &part, auto change) {
    ReducedModel model = synthetic::random_pair_model({}, 8, p0());
    change(model.contact.interfaces.front().mesh);
    EXPECT_NO_THROW(check_model(model));
    EXPECT_TRUE(refuses(part, [&] { OnlineSolver(model, p0()); }));
  };
  using M = InterfaceMesh;
  expect_refusal("the edges of the slave curve do not go",
                 [](M &m) { std::swap(m.entities[0], m.entities[1]); });
  expect_refusal("of its 11 nodes", [](M &m) { m.parts = {11, 10}; });
  expect_refusal("the master curve needs at least one edge", [](M &m) { m.parts = {21}; });
  expect_refusal("x must increase along the slave",
                 [](M &m) { std::swap(m.points[4], m.points[5]); });
  expect_refusal("move vertically", [](M &m) { m.dofs[5] = -1; });
}

/// The leading pair has the leading columns of the trace and of the dual basis; there is nothing of
/// b to cut.
TEST(LeadingPair, AnswersLikeItsOwnDenseOperators) {
  const ReducedModel model = synthetic::random_pair_model({4, 3, 4}, 9, p0());
  for (const auto &[n, r] : {std::pair{7, 4}, std::pair{6, 3}, std::pair{4, 2}}) {
    const ReducedModel part = leading(model, n, r);
    check_model(part);
    EXPECT_EQ(part.contact.interfaces.front().mesh.parts,
              model.contact.interfaces.front().mesh.parts);
    EXPECT_EQ(part.body.modes, 4);
    EXPECT_EQ(part.body.supremizers, n - 4);
    EXPECT_EQ(part.contact.trace, model.contact.trace.leftCols(n));
    EXPECT_EQ(part.contact.dual_basis, model.contact.dual_basis.leftCols(r));
    EXPECT_EQ(expect_agreement(part, p0()), 4);
  }
}

struct PairFile : InOwnDirectory {};

TEST_F(PairFile, ReturnsTheModel) {
  for (const Scene &scene : {p0(), p1()}) {
    const ReducedModel model = synthetic::random_pair_model({}, 10, scene);
    write_model(model, directory / "model.h5");
    const ReducedModel copy = read_model(directory / "model.h5", catalogue()),
                       bare = read_model(directory / "model.h5", catalogue(), false);
    EXPECT_TRUE(copy.evaluates_contact());
    EXPECT_TRUE(synthetic::same(copy.contact.interfaces, model.contact.interfaces));
    EXPECT_TRUE(synthetic::same(bare.contact.interfaces, model.contact.interfaces));
    EXPECT_EQ(copy.scene.options, scene.options);
    EXPECT_EQ(copy.contact.dual_basis, model.contact.dual_basis);
    EXPECT_EQ(copy.contact.trace, model.contact.trace);
    EXPECT_EQ(copy.contact.b.size(), 0);
    EXPECT_EQ(copy.contact.g.size(), 0);
    OnlineSolver from_file(copy), without_fields(bare), original(model);
    const ReducedAnswer solution = from_file.solve({0.77});
    EXPECT_EQ(solution.u, original.solve({0.77}).u);
    EXPECT_EQ(solution.u, without_fields.solve({0.77}).u);
    EXPECT_EQ(from_file.contact_gap(solution), without_fields.contact_gap(solution));
    EXPECT_THROW(without_fields.field(solution), Error);
  }
}

} // namespace
} // namespace rbvi::two_bodies_test
