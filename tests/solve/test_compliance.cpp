// The condensed operator that is kept while B alone changes: the same as the one made anew, and
// every column of E^T A^-1 E solved for once.
#include "../linear_algebra.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/solve/methods.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <set>

namespace rbvi::compliance_test {
namespace {

/// A direct solver that counts its right-hand sides.
class CountingSolver {
public:
  explicit CountingSolver(Mat a) : inner_(make_direct_solver(comm_of(a), "hf_")) {
    RBVI_CALL(KSPSetOperators(inner_.get(), a, a));
    RBVI_CALL(KSPCreate(comm_of(a), ksp_.put()));
    RBVI_CALL(KSPSetType(ksp_.get(), KSPPREONLY));
    RBVI_CALL(KSPSetOperators(ksp_.get(), a, a));
    PC pc = nullptr;
    RBVI_CALL(KSPGetPC(ksp_.get(), &pc));
    RBVI_CALL(PCSetType(pc, PCSHELL));
    RBVI_CALL(PCShellSetContext(pc, this));
    RBVI_CALL(PCShellSetApply(pc, [](PC shell, Vec x, Vec y) -> PetscErrorCode {
      void *context = nullptr;
      PetscFunctionBegin;
      PetscCall(PCShellGetContext(shell, &context));
      auto *self = static_cast<CountingSolver *>(context);
      ++self->solves_;
      PetscCall(KSPSolve(self->inner_.get(), x, y));
      PetscFunctionReturn(0);
    }));
  }
  CountingSolver(const CountingSolver &) = delete;
  CountingSolver &operator=(const CountingSolver &) = delete;
  KSP get() const { return ksp_.get(); }
  int solves() const { return solves_; }

private:
  static MPI_Comm comm_of(Mat a) { return PetscObjectComm(reinterpret_cast<PetscObject>(a)); }
  Handle<KSP> inner_, ksp_;
  int solves_ = 0;
};

std::set<Index> contact_dofs(const SparseMatrix &b, const std::vector<Index> &rows) {
  std::set<Index> dofs;
  for (const Index row : rows)
    for (SparseMatrix::InnerIterator entry(b, row); entry; ++entry)
      dofs.insert(entry.col());
  return dofs;
}

double relative(const Matrix &got, const Matrix &expected) {
  return (got - expected).norm() / expected.norm();
}

class CompliancePerSpace : public testing::TestWithParam<const char *> {};
INSTANTIATE_TEST_SUITE_P(Multipliers, CompliancePerSpace, testing::Values("p0", "p1"));

TEST_P(CompliancePerSpace, GivesTheCondensedColumnsAtEveryParameter) {
  Problem problem(PETSC_COMM_WORLD,
                  make_scene("two_disks", {{"degree", "1"}, {"multiplier", GetParam()}}), {});
  const Trace &trace = problem.trace();
  const CountingSolver solver(problem.assemble({0.7}).a);
  FactoredBody kept(solver.get(), trace, ColumnsLast::for_all_mu),
      once(solver.get(), trace, ColumnsLast::for_one_b);
  std::set<Index> seen;
  // More rows than one block of right-hand sides; repeated, reordered and overlapping ones; rows
  // without a partner at small radii; none.
  std::vector<Index> many;
  for (Index i = 0; i < 66; ++i)
    many.push_back(i);
  const std::vector<std::pair<double, std::vector<Index>>> requests{
      {0.7, {3, 4, 10}}, {0.7, {10, 3}}, {1.3, {4, 11, 12}}, {0.7, {279}}, {1.0, many}, {0.9, {}}};
  for (const auto &[radius, which] : requests) {
    const Operators &op = problem.assemble({radius});
    const std::set<Index> wanted = contact_dofs(op.b, which);
    const std::size_t before = seen.size();
    seen.insert(wanted.begin(), wanted.end());
    const int solves = solver.solves();
    kept.set(op.a);
    const Matrix columns = condensed_columns(kept, op.b, which);
    EXPECT_EQ(solver.solves() - solves, static_cast<int>(seen.size() - before)) << radius;
    once.set(op.a);
    const Matrix expected = condensed_columns(once, op.b, which);
    ASSERT_EQ(columns.rows(), expected.rows());
    ASSERT_EQ(columns.cols(), expected.cols());
    if (expected.norm() > 0)
      EXPECT_LE(relative(columns, expected), 1e-11) << radius;
    else
      EXPECT_EQ(columns.norm(), 0);
  }
  EXPECT_GT(seen.size(), 128U);
}

/// B A^-1 B^T is symmetric and positive definite on the multipliers that have a partner.
TEST_P(CompliancePerSpace, TheCondensedOperatorIsSymmetric) {
  Problem problem(PETSC_COMM_WORLD,
                  make_scene("two_disks", {{"degree", "1"}, {"multiplier", GetParam()}}), {});
  const Operators &op = problem.assemble({0.7});
  const Handle<KSP> ksp = make_direct_solver(problem.comm(), "hf_");
  RBVI_CALL(KSPSetOperators(ksp.get(), op.a, op.a));
  std::vector<Index> which;
  for (Index i = 0; i < 280 && op.weights[i] > 0; i += 7)
    which.push_back(i);
  FactoredBody kept(ksp.get(), problem.trace(), ColumnsLast::for_all_mu);
  kept.set(op.a);
  const Matrix block = condensed_columns(kept, op.b, which)(which, Eigen::all);
  EXPECT_LE((block - block.transpose()).norm(), 1e-12 * block.norm());
  EXPECT_GT(symmetric_eigenvalues(block)[0], 0);
}

/// A sweep with the kept operator finds what single solves find, at far fewer solves.
TEST(ComplianceOfASweep, ChangesNoAnswer) {
  Scene every_time = make_scene("two_disks");
  every_time.a = {mapped_term(
      elasticity("", every_time.materials[0].of_cell, every_time.degree))}; // nothing is kept
  Problem with(PETSC_COMM_WORLD, make_scene("two_disks"), {}),
      without(PETSC_COMM_WORLD, every_time, {});
  HighFidelity keeps(with, {}), forgets(without, {});
  for (const double radius : {1.3, 0.7, 1.0}) {
    const HfSolution kept = keeps.solve({radius}), anew = forgets.solve({radius});
    EXPECT_EQ(kept.active, anew.active);
    EXPECT_LE((kept.lambda - anew.lambda).norm(), 1e-10 * anew.lambda.norm());
    EXPECT_LE((kept.u - anew.u).norm(), 1e-11 * anew.u.norm());
  }
}

/// Groups that share columns find what each finds alone, and what they share is enough: no more
/// columns are solved for.
TEST(ComplianceOfASweep, IsSharedAmongGroups) {
  const std::vector<Mu> set{{1.2}, {0.8}, {0.75}, {1.05}, {0.9}, {1.3}, {0.7}, {1.0}};
  const Groups groups(PETSC_COMM_WORLD, 1);
  for (const std::string friction : {"none", "coulomb"}) {
    Problem problem(groups.comm(), make_scene("rigid_disk", {{"friction", friction}}), {});
    HighFidelity shares(problem, {}), alone(problem, {});
    shares.share_columns(groups, set);
    for (std::size_t k = static_cast<std::size_t>(groups.mine()); k < set.size();
         k += static_cast<std::size_t>(groups.count())) {
      const HfSolution found = shares.solve(set[k]), expected = alone.solve(set[k]);
      EXPECT_EQ(found.active, expected.active);
      EXPECT_LE((found.lambda - expected.lambda).norm(), 1e-10 * expected.lambda.norm());
      EXPECT_LE((found.u - expected.u).norm(), 1e-11 * expected.u.norm());
    }
  }
}

/// The same columns for any number of groups, each once; those that are there are not made again.
TEST(ComplianceOfASweep, SharedColumnsAreThoseOfOneGroup) {
  const Groups groups(PETSC_COMM_WORLD, 1);
  Problem problem(groups.comm(), make_scene("two_disks"), {});
  const Trace &trace = problem.trace();
  const CountingSolver solver(problem.assemble({1.0}).a);
  const Mat a = problem.assemble({1.0}).a;
  std::vector<Index> few, many;
  for (Index dof = 0; dof < 140; ++dof)
    (dof % 3 == 0 ? few : many).push_back(dof);
  FactoredBody shared(solver.get(), trace, ColumnsLast::for_all_mu),
      own(solver.get(), trace, ColumnsLast::for_all_mu);
  shared.set(a);
  own.set(a);
  shared.require(few);
  const int before = solver.solves();
  std::vector<Index> all = few;
  all.insert(all.end(), many.begin(), many.end());
  shared.require(all, groups);
  const int share = static_cast<int>(many.size()) / groups.count();
  EXPECT_GE(solver.solves() - before, share);
  EXPECT_LE(solver.solves() - before, share + 1);
  own.require(all);
  for (const Index dof : all)
    EXPECT_LE(relative(shared.column(dof), own.column(dof)), 1e-12) << dof;
}

} // namespace
} // namespace rbvi::compliance_test
