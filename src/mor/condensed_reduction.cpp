// The law of contact and friction at every node: the body behind it is its condensed operator.
#include "rbvi/core/text.hpp"
#include "rbvi/model/affine_coefficients.hpp"
#include "rbvi/model/law_problem.hpp"
#include "rbvi/mor/answered_responses.hpp"
#include "rbvi/mor/nodal_dual_basis.hpp"
#include "rounding.hpp"
#include "shared_stages.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace rbvi {

namespace {

StageRow condensation_row(const Scene &, const ReduceOptions &options, const Reduction *made) {
  if (made == nullptr)
    return {stage::condensation,
            "the condensed operator, on a sparse grid over the parameters of A to " +
                short_number(options.condensed.tolerance)};
  const CondensedOperator &condensed = made->bases.condensed;
  std::string what = counted(made->bases.nodal_dual.cols(), "multiplier") +
                     (made->bases.dropped > 0 ? " near contact" : "") + ", " +
                     counted(made->bases.responses, "displacement") + " under unit loads, " +
                     counted(made->bases.factorisations, "factorisation") + ", " +
                     counted(condensed.terms.cols(), "term");
  if (!condensed.grid.axes.empty()) what += ", error " + short_number(condensed.error);
  return {stage::condensation, what};
}

/// Whether the multipliers are not reduced.
bool has_no_functions(const Reducing &at) {
  return !way_of(at.problem.scene(), at.options.multipliers.reduction).dual_basis;
}

/// What `condense` makes of the nodes' dual basis. Responses join the modes where they are what
/// makes displacements as exact as multipliers.
void make_condensed(Reducing &at) {
  Problem &problem = at.problem;
  ReducedBases &bases = at.made.bases;
  const Scene &scene = problem.scene();
  const std::vector<Mu> training = parameters_of(at.samples);
  const Matrix &multipliers = at.multipliers;
  const Matrix &nodal = nodal_dual_of(at);
  CondensedLoads loads = condensed_loads(problem, at.made.affine, training, multipliers, nodal);
  const bool awaits = has_no_functions(at) && awaits_answers(problem, loads, at.options.condensed);
  LinearBasis *modes = has_no_functions(at) && !awaits ? &bases.pod.basis : nullptr;
  // First: how many A these need is told by what they have outside the modes.
  if (!scene.f.empty())
    bases.responses += add_load_responses(problem, at.made.affine, training, bases.pod.basis);
  Condensation made = condense(problem, loads, expand(scene.parameters, training.front()),
                               at.options.condensed, modes, nodal_coefficients(nodal, multipliers));
  bases.condensed = std::move(made.condensed);
  bases.responses += made.responses;
  bases.factorisations = made.factorisations;
  if (awaits) bases.awaiting = std::move(loads);
}

StageNeed condensation_need(const ReductionSize &size) {
  const bool varies = size.axes > 0;
  const double factorisations =
                   size.of_a > 0 ? size.points : std::min(size.points, span_factorisations),
               basis = size.dofs * size.modes / size.ranks;
  return {.numbers = size.responses(size.loads) + (varies ? 6 : 2) * basis +
                     size.square * (varies ? std::min(size.points, 3 * most_terms) : 3),
          .seconds = factorisations * (size.factorisation +
                                       size.factor * size.loads / size.ranks * column_seconds) +
                     1.5 * product_seconds * basis * size.modes};
}

/// The training multipliers that `project` has left in the model become what a query starts from.
void add_starts(ReducedModel &model, const Problem &problem) {
  Matrix starts = model.contact.law->starts;
  LawProblem of_model(model, problem.scene(), problem.contact());
  for (Index p = 0; p < starts.cols(); ++p) {
    const Vector mu = model.contact.law->starts_mu.col(p);
    ReducedAnswer unused;
    const LawAtMu &law = of_model.at(
        expand(problem.scene().parameters, {mu.begin(), mu.end()}), unused,
        model.contact.law->states.size() > 0 ? Vector(model.contact.law->states.col(p)) : Vector());
    starts.col(p) = of_model.at_all_nodes(law, starts.col(p)).start;
  }
  model.contact.law->starts = std::move(starts);
}

/// By the answers of the model: lets the responses that bases.awaiting waits for join the modes, or
/// leaves of those that did what displacements need, where these cost more than the law.
void choose_responses(Reducing &at) {
  ReducedBases &bases = at.made.bases;
  if (bases.awaiting) {
    const ResponseSpace appended = append_answered_responses(
        at.problem, *bases.awaiting, at.made.model, at.options.condensed.answers, bases.pod.basis);
    bases.responses += appended.functions;
    bases.factorisations += appended.points;
    const double numbers =
        static_cast<double>(bases.awaiting->joining()) * at.problem.dofs().total_free;
    if (numbers > at.options.condensed.large_fields)
      bases.left_by_answers = at.options.condensed.answers;
    bases.awaiting.reset();
    at.basis_changed = true;
  } else if (factorises_for_displacements(at.problem, at.made.model)) {
    const Matrix kept = answered_displacements(at.problem, at.made.model);
    if (kept.size() == 0) return;
    rotate(bases.pod.basis, kept);
    bases.responses = static_cast<int>(kept.cols()) - bases.modes;
    at.basis_changed = true;
  }
}

void project_again(Reducing &at) {
  if (!std::exchange(at.basis_changed, false)) return;
  constexpr double of_starts = 1e-4; // where queries start, a large model's need no more digits
  Matrix starts = std::move(at.made.model.contact.law->starts);
  project_bases(at);
  if (at.made.bases.left_by_answers > 0)
    round_entries(starts, of_starts * starts.cwiseAbs().maxCoeff());
  at.made.model.contact.law->starts = std::move(starts);
}

/// All nodes, where contact reaches the edge of those near it.
void keep_all_nodes(Reducing &at, const std::function<void()> &attempt) {
  attempt();
  if (at.unanswered == 0 || at.made.bases.dropped == 0) return;
  at.options.condensed.ring = std::numeric_limits<double>::infinity();
  attempt();
}

StageRow no_pair_row(const Scene &, const ReduceOptions &options, const Reduction *) {
  return {pair_stages,
          "the multipliers keep a coefficient at every node" +
              (options.cone.level > 0
                   ? " of the mesh refined " + counted(options.cone.level, "time") + " less"
                   : std::string()) +
              ": nothing to stabilise",
          StageKind::skipped};
}

std::vector<ReductionStage> law_at_nodes(const Scene &scene, const ReduceOptions &options) {
  std::vector<ReductionStage> list = first_stages(scene, separate_jointly);
  list.push_back(condensation_stage());
  list.push_back({pair_stages, no_pair_row});
  add_projection(scene, project_law, list);
  list.push_back({stage::condensation, nullptr, choose_responses});
  list.push_back({stage::projection, nullptr, project_again});
  add_bounds(options, list);
  list.push_back(self_check_stage());
  return list;
}

Joining responses_join(const Scene &scene, const ReduceOptions &options,
                       const ReductionSize &size) {
  // Where those to answers alone join the modes, with one A and with more.
  constexpr double few_responses = 150, of_more = 3;
  const double stored = size.square * std::min(size.points, most_terms);
  if (options.condensed.responses == 0) return {0, stored};
  if (responses_await(size.loads, size.dofs, size.axes > 0, options.condensed))
    return {few_responses * (size.axes > 0 ? of_more : 1), stored};
  if (size.axes > 0)
    return {size.contact * (split_sum(scene.a, scene.parameters).mapped.empty() ? 1 : 4), stored};
  const bool all = scene.components == 1; // of a membrane all that is beside the rim
  return {size.contact * (all ? 1 : 0.5), stored};
}

} // namespace

