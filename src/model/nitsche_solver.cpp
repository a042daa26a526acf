#include "rbvi/model/nitsche_solver.hpp"

#include "nitsche_system.hpp"
#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/model/packed.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace rbvi {

namespace {

constexpr double accuracy = 1e-10; ///< change of u, relative (4.26)
constexpr double smallest_step = 1e-3;
constexpr int most_printed_steps = 20, most_halved_steps = 60, most_alone = 100;

/// Cells that any of the four operators is sampled on.
std::vector<CurveCell> touched(const NitscheModel &model, const std::vector<CurveCell> &all) {
  std::vector<int> numbers;
  for (const LayerTerms *terms : {&model.contact_matrix, &model.contact_vector,
                                  &model.friction_matrix, &model.friction_vector}) {
    const std::vector<int> more = SampledLayer(*terms, all).cells();
    numbers.insert(numbers.end(), more.begin(), more.end());
  }
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return selected(all, numbers);
}

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

/// Newton's method on operators of the curve that are interpolated over (mu, Newton step), as
/// printed in (4.79)-(4.80).
struct ReducedNitsche::Interpolated {
  /// The interpolated terms of contact or of friction.
  struct Part {
    const LayerTerms &matrix, &vector;
    SampledLayer at_matrix, at_vector;
  };
  const Matrix &trace; ///< contact dofs x n: the primal basis
  const NitscheLayer &layer;
  std::vector<CurveCell> cells; ///< that some sampled entry touches
  std::array<Part, 2> parts;    ///< of contact, of friction

  Interpolated(const ReducedModel &of, const NitscheLayer &whole);
  /// From the coefficients `near`, by (4.79); where that does not converge (its matrix is not the
  /// derivative of its vectors), by the derivative, with halved steps. Empty: from u_0 = 0 by
  /// (4.79) alone. Into system.u. Returns the steps. Throws failure where it does not converge.
  int solve(const FullMu &all_parameters, const Vector &near, System &system);

private:
  /// The interpolated terms at one iterate.
  struct Terms {
    Vector residual;
    double scale;
  };
  Terms terms(const std::vector<NitscheFace> &faces, const System &system, const Vector &u) const;
  Part part(const LayerTerms &matrix, const LayerTerms &vector) const {
    return {matrix, vector, {matrix, cells}, {vector, cells}};
  }
  Matrix slope(const std::vector<NitscheFace> &faces, const System &system, const Vector &u,
               bool printed) const;
  Matrix times_trace(const std::vector<FaceBlock> &blocks) const;
};

ReducedNitsche::Interpolated::Interpolated(const ReducedModel &of, const NitscheLayer &whole)
    : trace(of.contact.trace), layer(whole), cells(touched(*of.contact.nitsche, whole.cells)),
      parts{part(of.contact.nitsche->contact_matrix, of.contact.nitsche->contact_vector),
            part(of.contact.nitsche->friction_matrix, of.contact.nitsche->friction_vector)} {}

ReducedNitsche::Interpolated::Terms
ReducedNitsche::Interpolated::terms(const std::vector<NitscheFace> &faces, const System &system,
                                    const Vector &u) const {
  const Vector on_layer = trace * u;
  std::array<Vector, 2> on_dofs{nitsche_residual(faces, on_layer, {}), {}};
  const Vector bounds = nitsche_bounds(faces, nitsche_pressures(faces, on_layer));
  if (bounds.size() > 0) on_dofs[1] = nitsche_residual(faces, on_layer, bounds) - on_dofs[0];
  Vector sum = Vector::Zero(u.size());
  for (std::size_t k = 0; k < 2; ++k)
    if (parts[k].vector.size() > 0)
      sum += parts[k].vector.reduced * parts[k].at_vector.of_vector(on_dofs[k]);
  const Vector au = system.quadratic.a_gamma * u;
  return {au + sum - system.quadratic.f, au.norm() + sum.norm() + system.quadratic.f.norm()};
}

/// The interpolated matrix, as printed, or the derivative of the interpolated vectors, but for
/// bounds that move.
Matrix ReducedNitsche::Interpolated::slope(const std::vector<NitscheFace> &faces,
                                           const System &system, const Vector &u,
                                           bool printed) const {
  const Matrix pressures = nitsche_pressures(faces, trace * u);
  const Vector bounds = nitsche_bounds(faces, pressures);
  std::array<std::vector<FaceBlock>, 2> blocks{nitsche_tangent(faces, pressures, {}), {}};
  if (bounds.size() > 0) blocks[1] = nitsche_tangent(faces, pressures, bounds);
  const bool joint = printed && parts[0].matrix.size() == 0;
  for (std::size_t k = 0; k < blocks[1].size() && !joint; ++k)
    blocks[1][k] -= blocks[0][k];
  Matrix result = system.quadratic.a_gamma;
  for (std::size_t k = 0; k < 2; ++k) {
    const Part &one = parts[k];
    if (printed && one.matrix.size() > 0) {
      const std::vector<FaceBlock> sampled = selected(blocks[k], one.at_matrix.cells());
      result += unpacked(one.matrix.reduced * one.at_matrix.of_blocks(sampled), u.size());
    } else if (!printed && one.vector.size() > 0) {
      const Matrix on_dofs = times_trace(blocks[k]);
      Matrix theta(one.vector.size(), u.size());
      for (Index j = 0; j < u.size(); ++j)
        theta.col(j) = one.at_vector.of_vector(on_dofs.col(j));
      result += one.vector.reduced * theta;
    }
  }
  return result;
}

/// The blocks of `cells` times the trace: a row for each dof of the layer.
Matrix ReducedNitsche::Interpolated::times_trace(const std::vector<FaceBlock> &blocks) const {
  Matrix result = Matrix::Zero(trace.rows(), trace.cols());
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const Matrix rows = blocks[k] * basis_on(cells[k], trace);
    for (Index i = 0; i < 12; ++i)
      if (cells[k].dofs[i] >= 0) result.row(cells[k].dofs[i]) += rows.row(i);
  }
  return result;
}

