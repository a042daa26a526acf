// A simulator that loads units of co-simulation, which rbvi-online packed, by dlopen: their outputs
// are those of rbvi.h to the last bit, in any number of instances and threads; and what they
// refuse.
#include "rbvi.h"
#include "rbvi/model/fmu.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <numeric>
#include <random>
#include <regex>
#include <thread>
#include <unistd.h>

namespace {

namespace fs = std::filesystem;

constexpr int ok = 0, warning = 1, discard = 2, error = 3; ///< fmi2Status
constexpr int model_exchange = 0, co_simulation = 1;       ///< fmi2Type

struct Callbacks {
  void (*logger)(void *, const char *, int, const char *, const char *, ...);
  void *(*allocate)(std::size_t, std::size_t);
  void (*free)(void *);
  void (*step_finished)(void *, int);
  void *environment;
};

struct Line {
  std::string instance, category, text;
  int status;
};

using Log = std::vector<Line>;

/// As simulators do: printf's format, then ## for #.
void log_line(void *log, const char *instance, int status, const char *category, const char *format,
              ...) {
  char text[4096];
  va_list values;
  va_start(values, format);
  std::vsnprintf(text, sizeof text, format, values);
  va_end(values);
  static_cast<Log *>(log)->push_back(
      {instance, category, std::regex_replace(text, std::regex("##"), "#"), status});
}

int run(const std::string &command) {
  return std::system(command.c_str()); // NOLINT: one thread
}

std::string quoted(const fs::path &path) {
  return "'" + path.string() + "'";
}

fs::path new_folder(const std::string &name) {
  const fs::path folder =
      fs::path(testing::TempDir()) / ("rbvi_fmu_" + std::to_string(::getpid())) / name;
  fs::create_directories(folder);
  return folder;
}

/// Blanks, percents and letters beyond ASCII as %XX.
std::string encoded(const std::string &path) {
  std::string text;
  for (const char c : path) {
    char code[8];
    std::snprintf(code, sizeof code, "%%%02X",
                  static_cast<unsigned>(static_cast<unsigned char>(c)));
    text += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '/' ? std::string(1, c) : code;
  }
  return text;
}

/// A unit that is unpacked and loaded, and the image beside it; the model itself is gone.
struct Loaded {
  fs::path folder, image;
  std::string guid;
  std::map<std::string, unsigned> references;
  void *library = nullptr;

  /// Of the model of a small run, by rbvi-online.
  Loaded(const std::string &name, const std::string &folder_name)
      : folder(new_folder(folder_name)), image(folder / "packed.rbvi") {
    const fs::path model = folder / "model.h5";
    fs::copy_file(fs::path(RBVI_MODELS) / name / "model.h5", model);
    const std::string online = RBVI_ONLINE " " + quoted(model);
    EXPECT_EQ(run(online + " --pack " + quoted(image) + " > /dev/null"), 0);
    EXPECT_EQ(run(online + " --fmu " + quoted(folder / "unit.fmu") + " > /dev/null"), 0);
    fs::remove(model);
    unpack();
  }
  /// Of the bytes of a unit.
  explicit Loaded(const std::string &unit) : folder(new_folder("bytes")) {
    std::ofstream(folder / "unit.fmu", std::ios::binary) << unit;
    unpack();
  }
  void unpack() {
    const fs::path unit = folder / "unit.fmu";
    EXPECT_EQ(run("/usr/bin/python3 -m zipfile -e " + quoted(unit) + " " + quoted(folder)), 0);
    fs::remove(unit);
    std::ifstream file(folder / "modelDescription.xml");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    std::smatch found;
    EXPECT_TRUE(std::regex_search(text, found, std::regex("guid=\"([^\"]+)\"")));
    guid = found[1];
    const std::regex variable("ScalarVariable name=\"([^\"]+)\" valueReference=\"(\\d+)\"");
    for (std::sregex_iterator at(text.begin(), text.end(), variable), end; at != end; ++at)
      references[(*at)[1]] = static_cast<unsigned>(std::stoul((*at)[2]));
    for (const auto &entry : fs::directory_iterator(folder / "binaries/linux64"))
      library = dlopen(entry.path().c_str(), RTLD_NOW | RTLD_LOCAL);
    EXPECT_NE(library, nullptr) << dlerror();
  }
  Loaded(const Loaded &) = delete;
  ~Loaded() {
    dlclose(library);
    fs::remove_all(folder);
  }

