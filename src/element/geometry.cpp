#include "rbvi/element/geometry.hpp"

#include "rbvi/core/error.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// Columns: the edges from vertex 0; in 2D the third is e_z.
Eigen::Matrix3d edges_of(int dim, const std::array<Point, 4> &vertices) {
  Eigen::Matrix3d edges = Eigen::Matrix3d::Identity();
  for (int j = 0; j < dim; ++j)
    edges.col(j) = Eigen::Vector3d((vertices[j + 1] - vertices[0]).data());
  return edges;
}

double longest_edge(int dim, const std::array<Point, 4> &vertices) {
  double longest = 0;
  for (int i = 0; i <= dim; ++i)
    for (int j = 0; j < i; ++j)
      longest = std::max(longest, norm(vertices[i] - vertices[j]));
  return longest;
}

} // namespace

Simplex simplex(int dim, const std::array<Point, 4> &vertices) {
  Simplex result;
  const Eigen::Matrix3d edges = edges_of(dim, vertices);
  const double determinant = edges.determinant();
  result.volume = determinant / (dim == 2 ? 2 : 6);
  const Eigen::Matrix3d inverse = edges.inverse();
  result.gradients.setZero();
  for (int j = 0; j < dim; ++j) {
    result.gradients.row(j + 1) = inverse.row(j);
    result.gradients.row(0) -= inverse.row(j);
  }
  return result;
}

std::array<double, 4> barycentric_of(int dim, const std::array<Point, 4> &vertices,
                                     const Point &x) {
  const Simplex geometry = simplex(dim, vertices);
  std::array<double, 4> result{1, 0, 0, 0};
  for (int i = 0; i <= dim; ++i)
    for (int k = 0; k < dim; ++k)
      result[i] += geometry.gradients(i, k) * (x[k] - vertices[0][k]);
  return result;
}

double volume_of(int dim, const std::array<Point, 4> &vertices) {
  return edges_of(dim, vertices).determinant() / (dim == 2 ? 2 : 6);
}

Point reference_centre(const Cell &cell) {
  Point sum{};
  for (int i = 0; i <= cell.dim; ++i)
    sum = sum + cell.reference[i];
  return sum / (cell.dim + 1);
}

void check_orientation(const Scene &scene, const FullMu &mu, const Cell &cell) {
  const double longest = longest_edge(cell.dim, cell.mapped);
  const double size = cell.dim == 2 ? longest * longest : longest * longest * longest;
  if (!(volume_of(cell.dim, cell.mapped) > 1e-12 * size))
    throw failure("the geometric map of scene " + scene.name + " inverts a cell at mu = " +
                  describe(scene.parameters, mu) + ": use a smaller parameter box or a finer mesh");
}

void map_cell(const Scene &scene, const FullMu &mu, Cell &cell) {
  for (int i = 0; i <= cell.dim; ++i)
    cell.mapped[i] = scene.map(mu, cell.reference[i]);
  check_orientation(scene, mu, cell);
}

double aspect_ratio(int dim, const std::array<Point, 4> &vertices) {
  const Simplex cell = simplex(dim, vertices);
  double surface = 0; // sum of facet measures: dim * volume * |gradient| is one facet's
  for (int i = 0; i <= dim; ++i)
    surface += dim * std::abs(cell.volume) * cell.gradients.row(i).norm();
  const double inradius = dim * std::abs(cell.volume) / surface;
  const double regular = dim == 2 ? 2 * std::sqrt(3.0) : 2 * std::sqrt(6.0);
  return longest_edge(dim, vertices) / (regular * inradius);
}

} // namespace rbvi
