#include "rbvi/mor/reduce.hpp"

#include "balancing_functions.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/variants.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/model/self_check.hpp"
#include "rbvi/mor/certificate.hpp"
#include "rbvi/mor/other_answers.hpp"
#include "rbvi/mor/reduced_balance.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/columns.hpp"
#include "rbvi/par/progress.hpp"
#include "shared_stages.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>

namespace rbvi {

namespace {

using enum StageKind;

std::string terms(const char *name, const Eim &eim) {
  return std::string(name) + " " + std::to_string(eim.size()) +
         (eim.exact()      ? " (exact)"
          : eim.unproved() ? " (all samples that differ: more would tell whether it is exact)"
                           : "");
}

/// "to 0.0001", and the tolerances of B^n and B^tau where they have their own.
std::string interpolation_tolerance(const Scene &scene, const ReduceOptions &options) {
  std::string text = "to " + short_number(options.eim.tolerance);
  const double of_body = eim_of_body(scene, options.eim).tolerance;
  if (of_body != options.eim.tolerance) text += ", A and F to " + short_number(of_body);
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

StageRow interpolation_row(const Scene &scene, const ReduceOptions &options,
                           const Reduction *made) {
  const bool apart = !separable_contact(scene), multipliers = has_multipliers(scene);
  const bool a = has_mapped_terms(scene.a), f = has_mapped_terms(scene.f);
  const std::string assembled = !multipliers            ? ""
                                : apart                 ? "; B, G are assembled exactly online"
                                : !separable_gap(scene) ? "; G is assembled exactly online"
                                                        : "";
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
  if (separable_gap(scene)) add("G", &AffineOperators::g);
  const std::string tolerance = interpolation_tolerance(scene, options);
  return {stage::interpolation,
          exact + (made == nullptr ? "" : "terms: ") + joined(names) +
              (made == nullptr ? " " + tolerance + "; a sum of few terms ends there"
                               : "; " + tolerance) +
              assembled};
}

StageNeed interpolation_need(const ReductionSize &size) {
  constexpr double of_entry = 2.5e-7, of_load = 3e-6; // seconds, for an entry of a sample
  return {.numbers =
              2 * ((size.of_a * size.entries / 2 + size.of_f * size.dofs) / size.ranks + size.of_b),
          .seconds =
              (of_entry * size.of_a * size.entries + of_load * size.of_f * size.dofs) / size.ranks};
}

StageRow pod_row(const ReduceOptions &options, const Reduction *made) {
  if (made == nullptr)
    return {stage::pod, "displacements to " + short_number(options.pod.tolerance)};
  const ReducedBases &bases = made->bases;
  const double error = bases.pod.error[bases.modes];
  return {stage::pod, "N = " + counted(bases.modes, "mode") + ", error " + short_number(error)};
}

} // namespace

void add_modes(Problem &problem, const std::vector<Sample> &samples, const PodOptions &options,
               ReducedBases &bases) {
  std::vector<Handle<Vec>> owned;
  std::vector<Vec> snapshots;
  for (const Sample &sample : samples) {
    owned.push_back(from_natural(problem.dofs(), displacement(problem.comm(), sample)));
    snapshots.push_back(owned.back().get());
  }
  bases.pod = pod(snapshots, problem.v_product(), options);
  const PetscInt modes = bases.pod.basis.size();
  add_balancing_functions(problem, samples, bases.pod.basis);
  std::vector<double> &error = bases.pod.error; // what is left of the snapshots is as before
  error.insert(error.begin() + modes, static_cast<std::size_t>(bases.pod.basis.size() - modes),
               error[static_cast<std::size_t>(modes)]);
  bases.modes = static_cast<int>(bases.pod.basis.size());
}

void separate_jointly(Reducing &at) {
  at.made.affine = separate(at.problem, parameters_of(at.samples), at.options.eim);
}

std::vector<ReductionStage> first_stages(const Scene &scene, void (*separates)(Reducing &)) {
  std::vector<ReductionStage> list{
      {stage::interpolation, interpolation_row, separates, interpolation_need, fewer_samples}};
  if (scene.f.empty())
    list.push_back(
        {StageName("load vector"), [](const Scene &, const ReduceOptions &, const Reduction *) {
           return StageRow{StageName("load vector"), "the scene has no load", skipped};
         }});
  list.push_back(
      {stage::pod,
       [](const Scene &, const ReduceOptions &options, const Reduction *made) {
         return pod_row(options, made);
       },
       [](Reducing &at) { add_modes(at.problem, at.samples, at.options.pod, at.made.bases); },
       [](const ReductionSize &size) {
         constexpr double of_product = 1.4e-9, of_dof = 4e-6; // seconds
         return StageNeed{
             .numbers = 4 * size.dofs * size.samples / size.ranks + 6 * size.samples * size.samples,
             .seconds =
                 (of_product * size.samples * size.samples + of_dof) * size.dofs / size.ranks};
       },
       fewer_samples});
  return list;
}

bool has_mapped_terms(const Sum &sum) {
  return std::any_of(sum.begin(), sum.end(), [](const Term &term) { return !term.theta; });
}

Mu reference_of(const Problem &problem, const ReduceOptions &options) {
  return options.reference.empty() ? box_centre(problem.scene().parameters) : options.reference;
}

void project_bases(Reducing &at) {
  at.made.model = project(at.problem, at.samples, at.made.affine, at.made.bases);
}

void add_projection(const Scene &scene, void (*projects)(Reducing &),
                    std::vector<ReductionStage> &list) {
  if (has_multipliers(scene) && !has_friction(scene))
    list.push_back({StageName("tangential multipliers"),
                    [](const Scene &, const ReduceOptions &, const Reduction *) {
                      return StageRow{StageName("tangential multipliers"),
                                      "the scene has no friction", skipped};
                    }});
  list.push_back({stage::projection,
                  [](const Scene &, const ReduceOptions &, const Reduction *) {
                    return StageRow{stage::projection, "the separated operators onto the bases"};
                  },
                  projects,
                  [](const ReductionSize &size) {
                    return StageNeed{.numbers = size.model,
                                     .seconds =
                                         product_seconds * size.modes * size.modes *
                                         (size.terms * size.dofs / size.ranks + size.multipliers)};
                  }});
}

namespace {

StageRow bounds_row(const Scene &scene, const ReduceOptions &, const Reduction *made) {
  if (const std::string none = no_certificate(scene); !none.empty())
    return {stage::bounds, "none: " + none, skipped};
  if (made == nullptr) return {stage::bounds, "norms of the residual at reference parameters"};
  if (!made->no_bounds.empty()) return {stage::bounds, "none: " + made->no_bounds};
  if (made->model.certificate.by_law)
    return {stage::bounds, "energies of the law and of the displacement"};
  const std::vector<CertificateReference> &references = made->model.certificate.references;
  double numbers = static_cast<double>(made->model.certificate.lifting_trace.size());
  for (const CertificateReference &at : references)
    numbers += static_cast<double>(at.of_basis.size() + at.of_lifting.size() + at.of_loads.size() +
                                   at.of_contact.size());
  return {stage::bounds, "norms of the residual at " +
                             counted(std::ssize(references), "reference parameter") + ", " +
                             short_number(8e-6 * numbers) + " MB"};
}

void keep_bounds(Reducing &at) {
  Certificate made = make_certificate(at.problem, at.made.bases.pod.basis, at.made.model,
                                      parameters_of(at.samples));
  at.made.model.certificate = std::move(made.model);
  at.made.no_bounds = std::move(made.none);
}

std::string self_check_text(const Reduction *made) {
  if (made == nullptr) return "queries of the model just made, random and at corners and faces";
  const SelfCheck &check = made->model.made.self_check;
  return counted(check.queries - check.unanswered, "answer") + " to " +
         std::to_string(check.queries) + " queries, residual " +
         short_number(check.residual.value) + ", penetration " +
         short_number(check.penetration.value);
}

/// Lines of progress of a rank that asks queries.
QueriesAsked reported(const char *what) {
  return [what, progress = std::shared_ptr<Progress>()](int done, int all) mutable {
    if (!progress) progress = std::make_shared<Progress>(what, all, true);
    progress->update(done);
  };
}

/// Into the model of rank 0.
void check_answers(Reducing &at) {
  const MPI_Comm comm = at.problem.comm();
  ReducedModel &model = at.made.model;
  std::array<int, 2> found{};
  look_for_other_answers(comm, model, at.problem.scene());
  collectively(comm, [&] {
    if (rank_of(comm) != 0) return;
    model.made.self_check =
        self_check(model, at.problem.scene(), queries_of_check(model),
                   {.method = at.options.online_method}, reported("queries of the self-check"));
    found = {model.made.self_check.unanswered, model.made.self_check.answered() ? 1 : 0};
  });
  MPI_Bcast(found.data(), 2, MPI_INT, 0, comm);
  at.unanswered = found[0];
  at.met = found[1] != 0;
  compare_balance(at.problem, model);
}

} // namespace

void add_bounds(const ReduceOptions &options, std::vector<ReductionStage> &list) {
  if (!options.certify) return;
  list.push_back({stage::bounds, bounds_row, keep_bounds,
                  [](const ReductionSize &size) {
                    if (size.contact > most_pushed_dofs) return StageNeed{};
                    const double loads = 3 * (size.modes + size.multipliers) + size.contact;
                    const double references = size.axes > 0 ? 3 : 1;
                    return StageNeed{.numbers = 2 * size.dofs * loads / size.ranks + size.factor,
                                     .seconds =
                                         references * (size.factorisation +
                                                       loads / size.ranks *
                                                           (size.factor * column_seconds +
                                                            product_seconds * loads * size.dofs))};
                  },
                  "-certify no"});
}

ReductionStage self_check_stage() {
  return {stage::self_check,
          [](const Scene &, const ReduceOptions &, const Reduction *made) {
            return StageRow{stage::self_check, self_check_text(made)};
          },
          check_answers,
          [](const ReductionSize &size) {
            return StageNeed{size.dofs * size.modes / size.ranks, size.model, size.self_check};
          }};
}

double ReductionSize::responses(double count) const {
  constexpr double at_once = 128;
  return factor + 2 * dofs * std::min(at_once, count / ranks);
}

namespace {

std::vector<ReductionWay> &list_of_ways() {
  static std::vector<ReductionWay> ways{cone_way, condensed_way, nitsche_way};
  return ways;
}

} // namespace

const std::vector<ReductionWay> &reduction_ways() {
  return list_of_ways();
}

void add_reduction(const ReductionWay &way) {
  std::vector<ReductionWay> &ways = list_of_ways();
  if (std::ranges::find(ways, way.reduction, &ReductionWay::reduction) == ways.end())
    ways.push_back(way);
}

const std::vector<std::string> &multiplier_reduction_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{"auto"};
    for (const ReductionWay &way : reduction_ways())
      if (*way.name != 0) all.emplace_back(way.name);
    return all;
  }();
  return names;
}

