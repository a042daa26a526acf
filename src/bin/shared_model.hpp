// What is behind the handles of rbvi.h.
#pragma once

#include "rbvi.h"
#include "rbvi/model/model_image.hpp"
#include "rbvi/model/online.hpp"

#include <atomic>
#include <memory>
#include <mutex>

namespace rbvi {

/// A model and what is said of it; shared by all threads.
class SharedModel {
public:
  /// The image stays where fields are to be read from it. Throws as model_in.
  SharedModel(std::vector<std::byte> image, std::string what);
  SharedModel(const SharedModel &) = delete;

  const ReducedModel &model() const { return model_; }
  const std::vector<OutputColumn> &columns() const { return columns_; }
  rbvi_parameter parameter(std::size_t i) const;
  rbvi_output output(std::size_t i) const;
  const std::string &contact_name(std::size_t i) const { return contacts_.at(i); }
  std::size_t contact_count() const { return contacts_.size(); }
  /// What parameters have to meet together: "that: says".
  const std::vector<std::string> &requirements() const { return requirements_; }
  /// The model with its fields, read when they are first asked for. Throws failure where the image
  /// has none.
  const ReducedModel &with_fields() const;

private:
  const std::vector<std::byte> image_;
  const std::string what_;
  const ReducedModel model_; ///< without its fields
  std::vector<OutputColumn> columns_;
  std::vector<std::string> output_units_, output_says_; ///< of each column
  std::vector<std::string> contacts_, requirements_;
  std::map<std::string, std::string> says_; ///< of parameters, by their names
  ErrorOfOutput mean_errors_, largest_errors_;
  mutable std::once_flag fields_read_;
  mutable std::unique_ptr<const ReducedModel> with_fields_;
};

/// A query and its answer, for one thread at a time.
class SharedQuery {
public:
  explicit SharedQuery(std::shared_ptr<const SharedModel> of);

  const SharedModel &of() const { return *of_; }
  /// Throws bad_input for numbers that are none, outside of the box unless `extrapolate`; failure
  /// where there is no answer.
  void solve(const double *mu, bool extrapolate);
  /// Those below need an answer, and throw bad_input without.
  void outputs(double *values) const;
  void errors(double *expected, double *bounds) const;
  void gradients(double *values, int *kinked);
  rbvi_answer answer() const;
  /// The grid stays until the next one.
  rbvi_grid contact(std::size_t i);
  rbvi_grid field();
  rbvi_column column(std::size_t i) const;

  std::atomic_flag busy{};

private:
  const ReducedAnswer &answered() const;
  double bound_of(const OutputColumn &column) const; ///< NaN: it has none
  rbvi_grid keep(Grid grid);

  std::shared_ptr<const SharedModel> of_;
  OnlineSolver solver_;
  Mu mu_;
  bool answered_ = false, inside_ = false;
  double seconds_ = 0;
  ReducedAnswer answer_;
  Outputs outputs_;
  Grid grid_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> points_; ///< of grid_
};

} // namespace rbvi
