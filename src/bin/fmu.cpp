// The functions of FMI 2.0 for co-simulation, on rbvi.h. Outputs follow the inputs whatever was
// called before, and time changes nothing; include/rbvi/model/fmu.hpp has the value references.
#include "rbvi.h"
#include "rbvi/io/image.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>

namespace {

using fmi2String = const char *;
using fmi2Boolean = int;
using fmi2ValueReference = unsigned;
enum fmi2Status { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error };
enum fmi2Type { fmi2ModelExchange, fmi2CoSimulation };
enum fmi2StatusKind { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated };
struct fmi2CallbackFunctions {
  void (*logger)(void *environment, fmi2String instance, fmi2Status status, fmi2String category,
                 fmi2String message, ...);
  void *(*allocate)(std::size_t count, std::size_t size);
  void (*free)(void *memory);
  void (*step_finished)(void *environment, fmi2Status status);
  void *environment;
};

void check(rbvi_status of) {
  if (of != RBVI_OK) throw std::runtime_error(rbvi_error());
}

/// An instance.
struct Unit {
  std::string name, why; ///< `why` there is no answer
  fmi2CallbackFunctions callbacks{};
  rbvi_model *model = nullptr;
  rbvi_workspace *workspace = nullptr;
  std::size_t inputs = 0, outputs = 0;
  std::vector<double> reals; ///< by their value references
  rbvi_status status = RBVI_OK;
  bool answered = false;
  double time = 0; ///< of the last step with an answer

  Unit() = default;
  Unit(const Unit &) = delete;
  ~Unit() {
    rbvi_workspace_free(workspace);
    rbvi_close(model);
  }

  /// A line in the simulator's log, where % and # are formats unless they are doubled.
  fmi2Status tell(fmi2Status as, const std::string &text) const {
    const char *categories[] = {"", "logStatusWarning", "logStatusDiscard", "logStatusError"};
    std::string message;
    for (const char c : text)
      message.append(c == '%' || c == '#' ? 2 : 1, c);
    if (callbacks.logger != nullptr)
      callbacks.logger(callbacks.environment, name.c_str(), as, categories[as], message.c_str());
    return as;
  }

  void open(const std::filesystem::path &image, const std::string &guid) {
    const std::string own = rbvi::guid_of(rbvi::bytes_of_file(image, 32));
    if (guid != own)
      throw std::runtime_error("the GUID is " + guid + ", that of the image " + own +
                               ": unpack the unit again");
    check(rbvi_open(image.c_str(), &model));
    check(rbvi_workspace_new(model, &workspace));
    inputs = rbvi_parameter_count(model);
    outputs = rbvi_output_count(model);
    reals.resize(inputs + 2 * outputs + 1);
    reset();
  }

  void reset() {
    for (std::size_t i = 0; i < inputs; ++i) {
      rbvi_parameter of;
      check(rbvi_parameter_at(model, i, &of));
      reals[i] = std::clamp(of.value, of.lower, of.upper);
    }
    answered = false;
  }

  /// Answers the inputs, unless it did; without an answer outputs are NaN.
  rbvi_status answer() {
    if (answered) return status;
    rbvi_answer facts{};
    double *to = reals.data() + inputs;
    status = rbvi_solve(workspace, reals.data(), 0);
    if (status == RBVI_OK) status = rbvi_outputs(workspace, to);
    if (status == RBVI_OK) status = rbvi_errors(workspace, to + outputs, nullptr);
    if (status == RBVI_OK) status = rbvi_answer_of(workspace, &facts);
    why = rbvi_error();
    reals.back() = facts.residual;
    if (status != RBVI_OK)
      std::fill_n(to, 2 * outputs + 1, std::numeric_limits<double>::quiet_NaN());
    answered = true;
    return status;
  }
};

/// Of "file:///a%20b", "file://host/a" and "file:/a".
std::filesystem::path path_of(const std::string &uri) {
  std::size_t at = uri.starts_with("file:") ? 5 : 0;
  if (uri.compare(at, 2, "//") == 0) at = std::min(uri.find('/', at + 2), uri.size());
  std::string path;
  for (; at < uri.size(); ++at) {
    unsigned char byte = 0;
    const char *hex = uri.data() + at + 1;
    if (uri[at] == '%' && at + 2 < uri.size() &&
        std::from_chars(hex, hex + 2, byte, 16).ptr == hex + 2)
      path += static_cast<char>(byte), at += 2;
    else
      path += uri[at];
  }
  return path;
}

/// work(unit), where there is one; what it throws becomes a line in the log and fmi2Error.
template <class Work> fmi2Status with(void *unit, Work &&work) noexcept {
  if (unit == nullptr) return fmi2Error;
  auto &of = *static_cast<Unit *>(unit);
  try {
    return work(of);
  } catch (const std::exception &error) {
    return of.tell(fmi2Error, error.what());
  }
}

/// Throws where a reference is not among those from `first` on, below `end`.
void check_variables(const fmi2ValueReference *references, std::size_t count, const void *values,
                     std::size_t first, std::size_t end) {
  if (count > 0 && (references == nullptr || values == nullptr))
    throw std::runtime_error("value references or values are null");
  for (std::size_t i = 0; i < count; ++i)
    if (references[i] < first || references[i] >= end)
      throw std::runtime_error("the call takes no variable of value reference " +
                               std::to_string(references[i]));
}

} // namespace

