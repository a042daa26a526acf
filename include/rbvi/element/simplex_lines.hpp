// The lines that a simplex is summed along.
#pragma once

#include "rbvi/element/clipped_simplex.hpp"
#include "rbvi/element/output_sums.hpp"

namespace rbvi {

/// A simplex of one to three dimensions by lines: of a triangle at the shares r of the way from its
/// first vertex to the opposite edge, of a tetrahedron those of triangles at the shares of the way
/// to the opposite side. The shares are of Gauss, where they are summed, else from end to end.
class SimplexLines {
public:
  SimplexLines(int dim, double size, const OutputLines &lines)
      : dim_(dim), size_(size), places_(lines.places()) {}

  std::size_t count() const { return dim_ == 1 ? 1 : dim_ == 2 ? 3 : 9; }
  Barycentric at(std::size_t line, double s) const {
    if (dim_ == 1) return {1 - s, s, 0, 0};
    const double r = places_[line % 3].s;
    if (dim_ == 2) return {1 - r, r * (1 - s), r * s, 0};
    const double q = places_[line / 3].s;
    return {1 - q, q * (1 - r), q * r * (1 - s), q * r * s};
  }
  /// Over the length of the line.
  double measure(std::size_t line) const {
    if (dim_ == 1) return size_;
    const auto &[r, weight] = places_[line % 3];
    if (dim_ == 2) return 2 * size_ * r * weight;
    const auto &[q, of_layer] = places_[line / 3];
    return 6 * size_ * q * q * of_layer * r * weight;
  }

private:
  int dim_;
  double size_;
  const std::array<OutputLines::Place, 3> &places_;
};

/// Adds a simplex of this measure to an output: of a triangle and a tetrahedron the parts where the
/// condition of the output holds. `fields`: at barycentric coordinates; `weight(fields)`: of its
/// measure there.
template <class Fields, class Weight>
void add_simplex(int dim, double size, const Fields &fields, const Weight &weight,
                 OutputLines &lines) {
  const auto weight_of = [&](const SimplexLines &own) {
    return [&](std::size_t line, const OutputFields &at) { return own.measure(line) * weight(at); };
  };
  if (dim == 1 || !lines.is_conditional()) {
    const SimplexLines own(dim, size, lines);
    return lines.add(
        own.count(), [&](std::size_t line, double s) { return fields(own.at(line, s)); },
        weight_of(own));
  }
  for (int image = 0; image < lines.images(); ++image)
    for (const Piece &piece :
         pieces_where(dim, [&](const Barycentric &at) { return lines.holds(image, fields(at)); })) {
      const SimplexLines own(dim, size * piece.share(), lines);
      lines.add_whole(
          image, own.count(),
          [&](std::size_t line, double s) { return fields(piece.at(own.at(line, s))); },
          weight_of(own));
    }
}

} // namespace rbvi
