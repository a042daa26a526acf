// The options of the reduced model.
#include "table.hpp"

#include "kinds.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/mor/reduction.hpp"

namespace rbvi {

namespace {

const Range basis_size{0, 100000};

Option pga_tolerance(ReduceOptions &o) {
  Option option =
      number("pga_tolerance", {0, 0.999}, o.pga.tolerance,
             "stop at this largest sigma (2.27); infsup: at the smallest beta_HF / c_HF over the "
             "training set, which meets (2.23) for certain; 0: stop by -pga_beta_fraction");
  option.values += ", infsup";
  option.read = [&o, read_number = option.read](const std::string &value) {
    o.infsup_tolerance = value == "infsup";
    if (!o.infsup_tolerance)
      while_doing("reading -pga_tolerance, a number or infsup", [&] { read_number(value); });
  };
  option.shown = [&o, show_number = option.shown] {
    return o.infsup_tolerance ? "infsup" : show_number();
  };
  return option;
}

Option reference_mu(const Scene &scene, Mu &place) {
  Option option{"reference_mu", OptionKind::text,
                "parameter at which -pga_product energy, and the hybrid basis, take A", "parameter",
                "centre of the box"};
  option.read = [&](const std::string &value) {
    place = while_doing("reading option -reference_mu",
                        [&] { return parse_mu(scene.parameters, value); });
  };
  return option;
}

Option nitsche_eim_validation(const Scene &scene, std::vector<Mu> &place) {
  Option option{"nitsche_eim_validation", OptionKind::set,
                "interpolated: a further set, given as -train is, at whose Newton steps that error "
                "is measured too",
                "set"};
  option.read = [&](const std::string &value) {
    place = while_doing("reading option -nitsche_eim_validation",
                        [&] { return parse_set(scene.parameters, value, false, scene.outputs); });
  };
  return option;
}

std::vector<Option> of_modes(ReduceOptions &o) {
  return {
      kept(number("pod_tolerance", relative_error, o.pod.tolerance,
                  "relative error that the modes of the displacement may leave (2.11)")),
      number("pod_max_size", basis_size, o.pod.max_size, "largest number of modes; 0: no limit")};
}

std::vector<Option> of_cones(ReduceOptions &o) {
  const std::vector<std::string> cones{
      "snapshots of the pressure, each the one farthest from the cone of those before (B.2)",
      "the same, each without the largest part that the cone holds already (Algorithm 2); default "
      "of -multiplier_reduction collocated",
      "snapshots, each the one at the largest angle to the span of those before (Haasdonk, "
      "Salomon, Wohlmuth 2012)",
      "non-negative factorisation of the snapshots (Lee, Seung 2000), by HALS",
      "hat functions of all nodes that were ever in contact (a hat is 1 at its node and 0 at the "
      "others)",
      "hat functions where contact changes, and a few modes of either sign at the nodes that never "
      "leave contact: see the study in membrane_obstacle/README.md"};
  return {
      kept(choice("cone_type", choices(cone_type_names(), cones), o.cone.type,
                  "dual basis: functions that the multipliers are combined from")),
      kept(number("cone_tolerance", relative_error, o.cone.tolerance,
                  "relative error that the dual basis may leave (2.34); nodal does not use it")),
      number("cone_max_size", basis_size, o.cone.max_size,
             "largest number of its functions; 0: no limit"),
      kept(number("cone_feasibility", relative_error, o.cone.feasibility,
                  "mcpg: largest negative value that a function may have, as a "
                  "fraction of its maximum")),
      kept(number("cone_ring", {0, 1000}, o.cone.ring,
                  "nodal, hybrid: how many layers of nodes around the nodes where "
                  "contact changes have hats, too; hybrid: at least 1 if the "
                  "training set has no corners, doubled as needed")),
      kept(use::multipliers,
           only(use::hats,
                never_waits(
                    number("cone_level", refinements, o.cone.level,
                           "hybrid, and the law at nodes: take the hats of the mesh with this many "
                           "refinements less"))))};
}

std::vector<Option> of_stability(const Scene &scene, ReduceOptions &o) {
  return {
      kept(choice(
          "pga_enrichment",
          choices(enrichment_names(),
                  {"none: the modes alone",
                   "those of each parameter, made anew for each query (2.17)",
                   "one set for all parameters, chosen by the projected greedy algorithm (2.30)"}),
          o.enrichment, "which supremizers join the modes")),
      kept(choice("pga_product",
                  choices(product_names(),
                          {"the product of V, for which the theory states its constants and bounds",
                           "the energy of A at -reference_mu"}),
                  o.product, "product with which supremizers are computed")),
      reference_mu(scene, o.reference),
      kept(pga_tolerance(o)),
      kept(number("pga_beta_fraction", {0, 1 - 1e-12}, o.pga.stability,
                  "stop when beta_off >= this fraction of beta_on holds for certain")),
      number("pga_max_size", basis_size, o.pga.max_size,
             "largest number of supremizers; 0: no limit")};
}

std::vector<Option> of_separation(ReduceOptions &o) {
  return {
      kept(number(
          "eim_tolerance", relative_error, o.eim.tolerance,
          "relative error that the separated operators may have (B.32); of an elastic body A "
          "and F a millionth of it, as bending is a small rest of large entries")),
      number("eim_max_size", basis_size, o.eim.max_size, "largest number of terms; 0: no limit"),
      otherwise("-eim_tolerance",
                kept(use::collocated,
                     only(use::rows_apart,
                          never_waits(number(
                              "eim_normal_tolerance", relative_error, o.eim_normal,
                              "collocated: the same for B^n, the rows of lambda_n (3.61a)"))))),
      otherwise(
          "-eim_tolerance",
          kept(use::collocated,
               only(use::tangential_rows,
                    never_waits(number(
                        "eim_tangential_tolerance", relative_error, o.eim_tangential,
                        "collocated: the same for B^tau, the rows of lambda_tau (3.61b)")))))};
}

std::vector<Option> of_law(ReduceOptions &o) {
  std::vector<std::string> reductions{
      "condensed on rigid supports, between two bodies, and where A is one matrix for all mu, "
      "otherwise cone"};
  for (const ReductionWay &way : reduction_ways())
    if (*way.name != 0) reductions.emplace_back(way.says);
  return {
      kept(number("condensed_tolerance", relative_error, o.condensed.tolerance,
                  "relative error that the condensed operator may have as a function of mu")),
      number("response_tolerance", relative_error, o.condensed.responses,
             "displacements A^-1 B^T under unit loads join the modes: first those of one A (if it "
             "is constant and they would take more than 160 MB only those under the loads of "
             "answers, to -answer_tolerance), then of others until this relative error is left; "
             "0: none join"),
      number("answer_tolerance", relative_error, o.condensed.answers,
             "where only displacements under the loads of answers join: what may be left of them, "
             "relative, in the energy; the larger, the smaller the model and the faster a query, "
             "and multipliers do not depend on it"),
      kept(use::law,
           only(use::multipliers,
                choice("multiplier_reduction", choices(multiplier_reduction_names(), reductions),
                       o.multipliers.reduction, "how the multipliers are reduced")))};
}

std::vector<Option> of_collocation(ReduceOptions &o) {
  return {
      flag("multiplier_exact", o.multipliers.exact,
           "collocated: an answer that breaks the law at some node is corrected by exact steps"),
      kept(number("tangential_tolerance", relative_error, o.multipliers.tangential,
                  "collocated: relative error that the modes of lambda_tau may leave")),
      choice("gcns_nodes",
             choices(collocation_nodes_names(),
                     {"those of the least e_GCNS that the greedy selection meets to its end",
                      "those before the first rise of e_GCNS, where Algorithm 3 stops",
                      "every one (3.43)"}),
             o.gcns.nodes, "collocated: nodes that hold the bound of friction"),
      number("gcns_tolerance", positive, o.gcns.tolerance,
             "collocated: no more nodes are chosen at this e_GCNS; 0: all are tried, and the "
             "best number is kept"),
      number("gcns_max_nodes", basis_size, o.gcns.max_nodes,
             "collocated: largest number of collocation nodes; 0: no limit")};
}

std::vector<Option> of_bounds(ReduceOptions &o) {
  return {
      kept(use::certified,
           flag("certify", o.certify,
                "every answer has a bound of its error in the energy norm (error_bound), or with "
                "Coulomb's law an indicator; where A and the load are sums of exact terms"))};
}

std::vector<Option> of_nitsche(NitscheOptions &solver, ReduceOptions &o) {
  return {
      choice("nitsche_steps",
             {{"searched", "along each the least energy is taken; they start in contact"},
              {"plain", "as published, from u = 0 (4.23), (4.41), (4.53): they may cycle"}},
             solver.plain_steps, "steps of Newton's method"),
      only(use::coulomb_terms,
           choice("nitsche_loop",
                  {{"nested", "keeps it fixed within an outer loop (4.63)"},
                   {"single", "updates it in every Newton step (4.53)"}},
                  solver.single_loop,
                  "how Newton's method treats Coulomb's bound, which depends on the pressure")),
      choice("nitsche_bounds",
             {{"none", "Newton's method"},
              {"nonpenetration", "SNES keeps the nodes' normal displacements below the gap"}},
             solver.nonpenetration, "bounds that the displacement keeps besides"),
      kept(choice(
          "nitsche_quadrature",
          choices(curve_rule_names(),
                  {"at a few Gauss points of the curve, with non-negative weights from least "
                   "squares (NNLS), so that the reduced problem still minimises an energy",
                   "at all Gauss points",
                   "the published method: tangent and residual by empirical interpolation "
                   "over (mu, Newton step) (4.71)-(4.80)"}),
          o.curve.rule, "how a reduced model integrates contact and friction over the curve")),
      only(use::empirical,
           number(
               "nitsche_quadrature_tolerance", relative_error, o.curve.tolerance,
               "empirical: relative error that it may add to u at a training parameter; 0: as much "
               "as the modes leave there"))};
}

std::vector<Option> of_interpolated_curve(const Scene &scene, ReduceOptions &o) {
  return {
      number("nitsche_eim_tolerance", relative_error, o.curve.eim_tolerance,
             "interpolated: relative error that may be left over all (mu, Newton step) (B.32)"),
      choice("nitsche_eim_pairs",
             {{"steps", "all: without friction plain ones from u = 0, else those of the solver"},
              {"published", "with Tresca's law plain ones, too, and B^n + B^tau in one; with "
                            "Coulomb's the ends of the loops (4.63) alone"}},
             o.curve.published_pairs, "interpolated: which Newton steps (4.73) has"),
      nitsche_eim_validation(scene, o.curve.eim_validation)};
}

} // namespace

std::vector<Option> reduction_options(OfflineOptions &options) {
  std::vector<Option> all;
  add("Bases", of_modes(options.reduce), all);
  add("Bases", only(use::dual_basis, of_cones(options.reduce)), all);
  add("Stability", only(use::dual_basis, of_stability(options.scene, options.reduce)), all);
  add("Separation", of_separation(options.reduce), all);
  add("Multipliers", only(use::law, of_law(options.reduce)), all);
  add("Multipliers", only(use::collocated, of_collocation(options.reduce)), all);
  add("Bounds of errors", only(use::multipliers, of_bounds(options.reduce)), all);
  add("Nitsche's method", only(use::nitsche, of_nitsche(options.hf.nitsche, options.reduce)), all);
  add("Nitsche's method",
      only(use::interpolated, of_interpolated_curve(options.scene, options.reduce)), all);
  return all;
}

} // namespace rbvi