  template <class... Arguments> int call(const char *name, Arguments... arguments) const {
    return function<int, Arguments...>(name)(arguments...);
  }
  template <class Result, class... Arguments> auto function(const char *name) const {
    auto *found = reinterpret_cast<Result (*)(Arguments...)>(dlsym(library, name)); // NOLINT
    EXPECT_NE(found, nullptr) << name;
    return found;
  }
  std::string location() const { return "file://" + encoded((folder / "resources").string()); }
  void *instance(Log &log, const char *name, int type, const char *key, const char *where) const {
    const Callbacks callbacks{log_line, nullptr, nullptr, nullptr, &log}; // units keep their own
    return function<void *, const char *, int, const char *, const char *, const Callbacks *, int,
                    int>("fmi2Instantiate")(name, type, key, where, &callbacks, 0, 0);
  }
  void *instance(Log &log) const {
    return instance(log, "it", co_simulation, guid.c_str(), location().c_str());
  }
  void *initialized(Log &log) const {
    void *unit = instance(log);
    EXPECT_NE(unit, nullptr);
    EXPECT_EQ(call("fmi2SetupExperiment", unit, 0, 0.0, 2.0, 0, 0.0), ok);
    EXPECT_EQ(call("fmi2EnterInitializationMode", unit), ok);
    EXPECT_EQ(call("fmi2ExitInitializationMode", unit), ok);
    return unit;
  }
  int set(void *unit, const std::vector<double> &mu) const {
    std::vector<unsigned> all(mu.size());
    std::iota(all.begin(), all.end(), 0U);
    return call("fmi2SetReal", unit, static_cast<const unsigned *>(all.data()), all.size(),
                mu.data());
  }
  double real(void *unit, const std::string &name) const {
    const unsigned reference = references.at(name);
    double value = -77;
    EXPECT_EQ(call("fmi2GetReal", unit, &reference, std::size_t{1}, &value), ok);
    return value;
  }
  int status(void *unit) const {
    const unsigned reference = references.at("status");
    int value = -77;
    EXPECT_EQ(call("fmi2GetInteger", unit, &reference, std::size_t{1}, &value), ok);
    return value;
  }
  void end(void *unit) const {
    EXPECT_EQ(call("fmi2Terminate", unit), ok);
    function<void, void *>("fmi2FreeInstance")(unit);
  }
};

/// The unit of a small run, packed once for all tests that leave its files alone.
const Loaded &unit_of(const std::string &name) {
  static std::map<std::string, std::unique_ptr<const Loaded>> units;
  std::unique_ptr<const Loaded> &unit = units[name];
  if (!unit) unit = std::make_unique<const Loaded>(name, name + ", 100 % \u00e9tanche");
  return *unit;
}

/// The same model by rbvi.h.
struct Known {
  rbvi_model *model = nullptr;
  rbvi_workspace *workspace = nullptr;
  std::vector<std::string> parameters, outputs;
  std::vector<double> lower, upper, start;
  std::vector<bool> has_error; ///< of the outputs, in the unit

