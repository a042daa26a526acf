// The reduction of Nitsche's method: modes alone, then the curve.
#include "rbvi/mor/reduce.hpp"

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

} // namespace

void reduce_nitsche(Problem &problem, const std::vector<Sample> &samples,
                    const ReduceOptions &options, Reduction &result) {
  add_modes(problem, samples, options.pod, result.bases, result.stages);
  result.bases.nodal_dual.resize(problem.dual_size(), 0);
  result.model = timed(result.stages, stage::projection,
                       [&] { return project(problem, samples, result.affine, result.bases); });
  const Stage stage(result.stages, stage::contact_curve);
  const double left = result.bases.pod.error[result.bases.modes];
  Matrix coefficients;
  if (options.curve.rule == CurveRule::interpolated || layer_of(problem.contact()).follows_state())
    coefficients = coefficients_of(problem, samples, result.bases.pod.basis);
  result.curve = reduce_curve(problem, samples, coefficients, left, options.curve, result.model);
  add_histories(result.curve, result.model.made.histories);
}

} // namespace rbvi
