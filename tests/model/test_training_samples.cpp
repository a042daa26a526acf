#include "synthetic.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/model/print.hpp"
#include "rbvi/model/training_samples.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>
#include <sstream>
#include <unistd.h>

namespace rbvi::training_samples_test {
namespace {

/// Two free parameters, the first with ten times the width of the second.
ReducedModel wide_model() {
  ReducedModel model = synthetic::random_model({3, 2, 4, 3, 2, 1, 2}, 11);
  model.scene.parameters = free_only(model.scene.parameters, "radius,center_y");
  model.scene.parameters.all[0].lower = 0.1;
  model.scene.parameters.all[0].upper = 1.1;
  model.scene.parameters.all[2].lower = -0.05;
  model.scene.parameters.all[2].upper = 0.05;
  return model;
}

std::string printed(const ReducedModel &model) {
  std::ostringstream text;
  print_model(text, model);
  return text.str();
}

TEST(TrainingSamples, ColumnsComeBackAsTheSet) {
  const std::vector<Mu> set{{0.2, 0.01}, {0.3, -0.02}, {0.25, 0}};
  const Matrix columns = as_columns(set, 2);
  EXPECT_EQ(columns.rows(), 2);
  EXPECT_EQ(columns.cols(), 3);
  EXPECT_EQ(columns(1, 1), -0.02);
  EXPECT_EQ(from_columns(columns), set);
  EXPECT_EQ(as_columns({}, 2).rows(), 2);
  EXPECT_TRUE(from_columns(as_columns({}, 2)).empty());
}

TEST(TrainingSamples, DistancesAreInPartsOfTheBox) {
  ReducedModel model = wide_model();
  model.made.trained_mu = as_columns({{0.3, 0.05}, {1.1, 0}}, 2);
  model.made.failed_mu = as_columns({{0.5, 0}}, 2);
  // The first sample is 0.05 away, half a box; the failed one 0.2, a fifth of a box.
  EXPECT_TRUE(nearest_sample_failed(model, {0.3, 0}));
  EXPECT_FALSE(nearest_sample_failed(model, {0.3, 0.04}));
  EXPECT_TRUE(nearest_sample_failed(model, {0.79, 0}));
  EXPECT_FALSE(nearest_sample_failed(model, {0.81, 0}));
}

TEST(TrainingSamples, WithoutFailuresNoneIsNear) {
  ReducedModel model = wide_model();
  EXPECT_FALSE(nearest_sample_failed(model, {0.3, 0}));
  model.made.trained_mu = as_columns({{0.3, 0.05}}, 2);
  EXPECT_FALSE(nearest_sample_failed(model, {1.1, -0.05}));
}

TEST(TrainingSamples, TheModelFileKeepsThem) {
  const auto path = std::filesystem::path(testing::TempDir()) /
                    ("rbvi_training_" + std::to_string(::getpid()) + ".h5");
  ReducedModel model = synthetic::random_model({3, 2, 4, 3, 2, 1, 2}, 11);
  model.scene.parameters = free_only(model.scene.parameters, "radius,center_y");
  model.made.trained_mu = as_columns({{0.18, 0.05}, {0.24, 0}}, 2);
  model.made.failed_mu = as_columns({{0.2, 0}}, 2);
  write_model(model, path);
  const ReducedModel back = read_model(path, catalogue(), false);
  std::filesystem::remove(path);
  std::filesystem::remove(fields_file(path));
  EXPECT_EQ(back.made.trained_mu, model.made.trained_mu);
  EXPECT_EQ(back.made.failed_mu, model.made.failed_mu);
}

TEST(TrainingSamples, OtherNumbersOfParametersAreInconsistent) {
  for (Matrix ModelHistory::*member : {&ModelHistory::trained_mu, &ModelHistory::failed_mu}) {
    ReducedModel model = wide_model();
    model.made.*member = Matrix::Zero(3, 2);
    EXPECT_THROW(check_model(model), Error);
    model.made.*member = Matrix::Zero(2, 2);
    EXPECT_NO_THROW(check_model(model));
    (model.made.*member)(1, 0) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(check_model(model), Error);
  }
}

TEST(TrainingSamples, FailedOnesArePrinted) {
  ReducedModel model = wide_model();
  model.made.trained_mu = as_columns({{0.3, 0.05}, {1.1, 0}}, 2);
  EXPECT_EQ(printed(model).find("failed samples"), std::string::npos);
  model.made.failed_mu = as_columns({{0.5, 0.01}}, 2);
  EXPECT_NE(printed(model).find("1 of 3, without"), std::string::npos) << printed(model);
  EXPECT_NE(printed(model).find("radius=0.5 center_y=0.01"), std::string::npos);
  model.made.failed_mu = as_columns(std::vector<Mu>(74, {0.5, 0.01}), 2);
  EXPECT_NE(printed(model).find("and 64 more"), std::string::npos) << printed(model);
}

} // namespace
} // namespace rbvi::training_samples_test
