// Runs GoogleTest on every rank. Rank 0 prints as usual; the others print their failures, marked
// with their rank; the status is that of the worst rank.
#include "rbvi/mor/published/reductions.hpp"
#include "rbvi/par/session.hpp"

#include <gtest/gtest.h>

#include <iostream>

namespace {

class OtherRankPrinter : public testing::EmptyTestEventListener {
public:
  explicit OtherRankPrinter(int rank) : rank_(rank) {}
  void OnTestPartResult(const testing::TestPartResult &result) override {
    if (result.failed())
      std::cerr << "[rank " << rank_ << "] " << (result.file_name() ? result.file_name() : "?")
                << ":" << result.line_number() << ": " << result.summary() << "\n";
  }

private:
  int rank_;
};

} // namespace

int main(int argc, char **argv) {
  testing::InitGoogleTest(&argc, argv);
  const rbvi::Session session(argc, argv);
  rbvi::add_published_reductions();
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank != 0) {
    auto &listeners = testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new OtherRankPrinter(rank));
  }
  int status = RUN_ALL_TESTS();
  MPI_Allreduce(MPI_IN_PLACE, &status, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD);
  return status;
}
