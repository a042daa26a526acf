#include "synthetic.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/io/vtu.hpp"
#include "rbvi/model/online_tool.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>
#include <set>
#include <sstream>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace rbvi::online_tool_test {
namespace {

using Path = std::filesystem::path;

std::string slurp(const Path &path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path).rdbuf();
  return bytes.str();
}

struct Finished {
  int status;
  std::string out;
};

/// Output and errors together.
Finished shell(const std::string &command) {
  Finished run{-1, ""};
  FILE *pipe = popen((command + " 2>&1").c_str(), "r");
  char buffer[512];
  while (pipe != nullptr && std::fgets(buffer, sizeof buffer, pipe) != nullptr)
    run.out += buffer;
  const int status = pclose(pipe);
  run.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return run;
}

Finished online(const std::string &arguments) {
  return shell(RBVI_ONLINE " " + arguments);
}

bool contains(const std::string &text, const std::string &part) {
  return text.find(part) != std::string::npos;
}

/// Files whose names begin so.
int files_named(const std::string &start) {
  int count = 0;
  for (const auto &entry : std::filesystem::directory_iterator("."))
    count += entry.path().filename().string().starts_with(start) ? 1 : 0;
  return count;
}

std::vector<std::string> lines_of(const std::string &text) {
  std::vector<std::string> lines = split(text, '\n');
  if (!lines.empty() && lines.back().empty()) lines.pop_back();
  return lines;
}

/// In a directory of its own, with a model in it; commands run with relative paths.
struct OnlineBinary : testing::Test {
  Path directory = Path(testing::TempDir()) / ("rbvi_tool_" + std::to_string(::getpid()));
  Path before = std::filesystem::current_path();
  ReducedModel model = synthetic::random_model({3, 2, 4, 3, 1, 1, 2}, 21);

  void SetUp() override {
    std::filesystem::create_directories(directory);
    std::filesystem::current_path(directory);
    model.made.validation_enriched = {64, 1e-4, 2e-4, 3e-4, 4e-4};
    model.made.validation_decorrelated = {64, 0.1, 0.2, 0.3, 0.4};
    write_model(model, "model.h5");
  }
  void TearDown() override {
    std::filesystem::current_path(before);
    std::filesystem::remove_all(directory);
  }

  /// One line on standard error, exit status 2, and no new file.
  testing::AssertionResult refused(const std::string &arguments, const std::string &part) {
    const Finished run = online(arguments);
    std::set<std::string> names;
    for (const auto &entry : std::filesystem::directory_iterator("."))
      if (entry.path().extension() != ".csv" || contains(entry.path().string(), "out"))
        names.insert(entry.path().filename().string());
    const bool ok = run.status == 2 && contains(run.out, part) && lines_of(run.out).size() == 1 &&
                    names == std::set<std::string>{"model.fields.h5", "model.h5"};
    return (ok ? testing::AssertionSuccess() : testing::AssertionFailure())
           << "status " << run.status << ": " << run.out;
  }
};

TEST_F(OnlineBinary, DescribesTheModel) {
  const Finished run = online("model.h5");
  EXPECT_EQ(run.status, 0);
  for (const char *part : {"radius", "[0.16, 0.24] m", "modes", "supremizers", "expected error"})
    EXPECT_TRUE(contains(run.out, part)) << part << " in\n" << run.out;
  EXPECT_TRUE(contains(online("--help").out, "--queries"));
  EXPECT_EQ(online("-version").out, "rbvi-online " RBVI_VERSION "\n");
}

TEST_F(OnlineBinary, AnswersOne) {
  const Finished run = online("-mu 0.18,0.02,-0.01 model.h5 --full");
  EXPECT_EQ(run.status, 0);
  OnlineSolver solver(model);
  const Mu mu{0.18, 0.02, -0.01};
  const ReducedAnswer solution = solver.solve(mu);
  std::istringstream in(run.out);
  std::map<std::string, double> values;
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string name;
    double value = 0;
    if (words >> name >> value) values[name] = value;
  }
  EXPECT_NEAR(values.at("energy"), solution.energy, 1e-8 * std::abs(solution.energy));
  EXPECT_NEAR(values.at("min_u"), solver.field(solution).minCoeff(), 1e-8);
  EXPECT_LE(values.at("kkt_residual"), 1e-10);
  EXPECT_EQ(values.at("expected_error_u"), 2e-4);
  EXPECT_GT(values.at("seconds"), 0);
  EXPECT_TRUE(contains(run.out, "over 64 parameters"));
  EXPECT_EQ(online("model.h5 --mu=center_x=0.02,center_y=-0.01,radius=0.18").status, 0);
}

