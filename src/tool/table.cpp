#include "table.hpp"

#include "kinds.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/mor/reduction.hpp"
#include "rbvi/solve/methods.hpp"
#include "run_directory.hpp"

#include <algorithm>

namespace rbvi {

const Use *unmet(const Use &use, const OfflineOptions &options) {
  if (use.within != nullptr)
    if (const Use *outer = unmet(*use.within, options)) return outer;
  return use.in(options) ? nullptr : &use;
}

namespace {

template <FrictionLaw law> bool has_law(const OfflineOptions &options) {
  return std::ranges::any_of(options.scene.contacts,
                             [](const ContactRecipe &c) { return c.friction == law; });
}

const ReductionWay &way_for(const OfflineOptions &options) {
  return way_of(options.scene, options.reduce.multipliers.reduction);
}

bool has_online_method(const OfflineOptions &options) {
  switch (options.reduce.online_method) {
  case OnlineMethod::exact:
    return true;
  case OnlineMethod::uzawa:
    return is_of(use::collocated, options);
  case OnlineMethod::kacanov:
    return is_of(use::following, options);
  case OnlineMethod::newton:
    return is_of(use::interpolated, options);
  }
  return false;
}

} // namespace

namespace use {

const Use friction{nullptr, [](const OfflineOptions &o) { return has_friction(o.scene); },
                   "contact with friction, which this scene has not: leave out -friction none"};
const Use tresca{nullptr, has_law<FrictionLaw::tresca>, "-friction tresca"};

const Use multipliers{nullptr, [](const OfflineOptions &o) { return has_multipliers(o.scene); },
                      "the mixed formulation: Nitsche's method has no multipliers"};
const Use active_set{&multipliers,
                     [](const OfflineOptions &o) { return o.hf.method == HfMethod::active_set; },
                     "-hf_method active_set"};
const Use uzawa{&multipliers,
                [](const OfflineOptions &o) { return o.hf.method == HfMethod::uzawa; },
                "-hf_method uzawa"};
const Use following{&multipliers, [](const OfflineOptions &o) { return follows_state(o.scene); },
                    "contact that follows the displacement: set -kinematics large"};

const Use dual_basis{&multipliers, [](const OfflineOptions &o) { return way_for(o).dual_basis; },
                     "-multiplier_reduction cone or collocated"};
const Use law{&multipliers, [](const OfflineOptions &o) { return way_for(o).law; },
              "-multiplier_reduction condensed or collocated"};
const Use hats{
    &multipliers,
    [](const OfflineOptions &o) { return is_of(law, o) || o.reduce.cone.type == ConeType::hybrid; },
    "hat functions, which this dual basis has none of: use -cone_type hybrid"};
const Use collocated{&multipliers,
                     [](const OfflineOptions &o) {
                       return o.reduce.multipliers.reduction == MultiplierReduction::collocated;
                     },
                     "-multiplier_reduction collocated"};
const Use rows_apart{&collocated,
                     [](const OfflineOptions &o) { return o.scene.contacts.size() == 1; },
                     "a single contact interface: use -eim_tolerance"};
const Use tangential_rows{&rows_apart, friction.in, friction.is_for};

const Use nitsche{nullptr, [](const OfflineOptions &o) { return !is_of(multipliers, o); },
                  "Nitsche's method: set -formulation nitsche"};
const Use coulomb_terms{&nitsche, has_law<FrictionLaw::coulomb>,
                        "Coulomb's friction: set -friction coulomb"};
const Use empirical{
    &nitsche, [](const OfflineOptions &o) { return o.reduce.curve.rule == CurveRule::empirical; },
    "-nitsche_quadrature empirical"};
const Use interpolated{
    &nitsche,
    [](const OfflineOptions &o) { return o.reduce.curve.rule == CurveRule::interpolated; },
    "-nitsche_quadrature interpolated"};

const Use online{nullptr, has_online_method,
                 "-multiplier_reduction collocated (uzawa), for contact with multipliers that "
                 "follows the displacement (kacanov), or for -nitsche_quadrature interpolated "
                 "(newton)"};
const Use certified{nullptr, [](const OfflineOptions &o) { return o.reduce.certify; }, "-certify"};
const Use not_exact{
    nullptr, [](const OfflineOptions &o) { return o.reduce.online_method != OnlineMethod::exact; },
    ""};

} // namespace use

namespace {

/// An option of one command, not of the run.
Option of_command(Option option) {
  option.of_command = true;
  return option;
}

Option mesh_file(Setup &o) {
  Option option = text("mesh", OptionKind::file, "file", o.mesh.file,
                       "Gmsh file (MSH 2.2, 4.0 or 4.1, text or binary, order 1) whose physical "
                       "names and shape are those that -help -case FILE lists");
  option.shown = [&o] { return value_in_run("mesh", o.mesh.file); };
  return otherwise("built in", option);
}

std::vector<Option> of_runs(ToolOptions &o) {
  return {
      of_command(
          text("case", OptionKind::text, "file", o.case_name,
               "case file, or one of options alone ('option: value' per line) that names it by "
               "'case: FILE'; without it that of -out is read")),
      {"variant", OptionKind::text, "variant of the case (rbvi -help -case FILE)", "name", "none"},
      {"set", OptionKind::text,
       "values at paths of the case file: mesh.edges=200,contact.support.lumped=yes", "list",
       "none"},
      {"scene", OptionKind::text,
       "name of a scene that a program of its own adds to rbvi, in place of -case", "name"},
      of_command(text(
          "out", OptionKind::text, "directory", o.out,
          "directory of the run: everything is written there; of rbvi run by default run/NAME")),
      {"parameters", OptionKind::text,
       "names of the parameters that vary, in the order of -mu; the others keep one value", "names",
       "the scene's"},
      kept(otherwise("the scene's",
                     text("train", OptionKind::set, "set", o.train,
                          "parameters of the training set: grid:5,5,5 | random:COUNT:SEED | COUNT "
                          "(seed 1) | corners (and centres of faces of the box) | file.csv with a "
                          "header of names; several with ' + ' between them; 'grid:61 in "
                          "radius=0.7,1.15', and random likewise, in a part of the box")),
           "training"),
      otherwise("the scene's", text("valid", OptionKind::set, "set", o.valid,
                                    "parameters of the validation set, given as -train is; verify "
                                    "measures at the corners and faces of the box, too")),
      of_command(
          text("mu", OptionKind::text, "parameter", o.mu,
               "parameter at which solve solves: 0.18,0.02,-0.01 or radius=0.18,center_x=0.02")),
      of_command(text(
          "vtu", OptionKind::text, "file", o.vtu,
          "file to which solve, and check, write displacement and stresses; contact goes to "
          "FILE_contact, of several contacts each to FILE_contact_NAME, what check draws of the "
          "case to FILE_mesh, FILE_surface and FILE_partners")),
      of_command(text("csv", OptionKind::text, "file", o.csv,
                      "file to which solve writes its outputs as a table")),
      of_command(text("only", OptionKind::text, "names", o.only,
                      "verify: these outputs alone, as rbvi-online --only: errors and time are of "
                      "queries that compute no others")),
      flag("verify_stability", o.stability,
           "verify: measure inf-sup constants and their bounds besides errors"),
      kept(
          use::not_exact,
          only(use::online,
               choice("online_method",
                      choices(
                          online_method_names(),
                          {"to round-off, by the fastest iteration that there is",
                           "-multiplier_reduction collocated: Uzawa's method on the reduced pair, "
                           "(3.40) or (3.55) until (3.19)",
                           "contact that follows the displacement: each step solves the problem "
                           "linearised at the state before (A.7), not accelerated",
                           "-nitsche_quadrature interpolated: Newton's method (4.79) as published, "
                           "from u_0 = 0 and without a rescue"}),
                      o.reduce.online_method,
                      "how the model answers, in verify and bench, and later in rbvi-online"))),
      of_command(
          rising("bench_growth", refinements, o.growth,
                 "bench: measure what offline costs, stage by stage, on the meshes with these "
                 "-mesh_refine, with every number of ranks per solve that divides the ranks or "
                 "with that of the command line; run time against error is then not measured")),
      of_command(rising(
          "convergence", refinements, o.convergence,
          "bench: outputs of full solves on the meshes with these -mesh_refine, at the tests "
          "of the case, without any at the defaults of its parameters; observed orders, "
          "Richardson's values, and how far these are from what the tests expect")),
      of_command(flag("plan", o.plan,
                      "print which stages would run, with the memory and time "
                      "that are foreseen, and stop")),
      of_command(flag("run", o.run_tests,
                      "check: solve at the tests of the case, and compare what they expect"))};
}

std::vector<Option> of_meshes(Setup &o) {
  return {kept(mesh_file(o), "mesh_file"), kept(number("mesh_refine", refinements, o.mesh.refine,
                                                       "how many times all edges are halved"))};
}

std::vector<Option> solver_rows(Setup &o) {
  return {
      only(use::multipliers,
           choice("hf_method",
                  choices(hf_method_names(), {"a semismooth Newton method: guess which nodes "
                                              "touch, stick and slip, solve, and "
                                              "guess again",
                                              "gradient steps for the multipliers, negative "
                                              "pressures cut off: the slow baseline",
                                              "PETSc's solver of variational inequalities (SNES "
                                              "VI): it bounds single nodes, so "
                                              "it needs -lumped yes and no friction"}),
                  o.hf.method, "method that solves the full problem")),
      only(
          use::active_set,
          choice(
              "hf_contact",
              choices(
                  hf_contact_names(),
                  {"the one that takes less time by an estimate from the sizes, which -plan prints",
                   "for the multipliers, with columns of B A^-1 B^T, which are kept as long as A "
                   "does not change",
                   "for the displacement, of which each active constraint eliminates one dof; "
                   "starts on the coarser meshes that -mesh_refine has"}),
              o.hf.contact, "for which unknown active_set solves its linear systems")),
      number("contact_gather", {0, 1000000000}, o.contact_gather,
             "each rank evaluates a whole interface with up to this many multipliers, and its own "
             "part of a larger one (of two bodies always the whole)")};
}

std::vector<Option> of_uzawa(HfOptions &o) {
  return {
      number(
          "uzawa_tolerance", {1e-15, 0.1}, o.uzawa.tolerance,
          "uzawa stops at this relative change of the multipliers; a KKT residual above 1e-2, or "
          "10 times this, is an error then"),
      number("uzawa_max_iterations", {1, 100000000}, o.uzawa.max_iterations,
             "largest number of iterations of uzawa"),
      flag("uzawa_accelerated", o.uzawa.accelerated,
           "accelerate uzawa by Nesterov's extrapolation with restart"),
      number("uzawa_step", positive, o.uzawa.step,
             "step rho of uzawa; 0: 1 / largest eigenvalue of B A^-1 B^T")};
}

std::vector<Option> of_iterations(HfOptions &o) {
  return {
      choice(
          "nonlinear_method",
          choices(
              nonlinear_method_names(),
              {"nodal if the surface is rigid and has its own normal; if not, or if that fails, "
               "newton without friction and kacanov with it",
               "each step solves the problem linearised at the state before (A.7)",
               "adds the curvature of the condition and converges quadratically; without friction",
               "kacanov, accelerated by three earlier states (Anderson)",
               "takes exact residuals and a tangent from averages at the nodes: that of newton "
               "without friction, with it that of kacanov, accelerated"}),
          o.nonlinear.method, "iteration for contact that depends on the displacement"),
      number("nonlinear_tolerance", {1e-13, 0.1}, o.nonlinear.tolerance,
             "stop at this relative change of u and of the multipliers (A.8)"),
      number("nonlinear_max_steps", {1, 100000}, o.nonlinear.max_steps, "largest number of steps"),
      number("nonlinear_load_steps", {0, 1000}, o.nonlinear.load_steps,
             "number of load steps if the first attempt fails; 0: a failure is an error")};
}

Option ranks_per_solve(int &place) {
  Option option =
      number("sweep_ranks_per_solve", {1, 1000000}, place,
             "how many ranks share one solve, a divisor of all ranks; auto: chosen by the sizes of "
             "set and mesh and by the memory of the nodes, -plan prints it");
  option.values += ", auto";
  option.read = [&place, read_number = option.read](const std::string &value) {
    if (value == "auto")
      place = 0;
    else
      while_doing("reading -sweep_ranks_per_solve, a number or auto", [&] { read_number(value); });
  };
  option.shown = [&place] { return place == 0 ? "auto" : std::to_string(place); };
  return otherwise("auto", option);
}

std::vector<Option> of_sweeps(OfflineOptions &o) {
  return {
      kept(otherwise(
          "none", text("greedy", OptionKind::set, "set", o.greedy,
                       "parameters, given as -train is, of which those with the largest bound of "
                       "the error (-certify) are solved next, as many at a time as there are "
                       "groups of ranks, until all bounds are below -greedy_tolerance"))),
      number("greedy_tolerance", relative_error, o.greedy_tolerance,
             "bound of the error of u over u, in the energy norm, at which -greedy ends"),
      number("greedy_samples", {1, 1000000}, o.greedy_samples,
             "most samples of -greedy, with those of -train"),
      ranks_per_solve(o.ranks_per_solve),
      number(
          "sweep_max_failures", {0, 1}, o.max_failures,
          "share of a set that may fail; if more does, no model is made and nothing is measured")};
}

bool is_kept(const Option &option, const OfflineOptions &options) {
  const Use *runs = option.kept == nullptr ? option.use : option.kept;
  return !option.kept_as.empty() && (runs == nullptr || is_of(*runs, options));
}

} // namespace

std::vector<Option> options_of(ToolOptions &options) {
  std::vector<Option> all;
  add("Run", of_runs(options), all);
  add("Mesh", of_meshes(options), all);
  add("High-fidelity solver", solver_rows(options), all);
  add("High-fidelity solver", only(use::uzawa, of_uzawa(options.hf)), all);
  add("Large deformations", only(use::following, of_iterations(options.hf)), all);
  add("Sweep", of_sweeps(options), all);
  for (Option &option : reduction_options(options))
    all.push_back(std::move(option));
  return all;
}

const std::vector<Option> &tool_options() {
  static ToolOptions defaults;
  static const std::vector<Option> options = options_of(defaults);
  return options;
}

const Option *find_option(const std::string &name) {
  const auto found = std::find_if(tool_options().begin(), tool_options().end(),
                                  [&](const Option &option) { return option.name == name; });
  return found == tool_options().end() ? nullptr : &*found;
}

std::map<std::string, std::string> kept_settings(const OfflineOptions &options) {
  std::map<std::string, std::string> settings;
  ToolOptions all;
  const std::vector<Option> table = options_of(all);
  static_cast<OfflineOptions &>(all) = options;
  for (const Option &option : table)
    if (is_kept(option, options))
      if (const std::string value = option.shown(); !value.empty())
        settings[option.kept_as] = value;
  return settings;
}

} // namespace rbvi
