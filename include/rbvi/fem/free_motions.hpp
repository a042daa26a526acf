// Bodies that no displacement and no term of a holds: they have rigid motions z with A z = 0, and
// contact alone can hold them. The solvers see springs on a few nodes of such a body in addition,
// of a stiffness like its own, one for each motion, relaxed where springs^T u = beta:
//
//   (A + theta springs springs^T) u + B^T lambda = F + theta springs beta
//
// and beta is found such that they are relaxed at the answer (method/balance.hpp): then they carry
// no force, forces balance without them, and u is that of A u + B^T lambda = F with the rigid
// motion that contact leaves. theta is that of the exact term of a on the body that varies least
// with mu, else 1.
#pragma once

#include "rbvi/fem/dofs.hpp"
#include "rbvi/fem/summed.hpp"

#include <string>

namespace rbvi {

/// A connected part of the mesh: its box.
struct MeshPart {
  Point low, high;
  Point centre() const { return (low + high) / 2; }
  double size() const { return norm(high - low) / 2; }
};

/// A body with k free motions.
struct FreeBody {
  std::string name; ///< "the body", or which of several
  int number;       ///< Mesh::body of its cells
  bool turned;      ///< axisymmetric: its motion is along the axis
  MeshPart part;    ///< at a generic point of the parameters, as `motions`
  Matrix motions;   ///< modes x k: of rigid_displacement() about the centre, in sizes; orthonormal
  int term = -1;    ///< of Scene::a, which has the springs and their theta
  std::vector<PetscInt> rows{}; ///< free dofs of the nodes with springs, on every rank
  Matrix springs{};             ///< rows x k
};

/// The bodies that can move, contact not counted; what a holds is asked at one point of the box,
/// where displacements alone leave a motion. Collective.
std::vector<FreeBody> free_bodies(const Scene &scene, const Mesh &mesh, const Dofs &dofs);

/// The same, with springs of unit length on nodes near the corners of each body: puts a term for
/// the springs of each behind those of scene.a and a load of nothing behind those of scene.f, and
/// couples their rows in `dofs`. Throws bad_input for a membrane. Collective.
std::vector<FreeBody> add_springs(Scene &scene, const Mesh &mesh, Dofs &dofs);
/// Gives the springs the stiffness of the diagonal of A and adds them to the terms of A. `a`:
/// summed at `mu`. Collective.
void stiffen(std::vector<FreeBody> &bodies, const Scene &scene, const FullMu &mu, Summed<Mat> &a);

/// k of all.
Index motions_of(const std::vector<FreeBody> &bodies);
/// theta of the springs of each motion.
Vector spring_coefficients(const std::vector<FreeBody> &bodies, const Scene &scene,
                           const FullMu &mu);
/// springs^T u of all bodies. Collective.
Vector spring_lengths(const std::vector<FreeBody> &bodies, Vec u);
/// f += springs values. Collective.
void add_spring_forces(const std::vector<FreeBody> &bodies, const Vector &values, Vec f);
/// The free motions at mu, in the order of the springs. Collective.
std::vector<Handle<Vec>> rigid_motions(const std::vector<FreeBody> &bodies, const Scene &scene,
                                       const FullMu &mu, const Mesh &mesh, const Dofs &dofs);

/// "the body 'lid' between (0, 0) and (1, 1) can move along (0, 1), the body ...": for each body
/// with a part in them the motions that are the columns, motions_of(bodies) x any number, of those
/// that rigid_motions() gives.
std::string describe(const std::vector<FreeBody> &bodies, int dim, const Matrix &motions);

} // namespace rbvi