TEST_F(OnlineBinary, AnswersMany) {
  std::ofstream("mu.csv") << "center_x,radius,center_y\n0.02,0.18,-0.01\n0,0.2,0\n";
  const Finished run = online("model.h5 --queries mu.csv --out out.csv");
  EXPECT_EQ(run.status, 0) << run.out;
  EXPECT_TRUE(contains(run.out, "2 answers, ")) << run.out;
  EXPECT_TRUE(contains(run.out, "\nwrote out.csv\n")) << run.out;
  EXPECT_TRUE(contains(run.out, "kkt_residual"));
  EXPECT_TRUE(contains(run.out, "expected error"));
  const std::vector<std::string> lines = lines_of(slurp("out.csv"));
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_TRUE(lines[0].starts_with("radius,center_x,center_y,energy,normal_force"));
  EXPECT_TRUE(contains(lines[0], ",kkt_residual,"));
  EXPECT_TRUE(contains(lines[0], ",expected_error_u,expected_error_lambda,"));
  EXPECT_TRUE(lines[0].ends_with(",status"));
  EXPECT_TRUE(lines[1].ends_with(",ok"));
  EXPECT_FALSE(contains(lines[0], "min_u"));
  EXPECT_TRUE(lines[1].starts_with("0.18,0.02,-0.01,"));
  EXPECT_EQ(split(lines[2], ',').size(), split(lines[0], ',').size());
  const Finished table = online("model.h5 --queries random:5:1 --full");
  EXPECT_EQ(lines_of(table.out).size(), 7U); // and the warning: three nodes
  EXPECT_TRUE(contains(table.out, ",min_u,"));
}

TEST_F(OnlineBinary, DecorrelatedIsAnotherModelWithItsOwnErrors) {
  const Finished run = online("model.h5 --mu 0.2,0,0 --decorrelated");
  EXPECT_EQ(run.status, 0) << run.out;
  EXPECT_TRUE(contains(run.out, "0.2 largest")) << run.out;
  EXPECT_TRUE(contains(online("model.h5 --decorrelated").out, "supremizers           0"));
}

TEST_F(OnlineBinary, ExtrapolatesOnlyWhenAsked) {
  EXPECT_TRUE(refused("model.h5 --mu 0.25,0,0", "radius = 0.25 is outside [0.16, 0.24]"));
  const Finished run = online("model.h5 --mu 0.25,0,0 --extrapolate");
  EXPECT_EQ(run.status, 0);
  EXPECT_TRUE(contains(run.out, "unknown outside the box")) << run.out;
  EXPECT_TRUE(refused("model.h5 --mu 5,0,0 --extrapolate", "range of validity [0.02, 0.38]"));
  EXPECT_TRUE(refused("model.h5 --mu 0.3,0.2,0 --extrapolate", "folds the mesh"));
}

TEST_F(OnlineBinary, WritesVtu) {
  const Finished run = online("model.h5 --mu 0.2,0,0 --vtu u.vtu --out u.csv");
  EXPECT_EQ(run.status, 0);
  EXPECT_TRUE(contains(run.out, "\nwrote u.vtu, u_contact.vtu, u.csv\n")) << run.out;
  EXPECT_FALSE(contains(online("model.h5 --mu 0.2,0,0").out, "wrote"));
  EXPECT_TRUE(contains(slurp("u.vtu"), "Name=\"u\""));
  EXPECT_TRUE(contains(slurp("u_contact.vtu"), "Name=\"pressure\""));
}

