// The space of the responses of a body whose stiffness is a sum of exact terms, against a
// factorisation at parameters that were not in it.
#include "rbvi/core/error.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/mor/condensed.hpp"
#include "rbvi/mor/response_space.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/response_solver.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::response_space_test {
namespace {

Scene disk() {
  Scene scene = make_scene("rigid_disk", {{"arc_edges", "20"}});
  scene.parameters = free_only(scene.parameters, "core_stiffness,poisson_ratio");
  return scene;
}

const std::vector<Mu> unseen{{0.3, 0.21}, {0.9, 0.33}, {4.7, 0.44}, {2.2, 0.28}};
constexpr int core_stiffness = 3, poisson_ratio = 4;

std::vector<GridAxis> axes() {
  return {{core_stiffness, std::log(0.2), std::log(5)},
          {poisson_ratio, std::log(0.1), std::log(0.6)}};
}

/// Unit forces at some contact dofs.
Matrix unit_loads(const Problem &problem, Index count) {
  Matrix loads = Matrix::Zero(problem.trace().size, count);
  for (Index i = 0; i < count; ++i)
    loads(i * loads.rows() / count, i) = 1;
  return loads;
}

/// One mode: the response to all of them together.
LinearBasis one_mode(Problem &problem, const Matrix &loads) {
  ResponseSolver solver(problem.assemble({1, 0.3}).a, problem.trace(), "hf_");
  const Handle<Mat> fields = solver.fields(loads.rowwise().sum());
  Handle<Vec> column;
  RBVI_CALL(MatCreateVecs(fields.get(), nullptr, column.put()));
  RBVI_CALL(MatGetColumnVector(fields.get(), column.get(), 0));
  return std::move(pod({column.get()}, problem.v_product(), {}).basis);
}

double worst_compliance(Problem &problem, const Matrix &loads, const LinearBasis &basis) {
  const ReducedResponses reduced(problem, loads, basis);
  double worst = 0;
  for (const Mu &mu : unseen) {
    ResponseSolver solver(problem.assemble(mu).a, problem.trace(), "hf_");
    const Matrix exact = loads.transpose() * solver.responses(loads);
    const Matrix found = reduced.compliance(expand(problem.scene().parameters, mu));
    worst = larger(worst, (found - exact).norm() / exact.norm());
  }
  return worst;
}

const FullMu all{1, 0.09, 0.2, 1, 0.35, 0};

TEST(ResponseSpace, HoldsTheResponsesAtUnseenParameters) {
  Problem problem(PETSC_COMM_WORLD, disk(), {});
  const Matrix loads = unit_loads(problem, 36), weights = Matrix::Identity(36, 36);
  double before = 1;
  int points = 0;
  for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
    LinearBasis basis = one_mode(problem, loads);
    const ResponseSpace space =
        append_responses(problem, loads, weights, {axes(), all, tolerance, 100}, basis);
    EXPECT_LE(space.left, tolerance * 1e4) << "the last point was worth taking";
    EXPECT_EQ(basis.size(), 1 + space.functions);
    EXPECT_GT(space.points, points);
    points = space.points;
    const double error = worst_compliance(problem, loads, basis);
    EXPECT_LE(error, 100 * tolerance * tolerance + 1e-12)
        << "the square of the error of the responses; " << tolerance;
    EXPECT_LE(error, before);
    before = error;
  }
}

TEST(ResponseSpace, DoesNotDependOnTheNumberOfRanks) {
  Problem world(PETSC_COMM_WORLD, disk(), {}), alone(PETSC_COMM_SELF, disk(), {});
  std::vector<ResponseSpace> spaces;
  std::vector<Matrix> found;
  for (Problem *problem : {&world, &alone}) {
    const Matrix loads = unit_loads(*problem, 30);
    LinearBasis basis = one_mode(*problem, loads);
    spaces.push_back(append_responses(*problem, loads, Matrix::Identity(30, 30),
                                      {axes(), all, 1e-4, 100}, basis));
    found.push_back(ReducedResponses(*problem, loads, basis)
                        .compliance(expand(problem->scene().parameters, unseen.front())));
  }
  EXPECT_EQ(spaces[0].points, spaces[1].points);
  EXPECT_EQ(spaces[0].functions, spaces[1].functions);
  EXPECT_LE((found[0] - found[1]).norm(), 1e-10 * found[0].norm());
}

TEST(ResponseSpace, TooFewPointsAreSaid) {
  Problem problem(PETSC_COMM_WORLD, disk(), {});
  const Matrix loads = unit_loads(problem, 4);
  LinearBasis basis = one_mode(problem, loads);
  testing::internal::CaptureStderr();
  const ResponseSpace space =
      append_responses(problem, loads, Matrix::Identity(4, 4), {axes(), all, 1e-9, 3}, basis);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_EQ(space.points, 3);
  EXPECT_GT(space.left, 1e-9);
  EXPECT_EQ(said.find("only after 3 factorisations") != std::string::npos,
            rank_of(PETSC_COMM_WORLD) == 0);
}

} // namespace
} // namespace rbvi::response_space_test
