#include "rbvi/fem/body_balance.hpp"

#include "means.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/facets.hpp"
#include "rbvi/fem/assembly.hpp"
#include "rbvi/par/collective.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace rbvi {

namespace {

using Flags = std::vector<PetscInt>; ///< by body
using Means = std::vector<Mean>;

/// Regions and boundaries may have the same names.
std::string region_key(const std::string &region) {
  return "region " + region;
}

auto count_of(const Sum &sum, const Means &means) {
  return std::ranges::count_if(sum,
                               [&](const Term &term) { return are_same(term.form.means, means); });
}

/// Of boundaries, and of the regions of obstacles.
std::map<std::string, Flags> bodies_of_parts(const Scene &scene, const Mesh &mesh) {
  std::map<std::string, Flags> result;
  const auto add = [&](const std::string &name, const std::vector<CellFacet> &places) {
    Flags &bodies = result[name];
    bodies.resize(static_cast<std::size_t>(mesh.bodies), 0);
    for (const CellFacet &at : places)
      bodies[static_cast<std::size_t>(mesh.body[at.cell])] = 1;
    over_ranks(mesh.comm, MPI_MAX, bodies);
  };
  for (const auto &[name, facets] : mesh.facets)
    add(name, facets);
  for (const ContactRecipe &contact : scene.contacts)
    if (contact.entities.kind == InterfaceEntities::Kind::cells)
      add(region_key(contact.entities.parts[0]),
          places_of(mesh, {contact.entities.parts[0], {}, ""}));
  return result;
}

/// The bodies that share forces along one direction, and what is known of these.
class Group {
public:
  Group(const Problem &problem, const std::map<std::string, Flags> &bodies, std::size_t body,
        const Point &direction)
      : scene_(problem.scene()), mesh_(problem.mesh()), dofs_(problem.dofs()), bodies_(bodies),
        in_(static_cast<std::size_t>(mesh_.bodies), 0) {
    in_[body] = 1;
    forces.direction = direction;
    forces.membrane = scene_.components == 1;
    add_reactions();
    known = add_contacts() && add_means();
    for (const Term &term : scene_.a)
      known = known && !term.of_order_zero &&
              (term.form.boundary.empty() || share(term.form.boundary) == 0);
    for (std::size_t c = 0; c < 3 && !forces.membrane; ++c)
      known = known && (direction[c] == 0 ||
                        !(cancels(scene_.mirrors, c) || (scene_.axisymmetric && c == 0)));
  }

  BodyForces forces;
  bool known = false;
  std::map<const Term *, double> mean_loads; ///< with the work of their means

  bool has(std::size_t cell) const { return in_[static_cast<std::size_t>(mesh_.body[cell])] != 0; }
  bool is_of(const Group &other) const {
    return in_ == other.in_ && forces.direction == other.forces.direction;
  }
  /// Whether one reaction has each node that is held, on this rank.
  bool reactions_have_all() const {
    for (std::size_t k = 0; k < mesh_.cells.size(); ++k)
      for (const int node : nodes_of(mesh_, k))
        if (node >= 0 && has(k) && is_held(static_cast<std::size_t>(node)) &&
            std::ranges::count_if(forces.outputs, [&](const auto &output) {
              return std::ranges::any_of(
                  scene_.outputs[static_cast<std::size_t>(output.first)].at,
                  [&](const std::string &at) { return mesh_.boundary.at(at)[node]; });
            }) != 1)
          return false;
    return true;
  }

private:
  bool is_held(std::size_t node) const {
    const auto components = static_cast<std::size_t>(dofs_.components);
    for (std::size_t c = 0; c < components; ++c)
      if (forces.direction[c] != 0 && dofs_.free[components * node + c] < 0) return true;
    return false;
  }

  /// 1: all bodies of the boundary are in; 0: none is.
  std::optional<int> share(const std::string &boundary) const {
    bool some = false, all = true;
    const Flags &of = bodies_.at(boundary);
    for (std::size_t body = 0; body < of.size(); ++body)
      if (of[body] != 0) (in_[body] != 0 ? some : all) = in_[body] != 0;
    if (some && !all) return std::nullopt;
    return some ? 1 : 0;
  }

