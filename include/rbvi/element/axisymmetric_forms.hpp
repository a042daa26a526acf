// Cell kernels of elastic bodies that are turned about x = 0, as Forms: x is the radius, the
// displacement (u_x, u_y) has the hoop strain u_x / x beside those of the plane, and integrals are
// over the whole circumference. Triangles of degree 1 or 2; local dof = node * 2 + component.
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// int sigma(u) : eps(v) over the mapped cells, the material constant on each as in elasticity():
/// exact but for the square of the hoop strain, which is rational. Throws bad_input for a degree
/// other than 1 and 2.
Form axisymmetric_elasticity(const std::string &region, const std::function<Material> &material,
                             int degree);

/// int u . v + length^2 grad u : grad v in space over the reference cells, the hoop strain part of
/// the gradient. Throws likewise.
Form axisymmetric_h1_product(double length, int degree);

/// The product of V of this length (2.44), of a body of the plane or one that is turned.
Sum h1_product_of(const Scene &scene, double length);

} // namespace rbvi
