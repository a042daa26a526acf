// Options that do not go together, or not with the scene.
#include "database.hpp"
#include "table.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/solve/methods.hpp"

namespace rbvi {

namespace {

/// Throws bad_input for a mesh file beside an option of the built-in mesh.
void check_mesh_options(const ToolOptions &options) {
  if (options.mesh.file.empty()) return;
  for (const SceneEntry &entry : scene_catalogue())
    for (const SceneOption &option : entry.options)
      if (entry.name == options.scene.name && option.built_in_mesh && is_given(option.name))
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

} // namespace

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
}

} // namespace rbvi
