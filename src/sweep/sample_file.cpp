// samples/HASH.h5: its data sets are listed in src/rom/model/LAYOUT.md.
#include "sample_file.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/h5.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/rom/model/scene_text.hpp"

#include <limits>

namespace rbvi {

namespace {

constexpr int sample_schema = 8;

/// The outputs that a sample stores, in the order of their file record.
constexpr std::array stored_outputs{&Outputs::energy,
                                    &Outputs::normal_force,
                                    &Outputs::tangential_force,
                                    &Outputs::reaction,
                                    &Outputs::horizontal_reaction,
                                    &Outputs::contact_measure,
                                    &Outputs::contact_half_width,
                                    &Outputs::stick_half_width,
                                    &Outputs::peak_pressure,
                                    &Outputs::centre_pressure,
                                    &Outputs::min_u,
                                    &Outputs::contact_nodes,
                                    &Outputs::stick_nodes,
                                    &Outputs::ends_in_contact,
                                    &Outputs::free_nodes,
                                    &Outputs::slip_directions,
                                    &Outputs::kkt_residual,
                                    &Outputs::max_penetration,
                                    &Outputs::friction_violation,
                                    &Outputs::law_error_normal,
                                    &Outputs::law_error_tangential,
                                    &Outputs::law_error_tau_over_n,
                                    &Outputs::iterations,
                                    &Outputs::load_steps,
                                    &Outputs::contraction,
                                    &Outputs::seconds};

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
      scene_difference(found == theirs.end() ? "" : found->second, mine.at(whole_scene), true);
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

Settings settings_in(const H5Reader &file) {
  const std::vector<std::string> names = file.strings("settings/names");
  const std::vector<std::string> values = file.strings("settings/values");
  if (names.size() != values.size()) throw bad_input("settings without values");
  Settings settings;
  for (std::size_t i = 0; i < names.size(); ++i)
    settings[names[i]] = values[i];
  return settings;
}

Sample sample_in(const H5Reader &file) {
  Sample sample{
      Mu(file.doubles("mu")), file.vector("u"), file.vector("lambda"), {}, file.matrix("states")};
  const std::vector<double> outputs = file.doubles("outputs");
  if (outputs.size() != stored_outputs.size()) throw bad_input("another number of outputs");
  for (std::size_t i = 0; i < stored_outputs.size(); ++i)
    if (!std::isnan(outputs[i])) sample.outputs.*stored_outputs[i] = outputs[i];
  return sample;
}

} // namespace

void write_sample(const std::filesystem::path &path, const Sample &sample,
                  const Settings &settings) {
  std::vector<std::string> names, values;
  for (const auto &[name, value] : settings) {
    names.push_back(name);
    values.push_back(value);
  }
  std::vector<double> outputs;
  for (const auto member : stored_outputs)
    outputs.push_back((sample.outputs.*member).value_or(std::numeric_limits<double>::quiet_NaN()));
  H5Writer file;
  file.write("mu", sample.mu);
  file.write("u", sample.u);
  file.write("lambda", sample.lambda);
  file.write("states", sample.states);
  file.write("outputs", outputs);
  file.write("settings/names", names);
  file.write("settings/values", values);
  file.commit(path, "sample", sample_schema);
}

Sample read_sample(const std::filesystem::path &path, const Settings &settings) {
  const H5Reader file = open_sample(path);
  check_settings(path, settings, contents([&] { return settings_in(file); }));
  Sample sample = contents([&] { return sample_in(file); });
  if (sample_file(path.parent_path(), sample.mu).filename() != path.filename())
    throw DamagedFile(path.string() + " holds the answer at another parameter than its name says");
  sample.file = path;
  return sample;
}

Vector displacement(MPI_Comm comm, const Sample &sample) {
  if (sample.u.size() > 0) return sample.u;
  Vector u;
  collectively(comm, [&] { u = contents([&] { return open_sample(sample.file).vector("u"); }); });
  return u;
}

} // namespace rbvi
