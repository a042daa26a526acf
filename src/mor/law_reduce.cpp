#include "rbvi/mor/stages.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/mor/bases/near_contact.hpp"
#include "rbvi/mor/bases/nodal_dual_basis.hpp"
#include "rbvi/mor/separation/answered_responses.hpp"
#include "rbvi/rom/law/law_solver.hpp"
#include "rbvi/rom/model/affine_coefficients.hpp"

namespace rbvi {

namespace {

/// None without friction.
std::vector<FrictionBound> bounds_at(const Scene &scene, const Contact &contact,
                                     const std::vector<Mu> &set) {
  std::vector<FrictionBound> bounds;
  if (!has_friction(scene)) return bounds;
  for (const Mu &mu : set)
    bounds.push_back(contact.interfaces.front()->bound(expand(scene.parameters, mu)));
  return bounds;
}

} // namespace

MultiplierReduction reduction_of(const Scene &scene, MultiplierReduction chosen) {
  if (chosen != MultiplierReduction::automatic) return chosen;
  return keeps_nodes(scene) ? MultiplierReduction::condensed : MultiplierReduction::cone;
}

bool keeps_law(MultiplierReduction reduction) {
  return reduction >= MultiplierReduction::condensed;
}

void check_reduction(const Scene &scene, const ReduceOptions &options) {
  const MultiplierReduction reduction = reduction_of(scene, options.multipliers.reduction);
  if (!has_multipliers(scene)) return;
  if (reduction == MultiplierReduction::cone && has_friction(scene))
    throw bad_input("-multiplier_reduction cone is for contact without friction: use condensed, "
                    "collocated, cones or joint");
  if (reduction == MultiplierReduction::condensed) return;
  if (follows_state(scene) && keeps_law(reduction))
    throw bad_input("contact that follows the displacement is reduced by -multiplier_reduction "
                    "condensed, or without friction by cone");
  if (!keeps_law(reduction)) return;
  if (scene.contacts.size() > 1)
    throw bad_input("several contact interfaces have laws of their own: use -multiplier_reduction "
                    "condensed, or cone without friction");
  if (!separable_contact(scene))
    throw bad_input("B of this contact does not separate: use -multiplier_reduction cone or "
                    "condensed");
  if (!has_friction(scene) && reduction != MultiplierReduction::collocated)
    throw bad_input("the scene has no friction: use -multiplier_reduction condensed or collocated");
  if (options.cone.type == ConeType::hybrid && reduction != MultiplierReduction::joint)
    throw bad_input("-cone_type hybrid has functions of either sign: use mcpg with "
                    "-multiplier_reduction " +
                    multiplier_reduction_names()[static_cast<std::size_t>(reduction)]);
}

ReducedBases build_law_bases(Problem &problem, const std::vector<Sample> &samples,
                             const ReduceOptions &options, const AffineOperators &affine,
                             StageTable &stages) {
  const Matrix multipliers = multipliers_of(samples);
  const Scene &scene = problem.scene();
  const MultiplierOptions &choice = options.multipliers;
  const bool collocated = choice.reduction == MultiplierReduction::collocated;
  std::vector<Mu> training = parameters_of(samples);
  ReducedBases bases;
  bases.reduction = choice.reduction;
  bases.mended = choice.exact;
  add_modes(problem, samples, options.pod, bases, stages);
  bases.nodal_dual = nodal_dual_basis(problem, multipliers, options.cone.level);
  if (choice.reduction == MultiplierReduction::condensed && !follows_state(scene)) {
    const std::vector<Index> near = columns_near_contact(problem.contact(), bases.nodal_dual,
                                                         multipliers, options.condensed.ring);
    bases.dropped = bases.nodal_dual.cols() - std::ssize(near);
    bases.nodal_dual = bases.nodal_dual(Eigen::all, near).eval();
  }
  const Matrix &nodal = bases.nodal_dual;
  if (will_run(stages, stage::condensation)) {
    const Stage stage(stages, stage::condensation);
    LinearBasis *modes = choice.exact && !collocated ? &bases.pod.basis : nullptr;
    CondensedLoads loads = condensed_loads(problem, affine, training, multipliers, nodal);
    const bool awaits = choice.reduction == MultiplierReduction::condensed && modes != nullptr &&
                        awaits_answers(problem, loads, options.condensed);
    if (awaits) modes = nullptr;
    Condensation made =
        condense(problem, loads, separable_contact(scene) ? nodal.cols() : loads.columns.cols(),
                 expand(scene.parameters, training.front()), options.condensed, modes,
                 nodal_coefficients(nodal, multipliers));
    bases.condensed = std::move(made.condensed);
    bases.responses = made.responses;
    if (!scene.f.empty())
      bases.responses += add_load_responses(problem, affine, training, bases.pod.basis);
    bases.factorisations = made.factorisations;
    if (awaits) bases.awaiting = std::move(loads);
  }
  if (!will_run(stages, stage::multipliers)) return bases;
  {
    const Stage stage(stages, stage::multipliers);
    const SparseMatrix w = (nodal.transpose() * problem.w_product() * nodal).sparseView();
    bases.multipliers =
        make_multiplier_basis(nodal_coefficients(nodal, multipliers), w,
                              bounds_at(scene, problem.contact(), training), choice, options.cone);
  }
  if (!will_run(stages, stage::pga)) return bases;
  std::vector<ContactPoint> points = contact_points(samples);
  if (affine.b_size() == 1) points.resize(1);
  const Mu reference = options.reference.empty() ? box_centre(scene.parameters) : options.reference;
  add_supremizers(problem, points, reference, options,
                  multiplier_functions(nodal, bases.multipliers.basis), bases, stages);
  return bases;
}

void add_starts(ReducedModel &model, const Problem &problem) {
  Matrix starts = model.law->starts;
  LawSolver solver(model, problem.scene(), problem.contact());
  for (Index p = 0; p < starts.cols(); ++p) {
    const Vector mu = model.law->starts_mu.col(p);
    starts.col(p) =
        solver.start_of(expand(problem.scene().parameters, {mu.begin(), mu.end()}), starts.col(p),
                        model.law->states.size() > 0 ? Vector(model.law->states.col(p)) : Vector());
  }
  model.law->starts = std::move(starts);
}

void compress_responses(Problem &problem, const std::vector<Sample> &samples,
                        const AffineOperators &affine, double tolerance, ReducedBases &bases,
                        ReducedModel &model, StageTable &stages) {
  timed(stages, stage::condensation, [&] {
    bases.responses +=
        append_answered_responses(problem, *bases.awaiting, model, tolerance, bases.pod.basis);
    ++bases.factorisations;
  });
  bases.awaiting.reset();
  const Stage stage(stages, stage::projection);
  Matrix starts = std::move(model.law->starts);
  model = project(problem, samples, affine, bases);
  model.law->starts = std::move(starts);
}

Gcns collocate(ReducedModel &model, const Problem &problem, const std::vector<Sample> &samples,
               const GcnsOptions &options) {
  const Scene &scene = problem.scene();
  NodalLaw &law = *model.law;
  LawSolver solver(model, problem.scene(), problem.contact());
  const Index nodes = law.normal;
  const Matrix &nodal = model.dual_basis;
  const Matrix coefficients = nodal_coefficients(nodal, multipliers_of(samples));
  std::vector<GcnsSample> problems;
  for (std::size_t p = 0; p < samples.size(); ++p) {
    const FullMu all = expand(scene.parameters, samples[p].mu);
    LawAnswer unused;
    const BodyAtMu body = solver.body_at(all, unused);
    CollocatedProblem reduced = collocated_problem(law.basis, body);
    problems.push_back({std::move(reduced.h), std::move(reduced.q), body.bound,
                        coefficients.col(static_cast<Index>(p)).tail(nodes)});
  }
  const SparseMatrix w = (nodal.transpose() * problem.w_product() * nodal).sparseView();
  Gcns selected = select_collocation_nodes(problems, law.basis.normal, law.basis.tangential,
                                           w.block(nodes, nodes, nodes, nodes), options);
  law.basis.nodes = selected.nodes;
  return selected;
}

} // namespace rbvi
