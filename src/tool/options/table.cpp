#include "table.hpp"

#include "kinds.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/solve/methods.hpp"
#include "rbvi/tool/options/run_directory.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// The place of a value among the options.
#define AT(member)                                                                                 \
  [](auto &options) -> auto & {                                                                    \
    return options.member;                                                                         \
  }

/// Largest relative error that a reduced model may be asked for: above, it says nothing.
constexpr double rough = 0.5;

const Range relative_error{0, rough}, size{0, 100000}, positive{0, 1e300}, refinements{0, 6};

bool always(const ToolOptions & /*options*/) {
  return true;
}

bool mixed(const ToolOptions &options) {
  return has_multipliers(options.scene);
}

bool not_mixed(const ToolOptions &options) {
  return !mixed(options);
}

bool with_law(const ToolOptions &options) {
  return mixed(options) && keeps_law(options.reduce.multipliers.reduction);
}

bool with_reduced_law(const ToolOptions &options) {
  return with_law(options) &&
         options.reduce.multipliers.reduction != MultiplierReduction::condensed;
}

bool with_dual_basis(const ToolOptions &options) {
  return mixed(options) && (!with_law(options) || with_reduced_law(options));
}

/// Models keep the value where `when` says so.
Option kept(bool (*when)(const ToolOptions &), Option option, const std::string &as = "") {
  option.kept = when;
  option.kept_as = as.empty() ? option.name : as;
  return option;
}

/// An option of one command, not of the run.
Option of_command(Option option) {
  option.of_command = true;
  return option;
}

/// What stands in place of a value that is not given.
Option otherwise(const std::string &value, Option option) {
  option.default_value = value;
  return option;
}

Option mesh_file() {
  Option option = text("mesh", OptionKind::file, "file", AT(mesh.file),
                       "Gmsh file: MSH 2.2, 4.0 or 4.1, text or binary, order 1, with the physical "
                       "names and the shape that -help -scene NAME lists");
  option.shown = [](const ToolOptions &options) { return value_in_run("mesh", options.mesh.file); };
  return otherwise("built in", option);
}

Option pga_tolerance() {
  Option option = number("pga_tolerance", {0, 0.999}, AT(reduce.pga.tolerance),
                         "on the largest sigma (2.27); infsup: the smallest beta_HF / c_HF over "
                         "the training set, sure to meet (2.23); 0: by -pga_beta_fraction");
  option.values += ", infsup";
  option.read = [read_number = option.read](const std::string &value, ToolOptions &options) {
    options.reduce.infsup_tolerance = value == "infsup";
    if (!options.reduce.infsup_tolerance)
      while_doing("reading -pga_tolerance, a number or infsup",
                  [&] { read_number(value, options); });
  };
  option.shown = [show_number = option.shown](const ToolOptions &options) {
    return options.reduce.infsup_tolerance ? "infsup" : show_number(options);
  };
  return option;
}

Option reference_mu() {
  Option option{"reference_mu", OptionKind::text, "mu of that energy, and of the hybrid basis",
                "parameter", "centre of the box"};
  option.read = [](const std::string &value, ToolOptions &options) {
    options.reduce.reference = while_doing(
        "reading option -reference_mu", [&] { return parse_mu(options.scene.parameters, value); });
  };
  return option;
}

Option nitsche_eim_validation() {
  Option option{"nitsche_eim_validation", OptionKind::set,
                "interpolated: further mu, as -train, whose steps measure that error, too", "set"};
  option.read = [](const std::string &value, ToolOptions &options) {
    options.reduce.curve.eim_validation =
        while_doing("reading option -nitsche_eim_validation",
                    [&] { return parse_set(options.scene.parameters, value); });
  };
  return option;
}

std::vector<Option> of_runs() {
  return {
      of_command(text("case", OptionKind::text, "file", AT(case_name),
                      "case file (YAML, one 'option: value' per line); the command line beats it. "
                      "Without it: that of -out")),
      {"scene", OptionKind::text,
       "name of the scene (rbvi list); with its defaults no case file is needed", "name"},
      of_command(text("out", OptionKind::text, "directory", AT(out), "run directory")),
      {"parameters", OptionKind::text, "names of the free parameters; the others keep their value",
       "names", "the scene's"},
      kept(always,
           otherwise("the scene's",
                     text("train", OptionKind::set, "set", AT(train),
                          "training set: grid:5,5,5 | random:COUNT:SEED | COUNT (seed 1) | "
                          "file.csv with a header of names")),
           "training"),
      otherwise("the scene's", text("valid", OptionKind::set, "set", AT(valid),
                                    "validation set, as -train; verify measures at the corners and "
                                    "faces of the box, too")),
      of_command(text("mu", OptionKind::text, "parameter", AT(mu),
                      "parameter of one solve: 0.18,0.02,-0.01 or radius=0.18,center_x=0.02")),
      of_command(text("vtu", OptionKind::text, "file", AT(vtu), "file for the field of one solve")),
      of_command(text("csv", OptionKind::text, "file", AT(csv), "file for the table of outputs")),
      flag("verify_stability", AT(stability),
           "verify: inf-sup constants and bounds too, not errors alone"),
      of_command(rising("bench_growth", refinements, AT(growth),
                        "bench: in place of run time against error what offline takes, stage by "
                        "stage, on the meshes of these -mesh_refine, by every number of ranks per "
                        "solve that divides the ranks, or by that of the command line")),
      of_command(flag("plan", AT(plan), "print which stages will run, and stop"))};
}

