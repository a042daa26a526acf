#include "rbvi/core/scene.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

void check_option(const SceneOption &option, const std::string &value,
                  const std::optional<UnitSystem> &units) {
  if (option.choices.empty()) {
    const std::vector<std::string> numbers =
        option.may_vary ? split(value, ',') : std::vector{value};
    if (numbers.size() > 2)
      throw bad_input("option " + option.name + " is '" + value +
                      "': give one value, or two bounds");
    for (const std::string &number : numbers)
      check_range(option.valid, parse_given(number, units, option.unit, "option " + option.name),
                  "option " + option.name);
  } else if (std::find(option.choices.begin(), option.choices.end(), value) ==
             option.choices.end()) {
    throw bad_input("option " + option.name + " is '" + value + "': use one of " +
                    joined(option.choices));
  }
}

/// Throws bad_input in place of what the standard library throws in its code.
Scene made(const SceneEntry &entry, const SceneOptions &options) {
  try {
    return entry.make(options);
  } catch (const std::out_of_range &) {
    throw bad_input("the code of scene " + entry.name +
                    " asks for an option that the scene does not declare, or for a member of a "
                    "list that is not there");
  }
}

} // namespace

bool has_friction(const Scene &scene) {
  return std::ranges::any_of(scene.contacts, [](const ContactRecipe &contact) {
    return contact.friction != FrictionLaw::none;
  });
}

bool has_multipliers(const Scene &scene) {
  return std::ranges::all_of(scene.contacts, [](const ContactRecipe &contact) {
    return contact.formulation == Formulation::mixed;
  });
}

bool separable_contact(const Scene &scene) {
  return std::ranges::all_of(scene.contacts, &ContactRecipe::separable);
}

bool separable_gap(const Scene &scene) {
  return separable_contact(scene) && scene.dim == 2;
}

bool follows_state(const Scene &scene) {
  return std::ranges::any_of(scene.contacts, &ContactRecipe::follows_state);
}

bool keeps_nodes(const Scene &scene) {
  return std::ranges::all_of(scene.contacts, &ContactRecipe::keeps_nodes);
}

bool bounds_nodes(const Scene &scene) {
  return std::ranges::all_of(scene.contacts, &ContactRecipe::nodal) && !has_friction(scene);
}

std::string contact_name(const Scene &scene, std::size_t number) {
  const std::string &name = scene.contacts.at(number).name;
  if (!name.empty()) return name;
  return scene.contacts.size() == 1 ? "contact" : "contact " + std::to_string(number + 1);
}

std::string described(const ContactRecipe &contact) {
  std::string words = "contact ";
  if (!contact.name.empty()) words.append("'").append(contact.name).append("' ");
  return words.append("on '").append(contact.entities.parts.front()).append("'");
}

bool is_symmetric(const Scene &scene) {
  if (!scene.symmetric || scene.skewed_by < 0) return scene.symmetric;
  const ParameterSpace &space = scene.parameters;
  return std::ranges::find(space.free, scene.skewed_by) == space.free.end() &&
         space.all[scene.skewed_by].value == 0;
}

const Coordinate *coordinate_of(const Scene &scene, int parameter) {
  const auto found = scene.coordinates.find(parameter);
  return found == scene.coordinates.end() ? nullptr : &found->second;
}

bool constant_stiffness(const Scene &scene) {
  return is_constant(scene.a, scene.parameters);
}

bool stiffness_scales(const Scene &scene) {
  return !constant_stiffness(scene) && parameters_beside_common(scene.a, scene.parameters).empty();
}

const SceneEntry &entry_of(const Registry &registry, const std::string &scene) {
  std::vector<std::string> names;
  for (const SceneEntry &entry : registry) {
    if (entry.name == scene) return entry;
    names.push_back(entry.name);
  }
  throw bad_input("unknown scene '" + scene + "': this build has " +
                  (names.empty() ? "none" : joined(names)));
}

Scene make_scene(const SceneEntry &entry, const SceneOptions &options) {
  SceneOptions resolved;
  for (const SceneOption &option : entry.options)
    resolved[option.name] = option.default_value;
  for (const auto &[key, value] : options) {
    const auto option = std::find_if(entry.options.begin(), entry.options.end(),
                                     [&key = key](const SceneOption &o) { return o.name == key; });
    if (option == entry.options.end())
      throw bad_input("scene " + entry.name + " has no option '" + key + "'");
    if (value.empty() && option->choices.empty()) continue;
    check_option(*option, value, entry.units);
    resolved[key] = value;
  }
  Scene scene = made(entry, resolved);
  scene.name = entry.name;
  scene.summary = entry.summary;
  scene.options = resolved;
  scene.units = entry.units;
  if (entry.version > 0)
    scene.tree = "program: " + entry.name + "\nversion: " + std::to_string(entry.version) + "\n";
  return scene;
}

int image_count(const MirrorPlanes &planes) {
  return 1 << planes.size();
}

constexpr double round_off = 1e-7; // of the size of what is asked for

Vector image_counts(const MirrorPlanes &planes, const std::vector<Point> &points) {
  Vector counts = Vector::Constant(std::ssize(points), image_count(planes));
  if (planes.empty() || points.empty()) return counts;
  Point least = points.front(), most = least;
  for (const Point &x : points)
    for (std::size_t c = 0; c < 3; ++c) {
      least[c] = std::min(least[c], x[c]);
      most[c] = std::max(most[c], x[c]);
    }
  for (const auto &[component, position] : planes)
    for (std::size_t i = 0; i < points.size(); ++i)
      if (std::abs(points[i][component] - position) <= round_off * norm(most - least))
        counts[static_cast<Index>(i)] /= 2;
  return counts;
}

bool cancels(const MirrorPlanes &planes, std::size_t component) {
  return std::ranges::find(planes, static_cast<int>(component), &MirrorPlane::component) !=
         planes.end();
}

bool has_image(const MirrorPlanes &planes, int image, const OutputFields &begin,
               const OutputFields &end) {
  const double along_z = std::isnan(end[field::z]) ? 0 : end[field::z] - begin[field::z];
  const double most = round_off * std::hypot(end[field::x] - begin[field::x],
                                             end[field::y] - begin[field::y], along_z);
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const auto &[component, position] = planes[k];
    const std::size_t place = field::x + static_cast<std::size_t>(component);
    if (((image >> k) & 1) != 0 && std::abs(begin[place] - position) < most &&
        std::abs(end[place] - position) < most)
      return false;
  }
  return true;
}

void reflect(const MirrorPlanes &planes, int image, OutputFields &fields) {
  for (std::size_t k = 0; k < planes.size(); ++k) {
    if (((image >> k) & 1) == 0) continue;
    const auto c = static_cast<std::size_t>(planes[k].component);
    double &place = fields[field::x + c];
    place = 2 * planes[k].position - place;
    constexpr std::array<std::array<std::size_t, 2>, 3> shears{
        {{field::sigma_xy, field::sigma_xz},
         {field::sigma_xy, field::sigma_yz},
         {field::sigma_yz, field::sigma_xz}}};
    for (const std::size_t turned : {field::ux + c, field::nx + c, shears[c][0], shears[c][1]})
      fields[turned] = -fields[turned];
    if (c < 2) fields[field::slope_x + c] = -fields[field::slope_x + c];
    if (std::isnan(fields[field::z])) // in space they are sizes
      for (const std::size_t turned : {field::tangential, field::slip})
        fields[turned] = -fields[turned];
  }
}

} // namespace rbvi
