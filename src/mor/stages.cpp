#include "rbvi/mor/reduce.hpp"

#include "rbvi/core/text.hpp"
#include "rbvi/element/imposed.hpp"

#include <algorithm>

namespace rbvi {

namespace {

using enum StageKind;

std::string terms(const char *name, const Eim &eim) {
  return std::string(name) + " " + std::to_string(eim.size()) + (eim.exact() ? " (exact)" : "");
}

/// "to 0.0001", and the tolerances of B^n and B^tau where they have their own.
std::string interpolation_tolerance(const ReduceOptions &options) {
  std::string text = "to " + short_number(options.eim.tolerance);
  if (options.eim_normal) text += ", B^n to " + short_number(*options.eim_normal);
  if (options.eim_tangential) text += ", B^tau to " + short_number(*options.eim_tangential);
  return text;
}

std::string terms_of_b(const AffineOperators &affine) {
  if (affine.b_tangential.size() == 0) return terms("B", affine.b);
  return terms("B^n", affine.b) + ", " + terms("B^tau", affine.b_tangential);
}

/// "A: exact sum of 4 terms; " of an operator that has exact terms.
std::string exact_sum(const char *name, const Sum &sum, const ParameterSpace &space) {
  const SplitSum split = split_sum(sum, space);
  if (split.exact.empty()) return "";
  return std::string(name) + (split.mapped.empty() ? ": exact sum of " : ": in part exact, ") +
         counted(std::ssize(split.exact), "term") + "; ";
}

bool has_mapped_terms(const Sum &sum) {
  return std::any_of(sum.begin(), sum.end(), [](const Term &term) { return !term.theta; });
}

StageRow interpolation_row(const Scene &scene, const ReduceOptions &options,
                           const Reduction *made) {
  const bool apart = !separable_contact(scene),
             evaluated = apart && options.multipliers.reduction != MultiplierReduction::none;
  const bool a = has_mapped_terms(scene.a), f = has_mapped_terms(scene.f);
  const std::string assembled = evaluated ? "; B, G are assembled exactly online" : "";
  const std::string exact =
      exact_sum("A", scene.a, scene.parameters) + exact_sum("F", scene.f, scene.parameters);
  if (!a && !f && apart)
    return {stage::interpolation,
            (constant_stiffness(scene) && scene.f.empty() ? "A does not depend on mu"
                                                          : exact.substr(0, exact.size() - 2)) +
                assembled,
            nothing_to_do};
  std::vector<std::string> names;
  const auto add = [&](const char *name, const Eim AffineOperators::*eim) {
    names.push_back(made == nullptr ? name : terms(name, made->affine.*eim));
  };
  if (a) add("A", &AffineOperators::a);
  if (!apart) names.push_back(made == nullptr ? "B" : terms_of_b(made->affine));
  if (f) add("F", &AffineOperators::f);
  if (!apart) add("G", &AffineOperators::g);
  const std::string tolerance = interpolation_tolerance(options);
  return {stage::interpolation,
          exact + (made == nullptr ? "" : "terms: ") + joined(names) +
              (made == nullptr ? " " + tolerance + "; a sum of few terms ends there"
                               : "; " + tolerance) +
              assembled};
}

StageRow pod_row(const ReduceOptions &options, const Reduction *made) {
  if (made == nullptr)
    return {stage::pod, "displacements to " + short_number(options.pod.tolerance)};
  const ReducedBases &bases = made->bases;
  const double error = bases.pod.error[bases.modes];
  return {stage::pod, "N = " + counted(bases.modes, "mode") + ", error " + short_number(error)};
}

StageRow cone_row(const ReduceOptions &options, const Reduction *made) {
  const ConeOptions &cone = options.cone;
  const std::string &name = cone_type_names()[static_cast<std::size_t>(cone.type)];
  if (made == nullptr)
    return {stage::cone,
            name + " for the multipliers" +
                (cone.type == ConeType::nodal ? "" : ", to " + short_number(cone.tolerance))};
  const Cone &found = made->bases.cone;
  const Index modes = found.modes.columns.cols();
  return {
      stage::cone,
      "R = " + counted(found.basis.generators.cols(), "generator") +
          (modes > 0 ? " + " + counted(modes, "free mode") : "") + " (" + name + "), error " +
          short_number(found.history.error.back()) + ", " + found.history.reason +
          (made->ring > cone.ring ? ", widened to a ring of " + std::to_string(made->ring) : "")};
}

/// When the greedy stops.
std::string pga_target(const ReduceOptions &options) {
  if (options.infsup_tolerance) return "sigma <= beta_HF / c_HF at all training mu";
  if (options.pga.tolerance > 0) return "sigma <= " + short_number(options.pga.tolerance);
  return "beta_off >= " + short_number(options.pga.stability) + " beta_on";
}

StageRow pga_row(const Scene &scene, const ReduceOptions &options, const Reduction *made) {
  const std::string product = options.product == SupremizerProduct::energy ? " in energy" : "";
  if (made == nullptr && options.enrichment == Enrichment::online)
    return {stage::pga, "the span of all supremizers" + product};
  if (made == nullptr)
    return {stage::pga, "supremizers" + product + " until " + pga_target(options) +
                            (separable_contact(scene) ? "; one SVD if B only scales" : "")};
  const ReducedBases &bases = made->bases;
  return {stage::pga, "S = " + counted(bases.supremizers, "supremizer") + product + ", sigma " +
                          short_number(bases.pga.sigma.back()) + ", " + bases.pga.reason};
}

/// Supremizers of a reduced pair.
void add_supremizer_rows(const Scene &scene, const ReduceOptions &options, const Reduction *made,
                         StageTable &rows) {
  if (options.enrichment == Enrichment::decorrelated) {
    rows.push_back({stage::pga, "no supremizers are wanted (-pga_enrichment)", skipped});
    return;
  }
  rows.push_back({stage::riesz, options.product == SupremizerProduct::energy
                                    ? "one factorisation of A at the reference mu"
                                    : "one factorisation of V for all mu"});
  if (options.infsup_tolerance && options.enrichment == Enrichment::offline)
    rows.push_back({stage::infsup_tolerance,
                    "smallest beta_HF / c_HF" +
                        (made == nullptr ? " over the training set"
                                         : ": " + short_number(made->bases.infsup_tolerance))});
  rows.push_back(pga_row(scene, options, made));
}

StageRow sweep_of_supremizers_row(const Scene &scene, const ReduceOptions &options,
                                  const Reduction *made) {
  constexpr StageName name("supremizers at all mu");
  if (options.enrichment == Enrichment::decorrelated)
    return {name, "no supremizers are wanted", skipped};
  const bool separable = separable_contact(scene);
  if (made == nullptr && separable) return {name, "only if B does more than scale", part};
  if (separable && made->affine.b_size() == 1)
    return {name, "B only scales: one set and one SVD serve all mu", skipped};
  return {name,
          follows_state(scene) ? "B depends on mu and the step of the iteration: part of PGA"
                               : "B depends on mu: part of PGA",
          part};
}

/// The functions of the multipliers.
std::string multiplier_text(const Reduction *made) {
  if (made == nullptr) return "collocated";
  const MultiplierBasis &basis = made->bases.multipliers.basis;
  const std::string normal = "collocated: R = " + counted(basis.normal.cols(), "generator");
  if (basis.tangential.size() == 0) return normal;
  return normal + ", S = " + counted(basis.tangential.cols(), "mode");
}

StageRow condensation_row(const ReduceOptions &options, const Reduction *made) {
  if (options.multipliers.reduction == MultiplierReduction::collocated &&
      !options.multipliers.exact)
    return {stage::condensation, "not wanted (-multiplier_exact no)", skipped};
  if (made == nullptr)
    return {stage::condensation,
            "the condensed operator, at the Chebyshev points of the parameters of A to " +
                short_number(options.condensed.tolerance)};
  const CondensedOperator &condensed = made->bases.condensed;
  std::string what = counted(made->bases.nodal_dual.cols(), "multiplier") +
                     (made->bases.dropped > 0 ? " near contact" : "") + ", " +
                     counted(made->bases.responses, "response") + ", " +
                     counted(made->bases.factorisations, "factorisation") + ", " +
                     counted(condensed.terms.cols(), "term");
  if (!condensed.axes.empty()) what += ", error " + short_number(condensed.error);
  return {stage::condensation, what};
}

constexpr StageName pair_stages("cone, PGA");

/// The law at nodes: the condensed operator in place of a reduced pair, or beside it.
void add_law_rows(const Scene &scene, const ReduceOptions &options, const Reduction *made,
                  StageTable &rows) {
  rows.push_back(condensation_row(options, made));
  if (options.multipliers.reduction == MultiplierReduction::condensed) {
    rows.push_back({pair_stages,
                    "the multipliers keep a coefficient at every node" +
                        (options.cone.level > 0 ? " of the mesh refined " +
                                                      counted(options.cone.level, "time") + " less"
                                                : std::string()) +
                        ": nothing to stabilise",
                    skipped});
    return;
  }
  rows.push_back({stage::multipliers, multiplier_text(made)});
  add_supremizer_rows(scene, options, made, rows);
  if (has_friction(scene))
    rows.push_back({stage::collocation,
                    made == nullptr ? "greedy (Algorithm 3), reduced problems solved exactly"
                                    : counted(std::ssize(made->collocation.nodes), "node") + ": " +
                                          made->collocation.reason});
}

/// Nitsche's method: how the integrals over the curve are reduced.
void add_curve_rows(const ReduceOptions &options, const Reduction *made, StageTable &rows) {
  const CurveRule rule = options.curve.rule;
  std::string what = rule == CurveRule::full        ? "all Gauss points"
                     : rule == CurveRule::empirical ? "few Gauss points, non-negative weights"
                                                    : "EIM over (mu, Newton step)";
  if (made != nullptr) {
    what = describe_curve(made->model);
    if (rule == CurveRule::empirical) what += ", error " + short_number(made->curve.error.back());
    if (rule == CurveRule::interpolated)
      what += ", of " + std::to_string(made->curve.states) + " states";
  }
  rows.push_back({stage::contact_curve, what});
  rows.push_back({pair_stages, "Nitsche's method has no multipliers", skipped});
}

std::string self_check_text(const Reduction *made) {
  if (made == nullptr) return "queries of the model just made, random and at corners and faces";
  const SelfCheck &check = made->model.made.self_check;
  return counted(check.queries - check.unanswered, "answer") + " to " +
         std::to_string(check.queries) + " queries, residual " +
         short_number(check.residual.value) + ", penetration " +
         short_number(check.penetration.value);
}

} // namespace

StageTable reduction_stages(const Scene &of, const ReduceOptions &given, const Reduction *made) {
  const Scene scene = with_imposed_loads(of);
  ReduceOptions options = given;
  MultiplierReduction &reduction = options.multipliers.reduction;
  reduction = reduction_of(scene, reduction);
  StageTable rows{interpolation_row(scene, options, made)};
  if (scene.f.empty()) rows.push_back({StageName("load vector"), "the scene has no load", skipped});
  rows.push_back(pod_row(options, made));
  if (reduction == MultiplierReduction::none) {
    add_curve_rows(options, made, rows);
  } else if (keeps_law(reduction)) {
    add_law_rows(scene, options, made, rows);
  } else {
    rows.push_back(cone_row(options, made));
    add_supremizer_rows(scene, options, made, rows);
    rows.push_back(sweep_of_supremizers_row(scene, options, made));
  }
  if (reduction != MultiplierReduction::none && !has_friction(scene))
    rows.push_back({StageName("tangential multipliers"), "the scene has no friction", skipped});
  rows.push_back({stage::projection, "the separated operators onto the bases"});
  rows.push_back({stage::self_check, self_check_text(made)});
  return rows;
}

} // namespace rbvi
