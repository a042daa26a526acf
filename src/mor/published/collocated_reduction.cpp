// The published reduction of the law at nodes: a cone for lambda_n, modes for lambda_tau, the bound
// of friction at collocation nodes. Niakh (2022): (3.39).
#include "../shared_stages.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/model/affine_coefficients.hpp"
#include "rbvi/model/published/collocated_problem.hpp"
#include "rbvi/mor/nodal_dual_basis.hpp"
#include "rbvi/mor/pod.hpp"
#include "rbvi/mor/published/gcns.hpp"
#include "rbvi/mor/published/reductions.hpp"
#include "rbvi/par/small_svd.hpp"
#include "reductions.hpp"

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

/// A cone of lambda_n and, with friction, modes of lambda_tau: as few as leave `tangential`.
/// `coefficients`: m x P, `normal` rows of lambda_n first; without friction they are all.
/// `product`: m x m, its blocks of lambda_n and lambda_tau. Throws failure where the snapshots have
/// no tangential stress at all.
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

} // namespace

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

namespace {

/// The functions of the multipliers.
std::string multiplier_text(const Reduction *made) {
  if (made == nullptr) return "collocated";
  const MultiplierBasis &basis = made->bases.multipliers.basis;
  const std::string normal =
      "collocated: R = " + counted(basis.normal.cols(), "function") + " >= 0";
  if (basis.tangential.size() == 0) return normal;
  return normal + ", S = " + counted(basis.tangential.cols(), "mode");
}

/// B^n and B^tau apart, of one interface. Else B is seen in the condensed operator alone, which
/// grows with the square of the number of its terms.
void separate_rows(Reducing &at) {
  const ReduceOptions &options = at.options;
  if (at.problem.scene().contacts.size() > 1) return separate_jointly(at);
  RowOptions apart{options.eim, options.eim};
  apart.normal.tolerance = options.eim_normal.value_or(options.eim.tolerance);
  apart.tangential.tolerance = options.eim_tangential.value_or(options.eim.tolerance);
  at.made.affine = separate(at.problem, parameters_of(at.samples), options.eim, apart);
}

void make_functions(Reducing &at) {
  const Matrix &nodal = nodal_dual_of(at);
  const SparseMatrix w = (nodal.transpose() * at.problem.w_product() * nodal).sparseView();
  at.made.bases.multipliers =
      make_multiplier_basis(nodal_coefficients(nodal, at.multipliers),
                            laws_of_columns(at.problem.contact(), nodal).laws.nodes(), w,
                            at.options.multipliers.tangential, at.options.cone);
}

void choose_nodes(Reducing &at) {
  at.made.collocation = collocate(at.made.model, at.problem, at.samples, at.options.gcns);
  const Gcns &nodes = at.made.collocation;
  auto &histories = at.made.model.made.histories;
  histories["gcns/nodes"] = {nodes.count.begin(), nodes.count.end()};
  histories["gcns/error"] = nodes.error;
  histories["gcns/violation"] = nodes.violation;
}

StageRow collocation_row(const Scene &, const ReduceOptions &, const Reduction *made) {
  return {stage::collocation, made == nullptr
                                  ? "greedy (Algorithm 3), reduced problems solved exactly"
                                  : counted(std::ssize(made->collocation.nodes), "node") + ": " +
                                        made->collocation.reason};
}

std::vector<ReductionStage> law_on_functions(const Scene &scene, const ReduceOptions &options) {
  std::vector<ReductionStage> list = first_stages(scene, separate_rows);
  if (options.multipliers.exact)
    list.push_back(condensation_stage());
  else
    list.push_back(
        {stage::condensation, [](const Scene &, const ReduceOptions &, const Reduction *) {
           return StageRow{stage::condensation, "not wanted (-multiplier_exact no)",
                           StageKind::skipped};
         }});
  list.push_back({stage::multipliers,
                  [](const Scene &, const ReduceOptions &, const Reduction *made) {
                    return StageRow{stage::multipliers, multiplier_text(made)};
                  },
                  make_functions,
                  [](const ReductionSize &size) {
                    return StageNeed{3 * size.multipliers * size.multipliers};
                  }});
  add_supremizer_stages(options, list);
  add_projection(scene, project_law, list);
  if (has_friction(scene)) list.push_back({stage::collocation, collocation_row, choose_nodes});
  add_bounds(options, list);
  list.push_back(self_check_stage());
  return list;
}

void check_collocated(const Scene &scene, const ReduceOptions &options) {
  if (follows_state(scene))
    throw bad_input(
        "H of contact that follows the displacement changes with every step, so that it "
        "has no terms on fewer functions: use -multiplier_reduction condensed, or "
        "without friction cone");
  if (options.cone.type == ConeType::hybrid)
    throw bad_input("-cone_type hybrid has functions of either sign: use mcpg with "
                    "-multiplier_reduction collocated");
}

} // namespace

const ReductionWay collocated_way{
    .reduction = MultiplierReduction::collocated,
    .name = "collocated",
    .says = "the published method: a cone (-cone_type mcpg) for lambda_n, modes for lambda_tau, "
            "supremizers, the friction bound at nodes chosen greedily (Algorithm 3), B^n and B^tau "
            "interpolated apart unless B is a multiple of one form; without friction the cone and "
            "B^n alone",
    .law = true,
    .dual_basis = true,
    .check = check_collocated,
    .stages = law_on_functions,
    .joining = supremizers_join};

} // namespace rbvi
