// The part of a simplex on which a condition holds, as simplices.
#pragma once

#include "rbvi/element/quadrature.hpp"

#include <functional>
#include <vector>

namespace rbvi {

using Barycentric = std::array<double, 4>;

/// A simplex in another one, by the barycentric coordinates of its corners there.
struct Piece {
  int dim;
  std::array<Barycentric, 4> corners;

  /// A point of it in coordinates of the whole.
  Barycentric at(const Barycentric &own) const;
  /// Its measure over that of the whole.
  double share() const;
};

/// Simplices that fill the part where `holds`: of triangles and tetrahedra. What bounds it is
/// straight in each of them; the whole is halved where it passes, until edges are an eighth of it
/// (of a tetrahedron a quarter). It passes where points a quarter of an edge apart differ.
std::vector<Piece> pieces_where(int dim, const std::function<bool(const Barycentric &)> &holds);

} // namespace rbvi
