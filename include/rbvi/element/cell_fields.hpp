// What a solution is on each cell: the stress at its centre, the body that it belongs to.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/scene.hpp"

#include "rbvi/element/lagrange.hpp"

#include <vector>

namespace rbvi {

/// A cell with its displacement, three components at each node, the motion among them.
struct DisplacedCell {
  Cell cell; ///< mapped
  int material = 0;
  std::array<Point, most_nodes> u{};
};

/// u at a point.
Point displacement_at(const Scene &scene, const DisplacedCell &cell,
                      const std::array<double, 4> &barycentric);

/// The gradient of a scalar displacement there.
Point slope_at(const Scene &scene, const DisplacedCell &cell,
               const std::array<double, 4> &barycentric);

/// Cauchy stress (Pa; of a plane or turned body zz is out of the plane) and elastic energy of a
/// volume at a point. Constants are those at the centre of the cell.
struct PointStress {
  Eigen::Matrix3d sigma;
  double strain_energy = 0;
};
PointStress stress_at(const Scene &scene, const FullMu &all_parameters, const DisplacedCell &cell,
                      const std::array<double, 4> &barycentric);

/// Names of the components of a stress tensor that a plane (dim 2: plane strain; axisymmetric: zz
/// is the hoop) or solid body has, in the order of the columns of centre_stresses().
std::vector<std::string> stress_components(int dim);

/// Cauchy stress (Pa) at the centre of each cell: cells x stress_components(scene.dim). `points`:
/// nodes x dim, reference coordinates; `cells`: nodes_per_cell(dim, degree) node numbers each;
/// `displacement`: three components per node; `materials`: of each cell its number in
/// scene.materials, empty: all of the first. Throws failure for a cell that the map inverts.
Matrix centre_stresses(const Scene &scene, const FullMu &all_parameters, const Matrix &points,
                       const std::vector<int> &cells, const std::vector<int> &materials,
                       const Vector &displacement);

/// sqrt(3/2 s : s), s the deviator, of each row of centre_stresses().
Vector von_mises(const Matrix &stresses);

/// The connected part of the mesh that each cell belongs to, numbered from 1: first the part of
/// `first_node`, the others by their first cells.
Vector body_numbers(const std::vector<int> &cells, int per_cell, Index nodes, int first_node);

/// Rows of values at nodes (nodes x any number): those of the middles of edges become the means of
/// the ends, as on straight edges. Of degree 1 there is none. `cells`: as in centre_stresses.
void straighten_edges(const std::vector<int> &cells, int dim, int degree, Matrix &rows);

} // namespace rbvi
