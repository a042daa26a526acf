// Contact of a body with a rigid support along a polygonal curve in 2D (Niakh 2022, 3.2):
//
//   (motion + w) . n <= gap,      and, with friction, the slip (motion + w) . tau.
//
// Multipliers are continuous and linear on the edges, those of the normal constraint first, then
// those of the slip. Displacements are those of the nodes of the curve, of degree 1 or 2; column =
// node * 2 + component. Everything is integrated on the mapped straight edges with four Gauss
// points, or (Scene::lumped) with their two vertices, which makes the constraint one at each
// vertex; normal and gap are the scene's, at the points of the reference edges.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/scene.hpp"

namespace rbvi {

/// The reference curve: its vertices in the order of strictly increasing abscissa, then (degree 2)
/// the middle of each edge.
struct SupportCurve {
  std::vector<Point> points;
  Index vertices = 0;
};

/// The constraint on w, weak and at nodes: b w <= g in the rows of the normal multipliers; b w - g
/// is the slip in the others.
struct SupportOperators {
  SparseMatrix b; ///< multipliers x columns: int v . n eta, then int v . tau eta (3.12a, 3.17)
  Vector g;       ///< multipliers: int gap eta (3.12b) less the motion's share; - the motion's
  Vector weights; ///< vertices: int eta
  SparseMatrix nodal_b; ///< vertices x columns: v . n at the vertices
  Vector nodal_gap;     ///< vertices: gap - motion . n
};

/// Number of multipliers: vertices, and as many again with friction.
Index multiplier_count(const SupportCurve &curve, const SupportRecipe &support);

/// Throws bad_input where there is no edge, an edge does not go to larger abscissae, or the points
/// do not fit the degree; throws failure, naming mu, if the mapped curve has an edge of no length.
SupportOperators couple_with_support(const Scene &scene, const FullMu &all_parameters,
                                     const SupportCurve &curve);

/// Gram matrix of the multipliers in L2 of the reference curve: block diagonal with friction, an
/// entry for every pair of neighbours.
SparseMatrix multiplier_product(const SupportCurve &curve, const SupportRecipe &support);

} // namespace rbvi
