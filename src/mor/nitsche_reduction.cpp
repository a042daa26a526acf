// The reduction of Nitsche's method: modes alone, then the curve.
#include "rbvi/core/text.hpp"
#include "rbvi/model/print.hpp"
#include "shared_stages.hpp"

#include <array>

namespace rbvi {

namespace {

/// The coefficients of each sample in the modes, n x P.
Matrix coefficients_of(const Problem &problem, const std::vector<Sample> &samples,
                       const LinearBasis &modes) {
  Matrix result(modes.size(), std::ssize(samples));
  for (std::size_t p = 0; p < samples.size(); ++p)
    RBVI_CALL(BVDotVec(modes.columns.get(),
                       from_natural(problem.dofs(), displacement(problem.comm(), samples[p])).get(),
                       result.col(p).data()));
  return result;
}

void add_histories(const CurveReport &curve,
                   std::map<std::string, std::vector<double>> &histories) {
  histories["curve/points"] = {curve.points.begin(), curve.points.end()};
  histories["curve/error"] = curve.error;
  if (curve.states == 0) return;
  histories["curve/states"] = {static_cast<double>(curve.states)};
  constexpr std::array operators{"contact_matrix", "contact_vector", "friction_matrix",
                                 "friction_vector"};
  for (std::size_t k = 0; k < operators.size(); ++k) {
    const std::string name = std::string("curve/") + operators[k];
    const EimErrors &errors = curve.eim_errors[k];
    if (!errors.training.empty()) histories[name] = errors.training;
    if (!errors.validation.empty()) histories[name + "_validation"] = errors.validation;
    if (!errors.converged.empty()) histories[name + "_converged"] = errors.converged;
  }
}

StageRow curve_row(const Scene &, const ReduceOptions &options, const Reduction *made) {
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
  return {stage::contact_curve, what};
}

void integrate_curve(Reducing &at) {
  const ReducedBases &bases = at.made.bases;
  const CurveOptions &options = at.options.curve;
  Matrix coefficients;
  if (options.rule == CurveRule::interpolated || layer_of(at.problem.contact()).follows_state())
    coefficients = coefficients_of(at.problem, at.samples, bases.pod.basis);
  at.made.curve = reduce_curve(at.problem, at.samples, coefficients, bases.pod.error[bases.modes],
                               options, at.made.model);
  add_histories(at.made.curve, at.made.model.made.histories);
}

void project_modes(Reducing &at) {
  at.made.bases.nodal_dual.resize(at.problem.dual_size(), 0);
  project_bases(at);
}

std::vector<ReductionStage> modes_alone(const Scene &scene, const ReduceOptions &) {
  std::vector<ReductionStage> list = first_stages(scene, separate_jointly);
  list.push_back(
      {pair_stages, [](const Scene &, const ReduceOptions &, const Reduction *) {
         return StageRow{pair_stages, "Nitsche's method has no multipliers", StageKind::skipped};
       }});
  add_projection(scene, project_modes, list);
  list.push_back({stage::contact_curve, curve_row, integrate_curve, [](const ReductionSize &size) {
                    return StageNeed{6 * size.multipliers * size.samples * size.samples};
                  }});
  list.push_back(self_check_stage());
  return list;
}

} // namespace

const ReductionWay nitsche_way{.reduction = MultiplierReduction::none,
                               .name = "",

                               .says = "",
                               .law = false,
                               .dual_basis = false,
                               .check =
                                   [](const Scene &, const ReduceOptions &options) {
                                     if (options.curve.rule == CurveRule::interpolated)
                                       (void)entered(term_interpolations(), options.curve.rule,
                                                     interpolated_name);
                                   },
                               .stages = modes_alone,
                               .joining = [](const Scene &, const ReduceOptions &,
                                             const ReductionSize &) { return Joining(); }};

} // namespace rbvi