std::vector<Option> of_meshes() {
  return {kept(always, mesh_file(), "mesh_file"),
          kept(always, number("mesh_refine", refinements, AT(mesh.refine), "uniform refinements"))};
}

std::vector<Option> of_solvers() {
  return {
      choice("hf_method",
             choices(hf_method_names(),
                     {"semismooth Newton on the condensed problem B A^-1 B^T, asked for column "
                      "by column",
                      "projected gradient steps of the multiplier: the baseline",
                      "SNES with its VI extension; with -lumped yes and without friction, as it "
                      "bounds single nodes"}),
             AT(hf.method), "high-fidelity solver"),
      choice("hf_contact",
             choices(hf_contact_names(),
                     {"what an estimate from the sizes says takes less (-plan prints it)",
                      "on the multipliers: columns of B A^-1 B^T, kept where A does not change",
                      "on the displacement, each active constraint eliminating a dof; from "
                      "coarser meshes where -mesh_refine gives them"}),
             AT(hf.contact), "how active_set solves the linear systems of its sets"),
      number("contact_gather", {0, 1000000000}, AT(contact_gather),
             "multipliers of an interface up to which each rank evaluates all of it; of larger "
             "ones (not pairs) each evaluates its part"),
      number("uzawa_tolerance", {1e-15, 0.1}, AT(hf.uzawa_tolerance),
             "relative change of the multiplier"),
      number("uzawa_max_iterations", {1, 100000000}, AT(hf.uzawa_max_iterations),
             "most iterations"),
      flag("uzawa_accelerated", AT(hf.uzawa_accelerated), "Nesterov's extrapolation with restart"),
      number("uzawa_step", positive, AT(hf.uzawa_step),
             "step rho; 0: 1 / largest eigenvalue of B A^-1 B^T")};
}

std::vector<Option> of_iterations() {
  return {
      choice(
          "nonlinear_method",
          choices(
              nonlinear_method_names(),
              {"nodal where the surface is rigid with its own normal; else, and where that fails, "
               "newton without friction, kacanov with it",
               "each linearised problem at the solution of the last (A.7)",
               "with the curvature of the condition: quadratic; without friction",
               "kacanov accelerated with three earlier states (Anderson)",
               "exact residuals, a tangent from averages at the nodes: Newton's "
               "without friction, else Kacanov's, accelerated"}),
          AT(hf.nonlinear.method), "iteration of contact that follows the displacement"),
      number("nonlinear_tolerance", {1e-13, 0.1}, AT(hf.nonlinear.tolerance),
             "relative change of u and of the multipliers (A.8)"),
      number("nonlinear_max_steps", {1, 100000}, AT(hf.nonlinear.max_steps), "most steps"),
      number("nonlinear_load_steps", {0, 1000}, AT(hf.nonlinear.load_steps),
             "load steps where the first attempt fails; 0: that is an error")};
}

Option ranks_per_solve() {
  Option option = number("sweep_ranks_per_solve", {1, 1000000}, AT(ranks_per_solve),
                         "ranks that share one solve; divides the ranks; auto: by the sizes of set "
                         "and mesh and the memory of the nodes (-plan prints it)");
  option.values += ", auto";
  option.read = [read_number = option.read](const std::string &value, ToolOptions &options) {
    if (value == "auto")
      options.ranks_per_solve = 0;
    else
      while_doing("reading -sweep_ranks_per_solve, a number or auto",
                  [&] { read_number(value, options); });
  };
  option.shown = [](const ToolOptions &options) {
    return options.ranks_per_solve == 0 ? "auto" : std::to_string(options.ranks_per_solve);
  };
  return otherwise("auto", option);
}