// A function of FMI that always has the same status, and why.
#define RBVI_ALWAYS(status, text, function, ...)                                                   \
  fmi2Status function(void *unit __VA_OPT__(, ) __VA_ARGS__) {                                     \
    return with(unit, [](Unit &of) { return status == fmi2OK ? fmi2OK : of.tell(status, text); }); \
  }
#define RBVI_NO_VARIABLES(function, type)                                                          \
  fmi2Status function(void *unit, const fmi2ValueReference *references, std::size_t count,         \
                      type *values) {                                                              \
    return with(unit, [&](Unit &) {                                                                \
      check_variables(references, count, values, 0, 0);                                            \
      return fmi2OK;                                                                               \
    });                                                                                            \
  }

extern "C" {

const char *fmi2GetTypesPlatform() {
  return "default";
}

const char *fmi2GetVersion() {
  return "2.0";
}

void *fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                      const fmi2CallbackFunctions *callbacks, fmi2Boolean, fmi2Boolean) {
  std::unique_ptr<Unit> unit(new (std::nothrow) Unit);
  if (!unit || callbacks == nullptr) return nullptr;
  unit->callbacks = *callbacks;
  const fmi2Status status = with(unit.get(), [&](Unit &of) {
    if (name == nullptr || guid == nullptr || resources == nullptr)
      throw std::runtime_error("the name, the GUID or the folder of resources is null");
    of.name = name;
    if (type != fmi2CoSimulation) throw std::runtime_error("the unit is one for co-simulation");
    of.open(path_of(resources) / "model.rbvi", guid);
    return fmi2OK;
  });
  return status == fmi2OK ? unit.release() : nullptr;
}

void fmi2FreeInstance(void *unit) {
  delete static_cast<Unit *>(unit);
}

fmi2Status fmi2SetupExperiment(void *unit, fmi2Boolean, double, double start, fmi2Boolean, double) {
  return with(unit, [&](Unit &of) {
    of.time = start;
    return fmi2OK;
  });
}

fmi2Status fmi2ExitInitializationMode(void *unit) {
  return with(unit, [](Unit &of) {
    return of.answer() == RBVI_OK ? fmi2OK : of.tell(fmi2Warning, of.why);
  });
}

fmi2Status fmi2Reset(void *unit) {
  return with(unit, [](Unit &of) {
    of.reset();
    return fmi2OK;
  });
}

fmi2Status fmi2DoStep(void *unit, double start, double length, fmi2Boolean) {
  return with(unit, [&](Unit &of) {
    if (!(length > 0)) throw std::runtime_error("the length of a step is not above 0");
    if (of.answer() != RBVI_OK) return of.tell(fmi2Discard, of.why);
    of.time = start + length;
    return fmi2OK;
  });
}

fmi2Status fmi2GetReal(void *unit, const fmi2ValueReference *references, std::size_t count,
                       double *values) {
  return with(unit, [&](Unit &of) {
    check_variables(references, count, values, 0, of.reals.size());
    for (std::size_t i = 0; i < count; ++i) {
      if (references[i] >= of.inputs) of.answer();
      values[i] = of.reals[references[i]];
    }
    return fmi2OK;
  });
}

fmi2Status fmi2SetReal(void *unit, const fmi2ValueReference *references, std::size_t count,
                       const double *values) {
  return with(unit, [&](Unit &of) {
    check_variables(references, count, values, 0, of.inputs);
    for (std::size_t i = 0; i < count; ++i)
      of.reals[references[i]] = values[i];
    of.answered = of.answered && count == 0;
    return fmi2OK;
  });
}

