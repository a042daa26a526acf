// samples/HASH.h5: its data sets are listed in src/model/LAYOUT.md.
#include "sample_file.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/fields.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/stored_scene.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <span>

namespace rbvi {

namespace {

constexpr int sample_schema = 15;

void check_settings(const std::filesystem::path &path, const Settings &mine,
                    const Settings &theirs) {
  if (theirs == mine) return;
  for (const auto &[name, value] : mine) {
    const auto found = theirs.find(name);
    const std::string other = found == theirs.end() ? "not set" : found->second;
    if (other != value && name != whole_scene)
      throw bad_input("the samples in " + path.parent_path().string() + " were made with " + name +
                      " = " + other + ", now it is " + value +
                      ": use another -out or restore the option");
  }
  const auto found = theirs.find(whole_scene);
  const std::string difference =
      scene_difference(found == theirs.end() ? "" : found->second, mine.at(whole_scene));
  if (!difference.empty())
    throw bad_input("the samples in " + path.parent_path().string() + " are of another scene: " +
                    difference + ": rbvi offline makes them anew in another -out");
  if (theirs.size() == mine.size()) return;
  throw bad_input("the samples in " + path.parent_path().string() +
                  " were made with options that this scene no longer has: use another -out");
}

/// What `read` returns; its complaints are about a file that write_sample did not write.
template <class Read> auto contents(Read &&read) {
  try {
    return read();
  } catch (const Error &error) {
    throw DamagedFile(error.what());
  }
}

H5Reader open_sample(const std::filesystem::path &path) {
  try {
    return {path, "sample", sample_schema};
  } catch (const OtherVersion &error) {
    throw bad_input(std::string(error.what()) + " with another -out");
  }
}

/// Of each of some answers, one behind the other; NaN: it is not set.
template <class Store, class List>
void list_outputs(const Store &store, const std::string &name, List &&list) {
  std::vector<double> values;
  for (const Outputs &one : list)
    for (const std::optional<double> &number : numbers_of(one))
      values.push_back(number.value_or(std::numeric_limits<double>::quiet_NaN()));
  const std::size_t size = values.size();
  store(name, values);
  if constexpr (Store::reads) {
    if (values.size() != size) throw bad_input("another number of outputs");
    auto value = values.begin();
    for (Outputs &one : list) {
      std::vector<std::optional<double>> numbers = numbers_of(one);
      for (std::optional<double> &number : numbers)
        if (const double next = *value++; !std::isnan(next)) number = next;
      set_numbers(numbers, one);
    }
  }
}

template <class Store, class Of> void list_sample(const Store &store, Of &sample) {
  store("mu", sample.mu);
  store("u", sample.u);
  store("lambda", sample.lambda);
  store("states", sample.states);
  list_outputs(store, "outputs", std::span(&sample.outputs, 1));
  auto &interfaces = sample.outputs.interfaces;
  list_column(
      store, "interfaces/names", interfaces, [](auto &one) -> auto & { return one.name; });
  list_outputs(store, "interfaces/outputs", interfaces);
}

template <class Store, class Of> void list_settings(const Store &store, Of &settings) {
  list_map(store, "settings/names", "settings/values", settings);
}

} // namespace

void write_sample(const std::filesystem::path &path, const Sample &sample,
                  const Settings &settings) {
  H5Writer file;
  const FieldWriter writer{file};
  list_sample(writer, sample);
  list_settings(writer, settings);
  file.commit(path, "sample", sample_schema);
}

Sample read_sample(const std::filesystem::path &path, const Settings &settings) {
  const H5Reader file = open_sample(path);
  const FieldReader reader{file};
  Settings stored;
  Sample sample;
  contents([&] { list_settings(reader, stored); });
  check_settings(path, settings, stored);
  contents([&] { list_sample(reader, sample); });
  if (sample_file(path.parent_path(), sample.mu).filename() != path.filename())
    throw DamagedFile(path.string() + " holds the answer at another parameter than its name says");
  sample.file = path;
  return sample;
}

Vector displacement(MPI_Comm comm, const Sample &sample) {
  if (sample.u.size() > 0) return sample.u;
  Vector u;
  collectively(comm,
               [&] { u = contents([&] { return open_sample(sample.file).read<Vector>("u"); }); });
  return u;
}

} // namespace rbvi
