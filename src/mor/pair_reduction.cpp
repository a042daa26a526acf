// A reduced pair of spaces: modes with supremizers, and a cone of functions of the multipliers.
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/mor/held_multipliers.hpp"
#include "rbvi/mor/nodal_dual_basis.hpp"
#include "rbvi/par/collective.hpp"
#include "shared_stages.hpp"

#include <algorithm>
#include <utility>

namespace rbvi {

namespace {

using enum StageKind;

Cone build_dual_basis(Problem &problem, const Mu &reference, const Matrix &snapshots,
                      ConeOptions options) {
  if (options.level > 0) options.hats = hats_of_level(problem, options.level);
  if (options.type != ConeType::hybrid) return build_cone(snapshots, problem.w_product(), options);
  const HoldingMultipliers hold = holding(problem, problem.assemble(reference));
  return build_cone(snapshots, problem.w_product(), options, hold);
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
      "R = " + counted(found.basis.generators.cols(), "function") + " >= 0" +
          (modes > 0 ? " + " + std::to_string(modes) + " of either sign" : "") + " (" + name +
          "), error " + short_number(found.history.error.back()) + ", " + found.history.reason +
          (made->ring > cone.ring ? ", widened to a ring of " + std::to_string(made->ring) : "")};
}

constexpr StageName sweep_of_supremizers("supremizers at all mu");

StageRow sweep_of_supremizers_row(const Scene &scene, const ReduceOptions &options,
                                  const Reduction *made) {
  if (options.enrichment == Enrichment::decorrelated)
    return {sweep_of_supremizers, "no supremizers are wanted", skipped};
  const bool separable = separable_contact(scene);
  if (made == nullptr && separable) return {sweep_of_supremizers, "unless B(mu) = s(mu) B", part};
  if (separable && made->affine.b_size() == 1)
    return {sweep_of_supremizers, "B(mu) = s(mu) B: one set and one SVD serve all mu", skipped};
  return {sweep_of_supremizers,
          follows_state(scene) ? "B depends on mu and the step of the iteration: part of PGA"
                               : "B depends on mu: part of PGA",
          part};
}

/// ContactModel::starts. Collective.
void add_starts_of_pair(const Problem &problem, const std::vector<Mu> &training,
                        ReducedModel &model) {
  Matrix starts = Matrix::Zero(model.contact.generators, std::ssize(training));
  OnlineSolver solver(model, problem.scene());
  take_turns(problem.comm(), training.size(), [&](std::size_t p) {
    try {
      starts.col(static_cast<Index>(p)) = solver.solve(training[p]).lambda;
    } catch (const Error &) { // has no answer
    }
  });
  over_ranks(problem.comm(), MPI_SUM, starts);
  model.contact.starts = std::move(starts);
}

/// A pair whose answers are checked. The zones of a hybrid cone are those of the training samples:
/// where contact opens or closes between them, its layers of nodes are doubled until every query is
/// answered, or until all nodes are in the zones; the narrowest ring that answers most is kept. A
/// training set without the corners of the box does not know how far contact reaches: at least one.
/// A bound of the size of the cone bounds its ring as well; without supremizers its ring is not why
/// queries have no answer.
void widen(Reducing &at, const std::function<void()> &attempt) {
  constexpr int widest = 64;
  ConeOptions &cone = at.options.cone;
  const bool widens = cone.type == ConeType::hybrid && cone.max_size == 0 &&
                      at.options.enrichment != Enrichment::decorrelated;
  if (widens && cone.ring == 0 &&
      !holds_corners(at.problem.scene().parameters, parameters_of(at.samples)))
    cone.ring = 1;
  const auto hats = [&] { return at.made.bases.cone.basis.generators.cols(); };
  const auto wrong = [&] { return at.met ? 0 : std::max(1, at.unanswered); };
  attempt();
  int ring = cone.ring, best = ring, fewest = wrong();
  while (widens && fewest > 0 && cone.ring < widest) {
    const Index before = hats();
    const int last = std::exchange(cone.ring, std::max(1, 2 * cone.ring));
    attempt();
    ring = hats() == before ? last : cone.ring;
    if (ring == last) break; // the same pair
    if (wrong() < fewest) {
      fewest = wrong();
      best = ring;
    }
  }
  if (ring != best) {
    cone.ring = ring = best;
    attempt();
  }
  at.made.ring = ring;
  const Stage stage(at.made.stages, stage::self_check);
  add_starts_of_pair(at.problem, parameters_of(at.samples), at.made.model);
}

std::vector<ReductionStage> pair_of_spaces(const Scene &scene, const ReduceOptions &options) {
  std::vector<ReductionStage> list = first_stages(scene, separate_jointly);
  list.push_back({stage::cone,
                  [](const Scene &, const ReduceOptions &of, const Reduction *made) {
                    return cone_row(of, made);
                  },
                  [](Reducing &at) {
                    at.made.bases.cone =
                        build_dual_basis(at.problem, reference_of(at.problem, at.options),
                                         at.multipliers, at.options.cone);
                  },
                  [](const ReductionSize &size) {
                    return StageNeed{.numbers = generators_of(size),
                                     .seconds = size.factorisation +
                                                size.multipliers * size.factor * column_seconds};
                  }});
  add_supremizer_stages(options, list);
  list.push_back({sweep_of_supremizers, sweep_of_supremizers_row});
  add_projection(scene, project_bases, list);
  add_bounds(options, list);
  list.push_back(self_check_stage());
  return list;
}

} // namespace

const ReductionWay cone_way{
    .reduction = MultiplierReduction::cone,
    .name = "cone",
    .says = "a cone of functions (-cone_type), made stable by supremizers; without friction",
    .law = false,
    .dual_basis = true,
    .check =
        [](const Scene &scene, const ReduceOptions &) {
          if (has_friction(scene))
            throw bad_input("-multiplier_reduction cone is for contact without friction: use "
                            "condensed, collocated");
        },
    .stages = pair_of_spaces,
    .joining = supremizers_join,
    .repeats = widen};

} // namespace rbvi