TEST_F(OnlineBinary, RefusesBadInputWhole) {
  EXPECT_TRUE(refused("", "no model"));
  EXPECT_TRUE(refused("no.h5", "no.h5 does not exist"));
  EXPECT_TRUE(refused("model.h5 other.h5", "left over"));
  EXPECT_TRUE(refused("model.h5 --quries a.csv", "nearest one is --queries"));
  EXPECT_TRUE(refused("model.h5 --m 1", "nearest one is --mu"));
  EXPECT_TRUE(refused("model.h5 --mu", "needs a value"));
  EXPECT_TRUE(refused("model.h5 --full=yes --mu 0.2,0,0", "takes no value"));
  EXPECT_TRUE(refused("model.h5 --mu 0.2,0,0 --mu 0.2,0,0", "given twice"));
  EXPECT_TRUE(refused("model.h5 --mu 0.2,0,0 --queries a.csv", "exclude each other"));
  EXPECT_TRUE(refused("model.h5 --pack a.rbvi --mu 0.2,0,0", "--pack takes no --mu"));
  EXPECT_TRUE(refused("model.h5 --fmu a.fmu --queries a.csv", "--fmu takes no --mu"));
  EXPECT_TRUE(refused("model.h5 --fmu a.fmu --pack a.rbvi", "exclude each other"));
  EXPECT_TRUE(refused("model.h5 --fmu a.zip", "ends with .fmu"));
  EXPECT_TRUE(refused("model.h5 --vtu u.vtu", "needs --mu"));
  EXPECT_TRUE(refused("model.h5 --out out.csv", "needs --mu"));
  EXPECT_TRUE(refused("model.h5 --mu nan,0,0 --vtu u.vtu", "not finite"));
  EXPECT_TRUE(refused("model.h5 --mu 0.2,0", "2 values for 3"));
  EXPECT_TRUE(refused("model.h5 --queries no.csv --out out.csv", "cannot read 'no.csv'"));
  EXPECT_TRUE(refused("model.h5 --mu 0.2,0,0 --out ./model.h5", "would overwrite the model"));
  std::ofstream("mu.csv") << "radius,center_x,center_y\n0.2,0,0\n";
  EXPECT_TRUE(refused("model.h5 --queries mu.csv --out ./mu.csv", "the file of queries"));
  std::ofstream("mu.csv") << "radius,center_x,center_y\n0.2,0,0\n0.2,0,0.1\n0.2,0,0\n";
  EXPECT_TRUE(refused("model.h5 --queries mu.csv --out out.csv", "line 3 of mu.csv"));
}

TEST_F(OnlineBinary, FailsWithStatusOne) {
  EXPECT_EQ(online("model.h5 --queries grid:2,2,2 --out model.h5/out.csv").status, 1);
  EXPECT_EQ(online("model.h5 --queries grid:2,2,2 --out /dev/full").status, 1);
  EXPECT_EQ(online("model.h5 --queries grid:2,2,2 > /dev/full").status, 1);
  model.body.a.reduced *= -1;
  write_model(model, "model.h5");
  const Finished run = online("model.h5 --queries grid:2,2,2 --out out.csv");
  EXPECT_EQ(run.status, 1);
  EXPECT_TRUE(contains(run.out, "8 of 8 queries have no answer")) << run.out;
  EXPECT_TRUE(contains(run.out, "not positive definite")) << run.out;
  EXPECT_TRUE(std::filesystem::exists("out.csv"));
}

/// The rows of a table under its header, by column.
std::vector<std::map<std::string, std::string>> rows_of(const std::string &table) {
  const std::vector<std::string> lines = lines_of(table);
  std::vector<std::map<std::string, std::string>> rows;
  if (lines.empty()) return rows;
  const std::vector<std::string> names = split(lines[0], ',');
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string> fields = split(lines[i], ',');
    rows.emplace_back();
    for (std::size_t k = 0; k < names.size(); ++k)
      rows.back()[names[k]] = k < fields.size() ? fields[k] : "";
    for (std::size_t k = names.size(); k < fields.size(); ++k)
      rows.back()[names.back()] += "," + fields[k]; // commas of a reason
  }
  return rows;
}

