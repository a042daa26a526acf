#include "rbvi/model/nitsche_solver.hpp"

#include "nitsche_system.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/model/packed.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace rbvi {

namespace {

using ChosenPoints = std::vector<std::pair<int, double>>;

/// The points that the model integrates at; none where it interpolates.
ChosenPoints points_of(const NitscheModel &nitsche, const NitscheLayer &layer) {
  ChosenPoints chosen;
  if (nitsche.rule == CurveRule::empirical)
    for (std::size_t k = 0; k < nitsche.points.size(); ++k)
      chosen.emplace_back(nitsche.points[k], nitsche.factors[static_cast<Index>(k)]);
  else if (nitsche.rule == CurveRule::full)
    for (int k = 0; k < 4 * static_cast<int>(layer.cells.size()); ++k)
      chosen.emplace_back(k, 1.0);
  return chosen;
}

/// All points of the curve. Where scene and mesh are symmetric, so that the points of the model lie
/// on one half, which stands for both: those of that half, which count twice.
ChosenPoints whole_curve(const NitscheModel &nitsche, const NitscheLayer &layer) {
  const Vector x = point_abscissae(layer.cells);
  const bool half = is_symmetric(layer.scene) && nitsche.rule == CurveRule::empirical &&
                    std::all_of(nitsche.points.begin(), nitsche.points.end(),
                                [&](int point) { return x[point] < 0; });
  ChosenPoints chosen;
  for (Index point = 0; point < x.size(); ++point)
    if (!half || x[point] < 0) chosen.emplace_back(static_cast<int>(point), half ? 2.0 : 1.0);
  return chosen;
}

} // namespace

std::map<CurveRule, InterpolatedCurveMaker> &interpolated_curves() {
  static std::map<CurveRule, InterpolatedCurveMaker> list;
  return list;
}

ReducedNitsche::ReducedNitsche(const ReducedModel &model, NitscheLayer layer,
                               const QueryOptions &options)
    : model_(model), layer_(std::move(layer)), body_(model, layer_.scene),
      consistency_(model.contact.nitsche->consistency, layer_.cells),
      starts_(layer_.scene.parameters, model.contact.nitsche->starts_mu),
      from_rest_(options.method == OnlineMethod::newton) {
  system_ =
      std::make_unique<System>(model, layer_.cells, points_of(*model.contact.nitsche, layer_));
  if (model.contact.nitsche->rule == CurveRule::interpolated)
    interpolated_ = entered(interpolated_curves(), CurveRule::interpolated,
                            "-nitsche_quadrature interpolated")(model, layer_);
  else if (from_rest_)
    throw bad_input(
        "Newton's method from rest is for models by -nitsche_quadrature interpolated: ask "
        "this one by the method exact");
}

ReducedNitsche::~ReducedNitsche() = default;

ReducedNitsche::Quadratic ReducedNitsche::quadratic_at(const FullMu &all_parameters) const {
  BodyAtMu body(body_);
  body.set(all_parameters);
  Quadratic result{body.stiffness(), {}, body.load()};
  const std::vector<NitscheFace> faces =
      nitsche_faces(layer_, all_parameters, selected(layer_.cells, consistency_.cells()));
  const Vector theta = consistency_.of_blocks(nitsche_consistency(faces));
  result.a_gamma = result.a + unpacked(model_.contact.nitsche->consistency.reduced * theta,
                                       model_.primal_size());
  return result;
}

ReducedNitsche::System &ReducedNitsche::system_at(const FullMu &all_parameters) {
  system_->mu.clear(); // until its quadratic is there
  system_->quadratic = quadratic_at(all_parameters);
  system_->mu = all_parameters;
  return *system_;
}

ReducedAnswer ReducedNitsche::answer_of(const System &system, int iterations) const {
  ReducedAnswer answer;
  answer.mu = system.mu;
  answer.u = system.u;
  answer.residual = system.relative;
  answer.iterations = iterations;
  answer.energy =
      0.5 * answer.u.dot(system.quadratic.a * answer.u) - system.quadratic.f.dot(answer.u);
  return answer;
}

