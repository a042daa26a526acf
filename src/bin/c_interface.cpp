#include "handles.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/io/system_error.hpp"
#include "rbvi/model/published/queries.hpp"
#include "rbvi/model/rows.hpp"
#include "shared_model.hpp"

#include <cmath>
#include <limits>

namespace rbvi {

namespace {

using Models = Handles<rbvi_model, const SharedModel>;
using Queries = Handles<rbvi_workspace, SharedQuery>;

/// Neither ends before the last thread does.
Models &models() {
  static auto *all = new Models;
  return *all;
}

Queries &queries() {
  static auto *all = new Queries;
  return *all;
}

std::string &last_error() {
  thread_local std::string text;
  return text;
}

rbvi_status refused(rbvi_status status, const std::string &text) {
  last_error() = text;
  return status;
}

/// The status of `work()`; nothing that it throws goes on.
template <class Work> rbvi_status guarded(Work &&work) noexcept {
  try {
    last_error().clear();
    work();
    return RBVI_OK;
  } catch (const Error &error) {
    return refused(error.status() == Status::bad_input ? RBVI_BAD_INPUT : RBVI_NO_ANSWER,
                   in_plain_words(error.what()));
  } catch (const std::exception &error) {
    return refused(RBVI_NO_ANSWER, in_plain_words(error.what()));
  } catch (...) {
    return refused(RBVI_NO_ANSWER, "an unknown failure");
  }
}

template <class T> T &there(T *pointer, const char *what) {
  if (pointer == nullptr) throw bad_input(std::string(what) + " is null");
  return *pointer;
}

std::shared_ptr<const SharedModel> opened(const rbvi_model *handle) {
  std::shared_ptr<const SharedModel> model = models().find(handle);
  if (!model) throw bad_input("the model is not open: rbvi_open makes one");
  return model;
}

/// work(model).
template <class Work> rbvi_status with_model(const rbvi_model *handle, Work &&work) noexcept {
  return guarded([&] { work(*opened(handle)); });
}

/// work(query), unless another thread uses it.
template <class Work> rbvi_status with_query(rbvi_workspace *handle, Work &&work) noexcept {
  bool busy = false;
  const rbvi_status status = guarded([&] {
    const std::shared_ptr<SharedQuery> query = queries().find(handle);
    if (!query) throw bad_input("the workspace is none: rbvi_workspace_new makes one");
    busy = query->busy.test_and_set(std::memory_order_acquire);
    if (busy) throw bad_input("the workspace is in use by another thread: each needs its own");
    struct Release {
      std::atomic_flag &flag;
      ~Release() { flag.clear(std::memory_order_release); }
    } const release{query->busy};
    work(*query);
  });
  return busy ? RBVI_BUSY : status;
}

void open_image(std::vector<std::byte> image, const std::string &what, rbvi_model **model) {
  there(model, "the place of the model");
  if (!is_image(image))
    throw bad_input(what + " is no image of a model: make one by rbvi-online MODEL --pack FILE");
  static std::once_flag published;
  std::call_once(published, add_published_queries);
  *model = models().add(std::make_shared<const SharedModel>(std::move(image), what));
}

/// Where rows of a table come from and go to.
struct Rows {
  const double *mu;
  std::size_t count;
  double *outputs, *residuals;
  rbvi_status *statuses;
  std::function<void(std::size_t, const char *)> tell;
};

void answer_row(SharedQuery &query, bool extrapolate, std::size_t row, const Rows &rows) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  const auto parameters = static_cast<std::size_t>(query.of().model().scene.parameters.size());
  const std::size_t columns = query.of().columns().size();
  double *outputs = rows.outputs + row * columns;
  const rbvi_status status = guarded([&] {
    query.solve(rows.mu + row * parameters, extrapolate);
    query.outputs(outputs);
    if (rows.residuals != nullptr) rows.residuals[row] = query.answer().residual;
  });
  if (rows.statuses != nullptr) rows.statuses[row] = status;
  if (status == RBVI_OK) return;
  std::fill_n(outputs, columns, unknown);
  if (rows.residuals != nullptr) rows.residuals[row] = unknown;
  rows.tell(row, last_error().c_str());
}

void answer_rows(const std::shared_ptr<const SharedModel> &model, bool extrapolate,
                 unsigned threads, const Rows &rows) {
  threads = threads_for(rows.count, threads);
  std::vector<std::unique_ptr<SharedQuery>> each; // made before any thread is: it may throw
  for (unsigned i = 0; i < threads; ++i)
    each.push_back(std::make_unique<SharedQuery>(model));
  over_rows(rows.count, threads, [&](unsigned thread, std::size_t row) {
    answer_row(*each[thread], extrapolate, row, rows);
  });
}

} // namespace

} // namespace rbvi

using namespace rbvi; // NOLINT: what follows is C

