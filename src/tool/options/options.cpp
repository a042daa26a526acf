#include "rbvi/tool/options/options.hpp"

#include "database.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/options/case_file.hpp"
#include "rbvi/tool/options/run_directory.hpp"

#include <algorithm>
#include <cctype>

namespace rbvi {

namespace {

/// Largest relative error that a reduced model may be asked for: above, it says nothing.
constexpr double rough = 0.5;

/// -case, or the options that a run directory was made with, or none for the defaults of -scene.
std::string case_file_name() {
  const std::string file = text_of("case"), out = text_of("out");
  if (!file.empty()) return file;
  if (!out.empty() && std::filesystem::exists(case_of_run(out))) return case_of_run(out);
  if (!text_of("scene").empty()) return "";
  throw bad_input(
      "no case is named: use -case cases/<scene>/case.yaml, or -scene NAME (rbvi list)");
}

/// Puts the case file below the command line. Returns where its options stand.
Origin insert_case_file(MPI_Comm comm, const std::vector<std::string> &command_line) {
  std::string file;
  collectively(comm, [&] { file = case_file_name(); });
  Origin origin;
  if (file.empty()) return origin;
  for (const CaseEntry &entry : parse_case_file(read_case_text(comm, file), file)) {
    if (entry.name == "case")
      throw bad_input("a case file cannot name another: line " + std::to_string(entry.line) +
                      " of " + file);
    if (contains(command_line, entry.name)) continue;
    const std::string value = beside_case(entry.name, entry.value, file);
    RBVI_CALL(PetscOptionsSetValue(nullptr, ("-" + entry.name).c_str(),
                                   value.empty() ? nullptr : value.c_str()));
    origin[entry.name] = " (line " + std::to_string(entry.line) + " of " + file + ")";
  }
  return origin;
}

SceneOptions scene_options_of(const std::string &scene) {
  SceneOptions options;
  for (const SceneEntry &entry : scene_catalogue()) {
    if (entry.name != scene) continue;
    for (const SceneOption &option : entry.options)
      if (is_given(option.name)) options[option.name] = text_of(option.name);
  }
  return options;
}

enum class Given { nothing, value, bounds };

/// "-radius 0.2" fixes a parameter, "-radius 0.18,0.22" frees it between bounds.
Given adapt_parameter(Parameter &parameter) {
  const std::string text = text_of(parameter.name);
  const std::vector<std::string> parts = split(text, ',');
  const std::string what = "option -" + parameter.name;
  if (text.empty()) return Given::nothing;
  if (parts.size() == 1) {
    parameter.value = parse_number(parts[0], what);
    check_range(parameter.valid, parameter.value, what);
    return Given::value;
  }
  if (parts.size() != 2)
    throw bad_input(what + " is '" + text + "': give one value, or two bounds");
  parameter.lower = parse_number(parts[0], what);
  parameter.upper = parse_number(parts[1], what);
  if (parameter.lower == parameter.upper)
    throw bad_input(what + " is '" + text + "': both bounds are the same; one value fixes it");
  if (!(parameter.lower < parameter.upper))
    throw bad_input(what + " is '" + text + "': the lower bound comes first");
  check_range(parameter.valid, parameter.lower, what + ", lower bound,");
  check_range(parameter.valid, parameter.upper, what + ", upper bound,");
  parameter.value = std::clamp(parameter.value, parameter.lower, parameter.upper);
  return Given::bounds;
}

/// "-parameters" says which are free; without it those with two bounds and those that the scene
/// frees, less those with one value.
void adapt_parameters(ParameterSpace &space) {
  std::string unfixed;
  std::vector<std::string> fixed;
  for (int i = 0; i < static_cast<int>(space.all.size()); ++i) {
    Parameter &parameter = space.all[static_cast<std::size_t>(i)];
    const Given given = adapt_parameter(parameter);
    const bool free = std::find(space.free.begin(), space.free.end(), i) != space.free.end();
    if (given == Given::value)
      fixed.push_back(parameter.name);
    else if (free || given == Given::bounds)
      unfixed += (unfixed.empty() ? "" : ",") + parameter.name;
  }
  const std::string named = text_of("parameters");
  space = free_only(space, named.empty() ? unfixed : named);
  for (int i = 0; i < space.size(); ++i)
    if (contains(fixed, space.at(i).name))
      throw bad_input("parameter " + space.at(i).name + " is freed by -parameters and fixed by -" +
                      space.at(i).name + " " + text_of(space.at(i).name) + ": give two bounds");
}

/// The options as a case file, without those of one command.
std::string as_case_file(const std::vector<std::string> &names) {
  const std::vector<std::string> of_command{"case", "out", "plan", "mu", "vtu", "csv"};
  std::string text = std::string(run_case_header) + "\n";
  for (const std::string &name : names) {
    if (contains(of_command, name)) continue;
    text += case_line(name, value_in_run(name, text_of(name)));
    // What a solver must ask for is unread until it does: check_solver_options.
    if (starts_with_any(name, solver_prefixes())) mark_unread(name);
  }
  return text;
}

ReduceOptions reduce_options(const ParameterSpace &space) {
  ReduceOptions options;
  options.pod.tolerance = number_of("pod_tolerance", 0, rough);
  options.pod.max_size = integer_of("pod_max_size", 0, 100000);
  options.cone.type = static_cast<ConeType>(choice_of("cone_type", cone_type_names()));
  options.cone.tolerance = number_of("cone_tolerance", 0, rough);
  options.cone.max_size = integer_of("cone_max_size", 0, 100000);
  options.cone.feasibility = number_of("cone_feasibility", 0, rough);
  options.cone.ring = integer_of("cone_ring", 0, 1000);
  options.enrichment = static_cast<Enrichment>(choice_of("pga_enrichment", enrichment_names()));
  options.product = static_cast<SupremizerProduct>(choice_of("pga_product", product_names()));
  if (options.enrichment == Enrichment::online && options.product == SupremizerProduct::energy)
    throw bad_input("-pga_enrichment online takes supremizers in the V product: leave out "
                    "-pga_product energy");
  const std::string reference = text_of("reference_mu");
  if (!reference.empty())
    options.reference =
        while_doing("reading option -reference_mu", [&] { return parse_mu(space, reference); });
  options.infsup_tolerance = text_of("pga_tolerance") == "infsup";
  if (!options.infsup_tolerance)
    options.pga.tolerance = while_doing("reading -pga_tolerance, a number or infsup",
                                        [] { return number_of("pga_tolerance", 0, 0.999); });
  options.pga.stability = number_of("pga_beta_fraction", 0, 1 - 1e-12);
  options.pga.max_size = integer_of("pga_max_size", 0, 100000);
  options.eim.tolerance = number_of("eim_tolerance", 0, rough);
  options.eim.max_size = integer_of("eim_max_size", 0, 100000);
  if (is_given("eim_normal_tolerance"))
    options.eim_normal = number_of("eim_normal_tolerance", 0, rough);
  if (is_given("eim_tangential_tolerance"))
    options.eim_tangential = number_of("eim_tangential_tolerance", 0, rough);
  options.condensed.tolerance = number_of("condensed_tolerance", 0, rough);
  options.condensed.responses = number_of("response_tolerance", 0, rough);
  options.multipliers.reduction = static_cast<MultiplierReduction>(
      choice_of("multiplier_reduction", multiplier_reduction_names()));
  options.multipliers.tangential = number_of("tangential_tolerance", 0, rough);
  options.multipliers.extra_nodes = integer_of("joint_extra_nodes", 0, 100000);
  options.multipliers.exact = flag_of("multiplier_exact");
  options.curve.rule = static_cast<CurveRule>(choice_of("nitsche_quadrature", curve_rule_names()));
  options.curve.tolerance = number_of("nitsche_quadrature_tolerance", 0, rough);
  options.curve.eim_tolerance = number_of("nitsche_eim_tolerance", 0, rough);
  if (const std::string unseen = text_of("nitsche_eim_validation"); !unseen.empty())
    options.curve.eim_validation = while_doing("reading option -nitsche_eim_validation",
                                               [&] { return parse_set(space, unseen); });
  options.gcns.tolerance = number_of("gcns_tolerance", 0, 1e300);
  options.gcns.max_nodes = integer_of("gcns_max_nodes", 0, 100000);
  return options;
}

HfOptions hf_options() {
  HfOptions options;
  options.method = static_cast<HfMethod>(choice_of("hf_method", {"active_set", "uzawa", "vi"}));
  options.uzawa_tolerance = number_of("uzawa_tolerance", 1e-15, 0.1);
  options.uzawa_max_iterations = integer_of("uzawa_max_iterations", 1, 100000000);
  options.uzawa_accelerated = flag_of("uzawa_accelerated");
  options.uzawa_step = number_of("uzawa_step", 0, 1e300);
  options.nitsche.single_loop = choice_of("nitsche_loop", {"nested", "single"}) == 1;
  options.nitsche.nonpenetration = choice_of("nitsche_bounds", {"none", "nonpenetration"}) == 1;
  return options;
}

/// Throws bad_input where vi is asked for and constraints are not bounds at single nodes.
void check_vi(const ToolOptions &options) {
  if (options.hf.method != HfMethod::vi) return;
  const Scene &scene = options.scene;
  if (scene.pair)
    throw bad_input("-hf_method vi needs a bound at each node, and contact of two bodies bounds "
                    "integrals over several: use active_set or uzawa");
  if (scene.support && (scene.support->friction.law != FrictionLaw::none || !scene.lumped))
    throw bad_input("-hf_method vi on a rigid support needs a bound at each node and no friction: "
                    "set -friction none and -lumped yes, or use active_set");
  if (!scene.lumped)
    throw bad_input("-hf_method vi needs a bound at each node: set -lumped yes, or use "
                    "active_set");
}

/// Throws bad_input for a mesh file beside an option of the built-in mesh.
void check_mesh_options(const std::string &scene) {
  if (text_of("mesh").empty()) return;
  for (const SceneEntry &entry : scene_catalogue())
    for (const SceneOption &option : entry.options)
      if (entry.name == scene && option.built_in_mesh && is_given(option.name))
        throw bad_input("-" + option.name +
                        " is of the built-in mesh and has no effect on that of -mesh: leave out "
                        "one of the two");
}

/// Throws bad_input for tolerances of B^n and of B^tau where they are not apart.
void check_rows_apart(const Scene &scene, const ReduceOptions &reduce) {
  if (!reduce.eim_normal && !reduce.eim_tangential) return;
  if (!scene.support || scene.nitsche ||
      reduce.multipliers.reduction != MultiplierReduction::collocated)
    throw bad_input("-eim_normal_tolerance and -eim_tangential_tolerance are for contact with a "
                    "rigid support and -multiplier_reduction collocated: use -eim_tolerance");
  if (reduce.eim_tangential && scene.support->friction.law == FrictionLaw::none)
    throw bad_input("-eim_tangential_tolerance is for contact with friction, which this scene has "
                    "not");
}

} // namespace

bool is_option(const std::string &word) {
  return word.size() > 1 && word[0] == '-' &&
         std::isalpha(static_cast<unsigned char>(word[1])) != 0;
}

std::filesystem::path case_of_run(const std::filesystem::path &out) {
  return out / "case.yaml";
}

std::vector<std::string> normalised_arguments(int argc, char **argv) {
  std::vector<std::string> arguments(argv, argv + argc);
  for (std::string &argument : arguments)
    if (argument.starts_with("--") && is_option(argument.substr(1))) argument.erase(0, 1);
  return arguments;
}

ToolOptions read_options(MPI_Comm comm) {
  const std::vector<std::string> command_line = unread_names();
  const Origin origin = insert_case_file(comm, command_line);
  std::vector<std::string> names = command_line;
  for (const auto &[name, where] : origin)
    names.push_back(name);
  ToolOptions options;
  options.command_line = command_line;
  const std::string scene = text_of("scene");
  if (scene.empty())
    throw bad_input("no scene is named: the case file needs 'scene: NAME' (rbvi list)");
  options.scene = make_scene(scene, scene_options_of(scene));
  check_names(names, origin, options.scene);
  options.case_file = as_case_file(names);
  adapt_parameters(options.scene.parameters);
  check_box(options.scene);
  check_mesh_options(scene);
  options.mesh.file = text_of("mesh");
  options.mesh.refine = integer_of("mesh_refine", 0, 6);
  options.train = text_of("train", options.scene.training);
  options.valid = text_of("valid", options.scene.validation);
  for (const std::string name : {"train", "valid", "nitsche_eim_validation"})
    if (const std::string set = text_of(name); is_set_file(set)) options.set_files[name] = set;
  options.hf = hf_options();
  if (options.scene.nitsche && contains(names, "hf_method"))
    throw bad_input("-hf_method is for the mixed formulation: Nitsche's method has "
                    "-nitsche_snes_type");
  check_vi(options);
  options.reduce = reduce_options(options.scene.parameters);
  const bool multipliers = options.scene.support && !options.scene.nitsche;
  if (!multipliers && contains(names, "multiplier_reduction"))
    throw bad_input("-multiplier_reduction is for contact with a rigid support by multipliers, "
                    "which this scene has not");
  check_rows_apart(options.scene, options.reduce);
  if (!options.scene.nitsche && contains(names, "nitsche_quadrature"))
    throw bad_input("-nitsche_quadrature is for Nitsche's method: set -formulation nitsche");
  if (options.scene.support && !contains(names, "cone_type"))
    options.reduce.cone.type = ConeType::mcpg; // a cone of snapshots; hybrid is for one body
  options.ranks_per_solve = integer_of("sweep_ranks_per_solve", 1, 1000000);
  options.max_failures = number_of("sweep_max_failures", 0, 1);
  options.case_name = text_of("case");
  options.out = text_of("out");
  options.mu = text_of("mu");
  options.vtu = text_of("vtu");
  options.csv = text_of("csv");
  options.plan = flag_of("plan");
  options.stability = flag_of("verify_stability");
  return options;
}

} // namespace rbvi