ReducedAnswer ReducedNitsche::solve(const FullMu &all_parameters, Relaxed) {
  System &system = system_at(all_parameters);
  const NitscheModel &nitsche = *model_.contact.nitsche;
  int iterations = 0;
  if (interpolated_) {
    InterpolatedAnswer found = interpolated_->solve(
        all_parameters, from_rest_ ? Vector() : starts_.fit(nitsche.starts, all_parameters),
        system.quadratic.a_gamma, system.quadratic.f);
    system.u = std::move(found.u);
    system.relative = found.residual;
    iterations = found.iterations;
  } else {
    system.set_points(layer_, all_parameters);
    system.predict(starts_.fit(nitsche.starts, all_parameters),
                   starts_.fit(nitsche.states, all_parameters));
    iterations = system.settle();
  }
  return answer_of(system, iterations);
}

std::optional<ReducedAnswer> ReducedNitsche::near(const ReducedAnswer &from, const FullMu &mu) {
  if (interpolated_) return {};
  System &system = system_at(mu);
  system.set_points(layer_, mu);
  system.set(from.u);
  system.set_bounds();
  // The curvatures of the points tell what touches and what sticks.
  const auto curvatures = [&] {
    return system.terms.weighted(&PointTerm::curvature, system.pressures, system.bounds);
  };
  const Vector before = curvatures();
  const int iterations = system.settle();
  ReducedAnswer answer = answer_of(system, iterations);
  answer.passes_kink = ((before.array() != 0) != (curvatures().array() != 0)).any();
  return answer;
}

Matrix ReducedNitsche::point_residuals() const {
  const System &system = *system_;
  const Vector slopes = system.terms.weighted(&PointTerm::slope, system.pressures, system.bounds);
  Matrix result =
      system.functionals.leftCols(system.points) * slopes.head(system.points).asDiagonal();
  if (system.bounds.size() > 0)
    result += system.functionals.rightCols(system.points) * slopes.tail(system.points).asDiagonal();
  return result;
}

Matrix ReducedNitsche::tangent() const {
  return system_->tangent_at(system_->pressures);
}

Vector ReducedNitsche::multiplier(const FullMu &all_parameters, const Vector &u) const {
  return nitsche_multiplier(layer_, all_parameters, model_.contact.trace * u);
}

Vector ReducedNitsche::over_whole_curve(const FullMu &all_parameters,
                                        const std::vector<NitscheFace> &faces, const Vector &u,
                                        Outputs &outputs) const {
  if (model_.contact.nitsche->rule == CurveRule::full) return u;
  if (!whole_)
    whole_ = std::make_unique<System>(model_, layer_.cells,
                                      whole_curve(*model_.contact.nitsche, layer_));
  whole_->quadratic =
      system_->mu == all_parameters ? system_->quadratic : quadratic_at(all_parameters);
  whole_->set_points(layer_, all_parameters, faces);
  whole_->set(u);
  whole_->set_bounds();
  (void)whole_->residual();
  outputs.quadrature_residual = whole_->relative;
  (void)whole_->settle();
  return whole_->u;
}

void ReducedNitsche::outputs(const FullMu &all_parameters, const Vector &u,
                             Outputs &outputs) const {
  std::vector<NitscheFace> faces = nitsche_faces(layer_, all_parameters, layer_.cells);
  const Vector on_layer =
      model_.contact.trace * over_whole_curve(all_parameters, faces, u, outputs);
  turn_to(layer_, all_parameters, on_layer, faces);
  const Matrix pressures = nitsche_pressures(faces, on_layer);
  nitsche_outputs(layer_, all_parameters, faces, on_layer, pressures,
                  nitsche_bounds(faces, pressures), outputs);
}

} // namespace rbvi
