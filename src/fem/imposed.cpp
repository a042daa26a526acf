#include "rbvi/fem/imposed.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/par/collective.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// What one boundary imposes on a dof of this rank.
struct Value {
  double value = 0;
  int boundary = -1; ///< -1: none
};

/// By local node * components + component, one entry for each boundary that fixes it.
std::vector<std::vector<Value>> values_by_boundary(const Scene &scene, const FullMu &mu,
                                                   const Mesh &mesh) {
  std::vector<std::vector<Value>> result(mesh.points.size() *
                                         static_cast<std::size_t>(scene.components));
  for (int b = 0; b < static_cast<int>(scene.fixed.size()); ++b) {
    const FixedBoundary &part = scene.fixed[b];
    const std::vector<bool> &on_boundary = mesh.boundary.at(part.name);
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
      if (!on_boundary[v]) continue;
      const Point value = imposed_value(scene, mu, b, mesh.points[v]);
      for (int c = 0; c < scene.components; ++c)
        if (part.components.empty() ||
            std::ranges::find(part.components, c) != part.components.end())
          result[v * static_cast<std::size_t>(scene.components) + static_cast<std::size_t>(c)]
              .push_back({value[c], b});
    }
  }
  return result;
}

Error contradiction(const Scene &scene, const FullMu &mu, const Point &at, const Value &one,
                    const Value &other) {
  const auto name = [&](const Value &value) {
    return "'" + scene.fixed[value.boundary].name + "'";
  };
  return bad_input(
      "the boundaries " + name(one) + " and " + name(other) + " impose different displacements, " +
      short_number(one.value) + " and " + short_number(other.value) + " (" +
      short_number(std::abs(one.value - other.value)) + " apart), at their common point (" +
      short_number(at[0]) + ", " + short_number(at[1]) + ", " + short_number(at[2]) + ") at " +
      describe(scene.parameters, mu) + ": make them agree, or fix fewer components there");
}

} // namespace

void check_imposed(const Scene &scene, const FullMu &mu, const Mesh &mesh, const Dofs &dofs) {
  std::vector<std::vector<Value>> values;
  collectively(dofs.comm, [&] { values = values_by_boundary(scene, mu, mesh); });
  double largest = 0;
  for (const std::vector<Value> &here : values)
    for (const Value &one : here)
      largest = std::max(largest, std::abs(one.value));
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, dofs.comm);
  collectively(dofs.comm, [&] {
    for (std::size_t i = 0; i < values.size(); ++i)
      for (const Value &other : values[i])
        if (const Value &one = values[i].front();
            std::abs(one.value - other.value) > 1e-10 * largest)
          throw contradiction(
              scene, mu, mesh.points[i / static_cast<std::size_t>(scene.components)], one, other);
  });
}

Vector natural_imposed(const Scene &scene, const FullMu &mu, const Mesh &mesh, const Dofs &dofs) {
  const Vector local = imposed_values(scene, mu, mesh.points, dofs.imposed_by);
  Vector natural = Vector::Zero(dofs.total);
  for (Index i = 0; i < local.size(); ++i) {
    const auto node = static_cast<std::size_t>(i / dofs.components);
    if (mesh.owned_node[node])
      natural[mesh.natural_node[node] * dofs.components + i % dofs.components] = local[i];
  }
  over_ranks(dofs.comm, MPI_SUM, natural);
  return natural;
}

ImposedEnergy make_imposed_energy(const Scene &scene, const Mesh &mesh, const Dofs &dofs) {
  ImposedEnergy energy{imposed_energy(scene), {}, {}};
  energy.split = split_sum(energy.sum, scene.parameters);
  for (const ExactGroup &group : energy.split.exact) {
    std::vector<WeightedForm> forms;
    double of_means = 0;
    for (const auto &[term, weight] : group.members) {
      const Form &form = energy.sum[term].form;
      if (form.kernel) forms.push_back({&form, weight});
      for (const Mean &mean : form.means)
        of_means += weight * (mean.direction[0] + mean.direction[1] + mean.direction[2]);
    }
    energy.exact.push_back(of_means + integral(forms, {}, mesh, dofs, {}));
  }
  return energy;
}

double energy_at(const ImposedEnergy &energy, const Scene &scene, const FullMu &mu,
                 const Mesh &mesh, const Dofs &dofs, const MappedVertices &mapped) {
  const std::vector<double> theta =
      exact_coefficients(energy.sum, energy.split, scene.parameters, mu);
  double result = 0;
  for (std::size_t q = 0; q < theta.size(); ++q)
    result += theta[q] * energy.exact[q];
  std::vector<WeightedForm> forms;
  for (const int term : energy.split.mapped)
    forms.push_back({&energy.sum[term].form});
  return forms.empty() ? result : result + integral(forms, mu, mesh, dofs, mapped);
}

FullMu generic_point(const ParameterSpace &space) {
  Mu mu;
  for (int i = 0; i < space.size(); ++i) {
    const double part = std::fmod(0.6180339887 * (i + 1), 1.0);
    mu.push_back(space.at(i).lower + part * (space.at(i).upper - space.at(i).lower));
  }
  return expand(space, mu);
}

} // namespace rbvi
