#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/finish.hpp"

#include <gtest/gtest.h>

namespace rbvi::finish_test {
namespace {

int rank_in_world() {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}

int last_rank() {
  int size = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size - 1;
}

struct Finished {
  int status;
  std::string err; ///< of this rank
};

Finished finished(const std::function<void()> &work) {
  testing::internal::CaptureStderr();
  const int status = finish(MPI_COMM_WORLD, work);
  return {status, testing::internal::GetCapturedStderr()};
}

TEST(Finish, SuccessIsSilent) {
  const Finished run = finished([] {});
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.err, "");
}

TEST(Finish, AFailureOfAllRanksIsPrintedOnce) {
  const Finished run =
      finished([] { collectively(MPI_COMM_WORLD, [] { throw bad_input("no such scene"); }); });
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.err, rank_in_world() == 0 ? "rbvi: no such scene\n" : "");
}

TEST(Finish, AFailureOfOneRankIsPrintedByItAndIsTheStatusOfAll) {
  const Finished run = finished([] {
    if (rank_in_world() == last_rank()) throw bad_input("the last rank's file is missing");
  });
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.err,
            rank_in_world() == last_rank() ? "rbvi: the last rank's file is missing\n" : "");
}

TEST(Finish, OtherExceptionsAreFailures) {
  const Finished run = finished([] { throw std::bad_alloc(); });
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err.empty(), rank_in_world() != 0) << run.err;
}

/// Ends the whole job: run from outside by the tests of the binary.
TEST(Finish, DISABLED_ARankLeavesTheOthersWaiting) {
  (void)finish(MPI_COMM_WORLD, [] {
    if (rank_in_world() == last_rank()) throw failure("this rank is lost");
    MPI_Barrier(MPI_COMM_WORLD);
    int ready = rank_in_world();
    MPI_Bcast(&ready, 1, MPI_INT, last_rank(), MPI_COMM_WORLD);
  });
  FAIL() << "all ranks should have been ended";
}

Invocation invocation(std::vector<std::string> words) {
  std::vector<char *> pointers;
  for (std::string &word : words)
    pointers.push_back(word.data());
  return read_invocation(static_cast<int>(pointers.size()), pointers.data());
}

TEST(ReadInvocation, CommandFileAndOptions) {
  const Invocation offline = invocation({"rbvi", "offline", "--case", "c.yaml", "-load", "-20"});
  EXPECT_FALSE(offline.status.has_value());
  EXPECT_EQ(offline.command, "offline");
  EXPECT_EQ(offline.arguments,
            (std::vector<std::string>{"rbvi", "-case", "c.yaml", "-load", "-20"}));
  EXPECT_EQ(offline.pointers().back(), nullptr);
  EXPECT_EQ(invocation({"rbvi", "inspect", "m.h5"}).file, "m.h5");
  EXPECT_EQ(invocation({"rbvi", "run", "c.yaml", "-train", "4"}).arguments,
            (std::vector<std::string>{"rbvi", "-case", "c.yaml", "-train", "4"}));
  const Invocation runs = invocation({"rbvi", "compare", "a", "b/model.h5", "--csv", "c.csv"});
  EXPECT_EQ(runs.files, (std::vector<std::string>{"a", "b/model.h5"}));
  EXPECT_EQ(runs.topic, "c.csv");
  EXPECT_EQ(runs.arguments.size(), 1U);
  EXPECT_EQ(invocation({"rbvi", "solve", "--help"}).command, "help");
  EXPECT_EQ(invocation({"rbvi", "solve", "--help"}).topic, "solve");
  EXPECT_EQ(invocation({"rbvi"}).command, "help");
  EXPECT_FALSE(invocation({"rbvi", "-help"}).json);
  EXPECT_TRUE(invocation({"rbvi", "--help", "--json"}).json);
  EXPECT_EQ(invocation({"rbvi", "--version"}).status, 0);
}

TEST(ReadInvocation, MistakesOfTheCommand) {
  const std::vector<std::string> wrong[] = {{"rbvi", "oflfine"},
                                            {"rbvi", "offline", "c.yaml"},
                                            {"rbvi", "solve", "-mu", "1", "2"},
                                            {"rbvi", "inspect"},
                                            {"rbvi", "inspect", "a", "b"},
                                            {"rbvi", "inspect", "a", "-b"},
                                            {"rbvi", "compare", "a"},
                                            {"rbvi", "compare", "a", "b", "-mu", "1"},
                                            {"rbvi", "run", "a", "b"},
                                            {"rbvi", "list", "all", "more"},
                                            {"rbvi", "list", "-all"},
                                            {"rbvi", "solve", "-mu", "1", "--mu", "2"},
                                            {"rbvi", "-case", "c.yaml", "offline"}};
  for (const auto &words : wrong)
    EXPECT_EQ(invocation(words).status, 2) << words.back();
}

} // namespace
} // namespace rbvi::finish_test
