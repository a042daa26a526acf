// Niakh (2022): (3.39).
#include "rbvi/core/error.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/model/affine_coefficients.hpp"
#include "rbvi/model/law_problem.hpp"
#include "rbvi/mor/answered_responses.hpp"
#include "rbvi/mor/nodal_dual_basis.hpp"
#include "rbvi/mor/pod.hpp"
#include "rbvi/mor/reduce.hpp"
#include "rbvi/par/small_svd.hpp"

namespace rbvi {

namespace {

SparseMatrix block(const SparseMatrix &product, Index first, Index count) {
  return product.block(first, first, count, count);
}

/// Modes of snapshots, orthonormal in `product`: as few as hold the tolerance.
struct DenseModes {
  Matrix columns;
  std::vector<double> error; ///< e(n), n = 0, 1, ..., rank: root of sum of squares, relative
};

/// QR, then SVD of the small factor.
DenseModes dense_pod(const Matrix &snapshots, const SparseMatrix &product, double tolerance) {
  const Matrix factor = product_factor(product);
  const SmallSvd svd = small_svd(factor * snapshots);
  DenseModes modes;
  modes.error = projection_errors(svd.values);
  Index count = 1;
  while (count < svd.values.size() && modes.error[count] > tolerance)
    ++count;
  modes.columns = svd.left.leftCols(count);
  factor.triangularView<Eigen::Upper>().solveInPlace(modes.columns);
  return modes;
}

} // namespace

Matrix multiplier_functions(const Matrix &nodal, const MultiplierBasis &basis) {
  return nodal * multiplier_coefficients(basis);
}

MultiplierBases make_multiplier_basis(const Matrix &coefficients, Index normal,
                                      const SparseMatrix &product, double tangential,
                                      const ConeOptions &cone) {
  MultiplierBases bases;
  const Index tangents = coefficients.rows() - normal;
  const Matrix tractions = coefficients.bottomRows(tangents);
  if (tangents > 0 && tractions.isZero(0))
    throw failure("no snapshot has a tangential stress: use -multiplier_reduction condensed");
  Cone found = build_cone(coefficients.topRows(normal), block(product, 0, normal), cone);
  bases.basis.normal = std::move(found.basis.generators);
  bases.normal = std::move(found.history);
  if (tangents == 0) return bases;
  DenseModes modes = dense_pod(tractions, block(product, normal, tangents), tangential);
  bases.basis.tangential = std::move(modes.columns);
  bases.tangential = std::move(modes.error);
  return bases;
}

MultiplierReduction reduction_of(const Scene &scene, MultiplierReduction chosen) {
  if (!has_multipliers(scene)) return MultiplierReduction::none;
  if (chosen != MultiplierReduction::automatic) return chosen;
  return keeps_nodes(scene) ? MultiplierReduction::condensed : MultiplierReduction::cone;
}

bool keeps_law(MultiplierReduction reduction) {
  return reduction == MultiplierReduction::condensed ||
         reduction == MultiplierReduction::collocated;
}

void check_reduction(const Scene &scene, const ReduceOptions &options) {
  const MultiplierReduction reduction = reduction_of(scene, options.multipliers.reduction);
  if (reduction == MultiplierReduction::cone && has_friction(scene))
    throw bad_input("-multiplier_reduction cone is for contact without friction: use condensed, "
                    "collocated");
  if (reduction != MultiplierReduction::collocated) return;
  if (follows_state(scene))
    throw bad_input(
        "H of contact that follows the displacement changes with every step, so that it "
        "has no terms on fewer functions: use -multiplier_reduction condensed, or "
        "without friction cone");
  if (options.cone.type == ConeType::hybrid)
    throw bad_input("-cone_type hybrid has functions of either sign: use mcpg with "
                    "-multiplier_reduction collocated");
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
  if (!collocated && !follows_state(scene)) {
    const std::vector<Index> near = columns_near_contact(problem.contact(), bases.nodal_dual,
                                                         multipliers, options.condensed.ring);
    bases.dropped = bases.nodal_dual.cols() - std::ssize(near);
    bases.nodal_dual = bases.nodal_dual(Eigen::all, near).eval();
  }
  const Matrix &nodal = bases.nodal_dual;
  if (will_run(stages, stage::condensation)) {
    const Stage stage(stages, stage::condensation);
    CondensedLoads loads = condensed_loads(problem, affine, training, multipliers, nodal);
    const bool awaits = !collocated && awaits_answers(problem, loads, options.condensed);
    LinearBasis *modes = collocated || awaits ? nullptr : &bases.pod.basis;
    Condensation made = condense(problem, loads, expand(scene.parameters, training.front()),
                                 options.condensed, modes, nodal_coefficients(nodal, multipliers));
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
    bases.multipliers = make_multiplier_basis(
        nodal_coefficients(nodal, multipliers),
        laws_of_columns(problem.contact(), nodal).laws.nodes(), w, choice.tangential, options.cone);
  }
  if (!will_run(stages, stage::pga)) return bases;
  std::vector<ContactPoint> points = contact_points(samples);
  if (affine.b_size() == 1) points.resize(1);
  add_supremizers(problem, points, options, multiplier_functions(nodal, bases.multipliers.basis),
                  bases, stages);
  return bases;
}

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

void compress_responses(Problem &problem, const std::vector<Sample> &samples,
                        const AffineOperators &affine, ReducedBases &bases, ReducedModel &model,
                        StageTable &stages) {
  if (!bases.awaiting && !factorises_for_displacements(problem, model)) return;
  {
    const Stage stage(stages, stage::condensation);
    if (bases.awaiting) {
      bases.responses += append_answered_responses(problem, *bases.awaiting, model,
                                                   answered_tolerance, bases.pod.basis);
      ++bases.factorisations;
      bases.awaiting.reset();
    } else {
      const Matrix kept = answered_displacements(problem, model);
      if (kept.size() == 0) return;
      rotate(bases.pod.basis, kept);
      bases.responses = static_cast<int>(kept.cols()) - bases.modes;
    }
  }
  const Stage stage(stages, stage::projection);
  Matrix starts = std::move(model.contact.law->starts);
  model = project(problem, samples, affine, bases);
  model.contact.law->starts = std::move(starts);
}

Gcns collocate(ReducedModel &model, const Problem &problem, const std::vector<Sample> &samples,
               const GcnsOptions &options) {
  const Scene &scene = problem.scene();
  NodalLaw &law = *model.contact.law;
  LawProblem of_model(model, problem.scene(), problem.contact());
  const Index normal = law.normal, tangential = model.contact.generators - normal;
  const std::vector<Index> nodes =
      nodes_with_tangent(laws_of_columns(problem.contact(), model.contact.dual_basis).laws);
  const Matrix &nodal = model.contact.dual_basis;
  const Matrix coefficients = nodal_coefficients(nodal, multipliers_of(samples));
  std::vector<GcnsSample> problems;
  for (std::size_t p = 0; p < samples.size(); ++p) {
    const FullMu all = expand(scene.parameters, samples[p].mu);
    ReducedAnswer unused;
    const LawAtMu &at_mu = of_model.at(all, unused);
    CollocatedProblem reduced = collocated_problem(law.basis, at_mu, of_model.body());
    problems.push_back({std::move(reduced.h), std::move(reduced.q),
                        bounds_at(at_mu.laws.bound, nodes), coefficients.col(p).tail(tangential)});
  }
  const SparseMatrix w = (nodal.transpose() * problem.w_product() * nodal).sparseView();
  Gcns selected =
      select_collocation_nodes(problems, law.basis.normal(nodes, Eigen::all), law.basis.tangential,
                               w.block(normal, normal, tangential, tangential), options);
  for (int &node : selected.nodes)
    node = static_cast<int>(nodes[node]);
  law.basis.nodes = selected.nodes;
  return selected;
}

} // namespace rbvi
