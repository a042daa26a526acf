#include "surface_frames.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/element/facets.hpp"

namespace rbvi {

namespace {

FacetMeasure measure_of(const InterfaceMesh &mesh, Index triangle) {
  const int *nodes = mesh.nodes_of(triangle);
  return facet_measure(3, {mesh.points[nodes[0]], mesh.points[nodes[1]], mesh.points[nodes[2]]});
}

std::vector<std::size_t> held_axes(const InterfaceMesh &mesh, std::size_t node) {
  std::vector<std::size_t> held;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (mesh.dofs[3 * node + axis] < 0) held.push_back(axis);
  return held;
}

} // namespace

std::vector<Frame> reference_frames(const InterfaceMesh &mesh, Index vertices) {
  std::vector<Point> sums(static_cast<std::size_t>(vertices), Point{});
  for (Index e = 0; e < mesh.count(); ++e) {
    const auto [size, normal] = measure_of(mesh, e);
    for (std::size_t a = 0; a < 3; ++a) {
      Point &sum = sums[mesh.nodes_of(e)[a]];
      sum = sum + size * normal;
    }
  }
  std::vector<Frame> frames;
  for (const Point &sum : sums) {
    if (!(norm(sum) > 0)) throw bad_input("a surface in contact folds back on itself at a vertex");
    frames.push_back(frame_of(sum / norm(sum), held_axes(mesh, frames.size())));
  }
  return frames;
}

SparseMatrix surface_gram(const InterfaceMesh &mesh, const std::vector<Frame> &frames,
                          bool friction) {
  const auto vertices = static_cast<Index>(frames.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (Index e = 0; e < mesh.count(); ++e) {
    const double size = measure_of(mesh, e).size;
    const int *nodes = mesh.nodes_of(e);
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) {
        const Index i = nodes[a], j = nodes[b];
        const double product = size * (a == b ? 2 : 1) / 12;
        entries.emplace_back(i, j, product);
        for (std::size_t k = 0; k < 2 && friction; ++k)
          for (std::size_t l = 0; l < 2; ++l)
            entries.emplace_back(
                vertices + 2 * i + static_cast<Index>(k), vertices + 2 * j + static_cast<Index>(l),
                product * dot(carried(frames[i], k, frames[j].normal), frames[j].tangents[l]));
      }
  }
  const Index size = (friction ? 3 : 1) * vertices;
  SparseMatrix result(size, size);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

} // namespace rbvi