TEST_F(OnlineBinary, ARowWithoutAnAnswerSaysWhyAndTheOthersAreAnswered) {
  // The last generator takes either sign and pulls at a node, the less the smaller its share is.
  model.contact.free_modes = 1;
  std::vector<bool> answered;
  std::ptrdiff_t missing = 40;
  for (double share = 10; missing == 40 && share > 1e-6; share /= 2) {
    model.contact.dual_basis.col(3) << share, -share, share;
    answered.clear();
    OnlineSolver solver(model);
    for (const Mu &mu : parse_set(solver.scene().parameters, "random:40:3")) {
      try {
        (void)solver.solve(mu);
        answered.push_back(true);
      } catch (const Error &) {
        answered.push_back(false);
      }
    }
    missing = std::count(answered.begin(), answered.end(), false);
  }
  ASSERT_GT(missing, 0);
  ASSERT_LT(missing, 40);
  write_model(model, "model.h5");
  const Finished run = online("model.h5 --queries random:40:3 --out out.csv");
  EXPECT_EQ(run.status, 1);
  EXPECT_TRUE(contains(run.out, std::to_string(missing) + " of 40 queries have no answer"))
      << run.out;
  const auto rows = rows_of(slurp("out.csv"));
  ASSERT_EQ(rows.size(), 40U);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].at("status") == "ok", answered[i]) << i;
    EXPECT_EQ(rows[i].at("energy").empty(), !answered[i]) << i;
    EXPECT_FALSE(rows[i].at("radius").empty());
    if (!answered[i]) {
      EXPECT_TRUE(contains(rows[i].at("status"), "while solving")) << rows[i].at("status");
    }
  }
  EXPECT_EQ(files_named("out.csv"), 1);
}

/// Each has a temporary file of its own; the last one that ends is there, whole.
TEST_F(OnlineBinary, TwoWritersOfOneFileLeaveOneWholeTable) {
  const std::string ask = RBVI_ONLINE " model.h5 --out out.csv --queries random:";
  const Finished run =
      shell("sh -c '" + ask + "2000:1 & " + ask + "3000:2 & " + ask + "1000:3 & wait'");
  const std::vector<std::string> lines = lines_of(slurp("out.csv"));
  const std::size_t rows = lines.size() - 1;
  EXPECT_TRUE(rows == 1000 || rows == 2000 || rows == 3000) << rows << "\n" << run.out;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    EXPECT_EQ(split(lines[i], ',').size(), split(lines[0], ',').size()) << lines[i];
    EXPECT_TRUE(lines[i].ends_with(",ok")) << lines[i];
  }
  EXPECT_FALSE(contains(run.out, "cannot")) << run.out;
  EXPECT_EQ(files_named("out.csv"), 1);
}

/// Rows that a killed batch wrote stay beside the file, until the next one is written.
TEST_F(OnlineBinary, TheRowsOfAKilledBatchStay) {
  (void)shell("sh -c '(echo radius,center_x,center_y; yes 0.2,0,0) | " RBVI_ONLINE
              " model.h5 --queries - --out out.csv & for i in $(seq 500); do sleep 0.02; "
              "test -s out.csv.tmp.* && break; done; kill -KILL $!; wait'");
  EXPECT_FALSE(std::filesystem::exists("out.csv"));
  EXPECT_EQ(files_named("out.csv.tmp."), 1);
  EXPECT_EQ(online("model.h5 --queries random:2:1 --out out.csv").status, 0);
  EXPECT_EQ(files_named("out.csv"), 1);
}

TEST_F(OnlineBinary, IdsAreHandedOnAndDigitsAreChosen) {
  std::ofstream("mu.csv") << "radius,id,center_x,center_y\n0.18,\"a, b\",0.02,-0.01\n0.2,2,0,0\n";
  const Finished run = online("model.h5 --queries mu.csv --precision 15");
  ASSERT_EQ(run.status, 0) << run.out;
  const std::vector<std::string> lines = lines_of(run.out);
  EXPECT_TRUE(lines[0].starts_with("id,radius,center_x,center_y,energy,")) << lines[0];
  EXPECT_TRUE(lines[1].starts_with("\"a, b\",0.18,0.02,-0.01,")) << lines[1];
  OnlineSolver solver(model);
  const auto row = rows_of(lines[0] + "\n" + lines[2] + "\n").front();
  EXPECT_EQ(row.at("id"), "2");
  const double energy = solver.solve({0.2, 0, 0}).energy;
  EXPECT_NEAR(parse_number(row.at("energy"), "energy"), energy, 1e-14 * std::abs(energy));
  EXPECT_TRUE(refused("model.h5 --queries grid:2,2,2 --precision 18", "from 1 to 17"));
  EXPECT_TRUE(refused("model.h5 --queries grid:2,2,2 --precision 1.5", "from 1 to 17"));
  EXPECT_TRUE(refused("model.h5 --mu 0.2,0,0 --precision 3", "needs --queries, --out"));
}

