// Displacements imposed on fixed boundaries (FixedBoundary::values). With l(mu) the imposed values
// at the nodes of these boundaries, zero at all others, and w zero at the fixed ones,
//
//   u = motion + l + w,   a(w, v) + b(v, lambda) = f(v) - a(l, v),   b(w, eta) <= g(eta) - b(l,
//   eta)
//
// and the energy of u is that of w under this load, and a(l, l) / 2 - f(l) - f(motion). Loads and
// energy are sums of forms like those of a scene: exact where a and the imposed values are, else
// separated by empirical interpolation. Their kernels read Cell::imposed_by.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/scene.hpp"

namespace rbvi {

/// Whether the scene imposes values on some boundary.
bool imposes_values(const Scene &scene);

/// Without the values that factors of fixed parameters make zero, and with the loads -a(l, v) of
/// the others behind those of the scene itself. Done twice it changes nothing. Throws bad_input for
/// a factor that is not finite at the fixed parameters.
Scene with_imposed_loads(Scene scene);

/// a(l, l) / 2 - f(l) - f(motion): each kernel fills a single number, which the cells add up; of a
/// form of means it is the sum of their directions. Terms of l are `of_imposed`: of cells without
/// imposed values they are zero. `scene`: as with_imposed_loads returns it. Throws bad_input for
/// means beside a motion that depends on the place.
Sum imposed_energy(const Scene &scene);

/// What fixed boundary number `boundary` imposes at a point of the reference domain. Throws
/// bad_input, naming boundary and mu, where it is not finite.
Point imposed_value(const Scene &scene, const FullMu &all_parameters, int boundary, const Point &x);

/// l at nodes * components + component, zero where `imposed_by` is -1 (see Cell::imposed_by).
Vector imposed_values(const Scene &scene, const FullMu &all_parameters,
                      const std::vector<Point> &nodes, const std::vector<int> &imposed_by);

/// Reference coordinates of the nodes of a simplex: its vertices, of degree 2 then the middles of
/// its edges. `dim`: 1, 2 or 3, that of the facet for a form on a boundary.
std::vector<Point> node_points(int dim, int degree, const Cell &cell);

} // namespace rbvi
