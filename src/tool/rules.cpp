// Options that do not go together, or not with the scene.
#include "database.hpp"
#include "table.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/solve/methods.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// Throws bad_input for a mesh file beside an option of the built-in mesh.
void check_mesh_options(const ToolOptions &options) {
  if (options.mesh.file.empty()) return;
  for (const SceneOption &option : entry_of(*options.registry, options.scene.name).options)
    if (option.built_in_mesh && is_given(option.name))
      throw bad_input("-" + option.name +
                      " is of the built-in mesh and has no effect on that of -mesh: leave out "
                      "one of the two");
}

/// Throws bad_input for tolerances of B^n and of B^tau where they are not apart.
void check_rows_apart(const Scene &scene, const ReduceOptions &reduce) {
  if (!reduce.eim_normal && !reduce.eim_tangential) return;
  if (reduce.multipliers.reduction != MultiplierReduction::collocated)
    throw bad_input("-eim_normal_tolerance and -eim_tangential_tolerance are for "
                    "-multiplier_reduction collocated: use -eim_tolerance");
  if (scene.contacts.size() > 1)
    throw bad_input("-eim_normal_tolerance and -eim_tangential_tolerance are for a single contact "
                    "interface: use -eim_tolerance");
  if (reduce.eim_tangential && !has_friction(scene))
    throw bad_input("-eim_tangential_tolerance is for contact with friction, which this scene has "
                    "not");
}

/// Throws bad_input for options of a formulation that the scene has not.
void check_formulation(const Scene &scene) {
  if (!has_multipliers(scene) && is_given("hf_method"))
    throw bad_input("-hf_method is for the mixed formulation: Nitsche's method has "
                    "-nitsche_snes_type");
  if (!has_multipliers(scene) && is_given("hf_contact"))
    throw bad_input("-hf_contact is for the mixed formulation: Nitsche's method has no "
                    "multipliers");
  if (!has_multipliers(scene) && is_given("multiplier_reduction"))
    throw bad_input("-multiplier_reduction is for the mixed formulation: Nitsche's method has no "
                    "multipliers");
  if (has_multipliers(scene) && is_given("nitsche_quadrature"))
    throw bad_input("-nitsche_quadrature is for Nitsche's method: set -formulation nitsche");
}

/// Throws bad_input for options of a dual basis and of its supremizers where the scene keeps every
/// node by default. Who asks for that, maybe beside a case file with such options, means it.
void check_dual_basis(const ToolOptions &options) {
  if (!has_multipliers(options.scene) || is_given("multiplier_reduction") ||
      options.reduce.multipliers.reduction != MultiplierReduction::condensed)
    return;
  for (const Option &option : tool_options())
    if ((option.name.starts_with("cone_") || option.name.starts_with("pga_")) &&
        option.name != "cone_level" && is_given(option.name))
      throw bad_input("-" + option.name +
                      " is for a reduced dual basis, and -multiplier_reduction condensed, the "
                      "default here, keeps every node: add -multiplier_reduction " +
                      (has_friction(options.scene) ? "collocated" : "cone") + ", or leave it out");
}

void check_cone_level(const ToolOptions &options) {
  const ConeOptions &cone = options.reduce.cone;
  if (cone.level == 0) return;
  if (!has_multipliers(options.scene))
    throw bad_input("-cone_level is for the mixed formulation: Nitsche's method has no "
                    "multipliers");
  const bool law = keeps_law(options.reduce.multipliers.reduction);
  if (!law && cone.type != ConeType::hybrid)
    throw bad_input("-cone_level chooses hat functions, and -cone_type " +
                    cone_type_names()[static_cast<std::size_t>(cone.type)] +
                    " has none: use -cone_type hybrid");
  if (cone.level > options.mesh.refine)
    throw bad_input("-cone_level " + std::to_string(cone.level) +
                    " takes the hat functions of a mesh with so many refinements less, and "
                    "-mesh_refine is " +
                    std::to_string(options.mesh.refine));
}

bool has_law(const Scene &scene, FrictionLaw law) {
  return std::ranges::any_of(scene.contacts,
                             [&](const ContactRecipe &c) { return c.friction == law; });
}

bool collocates(const ToolOptions &options) {
  return options.reduce.multipliers.reduction == MultiplierReduction::collocated;
}

