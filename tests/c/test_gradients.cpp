// Gradients against differences of whole queries of sixth order, on a model of each kind; and by
// identities: the energy at its minimum, what B only scales.
#include "rbvi.h"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/gradient.hpp"
#include "rbvi/model/model_image.hpp"
#include "rbvi/model/published/queries.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>

namespace rbvi {
namespace {

struct Model {
  const char *name;
  double accuracy; ///< of the largest derivative of an output, over the box
};

/// Ten times what was met: round-off over the step of 1e-5. By the published law on fewer functions
/// answers themselves are exact to 1e-12 alone; so are those of bodies whose forces are balanced.
constexpr double usual = 2e-7, on_functions = 2e-6, balanced = 1e-6;

class Gradients : public testing::TestWithParam<Model> {
protected:
  static void SetUpTestSuite() {
    static std::once_flag once;
    std::call_once(once, add_published_queries);
  }
  void SetUp() override {
    model_ =
        read_model(std::filesystem::path(RBVI_MODELS) / GetParam().name / "model.h5", Registry{});
    solver_.emplace(model_);
    queries_ = parse_set(model_.scene.parameters, "random:25:7");
    std::ranges::copy(parse_set(model_.scene.parameters, "corners"), std::back_inserter(queries_));
    for (const Mu &mu : queries_)
      if (columns_.empty()) try_columns(mu);
  }
  void try_columns(const Mu &mu) {
    try {
      columns_ = columns_of({solver_->outputs(mu, solver_->solve(mu))});
    } catch (const Error &) { // no answer there
    }
  }
  const ParameterSpace &space() const { return model_.scene.parameters; }
  double width(int p) const { return space().at(p).upper - space().at(p).lower; }
  /// Columns of outputs at mu; NaN where there is none.
  Vector outputs_at(const Mu &mu) {
    const Outputs outputs = solver_->outputs(mu, solver_->solve(mu, true));
    return Vector::NullaryExpr(std::ssize(columns_),
                               [&](Index c) { return columns_[c].of(outputs).value_or(NAN); });
  }
  /// Of sixth order with steps h, inside of the box. At corners, where samples are, nodes change
  /// their states.
  Vector differences(const Mu &mu, int p, double h) {
    static const std::vector<double> both{-1, 9, -45, 0, 45, -9, 1},
        one_side{-147, 360, -450, 400, -225, 72, -10};
    const bool lower = mu[p] == space().at(p).lower, upper = mu[p] == space().at(p).upper;
    const std::vector<double> &weights = lower || upper ? one_side : both;
    const double step = upper ? -h : h;
    Vector result = Vector::Zero(std::ssize(columns_));
    for (int k = 0; k < 7; ++k) {
      Mu moved = mu;
      moved[p] += (lower || upper ? k : k - 3) * step;
      if (weights[k] != 0) result += weights[k] / (60 * step) * outputs_at(moved);
    }
    return result;
  }

