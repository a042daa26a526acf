// The coefficients theta(mu) of a separated operator.
#pragma once

#include "rbvi/rom/model/model.hpp"

namespace rbvi {

/// theta_q(mu): the sampled entries re-assembled, then the triangular solve (B.36). J numbers.
Vector affine_coefficients(const AffineTerms &terms, const Form &form, const Scene &scene,
                           const FullMu &all_parameters);

/// The same of b or g: the entries are integrated again on their few entities of each interface.
enum class Part { b, g };
Vector contact_coefficients(const AffineTerms &terms, Part part, const Contact &contact,
                            const Scene &scene, const FullMu &all_parameters);

} // namespace rbvi
