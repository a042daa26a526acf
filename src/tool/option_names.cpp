// Names of options: which there are, and what to say of others.
#include "database.hpp"
#include "table.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// How options of PETSc's and SLEPc's kinds of objects begin.
const std::vector<std::string> all_kinds{"ksp_", "pc_", "mat_", "snes_", "sub_",
                                         "vec_", "dm_", "eps_", "svd_",  "st_",
                                         "bv_",  "ds_", "tao_", "ts_",   "is_"};

/// Options of PETSc itself that serve here.
const std::vector<std::string> petsc_names{"log_view",     "log_trace",    "info",
                                           "malloc_debug", "malloc_dump",  "options_left",
                                           "options_view", "options_file", "fp_trap"};

bool is_flag(const std::string &name) {
  const Option *option = find_option(name);
  return option != nullptr && option->kind == OptionKind::flag;
}

/// What to do about a name that nothing knows.
std::string advice(const std::string &name, std::vector<std::string> known) {
  for (const std::string &kind : all_kinds) {
    if (!name.starts_with(kind)) continue;
    std::vector<std::string> ours;
    for (const SolverPrefix &solver : solver_objects())
      if (contains(solver.kinds, kind))
        ours.push_back(std::string("-").append(solver.prefix).append(name));
    if (ours.empty()) return "no object of rbvi takes PETSc's options -" + kind + "*";
    return "PETSc's options need the prefix of a solver: " + joined(ours);
  }
  known.insert(known.end(), petsc_names.begin(), petsc_names.end());
  return "the nearest one is -" + nearest_name(name, known) + " (-help lists all)";
}

Error unknown_option(const std::string &name, const std::string &where,
                     const std::vector<std::string> &known, const Scene &scene,
                     const Registry &registry) {
  const std::string option = "option -" + name + where;
  if (contains(petsc_names, name))
    return bad_input(option + " is PETSc's own, which reads it as it starts: give it on the "
                              "command line");
  const std::string needed = what_needs(name, scene, registry);
  return bad_input(needed.empty() ? "unknown " + option + ": " + advice(name, known)
                                  : option + " " + needed);
}

} // namespace

std::vector<std::string> taken_names() {
  std::vector<std::string> names{"help", "version"};
  names.insert(names.end(), petsc_names.begin(), petsc_names.end());
  for (const Option &option : tool_options())
    if (option.name != "mu") names.push_back(option.name);
  return names;
}

const std::vector<SolverPrefix> &solver_objects() {
  static const std::vector<SolverPrefix> all{
      {"hf_", {"ksp_", "pc_", "mat_"}, "the stiffness A, but for Nitsche's method"},
      {"hf_krylov_", {"ksp_"}, "-hf_contact eliminated: the systems of its sets"},
      {"v_", {"ksp_", "pc_", "mat_"}, "the V product: Riesz representers"},
      {"vi_", {"snes_", "ksp_", "pc_", "mat_"}, "-hf_method vi"},
      {"nitsche_", {"snes_", "ksp_", "pc_", "mat_"}, "Nitsche's method"},
      {"pga_", {"eps_", "svd_"}, "offline: the projected greedy algorithm (SLEPc)"},
      {"infsup_",
       {"svd_", "eps_"},
       "verify, -pga_tolerance infsup: inf-sup constants (SLEPc); eps: beta_HF, c_HF of many "
       "multipliers"}};
  return all;
}

std::vector<std::string> prefixes_of(const std::vector<std::string> &kinds) {
  std::vector<std::string> prefixes;
  for (const SolverPrefix &solver : solver_objects())
    for (const std::string &kind : solver.kinds)
      if (contains(kinds, kind)) prefixes.push_back(solver.prefix + kind);
  return prefixes;
}

/// "-friction none": what a scene has that is not the default.
std::string chosen(const Scene &scene, const SceneEntry &entry) {
  std::vector<std::string> options;
  for (const SceneOption &option : entry.options)
    if (const auto own = scene.options.find(option.name);
        own != scene.options.end() && own->second != option.default_value)
      options.push_back("-" + option.name + " " + own->second);
  return joined(options);
}

std::string what_needs(const std::string &name, const Scene &scene, const Registry &registry) {
  std::string others;
  for (const SceneEntry &entry : registry) {
    bool found = std::ranges::find(entry.options, name, &SceneOption::name) != entry.options.end();
    for (const auto &[parameter, choice] : parameters_of(entry)) {
      if (parameter.name != name) continue;
      const bool is_there = std::ranges::find(scene.parameters.all, name, &Parameter::name) !=
                            scene.parameters.all.end();
      if (entry.name == scene.name)
        return !choice.empty() ? "needs " + choice
               : is_there      ? ""
                               : "has no effect with " + chosen(scene, entry);
      found = true;
    }
    if (found && entry.name == scene.name) return "";
    if (found) others += (others.empty() ? "" : ", ") + entry.name;
  }
  return others.empty() ? "" : "is of another scene (" + others + "), and this is " + scene.name;
}

void check_names(const std::vector<std::string> &names, const Origin &origin, const Scene &scene,
                 const Registry &registry) {
  std::vector<std::string> known;
  for (const Option &option : tool_options())
    known.push_back(option.name);
  for (const auto &[name, value] : scene.options)
    known.push_back(name);
  for (const Parameter &parameter : scene.parameters.all)
    known.push_back(parameter.name);
  for (const std::string &name : names) {
    const auto found = origin.find(name);
    const std::string where = found == origin.end() ? "" : found->second;
    if (starts_with_any(name, solver_prefixes())) continue;
    if (!contains(known, name)) throw unknown_option(name, where, known, scene, registry);
    if (!is_flag(name) && text_of(name).empty())
      throw bad_input("option -" + name + where + " has no value");
  }
}

} // namespace rbvi
