// Cell kernels of scalar P1 problems, as Forms: Laplace, mass, loads, and the H1 product of any
// number of components and of degree 1 or 2. They serve the distributed assembly and the online
// evaluation of sampled entries alike, in 2D and 3D.
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// Which copy of the cell a kernel integrates over.
enum class Domain { reference, mapped };

/// int grad u . grad v over the mapped cells (2.37).
Form laplace(const std::string &region);

/// factor * int u v; lumped: vertex quadrature, a diagonal (2.40a).
Form mass(const std::string &region, Domain domain, double factor, bool lumped = false);

/// int u . v + length^2 grad u : grad v over the reference cells (2.44); local dof = node *
/// components + component, exact. Throws bad_input for a degree other than 1 and 2.
Form h1_product(double length, int components = 1, int degree = 1);

/// value * int v over the mapped cells (2.38).
Form constant_load(const std::string &region, double value);

/// factor * int psi v over the mapped cells (2.40b), psi(mu, x) at the quadrature points of degree
/// 5; lumped: vertex quadrature.
Form function_load(const std::string &region, double factor,
                   const std::function<double(const FullMu &, const Point &)> &psi,
                   bool lumped = false);

} // namespace rbvi
