#include "reader.hpp"

#include "rbvi/contact/nitsche_support.hpp"
#include "rbvi/contact/obstacle.hpp"
#include "rbvi/contact/pair.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/facet_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"

#include <algorithm>
#include <numeric>
#include <optional>

namespace rbvi {

namespace {

constexpr double usual_gamma0 = 11.54;
constexpr Range gamma0_range{0.1, 2000};

/// Throws bad_input for a key that this kind of contact does not have.
void check_used(const CaseNode &node, const std::string &kind,
                const std::vector<std::string> &keys) {
  for (const auto &[name, value] : node.entries)
    if (std::ranges::find(keys, name) == keys.end())
      throw bad_input("contact " + kind + " has no '" + name + "': leave it out");
}

Friction friction_in(Reader &reader, const CaseNode &contact, Scene &scene) {
  const CaseNode *node = contact.find("friction");
  Friction friction;
  if (node == nullptr || node->entries.empty()) return friction;
  const CaseNode *coulomb = node->find("coulomb"), *tresca = node->find("tresca");
  if ((coulomb == nullptr) == (tresca == nullptr))
    throw bad_input("friction is 'coulomb: COEFFICIENT' or 'tresca: THRESHOLD'");
  const CaseNode &value = coulomb != nullptr ? *coulomb : *tresca;
  friction.law = coulomb != nullptr ? FrictionLaw::coulomb : FrictionLaw::tresca;
  friction.value = coefficient_of(formula_in(reader, value));
  friction.only_in_contact =
      choice_or(*node, "bound", "everywhere", {"everywhere", "contact"}) == "contact";
  if (coulomb != nullptr) limit(reader, expression_in(reader, value), friction_range, scene);
  if (const CaseNode *most = node->find("limit"); most != nullptr) {
    if (coulomb == nullptr) throw bad_input("friction has a 'limit' beside 'coulomb' alone");
    friction.limit = coefficient_of(formula_in(reader, *most));
  }
  return friction;
}

std::function<Coefficient> adhesion_in(Reader &reader, const CaseNode &contact) {
  const CaseNode *node = contact.find("adhesion");
  return node == nullptr ? nullptr : coefficient_of(formula_in(reader, *node));
}

/// Throws bad_input for adhesion with what has none.
void check_adhesion(const CaseNode &contact, const RigidContact &rigid, const Scene &scene) {
  const auto refuse = [](const std::string &what) {
    throw bad_input("adhesion is not for " + what + ": leave out one of them");
  };
  if (rigid.facing.follows_state) refuse("kinematics: large");
  if (choice_or(contact, "formulation", "mixed", {"mixed", "nitsche"}) == "nitsche")
    refuse("formulation: nitsche");
  if (rigid.lumped) refuse("lumped: yes");
  if (rigid.curved && scene.degree == 2 && !scene.curves.empty())
    refuse("gap_from: curve on a boundary whose circle has another name");
}

/// The pull of adhesion: exact, `of_one` of a pull of 1 times it, where that does not depend on
/// parameters; else `pull`.
void add_pull(Reader &reader, const CaseNode &contact, std::optional<Form> of_one, Term pull,
              Scene &scene) {
  if (of_one) {
    pull =
        exact_term(*of_one, {factor_of(reader, expression_in(reader, entry(contact, "adhesion")))});
  } else {
    pull.parameters.emplace(reader.parameters.size());
    std::iota(pull.parameters->begin(), pull.parameters->end(), 0);
  }
  pull.of_contact = true;
  scene.f.push_back(std::move(pull));
}

bool is_large(const CaseNode &node) {
  return choice_or(node, "kinematics", "small", {"small", "large"}) == "large";
}

/// What is known of a boundary: the mapped points of its circles, and their normals.
struct Side {
  std::string boundary;
  std::function<PointMap> at{};     ///< empty without circles
  std::function<PointMap> normal{}; ///< of the body; likewise
};

Side side_of(const Reader &reader, const std::string &boundary, const Scene &scene) {
  Side side{boundary};
  const auto found = reader.circles.find(boundary);
  if (found == reader.circles.end()) return side;
  const std::function<PointMap> curve = on_circles(found->second);
  side.at = map_of(reader).empty() ? curve : composed(scene.map, curve);
  if (keeps_directions(reader, scene)) side.normal = normals_of_circles(found->second);
  return side;
}

std::function<Surface> disk_in(Reader &reader, const CaseNode &disk) {
  const std::vector<Expression> centre = components_in(reader, entry(disk, "center"));
  if (centre.size() != 2) throw bad_input("the center of a disk is [x, y]");
  const Formula radius = formula_in(reader, entry(disk, "radius"));
  return disk_surface(coefficient_of(formula_of(reader, {centre[0]})),
                      coefficient_of(formula_of(reader, {centre[1]})), coefficient_of(radius));
}

std::function<Surface> plane_in(Reader &reader, const CaseNode &plane) {
  const CaseNode *pivot = plane.find("pivot"), *tilt = plane.find("tilt"),
                 *about = plane.find("about");
  const bool solid = dimensions_of(reader) == 3;
  if (tilt != nullptr && solid != (about != nullptr))
    throw bad_input(solid ? "a plane in space is tilted 'about: [x, y, z]', a direction"
                          : "a plane body sees a tilt in its plane: leave out 'about'");
  return plane_surface(
      vector_in(reader, entry(plane, "normal")), pivot ? vector_in(reader, *pivot) : Point{},
      coefficient_of(formula_in(reader, entry(plane, "position"))),
      tilt ? coefficient_of(formula_in(reader, *tilt)) : std::function<Coefficient>(),
      about ? vector_in(reader, *about) : Point{0, 0, 1});
}

/// A sphere, a cylinder or a cone: where it is, and of the last two the direction of the axis.
std::function<Surface> round_in(Reader &reader, const std::string &kind, const CaseNode &node) {
  const char *place = kind == "sphere" ? "center" : kind == "cone" ? "apex" : "point";
  const std::vector<Expression> at = components_in(reader, entry(node, place));
  if (at.size() != 3) throw bad_input(std::string(place) + " is [x, y, z]");
  std::array<std::function<Coefficient>, 3> centre;
  for (std::size_t c = 0; c < 3; ++c)
    centre[c] = coefficient_of(formula_of(reader, {at[c]}));
  const auto size =
      coefficient_of(formula_in(reader, entry(node, kind == "cone" ? "angle" : "radius")));
  if (kind == "sphere") return sphere_surface(centre, size);
  const Point axis = vector_in(reader, entry(node, "axis"));
  return kind == "cylinder" ? cylinder_surface(centre, axis, size)
                            : cone_surface(centre, axis, size);
}

std::function<Surface> surface_in(Reader &reader, const CaseNode &against) {
  const bool solid = dimensions_of(reader) == 3;
  const std::vector<std::string> kinds =
      solid ? std::vector<std::string>{"plane", "sphere", "cylinder", "cone", "level_set"}
            : std::vector<std::string>{"disk", "plane", "level_set"};
  std::vector<std::string> found;
  for (const auto &[kind, node] : against.entries)
    found.push_back(kind);
  if (found.size() != 1 || std::ranges::find(kinds, found.front()) == kinds.end())
    throw bad_input((solid ? "a solid meets one of " : "against: a boundary, or one of ") +
                    joined(kinds) + ": {plane: {...}}, {level_set: EXPRESSION}, ...");
  const std::string &kind = found.front();
  const CaseNode &node = entry(against, kind);
  if (kind == "plane") return plane_in(reader, node);
  if (kind == "disk") return disk_in(reader, node);
  if (kind != "level_set") return round_in(reader, kind, node);
  const Formula phi = formula_in(reader, node);
  return solid ? level_set(point_value_of(phi), gradient_of(phi))
               : level_set(value_and_gradient_of(phi));
}

/// Whether contact is along the normal of the body. The published law takes that of a round body on
/// a disk, in space of one on a sphere or cylinder; any other that of what is rigid.
bool is_along_body(const CaseNode &node, bool large, bool is_round) {
  const std::string normal =
      choice_or(node, "normal", "auto", {"auto", "body", "rigid", "deformed"});
  if (large && normal == "body")
    throw bad_input("normal: body is that of the undeformed body: with kinematics: large use rigid "
                    "or deformed");
  if (!large && normal == "deformed")
    throw bad_input("normal: deformed is that of the deformed body: use it with kinematics: large");
  const auto is_against = [&](const char *kind) {
    return entry(node, "against").find(kind) != nullptr;
  };
  if (normal == "auto")
    return !large && is_round &&
           (is_against("disk") || is_against("sphere") || is_against("cylinder"));
  return normal != "rigid";
}

RigidContact rigid_in(Reader &reader, const CaseNode &node, const CaseNode &against, Scene &scene) {
  const auto in_space = [&](const char *key, const char *value) {
    if (const CaseNode *given = node.find(key); given != nullptr && given->value == value)
      throw bad_input("a solid has no '" + std::string(key) + ": " + value + "' yet: leave it out");
  };
  if (scene.dim == 3) {
    in_space("kinematics", "large");
    in_space("formulation", "nitsche");
    in_space("gap", "vertical");
  }
  check_used(node, "with something rigid",
             {"at", "against", "normal", "gap", "gap_from", "friction", "adhesion", "kinematics",
              "formulation", "nitsche_gamma0", "lumped"});
  const Side side = side_of(reader, entry(node, "at").value, scene);
  const bool of_curve = choice_or(node, "gap_from", "curve", {"curve", "edges"}) == "curve";
  const std::string gap = choice_or(node, "gap", "closest", {"closest", "ray", "vertical"});
  RigidSurface surface{side.boundary, surface_in(reader, against)};
  if (of_curve) surface.at_rest = side.at;
  surface.body_normal = side.normal;
  surface.large = is_large(node);
  surface.along_body = is_along_body(node, surface.large, bool(side.normal));
  surface.partner = gap == "ray"        ? Partner::ray
                    : gap == "vertical" ? Partner::vertical
                                        : Partner::closest;
  surface.friction = friction_in(reader, node, scene);
  surface.friction.adhesion = adhesion_in(reader, node);
  surface.lumped = yes_or(node, "lumped", false);
  RigidContact rigid = rigid_contact(surface);
  rigid.curved = !side.at && of_curve;
  if (!surface.friction.adhesion) return rigid;
  check_adhesion(node, rigid, scene);
  std::optional<Form> of_one;
  if (const CaseNode *plane = against.find("plane"); plane != nullptr &&
                                                     plane->find("tilt") == nullptr &&
                                                     !surface.along_body && map_of(reader).empty())
    of_one = traction_load(
        rigid.boundary,
        [n = vector_in(reader, entry(*plane, "normal"))](const FullMu &, const Point &,
                                                         const Point &) { return n; },
        scene.components, scene.degree, scene.axisymmetric);
  add_pull(reader, node, of_one, adhesive_load(rigid, scene), scene);
  return rigid;
}

ContactRecipe with_something_rigid(Reader &reader, const CaseNode &node, const CaseNode &against,
                                   Scene &scene) {
  if (scene.axisymmetric && yes_or(node, "lumped", false))
    throw bad_input("vertex quadrature sees nothing on the axis: leave out lumped");
  const RigidContact rigid = rigid_in(reader, node, against, scene);
  if (choice_or(node, "formulation", "mixed", {"mixed", "nitsche"}) == "mixed")
    return by_multipliers(rigid);
  if (std::ranges::any_of(scene.materials,
                          [](const BodyMaterial &m) { return static_cast<bool>(m.free_strain); }))
    throw bad_input("formulation: nitsche has no stress of a temperature: leave it out");
  const double gamma0 = number_or(reader, node, "nitsche_gamma0", usual_gamma0);
  if (!(gamma0 >= gamma0_range.lower && gamma0 <= gamma0_range.upper))
    throw bad_input("nitsche_gamma0 is " + short_number(gamma0) + ": it lies between 0.1 and 2000");
  return by_nitsche(rigid, gamma0);
}

ContactRecipe with_another_body(Reader &reader, const CaseNode &node, const std::string &master,
                                Scene &scene) {
  check_used(
      node, "between bodies",
      {"at", "against", "kinematics", "multiplier", "integration", "projection", "friction"});
  const bool continuous = choice_or(node, "multiplier", "p0", {"p0", "p1"}) == "p1",
             direct = choice_or(node, "integration", "intersection", {"intersection", "direct"}) ==
                      "direct",
             vertical =
                 choice_or(node, "projection", "normal", {"normal", "vertical"}) == "vertical";
  return two_bodies({entry(node, "at").value,
                     master,
                     {continuous ? MultiplierSpace::nodes : MultiplierSpace::macro_edges,
                      direct ? PairQuadrature::direct : PairQuadrature::intersection,
                      vertical ? PairProjection::vertical : PairProjection::normal},
                     is_large(node),
                     friction_in(reader, node, scene)});
}

ContactRecipe contact_in(Reader &reader, const CaseNode &node, Scene &scene) {
  const CaseNode *above = node.find("above"), *below = node.find("below"),
                 *against = node.find("against");
  const bool on_obstacle = above != nullptr || below != nullptr;
  const CaseNode &at = entry(node, "at");
  if (!at.is_value() || at.value == "all")
    throw bad_input("contact is at one boundary, or one region, with a name: give each its entry");
  if (int(above != nullptr) + int(below != nullptr) + int(against != nullptr) != 1)
    throw bad_input("contact is 'above: HEIGHT' or 'below: HEIGHT' of a membrane (of both two "
                    "contacts), or 'against:' something");
  if (on_obstacle != (scene.components == 1))
    throw bad_input(on_obstacle ? "'above' and 'below' are for a membrane: use 'against'"
                                : "a membrane has contact 'above: HEIGHT' or 'below: HEIGHT'");
  if (on_obstacle) {
    check_used(node, "of a membrane", {"at", "above", "below", "adhesion", "lumped"});
    const Obstacle on{
        at.value, point_value_of(formula_in(reader, above != nullptr ? *above : *below)),
        yes_or(node, "lumped", true), adhesion_in(reader, node), above != nullptr ? 1.0 : -1.0};
    std::optional<Form> of_one;
    if (map_of(reader).empty())
      of_one = body_load(on.region, everywhere(Point{-on.side, 0, 0}), 1, scene.degree);
    if (on.adhesion) add_pull(reader, node, of_one, adhesive_load(on, scene), scene);
    return obstacle(on);
  }
  if (scene.dim == 3 && !against->is_table())
    throw bad_input("two solids do not meet yet: contact of a solid is with something rigid");
  return against->is_table() ? with_something_rigid(reader, node, *against, scene)
                             : with_another_body(reader, node, against->value, scene);
}

} // namespace

void read_contact(Reader &reader, Scene &scene, Defects &defects) {
  const CaseNode &contacts = section(reader, "contact");
  if (contacts.entries.empty()) defects.add(contacts, "no contact is named");
  for (const auto &[name, node] : contacts.entries)
    defects.collect(node, [&, &own = name, &value = node] {
      scene.contacts.push_back(contact_in(reader, value, scene));
      scene.contacts.back().name = own;
    });
}

} // namespace rbvi
