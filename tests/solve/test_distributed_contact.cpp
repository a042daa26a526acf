// Answers do not depend on whether contact interfaces are gathered, nor on the number of ranks.
#include "rbvi/solve/methods.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

namespace rbvi::distributed_contact_test {
namespace {

HfSolution solve(MPI_Comm comm, Index gather, const Scene &scene, const Mu &mu,
                 const HfOptions &options) {
  Problem problem(comm, scene, {}, gather);
  HighFidelity solver(problem, options);
  (void)solver.solve(mu);
  return solver.solve(mu); // again: what was kept is right, too
}

void expect_one_answer(const Scene &scene, const Mu &mu, const HfOptions &options) {
  const HfSolution alone = solve(PETSC_COMM_SELF, default_contact_gather, scene, mu, options);
  for (const Index gather : {Index{0}, Index{1} << 20}) {
    SCOPED_TRACE("gathered up to " + std::to_string(gather));
    const HfSolution shared = solve(PETSC_COMM_WORLD, gather, scene, mu, options);
    EXPECT_LE((shared.u - alone.u).norm(), 1e-10 * alone.u.norm());
    EXPECT_LE((shared.lambda - alone.lambda).norm(), 1e-10 * alone.lambda.norm());
    EXPECT_EQ(shared.active, alone.active);
    EXPECT_EQ(shared.iterations, alone.iterations);
    EXPECT_NEAR(shared.kkt.largest(), alone.kkt.largest(), 1e-12 + 1e-4 * alone.kkt.largest());
    for (const auto member : {&Outputs::energy, &Outputs::normal_force, &Outputs::contact_measure,
                              &Outputs::peak_pressure, &Outputs::max_penetration})
      EXPECT_NEAR(*(shared.outputs.*member), *(alone.outputs.*member),
                  1e-10 * (1 + std::abs(*(alone.outputs.*member))));
  }
}

TEST(DistributedContact, AnswersDoNotDependOnGathering) {
  const SceneOptions coarse{{"arc_edges", "60"}};
  const Scene membrane = make_scene("membrane_obstacle", {{"circle_edges", "36"}}),
              disk = make_scene("rigid_disk", coarse), roller = make_scene("roller"),
              discs = make_scene("two_disks", coarse);
  HfOptions uzawa;
  uzawa.method = HfMethod::uzawa;
  uzawa.uzawa.accelerated = true;
  uzawa.uzawa.tolerance = 1e-2; // as many steps on any number of ranks, not an answer
  for (const HfOptions &options : {HfOptions{}, uzawa}) {
    expect_one_answer(membrane, {0.17, -0.03, 0.05}, options);
    expect_one_answer(disk, {1.1}, options);
    expect_one_answer(roller, {0.03, 0.1}, options);
    expect_one_answer(discs, {1.1}, options);
  }
}

TEST(DistributedContact, NorDoThoseOfBoundsAtNodes) {
  HfOptions vi;
  vi.method = HfMethod::vi;
  expect_one_answer(make_scene("membrane_obstacle", {{"lumped", "yes"}}), {0.17, -0.03, 0.05}, vi);
  expect_one_answer(make_scene("roller", {{"lumped", "yes"}, {"friction", "none"}}), {0.02, 0.01},
                    vi);
}

/// Both ways to measure the residual, at multipliers that are no answer.
TEST(DistributedContact, TheResidualOverTheRanksIsThatOfOne) {
  for (const std::string name : {"membrane_obstacle", "roller"}) {
    Problem problem(PETSC_COMM_WORLD, make_scene(name), {});
    const Mu mu = name == "roller" ? Mu{0.03, 0.1} : Mu{0.17, -0.03, 0.05};
    const Operators &op = problem.assemble(mu);
    const Vector lambda = Vector::NullaryExpr(
        problem.dual_size(), [](Index i) { return std::cos(static_cast<double>(i)); });
    const Vector field = Vector::LinSpaced(problem.dofs().total, -1, 1);
    const Handle<Vec> u = from_natural(problem.dofs(), field),
                      l = distribute(problem.dual_layout(), lambda);
    const KktResidual whole = kkt_residual(problem.trace(), op, u.get(), lambda);
    const KktResidual shared =
        kkt_residual(distribute(problem.dual_layout(), op, op.laws), op, u.get(), l.get());
    for (const auto part :
         {&KktResidual::stationarity, &KktResidual::feasibility, &KktResidual::complementarity,
          &KktResidual::sign, &KktResidual::friction})
      EXPECT_NEAR(shared.*part, whole.*part, 1e-12 * std::abs(whole.*part));
    EXPECT_GT(whole.sign, 0.1);
    EXPECT_EQ(whole.friction > 0, name == "roller");
  }
}

} // namespace
} // namespace rbvi::distributed_contact_test
