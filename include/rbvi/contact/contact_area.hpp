// The area in contact of a pressure by vertex quadrature.
#pragma once

#include "rbvi/core/dense.hpp"

#include <vector>

namespace rbvi {

/// sum over i of weight_i lambda_i / (largest lambda at i and its neighbours). `weights`: integral
/// of each hat function; `lambda` >= 0, zero where a node is free; `cells`: the nodes of each cell,
/// `corners` of them.
///
/// Where the pressure is nearly constant in contact and jumps to zero at its edge, nodal
/// equilibrium leaves each node along the edge the part of the pressure that the part of its patch
/// in contact carries. The sum of all active weights would count those patches as a whole.
double contact_area(const Vector &weights, const Vector &lambda, const std::vector<int> &cells,
                    int corners);

} // namespace rbvi
