// Integrals over contact: where contact and stick end inside an edge, and what is taken between
// nodes.
#pragma once

#include "rbvi/core/dense.hpp"

#include <array>
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

/// Two successive nodes beside the end of a zone, contact or stick, the nearer one first, and how
/// far they are apart. NaN: there is no second one.
struct NodesBeside {
  std::array<double, 2> values;
  double apart;
};

/// How far from the first of these nodes the zone begins: p = C s^(3/2) outside of it, s the way
/// from its end (the gap; in contact the slip), so that p^(2/3) is linear. NaN where they do not
/// say.
double way_to_zone(const NodesBeside &outside);

/// How far from its last node a zone reaches into an edge of this length, whose other node is
/// outside. Both sides say it, their mean is taken: second order in the length. `inside`: what
/// falls there like the root of the way to the end (the pressure; in contact what the shear is
/// below its bound). Nodal values carry what lies between the nodes, so that it is their force F
/// and its first moment M about the node before the last that tell the end: of a root they are
/// (2/3) C L^(3/2) and (2/5) L F.
double way_into_edge(const NodesBeside &inside, const NodesBeside &outside, double edge);

/// The integral of |v| over an edge on which v is linear with these values at its ends, and so is
/// what it is weighted with; `hats`: the integrals of the hats of both ends.
double integral_of_magnitude(const std::array<double, 2> &hats, const std::array<double, 2> &v);

} // namespace rbvi
