// The operators of vertical pairing in the displacements of the nodes.
#pragma once

#include "rbvi/contact/contact_pair.hpp"

#include <numeric>

namespace rbvi {

/// Columns are the vertical displacements of the slave nodes, then of the master nodes, each in the
/// order of their curve.
inline PairOperators couple(const std::vector<Point> &slave, const std::vector<Point> &master,
                            const PairDiscretisation &discretisation, int degree = 1) {
  std::vector<int> dofs(slave.size() + master.size());
  std::iota(dofs.begin(), dofs.end(), 0);
  return pair_operators(vertical_partners(slave, master, discretisation.quadrature, degree),
                        discretisation.multiplier, dofs, std::ssize(dofs));
}

} // namespace rbvi