std::vector<Option> of_sweeps() {
  return {ranks_per_solve(),
          number("sweep_max_failures", {0, 1}, AT(max_failures),
                 "share of a set that may fail: where more does, no model is made, nothing "
                 "measured")};
}

std::vector<Option> of_bases() {
  const std::vector<std::string> cones{
      "greedy choice of snapshots, cone-projected (B.2)",
      "the same, modified (Algorithm 2); the default of -multiplier_reduction but cone",
      "the snapshot farthest in angle from the span of those taken (Haasdonk, Salomon, Wohlmuth "
      "2012)",
      "non-negative factorisation of the snapshots (Lee, Seung 2000), by HALS",
      "hat functions of all nodes that were ever in contact",
      "hat functions where contact changes, continued to the nodes that never leave contact, and a "
      "few modes of either sign there: see the study in membrane_obstacle/README.md"};
  return {
      kept(always, number("pod_tolerance", relative_error, AT(reduce.pod.tolerance),
                          "relative error of the displacement modes (2.11)")),
      number("pod_max_size", size, AT(reduce.pod.max_size), "most modes; 0: no bound"),
      kept(with_dual_basis,
           choice("cone_type", choices(cone_type_names(), cones), AT(reduce.cone.type),
                  "dual basis, what multipliers are combined from")),
      kept(with_dual_basis, number("cone_tolerance", relative_error, AT(reduce.cone.tolerance),
                                   "relative error of the dual basis (2.34); not used by nodal")),
      number("cone_max_size", size, AT(reduce.cone.max_size), "most generators; 0: no bound"),
      kept(with_dual_basis, number("cone_feasibility", relative_error, AT(reduce.cone.feasibility),
                                   "mcpg: tolerated negative part, as a fraction of the maximum")),
      kept(with_dual_basis, number("cone_ring", {0, 1000}, AT(reduce.cone.ring),
                                   "nodal, hybrid: layers of nodes around moving contact; hybrid: "
                                   "1 or more where training has no corners, doubled as needed")),
      kept(mixed, number("cone_level", refinements, AT(reduce.cone.level),
                         "hybrid, and laws at nodes: hat functions of the mesh with so many "
                         "refinements less"))};
}

std::vector<Option> of_stability() {
  return {
      kept(with_dual_basis,
           choice("pga_enrichment",
                  choices(enrichment_names(),
                          {"none: modes alone", "those of each mu, made for each query (2.17)",
                           "for all mu at once, by the projected greedy algorithm (2.30)"}),
                  AT(reduce.enrichment), "supremizers")),
      kept(with_dual_basis, choice("pga_product",
                                   choices(product_names(), {"that of V: constants and bounds are "
                                                             "those of the theory",
                                                             "the energy of A at -reference_mu"}),
                                   AT(reduce.product), "product in which they are taken")),
      reference_mu(),
      kept(with_dual_basis, pga_tolerance()),
      kept(with_dual_basis, number("pga_beta_fraction", {0, 1 - 1e-12}, AT(reduce.pga.stability),
                                   "stop when beta_off >= this fraction of beta_on is sure")),
      number("pga_max_size", size, AT(reduce.pga.max_size), "most supremizers; 0: no bound")};
}

std::vector<Option> of_separation() {
  return {
      kept(always, number("eim_tolerance", relative_error, AT(reduce.eim.tolerance),
                          "relative error of the separated operators (B.32)")),
      number("eim_max_size", size, AT(reduce.eim.max_size), "most terms; 0: no bound"),
      otherwise("-eim_tolerance",
                kept(with_reduced_law,
                     number("eim_normal_tolerance", relative_error, AT(reduce.eim_normal),
                            "collocated: that of B^n, the rows of lambda_n (3.61a)"))),
      otherwise("-eim_tolerance",
                kept(with_reduced_law,
                     number("eim_tangential_tolerance", relative_error, AT(reduce.eim_tangential),
                            "collocated: that of B^tau, the rows of lambda_tau (3.61b)")))};
}

