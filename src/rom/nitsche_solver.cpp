#include "rbvi/rom/nitsche_solver.hpp"

#include "nitsche_interpolated.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/rom/local_fit.hpp"
#include "rbvi/rom/online.hpp"
#include "rbvi/rom/packed.hpp"

namespace rbvi {

namespace {

const NitscheModel &checked(const ReducedModel &model, const Scene &scene) {
  if (!scene.nitsche || !model.nitsche)
    throw bad_input("the model and its scene in this build differ in the formulation of contact");
  return *model.nitsche;
}

} // namespace

ReducedNitsche::ReducedNitsche(const ReducedModel &model, const Scene &scene)
    : model_(model), scene_(scene), cells_(curve_cells(checked(model, scene))),
      consistency_(model.nitsche->consistency, cells_) {
  system_ = std::make_unique<System>(model, cells_);
  if (model.nitsche->rule == CurveRule::interpolated)
    interpolated_ = std::make_unique<Interpolated>(*model.nitsche, cells_);
}

ReducedNitsche::~ReducedNitsche() = default;

ReducedNitsche::Quadratic ReducedNitsche::quadratic_at(const Mu &all_parameters) const {
  const Index n = model_.primal_size();
  Quadratic result;
  result.a = unpacked(
      model_.a.reduced * affine_coefficients(model_.a, scene_.a, scene_, all_parameters), n);
  result.f = Vector::Zero(n);
  if (model_.f.size() > 0)
    result.f = model_.f.reduced * affine_coefficients(model_.f, scene_.f, scene_, all_parameters);
  const std::vector<NitscheFace> faces =
      nitsche_faces(scene_, all_parameters, selected(cells_, consistency_.cells()));
  const bool friction = scene_.support->friction.law != FrictionLaw::none;
  const Vector theta = consistency_.of_blocks(nitsche_consistency(faces, friction));
  result.a_gamma = result.a + unpacked(model_.nitsche->consistency.reduced * theta, n);
  return result;
}

Vector ReducedNitsche::predicted(const Mu &all_parameters) const {
  const NitscheModel &nitsche = *model_.nitsche;
  if (nitsche.starts.cols() == 0) return {};
  return local_fit(nitsche.starts, parts_of_box(scene_.parameters, nitsche.starts_mu),
                   parts_of_box(scene_.parameters, all_parameters));
}

NitscheAnswer ReducedNitsche::solve(const Mu &all_parameters) {
  System &system = *system_;
  system.law = nitsche_law(scene_.support->friction, all_parameters);
  system.quadratic = quadratic_at(all_parameters);
  NitscheAnswer answer;
  if (interpolated_) {
    answer.iterations =
        interpolated_->solve(scene_, all_parameters, predicted(all_parameters), system);
  } else {
    system.set_points(scene_, all_parameters, cells_);
    system.predict(predicted(all_parameters));
    answer.iterations = system.settle();
  }
  answer.u = system.u;
  answer.residual = system.relative;
  answer.energy =
      0.5 * answer.u.dot(system.quadratic.a * answer.u) - system.quadratic.f.dot(answer.u);
  return answer;
}

Matrix ReducedNitsche::point_residuals() const {
  const System &system = *system_;
  const Vector slopes = system.weighted(&PointTerm::slope, system.pressures);
  Matrix result =
      system.functionals.leftCols(system.points) * slopes.head(system.points).asDiagonal();
  if (system.bounds.size() > 0)
    result += system.functionals.rightCols(system.points) * slopes.tail(system.points).asDiagonal();
  return result;
}

Matrix ReducedNitsche::tangent() const {
  return system_->tangent_at(system_->pressures);
}

CurveFields ReducedNitsche::fields(const Mu &all_parameters, const Vector &u) const {
  return nitsche_fields(scene_, all_parameters, cells_, model_.nitsche->trace * u);
}

void ReducedNitsche::outputs(const Mu &all_parameters, const Vector &u, Outputs &outputs) const {
  const Matrix &trace = model_.nitsche->trace;
  const Vector layer = trace * u;
  const NitscheLaw law = nitsche_law(scene_.support->friction, all_parameters);
  const std::vector<NitscheFace> faces = nitsche_faces(scene_, all_parameters, cells_);
  const Matrix pressures = nitsche_pressures(faces, layer);
  nitsche_outputs(faces, pressures, nitsche_fields(scene_, all_parameters, cells_, layer), law,
                  outputs);
  const Vector bounds = nitsche_bounds(pressures, law);
  const Vector terms = trace.transpose() * nitsche_residual(faces, layer, bounds);
  const Quadratic quadratic = quadratic_at(all_parameters);
  const Vector au = quadratic.a_gamma * u, r = au + terms - quadratic.f;
  const double scale = au.norm() + terms.norm() + quadratic.f.norm();
  outputs.kkt_residual = scale > 0 ? r.norm() / scale : 0;
}

} // namespace rbvi
