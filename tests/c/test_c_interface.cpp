// The C interface against the C++ one, on a model of each kind: the same digits, whatever was asked
// before, on however many threads; and what it refuses.
#include "rbvi.h"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/model_image.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/model/published/queries.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <mutex>
#include <numeric>
#include <thread>

namespace rbvi {
namespace {

constexpr std::size_t queries = 60;

class CInterface : public testing::TestWithParam<const char *> {
protected:
  static void SetUpTestSuite() {
    static std::once_flag once;
    std::call_once(once, add_published_queries);
  }
  void SetUp() override {
    const std::filesystem::path file = std::filesystem::path(RBVI_MODELS) / GetParam() / "model.h5";
    model_ = read_model(file, Registry{});
    image_ = image_of(model_);
    ASSERT_EQ(rbvi_open_memory(image_.data(), image_.size(), &handle_), RBVI_OK) << rbvi_error();
    columns_ = rbvi_output_count(handle_);
    for (const Mu &mu :
         parse_set(model_.scene.parameters, "random:" + std::to_string(queries) + ":3"))
      mus_.insert(mus_.end(), mu.begin(), mu.end());
    parameters_ = mus_.size() / queries;
  }
  void TearDown() override { rbvi_close(handle_); }

  rbvi_workspace *workspace() const {
    rbvi_workspace *workspace = nullptr;
    EXPECT_EQ(rbvi_workspace_new(handle_, &workspace), RBVI_OK) << rbvi_error();
    return workspace;
  }
  const double *mu(std::size_t row) const { return mus_.data() + row * parameters_; }
  /// Of the rows in this order by one workspace; NaN where there is no answer.
  std::vector<double> in_order(const std::vector<std::size_t> &rows) const {
    std::vector<double> all(queries * columns_, NAN);
    rbvi_workspace *one = workspace();
    for (const std::size_t row : rows)
      if (rbvi_solve(one, mu(row), 0) == RBVI_OK)
        EXPECT_EQ(rbvi_outputs(one, all.data() + row * columns_), RBVI_OK);
    rbvi_workspace_free(one);
    return all;
  }
  static bool same(const std::vector<double> &a, const std::vector<double> &b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
  }

