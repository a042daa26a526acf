#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace rbvi::collective_test {
namespace {

int rank_in_world() {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}

int ranks_in_world() {
  int size = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size;
}

TEST(Collectively, RunsTheWorkOnceAndReturns) {
  int runs = 0;
  EXPECT_NO_THROW(collectively(MPI_COMM_WORLD, [&] { ++runs; }));
  EXPECT_EQ(runs, 1);
}

TEST(Collectively, OneRanksFailureIsEveryRanksFailure) {
  for (int culprit = 0; culprit < ranks_in_world(); ++culprit) {
    try {
      collectively(MPI_COMM_WORLD, [&] {
        if (rank_in_world() == culprit)
          throw bad_input("no such file, rank " + std::to_string(culprit));
      });
      FAIL() << "nothing was thrown";
    } catch (const Error &error) {
      EXPECT_EQ(error.status(), Status::bad_input);
      EXPECT_EQ(std::string(error.what()), "no such file, rank " + std::to_string(culprit));
    }
  }
}

TEST(Collectively, TheLowestFailingRankSpeaks) {
  try {
    collectively(MPI_COMM_WORLD, [] { throw failure("rank " + std::to_string(rank_in_world())); });
    FAIL() << "nothing was thrown";
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::failed);
    EXPECT_EQ(std::string(error.what()), "rank 0");
  }
}

TEST(Collectively, OtherExceptionsAndEmptyMessagesArrive) {
  const int last = ranks_in_world() - 1;
  EXPECT_THROW(collectively(MPI_COMM_WORLD,
                            [&] {
                              if (rank_in_world() == last) (void)std::vector<int>{}.at(1);
                            }),
               Error);
  EXPECT_THROW(collectively(MPI_COMM_WORLD,
                            [&] {
                              if (rank_in_world() == last) throw failure("");
                            }),
               Error);
  EXPECT_THROW(collectively(MPI_COMM_WORLD,
                            [&] {
                              if (rank_in_world() == last) throw 1;
                            }),
               Error);
}

} // namespace
} // namespace rbvi::collective_test
