// Nitsche's terms along the whole contact curve: energy, residual and tangent on the dofs of the
// cells beside it (the contact layer), from the terms of element/nitsche.hpp. Serial: the layer is
// small beside the domain, and every rank holds all of it.
#pragma once

#include "rbvi/element/nitsche.hpp"

#include <vector>

namespace rbvi {

/// An edge of the curve and the cell beside it. Rows of NitschePoint are for these dofs.
struct NitscheFace {
  std::array<NitschePoint, 4> points;
  double gamma = 0;
  std::array<int, 12> dofs; ///< of the layer; -1: fixed, or not there (degree 1)
};

/// Friction::law with its threshold or coefficient at one mu.
struct NitscheLaw {
  FrictionLaw law = FrictionLaw::none;
  double value = 0;
  bool only_in_contact = false; ///< Tresca's threshold holds where [P_n]_- < 0 alone
};

/// P_n (4.19a) and P_tau (4.35) at every point, face by face: 4 * faces rows, 2 columns.
Matrix nitsche_pressures(const std::vector<NitscheFace> &faces, const Vector &u);

/// The bound of friction at every point that these pressures tell: s (4.33), or s^c (4.51).
Vector nitsche_bounds(const Matrix &pressures, const NitscheLaw &law);

/// All integrals over the curve in J^Nitsche (4.15), with friction of these bounds (4.36); without
/// friction `bounds` is empty.
double nitsche_energy(const std::vector<NitscheFace> &faces, const Vector &u, const Vector &bounds);

/// Its gradient in u, `u.size()` entries: the integrals of (4.17), (4.39), (4.52).
Vector nitsche_residual(const std::vector<NitscheFace> &faces, const Vector &u,
                        const Vector &bounds);

/// Its Hessian, one block for each face, the bounds being fixed: (4.24a), (4.43a), (4.55a), and the
/// integrals of a_gamma.
std::vector<Eigen::Matrix<double, 12, 12>> nitsche_tangent(const std::vector<NitscheFace> &faces,
                                                           const Vector &u, const Vector &bounds);

} // namespace rbvi
