#include "reader.hpp"

#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <random>

namespace rbvi {

namespace {

void add_name(std::vector<std::string> &names, const std::string &name) {
  if (name != "all" && std::ranges::find(names, name) == names.end()) names.push_back(name);
}

/// The regions and boundaries that the sections name: what a mesh from a file must have.
MeshRecipe recipe_of_sections(const Reader &reader) {
  MeshRecipe recipe;
  const auto add = [](const CaseNode &node, const std::string &key, std::vector<std::string> &to) {
    const CaseNode *at = node.find(key);
    if (at != nullptr && (at->is_value() || !at->items.empty()) && !at->is_table())
      for (const std::string &name : names_in(*at))
        add_name(to, name);
  };
  for (const auto &[name, node] : section(reader, "materials").entries)
    add(node, "at", recipe.regions);
  for (const auto &[name, node] : section(reader, "loads").entries)
    add(node, "at", node.find("force") != nullptr ? recipe.regions : recipe.boundaries);
  for (const auto &[name, node] : section(reader, "imposed").entries)
    add(node, "at", recipe.boundaries);
  for (const auto &[name, node] : section(reader, "springs").entries) {
    add(node, "at", recipe.boundaries);
    add(node, "between", recipe.boundaries);
  }
  for (const auto &[name, node] : section(reader, "contact").entries) {
    const bool on_obstacle = node.find("above") != nullptr || node.find("below") != nullptr;
    add(node, "at", on_obstacle ? recipe.regions : recipe.boundaries);
    add(node, "against", recipe.boundaries);
  }
  for (const auto &[name, node] : section(reader, "outputs").entries) {
    add(node, "in", recipe.regions);
    if (!is_over_contacts(reader, node)) add(node, "at", recipe.boundaries);
  }
  for (const char *named : {"curves", "surfaces"})
    for (const auto &[name, node] : section(reader, named).entries)
      if (std::ranges::find(recipe.regions, name) == recipe.regions.end())
        add_name(recipe.boundaries, name);
  return recipe;
}

/// Throws bad_input for a name that the shape does not have, or has of another kind.
void check_parts(const MeshRecipe &shape, const MeshRecipe &named) {
  const auto check = [&](const std::vector<std::string> &names,
                         const std::vector<std::string> &known, const std::string &kind) {
    for (const std::string &name : names)
      if (std::ranges::find(known, name) == known.end())
        throw bad_input("the built-in mesh " + shape.generator + " has no " + kind + " '" + name +
                        "': it has " + (known.empty() ? "none" : joined(known)));
  };
  check(named.regions, shape.regions, "region");
  check(named.boundaries, shape.boundaries, "boundary");
}

Circle circle_in(const Reader &reader, const CaseNode &node) {
  const std::vector<double> circle = numbers_in(reader, entry(node, "circle"), 3);
  if (!(circle[2] > 0)) throw bad_input("the radius of a circle is positive");
  return {{circle[0], circle[1], 0}, circle[2], yes_or(node, "hole", false)};
}

/// A sphere, or a cylinder: a point of its axis, the direction of that, its radius.
Circle round_in(const Reader &reader, const CaseNode &node) {
  const CaseNode *sphere = node.find("sphere"), *cylinder = node.find("cylinder");
  if ((sphere == nullptr) == (cylinder == nullptr))
    throw bad_input("a surface is a sphere or a cylinder");
  const std::vector<double> n =
      sphere != nullptr ? numbers_in(reader, *sphere, 4) : numbers_in(reader, *cylinder, 7);
  Circle round{{n[0], n[1], n[2]}, n.back(), yes_or(node, "hole", false)};
  if (!(round.radius > 0)) throw bad_input("the radius of a sphere or cylinder is positive");
  if (sphere != nullptr) return round;
  round.axis = {n[3], n[4], n[5]};
  if (!(norm(round.axis) > 0)) throw bad_input("the axis of a cylinder has no direction");
  round.axis = round.axis / norm(round.axis);
  return round;
}

} // namespace

std::vector<Expression> map_of(const Reader &reader) {
  const CaseNode &map = section(reader, "map");
  if (map.is_table()) {
    const std::string scale = "(" + expression_in(reader, entry(map, "scale")).text() + ") * ";
    std::vector<Expression> scaled{parse_expression(scale + "x"), parse_expression(scale + "y")};
    if (dimensions_of(reader) == 3) scaled.push_back(parse_expression(scale + "z"));
    return scaled;
  }
  if (map.is_value() && map.value.empty()) return {};
  std::vector<Expression> components = components_in(reader, map);
  if (std::ssize(components) != dimensions_of(reader))
    throw bad_input(dimensions_of(reader) == 2 ? "the map has two components, [x, y]"
                                               : "the map has three components, [x, y, z]");
  return components;
}

std::vector<int> dependence_of_map(Reader &reader) {
  return dependence_of(formula_of(reader, map_of(reader)));
}

namespace {

/// Names in place of what the point decides, so that no piece of a map is missed, however small it
/// is or far away.
class Pieces {
public:
  Expression named(const Expression &whole) {
    names_ = whole.free_names();
    Program program;
    std::vector<std::size_t> begins; // of the operands that are not yet used
    for (const Instruction &step : whole.program()) {
      const auto count = static_cast<std::size_t>(operands_of(step.operation));
      const std::size_t begin = count == 0 ? program.size() : begins[begins.size() - count];
      if (step.operation == Operation::choose) {
        if (const auto name = named_from(begins.back(), program)) {
          program.resize(begins.back());
          program.push_back(*name);
        }
      }
      program.push_back(step);
      if (step.operation == Operation::min || step.operation == Operation::max) {
        if (const auto name = named_from(begin, program)) {
          program.back() = *name;
          program.push_back({Operation::choose});
        }
      }
      begins.resize(begins.size() - count);
      begins.push_back(begin);
    }
    return {program, names_};
  }
  std::vector<std::string> all() const {
    std::vector<std::string> names;
    for (const auto &[text, name] : name_of_)
      names.push_back(name);
    return names;
  }

private:
  /// A name for what `program` has from `begin` on, if the point is in it.
  std::optional<Instruction> named_from(std::size_t begin, const Program &program) {
    const Program part(program.begin() + static_cast<std::ptrdiff_t>(begin), program.end());
    const Expression condition(part, names_);
    if (std::ranges::none_of(condition.free_names(), [](const auto &name) {
          return name == "x" || name == "y" || name == "z";
        }))
      return std::nullopt;
    const std::string next = "piece_of_map_" + std::to_string(name_of_.size());
    names_.push_back(name_of_.emplace(condition.text(), next).first->second);
    return Instruction{Operation::name, static_cast<int>(names_.size()) - 1};
  }
  std::vector<std::string> names_;
  std::map<std::string, std::string> name_of_; ///< by text
};

/// Derivatives of a map by x, y and z.
using Slopes = std::array<Point, 3>;

/// Whether holds(slopes of the map), at random points and parameters.
template <class Holds>
bool holds_of_slopes(const Reader &reader, const Scene &scene, const Holds &holds) {
  const std::vector<Expression> map = map_of(reader);
  if (map.empty()) return true;
  Pieces pieces;
  std::vector<Expression> components;
  for (const Expression &component : map)
    components.push_back(pieces.named(expanded(component, reader.lets)));
  std::vector<std::string> names = reader.values;
  const std::vector<std::string> conditions = pieces.all();
  names.insert(names.end(), {"x", "y", "z"});
  names.insert(names.end(), conditions.begin(), conditions.end());
  std::vector<BoundExpression> bound;
  for (const Expression &component : components)
    bound.push_back(bound_to(component, names, {"x", "y", "z"}));
  std::mt19937_64 random(1);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  constexpr int points = 400;
  for (int i = 0; i < points; ++i) {
    std::vector<double> at;
    for (const Parameter &parameter : scene.parameters.all)
      at.push_back(parameter.lower + unit() * (parameter.upper - parameter.lower));
    // Bodies are of any size: six decades of it about 1.
    const double size = std::pow(10, 6 * unit() - 3), angle = 2 * std::numbers::pi * unit();
    at.insert(at.end(), {size * std::cos(angle), size * std::sin(angle),
                         bound.size() > 2 ? size * (2 * unit() - 1) : 0});
    for (std::size_t c = 0; c < conditions.size(); ++c)
      at.push_back(unit() < 0.5 ? 0 : 1);
    Slopes by{};
    for (std::size_t c = 0; c < bound.size(); ++c) {
      double value;
      Point slopes{};
      bound[c].value_and_gradient(at.data(), value, slopes.data());
      for (std::size_t k = 0; k < 3; ++k)
        by[k][c] = slopes[k];
    }
    if (!holds(by)) return false;
  }
  return true;
}

constexpr double round_off = 1e-10;

} // namespace

bool is_similarity(const Reader &reader, const Scene &scene) {
  return holds_of_slopes(reader, scene, [](const Slopes &by) {
    const auto &[by_x, by_y, by_z] = by;
    const double size = norm(by_x);
    return std::abs(size - norm(by_y)) <= round_off * size &&
           std::abs(dot(by_x, by_y)) <= round_off * size * size;
  });
}

bool keeps_directions(const Reader &reader, const Scene &scene) {
  const auto axes = static_cast<std::size_t>(scene.dim);
  return holds_of_slopes(reader, scene, [axes](const Slopes &by) {
    const double scale = by[0][0];
    for (std::size_t k = 0; k < axes; ++k)
      for (std::size_t c = 0; c < axes; ++c)
        if (!(std::abs(by[k][c] - (k == c ? scale : 0)) <= round_off * scale)) return false;
    return scale > 0;
  });
}

void read_mesh(Reader &reader, Scene &scene, Defects &defects) {
  const CaseNode &mesh = section(reader, "mesh");
  scene.dim = dimensions_of(reader);
  const CaseNode *shape_name = mesh.find("built_in"), *file = mesh.find("file");
  const std::string usual = section(reader, "physics").value == "membrane" ? "1" : "2";
  defects.collect(mesh, [&] {
    scene.degree = choice_or(mesh, "degree", usual, {"1", "2"}) == "2" ? 2 : 1;
    if ((shape_name == nullptr) == (file == nullptr))
      throw bad_input("a mesh is 'built_in: SHAPE' or 'file: FILE.msh'");
    if (shape_name != nullptr && scene.dim == 3)
      throw bad_input("the built-in shapes are plane: a solid has 'file: FILE.msh' or FILE.geo");
    scene.mesh = recipe_of_sections(reader);
    if (shape_name == nullptr) return read_facts(reader, mesh, scene.mesh, defects);
    if (mesh.find("facts") != nullptr)
      throw bad_input(
          "'facts' are those of a mesh from a file: the built-in shapes have their own");
    ShapeNumbers numbers;
    const double edges = number_or(reader, mesh, "edges", 0);
    if (edges != std::floor(edges) || edges < 0 || edges > 1e6)
      throw bad_input("edges is " + short_number(edges) + ": it must be a whole number");
    numbers.edges = static_cast<int>(edges);
    numbers.angle = number_or(reader, mesh, "angle", numbers.angle);
    Shape shape = shape_of(shape_name->value, numbers);
    check_parts(shape.recipe, scene.mesh);
    scene.mesh = std::move(shape.recipe);
    reader.circles = std::move(shape.circles);
  });
  for (const auto &[name, node] : section(reader, "curves").entries)
    defects.collect(node, [&, &own = name, &value = node] {
      if (scene.dim == 3) throw bad_input("curves are of plane bodies: a solid has 'surfaces:'");
      reader.circles[own] = {circle_in(reader, value)};
    });
  for (const auto &[name, node] : section(reader, "surfaces").entries)
    defects.collect(node, [&, &own = name, &value = node] {
      if (scene.dim == 2) throw bad_input("surfaces are of solids: a plane body has 'curves:'");
      reader.circles[own] = {round_in(reader, value)};
    });
  for (const auto &[name, circles] : reader.circles)
    scene.curves[name] = [circles](const Point &x) { return on_circles(circles, x); };
  const CaseNode &map = section(reader, "map");
  defects.collect(map, [&] {
    const std::vector<Expression> components = map_of(reader);
    if (const CaseNode *scale = map.find("scale")) {
      scene.map = scaled(coefficient_of(formula_in(reader, *scale)));
      return;
    }
    scene.map = components.empty() ? identity() : point_map_of(formula_of(reader, components));
  });
}

} // namespace rbvi
