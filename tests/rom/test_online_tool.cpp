#include "synthetic.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/rom/online_tool.hpp"

#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <sys/wait.h>
#include <unistd.h>

namespace rbvi {
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
    model.validation_enriched = {64, 1e-4, 2e-4, 3e-4, 4e-4};
    model.validation_decorrelated = {64, 0.1, 0.2, 0.3, 0.4};
    write_model(model, "model.h5");
  }
  void TearDown() override {
    std::filesystem::current_path(before);
    std::filesystem::remove_all(directory);
  }

  /// One line on standard error, exit status 2, and no new file.
  testing::AssertionResult refused(const std::string &arguments, const std::string &part) {
    const Finished run = online(arguments);
    std::vector<std::string> names;
    for (const auto &entry : std::filesystem::directory_iterator("."))
      if (entry.path().extension() != ".csv" || contains(entry.path().string(), "out"))
        names.push_back(entry.path().filename().string());
    const bool ok = run.status == 2 && contains(run.out, part) && lines_of(run.out).size() == 1 &&
                    names == std::vector<std::string>{"model.h5"};
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
  const ReducedSolution solution = solver.solve(mu);
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
  EXPECT_TRUE(contains(run.out, "2 answers in out.csv")) << run.out;
  EXPECT_TRUE(contains(run.out, "kkt_residual"));
  EXPECT_TRUE(contains(run.out, "expected error"));
  const std::vector<std::string> lines = lines_of(slurp("out.csv"));
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_TRUE(lines[0].starts_with("radius,center_x,center_y,energy,normal_force"));
  EXPECT_TRUE(contains(lines[0], ",kkt_residual,"));
  EXPECT_TRUE(contains(lines[0], ",expected_error_u,expected_error_lambda,"));
  EXPECT_FALSE(contains(lines[0], "min_u"));
  EXPECT_TRUE(lines[1].starts_with("0.18,0.02,-0.01,"));
  EXPECT_EQ(split(lines[2], ',').size(), split(lines[0], ',').size());
  const Finished table = online("model.h5 --queries random:5:1 --full");
  EXPECT_EQ(lines_of(table.out).size(), 6U);
  EXPECT_TRUE(contains(table.out, ",min_u,"));
}

TEST_F(OnlineBinary, DecorrelatedIsAnotherModelWithItsOwnErrors) {
  const Finished run = online("model.h5 --mu 0.2,0,0 --decorrelated");
  EXPECT_EQ(run.status, 0) << run.out;
  EXPECT_TRUE(contains(run.out, "0.2 max")) << run.out;
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
  EXPECT_EQ(online("model.h5 --mu 0.2,0,0 --vtu u.vtu").status, 0);
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
  EXPECT_TRUE(refused("model.h5 --vtu u.vtu", "needs --mu"));
  EXPECT_TRUE(refused("model.h5 --out out.csv", "needs --mu"));
  EXPECT_TRUE(refused("model.h5 --mu nan,0,0 --vtu u.vtu", "not finite"));
  EXPECT_TRUE(refused("model.h5 --mu 0.2,0", "2 values for 3"));
  EXPECT_TRUE(refused("model.h5 --queries no.csv --out out.csv", "cannot read 'no.csv'"));
  std::ofstream("mu.csv") << "radius,center_x,center_y\n0.2,0,0\n0.2,0,0.1\n0.2,0,0\n";
  EXPECT_TRUE(refused("model.h5 --queries mu.csv --out out.csv", "line 3 of mu.csv"));
}

TEST_F(OnlineBinary, FailsWithStatusOne) {
  EXPECT_EQ(online("model.h5 --queries grid:2,2,2 --out model.h5/out.csv").status, 1);
  EXPECT_EQ(online("model.h5 --queries grid:2,2,2 --out /dev/full").status, 1);
  EXPECT_EQ(online("model.h5 --queries grid:2,2,2 > /dev/full").status, 1);
  model.a.reduced *= -1;
  write_model(model, "model.h5");
  const Finished run = online("model.h5 --queries grid:2,2,2 --out out.csv");
  EXPECT_EQ(run.status, 1);
  EXPECT_TRUE(contains(run.out, "not positive definite")) << run.out;
  EXPECT_TRUE(contains(run.out, "query 1 of 8")) << run.out;
  EXPECT_FALSE(std::filesystem::exists("out.csv"));
}

TEST_F(OnlineBinary, IsSerial) {
  const Finished run = shell("ldd " RBVI_ONLINE);
  EXPECT_EQ(run.status, 0);
  EXPECT_TRUE(contains(run.out, "hdf5")) << run.out;
  for (const char *library : {"libmpi", "libpetsc", "libslepc", "libmetis"})
    EXPECT_FALSE(contains(run.out, library)) << run.out;
}

} // namespace
} // namespace rbvi
