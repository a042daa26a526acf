// The compliance on the contact dofs by a Schur complement: what solves for its columns give.
#include "../linear_algebra.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/complement.hpp"
#include "rbvi/solve/contact_cost.hpp"
#include "rbvi/solve/methods.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

namespace rbvi::complement_test {
namespace {

double relative(const Matrix &got, const Matrix &expected) {
  return (got - expected).norm() / expected.norm();
}

Mu centre(const ParameterSpace &space) {
  Mu mu;
  for (int i = 0; i < space.size(); ++i)
    mu.push_back((space.at(i).lower + space.at(i).upper) / 2);
  return mu;
}

TEST(Complement, IsTheInverseOfTheCompliance) {
  for (const std::string name : {"two_disks", "rigid_disk", "roller"}) {
    SCOPED_TRACE(name);
    Problem problem(PETSC_COMM_WORLD, make_scene(name), {});
    const Trace &trace = problem.trace();
    const Mat a = problem.assemble(centre(problem.scene().parameters)).a;
    const Matrix units = Matrix::Identity(trace.size, trace.size);
    const Matrix solved = ResponseSolver(a, trace, "hf_").responses(units);
    const Matrix made = compliance_by_complement(a, trace);
    EXPECT_LE(relative(made, solved), 1e-11);
    EXPECT_EQ((made - made.transpose()).norm(), 0);
    EXPECT_GT(symmetric_eigenvalues(made)[0], 0);
  }
}

/// On the dofs that they touch alone, where dofs repeat, and where no complement pays.
TEST(Complement, CondensesLoads) {
  Problem problem(PETSC_COMM_WORLD, make_scene("two_disks"), {});
  const Mat a = problem.assemble({1.0}).a;
  Trace twice = problem.trace();
  const Index size = twice.size;
  for (std::size_t k = 0; k < problem.trace().index.size(); ++k) {
    twice.local_row.push_back(problem.trace().local_row[k]);
    twice.index.push_back(static_cast<PetscInt>(size) + problem.trace().index[k]);
  }
  twice.size *= 2;
  PetscInt dofs = 0;
  RBVI_CALL(MatGetSize(a, &dofs, nullptr));
  for (const Index count : {Index{4}, size / 2}) {
    Matrix loads = Matrix::Zero(2 * size, count);
    for (Index k = 0; k < count; ++k) {
      loads(k, k) = 1 + 0.1 * static_cast<double>(k);
      loads(size + k, k) = -0.5; // the same dof once more
      loads(size + (k + 7) % size, k) = 0.25;
    }
    ResponseSolver solver(a, twice, "hf_");
    const Matrix expected = loads.transpose() * solver.responses(loads);
    EXPECT_LE(relative(condensed_by_loads(a, twice, "hf_", loads), expected), 1e-11) << count;
    EXPECT_LE(relative(condensed_by_loads(a, twice, "hf_", loads, &solver), expected), 1e-11);
  }
  EXPECT_FALSE(complement_pays(dofs, static_cast<PetscInt>(size), 4, true));
  EXPECT_TRUE(complement_pays(dofs, static_cast<PetscInt>(size), static_cast<double>(size), true));
  EXPECT_EQ(condensed_by_loads(a, twice, "hf_", Matrix(2 * size, 0)).size(), 0);
}

TEST(Complement, NeedsAPositiveDefiniteMatrix) {
  Problem problem(PETSC_COMM_WORLD, make_scene("two_disks"), {});
  Handle<Mat> negative;
  RBVI_CALL(MatDuplicate(problem.assemble({1.0}).a, MAT_COPY_VALUES, negative.put()));
  RBVI_CALL(MatScale(negative.get(), -1));
  EXPECT_THROW(compliance_by_complement(negative.get(), problem.trace()), Error);
}

TEST(Complement, IsNotTakenWhereContactIsARegionOrSolvesIterate) {
  Problem membrane(PETSC_COMM_WORLD, make_scene("membrane_obstacle"), {"", 1});
  Problem disks(PETSC_COMM_WORLD, make_scene("two_disks"), {});
  EXPECT_FALSE(takes_complement(membrane, membrane.trace().size / 2.0));
  EXPECT_TRUE(takes_complement(disks, disks.trace().size / 2.0));
  RBVI_CALL(PetscOptionsSetValue(nullptr, "-hf_pc_type", "gamg"));
  EXPECT_FALSE(takes_complement(disks, disks.trace().size / 2.0));
  RBVI_CALL(PetscOptionsClearValue(nullptr, "-hf_pc_type"));
}

/// Groups of ranks that share the columns have the compliance that each makes alone.
TEST(Complement, IsSharedByGroups) {
  const Groups groups(PETSC_COMM_WORLD, 1);
  Problem problem(groups.comm(), make_scene("two_disks"), {});
  const Mat a = problem.assemble({1.0}).a;
  FactoredBody shared(nullptr, problem.trace(), ColumnsLast::for_all_mu),
      own(nullptr, problem.trace(), ColumnsLast::for_all_mu);
  shared.set(a);
  own.set(a);
  shared.require_all(&groups);
  own.require_all();
  ASSERT_EQ(shared.count(), problem.trace().size);
  for (Index dof = 0; dof < shared.count(); ++dof)
    EXPECT_LE((shared.column(dof) - own.column(dof)).norm(), 1e-12 * own.column(dof).norm());
}

} // namespace
} // namespace rbvi::complement_test
