// The coefficients theta(mu) of a separated operator.
#pragma once

#include "rbvi/model/model.hpp"

namespace rbvi {

/// theta_q(mu) of a or f: the coefficients of the scene, then those of empirical interpolation, the
/// sampled entries re-assembled, then the triangular solve (B.36). terms.size() numbers. Throws
/// bad_input for a coefficient that is not finite.
Vector affine_coefficients(const AffineTerms &terms, const Sum &sum, const Scene &scene,
                           const FullMu &all_parameters);

/// The same of b or g: the entries are integrated again on their few entities of each interface.
enum class Part { b, g };
Vector contact_coefficients(const AffineTerms &terms, Part part, const Contact &contact,
                            const Scene &scene, const FullMu &all_parameters);

/// The lower triangle of A_N with these coefficients of its terms, n x n.
void stiffness_of(const ReducedModel &model, const Vector &theta, Matrix &lower);

/// u^T A_N u with these coefficients of its terms.
double energy_product(const ReducedModel &model, const Vector &theta, const Vector &u);

/// Throws bad_input, with the name of the operator, unless the terms are those of the sum.
void check_terms_of(const AffineTerms &terms, const Sum &sum, const ParameterSpace &space,
                    const std::string &name);

} // namespace rbvi