TEST_F(OnlineBinary, OutputsAloneThatAreAsked) {
  const std::string one = online("model.h5 --mu 0.2,0,0 --only peak_pressure,energy").out;
  const auto begins = [](const std::string &text, const std::string &start) {
    return std::ranges::any_of(lines_of(text),
                               [&](const std::string &line) { return line.starts_with(start); });
  };
  for (const char *name : {"energy ", "peak_pressure "})
    EXPECT_TRUE(begins(one, name)) << one;
  for (const char *name : {"normal_force", "kkt_residual", "seconds", "min_u"})
    EXPECT_FALSE(begins(one, name)) << one;
  EXPECT_TRUE(begins(online("model.h5 --mu 0.2,0,0 --only min_u").out, "min_u "));
  const std::string table = online("model.h5 --queries grid:2,1,1 --only energy,seconds").out;
  EXPECT_TRUE(table.starts_with("radius,center_x,center_y,energy,seconds,status\n")) << table;
  EXPECT_EQ(rows_of(table)[1].at("energy"),
            rows_of(online("model.h5 --queries grid:2,1,1").out)[1].at("energy"));
  const std::string slopes = online("model.h5 --queries grid:2,1,1 --only energy --gradient").out;
  EXPECT_TRUE(slopes.starts_with("radius,center_x,center_y,energy,d_energy_d_radius,"
                                 "d_energy_d_center_x,d_energy_d_center_y,status\n"))
      << slopes;
  const std::string json = online("model.h5 --mu 0.2,0,0 --json --only energy").out;
  EXPECT_TRUE(contains(json, "\"outputs\": {\"energy\": {")) << json;
  EXPECT_FALSE(contains(json, "normal_force")) << json;
  EXPECT_TRUE(refused("model.h5 --mu 0.2,0,0 --only force",
                      "the model has no output 'force': the nearest is '"));
  EXPECT_TRUE(refused("model.h5 --only energy", "--only needs --mu or --queries"));
}

/// Times and names go with their rows; a spreadsheet of another country is read.
TEST_F(OnlineBinary, OtherColumnsAreHandedOn) {
  std::ofstream("mu.csv") << "time;radius;center_x;center_y;who\n0,5;0,18;0,02;-1e-2;a;\n";
  EXPECT_TRUE(refused("model.h5 --queries mu.csv", "6 entries under 5 columns"));
  std::ofstream("mu.csv") << "time;radius;center_x;center_y;who\n0,5;0,18;0,02;-1e-2;\"a; b\"\n"
                             "1;0.2;0;0;c\n";
  const auto rows = rows_of(online("model.h5 --queries mu.csv").out);
  ASSERT_GE(rows.size(), 2U);
  EXPECT_EQ(rows[1].at("who"), "c");
  EXPECT_EQ(rows[1].at("radius"), "0.2");
  const std::string table = online("model.h5 --queries mu.csv --only energy").out;
  EXPECT_TRUE(table.starts_with("time,who,radius,center_x,center_y,energy,status\n"
                                "\"0,5\",a; b,0.18,0.02,-0.01,"))
      << table;
  std::ofstream("mu.csv") << "name,radius,center_x,center_y,energy\n\"first, of all\",0.9,0,0,7\n";
  EXPECT_TRUE(refused("model.h5 --queries mu.csv", "line 2 of mu.csv"));
  const std::string stream = shell(RBVI_ONLINE " model.h5 --only energy --queries - < mu.csv").out;
  EXPECT_TRUE(contains(stream, "\"first, of all\",0.9,0,0,,\"radius = 0.9 is outside")) << stream;
  std::ofstream("mu.csv") << "radus,center_x,center_y\n0.2,0,0\n";
  EXPECT_TRUE(refused("model.h5 --queries mu.csv", "there is no parameter 'radus'"));
}