  explicit Known(const fs::path &image) {
    EXPECT_EQ(rbvi_open(image.c_str(), &model), RBVI_OK) << rbvi_error();
    EXPECT_EQ(rbvi_workspace_new(model, &workspace), RBVI_OK);
    for (std::size_t i = 0; i < rbvi_parameter_count(model); ++i) {
      rbvi_parameter of;
      EXPECT_EQ(rbvi_parameter_at(model, i, &of), RBVI_OK);
      parameters.emplace_back(of.name);
      lower.push_back(of.lower);
      upper.push_back(of.upper);
      start.push_back(of.value);
    }
    for (std::size_t i = 0; i < rbvi_output_count(model); ++i) {
      rbvi_output of;
      EXPECT_EQ(rbvi_output_at(model, i, &of), RBVI_OK);
      outputs.emplace_back(of.name);
      has_error.push_back(of.kind != RBVI_CHECK && !std::isnan(of.largest_error));
    }
  }
  Known(const Known &) = delete;
  ~Known() {
    rbvi_workspace_free(workspace);
    rbvi_close(model);
  }
  std::vector<double> drawn(std::mt19937 &draw) const {
    std::vector<double> mu;
    for (std::size_t i = 0; i < lower.size(); ++i)
      mu.push_back(lower[i] + (upper[i] - lower[i]) * std::uniform_real_distribution<>(0, 1)(draw));
    return mu;
  }
  /// Outputs, their errors, the residual; NaN without an answer.
  std::vector<double> answer(const std::vector<double> &mu) const {
    const std::size_t count = outputs.size();
    std::vector<double> values(2 * count + 1, NAN);
    rbvi_answer facts;
    if (rbvi_solve(workspace, mu.data(), 0) != RBVI_OK) return values;
    EXPECT_EQ(rbvi_outputs(workspace, values.data()), RBVI_OK);
    EXPECT_EQ(rbvi_errors(workspace, values.data() + count, nullptr), RBVI_OK);
    EXPECT_EQ(rbvi_answer_of(workspace, &facts), RBVI_OK);
    values.back() = facts.residual;
    return values;
  }
};

/// Whether all bits of what the unit gives are those of rbvi.h.
void expect_same(const Loaded &loaded, void *unit, const Known &known,
                 const std::vector<double> &mu) {
  const std::vector<double> values = known.answer(mu);
  const std::size_t count = known.outputs.size();
  const auto same = [&](const std::string &name, double value) {
    const double own = loaded.real(unit, name);
    EXPECT_TRUE(std::memcmp(&own, &value, sizeof own) == 0 ||
                (std::isnan(own) && std::isnan(value)))
        << name << ' ' << own << ' ' << value;
  };
  for (std::size_t i = 0; i < count; ++i) {
    same(known.outputs[i], values[i]);
    EXPECT_EQ(loaded.references.contains(known.outputs[i] + "_error"), known.has_error[i]);
    if (loaded.references.contains(known.outputs[i] + "_error"))
      same(known.outputs[i] + "_error", values[count + i]);
  }
  same("residual", values.back());
}

class Fmu : public testing::TestWithParam<const char *> {};

TEST_P(Fmu, OutputsAreThoseOfTheLibrary) {
  const Loaded &loaded = unit_of(GetParam());
  const Known known(loaded.image);
  Log log;
  void *unit = loaded.initialized(log);
  expect_same(loaded, unit, known, known.start);
  std::mt19937 draw(7);
  int answered = 0;
  for (int step = 0; step < 40; ++step) {
    const std::vector<double> mu = known.drawn(draw);
    ASSERT_EQ(loaded.set(unit, mu), ok);
    if (step % 2 == 0) { // else they are asked without a step
      const int done = loaded.call("fmi2DoStep", unit, 2.0 + step, 1.0, 1);
      EXPECT_EQ(done, loaded.status(unit) == 0 ? ok : discard);
      answered += done == ok ? 1 : 0;
    }
    expect_same(loaded, unit, known, mu);
    for (std::size_t i = 0; i < mu.size(); ++i)
      EXPECT_EQ(loaded.real(unit, known.parameters[i]), mu[i]);
  }
  EXPECT_GT(answered, 10);
  ASSERT_EQ(loaded.call("fmi2Reset", unit), ok);
  expect_same(loaded, unit, known, known.start);
  loaded.end(unit);
}

TEST_P(Fmu, DerivativesAreThoseOfTheLibrary) {
  const Loaded &loaded = unit_of(GetParam());
  const Known known(loaded.image);
  Log log;
  void *unit = loaded.initialized(log);
  std::mt19937 draw(11);
  const std::vector<double> mu = known.drawn(draw);
  std::vector<double> direction(mu.size()), gradients(known.outputs.size() * mu.size());
  std::vector<unsigned> inputs, outputs;
  for (std::size_t j = 0; j < mu.size(); ++j) {
    direction[j] = j % 2 == 0 ? 0.5 : -3;
    inputs.push_back(loaded.references.at(known.parameters[mu.size() - 1 - j])); // backwards
  }
  for (const std::string &name : known.outputs)
    outputs.push_back(loaded.references.at(name));
  outputs.push_back(loaded.references.at("residual"));
  std::vector<double> derivatives(outputs.size());
  ASSERT_EQ(loaded.set(unit, mu), ok);
  ASSERT_EQ(rbvi_solve(known.workspace, mu.data(), 0), RBVI_OK) << rbvi_error();
  ASSERT_EQ(rbvi_gradients(known.workspace, gradients.data(), nullptr), RBVI_OK) << rbvi_error();
  ASSERT_EQ(loaded.call("fmi2GetDirectionalDerivative", unit,
                        static_cast<const unsigned *>(outputs.data()), outputs.size(),
                        static_cast<const unsigned *>(inputs.data()), inputs.size(),
                        static_cast<const double *>(direction.data()), derivatives.data()),
            ok);
  int finite = 0;
  for (std::size_t i = 0; i < known.outputs.size(); ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < mu.size(); ++j)
      sum += gradients[i * mu.size() + mu.size() - 1 - j] * direction[j];
    EXPECT_TRUE(derivatives[i] == sum || (std::isnan(derivatives[i]) && std::isnan(sum)))
        << known.outputs[i] << ' ' << derivatives[i] << ' ' << sum;
    finite += std::isfinite(sum) ? 1 : 0;
  }
  EXPECT_GT(finite, 0);
  EXPECT_TRUE(std::isnan(derivatives.back()));
  expect_same(loaded, unit, known, mu);
  loaded.end(unit);
}

