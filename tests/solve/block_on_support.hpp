// The exact state of one block on a rigid support (scene patch), sticking or slipping.
#pragma once

#include "tests/catalogue.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace rbvi::block_on_support {

constexpr double height = 0.5;

/// All parameters free: indentation, shear, friction coefficient.
inline Scene block(const std::string &degree, const std::string &friction = "coulomb",
                   const std::string &formulation = "mixed") {
  Scene scene = make_scene("patch", {{"bodies", "one"},
                                     {"degree", degree},
                                     {"friction", friction},
                                     {"formulation", formulation}});
  scene.parameters = all_free(scene.parameters.all);
  return scene;
}

/// The exact state: mu = (indentation, shear, coefficient).
struct Exact {
  double pressure, stress, slip;
  Exact(const Mu &mu, bool frictionless) {
    const Lame material = lame(15, 0.35);
    pressure = (material.lambda + 2 * material.shear) * mu[0] / height;
    const double most = frictionless ? 0 : mu[2] * pressure;
    stress = std::clamp(material.shear * mu[1] / height, -most, most);
    slip = mu[1] - stress / material.shear * height;
  }
};

/// Largest difference of the displacement, the motion included. Collective.
inline double displacement_error(const Problem &problem, const Mu &mu, const Exact &exact,
                                 const HfSolution &s) {
  const Mesh &mesh = problem.mesh();
  const FullMu all = expand(problem.scene().parameters, mu);
  double worst = 0;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const Point &x = mesh.points[v], motion = problem.scene().motion(all, x);
    const Index dof = 2 * mesh.natural_node[v];
    const double across = motion[0] + s.u[dof], down = motion[1] + s.u[dof + 1];
    worst =
        rbvi::largest({worst, std::abs(across - exact.slip - (mu[1] - exact.slip) * x[1] / height),
                       std::abs(down + mu[0] * x[1] / height)});
  }
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE, MPI_MAX, problem.comm());
  return worst;
}

} // namespace rbvi::block_on_support
