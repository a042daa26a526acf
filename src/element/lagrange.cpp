#include "rbvi/element/lagrange.hpp"

#include "rbvi/core/error.hpp"

namespace rbvi {

namespace {

std::size_t edges_of(int dim) {
  return static_cast<std::size_t>(dim * (dim + 1) / 2);
}

} // namespace

void check_degree(int degree) {
  if (degree != 1 && degree != 2)
    throw bad_input("the degree of the displacement must be 1 or 2, not " + std::to_string(degree));
}

int nodes_per_cell(int dim, int degree) {
  return degree == 1 ? dim + 1 : (dim + 1) * (dim + 2) / 2;
}

void lagrange_values(int dim, int degree, std::span<const double> barycentric,
                     std::span<double> values) {
  const auto vertices = static_cast<std::size_t>(dim) + 1;
  for (std::size_t i = 0; i < vertices; ++i)
    values[i] = degree == 1 ? barycentric[i] : barycentric[i] * (2 * barycentric[i] - 1);
  if (degree == 1) return;
  for (std::size_t e = 0; e < edges_of(dim); ++e) {
    const auto [i, j] = simplex_edges[e];
    values[vertices + e] = 4 * barycentric[i] * barycentric[j];
  }
}

void lagrange_gradients(int dim, int degree, std::span<const double> barycentric,
                        const Simplex &simplex, std::span<std::array<double, 3>> gradients) {
  const auto vertices = static_cast<std::size_t>(dim) + 1;
  for (std::size_t i = 0; i < vertices; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      gradients[i][c] = (degree == 1 ? 1 : 4 * barycentric[i] - 1) *
                        simplex.gradients(static_cast<Index>(i), static_cast<Index>(c));
  if (degree == 1) return;
  for (std::size_t e = 0; e < edges_of(dim); ++e) {
    const auto [i, j] = simplex_edges[e];
    const double at_i = 4 * barycentric[i], at_j = 4 * barycentric[j];
    for (int c = 0; c < 3; ++c)
      gradients[vertices + e][c] = at_i * simplex.gradients(j, c) + at_j * simplex.gradients(i, c);
  }
}

} // namespace rbvi