extern "C" {

const char *rbvi_version(void) {
  return RBVI_VERSION;
}

const char *rbvi_error(void) {
  return last_error().c_str();
}

rbvi_status rbvi_open(const char *file, rbvi_model **model) {
  return guarded([&] {
    there(file, "the name of the file");
    open_image(bytes_of_file(file), file, model);
  });
}

rbvi_status rbvi_open_memory(const void *image, size_t size, rbvi_model **model) {
  return guarded([&] {
    const auto *bytes = static_cast<const std::byte *>(image);
    there(bytes, "the image");
    open_image({bytes, bytes + size}, "the image", model);
  });
}

void rbvi_close(rbvi_model *model) {
  models().remove(model);
}

size_t rbvi_parameter_count(const rbvi_model *model) {
  const std::shared_ptr<const SharedModel> of = models().find(model);
  return of ? static_cast<size_t>(of->model().scene.parameters.size()) : 0;
}

size_t rbvi_output_count(const rbvi_model *model) {
  const std::shared_ptr<const SharedModel> of = models().find(model);
  return of ? of->columns().size() : 0;
}

size_t rbvi_contact_count(const rbvi_model *model) {
  const std::shared_ptr<const SharedModel> of = models().find(model);
  return of ? of->contact_count() : 0;
}

size_t rbvi_requirement_count(const rbvi_model *model) {
  const std::shared_ptr<const SharedModel> of = models().find(model);
  return of ? of->requirements().size() : 0;
}

rbvi_status rbvi_requirement_at(const rbvi_model *model, size_t i, const char **text) {
  return with_model(model, [&](const SharedModel &of) {
    if (i >= of.requirements().size()) throw bad_input("the model has no such requirement");
    there(text, "the text") = of.requirements()[i].c_str();
  });
}

rbvi_status rbvi_parameter_at(const rbvi_model *model, size_t i, rbvi_parameter *parameter) {
  return with_model(model, [&](const SharedModel &of) {
    if (i >= static_cast<size_t>(of.model().scene.parameters.size()))
      throw bad_input("the model has no parameter of this number");
    there(parameter, "the parameter") = of.parameter(i);
  });
}

rbvi_status rbvi_value(const rbvi_model *model, size_t i, const char *text, double *value) {
  return with_model(model, [&](const SharedModel &of) {
    const ParameterSpace &space = of.model().scene.parameters;
    if (i >= static_cast<size_t>(space.size()))
      throw bad_input("the model has no parameter of this number");
    const Parameter &parameter = space.at(static_cast<int>(i));
    there(value, "the value") =
        parse_value(parameter, &there(text, "the text"), "parameter " + parameter.name);
  });
}

rbvi_status rbvi_output_at(const rbvi_model *model, size_t i, rbvi_output *output) {
  return with_model(model, [&](const SharedModel &of) {
    if (i >= of.columns().size()) throw bad_input("the model has no output of this number");
    there(output, "the output") = of.output(i);
  });
}

rbvi_status rbvi_scene(const rbvi_model *model, const char **name) {
  return with_model(model, [&](const SharedModel &of) {
    there(name, "the name") = of.model().scene.name.c_str();
  });
}

rbvi_status rbvi_contact_name(const rbvi_model *model, size_t contact, const char **name) {
  return with_model(model, [&](const SharedModel &of) {
    if (contact >= of.contact_count()) throw bad_input("the model has no contact of this number");
    there(name, "the name") = of.contact_name(contact).c_str();
  });
}

rbvi_status rbvi_workspace_new(const rbvi_model *model, rbvi_workspace **workspace) {
  return guarded([&] {
    there(workspace, "the place of the workspace") =
        queries().add(std::make_shared<SharedQuery>(opened(model)));
  });
}

void rbvi_workspace_free(rbvi_workspace *workspace) {
  queries().remove(workspace);
}

rbvi_status rbvi_solve(rbvi_workspace *workspace, const double *mu, unsigned options) {
  return with_query(workspace, [&](SharedQuery &query) {
    query.solve(&there(mu, "mu"), (options & RBVI_EXTRAPOLATE) != 0);
  });
}

rbvi_status rbvi_outputs(rbvi_workspace *workspace, double *values) {
  return with_query(workspace,
                    [&](SharedQuery &query) { query.outputs(&there(values, "values")); });
}

rbvi_status rbvi_errors(rbvi_workspace *workspace, double *expected, double *bounds) {
  return with_query(workspace, [&](SharedQuery &query) { query.errors(expected, bounds); });
}

rbvi_status rbvi_gradients(rbvi_workspace *workspace, double *values, int *kinked) {
  return with_query(workspace,
                    [&](SharedQuery &query) { query.gradients(&there(values, "values"), kinked); });
}

rbvi_status rbvi_answer_of(rbvi_workspace *workspace, rbvi_answer *answer) {
  return with_query(workspace,
                    [&](SharedQuery &query) { there(answer, "the answer") = query.answer(); });
}

rbvi_status rbvi_solve_many(const rbvi_model *model, const double *mu, size_t rows,
                            unsigned threads, unsigned options, double *outputs, double *residuals,
                            rbvi_status *statuses, rbvi_reason reasons, void *context) {
  return guarded([&] {
    const std::shared_ptr<const SharedModel> of = opened(model);
    if (rows == 0) return;
    std::mutex one_at_a_time;
    const auto tell = [&](size_t row, const char *reason) {
      const std::lock_guard lock(one_at_a_time);
      if (reasons != nullptr) reasons(row, reason, context);
    };
    answer_rows(of, (options & RBVI_EXTRAPOLATE) != 0, threads,
                {&there(mu, "mu"), rows, &there(outputs, "outputs"), residuals, statuses, tell});
  });
}

rbvi_status rbvi_contact(rbvi_workspace *workspace, size_t contact, rbvi_grid *grid) {
  return with_query(workspace, [&](SharedQuery &query) {
    rbvi_grid &to = there(grid, "the grid");
    to = query.contact(contact);
  });
}

rbvi_status rbvi_field(rbvi_workspace *workspace, rbvi_grid *grid) {
  return with_query(workspace, [&](SharedQuery &query) {
    rbvi_grid &to = there(grid, "the grid");
    to = query.field();
  });
}

rbvi_status rbvi_column_at(rbvi_workspace *workspace, size_t i, rbvi_column *column) {
  return with_query(workspace,
                    [&](SharedQuery &query) { there(column, "the column") = query.column(i); });
}

} // extern "C"
