#include "rbvi/contact/named_outputs.hpp"

#include "rbvi/contact/contact_lines.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/output_sums.hpp"

#include <cmath>

namespace rbvi {

namespace {

void add_lines(const std::vector<ContactLine> &lines, bool turned, OutputLines &sums) {
  const auto along = [&](std::array<OutputFields, 2> ContactLine::*fields) {
    return [&lines, fields](std::size_t line, double s) {
      const auto &[first, last] = lines[line].*fields;
      OutputFields at;
      for (std::size_t i = 0; i < at.size(); ++i)
        at[i] = (1 - s) * first[i] + s * last[i];
      return at;
    };
  };
  sums.add(lines.size(), along(&ContactLine::fields), along(&ContactLine::seen),
           [&](std::size_t line, const OutputFields &at) {
             const auto &[first, last] = lines[line].fields;
             return std::hypot(last[field::x] - first[field::x], last[field::y] - first[field::y]) *
                    circumference(turned, {at[field::x], 0, 0});
           });
}

} // namespace

void check_outputs(const Scene &scene) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.contacts.size(); ++i)
    names.push_back(contact_name(scene, i));
  for (const OutputForm &form : scene.outputs)
    for (const std::string &at : form.at)
      if (!has_cells(form) && std::ranges::find(names, at) == names.end())
        throw bad_input("the output '" + form.name + "' is over '" + at +
                        "', which is no contact: the nearest is '" + nearest_name(at, names) + "'");
}

void add_named_outputs(const Scene &scene, const Contact &contact, const FullMu &mu,
                       const OutputSources &sources, const Vector &lambda, Outputs &outputs) {
  outputs.named.clear();
  std::vector<std::optional<std::vector<ContactLine>>> of(contact.interfaces.size());
  for (std::size_t k = 0; k < scene.outputs.size(); ++k) {
    const OutputForm &form = scene.outputs[k];
    double value = 0;
    if (has_cells(form)) {
      value = sources.of_cells(static_cast<int>(k));
    } else {
      OutputLines lines(form, mu, scene.mirrors);
      for (std::size_t i = 0; i < of.size(); ++i) {
        if (std::ranges::find(form.at, contact.names[i]) == form.at.end()) continue;
        ContactInterface &interface = *contact.interfaces[i];
        if (!of[i])
          of[i] = contact_lines(
              interface.fields(mu, sources.of_interface(i),
                               lambda.segment(contact.first_row[i], interface.dual().size()), true),
              interface.bound(mu), sources.least_pressure);
        add_lines(*of[i], scene.axisymmetric, lines);
      }
      value = output_value(form, lines.sums());
    }
    outputs.named.push_back(
        {form.name, std::isfinite(value) ? value : std::numeric_limits<double>::quiet_NaN()});
  }
}

void add_gap_error(const Scene &scene, const Contact &contact, const FullMu &mu,
                   const std::function<Vector(std::size_t i)> &of_interface, const Vector &lambda,
                   Outputs &outputs) {
  if (scene.small || scene.components != scene.dim) return;
  double largest = 0;
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    const ContactInterface &interface = *contact.interfaces[i];
    const Vector own = lambda.segment(contact.first_row[i], interface.dual().size());
    largest = std::max(largest, interface.gap_error(mu, of_interface(i), own));
  }
  outputs.gap_error = largest;
}

} // namespace rbvi
