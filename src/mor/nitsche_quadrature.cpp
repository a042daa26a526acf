#include "rbvi/mor/nitsche_quadrature.hpp"

#include "nitsche_layer.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/method/nonnegative_qp.hpp"
#include "rbvi/model/nitsche_solver.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace rbvi {

namespace {

constexpr double enough = 1e-10; ///< of an answer: where the modes leave less, enough

/// Most that the two halves of a symmetric curve add to an answer differently, relative: more is a
/// mesh without the symmetry.
constexpr double mirrored = 1e-7;

/// The model with all points: its answers, and what each point adds to them.
class AllPoints {
public:
  AllPoints(const ReducedModel &model, const NitscheLayer &layer,
            const std::vector<Sample> &samples)
      : model_(model), solver_(model_, layer), scene_(layer.scene), samples_(samples),
        of_curve_(4 * std::ssize(layer.cells)), symmetric_(is_symmetric(layer.scene)) {
    const std::vector<CurveCell> &cells = layer.cells;
    const auto count = std::ssize(samples);
    answers_.resize(model.primal_size(), count);
    std::vector<char> met(4 * cells.size(), 0); // some answer has contact or friction there
    const Vector x = point_abscissae(cells);
    const Vector sign = (x.array() < 0).select(Vector::Constant(x.size(), -1.0), 1.0);
    for (Index p = 0; p < count; ++p) {
      answers_.col(p) = solve(p);
      const Matrix residuals = solver_.point_residuals();
      for (Index q = 0; q < residuals.cols(); ++q)
        if (!residuals.col(q).isZero(0)) met[q] = 1;
      const Vector skew = lu_solve(solver_.tangent(), residuals * sign);
      symmetric_ = symmetric_ && skew.norm() <= mirrored * answers_.col(p).norm();
    }
    for (Index q = 0; q < x.size(); ++q)
      if ((!symmetric_ || x[q] < 0) && met[q] != 0) points_.push_back(static_cast<int>(q));
  }
  const Matrix &answers() const { return answers_; } ///< n x P
  /// The points that matter; on a symmetric curve the points of one half stand for both.
  const std::vector<int> &points() const { return points_; }
  Index of_curve() const { return of_curve_; } ///< all points
  double share() const { return symmetric_ ? 2 : 1; }
  /// What each of them adds to answer p to first order: tangent^-1 residual, relative to |u|.
  Matrix effects(Index p) {
    const double size = std::max(solve(p).norm(), 1e-300);
    const Matrix residuals = solver_.point_residuals()(Eigen::all, points_);
    return share() / size * lu_solve(solver_.tangent(), residuals);
  }

private:
  Vector solve(Index p) { return solver_.solve(expand(scene_.parameters, samples_[p].mu)).u; }
  const ReducedModel model_; ///< stays as it is while points are chosen for the other
  ReducedNitsche solver_;
  const Scene &scene_;
  const std::vector<Sample> &samples_;
  Index of_curve_;
  bool symmetric_; ///< scene and mesh, hence each answer: both halves of the curve add the same
  Matrix answers_;
  std::vector<int> points_;
};

/// Least squares for the factors of the points: what some training parameters ask of them, one
/// below the other.
class PointFit {
public:
  /// `each`: rows of one parameter.
  void add(const Matrix &effects, Index each) {
    Matrix more(effects_.rows() + effects.rows(), effects.cols());
    if (effects_.rows() > 0) more.topRows(effects_.rows()) = effects_;
    more.bottomRows(effects.rows()) = effects;
    effects_ = std::move(more);
    each_ = each;
    const std::vector<Index> active = qp_ ? qp_->active() : std::vector<Index>{};
    qp_.emplace(effects_.rows(), NonnegativeQpOptions{.max_iterations = 1});
    qp_->start_from(active);
    finished_ = false;
  }
  /// Takes points in until the effects are met to `tolerance` at every one of the parameters.
  void improve(double tolerance) {
    const Vector target = effects_.rowwise().sum();
    double left = 0;
    do {
      finished_ = qp_->solve(effects_, target).converged;
      left = std::sqrt(qp_->residual()
                           .reshaped(each_, effects_.rows() / each_)
                           .colwise()
                           .squaredNorm()
                           .maxCoeff());
    } while (left > tolerance && !finished_);
  }
  const Vector &factors() const { return qp_->x(); }
  bool finished() const { return finished_; } ///< no further point helps

private:
  Matrix effects_;
  Index each_ = 0;
  std::optional<NonnegativeQp> qp_;
  bool finished_ = false;
};

/// The points with positive factors, and where queries start from there.
void set_points(const AllPoints &all, const Vector &factors, const Matrix &pressures,
                NitscheModel &nitsche) {
  nitsche.points.clear();
  std::vector<double> positive;
  for (std::size_t k = 0; k < all.points().size(); ++k) {
    const double factor = all.share() * factors[k];
    if (!(factor > 0)) continue;
    nitsche.points.push_back(all.points()[k]);
    positive.push_back(factor);
  }
  nitsche.factors = Eigen::Map<const Vector>(positive.data(), std::ssize(positive));
  std::vector<int> rows = nitsche.points;
  const Index count = all.of_curve();
  for (std::size_t k = 0; k < nitsche.points.size() && pressures.rows() > count; ++k)
    rows.push_back(static_cast<int>(count) + nitsche.points[k]);
  nitsche.starts = pressures(rows, Eigen::all);
}

/// Relative distance of each answer of the model, with the points it has, to that with all;
/// infinite where it has none.
Vector errors_of_points(const ReducedModel &model, const NitscheLayer &layer,
                        const std::vector<Sample> &samples, const Matrix &answers) {
  ReducedNitsche solver(model, layer);
  Vector errors(answers.cols());
  for (Index p = 0; p < errors.size(); ++p) {
    const auto all = answers.col(p);
    try {
      const Mu &mu = samples[p].mu;
      errors[p] = (solver.solve(expand(layer.scene.parameters, mu)).u - all).norm() /
                  std::max(all.norm(), 1e-300);
    } catch (const Error &) {
      errors[p] = std::numeric_limits<double>::infinity();
    }
  }
  return errors;
}

/// Non-negative least squares, point by point, until every answer of the model itself is met: to
/// first order, at some training parameters and at those that turn out worst. `model`: starts at
/// all points.
void choose_curve_points(AllPoints &all, double tolerance, const NitscheLayer &layer,
                         const std::vector<Sample> &samples, ReducedModel &model,
                         CurveReport &report) {
  const Matrix pressures = model.contact.nitsche->starts;
  constexpr Index few = 64;
  const auto count = std::ssize(samples);
  std::vector<char> taken(samples.size(), 0);
  PointFit fit;
  const auto take = [&](Index p) {
    taken[p] = 1;
    return all.effects(p);
  };
  Matrix first;
  for (Index p = 0; p < count; p += (count + few - 1) / few) {
    first.conservativeResize(first.rows() + all.answers().rows(),
                             static_cast<Index>(all.points().size()));
    first.bottomRows(all.answers().rows()) = take(p);
  }
  fit.add(first, all.answers().rows());
  for (double first_order = tolerance;;) {
    fit.improve(first_order);
    set_points(all, fit.factors(), pressures, *model.contact.nitsche);
    const Vector errors = errors_of_points(model, layer, samples, all.answers());
    Index worst = 0;
    report.points.push_back(static_cast<int>(model.contact.nitsche->points.size()));
    report.error.push_back(errors.maxCoeff(&worst));
    if (report.error.back() <= tolerance) return;
    if (taken[worst] == 0)
      fit.add(take(worst), all.answers().rows());
    else if (fit.finished())
      return;
    else
      first_order *= 0.7;
  }
}

/// P_n and, with friction, P_tau of the samples at all points.
Matrix pressures_of(const Problem &problem, const std::vector<Sample> &samples) {
  const NitscheLayer layer = layer_of(problem.contact());
  const Index points = 4 * std::ssize(layer.cells);
  Matrix result(layer.friction() ? 2 * points : points, std::ssize(samples));
  for (std::size_t p = 0; p < samples.size(); ++p) {
    const Vector u = displacement(problem.comm(), samples[p])(problem.places().natural_dofs);
    const auto faces =
        nitsche_faces(layer, expand(layer.scene.parameters, samples[p].mu), layer.cells, u);
    result.col(p) = nitsche_pressures(faces, u).reshaped().head(result.rows());
  }
  return result;
}

} // namespace

