// Contact on triangles, surfaces in space and regions of a membrane, for outputs over them
// (contact/named_outputs.hpp).
#pragma once

#include "rbvi/contact/contact.hpp"
#include "rbvi/element/clipped_simplex.hpp"
#include "rbvi/element/output_sums.hpp"

namespace rbvi {

/// Triangles, of degree 1 or 2, in parts in which all touches, or sticks, or nothing does: what
/// holds at a vertex does up to the middles of its edges, and what holds at two of them between
/// these.
class ContactSurface {
public:
  /// `bound`: of the tangential stress; a node with a pressure of at most `least` is out of
  /// contact.
  ContactSurface(const Grid &grid, const FrictionBound &bound, double least);
  void add_to(OutputLines &sums) const;

  struct Part {
    Piece place; ///< in its triangle
    std::array<bool, 2> touches_sticks;
    Index triangle = 0;
    double area = 0;
  };

private:
  const int *nodes_of(Index triangle) const { return cells_.data() + triangle * per_cell_; }
  OutputFields fields_at(const Part &part, const Barycentric &at) const;

  std::vector<int> cells_;
  int per_cell_;
  Matrix values_; ///< of fields at nodes
  double pull_;   ///< what multipliers count from
  std::vector<Part> parts_;
};

} // namespace rbvi
