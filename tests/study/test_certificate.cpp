// Bounds of reduced answers against true errors: of good models, and of models that are wrong on
// purpose.
#include "disk.hpp"
#include "rbvi/model/certificate.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/mor/certificate.hpp"
#include "rbvi/study/effectivity.hpp"
#include "reduced.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace rbvi::certificate_study_test {
namespace {

using namespace testing_reduced;

ReduceOptions certified(MultiplierReduction reduction) {
  ReduceOptions options = with(reduction);
  options.certify = true;
  return options;
}

struct Case {
  std::string name, free;
  SceneOptions options;
  MultiplierReduction reduction = MultiplierReduction::condensed;
  bool bound = true; ///< else an indicator
};

const SceneOptions without{{"friction", "none"}};
const std::vector<Case> cases{{"frictionless", "radius,indentation", without},
                              {"stiffness", "radius,core_stiffness", without},
                              {"poisson", "radius,poisson_ratio", without},
                              {"tresca", "radius,indentation", {{"friction", "tresca"}}},
                              {"coulomb",
                               "radius,indentation",
                               {{"friction", "coulomb"}},
                               MultiplierReduction::condensed,
                               false},
                              {"cone", "radius,indentation", without, MultiplierReduction::cone}};

void PrintTo(const Case &c, std::ostream *out) {
  *out << c.name;
}

class OfDisk : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Cases, OfDisk, testing::ValuesIn(cases),
                         [](const auto &info) { return info.param.name; });

/// `width`: of the intervals of the energy at most, over it.
void expect_bounds(const Effectivities &found, const Case &c, double width) {
  const bool bound = c.bound, frictionless = c.options == without;
  EXPECT_EQ(found.wrong, 0);
  EXPECT_EQ(found.without, 0);
  std::vector<double> values = bound ? found.values : found.indicators;
  ASSERT_FALSE(values.empty());
  EXPECT_TRUE((bound ? found.indicators : found.values).empty());
  std::ranges::sort(values);
  if (bound) EXPECT_GE(values.front(), 1 - 1e-4) << "the error is known to 1e-8 of u";
  EXPECT_LE(values[values.size() / 2], 2);
  EXPECT_LE(values.back(), 3);
  EXPECT_EQ(found.widths.size(), frictionless ? 3U : 0U) << "energy, normal_force, reaction";
  if (frictionless) EXPECT_LE(found.widths.at("energy"), width);
  // Of first order where that of the energy is of second.
  if (frictionless) EXPECT_LE(found.widths.at("normal_force"), 10 * std::sqrt(width));
}

double energy_norm(Problem &problem, const Mu &mu, const Vector &u) {
  const Handle<Vec> x = from_natural(problem.dofs(), u);
  Handle<Vec> product;
  PetscScalar square = 0;
  RBVI_CALL(VecDuplicate(x.get(), product.put()));
  RBVI_CALL(MatMult(problem.assemble(mu).a, x.get(), product.get()));
  RBVI_CALL(VecDot(x.get(), product.get(), &square));
  return std::sqrt(std::max(0.0, square));
}

} // namespace

TEST_P(OfDisk, BoundsWhatTheModelLeaves) {
  const Case &c = GetParam();
  Reduced r(disk(c.free, c.options), "grid:2,2");
  r.reduce(certified(c.reduction));
  ASSERT_TRUE(r.model.certificate.exists());
  const auto unseen = solve_all(r.problem, parse_set(r.problem.scene().parameters, "random:8:3"));
  const Effectivities good = effectivities(r.problem, r.model, unseen);
  expect_bounds(good, c, c.reduction == MultiplierReduction::cone ? 0.02 : 1e-3);
  // Half of the functions of the displacement alone: the error is large, and told.
  const ReducedModel poor =
      leading(r.model, std::max(3, r.model.body.modes / 2), r.model.contact.generators);
  expect_bounds(effectivities(r.problem, poor, unseen), c, 0.3);
}

/// Any displacement and any multipliers have a bound, so those of a model that lost a node or whose
/// stiffness is off.
TEST_P(OfDisk, BoundsWhatIsWrongOnPurpose) {
  const Case &c = GetParam();
  if (!c.bound) return;
  Reduced r(disk(c.free, c.options), "grid:2,2");
  r.reduce(certified(c.reduction));
  OnlineSolver solver(r.model);
  for (const Sample &sample :
       solve_all(r.problem, parse_set(r.problem.scene().parameters, "random:4:5"))) {
    const ReducedAnswer answer = solver.solve(sample.mu, true);
    const Vector lambda = solver.multiplier(answer);
    Vector dropped = lambda, alternating = answer.u;
    Index peak = 0;
    lambda.head(solver.contact().nodes()).maxCoeff(&peak);
    dropped[peak] = 0;
    for (Index i = 0; i < alternating.size(); ++i)
      alternating[i] *= i % 2 == 0 ? 1.3 : 0.7;
    const std::vector<std::pair<Vector, Vector>> wrong{{answer.u, dropped},
                                                       {answer.u, 1.3 * lambda},
                                                       {1.3 * answer.u, lambda},
                                                       {0 * answer.u, 0 * lambda},
                                                       {alternating, lambda}};
    for (const auto &[u, l] : wrong) {
      ReducedAnswer other = answer;
      other.u = u;
      const auto bound = bound_of(r.model, r.problem.scene(), solver.contact(), other, l, 0, false);
      ASSERT_TRUE(bound);
      const double error = energy_norm(r.problem, sample.mu, sample.u - solver.field(other)),
                   size = energy_norm(r.problem, sample.mu, sample.u);
      EXPECT_GE(bound->error, error - 1e-8 * size);
      EXPECT_LE(bound->error, 3 * size);
    }
  }
}

} // namespace rbvi::certificate_study_test
