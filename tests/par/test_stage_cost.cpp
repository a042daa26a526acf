#include "rbvi/par/stage_cost.hpp"

#include "rbvi/par/collective.hpp"
#include "rbvi/par/petsc.hpp"
#include "rbvi/par/stage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <ctime>
#include <memory>

namespace rbvi::stage_cost_test {
namespace {

constexpr double megabyte = 1e6;

struct StageCosts : testing::Test {
  StageCosts() { measure_costs(); }
};

/// Takes memory from the system and gives it back.
void use_memory(double bytes) {
  const auto size = static_cast<std::size_t>(bytes);
  const std::unique_ptr<char[]> memory(new char[size]);
  std::memset(memory.get(), 1, size);
  volatile char *kept = memory.get();
  ASSERT_EQ(kept[size / 2], 1);
}

TEST_F(StageCosts, MemoryThatIsGivenBackWasUsed) {
  const CostMeter outer;
  {
    const CostMeter first;
    use_memory(200 * megabyte);
    EXPECT_GE(first.so_far().memory, 200 * megabyte);
  }
  {
    const CostMeter second;
    const double resident = resident_bytes();
    use_memory(20 * megabyte);
    EXPECT_LE(second.so_far().memory, resident + 60 * megabyte) << "what was before counts";
  }
  EXPECT_GE(outer.so_far().memory, 200 * megabyte) << "what was within does not count";
}

TEST_F(StageCosts, TheCpuWorksWhileTimePasses) {
  const CostMeter meter;
  const std::clock_t start = std::clock();
  while (std::clock() - start < CLOCKS_PER_SEC / 20) {
  }
  const StageCost cost = meter.so_far();
  EXPECT_GE(cost.cpu, 0.045);
  EXPECT_LE(cost.cpu, 1.5 * cost.seconds + 0.05) << "one thread";
}

TEST_F(StageCosts, MessagesAndReductionsAreThoseOfPetsc) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  const int rank = rank_of(world), ranks = ranks_of(world);
  Handle<Vec> x;
  RBVI_CALL(VecCreateMPI(world, 5, PETSC_DETERMINE, x.put()));
  RBVI_CALL(VecSet(x.get(), 1));
  const CostMeter meter;
  double dot = 0, mine = rank, theirs = -1;
  RBVI_CALL(VecDot(x.get(), x.get(), &dot));
  EXPECT_EQ(dot, 5.0 * ranks);
  MPI_Request requests[2];
  MPI_Irecv(&theirs, 1, MPI_DOUBLE, (rank + ranks - 1) % ranks, 0, world, &requests[0]);
  MPI_Isend(&mine, 1, MPI_DOUBLE, (rank + 1) % ranks, 0, world, &requests[1]);
  MPI_Waitall(2, requests, MPI_STATUSES_IGNORE);
  const StageCost cost = meter.so_far();
  EXPECT_EQ(cost.reductions, ranks > 1 ? 1 : 0);
  EXPECT_EQ(cost.messages, 1);
  EXPECT_EQ(cost.bytes, 8);
}

/// -u'' on n nodes of this rank.
Handle<Mat> laplacian(PetscInt n) {
  Handle<Mat> a;
  RBVI_CALL(MatCreateSeqAIJ(PETSC_COMM_SELF, n, n, 3, nullptr, a.put()));
  for (PetscInt i = 0; i < n; ++i)
    for (PetscInt j = std::max<PetscInt>(i - 1, 0); j <= std::min(i + 1, n - 1); ++j)
      RBVI_CALL(MatSetValue(a.get(), i, j, i == j ? 2 : -1, INSERT_VALUES));
  RBVI_CALL(MatAssemblyBegin(a.get(), MAT_FINAL_ASSEMBLY));
  RBVI_CALL(MatAssemblyEnd(a.get(), MAT_FINAL_ASSEMBLY));
  return a;
}

/// Solves a system twice; the steps of both solves together.
PetscInt solve_twice(KSPType ksp_type, PCType pc_type) {
  const Handle<Mat> a = laplacian(40);
  Handle<KSP> ksp;
  Handle<Vec> f, u;
  PC pc = nullptr;
  RBVI_CALL(MatCreateVecs(a.get(), u.put(), f.put()));
  RBVI_CALL(KSPCreate(PETSC_COMM_SELF, ksp.put()));
  RBVI_CALL(KSPSetOperators(ksp.get(), a.get(), a.get()));
  RBVI_CALL(KSPSetType(ksp.get(), ksp_type));
  RBVI_CALL(KSPGetPC(ksp.get(), &pc));
  RBVI_CALL(PCSetType(pc, pc_type));
  PetscInt all = 0;
  for (const PetscInt place : {3, 17}) {
    PetscInt steps = 0;
    RBVI_CALL(VecSet(f.get(), 0));
    RBVI_CALL(VecSetValue(f.get(), place, 1, INSERT_VALUES));
    RBVI_CALL(KSPSolve(ksp.get(), f.get(), u.get()));
    RBVI_CALL(KSPGetIterationNumber(ksp.get(), &steps));
    all += steps;
  }
  return all;
}

TEST_F(StageCosts, FactorisationsSolvesAndStepsAreCounted) {
  const CostMeter direct;
  solve_twice(KSPPREONLY, PCCHOLESKY);
  const StageCost cost = direct.so_far();
  EXPECT_EQ(cost.symbolic, 1);
  EXPECT_EQ(cost.factorisations, 1);
  EXPECT_EQ(cost.solves, 2);
  EXPECT_EQ(cost.cg_steps, 0);
  EXPECT_LE(cost.factor_seconds + cost.solve_seconds, cost.seconds);
  const CostMeter iterative;
  const PetscInt steps = solve_twice(KSPCG, PCJACOBI);
  EXPECT_NEAR(iterative.so_far().cg_steps, static_cast<double>(steps), 2);
  EXPECT_EQ(iterative.so_far().factorisations, 0);
}

TEST_F(StageCosts, RunsOfAStageAddUpButNotTheirMemory) {
  constexpr StageName work("work");
  StageTable table{{work, "to do"}};
  for (const double bytes : {100 * megabyte, 10 * megabyte})
    timed(table, work, [&] {
      use_memory(bytes);
      solve_twice(KSPPREONLY, PCCHOLESKY);
    });
  const StageCost cost = table[0].cost.value();
  EXPECT_EQ(cost.factorisations, 2);
  EXPECT_GE(cost.memory, 100 * megabyte);
  EXPECT_LE(cost.memory, resident_bytes() + 150 * megabyte);
  EXPECT_LE(cost.seconds, table[0].seconds.value());
  EXPECT_EQ(finished_stages(table, table)[0].cost->factorisations, 2);
}

TEST_F(StageCosts, OverTheRanks) {
  const int rank = rank_of(PETSC_COMM_WORLD), ranks = ranks_of(PETSC_COMM_WORLD);
  StageCost cost;
  cost.seconds = 1 + rank;
  cost.messages = 3;
  const RankCosts all = costs_over_ranks(PETSC_COMM_WORLD, cost);
  EXPECT_EQ(all.largest.seconds, ranks);
  EXPECT_EQ(all.sum.seconds, ranks * (ranks + 1) / 2.0);
  EXPECT_EQ(all.sum.messages, 3 * ranks);
  EXPECT_EQ(all.sum.memory, 0);
}

} // namespace
} // namespace rbvi::stage_cost_test
