// Cell kernels of scalar problems, as Forms: Laplace and a load of degree 1 or 2, the H1 product of
// any number of components, and what couples a displacement with the multipliers of an obstacle.
// They serve the distributed assembly and the online evaluation of sampled entries alike, on
// triangles and tetrahedra. All are exact on straight cells but for function_load; a degree other
// than 1 and 2 throws bad_input. The P1 hats of the vertices of a cell are called eta, the
// functions of the displacement at its nodes phi. Niakh (2022): (2.48), (3.59), (4.82).
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// int grad u . grad v over the mapped cells (2.37): nodes x nodes.
Form laplace(const std::string &region, int degree = 1);

/// int c u v over the mapped cells, exact where c is of degree 5 - 2 degree in x, a point of them.
Form weighted_product(const std::string &region, const std::function<PointValue> &c, int degree);

/// int u . v + length^2 grad u : grad v over the reference cells (2.44); local dof = node *
/// components + component.
Form h1_product(double length, int components = 1, int degree = 1);

/// value * int v over the mapped cells (2.38): nodes. Of degree 1 and value 1 the integrals of eta.
Form constant_load(const std::string &region, double value, int degree = 1);

/// int force . v over the mapped cells, exact where the force is of degree 3 (axisymmetric: 2) in
/// x, a point of them: local dof = node * components + component.
Form body_load(const std::string &region, const std::function<PointMap> &force, int components,
               int degree, bool axisymmetric = false);

/// int eta_i eta_j over the reference cells: vertices x vertices.
Form l2_product(const std::string &region);

/// factor * int eta_i phi_j over the mapped cells (2.40a): vertices x nodes. Lumped: vertex
/// quadrature, which couples a vertex with itself alone.
Form hat_coupling(const std::string &region, double factor, int degree, bool lumped);

/// factor * int psi eta_i over the mapped cells (2.40b), at the vertices whatever the degree of the
/// displacement; psi(mu, x) at the quadrature points of degree 5. Lumped: vertex quadrature.
Form function_load(const std::string &region, double factor,
                   const std::function<double(const FullMu &, const Point &)> &psi,
                   bool lumped = false);

} // namespace rbvi
