// Outputs that a scene has under names of its own (Scene::outputs), of full and of reduced answers
// alike. On a contact interface they are of its whole boundary, with straight pieces between its
// vertices on which pressure and tangential stress are linear, and displacement, gap and slip of
// degree 2 (contact_lines); elsewhere of cells of the mesh with their functions
// (element/output_cells.hpp).
// Axisymmetric: of the whole circumference.
#pragma once

#include "rbvi/contact/contact.hpp"
#include "rbvi/element/output_cells.hpp"
#include "rbvi/element/output_sums.hpp"

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
  double least_pressure = 0;       ///< with at most so much a node counts as out of contact
  std::vector<std::string> only{}; ///< outputs that are taken (is_asked)
};

/// Sets Outputs::named. `lambda`: at the dual dofs. NaN: an extremum or a mean over nothing, a slip
/// where nothing is faced.
void add_named_outputs(const Scene &scene, const Contact &contact, const FullMu &mu,
                       const OutputSources &sources, const Vector &lambda, Outputs &outputs);

/// Sets Outputs::gap_error, the largest of all interfaces, where the scene asks for it.
void add_gap_error(const Scene &scene, const Contact &contact, const FullMu &mu,
                   const std::function<Vector(std::size_t i)> &of_interface, const Vector &lambda,
                   Outputs &outputs);

/// The boundary of a contact interface in the plane as straight lines for integrals over it. They
/// are cut where contact and stick end, and where the tangential stress
/// and the slip change their sign, so that their magnitudes are as smooth. Fields at both ends of a
/// line and at its middle, between which they are of degree 2.
struct ContactLine {
  std::array<OutputFields, 3> fields;
  /// What conditions see: where contact ends inside an edge the pressure falls to zero up to there,
  /// and the gap grows from there on. (The multipliers, whose integrals are forces, fall to zero at
  /// the next vertex.)
  std::array<OutputFields, 3> seen;
  double measure; ///< the integral of 1 is the sum of these, of whole lines
};

/// `grid`: ContactInterface::fields; `bound`: of the tangential stress; a node with a pressure of
/// at most `least` is out of contact. Contact and stick end inside an edge where way_into_edge says
/// (contact_area.hpp); of pressures that are constant on edges they are of whole edges, and by
/// Nitsche's method they end where P_n, or what |P_tau| is below its bound, is zero, linear between
/// the vertices.
std::vector<ContactLine> contact_lines(const Grid &grid, const FrictionBound &bound, double least);
/// Adds them to an output; `turned`: axisymmetric.
void add_lines(const std::vector<ContactLine> &lines, bool turned, OutputLines &sums);

} // namespace rbvi