std::map<CurveRule, TermInterpolation> &term_interpolations() {
  static std::map<CurveRule, TermInterpolation> list;
  return list;
}

CurveReport reduce_curve(Problem &problem, const std::vector<Sample> &samples,
                         const Matrix &coefficients, double u_left, const CurveOptions &options,
                         ReducedModel &model) {
  const NitscheLayer layer = layer_of(problem.contact());
  if (layer.follows_state() && options.rule == CurveRule::interpolated)
    throw bad_input("-nitsche_quadrature interpolated is for contact at rest: leave it out, or use "
                    "-kinematics small");
  CurveReport report;
  model.contact.nitsche = NitscheModel{};
  NitscheModel &nitsche = *model.contact.nitsche;
  nitsche.consistency = interpolate_consistency(layer, samples, model.contact.trace);
  nitsche.starts_mu.resize(model.scene.parameters.size(), std::ssize(samples));
  for (std::size_t p = 0; p < samples.size(); ++p)
    std::copy(samples[p].mu.begin(), samples[p].mu.end(), nitsche.starts_mu.col(p).begin());
  nitsche.rule = CurveRule::full;
  nitsche.starts = pressures_of(problem, samples);
  if (layer.follows_state()) nitsche.states = coefficients;
  if (options.rule == CurveRule::empirical) {
    AllPoints all(model, layer, samples);
    if (all.points().empty())
      throw failure("there is no contact at any training mu, and nothing to integrate: widen the "
                    "parameter box");
    nitsche.rule = CurveRule::empirical;
    choose_curve_points(all, options.tolerance > 0 ? options.tolerance : std::max(u_left, enough),
                        layer, samples, model, report);
  } else if (options.rule == CurveRule::interpolated) {
    entered(term_interpolations(), options.rule, interpolated_name)(problem, samples, options,
                                                                    model, report);
    nitsche.rule = CurveRule::interpolated;
    nitsche.starts = coefficients;
  }
  return report;
}

} // namespace rbvi
