#include "rbvi/tool/tables.hpp"

#include "rbvi/core/locking.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/warnings.hpp"
#include "rbvi/io/output_table.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/study/bench.hpp"

#include <algorithm>
#include <sstream>

namespace rbvi {

void write_columns(const std::filesystem::path &path, const std::vector<std::string> &names,
                   const std::vector<std::vector<double>> &columns) {
  std::ostringstream out;
  for (std::size_t j = 0; j < names.size(); ++j)
    out << (j > 0 ? "," : "") << names[j];
  out << "\n";
  for (std::size_t i = 0; i < columns.front().size(); ++i) {
    for (std::size_t j = 0; j < columns.size(); ++j)
      out << (j > 0 ? "," : "") << shortest_number(columns[j][i]);
    out << "\n";
  }
  write_atomically(path, out.str());
}

void Table::add(const ParameterSpace &space, const std::vector<Mu> &set) {
  for (int i = 0; i < space.size(); ++i) {
    std::vector<double> values;
    for (const Mu &mu : set)
      values.push_back(mu[i]);
    add(space.at(i).name, values);
  }
}

void write_sample_table(const std::filesystem::path &path, const ParameterSpace &space,
                        const std::vector<Sample> &samples) {
  std::ostringstream out;
  write_csv(out, space, parameters_of(samples), outputs_of(samples));
  write_atomically(path, out.str());
}

void tell_of_samples(const Scene &scene, const Contact &contact, const std::vector<Sample> &samples,
                     std::ostream &out) {
  ResolutionTally tally;
  long in_load_steps = 0;
  double locking = 0;
  const std::vector<MaterialPoint> points = material_points(contact);
  for (const Sample &sample : samples) {
    tally.add(sample.outputs);
    locking = std::max(locking, locking_ratio(scene, expand(scene.parameters, sample.mu), points));
    if (sample.outputs.load_steps.value_or(0) > 0) ++in_load_steps;
  }
  if (in_load_steps > 0)
    out << in_load_steps << " of " << samples.size() << " samples took load steps\n";
  tally.print(out, "samples");
  warn_of_elements(scene, locking, out);
}

} // namespace rbvi
