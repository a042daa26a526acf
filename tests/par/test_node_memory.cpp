// What is free on the machine, and in the control groups of a process.
#include "rbvi/par/node_memory.hpp"

#include "rbvi/par/collective.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

namespace rbvi::node_memory_test {
namespace {

namespace fs = std::filesystem;

struct Groups : testing::Test {
  fs::path root = fs::path(testing::TempDir()) / ("rbvi_groups_" + std::to_string(getpid()));
  void TearDown() override { fs::remove_all(root); }

  void write(const fs::path &file, const std::string &text) const {
    fs::create_directories((root / file).parent_path());
    std::ofstream(root / file) << text;
  }
  /// Of a process in these groups.
  double left(const std::string &groups) const {
    write("groups", groups);
    return left_by_groups(root / "groups", root);
  }
};

TEST_F(Groups, ABoundOfTheGroupOrOfOneAboveIt) {
  write("job/memory.max", "5000\n");
  write("job/memory.current", "1000\n");
  write("job/step/memory.max", "max\n");
  write("job/step/memory.current", "900\n");
  EXPECT_EQ(left("0::/job/step\n"), 4000);
  write("job/step/memory.max", "3000\n");
  EXPECT_EQ(left("0::/job/step\n"), 2100);
  write("job/step/memory.stat", "anon 600\ninactive_file 300\nactive_file 0\n");
  EXPECT_EQ(left("0::/job/step\n"), 2400) << "a cache that can be dropped is free";
}

TEST_F(Groups, TheFirstVersionOfGroups) {
  write("memory/job/memory.limit_in_bytes", "7000\n");
  write("memory/job/memory.usage_in_bytes", "4000\n");
  write("memory/job/memory.stat", "inactive_file 1\ntotal_inactive_file 500\n");
  EXPECT_EQ(left("5:cpu:/job\n4:memory:/job\n0::/\n"), 3500);
}

TEST_F(Groups, WithoutABoundTheyLeaveEverything) {
  EXPECT_TRUE(std::isinf(left("0::/nowhere\n")));
  EXPECT_TRUE(std::isinf(left("")));
  EXPECT_TRUE(std::isinf(left_by_groups(root / "missing", root)));
}

TEST(NodeMemory, IsThatOfTheRanksOfThisMachine) {
  const NodeMemory node = tightest_node(PETSC_COMM_WORLD);
  EXPECT_EQ(node.ranks, ranks_of(PETSC_COMM_WORLD));
  EXPECT_GT(node.bytes, 1e6);
  EXPECT_LE(node.bytes, left_by_groups() * 1.5);
}

} // namespace
} // namespace rbvi::node_memory_test
