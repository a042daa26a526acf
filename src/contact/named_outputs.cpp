#include "rbvi/contact/named_outputs.hpp"

#include "rbvi/contact/support_outputs.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/output_sums.hpp"
#include "surface_parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

/// Adds the boundary of an interface to an output, as add_lines.
using Boundary = std::function<void(bool turned, OutputLines &sums)>;

Boundary boundary_of(const Grid &grid, const FrictionBound &bound, double least) {
  if (grid.per_cell > 2)
    return [surface = ContactSurface(grid, bound, least)](bool, OutputLines &sums) {
      surface.add_to(sums);
    };
  return [lines = contact_lines(grid, bound, least)](bool turned, OutputLines &sums) {
    add_lines(lines, turned, sums);
  };
}

/// What contact pushes the first body of interface i with; of tangential multipliers alone, where
/// it is that of friction.
PointForces forces_of(const Contact &contact, std::size_t i, const FullMu &mu,
                      const OutputSources &sources, const Vector &lambda, bool of_friction) {
  const ContactInterface &interface = *contact.interfaces[i];
  Vector own = lambda.segment(contact.first_row[i], interface.dual().size());
  auto pressures = own.head(interface.dual().nodes());
  pressures.array() -= interface.bound(mu).pull;
  if (of_friction) pressures.setZero();
  PointForces forces = interface.point_forces(
      mu, {.displacement = at_columns(interface.mesh(), sources.of_interface(i))}, own);
  std::erase_if(forces, [](const PointForce &force) { return force.part != 0; });
  return forces;
}

/// Of some forces and of their images.
double moment_of(const OutputForm &form, const FullMu &mu, const MirrorPlanes &mirrors,
                 const PointForces &forces) {
  Point about{};
  for (std::size_t c = 0; c < form.about.size(); ++c)
    about[c] = form.about[c](mu);
  double moment = 0;
  for (int image = 0; image < image_count(mirrors); ++image)
    for (PointForce force : forces) {
      for (std::size_t k = 0; k < mirrors.size(); ++k)
        if (((image >> k) & 1) != 0) {
          const auto c = static_cast<std::size_t>(mirrors[k].component);
          force.at[c] = 2 * mirrors[k].position - force.at[c];
          force.force[c] = -force.force[c];
        }
      moment += dot(form.vector, cross(force.at - about, force.force));
    }
  return moment;
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
  ContactShares shares;
  const auto per_cell = static_cast<std::size_t>(nodes_per_cell(scene.dim, scene.degree));
  for (const OutputCells::Part &part : cells.parts) {
    const int contact = contact_of_part(part);
    for (std::size_t i = 0; contact >= 0 && i < per_cell; ++i) {
      if (((part.held >> i) & 1) == 0) continue;
      const auto cell = static_cast<std::size_t>(part.cell);
      const std::vector<int> &of = nodes[contact];
      const auto found = std::ranges::find(of, cells.nodes[cells.cells[cell * per_cell + i]]);
      std::vector<std::vector<Index>> &own = shares[part.output];
      own.resize(nodes.size());
      if (found != of.end() &&
          std::ranges::find(own[contact], found - of.begin()) == own[contact].end())
        own[contact].push_back(found - of.begin());
    }
  }
  return shares;
}

void add_named_outputs(const Scene &scene, const Contact &contact, const FullMu &mu,
                       const OutputSources &sources, const Vector &lambda, Outputs &outputs) {
  std::vector<Vector> forces(contact.interfaces.size()); // at nodes, once for all reactions
  const auto shared = [&](const Point &direction, int output) {
    const auto shares = sources.shares.find(output);
    double force = 0;
    for (std::size_t i = 0; shares != sources.shares.end() && i < forces.size(); ++i) {
      const ContactInterface &interface = *contact.interfaces[i];
      const std::vector<Index> &nodes = shares->second[i];
      if (nodes.empty()) continue;
      if (forces[i].size() == 0)
        forces[i] = interface.nodal_forces(
            mu, {.displacement = at_columns(interface.mesh(), sources.of_interface(i))},
            lambda.segment(contact.first_row[i], interface.dual().size()));
      for (const Index node : nodes)
        for (Index c = 0; c < interface.mesh().components; ++c)
          force += direction[c] * forces[i][node * interface.mesh().components + c];
    }
    return image_count(scene.mirrors) * force;
  };
  outputs.named.clear();
  std::vector<Boundary> of(contact.interfaces.size());
  for (std::size_t k = 0; k < scene.outputs.size(); ++k) {
    const OutputForm &form = scene.outputs[k];
    if (!is_asked(sources.only, form.name)) continue;
    double value = 0;
    if (has_cells(form)) {
      const auto output = static_cast<int>(k);
      value = sources.of_cells(output) + shared(form.vector, output);
    } else if (form.kind == OutputForm::Kind::moment) {
      for (std::size_t i = 0; i < of.size(); ++i)
        if (std::ranges::find(form.at, contact.names[i]) != form.at.end())
          value += moment_of(form, mu, scene.mirrors,
                             forces_of(contact, i, mu, sources, lambda, form.of_friction));
    } else {
      OutputLines lines(form, mu, scene.mirrors);
      for (std::size_t i = 0; i < of.size(); ++i) {
        if (std::ranges::find(form.at, contact.names[i]) == form.at.end()) continue;
        ContactInterface &interface = *contact.interfaces[i];
        if (!of[i])
          of[i] = boundary_of(
              interface.fields(mu, sources.of_interface(i),
                               lambda.segment(contact.first_row[i], interface.dual().size()), true),
              interface.bound(mu), sources.least_pressure);
        of[i](scene.axisymmetric, lines);
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
    try {
      largest = std::max(largest, interface.gap_error(mu, of_interface(i), own));
    } catch (const Error &) { // the deformed bodies do not even face each other
      largest = std::max(largest, 1.0);
    }
  }
  outputs.gap_error = largest;
}

} // namespace rbvi