const Matrix &nodal_dual_of(Reducing &at) {
  ReducedBases &bases = at.made.bases;
  if (bases.nodal_dual.size() > 0) return bases.nodal_dual;
  const Matrix &multipliers = at.multipliers;
  bases.reduction = at.options.multipliers.reduction;
  bases.mended = at.options.multipliers.exact;
  bases.nodal_dual = nodal_dual_basis(at.problem, multipliers, at.options.cone.level);
  if (!has_no_functions(at) || follows_state(at.problem.scene())) return bases.nodal_dual;
  const std::vector<Index> near = columns_near_contact(at.problem.contact(), bases.nodal_dual,
                                                       multipliers, at.options.condensed.ring);
  bases.dropped = bases.nodal_dual.cols() - std::ssize(near);
  return bases.nodal_dual = bases.nodal_dual(Eigen::all, near).eval();
}

ReductionStage condensation_stage() {
  return {stage::condensation, condensation_row, make_condensed, condensation_need,
          "-response_tolerance 0, -multiplier_reduction cone where there is no friction, or a "
          "coarser mesh (-mesh_refine, -mesh)"};
}

void project_law(Reducing &at) {
  project_bases(at);
  if (at.made.bases.condensed.terms.size() > 0) add_starts(at.made.model, at.problem);
}

const ReductionWay condensed_way{
    .reduction = MultiplierReduction::condensed,
    .name = "condensed",
    .says = "not reduced: the law holds exactly at every node (or mirrored pair of nodes), and the "
            "body enters by its condensed operator B A^-1 B^T, interpolated where A varies; the "
            "most accurate by orders of magnitude",
    .law = true,
    .dual_basis = false,
    .check = [](const Scene &, const ReduceOptions &) {},
    .stages = law_at_nodes,
    .joining = responses_join,
    .repeats = keep_all_nodes};

} // namespace rbvi