const std::vector<std::string> &collocation_nodes_names() {
  static const std::vector<std::string> names{"best", "before_rise", "all"};
  return names;
}

const ReductionWay &way_of(const Scene &scene, MultiplierReduction chosen) {
  if (!has_multipliers(scene)) return nitsche_way;
  // Where A is one matrix the operator behind the law costs one factorisation, and the law is
  // exact.
  if (chosen == MultiplierReduction::automatic)
    return keeps_nodes(scene) || constant_stiffness(scene) ? condensed_way : cone_way;
  const auto found = std::ranges::find(reduction_ways(), chosen, &ReductionWay::reduction);
  if (found == reduction_ways().end()) throw not_entered("-multiplier_reduction collocated");
  return *found;
}

void check_reduction(const Scene &scene, const ReduceOptions &options) {
  way_of(scene, options.multipliers.reduction).check(scene, options);
}

std::vector<ReductionStage> stages_of(const Scene &scene, const ReduceOptions &options) {
  return way_of(scene, options.multipliers.reduction).stages(with_imposed_loads(scene), options);
}

StageTable reduction_stages(const Scene &of, const ReduceOptions &options, const Reduction *made) {
  const Scene scene = with_imposed_loads(of);
  StageTable rows;
  for (const ReductionStage &stage : stages_of(of, options))
    if (stage.row != nullptr) rows.push_back(stage.row(scene, options, made));
  return rows;
}

