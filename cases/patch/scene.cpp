// Patch tests: the exact stress is constant, and every formulation must reproduce it.
//
// Two bodies: elastic blocks, 1 wide and 0.5 high, on top of each other, their meshes not matching.
// The sides do not move sideways, the foot is fixed, the top goes down by the parameter. Exactly:
// uniaxial strain -indentation, pressure E (1 - nu) / ((1 + nu) (1 - 2 nu)) indentation.
//
// One body: the upper block on a flat rigid support with Coulomb friction. The top moves by
// (shear, -indentation), the sides carry the tractions of the exact stress: strain -2 indentation
// downwards and, with G the shear modulus and p the pressure, a shear of 2 shear where G (2 shear)
// <= nu_F p, so that the foot sticks; else nu_F p / G, and the foot slips as a whole.
#include "scene.hpp"

#include "rbvi/contact/elastic_pair.hpp"
#include "rbvi/contact/nitsche_support.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/places.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/facet_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

constexpr double apart = 0.25; ///< of each reference block from the contact line y = 0
constexpr double height = 0.5;
constexpr double largest_strain = 0.25;

/// Positions of the parameters of one body.
enum Position { indentation, shear, friction };

/// From (0, y) to (1, y).
Place level(double y) {
  return segment({0, y, 0}, {1, y, 0});
}

/// The sides x = 0 and x = 1 from y = low on.
Place two_sides(double low) {
  return nearest(
      {segment({0, low, 0}, {0, low + height, 0}), segment({1, low, 0}, {1, low + height, 0})});
}

MeshRecipe mesh_of_two() {
  const double high = apart + height;
  const Place upper = box({0, apart, 0}, {1, high, 0}), lower = box({0, -high, 0}, {1, -apart, 0});
  MeshRecipe recipe{
      "two_blocks", {"upper", "lower"}, {"sides", "top", "bottom", "slave", "master"}};
  recipe.facts = {{"", "two blocks, 1 m wide and 0.5 m high", nearest({upper, lower}), 1},
                  {"upper", "the block [0, 1] x [0.25, 0.75]", upper, 0.5},
                  {"lower", "the block [0, 1] x [-0.75, -0.25]", lower, 0.5},
                  {"sides", "the sides x = 0 and x = 1 of both blocks",
                   nearest({two_sides(apart), two_sides(-high)}), 2},
                  {"top", "the side y = 0.75 of the upper block", level(high), 1},
                  {"bottom", "the side y = -0.75 of the lower block", level(-high), 1},
                  {"slave", "the side y = 0.25 of the upper block", level(apart), 1},
                  {"master", "the side y = -0.25 of the lower block", level(-apart), 1}};
  return recipe;
}

MeshRecipe mesh_of_one() {
  MeshRecipe recipe{"one_block", {}, {"sides", "top", "contact"}};
  recipe.facts = {
      {"", "the block [0, 1] x [0, 0.5], in metres", box({0, 0, 0}, {1, height, 0}), 0.5},
      {"sides", "the sides x = 0 and x = 1", two_sides(0), 1},
      {"top", "the side y = 0.5", level(height), 1},
      {"contact", "the side y = 0", level(0), 1}};
  return recipe;
}

const auto joined_map = plain<PointMap>("patch/joined", 1, [](const FullMu &, const Point &x) {
  return Point{x[0], x[1] - (x[1] > 0 ? apart : -apart), 0};
});

const auto upper_down =
    plain<PointMap>("patch/upper_down", 1, [](const FullMu &mu, const Point &x) {
      return Point{0, x[1] > 0 ? -mu[indentation] : 0, 0};
    });

const auto top_moved = plain<PointMap>("patch/top_moved", 1, [](const FullMu &mu, const Point &) {
  return Point{mu[shear], -mu[indentation], 0};
});

const auto strain = plain<Coefficient>("patch/strain", 1,
                                       [](const FullMu &mu) { return mu[indentation] / height; });

/// What friction at the foot allows; without friction `frictionless` is 1.
const Maker<Coefficient> shear_stress_at{
    "patch/shear_stress", 1, [](const Record &of) -> std::function<Coefficient> {
      const Lame material{number(of, "lambda"), number(of, "shear")};
      const bool frictionless = number(of, "frictionless") != 0;
      return [=](const FullMu &mu) {
        const double pressure = (material.lambda + 2 * material.shear) * (mu[indentation] / height);
        const double most = frictionless ? 0 : mu[friction] * pressure;
        return std::clamp(material.shear * mu[shear] / height, -most, most);
      };
    }};