INSTANTIATE_TEST_SUITE_P(Models, Fmu,
                         testing::Values("membrane", "two_disks_cone", "disk_condensed",
                                         "disk_large", "disk_collocated", "nitsche_empirical",
                                         "nitsche_interpolated"),
                         [](const auto &of) { return std::string(of.param); });

class DiskUnit : public testing::Test {
protected:
  const Loaded &loaded_ = unit_of("disk_condensed");
  const Known known_{loaded_.image};
  Log log_;

  /// One line of this status, which says what; it is taken off the log.
  std::string one_line(int status) {
    EXPECT_EQ(log_.size(), 1U);
    if (log_.empty()) return "";
    const Line line = log_.back();
    log_.clear();
    EXPECT_EQ(line.status, status);
    EXPECT_EQ(line.category, status == error     ? "logStatusError"
                             : status == discard ? "logStatusDiscard"
                                                 : "logStatusWarning");
    EXPECT_FALSE(line.text.empty());
    EXPECT_EQ(line.text.find('\n'), std::string::npos) << line.text;
    return line.text;
  }
  void refused(int status) {
    EXPECT_EQ(status, error);
    one_line(error);
  }
};

TEST_F(DiskUnit, InstancesDoNotMeet) {
  void *first = loaded_.initialized(log_), *second = loaded_.initialized(log_);
  const Loaded copy("disk_condensed", "another");
  void *third = copy.initialized(log_);
  EXPECT_NE(copy.library, loaded_.library);
  std::mt19937 draw(3);
  const std::vector<double> one = known_.drawn(draw), two = known_.drawn(draw),
                            three = known_.drawn(draw);
  EXPECT_EQ(loaded_.set(first, one), ok);
  EXPECT_EQ(loaded_.set(second, two), ok);
  EXPECT_EQ(copy.set(third, three), ok);
  expect_same(loaded_, first, known_, one);
  loaded_.end(first);
  expect_same(copy, third, known_, three);
  expect_same(loaded_, second, known_, two);
  loaded_.end(second);
  copy.end(third);
}

TEST_F(DiskUnit, ThreadsHaveInstancesOfTheirOwn) {
  std::vector<std::jthread> threads;
  for (unsigned seed = 0; seed < 4; ++seed)
    threads.emplace_back([&, seed] {
      Log log;
      const Known known(loaded_.image);
      std::mt19937 draw(seed);
      void *unit = loaded_.initialized(log);
      for (int step = 0; step < 50; ++step) {
        const std::vector<double> mu = known.drawn(draw);
        EXPECT_EQ(loaded_.set(unit, mu), ok);
        EXPECT_EQ(loaded_.call("fmi2DoStep", unit, 2.0 + step, 1.0, 1), ok);
        expect_same(loaded_, unit, known, mu);
      }
      loaded_.end(unit);
    });
}