TEST_F(OnlineBinary, WarnsNextToAFailedTrainingSample) {
  model.made.trained_mu.resize(3, 1);
  model.made.trained_mu << 0.23, 0, 0;
  model.made.failed_mu.resize(3, 1);
  model.made.failed_mu << 0.17, 0, 0;
  write_model(model, "model.h5");
  const std::string warning = "1 answer lies nearest to a training parameter that has no";
  EXPECT_TRUE(contains(online("model.h5 --mu 0.18,0,0").out, warning));
  EXPECT_FALSE(contains(online("model.h5 --mu 0.22,0,0").out, "no high-fidelity answer"));
  std::ofstream("mu.csv") << "radius,center_x,center_y\n0.18,0,0\n0.22,0,0\n";
  EXPECT_TRUE(contains(online("model.h5 --queries mu.csv --out out.csv").out, warning));
}

TEST_F(OnlineBinary, ReadsAndWritesStreams) {
  const Finished run =
      shell("printf 'radius,id,center_x,center_y\\n0.2,1,0,0\\n0.9,2,0,0\\n"
            "x,3,0.5,0\\n0.18,4,0.01,0\\n' | " RBVI_ONLINE " model.h5 --queries - --out -");
  EXPECT_EQ(run.status, 1);
  const auto rows = rows_of(run.out);    // the last line is that of the failure
  ASSERT_EQ(rows.size(), 6U) << run.out; // and the warning: three nodes
  EXPECT_EQ(rows[0].at("status"), "ok");
  EXPECT_TRUE(contains(rows[1].at("status"), "outside")) << rows[1].at("status");
  EXPECT_TRUE(contains(rows[2].at("status"), "line 4")) << rows[2].at("status");
  // What is known of a bad row stays with it.
  EXPECT_EQ(rows[1].at("radius"), "0.9");
  EXPECT_EQ(rows[2].at("radius"), "x");
  EXPECT_EQ(rows[2].at("center_x"), "0.5");
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(rows[i].at("id"), std::to_string(i + 1));
  EXPECT_EQ(rows[3].at("status"), "ok");
  EXPECT_TRUE(contains(run.out, "2 of 4 queries have no answer")) << run.out;
  EXPECT_EQ(shell("printf 'center_x\\n0\\n' | " RBVI_ONLINE " model.h5 --queries -").status, 2);
}

TEST_F(OnlineBinary, ALongBatchLosesOnlyTheRowsWithoutAnAnswerAndTakesNoMemory) {
  constexpr int rows = 100000, each = 1000;
  {
    std::ofstream file("mu.csv");
    file << "radius,center_x,center_y\n";
    for (int i = 0; i < rows; ++i)
      file << (i % each == 0 ? 0.9 : 0.16 + 0.08 * i / rows) << ",0.01,0\n";
  }
  const Finished run = shell(RBVI_ONLINE " model.h5 --queries - --out out.csv < mu.csv");
  EXPECT_EQ(run.status, 1);
  EXPECT_TRUE(contains(run.out, "100 of 100000 queries have no answer")) << run.out;
  std::ifstream table("out.csv");
  std::string line;
  std::getline(table, line);
  int answered = 0, refused = 0;
  while (std::getline(table, line))
    ++(line.ends_with(",ok") ? answered : refused);
  EXPECT_EQ(answered, rows - rows / each);
  EXPECT_EQ(refused, rows / each);
#ifndef __SANITIZE_ADDRESS__ // which keeps what was freed
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  EXPECT_LE(usage.ru_maxrss, 100000) << "KB, of any command so far";
#endif
}