int ReducedNitsche::Interpolated::solve(const FullMu &all_parameters, const Vector &near,
                                        System &system) {
  const std::vector<NitscheFace> faces = nitsche_faces(layer, all_parameters, cells);
  int steps = 0;
  const bool alone = near.size() == 0;
  for (const bool printed : {true, false}) {
    if (alone && !printed) break;
    system.u = alone ? Vector(Vector::Zero(trace.cols())) : near;
    Terms here = terms(faces, system, system.u);
    const int most_steps = alone ? most_alone : printed ? most_printed_steps : most_halved_steps;
    for (int step = 1; step <= most_steps; ++step) {
      ++steps;
      const Vector d = -lu_solve(slope(faces, system, system.u, printed), here.residual);
      if (!d.allFinite()) break;
      double t = 1;
      Terms next = terms(faces, system, system.u + d);
      while (!printed && !(next.residual.norm() < here.residual.norm()) && t > smallest_step) {
        t /= 2;
        next = terms(faces, system, system.u + t * d);
      }
      system.u += t * d;
      here = std::move(next);
      system.relative = here.scale == 0 ? 0 : here.residual.norm() / here.scale;
      if (d.norm() <= accuracy * system.u.norm()) return steps;
    }
  }
  throw failure("the interpolated problem did not converge: its residual is " +
                short_number(system.relative) + "; " + (alone ? "use the method exact, or " : "") +
                "reduce again with -nitsche_quadrature empirical");
}

ReducedNitsche::ReducedNitsche(const ReducedModel &model, NitscheLayer layer,
                               const QueryOptions &options)
    : model_(model), layer_(std::move(layer)), body_(model, layer_.scene),
      consistency_(model.contact.nitsche->consistency, layer_.cells),
      from_rest_(options.method == OnlineMethod::newton) {
  system_ =
      std::make_unique<System>(model, layer_.cells, points_of(*model.contact.nitsche, layer_));
  if (model.contact.nitsche->rule == CurveRule::interpolated)
    interpolated_ = std::make_unique<Interpolated>(model, layer_);
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

Vector ReducedNitsche::predicted(const Matrix &of_samples, const FullMu &all_parameters) const {
  if (of_samples.cols() == 0) return {};
  const ParameterSpace &space = layer_.scene.parameters;
  return local_fit(of_samples, parts_of_box(space, model_.contact.nitsche->starts_mu),
                   parts_of_box(space, all_parameters));
}

ReducedAnswer ReducedNitsche::solve(const FullMu &all_parameters, Relaxed) {
  System &system = *system_;
  const NitscheModel &nitsche = *model_.contact.nitsche;
  system.mu.clear(); // until its quadratic is there
  system.quadratic = quadratic_at(all_parameters);
  system.mu = all_parameters;
  ReducedAnswer answer;
  answer.mu = all_parameters;
  if (interpolated_) {
    answer.iterations = interpolated_->solve(
        all_parameters, from_rest_ ? Vector() : predicted(nitsche.starts, all_parameters), system);
  } else {
    system.set_points(layer_, all_parameters);
    system.predict(predicted(nitsche.starts, all_parameters),
                   predicted(nitsche.states, all_parameters));
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