TEST_F(DiskUnit, OutsideOfTheBoxThereIsNoAnswer) {
  void *unit = loaded_.initialized(log_);
  EXPECT_EQ(loaded_.call("fmi2DoStep", unit, 2.0, 0.5, 1), ok);
  std::vector<double> outside = known_.start;
  outside[0] = known_.upper[0] + 1;
  EXPECT_EQ(loaded_.set(unit, outside), ok);
  EXPECT_TRUE(log_.empty());
  EXPECT_EQ(loaded_.call("fmi2DoStep", unit, 2.5, 0.5, 1), discard);
  EXPECT_NE(one_line(discard).find(known_.parameters[0]), std::string::npos);
  EXPECT_EQ(loaded_.status(unit), 2);
  for (const auto &[name, reference] : loaded_.references)
    if (name != "status" && reference >= known_.parameters.size())
      EXPECT_TRUE(std::isnan(loaded_.real(unit, name))) << name;
  double time = 0;
  int terminated = 7;
  EXPECT_EQ(loaded_.call("fmi2GetRealStatus", unit, 2, &time), ok);
  EXPECT_EQ(time, 2.5);
  EXPECT_EQ(loaded_.call("fmi2GetBooleanStatus", unit, 3, &terminated), ok);
  EXPECT_EQ(terminated, 0);
  outside[0] = NAN;
  EXPECT_EQ(loaded_.set(unit, outside), ok);
  EXPECT_EQ(loaded_.call("fmi2DoStep", unit, 2.5, 0.5, 1), discard);
  one_line(discard);
  EXPECT_EQ(loaded_.set(unit, known_.start), ok);
  EXPECT_EQ(loaded_.call("fmi2DoStep", unit, 2.5, 0.5, 1), ok);
  expect_same(loaded_, unit, known_, known_.start);
  EXPECT_EQ(loaded_.call("fmi2Reset", unit), ok);
  EXPECT_EQ(loaded_.set(unit, outside), ok);
  EXPECT_EQ(loaded_.call("fmi2ExitInitializationMode", unit), warning);
  one_line(warning);
  loaded_.end(unit);
}

