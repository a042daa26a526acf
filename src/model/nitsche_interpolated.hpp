// Newton's method on operators of the curve that are interpolated over (mu, Newton step), as
// printed in (4.79)-(4.80).
#pragma once

#include "nitsche_system.hpp"

namespace rbvi {

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

} // namespace rbvi