TEST_F(OnlineBinary, ReadsItsOwnTablesAgain) {
  model.made.validation_enriched.outputs = {{"energy", 1e-5, 2e-5, 1e-4, 2e-4, 1e-4, 2e-4},
                                            {"kkt_residual", 1e-15, 1e-15, 1, 1, 1, 1}};
  write_model(model, "model.h5");
  ASSERT_EQ(online("model.h5 --queries random:7:5 --out out.csv").status, 0);
  const Finished again = online("model.h5 --queries out.csv --out out2.csv");
  EXPECT_EQ(again.status, 0) << again.out;
  const auto first = rows_of(slurp("out.csv")), second = rows_of(slurp("out2.csv"));
  ASSERT_EQ(first.size(), 7U);
  ASSERT_EQ(second.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(first[i].at("radius"), second[i].at("radius"));
    EXPECT_EQ(first[i].at("energy"), second[i].at("energy"));
    EXPECT_EQ(first[i].at("energy_error"), "2.0e-05");
    EXPECT_FALSE(first[i].contains("kkt_residual_error"));
  }
  EXPECT_TRUE(contains(online("model.h5 --mu 0.2,0,0").out, "(largest error 2.0e-05)"));
}

TEST_F(OnlineBinary, SaysWhereNothingSoNearTheBoundaryWasMeasured) {
  const std::string nearer = "nearer to a corner or a face of the box";
  EXPECT_FALSE(contains(online("model.h5 --mu 0.24,0.05,0.05").out, nearer));
  model.made.validated_mu = Vector{{0.2, 0, 0}};
  write_model(model, "model.h5");
  EXPECT_FALSE(contains(online("model.h5 --mu 0.2,0,0").out, nearer));
  const Finished one = online("model.h5 --mu 0.21,0,0");
  EXPECT_TRUE(contains(one.out, "warning: 1 answer lies " + nearer)) << one.out;
  const Finished many = online("model.h5 --queries random:5:1 --out out.csv");
  EXPECT_TRUE(contains(many.out, "warning: 5 answers lie " + nearer)) << many.out;
  const Finished outside = online("model.h5 --mu 0.245,0,0 --extrapolate");
  EXPECT_TRUE(contains(outside.out, "unknown outside the box")) << outside.out;
  EXPECT_FALSE(contains(outside.out, nearer)) << outside.out;
  model.made.validation_enriched = {};
  model.made.validated_mu = {};
  write_model(model, "model.h5");
  EXPECT_TRUE(contains(online("model.h5 --mu 0.2,0,0").out, "not measured: nobody knows"));
}

/// The number behind a text.
double number_behind(const std::string &text, const std::string &before) {
  const std::size_t at = text.find(before);
  return at == std::string::npos ? std::nan("") : std::stod(text.substr(at + before.size()));
}

TEST_F(OnlineBinary, OneAnswerAsJson) {
  model.made.validation_enriched.outputs = {{"energy", 1e-5, 2e-5, 1e-4, 2e-4, 1e-4, 2e-4}};
  write_model(model, "model.h5");
  EXPECT_TRUE(refused("model.h5 --queries random:2:1 --json", "--json needs --mu"));
  const Finished run = online("model.h5 --mu 0.18,0.02,-0.01 --json --vtu u.vtu");
  EXPECT_EQ(run.status, 0) << run.out;
  EXPECT_EQ(lines_of(run.out).size(), 1U);
  OnlineSolver solver(model);
  const double energy = solver.solve({0.18, 0.02, -0.01}).energy;
  EXPECT_NEAR(number_behind(run.out, R"("outputs": {"energy": {"value": )"), energy,
              1e-14 * std::abs(energy));
  EXPECT_LE(number_behind(run.out, R"(}}, "residual": )"), 1e-10);
  for (const char *part :
       {R"({"parameters": {"radius": {"value": 0.18, "unit": "m"}, "center_x": )",
        R"(, "unit": "m*N", "expected_error": 2e-05}, "normal_force": {"value": )",
        R"("inside": true, "to_other": 0, "warnings": ["warning: contact reaches the end)"})
    EXPECT_TRUE(contains(run.out, part)) << part << " in\n" << run.out;
  EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '{'),
            std::count(run.out.begin(), run.out.end(), '}'));
  EXPECT_TRUE(std::filesystem::exists("u.vtu"));
  const Finished outside = online("model.h5 --mu 0.25,0,0 --extrapolate --json");
  EXPECT_TRUE(contains(outside.out, R"("inside": false)")) << outside.out;
  EXPECT_FALSE(contains(outside.out, R"("expected_error")")) << outside.out;
}

