#include "reader.hpp"

#include "rbvi/core/text.hpp"

#include <algorithm>

namespace rbvi {

namespace {

const std::vector<std::string> displacements{"ux", "uy", "uz"},
    forces{"force_x", "force_y", "force_z"};

bool has_one(const CaseNode &node, const std::vector<std::string> &keys) {
  return std::ranges::any_of(keys, [&](const auto &key) { return node.find(key) != nullptr; });
}

bool is_zero(const Expression &value) {
  return value.constant() == 0.0;
}

/// What a boundary imposes by component; unset: free. The word motion is the motion itself.
using Imposed = std::vector<std::optional<Expression>>;

Imposed imposed_in(const Reader &reader, const CaseNode &node, int components,
                   const std::vector<Expression> &motion) {
  Imposed imposed;
  const bool moved = has_one(node, forces);
  if (components == 1) {
    if (moved) throw bad_input("a membrane has loads, not force_x and force_y");
    if (has_one(node, displacements)) throw bad_input("the displacement of a membrane is u");
    return {expression_in(reader, entry(node, "u"))};
  }
  if (node.find("u") != nullptr) throw bad_input("the displacement has the components ux and uy");
  if (components == 2 && has_one(node, {"uz", "force_z"}))
    throw bad_input("uz and force_z are of a solid");
  for (std::size_t c = 0; c < static_cast<std::size_t>(components); ++c) {
    const CaseNode *value = node.find(displacements[c]);
    if (value == nullptr)
      imposed.emplace_back();
    else if (value->value != "motion")
      imposed.emplace_back(expression_in(reader, *value));
    else if (motion.empty())
      throw bad_input("there is no 'motion:' of the bodies");
    else
      imposed.emplace_back(motion[c]);
  }
  const auto is_set = [](const std::optional<Expression> &value) { return value.has_value(); };
  if (std::ranges::none_of(imposed, is_set) && !moved)
    throw bad_input(components == 2 ? "neither ux nor uy is imposed"
                                    : "none of ux, uy and uz is imposed");
  return imposed;
}

/// The motion that moves the one body as what is imposed moves its boundary; empty: none.
std::vector<Expression> derived_motion(Reader &reader, const Scene &scene) {
  const auto &all = section(reader, "imposed").entries;
  const bool springs = !section(reader, "springs").entries.empty(); // which it would stretch
  if (scene.components == 1 || all.size() != 1 || springs) return {};
  const Imposed imposed = imposed_in(reader, all.front().node, scene.components, {});
  std::vector<Expression> motion;
  for (const std::optional<Expression> &value : imposed)
    if (value) motion.push_back(*value);
  if (motion.size() != imposed.size() || std::ranges::all_of(motion, is_zero)) return {};
  if (scene.axisymmetric && !is_zero(motion[0])) return {}; // widens the body
  return depends_on_point(formula_of(reader, motion)) ? std::vector<Expression>{} : motion;
}

/// value - motion on a boundary, component by component.
void add_values(Reader &reader, const Expression &value, std::size_t c, FixedBoundary &boundary) {
  std::vector<Expression> components(c, parse_expression("0"));
  const auto products = products_of(reader, value);
  if (!products) {
    components.push_back(value);
    const Formula formula = formula_of(reader, components);
    boundary.values.push_back({point_map_of(formula), std::nullopt, dependence_of(formula)});
    return;
  }
  for (const Product &product : *products) {
    std::vector<Expression> own = components;
    own.push_back(product.at_point);
    boundary.values.push_back({point_map_of(formula_of(reader, own)), product.factors});
  }
}

FixedBoundary boundary_in(Reader &reader, const CaseNode &node,
                          const std::vector<Expression> &motion, int count) {
  FixedBoundary boundary{entry(node, "at").value, {}};
  const Imposed imposed = imposed_in(reader, node, count, motion);
  for (std::size_t c = 0; c < imposed.size(); ++c) {
    if (!imposed[c]) continue;
    boundary.components.push_back(static_cast<int>(c));
    if (motion.empty() && !is_zero(*imposed[c]))
      add_values(reader, *imposed[c], c, boundary);
    else if (!motion.empty() && imposed[c]->text() != motion[c].text())
      add_values(reader,
                 parse_expression("(" + imposed[c]->text() + ") - (" + motion[c].text() + ")"), c,
                 boundary);
  }
  if (static_cast<int>(boundary.components.size()) == count) boundary.components.clear();
  return boundary;
}

/// Throws bad_input for a component that is imposed on a boundary before.
void check_new(const std::vector<FixedBoundary> &fixed, const FixedBoundary &boundary) {
  for (const FixedBoundary &other : fixed) {
    if (other.name != boundary.name) continue;
    const bool all = other.components.empty() || boundary.components.empty();
    if (all || std::ranges::any_of(boundary.components, [&](int c) {
          return std::ranges::find(other.components, c) != other.components.end();
        }))
      throw bad_input("a displacement is imposed twice on '" + boundary.name + "'");
  }
}

/// The total forces on a boundary, which ties it in their directions.
void add_forces(Reader &reader, const CaseNode &node, const std::string &boundary, Scene &scene) {
  for (std::size_t c = 0; c < forces.size(); ++c) {
    const CaseNode *given = node.find(forces[c]);
    if (given == nullptr) continue;
    if (node.find(displacements[c]) != nullptr)
      throw bad_input(displacements[c] + " is given by " + forces[c] + ": leave out one of them");
    if (scene.axisymmetric && c == 0)
      throw bad_input("forces along the radius balance each other: use a pressure");
    const Expression force = expression_in(reader, *given);
    if (depends_on_point(formula_of(reader, {force})))
      throw bad_input(forces[c] + " is the force on the whole boundary: it does not depend on the "
                                  "place");
    const auto component = static_cast<int>(c);
    Point direction{};
    direction[c] = 1;
    check_direction(scene, direction, "a total force");
    scene.tied.push_back({boundary, component});
    Form mean;
    mean.means = {{boundary, direction, scene.axisymmetric}};
    scene.f.push_back(exact_term(mean, {factor_of(reader, share_of_domain(scene, force))}));
  }
}

} // namespace

void read_motion(Reader &reader, Scene &scene, Defects &defects) {
  const CaseNode &given = section(reader, "motion");
  std::vector<Expression> motion;
  defects.collect(given, [&] {
    if (!given.items.empty())
      motion = components_in(reader, given);
    else
      motion = derived_motion(reader, scene);
    if (!motion.empty() && motion.size() != static_cast<std::size_t>(scene.components)) {
      motion.clear();
      throw bad_input("the motion has " + counted(scene.components, "component"));
    }
    if (!motion.empty()) scene.motion = point_map_of(formula_of(reader, motion));
  });
  if (scene.axisymmetric) scene.fixed.push_back({axis_of_turning, {0}});
  for (const auto &[name, node] : section(reader, "imposed").entries)
    defects.collect(node, [&, &value = node] {
      for (const std::string &boundary : names_in(entry(value, "at"))) {
        FixedBoundary fixed = boundary_in(reader, value, motion, scene.components);
        fixed.name = boundary;
        add_forces(reader, value, boundary, scene);
        if (value.find("u") == nullptr && !has_one(value, displacements)) continue;
        check_new(scene.fixed, fixed);
        scene.fixed.push_back(std::move(fixed));
      }
    });
}

} // namespace rbvi