  /// With the other bodies that they are of.
  void add_reactions() {
    const auto touches = [&](const std::string &boundary) { return share(boundary) != 0; };
    for (bool grows = true; grows;) {
      grows = false;
      for (std::size_t k = 0; k < scene_.outputs.size(); ++k) {
        const OutputForm &form = scene_.outputs[k];
        if (form.kind != OutputForm::Kind::reaction ||
            norm(cross(form.vector, forces.direction)) > 1e-12 ||
            !std::ranges::any_of(form.at, touches) ||
            !forces.outputs.emplace(static_cast<int>(k), dot(form.vector, forces.direction)).second)
          continue;
        grows = true;
        forces.boundary = form.at.front();
        for (const std::string &at : form.at)
          for (std::size_t body = 0; body < in_.size(); ++body)
            in_[body] = std::max(in_[body], bodies_.at(at)[body]);
      }
    }
  }

  bool add_contacts() {
    for (std::size_t i = 0; i < scene_.contacts.size(); ++i) {
      double sign = 0, side = 1;
      const InterfaceEntities &entities = scene_.contacts[i].entities;
      const bool of_cells = entities.kind == InterfaceEntities::Kind::cells;
      for (const std::string &part : entities.parts) {
        const std::optional<int> of_part = share(of_cells ? region_key(part) : part);
        if (!of_part) return false;
        sign += side * *of_part;
        side = -1;
        if (*of_part != 0) forces.boundary = part;
      }
      if (of_cells) sign *= scene_.contacts[i].push;
      if (sign != 0) forces.contacts[static_cast<int>(i)] = sign;
    }
    return true;
  }

  /// What a translation along the direction does to them.
  std::optional<double> work(const Means &means) const {
    double sum = 0;
    for (const auto &[boundary, direction, turned] : means) {
      const double along = dot(direction, forces.direction);
      const std::optional<int> of = share(boundary);
      if (along != 0 && !of) return std::nullopt;
      if (along != 0) sum += along * *of;
    }
    return sum;
  }

  /// Springs, whose forces are outputs, and loads on means.
  bool add_means() {
    for (const Sum *sum : {&scene_.a, &scene_.f})
      for (const Term &term : *sum) {
        const Means &means = term.form.means;
        const std::optional<double> along = work(means);
        if (!along) return false;
        if (*along == 0) continue;
        int springs = 0;
        for (std::size_t k = 0; k < scene_.outputs.size(); ++k)
          if (const OutputForm &form = scene_.outputs[k];
              form.kind == OutputForm::Kind::spring && are_same(form.means, means)) {
            forces.outputs[static_cast<int>(k)] = -*along;
            ++springs;
          }
        if (springs > 1 || count_of(scene_.a, means) > 1 || count_of(scene_.f, means) > 1)
          return false;
        if (springs == 0 && sum == &scene_.a) return false;
        if (springs == 0) mean_loads[&term] = *along;
      }
    return true;
  }

  const Scene &scene_;
  const Mesh &mesh_;
  const Dofs &dofs_;
  const std::map<std::string, Flags> &bodies_;
  Flags in_;
};

/// Once each, with all bodies that a sum has to have.
std::vector<Group> groups_of(const Problem &problem, const std::map<std::string, Flags> &bodies) {
  std::vector<Point> directions{{1, 0, 0}};
  if (problem.scene().components > 1) directions.push_back({0, 1, 0});
  if (problem.scene().components == 3) directions.push_back({0, 0, 1});
  for (const OutputForm &form : problem.scene().outputs)
    if (form.kind == OutputForm::Kind::reaction && std::ranges::count(form.vector, 0.0) < 2)
      directions.push_back(form.vector);
  std::vector<Group> groups;
  for (std::size_t body = 0; body < static_cast<std::size_t>(problem.mesh().bodies); ++body)
    for (const Point &direction : directions)
      if (Group group(problem, bodies, body, direction);
          group.known && !group.forces.boundary.empty() &&
          std::ranges::none_of(groups, [&](const Group &other) { return group.is_of(other); }))
        groups.push_back(std::move(group));
  Flags unknown;
  for (const Group &group : groups)
    unknown.push_back(group.reactions_have_all() ? 0 : 1);
  over_ranks(problem.comm(), MPI_MAX, unknown);
  std::vector<Group> known;
  for (std::size_t k = 0; k < groups.size(); ++k)
    if (unknown[k] == 0) known.push_back(std::move(groups[k]));
  return known;
}

/// Of a load on cells or facets of this rank; of one that outputs have in contact the size alone.
void add_load(const Problem &problem, const FullMu &mu, const Term &load,
              std::vector<Group> &groups) {
  const Mesh &mesh = problem.mesh();
  const double theta = load.theta ? coefficient_of(load, mu) : 1;
  const auto components = static_cast<std::size_t>(problem.dofs().components);
  std::array<double, 3 * most_nodes> values{};
  for (const auto &[number, facet] : places_of(mesh, load.form)) {
    if (std::ranges::none_of(groups, [&](const Group &group) { return group.has(number); }))
      continue;
    Cell cell = cell_of(mesh, number);
    if (!load.theta) map_cell(problem.scene(), mu, cell);
    if (facet >= 0) cell = facet_cell(cell, facet);
    load.form.kernel(load.theta ? FullMu{} : mu, cell, values.data());
    const int nodes = nodes_per_cell(facet < 0 ? mesh.dim : mesh.dim - 1, mesh.degree);
    for (Group &group : groups)
      for (std::size_t i = 0; i < components * static_cast<std::size_t>(nodes) && group.has(number);
           ++i) {
        const double force = theta * values[i] * group.forces.direction[i % components];
        if (!load.of_contact) group.forces.load += force;
        group.forces.sizes += std::abs(force);
      }
  }
}

} // namespace

