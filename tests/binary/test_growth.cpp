// rbvi bench -bench_growth: what offline takes over meshes and ranks per solve.
#include "run.hpp"

#include <map>
#include <set>

namespace rbvi::growth_test {
namespace {

using Row = std::map<std::string, std::string>;

struct Growth : InDirectory {
  static double value(const Row &row, const std::string &name) {
    return parse_number(row.at(name), name);
  }

  static std::vector<Row> rows_of(const fs::path &table) {
    std::istringstream lines(slurp(table));
    std::string line;
    std::getline(lines, line);
    const std::vector<std::string> names = split(line, ',');
    std::vector<Row> rows;
    while (std::getline(lines, line)) {
      const std::vector<std::string> entries = split(line, ',');
      EXPECT_EQ(entries.size(), names.size()) << line;
      Row row;
      for (std::size_t i = 0; i < std::min(names.size(), entries.size()); ++i)
        row[names[i]] = entries[i];
      rows.push_back(row);
    }
    return rows;
  }

  /// The rows of a stage.
  static std::vector<Row> of_stage(const std::vector<Row> &rows, const std::string &stage) {
    std::vector<Row> found;
    for (const Row &row : rows)
      if (row.at("stage") == stage) found.push_back(row);
    return found;
  }
};

TEST_F(Growth, EveryStageOfEveryMeshAndGrouping) {
  const std::string out =
      output_of(rbvi(2, "bench -case case.yaml -bench_growth 0,1 -train random:3:1 -out grown"));
  EXPECT_TRUE(contains(out, "dofs, 1 rank per solve: ")) << out;
  EXPECT_TRUE(contains(out, "dofs, 2 ranks per solve: ")) << out;
  const std::vector<Row> rows = rows_of("grown/bench/growth.csv");
  const std::vector<Row> totals = of_stage(rows, "total"), snapshots = of_stage(rows, "snapshots");
  ASSERT_EQ(totals.size(), 4U); // two meshes, each by 1 and by 2 ranks per solve
  ASSERT_EQ(snapshots.size(), 4U);
  EXPECT_GT(value(totals[2], "dofs"), 3 * value(totals[0], "dofs"));
  for (const Row &row : totals) {
    EXPECT_EQ(row.at("samples"), "3");
    EXPECT_GT(value(row, "model_mb"), 0);
  }
  for (const Row &row : rows) {
    EXPECT_GE(value(row, "memory_max_mb"), 0.9 * value(row, "resident_mb")) << row.at("stage");
    EXPECT_GE(value(row, "memory_sum_mb"), value(row, "memory_max_mb"));
    EXPECT_GE(value(row, "messages"), value(row, "messages_max"));
    EXPECT_GE(value(row, "cpu_sum"), value(row, "cpu_max"));
  }
  for (const Row &row : snapshots)
    EXPECT_GE(value(row, "factorisations"), 1);
  for (const std::size_t mesh : {0U, 2U})
    EXPECT_GT(value(snapshots[mesh + 1], "reductions"), value(snapshots[mesh], "reductions"))
        << "ranks that share solves have more to say to each other";
}

TEST_F(Growth, NothingButTheTableIsLeft) {
  output_of(rbvi(1, "bench -case case.yaml -bench_growth 0 -train random:2:1 -out grown"));
  std::set<std::string> files;
  for (const auto &entry : fs::recursive_directory_iterator("grown"))
    files.insert(entry.path().string());
  EXPECT_EQ(files, (std::set<std::string>{"grown/bench", "grown/bench/growth.csv"}));
}

TEST_F(Growth, OneNumberOfRanksPerSolveWhereItIsAskedFor) {
  output_of(rbvi(2, "bench -case case.yaml -bench_growth 0 -train random:2:1 -out grown "
                    "-sweep_ranks_per_solve 2"));
  const std::vector<Row> totals = of_stage(rows_of("grown/bench/growth.csv"), "total");
  ASSERT_EQ(totals.size(), 1U);
  EXPECT_EQ(totals[0].at("ranks_per_solve"), "2");
}

} // namespace
} // namespace rbvi::growth_test
