// The boundary of a contact interface as straight lines for integrals over it. They are cut where
// contact and stick end, and where the tangential stress and the slip change their sign, so that
// their magnitudes are linear, too.
#pragma once

#include "rbvi/core/formula.hpp"
#include "rbvi/io/vtu.hpp"
#include "rbvi/method/node_laws.hpp"

#include <array>
#include <vector>

namespace rbvi {

/// Fields at both ends of a line, between which they are linear.
struct ContactLine {
  std::array<OutputFields, 2> fields;
  /// What conditions see: where contact ends inside an edge the pressure falls to zero up to there,
  /// and the gap grows from there on. (The multipliers, whose integrals are forces, fall to zero at
  /// the next vertex.)
  std::array<OutputFields, 2> seen;
};

/// `grid`: ContactInterface::fields; `bound`: of the tangential stress; a node with a pressure of
/// at most `least` is out of contact. Contact and stick end inside an edge where way_into_edge says
/// (contact_area.hpp); of pressures that are constant on edges they are of whole edges, and by
/// Nitsche's method they end where P_n, or what |P_tau| is below its bound, is zero, linear between
/// the vertices.
std::vector<ContactLine> contact_lines(const Grid &grid, const FrictionBound &bound, double least);

} // namespace rbvi
