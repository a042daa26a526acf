#include "rbvi/element/cell_fields.hpp"

#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/lagrange.hpp"

#include <map>
#include <numeric>

namespace rbvi {

namespace {

using Tensor = Eigen::Matrix3d;

/// Rows and columns of the components, a plane body's first.
constexpr std::array<std::array<int, 2>, 6> entries_of_stress{
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}}};

Index component_count(int dim) {
  return dim == 2 ? 4 : 6;
}

Cell cell_of(const Scene &scene, const FullMu &all_parameters, const Matrix &points,
             const int *nodes) {
  Cell cell{scene.dim, {}, {}};
  for (int i = 0; i <= scene.dim; ++i)
    for (Index k = 0; k < points.cols(); ++k)
      cell.reference[i][k] = points(nodes[i], k);
  map_cell(scene, all_parameters, cell);
  return cell;
}

std::size_t vertices_of(int dim) {
  return static_cast<std::size_t>(dim) + 1;
}

/// sigma = lambda tr(eps) I + 2 shear eps, for the gradient of a displacement.
Tensor stress(const Lame &material, const Tensor &gradient) {
  const Tensor strain = (gradient + gradient.transpose()) / 2;
  return material.lambda * strain.trace() * Tensor::Identity() + 2 * material.shear * strain;
}

/// Of the displacement, a row a component.
Tensor gradient_at(const Scene &scene, const DisplacedCell &cell,
                   const std::array<double, 4> &barycentric) {
  std::array<std::array<double, 3>, most_nodes> gradients{};
  lagrange_gradients(scene.dim, scene.degree, {barycentric.data(), vertices_of(scene.dim)},
                     simplex(scene.dim, cell.cell.mapped), gradients);
  Tensor gradient = Tensor::Zero();
  for (int i = 0; i < nodes_per_cell(scene.dim, scene.degree); ++i)
    gradient += Eigen::Map<const Eigen::Vector3d>(cell.u[i].data()) *
                Eigen::Map<const Eigen::RowVector3d>(gradients[i].data());
  return gradient;
}

/// The lowest node of a connected part; the path to it is shortened.
int root_of(std::vector<int> &above, int node) {
  while (above[node] != node) {
    int &parent = above[node];
    parent = above[parent];
    node = parent;
  }
  return node;
}

} // namespace

std::vector<std::string> stress_components(int dim) {
  static const std::vector<std::string> names{"sigma_xx", "sigma_yy", "sigma_zz",
                                              "sigma_xy", "sigma_yz", "sigma_xz"};
  return {names.begin(), names.begin() + component_count(dim)};
}

Point displacement_at(const Scene &scene, const DisplacedCell &cell,
                      const std::array<double, 4> &barycentric) {
  std::array<double, most_nodes> values{};
  lagrange_values(scene.dim, scene.degree, {barycentric.data(), vertices_of(scene.dim)}, values);
  Point u{};
  for (int i = 0; i < nodes_per_cell(scene.dim, scene.degree); ++i)
    u = u + values[i] * cell.u[i];
  return u;
}

Point slope_at(const Scene &scene, const DisplacedCell &cell,
               const std::array<double, 4> &barycentric) {
  const Tensor gradient = gradient_at(scene, cell, barycentric);
  return {gradient(0, 0), gradient(0, 1), gradient(0, 2)};
}

PointStress stress_at(const Scene &scene, const FullMu &all_parameters, const DisplacedCell &cell,
                      const std::array<double, 4> &barycentric) {
  Tensor gradient = gradient_at(scene, cell, barycentric);
  if (scene.axisymmetric) { // the hoop strain u_r / r, on the axis its limit
    const auto &corners = cell.cell.mapped;
    const double radius = point_at(corners, barycentric, 3)[0],
                 largest = std::max({corners[0][0], corners[1][0], corners[2][0]});
    gradient(2, 2) = radius <= 1e-10 * largest
                         ? gradient(0, 0)
                         : displacement_at(scene, cell, barycentric)[0] / radius;
  }
  const auto &[regions, material, free_strain] = scene.materials[cell.material];
  const Lame constants = material(all_parameters, reference_centre(cell.cell));
  const bool flat = is_plane_stress(material);
  Tensor sigma = stress(constants, gradient);
  if (free_strain) {
    const double strain =
        free_strain(all_parameters, point_at(cell.cell.reference, barycentric, scene.dim + 1));
    sigma -= swelling_modulus(constants, flat) * strain * Tensor::Identity();
    gradient -= strain * Tensor::Identity();
  }
  if (flat) sigma(2, 2) = 0;
  return {sigma, sigma.cwiseProduct(gradient).sum() / 2};
}