void run_stages(const std::vector<ReductionStage> &list, Reducing &at, const char *from,
                const char *until) {
  const auto at_name = [&](const char *name, auto first) {
    return std::find_if(first, list.end(), [&](const ReductionStage &stage) {
      return std::string_view(stage.name.text) == name;
    });
  };
  const auto first = *from == 0 ? list.begin() : at_name(from, list.begin());
  for (auto stage = first; stage != at_name(until, first); ++stage)
    if (stage->run != nullptr && will_run(at.made.stages, stage->name)) {
      const Stage measured(at.made.stages, stage->name);
      stage->run(at);
    }
}

Reducing start_reducing(Problem &problem, const std::vector<Sample> &samples,
                        const ReduceOptions &options, Reduction &made) {
  const Scene &scene = problem.scene();
  const ReductionWay &way = way_of(scene, options.multipliers.reduction);
  way.check(scene, options);
  if (samples.empty()) throw failure("there is no sample to build a basis from");
  Reducing at{problem, samples, options, made};
  at.options.multipliers.reduction = way.reduction;
  if (has_multipliers(scene)) at.multipliers = multipliers_of(samples);
  made.stages = reduction_stages(scene, options);
  return at;
}

Reduction reduce(Problem &problem, const std::vector<Sample> &samples,
                 const ReduceOptions &options) {
  const Scene &scene = problem.scene();
  Reduction result;
  Reducing at = start_reducing(problem, samples, options, result);
  const std::vector<ReductionStage> list = stages_of(scene, options);
  run_stages(list, at, "", stage::pod.text);
  const auto attempt = [&] {
    result.bases = {}; // one basis at a time: its fields are as large as the mesh
    result.model = {};
    run_stages(list, at, stage::pod.text);
  };
  const auto repeats = way_of(scene, options.multipliers.reduction).repeats;
  if (repeats != nullptr)
    repeats(at, attempt);
  else
    attempt();
  result.stages = finished_stages(result.stages, reduction_stages(scene, options, &result));
  return result;
}

} // namespace rbvi
