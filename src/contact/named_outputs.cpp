#include "rbvi/contact/named_outputs.hpp"

#include "rbvi/contact/contact_lines.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/element/output_sums.hpp"

#include <cmath>
#include <set>

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

ContactShares contact_shares(const Scene &scene, const OutputCells &cells,
                             const std::vector<std::vector<int>> &nodes) {
  std::map<int, std::vector<std::set<int>>> held;
  const auto per_cell = static_cast<std::size_t>(nodes_per_cell(scene.dim, scene.degree));
  for (const OutputCells::Part &part : cells.parts)
    if (const int contact = contact_of_part(part); contact >= 0)
      for (std::size_t i = 0; i < per_cell; ++i)
        if (((part.held >> i) & 1) != 0) {
          held[part.output].resize(nodes.size());
          held[part.output][contact].insert(
              cells.nodes[cells.cells[static_cast<std::size_t>(part.cell) * per_cell + i]]);
        }
  ContactShares shares;
  for (const auto &[output, of_contacts] : held)
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      std::vector<Index> &own = shares[output].emplace_back();
      for (std::size_t k = 0; k < nodes[i].size(); ++k)
        if (of_contacts[i].contains(nodes[i][k])) own.push_back(static_cast<Index>(k));
    }
  return shares;
}

namespace {

/// What contact pushes the nodes of reactions with.
class SharedForces {
public:
  SharedForces(const Scene &scene, const Contact &contact, const FullMu &mu,
               const OutputSources &sources, const Vector &lambda)
      : scene_(scene), contact_(contact), mu_(mu), sources_(sources), lambda_(lambda),
        forces_(contact.interfaces.size()) {}
  /// Of the whole domain; 0 of an output without such nodes.
  double along(const Point &direction, int output) {
    const auto shares = sources_.shares.find(output);
    double force = 0;
    for (std::size_t i = 0; shares != sources_.shares.end() && i < forces_.size(); ++i) {
      const std::vector<Index> &nodes = shares->second[i];
      const auto components = static_cast<Index>(contact_.interfaces[i]->mesh().components);
      for (const Index node : nodes)
        for (Index c = 0; c < components; ++c)
          force += direction[c] * of_interface(i)[node * components + c];
    }
    return image_count(scene_.mirrors) * force;
  }

private:
  const Vector &of_interface(std::size_t i) {
    const ContactInterface &interface = *contact_.interfaces[i];
    if (forces_[i].size() > 0) return forces_[i];
    ContactState state;
    if (interface.follows_state())
      state.displacement = at_columns(interface.mesh(), sources_.of_interface(i));
    return forces_[i] = interface.nodal_forces(
               mu_, state, lambda_.segment(contact_.first_row[i], interface.dual().size()));
  }

  const Scene &scene_;
  const Contact &contact_;
  const FullMu &mu_;
  const OutputSources &sources_;
  const Vector &lambda_;
  std::vector<Vector> forces_;
};

} // namespace

void add_named_outputs(const Scene &scene, const Contact &contact, const FullMu &mu,
                       const OutputSources &sources, const Vector &lambda, Outputs &outputs) {
  SharedForces shared(scene, contact, mu, sources, lambda);
  outputs.named.clear();
  std::vector<std::optional<std::vector<ContactLine>>> of(contact.interfaces.size());
  for (std::size_t k = 0; k < scene.outputs.size(); ++k) {
    const OutputForm &form = scene.outputs[k];
    double value = 0;
    if (has_cells(form)) {
      value =
          sources.of_cells(static_cast<int>(k)) + shared.along(form.vector, static_cast<int>(k));
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
