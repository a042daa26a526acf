// The imposed displacements of a scene (element/imposed.hpp) on a distributed mesh.
#pragma once

#include "rbvi/fem/assembly.hpp"

namespace rbvi {

/// Throws bad_input on every rank, naming boundary and mu, where a value is not finite, or where
/// boundaries that meet impose values that differ by more than 1e-10 of the largest. Collective.
void check_imposed(const Scene &scene, const FullMu &mu, const Mesh &mesh, const Dofs &dofs);

/// l(mu) at all dofs in natural order, on every rank. Collective.
Vector natural_imposed(const Scene &scene, const FullMu &mu, const Mesh &mesh, const Dofs &dofs);

/// a(l, l) / 2 - f(l) - f(motion), its exact terms integrated once.
struct ImposedEnergy {
  Sum sum;
  SplitSum split;
  std::vector<double> exact; ///< of each group of split.exact
};

/// Collective.
ImposedEnergy make_imposed_energy(const Scene &scene, const Mesh &mesh, const Dofs &dofs);

/// At mu; `mapped`: the vertices there. Collective.
double energy_at(const ImposedEnergy &energy, const Scene &scene, const FullMu &mu,
                 const Mesh &mesh, const Dofs &dofs, const MappedVertices &mapped);

/// A point of the box that no symmetry singles out: values that contradict each other at almost
/// all mu do so there.
FullMu generic_point(const ParameterSpace &space);

} // namespace rbvi
