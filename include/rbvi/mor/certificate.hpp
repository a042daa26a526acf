// What a reduced model keeps for bounds of its errors (model/certificate.hpp): at a few reference
// parameters the residual's parts in an orthonormal basis of their Riesz representers, by one
// factorisation of A each. The bound is then as exact as the residual; its square is never formed.
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/model/model.hpp"
#include "rbvi/mor/pod.hpp"

#include <string>

namespace rbvi {

/// Contact dofs beyond which there are no bounds: their representers would fill the memory.
inline constexpr int most_pushed_dofs = 3000;

/// Why answers to a scene have no bound; empty: they have one.
std::string no_certificate(const Scene &scene);

/// For a model that was projected on `basis`; nothing, references empty, where the scene has none.
/// Reference parameters are the ends and the middle of each parameter of A beside its common
/// coefficient. `training`: where multipliers push which contact dofs is seen there. Collective.
CertificateModel make_certificate(Problem &problem, const LinearBasis &basis,
                                  const ReducedModel &model, const std::vector<Mu> &training);

} // namespace rbvi