TEST_F(DiskUnit, WhatAnInstanceIsRefusedFor) {
  const Loaded own("disk_condensed", "an image that is cut"); // its files change
  const std::string key = loaded_.guid, where = loaded_.location();
  const auto refuses = [&](const char *name, int type, const char *guid, const std::string &place,
                           const std::string &part) {
    EXPECT_EQ(loaded_.instance(log_, name, type, guid, place.empty() ? nullptr : place.c_str()),
              nullptr);
    const std::string text = one_line(error);
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  refuses("it", model_exchange, key.c_str(), where, "co-simulation");
  refuses("it", co_simulation, "{another}", where, "{another}");
  refuses("it", co_simulation, nullptr, where, "null");
  refuses(nullptr, co_simulation, key.c_str(), where, "null");
  refuses("it", co_simulation, key.c_str(), "", "null");
  refuses("it", co_simulation, key.c_str(), "file:///nowhere/50%25%23d",
          "/nowhere/50%#d/model.rbvi");
  refuses("it", co_simulation, key.c_str(), "file:", "model.rbvi");
  refuses("it", co_simulation, key.c_str(), "file://host", "model.rbvi");
  EXPECT_EQ((loaded_.function<void *, const char *, int, const char *, const char *,
                              const Callbacks *, int, int>("fmi2Instantiate")(
                "it", co_simulation, key.c_str(), where.c_str(), nullptr, 0, 0)),
            nullptr);
  const std::string path = encoded((loaded_.folder / "resources").string());
  for (const std::string &spelt :
       {"file:" + path, "file://localhost" + path, "file://" + path + "/"}) {
    void *unit = loaded_.instance(log_, "it", co_simulation, key.c_str(), spelt.c_str());
    EXPECT_NE(unit, nullptr) << spelt;
    loaded_.function<void, void *>("fmi2FreeInstance")(unit);
  }
  const fs::path image = own.folder / "resources/model.rbvi";
  fs::resize_file(image, fs::file_size(image) - 8);
  refuses("it", co_simulation, key.c_str(), own.location(), "truncated");
  fs::resize_file(image, 5);
  refuses("it", co_simulation, key.c_str(), own.location(), "image");
  EXPECT_TRUE(log_.empty());
}

TEST_F(DiskUnit, WhatCallsAreRefusedFor) {
  void *unit = loaded_.initialized(log_);
  const std::size_t one = 1, inputs = known_.parameters.size();
  unsigned wrong = 1000, input = 0, output = static_cast<unsigned>(inputs);
  double value = 0;
  int number = 0;
  const char *text = nullptr;
  unsigned *none = nullptr;
  refused(loaded_.call("fmi2GetReal", unit, &wrong, one, &value));
  refused(loaded_.call("fmi2SetReal", unit, &wrong, one, &value));
  refused(loaded_.call("fmi2SetReal", unit, &output, one, &value));
  refused(loaded_.call("fmi2GetReal", unit, none, one, &value));
  refused(loaded_.call("fmi2GetReal", unit, &input, one, static_cast<double *>(nullptr)));
  refused(loaded_.call("fmi2GetInteger", unit, &wrong, one, &number));
  for (const char *function : {"fmi2SetInteger", "fmi2GetBoolean", "fmi2SetBoolean"})
    refused(loaded_.call(function, unit, &input, one, &number));
  for (const char *function : {"fmi2GetString", "fmi2SetString"}) {
    refused(loaded_.call(function, unit, &input, one, &text));
    EXPECT_EQ(loaded_.call(function, unit, none, std::size_t{0}, &text), ok);
  }
  expect_same(loaded_, unit, known_, known_.start); // nothing was set
  for (const double length : {0.0, -1.0, double(NAN)})
    refused(loaded_.call("fmi2DoStep", unit, 2.0, length, 1));
  refused(loaded_.call("fmi2CancelStep", unit));
  void *state = nullptr;
  std::size_t size = 0;
  char bytes[8] = "";
  refused(loaded_.call("fmi2GetFMUstate", unit, &state));
  refused(loaded_.call("fmi2SetFMUstate", unit, state));
  refused(loaded_.call("fmi2FreeFMUstate", unit, &state));
  refused(loaded_.call("fmi2SerializedFMUstateSize", unit, state, &size));
  refused(loaded_.call("fmi2SerializeFMUstate", unit, state, &bytes[0], sizeof bytes));
  refused(loaded_.call("fmi2DeSerializeFMUstate", unit, &bytes[0], sizeof bytes, &state));
  refused(loaded_.call("fmi2SetRealInputDerivatives", unit, &input, one, &number, &value));
  refused(loaded_.call("fmi2GetRealOutputDerivatives", unit, &output, one, &number, &value));
  const auto derivative = [&](unsigned *unknown, unsigned *known) {
    return loaded_.call(
        "fmi2GetDirectionalDerivative", unit, static_cast<const unsigned *>(unknown), one,
        static_cast<const unsigned *>(known), one, static_cast<const double *>(&value), &value);
  };
  refused(derivative(&input, &input));
  refused(derivative(&output, &output));
  refused(derivative(&wrong, &input));
  refused(derivative(none, &input));
  for (const char *function : {"fmi2GetStatus", "fmi2GetIntegerStatus", "fmi2GetBooleanStatus"}) {
    EXPECT_EQ(loaded_.call(function, unit, 0, &number), discard);
    one_line(discard);
  }
  EXPECT_EQ(loaded_.call("fmi2GetStringStatus", unit, 1, &text), discard);
  one_line(discard);
  EXPECT_EQ(loaded_.call("fmi2GetRealStatus", unit, 0, &value), discard);
  one_line(discard);
  EXPECT_EQ(loaded_.call("fmi2SetDebugLogging", unit, 1, std::size_t{0}, &text), ok);
  void *nobody = nullptr;
  EXPECT_EQ(loaded_.call("fmi2DoStep", nobody, 2.0, 1.0, 1), error);
  EXPECT_EQ(loaded_.call("fmi2GetReal", nobody, &input, one, &value), error);
  loaded_.function<void, void *>("fmi2FreeInstance")(nullptr);
  EXPECT_TRUE(log_.empty());
  EXPECT_STREQ((loaded_.function<const char *>("fmi2GetVersion")()), "2.0");
  EXPECT_STREQ((loaded_.function<const char *>("fmi2GetTypesPlatform")()), "default");
  loaded_.end(unit);
}

TEST(FmuOfABrokenModel, HasNoAnswer) {
  rbvi::ReducedModel model =
      rbvi::read_model(RBVI_MODELS "/roller/model.h5", rbvi::Registry{}, false);
  model.body.a.reduced *= 0;
  const Loaded loaded(rbvi::fmu_of(model, rbvi::library_of_units()));
  Log log;
  void *unit = loaded.instance(log);
  ASSERT_NE(unit, nullptr);
  EXPECT_EQ(loaded.call("fmi2ExitInitializationMode", unit), warning);
  EXPECT_EQ(loaded.call("fmi2DoStep", unit, 0.0, 1.0, 1), discard);
  ASSERT_EQ(log.size(), 2U);
  EXPECT_EQ(log[0].text, log[1].text);
  EXPECT_NE(log[1].text, "");
  EXPECT_EQ(loaded.status(unit), 1);
  EXPECT_TRUE(std::isnan(loaded.real(unit, "residual")));
  loaded.end(unit);
}

} // namespace