std::vector<Option> of_multipliers() {
  const std::vector<std::string> reductions{
      "condensed on rigid supports and between two bodies, else cone",
      "a cone (-cone_type), stable by supremizers; without friction",
      "not at all: the law is exact at every node (or mirrored pair), and the body between them "
      "is its condensed operator B A^-1 B^T, interpolated in A; the best by orders of magnitude",
      "a cone (-cone_type mcpg) for lambda_n, modes for lambda_tau, supremizers, the bound of "
      "friction at nodes chosen greedily (Algorithm 3), B^n and B^tau interpolated apart unless B "
      "is a multiple of one form: the published method; without friction the cone and B^n alone",
      "cones for lambda_n and what is left to the bound: Coulomb's bound holds at every node",
      "modes of both multipliers, by least squares on the law at nodes chosen by pivoted QR"};
  return {
      kept(with_law, number("condensed_tolerance", relative_error, AT(reduce.condensed.tolerance),
                            "relative error of the condensed operator as a function of mu")),
      kept(with_law, number("condensed_ring", positive, AT(reduce.condensed.ring),
                            "condensed: how far beyond contact multipliers are, over its extent")),
      number("response_tolerance", relative_error, AT(reduce.condensed.responses),
             "responses A^-1 B^T join the modes, those of further A to this remainder; 0: none"),
      number("response_compression", relative_error, AT(reduce.condensed.compression),
             "A constant, responses of over 160 MB: those to answers of the law, to this; 0: all"),
      kept(with_law,
           choice("multiplier_reduction", choices(multiplier_reduction_names(), reductions),
                  AT(reduce.multipliers.reduction), "how the multipliers are reduced")),
      flag("multiplier_exact", AT(reduce.multipliers.exact),
           "collocated, cones, joint: exact steps mend answers that break the law at some node"),
      kept(with_reduced_law,
           number("tangential_tolerance", relative_error, AT(reduce.multipliers.tangential),
                  "relative error of the modes of lambda_tau (collocated) or of both (joint)")),
      number("joint_extra_nodes", size, AT(reduce.multipliers.extra_nodes),
             "joint: collocation nodes beyond the number of modes"),
      number("gcns_tolerance", positive, AT(reduce.gcns.tolerance),
             "collocated: e_GCNS at which nodes are enough; 0: goes on to all, keeps the best"),
      number("gcns_max_nodes", size, AT(reduce.gcns.max_nodes),
             "collocated: most collocation nodes; 0: no bound")};
}

std::vector<Option> of_nitsche() {
  return {
      choice("nitsche_loop",
             {{"nested", "frozen in an outer loop (4.63)"},
              {"single", "following every Newton step (4.53)"}},
             AT(hf.nitsche.single_loop), "how Newton's method takes Coulomb's bound"),
      choice("nitsche_bounds",
             {{"none", "Newton's method"},
              {"nonpenetration", "SNES keeps the nodes' normal displacements below the gap"}},
             AT(hf.nitsche.nonpenetration), "bounds on the displacement"),
      kept(not_mixed,
           choice("nitsche_quadrature",
                  choices(curve_rule_names(),
                          {"at few Gauss points of the curve, with non-negative weights found by "
                           "least squares (NNLS): the reduced problem stays the minimum of an "
                           "energy",
                           "at all of them",
                           "empirical interpolation of the tangent and of the residual over (mu, "
                           "Newton step) (4.71)-(4.80): the published method"}),
                  AT(reduce.curve.rule),
                  "how a reduced model integrates contact and friction over the curve")),
      number("nitsche_quadrature_tolerance", relative_error, AT(reduce.curve.tolerance),
             "empirical: relative error that it may add to u at a training parameter; 0: as much "
             "as the modes leave"),
      number("nitsche_eim_tolerance", relative_error, AT(reduce.curve.eim_tolerance),
             "interpolated: relative error over (mu, Newton step) (B.32)"),
      nitsche_eim_validation()};
}

#undef AT

void add(const char *group, std::vector<Option> options, std::vector<Option> &all) {
  for (Option &option : options) {
    option.group = group;
    all.push_back(std::move(option));
  }
}

} // namespace

const std::vector<Option> &tool_options() {
  static const std::vector<Option> options = [] {
    std::vector<Option> all;
    add("Run", of_runs(), all);
    add("Mesh", of_meshes(), all);
    add("High-fidelity solver", of_solvers(), all);
    add("Large deformations", of_iterations(), all);
    add("Sweep", of_sweeps(), all);
    add("Bases", of_bases(), all);
    add("Stability", of_stability(), all);
    add("Separation", of_separation(), all);
    add("Multipliers", of_multipliers(), all);
    add("Nitsche's method", of_nitsche(), all);
    return all;
  }();
  return options;
}

const Option *find_option(const std::string &name) {
  const auto found = std::find_if(tool_options().begin(), tool_options().end(),
                                  [&](const Option &option) { return option.name == name; });
  return found == tool_options().end() ? nullptr : &*found;
}

std::map<std::string, std::string> kept_settings(const ToolOptions &options) {
  std::map<std::string, std::string> settings;
  for (const Option &option : tool_options())
    if (option.kept != nullptr && option.kept(options))
      if (const std::string value = option.shown(options); !value.empty())
        settings[option.kept_as] = value;
  return settings;
}

} // namespace rbvi
