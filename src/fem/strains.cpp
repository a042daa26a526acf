#include "rbvi/fem/assembly.hpp"
#include "rbvi/fem/problem.hpp"
#include "rbvi/par/collective.hpp"

#include <numbers>

namespace rbvi {

double strained_share(const Problem &problem, const FullMu &mu, const Vector &u) {
  const Mesh &mesh = problem.mesh();
  const int count = nodes_per_cell(mesh.dim, mesh.degree), dim = mesh.dim;
  std::vector<double> volumes{0, 0}; // of what is strained, of all
  std::array<double, 4> middle{};
  std::fill_n(middle.begin(), dim + 1, 1.0 / (dim + 1));
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    Cell cell = cell_of(mesh, k);
    map_cell(problem.scene(), mu, cell);
    const Simplex geometry = simplex(dim, cell.mapped);
    std::array<std::array<double, 3>, most_nodes> slopes{};
    lagrange_gradients(dim, mesh.degree, middle, geometry, slopes);
    const std::array<int, most_nodes> nodes = nodes_of(mesh, k);
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    for (int i = 0; i < count; ++i)
      for (int c = 0; c < dim; ++c)
        gradient.row(c) +=
            u[mesh.natural_node[nodes[i]] * dim + c] * Eigen::RowVector3d::Map(slopes[i].data());
    const double volume = geometry.volume * circumference(problem.scene().axisymmetric,
                                                          point_at(cell.mapped, middle, dim + 1));
    volumes[1] += volume;
    const double strain = (gradient + gradient.transpose()).norm() / 2,
                 turn = (gradient - gradient.transpose()).norm() / (2 * std::numbers::sqrt2);
    if (std::max(strain, turn) > large_strain) volumes[0] += volume;
  }
  over_ranks(problem.comm(), MPI_SUM, volumes);
  return volumes[0] / volumes[1];
}

} // namespace rbvi