Matrix centre_stresses(const Scene &scene, const FullMu &all_parameters, const Matrix &points,
                       const std::vector<int> &cells, const std::vector<int> &materials,
                       const Vector &displacement) {
  const auto per_cell = static_cast<std::size_t>(nodes_per_cell(scene.dim, scene.degree));
  std::array<double, 4> centre{};
  std::fill_n(centre.begin(), vertices_of(scene.dim), 1.0 / (scene.dim + 1));
  Matrix result(static_cast<Index>(cells.size() / per_cell), component_count(scene.dim));
  for (Index k = 0; k < result.rows(); ++k) {
    const int *nodes = cells.data() + static_cast<std::size_t>(k) * per_cell;
    DisplacedCell cell{cell_of(scene, all_parameters, points, nodes),
                       materials.empty() ? 0 : materials[k]};
    for (std::size_t i = 0; i < per_cell; ++i)
      for (int c = 0; c < 3; ++c)
        cell.u[i][c] = displacement[3 * Index{nodes[i]} + c];
    const Tensor sigma = stress_at(scene, all_parameters, cell, centre).sigma;
    for (Index c = 0; c < result.cols(); ++c) {
      const auto [i, j] = entries_of_stress[c];
      result(k, c) = sigma(i, j);
    }
  }
  return result;
}

Vector von_mises(const Matrix &stresses) {
  const Vector mean = stresses.leftCols(3).rowwise().mean();
  const Vector normal = (stresses.leftCols(3).colwise() - mean).rowwise().squaredNorm();
  const Vector shear = stresses.rightCols(stresses.cols() - 3).rowwise().squaredNorm();
  return (1.5 * (normal + 2 * shear)).cwiseSqrt();
}

Vector body_numbers(const std::vector<int> &cells, int per_cell, Index nodes, int first_node) {
  std::vector<int> above(nodes);
  std::iota(above.begin(), above.end(), 0);
  const auto step = static_cast<std::size_t>(per_cell);
  for (std::size_t k = 0; k < cells.size(); k += step)
    for (std::size_t i = 1; i < step; ++i) {
      const int a = root_of(above, cells[k]), b = root_of(above, cells[k + i]);
      above[std::max(a, b)] = std::min(a, b);
    }
  std::map<int, int> numbers{{root_of(above, first_node), 1}};
  Vector result(static_cast<Index>(cells.size() / step));
  for (std::size_t k = 0; k < cells.size(); k += step) {
    const int next = static_cast<int>(numbers.size()) + 1;
    result[k / step] = numbers.try_emplace(root_of(above, cells[k]), next).first->second;
  }
  return result;
}

void straighten_edges(const std::vector<int> &cells, int dim, int degree, Matrix &rows) {
  const auto per_cell = static_cast<std::size_t>(nodes_per_cell(dim, degree));
  const auto vertices = static_cast<std::size_t>(dim) + 1;
  for (std::size_t k = 0; k < cells.size(); k += per_cell)
    for (std::size_t e = 0; vertices + e < per_cell; ++e) {
      const auto [i, j] = simplex_edges[e];
      rows.row(cells[k + vertices + e]) = (rows.row(cells[k + static_cast<std::size_t>(i)]) +
                                           rows.row(cells[k + static_cast<std::size_t>(j)])) /
                                          2;
    }
}

} // namespace rbvi
