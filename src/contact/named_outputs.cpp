#include "rbvi/contact/named_outputs.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/output_sums.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// Fields at both ends of each piece of an interface.
using Traces = std::vector<std::array<OutputFields, 2>>;

/// A field at vertices, or one that is constant on pieces; NaN where the grid has none of this
/// name.
void put_field(const Grid &grid, const std::string &name, std::size_t field, Traces &traces) {
  const auto named = [&](const std::vector<Field> &fields) {
    return std::ranges::find(fields, name, &Field::name);
  };
  const auto of_pieces = named(grid.of_cells);
  const auto of_nodes = named(grid.of_nodes);
  for (std::size_t k = 0; k < grid.cells.size(); ++k) {
    double &value = traces[k / 2][k % 2][field];
    if (of_pieces != grid.of_cells.end())
      value = of_pieces->values[static_cast<Index>(k / 2)];
    else if (of_nodes != grid.of_nodes.end())
      value = of_nodes->values[grid.cells[k]];
  }
}

Traces traces_of(const Grid &grid) {
  if (grid.per_cell != 2) throw bad_input("outputs over contact are of curves");
  OutputFields none;
  none.fill(std::numeric_limits<double>::quiet_NaN());
  Traces traces(grid.cells.size() / 2, {none, none});
  const auto moved = std::ranges::find(grid.of_nodes, "u", &Field::name);
  for (std::size_t k = 0; k < grid.cells.size(); ++k) {
    const Index node = grid.cells[k];
    OutputFields &at = traces[k / 2][k % 2];
    at[field::x] = grid.points(node, 0);
    at[field::y] = grid.points(node, 1);
    at[field::ux] = moved->values[3 * node];
    at[field::uy] = moved->values[3 * node + 1];
  }
  put_field(grid, "pressure", field::pressure, traces);
  put_field(grid, "gap", field::gap, traces);
  put_field(grid, "tangential_stress", field::tangential, traces);
  put_field(grid, "slip", field::slip, traces);
  return traces;
}

void add_pieces(const Traces &traces, bool turned, OutputLines &lines) {
  lines.add(
      traces.size(),
      [&](std::size_t piece, double s) {
        const auto &[first, last] = traces[piece];
        OutputFields fields;
        for (std::size_t i = 0; i < fields.size(); ++i)
          fields[i] = (1 - s) * first[i] + s * last[i];
        return fields;
      },
      [&](std::size_t piece, const OutputFields &fields) {
        const auto &[first, last] = traces[piece];
        return std::hypot(last[field::x] - first[field::x], last[field::y] - first[field::y]) *
               circumference(turned, {fields[field::x], 0, 0});
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
  std::vector<std::optional<Traces>> traces(contact.interfaces.size());
  for (std::size_t k = 0; k < scene.outputs.size(); ++k) {
    const OutputForm &form = scene.outputs[k];
    double value = 0;
    if (has_cells(form)) {
      value = sources.of_cells(static_cast<int>(k));
    } else {
      OutputLines lines(form, mu, scene.mirrors);
      for (std::size_t i = 0; i < traces.size(); ++i) {
        if (std::ranges::find(form.at, contact.names[i]) == form.at.end()) continue;
        ContactInterface &interface = *contact.interfaces[i];
        if (!traces[i])
          traces[i] = traces_of(
              interface.fields(mu, sources.of_interface(i),
                               lambda.segment(contact.first_row[i], interface.dual().size())));
        add_pieces(*traces[i], scene.axisymmetric, lines);
      }
      value = output_value(form, lines.sums());
    }
    if (!std::isfinite(value))
      throw failure("the output '" + form.name +
                    "' has no value: nothing is where its condition holds, or a field is not "
                    "there (tangential needs friction)");
    outputs.named.push_back({form.name, value});
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
