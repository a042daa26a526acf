// Load, contact and the flux through the rim of a membrane.
#include "rbvi/core/error.hpp"
#include "rbvi/core/formula.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/fem/assembly.hpp"
#include "rbvi/fem/body_balance.hpp"
#include "rbvi/par/collective.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// Stresses of a membrane at the nodes of the cells beside its rim.
class Rim {
public:
  Rim(const Problem &problem, const FullMu &mu)
      : mesh_(problem.mesh()), dofs_(problem.dofs()), mu_(mu), beside_(mesh_.cells.size(), false),
        mapped_(mesh_.points) {
    std::vector<std::size_t> vertices;
    for (std::size_t k = 0; k < mesh_.cells.size(); ++k) {
      beside_[k] = std::ranges::any_of(nodes_of(mesh_, k),
                                       [&](int node) { return node >= 0 && is_held(node); });
      for (int i = 0; i <= mesh_.dim && beside_[k]; ++i)
        vertices.push_back(static_cast<std::size_t>(mesh_.cells[k][i]));
    }
    std::vector<Point> points;
    for (const std::size_t vertex : vertices)
      points.push_back(mesh_.points[vertex]);
    points = images(problem.scene().map, mu, points);
    for (std::size_t i = 0; i < vertices.size(); ++i)
      mapped_[vertices[i]] = points[i];
  }

  /// Adds what a term of a has in the rows of held dofs. Whether a constant does no work in it, as
  /// far as these cells, or the first one, tell.
  bool add(const Term &term, const Vector &u, MembraneForces &forces) const {
    if (!term.form.kernel || !term.form.boundary.empty()) return false;
    const double theta = term.theta ? coefficient_of(term, mu_) : 1;
    std::array<double, most_nodes * most_nodes> values{};
    bool first = true;
    for (const CellFacet &at : places_of(mesh_, term.form)) {
      if (!beside_[at.cell] && !std::exchange(first, false)) continue;
      const auto nodes = nodes_of(mesh_, at.cell);
      const Index count = nodes_per_cell(mesh_.dim, mesh_.degree);
      const Cell cell = term.theta ? cell_of(mesh_, at.cell) : cell_of(mesh_, at.cell, mapped_);
      term.form.kernel(term.theta ? FullMu{} : mu_, cell, values.data());
      const Eigen::Map<const Matrix> k(values.data(), count, count);
      if (!(k.colwise().sum().cwiseAbs().maxCoeff() <= round_off * k.cwiseAbs().maxCoeff()))
        return false;
      for (Index i = 0; i < count; ++i) {
        if (!is_held(nodes[i])) continue;
        double stress = 0;
        for (Index j = 0; j < count; ++j)
          stress += theta * k(i, j) * u[mesh_.natural_node[nodes[j]]];
        forces.flux += stress;
        forces.sizes += std::abs(stress);
      }
    }
    return true;
  }

private:
  static constexpr double round_off = 1e-10;
  bool is_held(int node) const { return dofs_.free[node] < 0; }

  const Mesh &mesh_;
  const Dofs &dofs_;
  const FullMu &mu_;
  std::vector<bool> beside_; ///< per owned cell: it has a held node
  MappedVertices mapped_;    ///< of these cells
};

/// What contact pushes held nodes with.
double contact_of_held(const Problem &problem, const FullMu &mu, const Vector &lambda) {
  const Contact &contact = problem.contact();
  double force = 0;
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    const ContactInterface &interface = *contact.interfaces[i];
    const std::vector<int> &dofs = interface.mesh().dofs;
    if (std::ranges::none_of(dofs, [](int dof) { return dof < 0; })) continue;
    const Vector forces = interface.nodal_forces(
        mu, {}, lambda.segment(contact.first_row[i], interface.dual().size()));
    for (std::size_t node = 0; node < dofs.size(); ++node)
      if (dofs[node] < 0) force -= forces[static_cast<Index>(node)];
  }
  return force;
}

} // namespace

std::optional<MembraneForces> forces_on_membrane(const Problem &problem, const FullMu &mu,
                                                 const Vector &u, const Vector &lambda,
                                                 const Outputs &outputs) {
  const Scene &scene = problem.scene();
  if (scene.components != 1 || !scene.materials.empty() || !problem.free_bodies().empty())
    return std::nullopt;
  const auto &[load, held, sizes] = problem.f_terms().sums;
  MembraneForces forces{.load = load, .flux = -held, .sizes = sizes};
  std::vector<int> unknown{0};
  collectively(problem.comm(), [&] {
    const Rim rim(problem, mu);
    for (const Term &term : scene.a)
      if (unknown[0] == 0) unknown[0] = rim.add(term, u, forces) ? 0 : 1;
  });
  over_ranks(problem.comm(), MPI_MAX, unknown);
  if (unknown[0] != 0) return std::nullopt;
  std::array<double, 3> sums{forces.load, forces.flux, forces.sizes};
  over_ranks(problem.comm(), MPI_SUM, sums);
  forces.load = sums[0];
  forces.sizes = sums[2];
  for (std::size_t i = 0; i < problem.contact().interfaces.size(); ++i) {
    ContactInterface &interface = *problem.contact().interfaces[i];
    const Outputs &one = outputs.interfaces.empty() ? outputs : outputs.interfaces[i];
    const double force = one.normal_force.value_or(0) / image_count(scene.mirrors) -
                         pull_of(interface, mu, {}).normal_force; // a load
    forces.contact += scene.contacts[i].push * force;
    forces.sizes += std::abs(force);
  }
  forces.flux = sums[1] - contact_of_held(problem, mu, lambda);
  return forces;
}

void check_membrane(const Problem &problem, const FullMu &mu, const Vector &u, const Vector &lambda,
                    const Outputs &outputs, double tolerance, double round_off) {
  const auto forces = forces_on_membrane(problem, mu, u, lambda, outputs);
  if (!forces || std::abs(forces->left()) <= tolerance * forces->sizes + round_off) return;
  throw failure("the forces on the membrane of '" + joined(problem.contact().names) +
                "' do not balance: the load " + short_number(forces->load) + ", contact " +
                short_number(forces->contact) + " and what holds it " + short_number(forces->flux) +
                " leave " + short_number(forces->left()));
}

} // namespace rbvi