  ReducedModel model_;
  std::optional<OnlineSolver> solver_;
  std::vector<Mu> queries_;
  std::vector<OutputColumn> columns_;
};

TEST_P(Gradients, AreTheLimitOfDifferences) {
  const Index columns = std::ssize(columns_);
  const auto parameters = static_cast<Index>(space().size());
  struct Compared {
    Matrix gradient, coarse, fine; ///< times the width of the box
  };
  std::vector<Compared> all;
  Vector largest = Vector::Zero(columns);
  for (const Mu &mu : queries_)
    try {
      Compared at{Matrix(columns, parameters), Matrix(columns, parameters),
                  Matrix(columns, parameters)};
      const ReducedAnswer answer = solver_->solve(mu);
      at.gradient = gradient_of(*solver_, mu, answer, columns_).values;
      for (int p = 0; p < space().size(); ++p) {
        at.coarse.col(p) = differences(mu, p, 2e-4 * width(p)) * width(p);
        at.fine.col(p) = differences(mu, p, 1e-4 * width(p)) * width(p);
        at.gradient.col(p) *= width(p);
      }
      for (Index c = 0; c < columns; ++c)
        if (at.fine.row(c).allFinite())
          largest[c] = std::max(largest[c], at.fine.row(c).cwiseAbs().maxCoeff());
      all.push_back(std::move(at));
    } catch (const Error &) { // no answer there, or beside it
    }
  int compared = 0;
  double worst = 0;
  for (const Compared &at : all)
    for (Index c = 0; c < columns; ++c) {
      if (columns_[c].kind != OutputKind::quantity) {
        EXPECT_TRUE(at.gradient.row(c).array().isNaN().all()) << columns_[c].name;
        continue;
      }
      for (Index p = 0; p < parameters; ++p) {
        // Where both differences agree no node changes its state on the way.
        if (!(std::abs(at.coarse(c, p) - at.fine(c, p)) <= 0.01 * GetParam().accuracy * largest[c]))
          continue;
        ++compared;
        const double error = std::abs(at.gradient(c, p) - at.fine(c, p)) / largest[c];
        worst = std::max(worst, error);
        EXPECT_LE(error, GetParam().accuracy)
            << columns_[c].name << " by " << space().at(static_cast<int>(p)).name << ": "
            << at.gradient(c, p) << " for " << at.fine(c, p);
      }
    }
  RecordProperty("worst", std::to_string(worst));
  EXPECT_GT(compared, 20);
}

TEST_P(Gradients, AreTheSameInC) {
  const std::string image = image_of(model_);
  rbvi_model *handle = nullptr;
  rbvi_workspace *workspace = nullptr;
  ASSERT_EQ(rbvi_open_memory(image.data(), image.size(), &handle), RBVI_OK) << rbvi_error();
  ASSERT_EQ(rbvi_workspace_new(handle, &workspace), RBVI_OK);
  const std::size_t count = rbvi_output_count(handle), parameters = rbvi_parameter_count(handle);
  std::vector<double> values(count * parameters);
  std::vector<int> kinked(parameters);
  EXPECT_EQ(rbvi_gradients(workspace, values.data(), kinked.data()), RBVI_BAD_INPUT);
  for (const Mu &mu : queries_) {
    if (rbvi_solve(workspace, mu.data(), 0) != RBVI_OK) continue;
    EXPECT_EQ(rbvi_gradients(workspace, nullptr, nullptr), RBVI_BAD_INPUT);
    ASSERT_EQ(rbvi_gradients(workspace, values.data(), kinked.data()), RBVI_OK) << rbvi_error();
    std::vector<double> outputs(count), after(count);
    ASSERT_EQ(rbvi_outputs(workspace, outputs.data()), RBVI_OK);
    OnlineSolver fresh(model_);
    const ReducedAnswer answer = fresh.solve(mu);
    const OutputGradient ours = gradient_of(fresh, mu, answer, columns_);
    for (std::size_t i = 0; i < count; ++i) {
      rbvi_output of;
      ASSERT_EQ(rbvi_output_at(handle, i, &of), RBVI_OK);
      const auto same = std::ranges::find(columns_, of.name, &OutputColumn::name);
      if (same == columns_.end()) continue;
      for (std::size_t p = 0; p < parameters; ++p) {
        const double value = ours.values(same - columns_.begin(), static_cast<Index>(p));
        const double theirs = values[i * parameters + p];
        EXPECT_TRUE(value == theirs || (std::isnan(value) && std::isnan(theirs))) << of.name;
      }
    }
    // The next answer does not depend on gradients that were asked for.
    ASSERT_EQ(rbvi_solve(workspace, mu.data(), 0), RBVI_OK);
    ASSERT_EQ(rbvi_outputs(workspace, after.data()), RBVI_OK);
    EXPECT_EQ(std::memcmp(outputs.data(), after.data(), count * sizeof(double)), 0);
    break;
  }
  rbvi_workspace_free(workspace);
  rbvi_close(handle);
}

INSTANTIATE_TEST_SUITE_P(Models, Gradients,
                         testing::Values(Model{"membrane", usual}, Model{"membrane_mcpg", usual},
                                         Model{"two_disks", usual}, Model{"two_disks_cone", usual},
                                         Model{"disk_condensed", usual}, Model{"disk_none", usual},
                                         Model{"disk_collocated", on_functions},
                                         Model{"disk_large", usual},
                                         Model{"disk_large_cone", usual},
                                         Model{"nitsche_empirical", usual},
                                         Model{"nitsche_interpolated", usual},
                                         Model{"free_block", balanced}, Model{"roller", usual}),
                         [](const auto &of) { return std::string(of.param.name); });

} // namespace
} // namespace rbvi
