// Outputs that a scene has under names of its own (Scene::outputs), of full and of reduced answers
// alike. On a contact interface they are of its whole boundary, with straight pieces between its
// vertices on which pressure, gap, tangential stress, slip and displacement are linear
// (contact/contact_lines.hpp); elsewhere of cells of
// the mesh with their functions (element/output_cells.hpp). Axisymmetric: of the whole
// circumference.
#pragma once

#include "rbvi/contact/contact.hpp"
#include "rbvi/element/output_cells.hpp"

#include <map>

namespace rbvi {

/// Throws bad_input for an output over a contact that the scene does not have.
void check_outputs(const Scene &scene);

/// The nodes of each interface whose contact forces belong to a reaction, by its output.
using ContactShares = std::map<int, std::vector<std::vector<Index>>>;

/// `nodes`: numbers of those of each interface in the whole mesh.
ContactShares contact_shares(const Scene &scene, const OutputCells &cells,
                             const std::vector<std::vector<int>> &nodes);

/// What named outputs are taken from.
struct OutputSources {
  const ContactShares &shares;
  /// Displacements at the nodes of interface number i, without the motion, with the values that
  /// boundaries impose, node * components + c.
  std::function<Vector(std::size_t i)> of_interface;
  std::function<double(int output)> of_cells; ///< values of those apart from contact
  double least_pressure = 0; ///< with at most so much a node counts as out of contact
};

/// Sets Outputs::named. `lambda`: at the dual dofs. NaN: an extremum or a mean over nothing, a slip
/// where nothing is faced.
void add_named_outputs(const Scene &scene, const Contact &contact, const FullMu &mu,
                       const OutputSources &sources, const Vector &lambda, Outputs &outputs);

/// Sets Outputs::gap_error, the largest of all interfaces, where the scene asks for it.
void add_gap_error(const Scene &scene, const Contact &contact, const FullMu &mu,
                   const std::function<Vector(std::size_t i)> &of_interface, const Vector &lambda,
                   Outputs &outputs);

} // namespace rbvi