fmi2Status fmi2GetInteger(void *unit, const fmi2ValueReference *references, std::size_t count,
                          int *values) {
  return with(unit, [&](Unit &of) {
    check_variables(references, count, values, 0, 1);
    std::fill_n(values, count, of.answer());
    return fmi2OK;
  });
}

/// Errors of outputs are constant; residuals have no derivative.
fmi2Status fmi2GetDirectionalDerivative(void *unit, const fmi2ValueReference *unknowns,
                                        std::size_t rows, const fmi2ValueReference *knowns,
                                        std::size_t columns, const double *direction,
                                        double *derivatives) {
  return with(unit, [&](Unit &of) {
    check_variables(knowns, columns, direction, 0, of.inputs);
    check_variables(unknowns, rows, derivatives, of.inputs, of.reals.size());
    if (of.answer() != RBVI_OK) throw std::runtime_error(of.why);
    std::vector<double> gradients((of.outputs * 2 + 1) * of.inputs);
    check(rbvi_gradients(of.workspace, gradients.data(), nullptr));
    std::fill_n(gradients.rbegin(), of.inputs, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < rows; ++i) {
      const double *row = gradients.data() + (unknowns[i] - of.inputs) * of.inputs;
      derivatives[i] = 0;
      for (std::size_t j = 0; j < columns; ++j)
        derivatives[i] += row[knowns[j]] * direction[j];
    }
    return fmi2OK;
  });
}

fmi2Status fmi2GetRealStatus(void *unit, fmi2StatusKind kind, double *value) {
  return with(unit, [&](Unit &of) {
    if (kind != fmi2LastSuccessfulTime || value == nullptr)
      return of.tell(fmi2Discard, "a step has no such status");
    *value = of.time;
    return fmi2OK;
  });
}

fmi2Status fmi2GetBooleanStatus(void *unit, fmi2StatusKind kind, fmi2Boolean *value) {
  return with(unit, [&](Unit &of) {
    if (kind != fmi2Terminated || value == nullptr)
      return of.tell(fmi2Discard, "a step has no such status");
    *value = 0;
    return fmi2OK;
  });
}

RBVI_NO_VARIABLES(fmi2SetInteger, const int)
RBVI_NO_VARIABLES(fmi2GetBoolean, fmi2Boolean)
RBVI_NO_VARIABLES(fmi2SetBoolean, const fmi2Boolean)
RBVI_NO_VARIABLES(fmi2GetString, fmi2String)
RBVI_NO_VARIABLES(fmi2SetString, const fmi2String)
RBVI_ALWAYS(fmi2OK, "", fmi2SetDebugLogging, fmi2Boolean, std::size_t, const fmi2String *)
RBVI_ALWAYS(fmi2OK, "", fmi2EnterInitializationMode)
RBVI_ALWAYS(fmi2OK, "", fmi2Terminate)
RBVI_ALWAYS(fmi2Discard, "no step is pending", fmi2GetStatus, fmi2StatusKind, fmi2Status *)
RBVI_ALWAYS(fmi2Discard, "no step is pending", fmi2GetIntegerStatus, fmi2StatusKind, int *)
RBVI_ALWAYS(fmi2Discard, "no step is pending", fmi2GetStringStatus, fmi2StatusKind, fmi2String *)
RBVI_ALWAYS(fmi2Error, "no step is pending", fmi2CancelStep)
RBVI_ALWAYS(fmi2Error, "a unit gives no state", fmi2GetFMUstate, void **)
RBVI_ALWAYS(fmi2Error, "a unit takes no state", fmi2SetFMUstate, void *)
RBVI_ALWAYS(fmi2Error, "a unit gives no state", fmi2FreeFMUstate, void **)
RBVI_ALWAYS(fmi2Error, "a unit gives no state", fmi2SerializedFMUstateSize, void *, std::size_t *)
RBVI_ALWAYS(fmi2Error, "a unit gives no state", fmi2SerializeFMUstate, void *, char *, std::size_t)
RBVI_ALWAYS(fmi2Error, "a unit takes no state", fmi2DeSerializeFMUstate, const char *, std::size_t,
            void **)
RBVI_ALWAYS(fmi2Error, "a unit takes no derivatives", fmi2SetRealInputDerivatives,
            const fmi2ValueReference *, std::size_t, const int *, const double *)
RBVI_ALWAYS(fmi2Error, "a unit gives no derivatives", fmi2GetRealOutputDerivatives,
            const fmi2ValueReference *, std::size_t, const int *, double *)

} // extern "C"
