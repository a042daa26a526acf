#include "shared_model.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/output_units.hpp"
#include "rbvi/model/gradient.hpp"
#include "rbvi/model/solution_vtu.hpp"
#include "rbvi/model/training_samples.hpp"
#include "rbvi/scene/stored_scene.hpp"

#include <chrono>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

const Registry &library() {
  static const Registry registry;
  return registry;
}

double of_output(const ErrorOfOutput &errors, const std::string &name) {
  const auto found = errors.find(name);
  return found == errors.end() ? unknown : found->second;
}

} // namespace

SharedModel::SharedModel(std::vector<std::byte> image, std::string what)
    : image_(std::move(image)), what_(std::move(what)),
      model_(model_in(image_, what_, library(), false)), columns_(columns_of_model(model_)),
      says_(texts_of_parameters(model_.scene)) {
  for (const OutputColumn &column : columns_) {
    output_units_.push_back(unit_of(model_.scene, column));
    output_says_.push_back(says_of(model_.scene, column));
  }
  for (std::size_t i = 0; i < model_.scene.contacts.size(); ++i)
    contacts_.push_back(rbvi::contact_name(model_.scene, i));
  const CaseNode tree = tree_in(model_.scene.tree);
  if (const CaseNode *require = tree.find("require"))
    for (const auto &[name, node] : require->entries) {
      const CaseNode *that = node.find("that"), *says = node.find("says");
      requirements_.push_back((that == nullptr ? name : that->value) +
                              (says == nullptr ? "" : ": " + says->value));
    }
  for (const OutputError &error : expected_errors(model_).outputs) {
    mean_errors_[error.name] = error.mean;
    largest_errors_[error.name] = error.max;
  }
}

rbvi_parameter SharedModel::parameter(std::size_t i) const {
  const Parameter &of = model_.scene.parameters.at(static_cast<int>(i));
  const auto says = says_.find(of.name);
  return {of.name.c_str(), of.unit.c_str(), says == says_.end() ? "" : says->second.c_str(),
          of.lower,        of.upper,        of.value};
}

rbvi_output SharedModel::output(std::size_t i) const {
  const OutputColumn &column = columns_.at(i);
  return {column.name.c_str(),
          output_units_[i].c_str(),
          output_says_[i].c_str(),
          static_cast<rbvi_output_kind>(column.kind),
          of_output(mean_errors_, column.name),
          of_output(largest_errors_, column.name)};
}

const ReducedModel &SharedModel::with_fields() const {
  std::call_once(fields_read_, [&] {
    with_fields_ = std::make_unique<const ReducedModel>(model_in(image_, what_, library(), true));
  });
  if (with_fields_->fields.basis.size() == 0)
    throw failure(what_ + " has no fields: pack the model again where its fields are beside it");
  return *with_fields_;
}

SharedQuery::SharedQuery(std::shared_ptr<const SharedModel> of)
    : of_(std::move(of)), solver_(of_->model()) {}

void SharedQuery::solve(const double *mu, bool extrapolate) {
  answered_ = false;
  const auto begin = std::chrono::steady_clock::now();
  const ParameterSpace &space = solver_.scene().parameters;
  mu_.assign(mu, mu + space.size());
  answer_ = solver_.solve(mu_, extrapolate);
  outputs_ = solver_.outputs(mu_, answer_);
  inside_ = in_box(space, mu_);
  seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  answered_ = true;
}

const ReducedAnswer &SharedQuery::answered() const {
  if (!answered_) throw bad_input("the workspace has no answer: call rbvi_solve before");
  return answer_;
}

void SharedQuery::outputs(double *values) const {
  answered();
  for (const OutputColumn &column : of_->columns())
    *values++ = column.of(outputs_).value_or(unknown);
}

void SharedQuery::errors(double *expected, double *bounds) const {
  answered();
  for (std::size_t i = 0; i < of_->columns().size(); ++i) {
    if (expected != nullptr) expected[i] = inside_ ? of_->output(i).largest_error : unknown;
    if (bounds != nullptr) bounds[i] = bound_of(of_->columns()[i]);
  }
}

double SharedQuery::bound_of(const OutputColumn &column) const {
  const auto within = interval_of(outputs_, column.name);
  const std::optional<double> value = column.of(outputs_);
  if (!within || !value) return unknown;
  return std::max(*value - within->front(), within->back() - *value);
}

void SharedQuery::gradients(double *values, int *kinked) {
  const OutputGradient found = gradient_of(solver_, mu_, answered(), of_->columns());
  Eigen::Map<decltype(points_)>(values, found.values.rows(), found.values.cols()) = found.values;
  if (kinked != nullptr) std::ranges::copy(found.kinked, kinked);
}

rbvi_answer SharedQuery::answer() const {
  const ReducedAnswer &of = answered();
  return {inside_,
          of.residual,
          seconds_,
          outputs_.expected_error_u.value_or(unknown),
          outputs_.expected_error_lambda.value_or(unknown),
          of.to_other};
}

rbvi_grid SharedQuery::keep(Grid grid) {
  grid_ = std::move(grid);
  points_ = grid_.points;
  return {static_cast<std::size_t>(points_.rows()),
          static_cast<std::size_t>(points_.cols()),
          grid_.cells.size() / static_cast<std::size_t>(grid_.per_cell),
          static_cast<std::size_t>(grid_.per_cell),
          grid_.of_nodes.size() + grid_.of_cells.size(),
          points_.data(),
          grid_.cells.data()};
}

rbvi_grid SharedQuery::contact(std::size_t i) {
  const ReducedAnswer &of = answered();
  if (i >= of_->contact_count()) throw bad_input("the model has no contact of this number");
  return keep(solver_.contact_grid(of, i));
}

rbvi_grid SharedQuery::field() {
  const ReducedAnswer &of = answered();
  const ReducedModel &model = of_->with_fields();
  const Scene &scene = solver_.scene();
  return keep(body_grid(scene, of.mu, model, field_of(scene, model.fields, of)));
}

rbvi_column SharedQuery::column(std::size_t i) const {
  const std::size_t nodal = grid_.of_nodes.size();
  if (i >= nodal + grid_.of_cells.size())
    throw bad_input("there is no such column: ask for a grid by rbvi_contact or rbvi_field before");
  const bool of_cells = i >= nodal;
  const Field &field = of_cells ? grid_.of_cells[i - nodal] : grid_.of_nodes[i];
  const Index places = of_cells ? std::ssize(grid_.cells) / grid_.per_cell : points_.rows();
  const Index components = places > 0 ? field.values.size() / places : 1;
  return {field.name.c_str(), field.unit.c_str(), of_cells, static_cast<std::size_t>(components),
          field.values.data()};
}

} // namespace rbvi
