#include "rbvi/tool/options.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/tool/run_directory.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

namespace rbvi {

namespace {

/// Options of PETSc itself that it reads only at its end.
const std::vector<std::string> late_options{"options_left", "options_view"};

bool starts_with_any(const std::string &name, const std::vector<std::string> &prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(),
                     [&](const std::string &prefix) { return name.rfind(prefix, 0) == 0; });
}

/// The names (without dash) of all options in a database of PETSc (nullptr: the global one).
std::vector<std::string> given_names(PetscOptions database = nullptr) {
  char *all = nullptr;
  RBVI_CALL(PetscOptionsGetAll(database, &all));
  std::istringstream words(all);
  RBVI_CALL(PetscFree(all));
  std::vector<std::string> names;
  for (std::string word; words >> word;)
    if (is_option(word)) names.push_back(word.substr(1));
  return names;
}

bool contains(const std::vector<std::string> &list, const std::string &name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

std::string text_of(const std::string &name, const std::string &otherwise = "",
                    PetscOptions database = nullptr) {
  char value[4096];
  PetscBool set = PETSC_FALSE;
  RBVI_CALL(
      PetscOptionsGetString(database, nullptr, ("-" + name).c_str(), value, sizeof value, &set));
  return set == PETSC_TRUE ? value : otherwise;
}

const std::string &default_of(const std::string &name) {
  const auto &options = tool_options();
  return std::find_if(options.begin(), options.end(),
                      [&](const OptionHelp &o) { return o.name == name; })
      ->default_value;
}

/// A number in [lower, upper].
double number_of(const std::string &name, double lower, double upper) {
  const std::string text = text_of(name, default_of(name));
  const double value = parse_number(text, "option -" + name);
  if (value < lower || value > upper) {
    std::ostringstream message;
    message << "option -" << name << " is " << text << ": use a number from " << lower << " to "
            << upper;
    throw bad_input(message.str());
  }
  return value;
}

bool flag_of(const std::string &name) {
  PetscBool value = PETSC_FALSE;
  const std::string text = text_of(name, default_of(name));
  if (text.empty()) return true;
  if (PetscOptionsStringToBool(text.c_str(), &value) != 0)
    throw bad_input("option -" + name + " is '" + text + "': use yes or no");
  return value == PETSC_TRUE;
}

int integer_of(const std::string &name, int lower, int upper) {
  const double value = number_of(name, lower, upper);
  if (value != std::floor(value)) throw bad_input("option -" + name + " must be an integer");
  return static_cast<int>(value);
}

/// Position of the value among the choices.
int choice_of(const std::string &name, const std::vector<std::string> &choices) {
  const std::string text = text_of(name, default_of(name));
  const auto found = std::find(choices.begin(), choices.end(), text);
  if (found == choices.end()) {
    std::string all;
    for (const std::string &choice : choices)
      all += (all.empty() ? "" : ", ") + choice;
    throw bad_input("option -" + name + " is '" + text + "': use one of " + all);
  }
  return static_cast<int>(found - choices.begin());
}

struct DestroyOptions {
  void operator()(PetscOptions options) const { (void)PetscOptionsDestroy(&options); }
};

/// -case, or the options that a run directory was made with.
std::string case_file_name() {
  std::string file = text_of("case");
  const std::string out = text_of("out");
  if (file.empty() && !out.empty() && std::filesystem::exists(case_of_run(out)))
    file = case_of_run(out);
  if (file.empty()) throw bad_input("no case is named: use -case cases/<scene>/case.yaml");
  if (std::filesystem::is_directory(file))
    throw bad_input("the case file " + file + " is a directory");
  if (!std::ifstream(file)) throw bad_input("the case file " + file + " cannot be read");
  return file;
}

void insert_case_file(MPI_Comm comm) {
  const std::string file = case_file_name();
  PetscOptions raw = nullptr;
  RBVI_CALL(PetscOptionsCreate(&raw));
  const std::unique_ptr<std::remove_pointer_t<PetscOptions>, DestroyOptions> database(raw);
  if (PetscOptionsInsertFileYAML(comm, raw, file.c_str(), PETSC_TRUE) != 0)
    throw bad_input("the case file " + file +
                    " is malformed: one 'option: value' per line is expected");
  const std::vector<std::string> command_line = given_names();
  for (const std::string &name : given_names(raw))
    if (!contains(command_line, name))
      RBVI_CALL(PetscOptionsSetValue(nullptr, ("-" + name).c_str(),
                                     beside_case(name, text_of(name, "", raw), file).c_str()));
}

SceneOptions scene_options_of(const std::string &scene) {
  SceneOptions options;
  for (const SceneEntry &entry : scene_catalogue()) {
    if (entry.name != scene) continue;
    for (const SceneOption &option : entry.options) {
      PetscBool set = PETSC_FALSE;
      RBVI_CALL(PetscOptionsHasName(nullptr, nullptr, ("-" + option.name).c_str(), &set));
      if (set == PETSC_TRUE) options[option.name] = text_of(option.name);
    }
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
    return Given::value;
  }
  if (parts.size() != 2)
    throw bad_input(what + " is '" + text + "': give one value, or two bounds");
  parameter.lower = parse_number(parts[0], what);
  parameter.upper = parse_number(parts[1], what);
  if (!(parameter.lower < parameter.upper))
    throw bad_input(what + " is '" + text + "': the lower bound comes first");
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

/// PETSc has read its own options when it started.
bool known_to_petsc(const std::string &name) {
  PetscBool used = PETSC_FALSE;
  RBVI_CALL(PetscOptionsUsed(nullptr, name.c_str(), &used));
  return used == PETSC_TRUE || contains(late_options, name);
}

/// All that PETSc does not know as its own. To be called before anything asks for an option.
std::vector<std::string> own_names() {
  std::vector<std::string> names = given_names();
  std::erase_if(names, known_to_petsc);
  return names;
}

/// The options as a case file, without those of one command.
std::string as_case_file(const std::vector<std::string> &names) {
  const std::vector<std::string> of_command{"case", "out", "plan", "mu", "vtu", "csv"};
  std::string text = "# The options of this run.\n";
  for (const std::string &name : names) {
    if (contains(of_command, name)) continue;
    const std::string value = text_of(name), option = "-" + name;
    text += name + ": " + value_in_run(name, value) + "\n";
    // Asking has marked the option as used, which check_solver_options must not see.
    RBVI_CALL(PetscOptionsClearValue(nullptr, option.c_str()));
    RBVI_CALL(PetscOptionsSetValue(nullptr, option.c_str(), value.c_str()));
  }
  return text;
}

/// Throws bad_input unless each name is one of ours or of the scene.
void check_names(const std::vector<std::string> &names, const Scene &scene) {
  std::vector<std::string> known;
  for (const OptionHelp &option : tool_options())
    known.push_back(option.name);
  for (const auto &[name, value] : scene.options)
    known.push_back(name);
  for (const Parameter &parameter : scene.parameters.all)
    known.push_back(parameter.name);
  for (const std::string &name : names)
    if (!contains(known, name) && !starts_with_any(name, solver_prefixes()))
      throw bad_input("unknown option -" + name + "; the nearest one is -" +
                      nearest_name(name, known) + " (-help lists all)");
}

ReduceOptions reduce_options(const ParameterSpace &space) {
  ReduceOptions options;
  options.pod.tolerance = number_of("pod_tolerance", 0, 1);
  options.pod.max_size = integer_of("pod_max_size", 0, 100000);
  options.cone.type = static_cast<ConeType>(choice_of("cone_type", cone_type_names()));
  options.cone.tolerance = number_of("cone_tolerance", 0, 1);
  options.cone.max_size = integer_of("cone_max_size", 0, 100000);
  options.cone.feasibility = number_of("cone_feasibility", 0, 1);
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
  options.pga.tolerance = number_of("pga_tolerance", 0, 1);
  options.pga.stability = number_of("pga_beta_fraction", 0, 1 - 1e-12);
  options.pga.max_size = integer_of("pga_max_size", 0, 100000);
  options.eim.tolerance = number_of("eim_tolerance", 0, 1);
  options.eim.max_size = integer_of("eim_max_size", 0, 100000);
  options.condensed.tolerance = number_of("condensed_tolerance", 0, 1);
  options.condensed.responses = number_of("response_tolerance", 0, 1);
  options.multipliers.reduction = static_cast<MultiplierReduction>(
      choice_of("multiplier_reduction", multiplier_reduction_names()));
  options.multipliers.tangential = number_of("tangential_tolerance", 0, 1);
  options.multipliers.extra_nodes = integer_of("joint_extra_nodes", 0, 100000);
  options.multipliers.exact = flag_of("multiplier_exact");
  options.curve.rule = static_cast<CurveRule>(choice_of("nitsche_quadrature", curve_rule_names()));
  options.curve.tolerance = number_of("nitsche_quadrature_tolerance", 0, 1);
  options.curve.eim_tolerance = number_of("nitsche_eim_tolerance", 0, 1);
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
  options.uzawa_tolerance = number_of("uzawa_tolerance", 1e-15, 1);
  options.uzawa_max_iterations = integer_of("uzawa_max_iterations", 1, 100000000);
  options.uzawa_accelerated = flag_of("uzawa_accelerated");
  options.uzawa_step = number_of("uzawa_step", 0, 1e300);
  options.nitsche.single_loop = choice_of("nitsche_loop", {"nested", "single"}) == 1;
  options.nitsche.nonpenetration = choice_of("nitsche_bounds", {"none", "nonpenetration"}) == 1;
  return options;
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
  insert_case_file(comm);
  const std::vector<std::string> names = own_names();
  ToolOptions options;
  const std::string scene = text_of("scene");
  if (scene.empty())
    throw bad_input("no scene is named: the case file needs 'scene: NAME' (rbvi list)");
  options.scene = make_scene(scene, scene_options_of(scene));
  check_names(names, options.scene);
  options.case_file = as_case_file(names);
  adapt_parameters(options.scene.parameters);
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
  if (options.hf.method == HfMethod::vi && !options.scene.lumped)
    throw bad_input(options.scene.pair || options.scene.support
                        ? "-hf_method vi needs a bound at each node, and contact of two bodies or "
                          "with a rigid support bounds integrals over several: use active_set or "
                          "uzawa"
                        : "-hf_method vi needs a bound at each node: set -lumped yes, or use "
                          "active_set");
  options.reduce = reduce_options(options.scene.parameters);
  const bool multipliers = options.scene.support && !options.scene.nitsche;
  if (!multipliers && contains(names, "multiplier_reduction"))
    throw bad_input("-multiplier_reduction is for contact with a rigid support by multipliers, "
                    "which this scene has not");
  if (!options.scene.nitsche && contains(names, "nitsche_quadrature"))
    throw bad_input("-nitsche_quadrature is for Nitsche's method: set -formulation nitsche");
  if (options.scene.support && !contains(names, "cone_type"))
    options.reduce.cone.type = ConeType::mcpg; // a cone of snapshots; hybrid is for one body
  options.ranks_per_solve = integer_of("sweep_ranks_per_solve", 1, 1000000);
  options.max_failures = number_of("sweep_max_failures", 0, 1);
  options.out = text_of("out");
  options.mu = text_of("mu");
  options.vtu = text_of("vtu");
  options.csv = text_of("csv");
  options.plan = flag_of("plan");
  options.stability = flag_of("verify_stability");
  return options;
}

} // namespace rbvi
