// What a reduced model keeps for bounds of its errors (model/certificate.hpp): at a few reference
// parameters the residual's parts in an orthonormal basis of their Riesz representers, by one
// factorisation of A each. The bound is then as exact as the residual; its square is never formed.
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/model/model.hpp"
#include "rbvi/mor/pod.hpp"

#include <string>

namespace rbvi {

/// Contact dofs of which bounds keep representers: more would fill the memory. Where there are more,
/// the law tells the bounds, or there are none.
inline constexpr int most_pushed_dofs = 3000;

/// Why answers to a scene have no bound; empty: they have one.
std::string no_certificate(const Scene &scene);

/// What is kept, or why answers have no bound.
struct Certificate {
  CertificateModel model{};
  std::string none{};
};

/// Of a model that was projected on `basis`. Reference parameters are the ends and the middle of
/// each parameter of A beside its common coefficient. `training`: which contact dofs multipliers
/// push is seen there. Collective.
Certificate make_certificate(Problem &problem, const LinearBasis &basis, const ReducedModel &model,
                             const std::vector<Mu> &training);

} // namespace rbvi