std::vector<BodyForces> forces_on_bodies(const Problem &problem, const FullMu &mu) {
  const Scene &scene = problem.scene();
  const bool holds = std::ranges::any_of(scene.outputs, [](const OutputForm &output) {
    return output.kind == OutputForm::Kind::reaction;
  });
  if (scene.components == 1 ? !holds : scene.materials.empty()) return {};
  std::vector<Group> groups = groups_of(problem, bodies_of_parts(scene, problem.mesh()));
  collectively(problem.comm(), [&] {
    for (const Term &load : scene.f)
      if (load.form.kernel && !load.of_imposed) add_load(problem, mu, load, groups);
  });
  Matrix sums(2, std::ssize(groups));
  for (Index k = 0; k < sums.cols(); ++k)
    sums.col(k) << groups[k].forces.load, groups[k].forces.sizes;
  over_ranks(problem.comm(), MPI_SUM, sums);
  sums *= image_count(scene.mirrors);
  std::vector<BodyForces> result;
  for (Index k = 0; k < sums.cols(); ++k) {
    BodyForces &forces = result.emplace_back(groups[k].forces);
    for (const auto &[load, along] : groups[k].mean_loads) {
      const double force = image_count(scene.mirrors) * coefficient_of(*load, mu) * along;
      sums(0, k) += force;
      sums(1, k) += std::abs(force);
    }
    forces.load = sums(0, k);
    forces.sizes = sums(1, k);
  }
  return result;
}

std::array<double, 2> left_of(const BodyForces &forces, const Outputs &outputs) {
  double left = forces.load, sizes = forces.sizes;
  for (const auto &[number, factor] : forces.outputs) {
    const double force = factor * outputs.named[static_cast<std::size_t>(number)].value;
    left += force;
    sizes += std::abs(force);
  }
  for (const auto &[number, sign] : forces.contacts) {
    const Outputs &one =
        outputs.interfaces.empty() ? outputs : outputs.interfaces[static_cast<std::size_t>(number)];
    const std::array along{one.force_x ? one.force_x : one.horizontal_reaction,
                           one.force_y ? one.force_y : one.reaction, one.force_z};
    if (forces.membrane) left += sign * one.normal_force.value_or(0);
    for (std::size_t c = 0; c < along.size(); ++c)
      left += sign * forces.direction[c] * along[c].value_or(0);
    sizes += std::abs(one.normal_force.value_or(0)) + one.tangential_force.value_or(0);
  }
  return {left, sizes};
}

void check_balance(const Problem &problem, const FullMu &mu, const Outputs &outputs,
                   double tolerance, double round_off) {
  for (const BodyForces &forces : forces_on_bodies(problem, mu))
    if (const auto [left, sizes] = left_of(forces, outputs);
        !(std::abs(left) <= tolerance * sizes + round_off))
      throw failure(
          "the forces on the " +
          (forces.membrane ? "membrane of '" + forces.boundary + "' do not balance"
                           : "body of the boundary '" + forces.boundary +
                                 "' do not balance along " + place_text(forces.direction)) +
          ": what outputs say of contact, " + "reactions and springs leaves, with the loads, " +
          short_number(left) + " of " + short_number(sizes));
}

} // namespace rbvi