/// Without the column seconds.
std::vector<std::map<std::string, std::string>> timeless_rows_of(const std::string &table) {
  auto rows = rows_of(table);
  for (auto &row : rows)
    row.erase("seconds");
  return rows;
}

TEST_F(OnlineBinary, ThreadsChangeNeitherOrderNorDigits) {
  EXPECT_TRUE(refused("model.h5 --mu 0.2,0,0 --threads 2", "--threads needs --queries"));
  EXPECT_TRUE(refused("model.h5 --queries random:2:1 --threads 0", "from 1 to 1000"));
  EXPECT_TRUE(refused("model.h5 --queries random:2:1 --threads 2 --warm", "leave out --threads"));
  const std::string ask = "model.h5 --queries random:1000:3 --precision 17 --contact ";
  ASSERT_EQ(online(ask + "trace1.csv --out one.csv").status, 0);
  ASSERT_EQ(online(ask + "trace3.csv --out three.csv --threads 3").status, 0);
  const auto one = timeless_rows_of(slurp("one.csv"));
  EXPECT_EQ(one.size(), 1000U);
  EXPECT_EQ(one, timeless_rows_of(slurp("three.csv")));
  EXPECT_EQ(slurp("trace1.csv"), slurp("trace3.csv"));
  // Rows of a stream that are none stay where they stood.
  const std::string stream = "( { echo id,radius,center_x,center_y; for i in $(seq 300); do "
                             "echo $i,0.$((i % 4 == 0 ? 9 : 2)),0,0; done; } | " RBVI_ONLINE
                             " model.h5 --queries - --threads 2 2> said )";
  const auto rows = rows_of(shell(stream).out);
  ASSERT_EQ(rows.size(), 300U);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].at("id"), std::to_string(i + 1));
    EXPECT_EQ(rows[i].at("status") == "ok", (i + 1) % 4 != 0) << i;
  }
  EXPECT_TRUE(contains(slurp("said"), "75 of 300 queries have no answer")) << slurp("said");
}

TEST_F(OnlineBinary, WritesAnswersAlongTheContact) {
  EXPECT_TRUE(refused("model.h5 --contact one.csv", "needs --mu or --queries"));
  EXPECT_TRUE(refused("model.h5 --mu 0.2,0,0 --contact ./model.h5", "would overwrite the model"));
  std::ofstream("mu.csv") << "radius,center_x,center_y\n0.18,0.02,-0.01\n0.9,0,0\n0.2,0,0\n";
  (void)shell(RBVI_ONLINE " model.h5 --queries - --contact trace.csv --out out.csv --precision 17"
                          " < mu.csv");
  const auto rows = rows_of(slurp("trace.csv"));
  OnlineSolver solver(model);
  std::size_t at = 0;
  for (const auto &[number, mu] : {std::pair{"1", Mu{0.18, 0.02, -0.01}}, {"3", Mu{0.2, 0, 0}}}) {
    const Grid grid = solver.contact_grid(solver.solve(mu), 0);
    for (Index node = 0; node < grid.points.rows(); ++node, ++at) {
      ASSERT_LT(at, rows.size());
      EXPECT_EQ(rows[at].at("row"), number);
      EXPECT_EQ(parse_number(rows[at].at("y"), "y"), grid.points(node, 1));
      EXPECT_NEAR(parse_number(rows[at].at("pressure"), "p"), grid.of_nodes.front().values[node],
                  1e-13);
      EXPECT_EQ(parse_number(rows[at].at("normal_y"), "n"), 0);
    }
  }
  EXPECT_EQ(at, rows.size());
  ASSERT_EQ(online("model.h5 --mu 0.18,0.02,-0.01 --contact one.csv --precision 17").status, 0);
  EXPECT_TRUE(slurp("trace.csv").starts_with(slurp("one.csv")));
}

TEST_F(OnlineBinary, IsSerial) {
  const Finished run = shell("ldd " RBVI_ONLINE);
  EXPECT_EQ(run.status, 0);
  EXPECT_TRUE(contains(run.out, "hdf5")) << run.out;
  for (const char *library : {"libmpi", "libpetsc", "libslepc", "libmetis"})
    EXPECT_FALSE(contains(run.out, library)) << run.out;
}

} // namespace
} // namespace rbvi::online_tool_test
