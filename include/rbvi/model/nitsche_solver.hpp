// The online stage of Nitsche's method: Newton's method in the n coefficients of the reduced basis,
//
//   A_gamma u + (contact and friction at points of the curve) = f,
//
// A_gamma = A + the terms that keep the method consistent, both separated. The points are all
// Gauss points of the curve or a few with weights of their own: a minimisation either way, convex
// where A_gamma is positive definite, with exact line search. Coulomb's bound moves with u: Newton
// steps, halved until the residual falls, and where they do not settle, bounds frozen in an outer
// loop (4.63). Where contact follows the displacement (large deformations) the axes of the
// points turn to those of every iterate. Niakh (2022): (4.66)-(4.70), Remark 4.4.1.
#pragma once

#include "rbvi/core/variants.hpp"
#include "rbvi/method/starts.hpp"
#include "rbvi/model/answer.hpp"
#include "rbvi/model/nitsche_layer_terms.hpp"
#include "rbvi/model/reduced_body.hpp"

#include <memory>

namespace rbvi {

struct InterpolatedAnswer {
  Vector u;        ///< n coefficients
  double residual; ///< relative
  int iterations;
};

/// Newton's method on operators of the curve that are interpolated over (mu, Newton step).
class InterpolatedCurve {
public:
  virtual ~InterpolatedCurve() = default;
  /// From the coefficients `near`; empty: from u = 0. `a_gamma`: n x n, `f`: n, at this mu. Throws
  /// failure where it does not converge.
  virtual InterpolatedAnswer solve(const FullMu &all_parameters, const Vector &near,
                                   const Matrix &a_gamma, const Vector &f) const = 0;
};

using InterpolatedCurveMaker = std::unique_ptr<InterpolatedCurve> (*)(const ReducedModel &,
                                                                      const NitscheLayer &);
/// Those that a rule has.
std::map<CurveRule, InterpolatedCurveMaker> &interpolated_curves();

class ReducedNitsche : public QueryMethod {
public:
  /// `model`, and the scene of the layer, must outlive it.
  ReducedNitsche(const ReducedModel &model, NitscheLayer layer, const QueryOptions &options = {});
  ~ReducedNitsche() override;
  /// Starts from what the training samples predict; where there are none, from u = 0. Throws
  /// failure, saying what to try, where Newton's method does not converge or the tangent is not
  /// positive definite.
  ReducedAnswer solve(const FullMu &all_parameters, Relaxed = {}) override;
  std::optional<ReducedAnswer> near(const ReducedAnswer &from, const FullMu &mu) override;

  /// What each point adds to the residual of the last answer, n x points, ...
  Matrix point_residuals() const;
  /// ... and the tangent, n x n.
  Matrix tangent() const;

  /// nitsche_multiplier of the whole curve.
  Vector multiplier(const FullMu &all_parameters, const Vector &u) const;
  /// All that is measured but the energy. Pressures need u to a part in gamma, which few points do
  /// not give between them: from u, Newton's method goes on over the whole curve, one or two steps,
  /// and forces, widths and pressures are those of its answer. Throws failure where it does not
  /// converge.
  void outputs(const FullMu &all_parameters, const Vector &u, Outputs &outputs) const;

private:
  struct System;

  /// a(u, u) / 2 - f(u), and a_gamma.
  struct Quadratic {
    Matrix a, a_gamma; ///< n x n
    Vector f;
  };
  Quadratic quadratic_at(const FullMu &all_parameters) const;
  /// The system at mu, without its points.
  System &system_at(const FullMu &all_parameters);
  /// What it has come to.
  ReducedAnswer answer_of(const System &system, int iterations) const;
  /// The answer with the integrals over the whole curve, from u. Sets quadrature_residual, of u.
  /// `faces`: of all cells at rest.
  Vector over_whole_curve(const FullMu &all_parameters, const std::vector<NitscheFace> &faces,
                          const Vector &u, Outputs &outputs) const;

  const ReducedModel &model_;
  const NitscheLayer layer_;
  const ReducedBody body_;
  SampledLayer consistency_;
  std::unique_ptr<System> system_;
  std::unique_ptr<InterpolatedCurve> interpolated_;
  const Neighbours starts_;
  const bool from_rest_;                  ///< OnlineMethod::newton
  mutable std::unique_ptr<System> whole_; ///< made by the first outputs of a model with few points
};

} // namespace rbvi