  ReducedModel model_;
  std::string image_;
  rbvi_model *handle_ = nullptr;
  std::size_t columns_ = 0, parameters_ = 0;
  std::vector<double> mus_;
};

TEST_P(CInterface, AnswersAsTheInterfaceInCpp) {
  std::vector<std::size_t> rows(queries);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  const std::vector<double> ours = in_order(rows);
  OnlineSolver solver(model_);
  std::size_t answered = 0;
  for (std::size_t row = 0; row < queries; ++row) {
    const Mu at(mu(row), mu(row) + parameters_);
    Outputs outputs;
    try {
      outputs = solver.outputs(at, solver.solve(at));
    } catch (const Error &) {
      EXPECT_TRUE(std::isnan(ours[row * columns_]));
      continue;
    }
    ++answered;
    for (std::size_t i = 0; i < columns_; ++i) {
      rbvi_output of;
      ASSERT_EQ(rbvi_output_at(handle_, i, &of), RBVI_OK);
      const double theirs = output_column(of.name).of(outputs).value_or(NAN);
      const double value = ours[row * columns_ + i];
      EXPECT_TRUE(value == theirs || (std::isnan(value) && std::isnan(theirs)))
          << of.name << " " << value << " " << theirs;
    }
  }
  EXPECT_GT(answered, queries / 2);
}

TEST_P(CInterface, BoundsTheEnergyWhereTheModelDoes) {
  std::vector<double> values(columns_), bounds(columns_);
  rbvi_workspace *one = workspace();
  ASSERT_EQ(rbvi_solve(one, mu(0), 0), RBVI_OK) << rbvi_error();
  ASSERT_EQ(rbvi_outputs(one, values.data()), RBVI_OK);
  ASSERT_EQ(rbvi_errors(one, nullptr, bounds.data()), RBVI_OK);
  std::map<std::string, double> value, bound;
  for (std::size_t i = 0; i < columns_; ++i) {
    rbvi_output of;
    ASSERT_EQ(rbvi_output_at(handle_, i, &of), RBVI_OK);
    value[of.name] = values[i];
    bound[of.name] = bounds[i];
  }
  for (const auto &[name, of] : bound)
    EXPECT_EQ(std::isfinite(of), value.contains(name + "_lower")) << name;
  if (std::string(GetParam()) == "disk_none") {
    EXPECT_GE(value.at("energy") + bound.at("energy"), value.at("energy_upper"));
    EXPECT_LE(value.at("energy") - bound.at("energy"), value.at("energy_lower"));
    EXPECT_LE(bound.at("energy"), 1e-4 * std::abs(value.at("energy")));
  }
  rbvi_workspace_free(one);
}

TEST_P(CInterface, AnswersDependOnTheirParametersAlone) {
  std::vector<std::size_t> rows(queries);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  const std::vector<double> forwards = in_order(rows);
  std::ranges::reverse(rows);
  EXPECT_TRUE(same(in_order(rows), forwards)) << "reversed";
  std::ranges::stable_partition(rows, [](std::size_t row) { return row % 3 == 0; });
  EXPECT_TRUE(same(in_order(rows), forwards)) << "interleaved";
  for (const unsigned threads : {1U, 4U}) {
    std::vector<double> table(queries * columns_), residuals(queries);
    std::vector<rbvi_status> statuses(queries);
    ASSERT_EQ(rbvi_solve_many(handle_, mus_.data(), queries, threads, 0, table.data(),
                              residuals.data(), statuses.data(), nullptr, nullptr),
              RBVI_OK);
    EXPECT_TRUE(same(table, forwards)) << threads << " threads";
  }
}

TEST_P(CInterface, ThreadsShareAModel) {
  std::vector<std::size_t> rows(queries);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::vector<std::vector<double>> all(4);
  {
    std::vector<std::jthread> threads;
    for (std::vector<double> &own : all)
      threads.emplace_back([&] { own = in_order(rows); });
  }
  for (const std::vector<double> &own : all)
    EXPECT_TRUE(same(own, all.front()));
}

TEST_P(CInterface, TracesAndFieldsAreThoseOfTheModel) {
  rbvi_workspace *one = workspace();
  rbvi_grid grid;
  ASSERT_GT(rbvi_contact_count(handle_), 0U);
  for (std::size_t row = 0; row < 20; ++row) {
    if (rbvi_solve(one, mu(row), 0) != RBVI_OK) continue;
    ASSERT_EQ(rbvi_contact(one, 0, &grid), RBVI_OK) << rbvi_error();
    double largest = 0;
    for (std::size_t i = 0; i < grid.columns; ++i) {
      rbvi_column column;
      ASSERT_EQ(rbvi_column_at(one, i, &column), RBVI_OK);
      const std::size_t rows = column.of_cells ? grid.cells : grid.nodes;
      if (std::string(column.name) == "pressure")
        largest = *std::max_element(column.values, column.values + rows * column.components);
    }
    EXPECT_GE(largest, 0);
    ASSERT_EQ(rbvi_field(one, &grid), RBVI_OK) << rbvi_error();
    EXPECT_EQ(grid.nodes, static_cast<std::size_t>(model_.fields.points.rows()));
    rbvi_column u;
    ASSERT_EQ(rbvi_column_at(one, 0, &u), RBVI_OK);
    EXPECT_STREQ(u.name, "u");
  }
  rbvi_workspace_free(one);
}

INSTANTIATE_TEST_SUITE_P(Models, CInterface,
                         testing::Values("membrane", "membrane_mcpg", "two_disks", "two_disks_cone",
                                         "disk_none", "disk_condensed", "disk_collocated",
                                         "disk_large", "disk_large_cone", "nitsche_empirical",
                                         "nitsche_interpolated", "free_block", "roller"),
                         [](const auto &of) { return std::string(of.param); });

/// What each wrong call returns, and that it says why in one line.
class Refusals : public testing::Test {
protected:
  void SetUp() override {
    const ReducedModel model =
        read_model(std::filesystem::path(RBVI_MODELS) / "disk_none/model.h5", Registry{}, false);
    image_ = image_of(model);
    ASSERT_EQ(rbvi_open_memory(image_.data(), image_.size(), &handle_), RBVI_OK);
    ASSERT_EQ(rbvi_workspace_new(handle_, &workspace_), RBVI_OK);
    rbvi_parameter of;
    ASSERT_EQ(rbvi_parameter_at(handle_, 0, &of), RBVI_OK);
    mu_.assign(rbvi_parameter_count(handle_), of.value);
    outside_ = of.upper + 1;
    values_.resize(rbvi_output_count(handle_));
  }
  void TearDown() override {
    rbvi_workspace_free(workspace_);
    rbvi_close(handle_);
  }
  static void refuses(rbvi_status status, rbvi_status expected = RBVI_BAD_INPUT) {
    EXPECT_EQ(status, expected);
    const std::string text = rbvi_error();
    EXPECT_FALSE(text.empty());
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
  std::string image_;
  rbvi_model *handle_ = nullptr;
  rbvi_workspace *workspace_ = nullptr;
  std::vector<double> mu_, values_;
  double outside_ = 0;
};

TEST_F(Refusals, OfImages) {
  rbvi_model *none = nullptr;
  refuses(rbvi_open(nullptr, &none));
  refuses(rbvi_open("nowhere.rbvi", &none));
  refuses(rbvi_open(RBVI_MODELS, &none)); // a folder
  refuses(rbvi_open(RBVI_MODELS "/disk_none/model.h5", &none));
  refuses(rbvi_open_memory(nullptr, 0, &none));
  refuses(rbvi_open_memory(image_.data(), image_.size(), nullptr));
  refuses(rbvi_open_memory("rbvi-img", 8, &none));
  std::string other = image_;
  other[8] = static_cast<char>(other[8] + 1);
  refuses(rbvi_open_memory(other.data(), other.size(), &none));
  EXPECT_NE(std::string(rbvi_error()).find("version"), std::string::npos);
  for (std::size_t length = 0; length < image_.size(); length += 1 + image_.size() / 50)
    refuses(rbvi_open_memory(image_.data(), length, &none));
  for (std::size_t byte = 24; byte < image_.size(); byte += 1 + image_.size() / 50) {
    std::string damaged = image_;
    damaged[byte] = static_cast<char>(damaged[byte] ^ 0x10);
    refuses(rbvi_open_memory(damaged.data(), damaged.size(), &none));
  }
  EXPECT_EQ(none, nullptr);
}

TEST_F(Refusals, OfHandles) {
  rbvi_model *closed = nullptr;
  ASSERT_EQ(rbvi_open_memory(image_.data(), image_.size(), &closed), RBVI_OK);
  rbvi_workspace *of_closed = nullptr;
  ASSERT_EQ(rbvi_workspace_new(closed, &of_closed), RBVI_OK);
  rbvi_close(closed);
  EXPECT_EQ(rbvi_solve(of_closed, mu_.data(), 0), RBVI_OK) << "it stays valid";
  rbvi_workspace *none = nullptr;
  refuses(rbvi_workspace_new(closed, &none));
  refuses(rbvi_workspace_new(nullptr, &none));
  refuses(rbvi_workspace_new(handle_, nullptr));
  EXPECT_EQ(rbvi_parameter_count(closed), 0U);
  EXPECT_EQ(rbvi_output_count(nullptr), 0U);
  EXPECT_EQ(rbvi_contact_count(closed), 0U);
  rbvi_close(closed);
  rbvi_close(nullptr);
  rbvi_workspace_free(of_closed);
  rbvi_workspace_free(of_closed);
  rbvi_workspace_free(nullptr);
  refuses(rbvi_solve(of_closed, mu_.data(), 0));
  refuses(rbvi_outputs(of_closed, values_.data()));
}

TEST_F(Refusals, OfNumbers) {
  refuses(rbvi_solve(workspace_, nullptr, 0));
  for (const double wrong : {outside_, double(NAN), double(INFINITY)}) {
    const std::vector<double> mu(mu_.size(), wrong);
    refuses(rbvi_solve(workspace_, mu.data(), 0));
    refuses(rbvi_outputs(workspace_, values_.data())); // there is no answer
  }
  const std::vector<double> nan(mu_.size(), NAN);
  refuses(rbvi_solve(workspace_, nan.data(), RBVI_EXTRAPOLATE));
  rbvi_parameter parameter;
  rbvi_output output;
  const char *name = nullptr;
  refuses(rbvi_parameter_at(handle_, mu_.size(), &parameter));
  refuses(rbvi_parameter_at(handle_, 0, nullptr));
  refuses(rbvi_output_at(handle_, values_.size(), &output));
  refuses(rbvi_output_at(handle_, 0, nullptr));
  refuses(rbvi_contact_name(handle_, 7, &name));
  refuses(rbvi_contact_name(handle_, 0, nullptr));
  refuses(rbvi_scene(handle_, nullptr));
  refuses(rbvi_solve_many(handle_, nullptr, 1, 1, 0, values_.data(), nullptr, nullptr, nullptr,
                          nullptr));
  refuses(
      rbvi_solve_many(handle_, mu_.data(), 1, 1, 0, nullptr, nullptr, nullptr, nullptr, nullptr));
}

TEST_F(Refusals, OfWhatIsNotThere) {
  rbvi_grid grid;
  rbvi_column column;
  rbvi_answer answer;
  refuses(rbvi_answer_of(workspace_, &answer));
  refuses(rbvi_errors(workspace_, values_.data(), nullptr));
  refuses(rbvi_contact(workspace_, 0, &grid));
  ASSERT_EQ(rbvi_solve(workspace_, mu_.data(), 0), RBVI_OK) << rbvi_error();
  EXPECT_STREQ(rbvi_error(), "");
  refuses(rbvi_answer_of(workspace_, nullptr));
  refuses(rbvi_outputs(workspace_, nullptr));
  refuses(rbvi_contact(workspace_, 9, &grid));
  refuses(rbvi_contact(workspace_, 0, nullptr));
  refuses(rbvi_column_at(workspace_, 0, &column));
  refuses(rbvi_field(workspace_, &grid), RBVI_NO_ANSWER); // packed without fields
}

TEST_F(Refusals, RowsOfATableSayWhy) {
  std::vector<double> mus(3 * mu_.size(), mu_.front()), table(3 * values_.size());
  std::fill_n(mus.begin() + static_cast<Index>(mu_.size()), mu_.size(), outside_);
  std::vector<rbvi_status> statuses(3);
  std::vector<std::string> reasons(3);
  const auto tell = [](std::size_t row, const char *reason, void *context) {
    static_cast<std::vector<std::string> *>(context)->at(row) = reason;
  };
  ASSERT_EQ(rbvi_solve_many(handle_, mus.data(), 3, 2, 0, table.data(), nullptr, statuses.data(),
                            tell, &reasons),
            RBVI_OK);
  EXPECT_EQ(statuses, (std::vector{RBVI_OK, RBVI_BAD_INPUT, RBVI_OK}));
  EXPECT_NE(reasons[1], "");
  EXPECT_EQ(reasons[0] + reasons[2], "");
  EXPECT_TRUE(std::isnan(table[values_.size()]));
  ASSERT_EQ(rbvi_solve_many(handle_, mus.data(), 3, 2, RBVI_EXTRAPOLATE, table.data(), nullptr,
                            statuses.data(), nullptr, nullptr),
            RBVI_OK);
}

TEST_F(Refusals, OfTwoThreadsOnOneWorkspace) {
  std::atomic<int> busy = 0, others = 0;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&] {
        for (int i = 0; i < 200; ++i) {
          const rbvi_status status = rbvi_solve(workspace_, mu_.data(), 0);
          ++(status == RBVI_BUSY ? busy : others);
          if (status != RBVI_BUSY) EXPECT_EQ(status, RBVI_OK);
        }
      });
  }
  EXPECT_GT(others, 0);
  EXPECT_EQ(busy + others, 800);
}

} // namespace
} // namespace rbvi