/// Options of one method, by how they begin, and what they are for.
struct OfMethod {
  const char *begin;
  bool (*used)(const ToolOptions &options);
  const char *is_for;
};

constexpr const char *without_multipliers =
    "the mixed formulation: Nitsche's method has no multipliers";
const OfMethod of_methods[] = {
    {"nitsche_", [](const ToolOptions &o) { return !has_multipliers(o.scene); },
     "Nitsche's method: set -formulation nitsche"},
    {"nitsche_loop", [](const ToolOptions &o) { return has_law(o.scene, FrictionLaw::coulomb); },
     "Coulomb's friction: set -friction coulomb"},
    {"nitsche_quadrature_tolerance",
     [](const ToolOptions &o) { return o.reduce.curve.rule == CurveRule::empirical; },
     "-nitsche_quadrature empirical"},
    {"nitsche_eim_",
     [](const ToolOptions &o) { return o.reduce.curve.rule == CurveRule::interpolated; },
     "-nitsche_quadrature interpolated"},
    {"cone_", [](const ToolOptions &o) { return has_multipliers(o.scene); }, without_multipliers},
    {"pga_", [](const ToolOptions &o) { return has_multipliers(o.scene); }, without_multipliers},
    {"uzawa_",
     [](const ToolOptions &o) {
       return has_multipliers(o.scene) && o.hf.method == HfMethod::uzawa;
     },
     "-hf_method uzawa"},
    {"nonlinear_", [](const ToolOptions &o) { return follows_state(o.scene); },
     "contact that follows the displacement: set -kinematics large"},
    {"gcns_", collocates, "-multiplier_reduction collocated"},
    {"online_method", has_online_method,
     "-multiplier_reduction collocated (uzawa), for contact with multipliers that follows the "
     "displacement (kacanov), or for -nitsche_quadrature interpolated (newton)"},
    {"tangential_", collocates, "-multiplier_reduction collocated"},
    {"multiplier_exact", collocates, "-multiplier_reduction collocated"},
    {"friction_bound", [](const ToolOptions &o) { return has_law(o.scene, FrictionLaw::tresca); },
     "-friction tresca"},
    {"friction_", [](const ToolOptions &o) { return has_friction(o.scene); },
     "contact with friction, which this scene has not: leave out -friction none"}};

/// Throws bad_input for options on the command line that nothing of the run uses, and for a free
/// parameter that is one. In a case file they may wait for another command line.
void check_effect(const ToolOptions &options) {
  const auto check = [&](const std::string &name, const std::string &what) {
    for (const OfMethod &method : of_methods)
      if (name.starts_with(method.begin) && !method.used(options))
        throw bad_input(what + " has no effect: it is for " + method.is_for);
  };
  for (const std::string &name : options.command_line)
    check(name, "-" + name);
  const ParameterSpace &space = options.scene.parameters;
  for (int i = 0; i < space.size(); ++i)
    check(space.at(i).name, "the free parameter " + space.at(i).name);
}

} // namespace

bool has_online_method(const ToolOptions &options) {
  switch (options.online_method) {
  case OnlineMethod::exact:
    return true;
  case OnlineMethod::uzawa:
    return has_multipliers(options.scene) && collocates(options);
  case OnlineMethod::kacanov:
    return has_multipliers(options.scene) && follows_state(options.scene);
  case OnlineMethod::newton:
    return !has_multipliers(options.scene) && options.reduce.curve.rule == CurveRule::interpolated;
  }
  return false;
}

void check_rules(const ToolOptions &options) {
  const ReduceOptions &reduce = options.reduce;
  check_mesh_options(options);
  check_formulation(options.scene);
  if (options.hf.method == HfMethod::vi) require_bounds_at_nodes(options.scene);
  if (options.hf.method != HfMethod::active_set && is_given("hf_contact"))
    throw bad_input("-hf_contact is for -hf_method active_set");
  if (reduce.enrichment == Enrichment::online && reduce.product == SupremizerProduct::energy)
    throw bad_input("-pga_enrichment online takes supremizers in the V product: leave out "
                    "-pga_product energy");
  check_rows_apart(options.scene, reduce);
  check_dual_basis(options);
  check_cone_level(options);
  check_effect(options);
}

} // namespace rbvi
