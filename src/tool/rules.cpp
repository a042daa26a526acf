// Options that do not go together, or not with the scene.
#include "database.hpp"
#include "table.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/solve/methods.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// Throws bad_input for a mesh file beside an option of the built-in mesh.
void check_mesh_options(const OfflineOptions &options) {
  if (options.mesh.file.empty()) return;
  for (const SceneOption &option : entry_of(*options.registry, options.scene.name).options)
    if (option.built_in_mesh && is_given(option.name))
      throw bad_input("-" + option.name +
                      " is of the built-in mesh and has no effect on that of -mesh: leave out "
                      "one of the two");
}

/// Throws bad_input for options of a dual basis and of its supremizers where the scene keeps every
/// node by default. Who asks for that, maybe beside a case file with such options, means it.
void check_dual_basis(const OfflineOptions &options) {
  if (is_given("multiplier_reduction") || unmet(use::dual_basis, options) != &use::dual_basis)
    return;
  for (const Option &option : tool_options())
    if (option.use == &use::dual_basis && is_given(option.name))
      throw bad_input("-" + option.name +
                      " is for a reduced dual basis, and -multiplier_reduction condensed, the "
                      "default here, keeps every node: add -multiplier_reduction " +
                      (is_of(use::friction, options) ? "collocated" : "cone") +
                      ", or leave it out");
}

void check_cone_level(const OfflineOptions &options) {
  if (is_of(use::hats, options) && options.reduce.cone.level > options.mesh.refine)
    throw bad_input("-cone_level " + std::to_string(options.reduce.cone.level) +
                    " takes the hat functions of a mesh with so many refinements less, and "
                    "-mesh_refine is " +
                    std::to_string(options.mesh.refine));
}

/// The runs that an option, one of a scene or of PETSc, or a parameter is for; null: all.
const Use *use_of(const std::string &name) {
  if (const Option *option = find_option(name)) return option->use;
  static const std::vector<std::pair<const char *, const Use *>> by_beginning{
      {"nitsche_", &use::nitsche}, {"friction_bound", &use::tresca}, {"friction_", &use::friction}};
  const auto found = std::ranges::find_if(
      by_beginning, [&](const auto &row) { return name.starts_with(row.first); });
  return found == by_beginning.end() ? nullptr : found->second;
}

/// Throws bad_input for options on the command line that nothing of the run uses, and for a free
/// parameter that is one. In a case file most wait for another command line (Option::waits).
void check_effect(const OfflineOptions &options) {
  const auto check = [&](const std::string &name, const std::string &what) {
    const Use *use = use_of(name), *missed = use == nullptr ? nullptr : unmet(*use, options);
    if (missed != nullptr) throw bad_input(what + " has no effect: it is for " + missed->is_for);
  };
  for (const std::string &name : options.command_line)
    check(name, "-" + name);
  for (const Option &option : tool_options())
    if (!option.waits && is_given(option.name)) check(option.name, "-" + option.name);
  const ParameterSpace &space = options.scene.parameters;
  for (int i = 0; i < space.size(); ++i)
    check(space.at(i).name, "the free parameter " + space.at(i).name);
}

} // namespace

void check_rules(const OfflineOptions &options) {
  const ReduceOptions &reduce = options.reduce;
  check_mesh_options(options);
  if (options.hf.method == HfMethod::vi) require_bounds_at_nodes(options.scene);
  if (reduce.enrichment == Enrichment::online && reduce.product == SupremizerProduct::energy)
    throw bad_input("-pga_enrichment online takes supremizers in the V product: leave out "
                    "-pga_product energy");
  check_dual_basis(options);
  check_cone_level(options);
  check_effect(options);
}

} // namespace rbvi
