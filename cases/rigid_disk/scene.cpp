// An elastic half-disk of radius R, its flat side on top and pushed down, on a rigid disk of radius
// 1. Plane strain; u = (0, -indentation) on the whole flat side. On the arc within 22.5 degrees of
// the lowest point, with n the normal and d the gap along it,
//
//   u . n <= d,   held by a pressure lambda_n >= 0,
//
// and friction: |lambda_tau| <= s (Tresca), nu_F lambda_n (Coulomb), against the total tangential
// displacement u . tau (3.16), (3.34). The reference domain has the radius 1 and h(x) = R x: a
// similarity, which leaves a plane stiffness as it is and multiplies b by R. What does depend on R
// is the gap. The same with Nitsche's method in place of multipliers (Niakh 2022, chapter 4), on a
// finer curve by default.
//
// Large deformations (Niakh 2022, appendix A): the condition is that of the deformed body on a
// wider arc, within 45 degrees; the elasticity stays linear. By either method. Contact of the
// undeformed body can be posed on that arc, too.
#include "scene.hpp"

#include "rbvi/contact/nitsche_support.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/places.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"

#include <cmath>
#include <numbers>

namespace rbvi {

namespace {

constexpr double initial_gap = 0.001, core_radius = 0.6;
constexpr int nitsche_edges = 316; // 2.5 mm, the mesh of the published study
/// Half of the contact arc: the angle from its lowest point.
constexpr double narrow_arc = std::numbers::pi / 8, wide_arc = std::numbers::pi / 4;
/// Indentation over the radius: from there on contact of the undeformed body reaches the ends of
/// the arc.
constexpr double deepest_narrow = 0.13, deepest_wide = 0.2;

/// Positions of the parameters.
enum Position { radius, indentation, friction, core_stiffness, poisson_ratio, offset };

/// Point of the exact arc.
Point on_arc(const FullMu &mu, const Point &x) {
  return mu[radius] / norm(x) * x;
}

/// From the centre of the rigid disk, (offset, -R - initial_gap - 1), to a point.
Point from_support(const FullMu &mu, const Point &x) {
  return {x[0] - mu[offset], x[1] + mu[radius] + initial_gap + 1, 0};
}

Point radial_normal(const FullMu &, const Point &x) {
  return x / norm(x);
}

/// Normal of the rigid disk at the point next to x, towards it.
Point rigid_normal(const FullMu &mu, const Point &x) {
  const Point p = from_support(mu, on_arc(mu, x));
  return Point{} - p / norm(p);
}

/// Along the normal n from p to the disk |p| = 1 (p being from its centre).
double gap_along(const Point &p, const Point &n) {
  const double half = dot(p, n);
  const double root = half * half - (dot(p, p) - 1);
  if (!(root > 0)) throw failure("a ray along the normal misses the rigid disk: use -gap closest");
  return -half - std::sqrt(root);
}

SurfacePoint rigid_disk_at(const FullMu &mu, const Point &y) {
  const Point p = from_support(mu, y);
  const double distance = norm(p);
  if (!(distance > 0)) throw failure("a point of the body is at the centre of the rigid disk");
  return {distance - 1, p / distance, 1 / distance};
}

const auto surfaces = plain<Surface>("rigid_disk/surface", 1, rigid_disk_at);
const auto points_on_arc = plain<PointMap>("rigid_disk/on_arc", 1, on_arc);
const auto radial_normals = plain<PointMap>("rigid_disk/radial_normal", 1, radial_normal);
const auto rigid_normals = plain<PointMap>("rigid_disk/rigid_normal", 1, rigid_normal);

/// (phi(x) - x) . n, phi(x) the partner of x on the rigid disk (3.4).
/// `from_arc`: of the point of the exact arc beside x.
std::function<PointValue> gap_function(const std::string &kind, bool from_arc,
                                       const std::function<PointMap> &normal) {
  return [=, along_normal = kind == "ray", vertical = kind == "vertical"](const FullMu &mu,
                                                                          const Point &x) {
    const Point at = from_arc ? on_arc(mu, x) : mu[radius] * x;
    const Point p = from_support(mu, at), n = normal(mu, x);
    if (along_normal) return gap_along(p, n);
    if (vertical) {
      if (!(std::abs(p[0]) < 1)) throw failure("no point of the rigid disk is below the arc");
      return (std::sqrt(1 - p[0] * p[0]) - p[1]) * n[1];
    }
    return (1 / norm(p) - 1) * dot(p, n);
  };
}

/// "closest", "ray", "vertical".
Maker<PointValue> gaps(const std::string &kind) {
  return {"rigid_disk/gap_" + kind, 1, [kind](const Stored &of) {
            return gap_function(kind, number(of, "from_arc") != 0,
                                made<PointMap>(part(of, "normal")));
          }};
}

Named<PointValue> gap_of(const SceneOptions &options, const Named<PointMap> &normal) {
  const std::string &kind = options.at("gap");
  const bool from_arc = options.at("gap_from") == "arc";
  return gaps(kind).named(gap_function(kind, from_arc, normal),
                          {{"from_arc", {from_arc ? 1.0 : 0.0}}}, {{"normal", normal.record}});
}

Friction friction_of(const SceneOptions &options) {
  const std::string &law = options.at("friction");
  Friction result;
  result.value = parameter(friction);
  result.only_in_contact = options.at("friction_bound") == "contact";
  result.law = law == "coulomb"  ? FrictionLaw::coulomb
               : law == "tresca" ? FrictionLaw::tresca
                                 : FrictionLaw::none;
  return result;
}

ParameterSpace parameters(FrictionLaw law, bool nitsche, double indented, double young) {
  ParameterSpace space =
      all_free({{"radius", "m", 0.7, 1.3, 1, {0.1, 10}},
                {"indentation", "m", 0.01, indented, 0.09, {0, 1.3}},
                {"friction_coefficient", "", 0, 0.5, nitsche ? 0.1 : 0.2, friction_range},
                {"core_stiffness", "", 0.2, 5, 1, {1e-3, 1e3}},
                {"poisson_ratio", "", 0.2, 0.45, 0.35, poisson_range},
                {"offset", "m", -0.1, 0.1, 0, {-1, 1}}});
  if (law == FrictionLaw::tresca)
    space.all[friction] = {"friction_threshold", "Pa", 0, 0.2, 0.1, {0, 1e4 * young}};
  space.free = {radius};
  return space;
}

MeshRecipe mesh(int edges, bool wide) {
  constexpr double pi = std::numbers::pi, down = -pi / 2;
  const double half_angle = wide ? wide_arc : narrow_arc;
  const Point centre{0, 0, 0};
  MeshRecipe recipe{
      wide ? "wide_half_disc" : "half_disc", {"core"}, {"top", "contact", "arc"}, {"arc"}, edges};
  recipe.facts = {{"", "the half y <= 0 of the disk of radius 1 m about the origin",
                   common_part(disk(centre, 1), box({-1, -1, 0}, {1, 0, 0})), pi / 2},
                  {"core", "the half disk of radius 0.6 m about the origin",
                   disk(centre, core_radius), pi / 2 * core_radius * core_radius},
                  {"top", "the flat side y = 0", segment({-1, 0, 0}, {1, 0, 0}), 2},
                  {"contact",
                   "the arc of radius 1 m within " + short_number(half_angle * 180 / pi) +
                       " degrees of (0, -1)",
                   arc(centre, 1, down, half_angle), 2 * half_angle, "arc"},
                  {"arc", "the whole half circle of radius 1 m, 'contact' included",
                   arc(centre, 1, down, pi / 2), pi}};
  recipe.inclusion = {"core", centre, core_radius};
  return recipe;
}

int arc_edges(const SceneOptions &options) {
  const double edges = number_in(options, "arc_edges");
  if (edges != 0 && (edges < 8 || std::fmod(edges, 2) != 0))
    throw bad_input("option arc_edges is " + options.at("arc_edges") +
                    ": it must be even and at least 8, or 0");
  return static_cast<int>(edges);
}

/// Throws bad_input unless the indentation all[1] is small enough beside the radius all[0] for
/// contact to stay on the arc: at most `deepest` times the radius.
void check_indentation(const FullMu &all, double deepest, const std::string &advice) {
  if (all[indentation] > deepest * all[radius] * (1 + 1e-12))
    throw bad_input("an indentation of " + short_number(all[indentation]) + " is above " +
                    short_number(deepest) + " of the radius " + short_number(all[radius]) +
                    ": contact would reach the ends of the arc" + advice);
}

void check_on_narrow_arc(const FullMu &all) {
  check_indentation(all, deepest_narrow, " (-contact_arc wide goes further)");
}

void check_on_wide_arc(const FullMu &all) {
  check_indentation(all, deepest_wide, "");
}

/// Throws bad_input where the rigid disk lies behind an end of the arc, against its radial normal:
/// a gap along that normal is not the way to the disk.
void check_facing(const FullMu &all, double half_angle) {
  for (const double angle : {-half_angle, half_angle}) {
    const Point n{std::sin(angle), -std::cos(angle), 0};
    const Point p = from_support(all, all[radius] * n);
    if (!(dot(p, n) < 0))
      throw bad_input("at a radius of " + short_number(all[radius]) + " and an offset of " +
                      short_number(all[offset]) +
                      " an end of the contact arc faces away from the rigid disk: make them "
                      "smaller, or use -contact_arc narrow or -normal rigid");
  }
}

void check_radial_on_narrow_arc(const FullMu &all) {
  check_on_narrow_arc(all);
  check_facing(all, narrow_arc);
}

void check_radial_on_wide_arc(const FullMu &all) {
  check_on_wide_arc(all);
  check_facing(all, wide_arc);
}

bool in_core(const Point &centre) {
  return norm(centre) < core_radius;
}

/// A = lambda A_lambda + shear A_shear on the ring and, times the core's stiffness, on the core; a
/// similarity leaves a plane stiffness as it is.
Sum stiffness(double young, int degree) {
  const Coordinate near_half{logarithm_to_half(), exponential_to_half()};
  const Factor lambda{
      "lambda", lame_lambda(young, poisson_ratio), {poisson_ratio}, {{poisson_ratio, near_half}}};
  const Factor shear{"shear", lame_shear(young, poisson_ratio), {poisson_ratio}};
  const Factor core{"core_stiffness",
                    parameter(core_stiffness),
                    {core_stiffness},
                    {{core_stiffness, {logarithm(), exponential()}}}};
  const auto part_of_body = [degree](bool inside, const Lame &material) {
    const auto inside_or_out = [=](const FullMu &, const Point &centre) {
      return in_core(centre) == inside ? material : Lame{0, 0};
    };
    return elasticity("", Named<Material>(inside_or_out), degree);
  };
  const Lame of_lambda{1, 0}, of_shear{0, 1};
  return {exact_term(part_of_body(false, of_lambda), {lambda}),
          exact_term(part_of_body(false, of_shear), {shear}),
          exact_term(part_of_body(true, of_lambda), {core, lambda}),
          exact_term(part_of_body(true, of_shear), {core, shear})};
}

const Maker<Material> ring_and_core{
    "rigid_disk/ring_and_core", 1, [](const Record &of) -> std::function<Material> {
      return [young = number(of, "young")](const FullMu &mu, const Point &centre) {
        const double stiffness = in_core(centre) ? mu[core_stiffness] : 1;
        return lame(stiffness * young, mu[poisson_ratio]);
      };
    }};

const auto scaled = plain<PointMap>(
    "rigid_disk/scaled", 1, [](const FullMu &mu, const Point &x) { return mu[radius] * x; });

const auto pushed_down =
    plain<PointMap>("rigid_disk/pushed_down", 1, [](const FullMu &mu, const Point &) {
      return Point{0, -mu[indentation], 0};
    });

const auto narrow_check = plain<Check>("rigid_disk/indentation", 1, check_on_narrow_arc);
const auto wide_check = plain<Check>("rigid_disk/indentation_on_wide_arc", 1, check_on_wide_arc);
const auto radial_narrow_check =
    plain<Check>("rigid_disk/radial_narrow_arc", 1, check_radial_on_narrow_arc);
const auto radial_wide_check =
    plain<Check>("rigid_disk/radial_wide_arc", 1, check_radial_on_wide_arc);

/// Contact that follows the displacement.
ContactRecipe following_contact(const SceneOptions &options, const Friction &friction) {
  if (options.at("gap") != "closest")
    throw bad_input("-kinematics large measures the gap to the next point: leave out -gap " +
                    options.at("gap"));
  const std::string &normal = options.at("normal");
  if (normal == "radial")
    throw bad_input("-normal radial is that of the undeformed body: with -kinematics large use "
                    "rigid or body");
  RigidSurface surface{"contact", surfaces()};
  if (options.at("gap_from") == "arc") surface.at_rest = points_on_arc();
  if (normal == "body") surface.body_normal = radial_normals();
  surface.friction = friction;
  surface.lumped = options.at("lumped") == "yes";
  return contact_by(options, rigid_contact(surface));
}

/// Contact on the undeformed body.
ContactRecipe contact_at_rest(const SceneOptions &options, const Friction &friction) {
  const std::string &choice = options.at("normal");
  if (choice == "body")
    throw bad_input("-normal body is that of the deformed body: use it with -kinematics large");
  const Named<PointMap> normal = choice == "rigid" ? rigid_normals() : radial_normals();
  Support support{"contact", normal, gap_of(options, normal), friction,
                  options.at("lumped") == "yes"};
  support.body_normal = radial_normals();
  return contact_by(options, rigid_contact(support));
}

Scene make(const SceneOptions &options) {
  Scene scene;
  const int edges = arc_edges(options);
  const double young = number_in(options, "young");
  scene.components = 2;
  scene.degree = options.at("degree") == "1" ? 1 : 2;
  const Friction friction = friction_of(options);
  const bool nitsche = asks_for_nitsche(options), large = options.at("kinematics") == "large";
  const std::string &arc = options.at("contact_arc");
  const bool wide = arc == "auto" ? large : arc == "wide";
  scene.contacts = {large ? following_contact(options, friction)
                          : contact_at_rest(options, friction)};
  scene.material = ring_and_core({{"young", {young}}});
  scene.parameters = parameters(friction.law, nitsche, large ? 0.2 : wide ? 0.14 : 0.09, young);
  if (!large && options.at("normal") == "rigid")
    scene.check_parameters = wide ? wide_check() : narrow_check();
  else if (!large)
    scene.check_parameters = wide ? radial_wide_check() : radial_narrow_check();
  scene.training = "grid:61";
  scene.validation = "random:30:1";
  scene.mesh = mesh(edges == 0 && nitsche ? nitsche_edges : edges, wide);
  scene.map = scaled();
  scene.snap = [](const Point &x) -> Point { return {x[0] / norm(x), x[1] / norm(x), 0}; };
  scene.fixed = {{"top", {}}};
  scene.motion = pushed_down();
  scene.a = stiffness(young, scene.degree);
  scene.symmetric = true;
  scene.skewed_by = offset;
  scene.v_product = {exact_term(h1_product(1, 2, scene.degree))};
  return scene;
}

} // namespace

SceneEntry rigid_disk() {
  std::vector<SceneOption> options{
      {"friction", "coulomb", "law of friction", {"none", "tresca", "coulomb"}},
      {"friction_bound",
       "arc",
       "Tresca's bound holds on the whole arc, or where there is contact",
       {"arc", "contact"}},
      {"kinematics",
       "small",
       "contact of the undeformed body, or (large) where the body now is",
       {"small", "large"}},
      {"normal",
       "auto",
       "of the half-disk (radial; auto with -kinematics small), of the rigid disk at the next "
       "point "
       "(rigid; auto with large), or of the deformed body",
       {"auto", "radial", "rigid", "body"}},
      {"gap",
       "closest",
       "along the normal to the next point, along a ray, or to the point below",
       {"closest", "ray", "vertical"}},
      {"gap_from",
       "arc",
       "the gap is measured from the exact arc, or from the straight edges of the mesh",
       {"arc", "edges"}},
      {"contact_arc",
       "auto",
       "contact within 22.5 degrees of the lowest point (narrow; auto with -kinematics small), or "
       "within 45 (wide; auto with large)",
       {"auto", "narrow", "wide"}},
      {"degree", "2", "of the displacement", {"1", "2"}},
      {"arc_edges",
       "0",
       "edges of the contact arc, an even number; 0: 100, with Nitsche's method 316, on the wide "
       "arc 200 by multipliers",
       {},
       {0, 10000},
       true},
      {"lumped", "no", "vertex quadrature in b and g", {"no", "yes"}},
      {"young", "15", "Young's modulus in Pa", {}, young_range}};
  for (SceneOption &option : nitsche_options())
    options.push_back(std::move(option));
  return {"rigid_disk",
          "Hertz contact of an elastic half-disk with a rigid disk, with friction",
          options,
          make,
          {surfaces, points_on_arc, radial_normals, rigid_normals, gaps("closest"), gaps("ray"),
           gaps("vertical"), ring_and_core, scaled, pushed_down, narrow_check, wide_check,
           radial_narrow_check, radial_wide_check}};
}

} // namespace rbvi
