// Cell kernels of linear elasticity with P1 displacements, as Forms: local dof = vertex * dim +
// component. One kernel serves 2D (plane strain) and 3D.
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// int sigma(u) : eps(v) over the mapped cells, dim components (2.45)-(2.47):
/// sigma = lambda tr(eps) I + 2 mu eps, lambda = E nu / ((1 + nu) (1 - 2 nu)), mu = E / (2 (1 +
/// nu)). `young` is E (a pressure), `poisson` is nu. Throws bad_input unless E > 0 and -1 < nu <
/// 1/2.
Form elasticity(const std::string &region, double young, double poisson);

} // namespace rbvi
