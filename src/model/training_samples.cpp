#include "rbvi/model/training_samples.hpp"

#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/online.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// The smallest squared distance of `mu` to a column, in parts of the box; infinite without
/// columns.
double distance_to(const Matrix &columns, const ParameterSpace &space, const Mu &mu) {
  double smallest = std::numeric_limits<double>::infinity();
  for (Index k = 0; k < columns.cols(); ++k) {
    double square = 0;
    for (int i = 0; i < space.size(); ++i) {
      const double width = space.at(i).upper - space.at(i).lower;
      const double part = (columns(i, k) - mu[i]) / (width > 0 ? width : 1);
      square += part * part;
    }
    smallest = std::min(smallest, square);
  }
  return smallest;
}

} // namespace

Matrix as_columns(const std::vector<Mu> &set, int rows) {
  Matrix columns(rows, std::ssize(set));
  for (std::size_t k = 0; k < set.size(); ++k)
    columns.col(k) = Eigen::Map<const Vector>(set[k].data(), rows);
  return columns;
}

std::vector<Mu> from_columns(const Matrix &columns) {
  std::vector<Mu> set;
  for (const auto &column : columns.colwise())
    set.emplace_back(column.begin(), column.end());
  return set;
}

Outputs example_outputs(const ReducedModel &model,
                        const std::function<Outputs(const Mu &)> &answer) {
  std::vector<Mu> candidates = from_columns(model.made.trained_mu);
  for (Mu &mu : parse_set(model.scene.parameters, "random:100:1"))
    candidates.push_back(std::move(mu));
  for (const Mu &mu : candidates) {
    try {
      return answer(mu);
    } catch (const Error &) {
      continue;
    }
  }
  return {};
}

std::vector<OutputColumn> columns_of_model(const ReducedModel &model) {
  OnlineSolver solver(model);
  std::vector<OutputColumn> columns = columns_of(
      {example_outputs(model, [&](const Mu &mu) { return solver.outputs(mu, solver.solve(mu)); })});
  std::erase_if(columns, [](const OutputColumn &column) { return column.name == "seconds"; });
  return columns;
}

void check_asked(const std::vector<std::string> &only, const ReducedModel &model) {
  if (only.empty()) return;
  std::vector<std::string> known{"seconds"};
  if (model.scene.components == 1) known.emplace_back("min_u");
  for (const OutputColumn &column : columns_of_model(model))
    known.push_back(column.name);
  for (const std::string &name : only)
    if (std::ranges::find(known, name) == known.end())
      throw bad_input("the model has no output '" + name + "': the nearest is '" +
                      nearest_name(name, known) + "'");
}

bool nearest_sample_failed(const ReducedModel &model, const Mu &free) {
  return distance_to(model.made.failed_mu, model.scene.parameters, free) <
         distance_to(model.made.trained_mu, model.scene.parameters, free);
}

bool beyond_validation(const ReducedModel &model, const Mu &free) {
  return model.made.validated_mu.cols() > 0 && expected_errors(model).count > 0 &&
         nearer_to_boundary(model.scene.parameters, model.made.validated_mu, free);
}

} // namespace rbvi
