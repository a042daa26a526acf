#include "means.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/facet_forms.hpp"
#include "rbvi/element/facets.hpp"
#include "rbvi/fem/assembly.hpp"
#include "rbvi/fem/imposed.hpp"
#include "rbvi/par/collective.hpp"

#include <cmath>
#include <map>

namespace rbvi {

std::string boundaries_of(const std::vector<Mean> &means) {
  std::vector<std::string> names;
  for (const Mean &mean : means)
    names.push_back("'" + mean.boundary + "'");
  return joined(names, " and ");
}

namespace {

/// Adds the integral of the direction over a boundary, and its size times |direction|^2.
void add_integral(const Mean &mean, const Mesh &mesh, const Dofs &dofs, Vector &integral,
                  double &size) {
  const Form load = traction_load(
      mean.boundary, [&](const FullMu &, const Point &, const Point &) { return mean.direction; },
      dofs.components, mesh.degree, mean.axisymmetric);
  std::array<double, 3 * most_nodes> values{};
  for (const auto &[cell, facet] : mesh.facets.at(mean.boundary)) {
    load.kernel({}, facet_cell(cell_of(mesh, cell), facet), values.data());
    const auto nodes = nodes_of(mesh, cell);
    const double *next = values.data();
    for (const int node : facet_nodes(mesh.dim, mesh.degree, facet))
      for (int c = 0; c < dofs.components; ++c, ++next) {
        integral[Index{nodes[node]} * dofs.components + c] += *next;
        size += mean.direction[c] * *next;
      }
  }
}

/// Throws bad_input where something that is no unknown changes the functional. Collective.
void check_unmoved(const Scene &scene, const Mesh &mesh, const Dofs &dofs,
                   const std::vector<Mean> &means, const Vector &functional) {
  std::vector<double> moved{0, 0}, imposed{0};
  const FullMu mu = generic_point(scene.parameters);
  for (Index i = 0; i < functional.size(); ++i) {
    if (functional[i] == 0) continue;
    if (!dofs.imposed_by.empty() && dofs.imposed_by[i] >= 0) imposed[0] = 1;
    if (!scene.motion) continue;
    const double part =
        functional[i] * scene.motion(mu, mesh.points[i / dofs.components])[i % dofs.components];
    moved[0] += part;
    moved[1] += std::abs(part);
  }
  over_ranks(mesh.comm, MPI_SUM, moved);
  over_ranks(mesh.comm, MPI_MAX, imposed);
  if (imposed[0] > 0)
    throw bad_input("a spring on " + boundaries_of(means) +
                    " meets a boundary that moves by what is imposed on it: give it a boundary "
                    "without such nodes");
  if (std::abs(moved[0]) > 1e-9 * moved[1])
    throw bad_input("the motion of the bodies stretches the spring on " + boundaries_of(means) +
                    ": impose displacements instead, and leave out 'motion:'");
}

} // namespace

Vector mean_functional(const std::vector<Mean> &means, const Mesh &mesh, const Dofs &dofs) {
  Vector sum = Vector::Zero(std::ssize(dofs.free));
  for (const Mean &mean : means) {
    Vector integral = Vector::Zero(sum.size());
    std::vector<double> size{0};
    add_integral(mean, mesh, dofs, integral, size[0]);
    over_ranks(mesh.comm, MPI_SUM, size);
    sum += std::pow(norm(mean.direction), 2) / size[0] * integral;
  }
  return sum;
}

void add_couplings(const Scene &scene, const Mesh &mesh, Dofs &dofs) {
  constexpr std::size_t most = 3000; // dofs: a dense block of 72 MB
  for (const Term &term : scene.a) {
    const std::vector<Mean> &means = term.form.means;
    if (means.empty()) continue;
    const Vector functional = mean_functional(means, mesh, dofs);
    check_unmoved(scene, mesh, dofs, means, functional);
    std::vector<PetscInt> rows;
    std::vector<double> values;
    for (Index i = 0; i < functional.size(); ++i)
      if (functional[i] != 0 && dofs.free[i] >= 0) {
        rows.push_back(dofs.free[i]);
        values.push_back(functional[i]);
      }
    rows = gather_all(mesh.comm, rows, MPIU_INT);
    values = gather_all(mesh.comm, values, MPI_DOUBLE);
    std::map<PetscInt, double> all;
    for (std::size_t k = 0; k < rows.size(); ++k)
      all[rows[k]] += values[k];
    if (all.size() > most)
      throw bad_input("the spring on " + boundaries_of(means) + " couples " +
                      std::to_string(all.size()) + " displacements with each other, more than " +
                      std::to_string(most) + ": give it a shorter boundary, or a coarser mesh");
    Coupling &coupling = dofs.couplings.emplace_back(Coupling{means, {}, {}});
    for (const auto &[row, value] : all) {
      coupling.rows.push_back(row);
      coupling.values.push_back(value);
    }
  }
}

} // namespace rbvi
