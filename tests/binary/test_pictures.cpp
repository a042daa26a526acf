// What cases/figures.py draws from whole runs, and that every command says what it wrote.
#include "run.hpp"

namespace rbvi::pictures_test {
namespace {

struct Pictures : InDirectory {
  /// Each figure as PNG and as PDF.
  static void expect_drawn(const std::vector<std::string> &names) {
    for (const std::string &name : names) {
      const std::string path = "run/figures/" + name;
      EXPECT_TRUE(slurp(path + ".png").starts_with("\x89PNG")) << name;
      EXPECT_TRUE(slurp(path + ".pdf").starts_with("%PDF")) << name;
    }
  }
};

TEST_F(Pictures, OfAMembraneWithItsBench) {
  const std::string offline = output_of(rbvi(2, "offline -case case.yaml -out run"));
  EXPECT_TRUE(contains(offline, "\nwrote run/model.h5, run/model.fields.h5, run/samples.csv,"))
      << offline;
  EXPECT_TRUE(contains(verified(), "\nwrote run/verify, run/model.h5\n"));
  const std::string bench = output_of(rbvi(1, "bench -out run"));
  EXPECT_TRUE(contains(bench, "\nwrote run/bench/table.md, run/bench/table.csv\n")) << bench;
  const std::string online =
      output_of(rbvi_online("run/model.h5 --mu 0.18,0.02,0 --vtu run/u.vtu"));
  EXPECT_TRUE(contains(online, "\nwrote run/u.vtu, run/u_contact.vtu\n")) << online;
  const std::string many =
      output_of(rbvi_online("run/model.h5 --queries grid:2,1,1 --out run/answers.csv"));
  EXPECT_TRUE(contains(many, "\nwrote run/answers.csv\n")) << many;

  const std::string table = slurp("run/bench/table.csv");
  EXPECT_TRUE(table.starts_with("method,includes,queries,median_ms,")) << table;
  EXPECT_TRUE(contains(line_with(table, "method"), ",outputs_max")) << table;
  EXPECT_EQ(lines_with(table, "\"multilinear interpolation\""), 1) << table;
  for (const char *row :
       {"\"active_set from rest\"", "\"multilinear interpolation\"", "\"reduced ("})
    EXPECT_FALSE(line_with(table, row).ends_with("\"\"")) << row << " has no error of its outputs";

  const std::string drawn = output_of(RBVI_FIGURES " run");
  EXPECT_TRUE(contains(drawn, "wrote run/figures/bench.png, run/figures/bench.pdf\n")) << drawn;
  expect_drawn(
      {"solution", "bases", "pressure", "infsup", "error_map", "mesh_quality", "errors", "bench"});
}

/// A file of more than 2000 nodes, its numbers in base64; nothing else of the run is there.
TEST_F(Pictures, OfTwoBodiesAloneFromAFileInBase64) {
  fs::create_directory("run");
  const std::string solve = output_of(
      rbvi(2, "solve -case " RBVI_CASES "/two_disks -mu 0.85 -vtu run/u.vtu -csv run/u.csv"));
  EXPECT_TRUE(contains(solve, "wrote run/u.csv\nwrote run/u.vtu, run/u_contact.vtu\n")) << solve;
  EXPECT_TRUE(contains(slurp("run/u.vtu"), "format=\"binary\""));
  EXPECT_FALSE(contains(slurp("run/u_contact.vtu"), "format=\"binary\""));
  const Finished drawn = shell(RBVI_FIGURES " run");
  EXPECT_EQ(drawn.status, 1);
  EXPECT_TRUE(contains(drawn.err, "run/model.h5 is missing")) << drawn.err;
  EXPECT_FALSE(contains(drawn.err, "Traceback")) << drawn.err;
  expect_drawn({"solution"});
}

TEST_F(Pictures, AFileThatIsNoVtuIsNamed) {
  fs::create_directory("run");
  for (const char *text : {"", "<VTKFile/>", "<VTKFile type=\"UnstructuredGrid\"></VTKFile>"}) {
    spill("run/u.vtu", text);
    const Finished drawn = shell(RBVI_FIGURES " run");
    EXPECT_EQ(drawn.status, 1);
    EXPECT_TRUE(contains(drawn.err, "solution: run/u.vtu is not a VTU file")) << drawn.err;
    EXPECT_FALSE(contains(drawn.err, "Traceback")) << drawn.err;
  }
}

} // namespace
} // namespace rbvi::pictures_test