Scene make_two(const SceneOptions &options) {
  Scene scene;
  set_elastic_pair(options, {true, true}, scene);
  scene.parameters = all_free({{"indentation", "m", 0.01, 0.1, 0.05, {0, largest_strain}}});
  scene.mesh = mesh_of_two();
  scene.map = joined_map();
  scene.fixed = {{"sides", {0}}, {"top", {}}, {"bottom", {}}};
  scene.motion = upper_down();
  return scene;
}

/// int sigma n . v over the sides, sigma the exact stress: sigma_xx = - lambda strain, sigma_xy the
/// shear stress that friction at the foot allows.
Sum side_load(const Lame &material, bool frictionless, int degree) {
  const Named<Coefficient> shear_stress =
      shear_stress_at({{"lambda", {material.lambda}},
                       {"shear", {material.shear}},
                       {"frictionless", {double(frictionless)}}});
  const auto across = [](const FullMu &, const Point &, const Point &n) -> Point {
    return {n[0], 0, 0};
  };
  const auto along = [](const FullMu &, const Point &, const Point &n) -> Point {
    return {0, n[0], 0};
  };
  return {exact_term(traction_load("sides", across, 2, degree),
                     {{"minus lambda", constant(-material.lambda), {}},
                      {"strain", strain(), {indentation}}}),
          exact_term(traction_load("sides", along, 2, degree),
                     {{"shear stress", shear_stress, {indentation, shear, friction}}})};
}

Scene make_one(const SceneOptions &options) {
  Scene scene;
  const Lame material = lame(number_in(options, "young"), number_in(options, "poisson_ratio"));
  const bool frictionless = options.at("friction") == "none";
  scene.components = 2;
  scene.degree = options.at("degree") == "2" ? 2 : 1;
  Support support{"contact", everywhere({0, -1, 0}), everywhere(0.0)};
  support.friction.law = frictionless ? FrictionLaw::none : FrictionLaw::coulomb;
  support.friction.value = parameter(friction);
  support.lumped = options.at("lumped") == "yes";
  support.closed_ends = true;
  scene.contacts = {contact_by(options, rigid_contact(support))};
  scene.parameters = all_free({{"indentation", "m", 0.01, 0.1, 0.05, {0, largest_strain * height}},
                               {"shear", "m", 0, 0.2, 0.02, {-height / 2, height / 2}},
                               {"friction_coefficient", "", 0, 1, 0.3, friction_range}});
  scene.parameters.free = {indentation};
  scene.material = everywhere(material);
  scene.mesh = mesh_of_one();
  scene.map = identity();
  scene.fixed = {{"top", {}}};
  scene.motion = top_moved();
  scene.a = {exact_term(elasticity("", material, scene.degree))};
  scene.f = side_load(material, frictionless, scene.degree);
  scene.v_product = {exact_term(h1_product(1, 2, scene.degree))};
  return scene;
}

Scene make(const SceneOptions &options) {
  if (options.at("bodies") == "two" && options.at("formulation") != "mixed")
    throw bad_input("Nitsche's method is for one body on a rigid support: use -bodies one");
  if (options.at("lumped") == "yes" &&
      (options.at("bodies") == "two" || options.at("formulation") != "mixed"))
    throw bad_input("-lumped yes is for one body on a rigid support by multipliers: use -bodies "
                    "one, and leave out -formulation nitsche");
  Scene scene = options.at("bodies") == "one" ? make_one(options) : make_two(options);
  scene.training = "grid:5";
  scene.validation = "random:5:1";
  return scene;
}

} // namespace

SceneEntry patch() {
  std::vector<SceneOption> options{
      {"bodies", "two", "two blocks, or one on a rigid support", {"one", "two"}},
      {"friction", "coulomb", "law of friction of one body", {"none", "coulomb"}},
      {"lumped", "no", "one body: vertex quadrature in b and g", {"no", "yes"}}};
  for (SceneOption &option : nitsche_options())
    options.push_back(std::move(option));
  return {"patch",
          "patch test: blocks on top of each other, or one on a rigid support with friction",
          elastic_pair_options(1, options),
          make,
          {joined_map, upper_down, top_moved, strain, shear_stress_at}};
}

} // namespace rbvi
