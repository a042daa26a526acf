// Responses by a factor on every rank and by one that the ranks share.
#include "rbvi/fem/problem.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/response_solver.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rbvi::response_solver_test {
namespace {

struct Disk {
  Problem problem{PETSC_COMM_WORLD, make_scene("rigid_disk", {{"arc_edges", "40"}}), {}};
  Mat a = problem.assemble({1.0}).a;
};

/// Without a pattern, the same on all ranks.
Matrix loads_on(const Trace &trace, Index columns) {
  Matrix loads(trace.size, columns);
  for (Index k = 0; k < columns; ++k)
    for (Index i = 0; i < loads.rows(); ++i)
      loads(i, k) = std::sin(static_cast<double>(1 + i * i + 7 * k));
  return loads;
}

/// What of the fields of one way is not in those of the other, relative.
double difference(Mat x, Mat y) {
  PetscReal size = 0, rest = 0;
  Handle<Mat> copy;
  RBVI_CALL(MatDuplicate(x, MAT_COPY_VALUES, copy.put()));
  RBVI_CALL(MatNorm(x, NORM_FROBENIUS, &size));
  RBVI_CALL(MatAXPY(copy.get(), -1, y, SAME_NONZERO_PATTERN));
  RBVI_CALL(MatNorm(copy.get(), NORM_FROBENIUS, &rest));
  return rest / size;
}

TEST(ResponseSolver, SharedFactorsGiveTheSame) {
  Disk disk;
  const Trace &trace = disk.problem.trace();
  ResponseSolver whole(disk.a, trace, "hf_", Factors::whole),
      shared(disk.a, trace, "hf_", Factors::shared);
  for (const Index columns : {Index{1}, Index{5}, Index{300}}) { // more than are solved at a time
    const Matrix loads = loads_on(trace, columns);
    const Matrix expected = whole.responses(loads), found = shared.responses(loads);
    EXPECT_LE((found - expected).norm(), 1e-12 * expected.norm());
    const Handle<Mat> of_whole = whole.fields(loads), of_shared = shared.fields(loads);
    EXPECT_LE(difference(of_whole.get(), of_shared.get()), 1e-12);
    EXPECT_LE((shared.restrict(of_shared.get()) - expected).norm(), 1e-12 * expected.norm());
    const Handle<Mat> back = extension(trace, loads, disk.a);
    Handle<Mat> residual;
    RBVI_CALL(
        MatMatMult(disk.a, of_shared.get(), MAT_INITIAL_MATRIX, PETSC_DEFAULT, residual.put()));
    EXPECT_LE(difference(back.get(), residual.get()), 1e-10) << "A times the fields";
  }
}

/// What the first A was ordered by serves another one of its pattern.
TEST(ResponseSolver, AnotherMatrixIsFactorisedAnew) {
  Disk disk;
  const Trace &trace = disk.problem.trace();
  const Matrix loads = loads_on(trace, 3);
  Handle<Mat> other;
  RBVI_CALL(MatDuplicate(disk.a, MAT_COPY_VALUES, other.put()));
  RBVI_CALL(MatShift(other.get(), 10));
  for (const Factors factors : {Factors::whole, Factors::shared}) {
    ResponseSolver solver(disk.a, trace, "hf_", factors);
    const Matrix first = solver.responses(loads);
    solver.set(other.get());
    const Matrix expected = ResponseSolver(other.get(), trace, "hf_", factors).responses(loads);
    EXPECT_LE((solver.responses(loads) - expected).norm(), 1e-12 * expected.norm());
    EXPECT_GT((first - expected).norm(), 0.1 * expected.norm());
    solver.set(disk.a);
    EXPECT_LE((solver.responses(loads) - first).norm(), 1e-12 * first.norm());
  }
}

/// Loads on a dof that is listed twice add up.
TEST(ResponseSolver, DofsMayRepeat) {
  Disk disk;
  const Trace &once = disk.problem.trace();
  const Index size = once.size;
  Trace twice = once;
  twice.local_row.insert(twice.local_row.end(), once.local_row.begin(), once.local_row.end());
  for (const PetscInt dof : once.index)
    twice.index.push_back(once.size + dof);
  twice.size *= 2;
  const Matrix loads = loads_on(twice, 3);
  for (const Factors factors : {Factors::whole, Factors::shared}) {
    const Matrix found = ResponseSolver(disk.a, twice, "hf_", factors).responses(loads);
    const Matrix expected =
        ResponseSolver(disk.a, once, "hf_").responses(loads.topRows(size) + loads.bottomRows(size));
    EXPECT_LE((found.topRows(size) - expected).norm(), 1e-12 * expected.norm());
    EXPECT_LE((found.bottomRows(size) - expected).norm(), 1e-12 * expected.norm());
  }
}

TEST(ResponseSolver, FactorsThatFitAreWhole) {
  const bool alone = ranks_of(PETSC_COMM_WORLD) == 1;
  EXPECT_TRUE(factors_fit(PETSC_COMM_WORLD, 10000));
  EXPECT_EQ(factors_fit(PETSC_COMM_WORLD, std::numeric_limits<PetscInt>::max()), alone);
}

} // namespace
} // namespace rbvi::response_solver_test
