#include "rbvi/tool/stages.hpp"

#include "rbvi/core/text.hpp"
#include "rbvi/rom/print.hpp"
#include "rbvi/solve/scaled_part.hpp"

#include <algorithm>
#include <cstdio>

namespace rbvi {

namespace {

std::string count(int number, const std::string &noun) {
  return std::to_string(number) + " " + noun + (number == 1 ? "" : "s");
}

StageRow mesh_row(const ToolOptions &options) {
  return {"mesh",
          (options.mesh.file.empty() ? "built in: " + options.scene.mesh.generator
                                     : "file " + options.mesh.file) +
              (options.mesh.refine > 0 ? ", refined " + count(options.mesh.refine, "time") : "")};
}

StageRow snapshot_row(const ToolOptions &options, std::size_t training, int groups,
                      const OfflineResult *result) {
  const std::string shared =
      " by " + count(groups, "group") + " of " + count(options.ranks_per_solve, "rank");
  if (result == nullptr)
    return {"snapshots", std::to_string(training) + " high-fidelity solves" + shared +
                             ", those that are there reused"};
  const SweepReport &sweep = result->sweep;
  if (sweep.solved == 0 && sweep.failed.empty())
    return {"snapshots", "all " + std::to_string(sweep.reused) + " were there", true};
  std::string what = std::to_string(sweep.solved) + " solved" + shared;
  if (sweep.solved > 0) what += ", median " + short_number(1e3 * sweep.seconds_per_solve) + " ms";
  if (sweep.reused > 0) what += "; " + std::to_string(sweep.reused) + " reused";
  if (!sweep.failed.empty()) what += "; " + std::to_string(sweep.failed.size()) + " failed";
  return {"snapshots", what};
}

std::string terms(const char *name, const Eim &eim) {
  return std::string(name) + " " + std::to_string(eim.size()) + (eim.exact() ? " (exact)" : "");
}

/// "to 0.0001", and of B^n and B^tau where they have their own.
std::string interpolation_tolerance(const ReduceOptions &reduce) {
  std::string text = "to " + short_number(reduce.eim.tolerance);
  if (reduce.eim_normal) text += ", B^n to " + short_number(*reduce.eim_normal);
  if (reduce.eim_tangential) text += ", B^tau to " + short_number(*reduce.eim_tangential);
  return text;
}

std::string terms_of_b(const AffineOperators &affine) {
  if (affine.b_tangential.size() == 0) return terms("B", affine.b);
  return terms("B^n", affine.b) + ", " + terms("B^tau", affine.b_tangential);
}

StageRow interpolation_row(const ToolOptions &options, const OfflineResult *result) {
  const std::string tolerance = interpolation_tolerance(options.reduce);
  const bool load = static_cast<bool>(options.scene.f);
  const bool apart = options.scene.pair.has_value() || options.scene.nitsche.has_value();
  const std::string exact = options.scene.pair ? "; B, G are assembled exactly online" : "";
  if (constant_stiffness(options.scene) && apart && !load)
    return {"interpolation", "A does not depend on mu" + exact, true};
  if (result == nullptr)
    return {"interpolation", std::string("A") + (apart ? "" : ", B") + (load ? ", F" : "") +
                                 (apart ? " " : ", G ") + tolerance +
                                 "; a sum of few terms ends there" + exact};
  const AffineOperators &affine = result->made.affine;
  return {"interpolation",
          "terms: " + terms("A", affine.a) + (apart ? "" : ", " + terms_of_b(affine)) +
              (load ? ", " + terms("F", affine.f) : "") +
              (apart ? "" : ", " + terms("G", affine.g)) + "; " + tolerance + exact};
}

/// What of the solves is done once for all mu.
StageRow factorisation_row(const ToolOptions &options) {
  if (options.scene.nitsche)
    return {"factorisations",
            "one serves many Newton steps, as long as conjugate gradients need few iterations"};
  if (constant_stiffness(options.scene))
    return {"factorisations", "A does not depend on mu: one for the sweep, one condensed operator"};
  if (options.hf.method == HfMethod::active_set && ScaledPart::fits(options.scene))
    return {"factorisations",
            "a part of A is scaled: three for the sweep of each group, the part is "
            "eliminated once"};
  return {"factorisations", "A depends on mu: one for each solve"};
}

StageRow pod_row(const ToolOptions &options, const OfflineResult *result) {
  const std::string tolerance = "to " + short_number(options.reduce.pod.tolerance);
  if (result == nullptr) return {"POD", "displacements " + tolerance};
  const ReducedBases &bases = result->made.bases;
  const double error = bases.pod.error[static_cast<std::size_t>(bases.modes)];
  return {"POD", "N = " + count(bases.modes, "mode") + ", error " + short_number(error)};
}

StageRow cone_row(const ToolOptions &options, const OfflineResult *result) {
  const ConeOptions &cone = options.reduce.cone;
  const std::string &name = cone_type_names()[static_cast<std::size_t>(cone.type)];
  if (result == nullptr)
    return {"cone",
            name + " for the multipliers" +
                (cone.type == ConeType::nodal ? "" : ", to " + short_number(cone.tolerance))};
  const Cone &made = result->made.bases.cone;
  const auto modes = static_cast<int>(made.modes.columns.cols());
  return {"cone", "R = " + count(static_cast<int>(made.basis.generators.cols()), "generator") +
                      (modes > 0 ? " + " + count(modes, "free mode") : "") + " (" + name +
                      "), error " + short_number(made.history.error.back()) + ", " +
                      made.history.reason +
                      (result->made.ring > cone.ring
                           ? ", widened to a ring of " + std::to_string(result->made.ring)
                           : "")};
}

StageRow pga_row(const ToolOptions &options, const OfflineResult *result) {
  const ReduceOptions &reduce = options.reduce;
  if (reduce.enrichment == Enrichment::decorrelated)
    return {"PGA", "no supremizers are wanted (-pga_enrichment)", true};
  const bool online = reduce.enrichment == Enrichment::online;
  const std::string product = reduce.product == SupremizerProduct::energy ? " in energy" : "";
  if (result == nullptr) {
    if (online) return {"PGA", "the span of all supremizers" + product};
    return {"PGA", "supremizers" + product + " until " +
                       (reduce.infsup_tolerance ? "sigma <= beta_HF / c_HF at all training mu"
                        : reduce.pga.tolerance > 0
                            ? "sigma <= " + short_number(reduce.pga.tolerance)
                            : "beta_off >= " + short_number(reduce.pga.stability) + " beta_on") +
                       (options.scene.pair ? "" : "; one SVD if B only scales")};
  }
  const ReducedBases &bases = result->made.bases;
  return {"PGA", "S = " + count(bases.supremizers, "supremizer") + product + ", sigma " +
                     short_number(bases.pga.sigma.back()) + ", " + bases.pga.reason};
}

/// Before that of the PGA, where its tolerance is computed.
void add_tolerance_row(const ToolOptions &options, const OfflineResult *result,
                       std::vector<StageRow> &rows) {
  if (!options.reduce.infsup_tolerance || options.reduce.enrichment != Enrichment::offline) return;
  rows.push_back(
      {"inf-sup tolerance",
       "smallest beta_HF / c_HF" +
           (result == nullptr ? " over the training set"
                              : ": " + short_number(result->made.bases.infsup_tolerance))});
}

StageRow sweep_of_supremizers_row(const ToolOptions &options, const OfflineResult *result) {
  const char *stage = "supremizers at all mu";
  if (options.reduce.enrichment == Enrichment::decorrelated)
    return {stage, "no supremizers are wanted", true};
  if (result == nullptr && !options.scene.pair) return {stage, "only if B does more than scale"};
  if (!options.scene.pair && result->made.affine.b_size() == 1)
    return {stage, "B only scales: one set and one SVD serve all mu", true};
  return {stage, "B depends on mu: part of PGA"};
}

/// Functions of the multipliers of a further reduction.
std::string multiplier_row(const ToolOptions &options, const OfflineResult *result) {
  const auto kind = static_cast<std::size_t>(options.reduce.multipliers.reduction);
  const std::string name = multiplier_reduction_names()[kind];
  if (result == nullptr) return name;
  const MultiplierBasis &basis = result->made.bases.multipliers.basis;
  if (options.reduce.multipliers.reduction == MultiplierReduction::joint)
    return name + ": " + count(static_cast<int>(basis.normal.cols()), "mode") + ", " +
           count(static_cast<int>(basis.nodes.size()), "node");
  const bool cones = options.reduce.multipliers.reduction == MultiplierReduction::cones;
  if (basis.tangential.size() == 0)
    return name + ": R = " + count(static_cast<int>(basis.normal.cols()), "generator");
  return name + ": R = " + count(static_cast<int>(basis.normal.cols()), "generator") + ", " +
         (cones ? "M = " : "S = ") +
         count(static_cast<int>(basis.tangential.cols()), cones ? "generator" : "mode");
}

/// Contact with a rigid support: the condensed operator in place of a reduced pair.
void add_support_rows(const ToolOptions &options, const OfflineResult *result,
                      std::vector<StageRow> &rows) {
  const std::string tolerance = short_number(options.reduce.condensed.tolerance);
  std::string what =
      "the condensed operator, at the Chebyshev points of the parameters of A to " + tolerance;
  if (result != nullptr) {
    const CondensedOperator &condensed = result->made.bases.condensed;
    what = count(static_cast<int>(result->made.bases.support_dual.cols()), "multiplier") + ", " +
           count(static_cast<int>(grid_size(condensed.axes)), "factorisation") + ", " +
           count(static_cast<int>(condensed.terms.cols()), "term");
    if (!condensed.axes.empty()) what += ", error " + short_number(condensed.error);
  }
  const MultiplierReduction reduction = options.reduce.multipliers.reduction;
  const bool none =
      reduction == MultiplierReduction::collocated && !options.reduce.multipliers.exact;
  rows.push_back({"condensation", none ? "not wanted (-multiplier_exact no)" : what, none});
  if (reduction == MultiplierReduction::condensed)
    rows.push_back({"cone, PGA",
                    "the multipliers keep a coefficient at every node: nothing to "
                    "stabilise",
                    true});
  else
    rows.push_back({"multipliers", multiplier_row(options, result)});
  if (reduction == MultiplierReduction::collocated) {
    add_tolerance_row(options, result, rows);
    rows.push_back(pga_row(options, result));
  }
  const bool friction = options.scene.support->friction.law != FrictionLaw::none;
  if (reduction == MultiplierReduction::collocated && friction)
    rows.push_back({"collocation nodes",
                    result == nullptr
                        ? "greedy (Algorithm 3), reduced problems solved exactly"
                        : count(static_cast<int>(result->made.collocation.nodes.size()), "node") +
                              ": " + result->made.collocation.reason});
  if (!friction) rows.push_back({"tangential multipliers", "the scene has no friction", true});
}

/// Nitsche's method: how the integrals over the curve are reduced.
void add_curve_rows(const ToolOptions &options, const OfflineResult *result,
                    std::vector<StageRow> &rows) {
  const CurveRule rule = options.reduce.curve.rule;
  std::string what = rule == CurveRule::full        ? "all Gauss points"
                     : rule == CurveRule::empirical ? "few Gauss points, non-negative weights"
                                                    : "EIM over (mu, Newton step)";
  if (result != nullptr) {
    const CurveReport &curve = result->made.curve;
    what = describe_curve(*result->made.model.nitsche);
    if (rule == CurveRule::empirical) what += ", error " + short_number(curve.error.back());
    if (rule == CurveRule::interpolated) what += ", of " + std::to_string(curve.states) + " states";
  }
  rows.push_back({"contact curve", what});
  rows.push_back({"cone, PGA", "Nitsche's method has no multipliers", true});
}

/// Dual basis and supremizers of a reduced pair.
void add_pair_rows(const ToolOptions &options, const OfflineResult *result,
                   std::vector<StageRow> &rows) {
  rows.push_back(cone_row(options, result));
  if (options.reduce.enrichment != Enrichment::decorrelated)
    rows.push_back({"Riesz representers", options.reduce.product == SupremizerProduct::energy
                                              ? "one factorisation of A at the reference mu"
                                              : "one factorisation of V for all mu"});
  add_tolerance_row(options, result, rows);
  rows.push_back(pga_row(options, result));
  rows.push_back(sweep_of_supremizers_row(options, result));
  rows.push_back({"tangential multipliers", "the scene has no friction", true});
}

std::string self_check_row(const OfflineResult *result) {
  if (result == nullptr) return "random queries of the model just made";
  const SelfCheck &check = result->made.model.self_check;
  return count(check.queries - check.unanswered, "answer") + " to " +
         std::to_string(check.queries) + " random queries, residual " +
         short_number(check.residual.value);
}

} // namespace

std::vector<StageRow> offline_stages(const ToolOptions &options, std::size_t training, int groups,
                                     const OfflineResult *result) {
  std::vector<StageRow> rows{mesh_row(options), factorisation_row(options),
                             snapshot_row(options, training, groups, result)};
  if (groups == 1)
    rows.push_back({"distributed mesh", "the one group holds all ranks", true});
  else
    rows.push_back({"distributed mesh", "for the reduction on all ranks"});
  rows.push_back(interpolation_row(options, result));
  if (!options.scene.f) rows.push_back({"load vector", "the scene has no load", true});
  rows.push_back(pod_row(options, result));
  if (options.scene.nitsche)
    add_curve_rows(options, result, rows);
  else if (options.scene.support)
    add_support_rows(options, result, rows);
  else
    add_pair_rows(options, result, rows);
  rows.push_back({"projection", "the separated operators onto the bases"});
  rows.push_back({"self-check", self_check_row(result)});
  rows.push_back({"writing", "model.h5, samples.csv"});
  rows.push_back({"reconstruction", "online, only when asked", true});
  return rows;
}

void print_stages(const std::vector<StageRow> &rows, const StageTimes &times) {
  std::printf("%-24s %9s  %s\n", "Stage", "seconds", "what");
  double total = 0;
  for (const StageRow &row : rows) {
    const auto time = std::find_if(times.begin(), times.end(),
                                   [&](const auto &entry) { return entry.first == row.stage; });
    char seconds[16] = "";
    if (time != times.end()) {
      std::snprintf(seconds, sizeof seconds, "%.3f", time->second);
      total += time->second;
    }
    std::printf("  %-22s %9s  %s%s\n", row.stage.c_str(), seconds, row.skipped ? "skipped: " : "",
                row.what.c_str());
  }
  if (!times.empty()) std::printf("  %-22s %9.3f\n", "total", total);
}

} // namespace rbvi
