// The patch test with Coulomb friction: one block on a flat support carries a constant stress
// exactly, whether its foot sticks or slips, of degree 1 and 2.
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi {
namespace {

constexpr double height = 0.5;

Scene block(const std::string &degree, const std::string &friction = "coulomb") {
  Scene scene =
      make_scene("patch", {{"bodies", "one"}, {"degree", degree}, {"friction", friction}});
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

/// Largest difference of the displacement, the motion included.
double displacement_error(const Problem &problem, const Mu &mu, const Exact &exact,
                          const HfSolution &s) {
  const Mesh &mesh = problem.mesh();
  double worst = 0;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const Point &x = mesh.points[v], motion = problem.scene().motion(mu, x);
    const Index dof = 2 * mesh.natural_node[v];
    const double across = motion[0] + s.u[dof], down = motion[1] + s.u[dof + 1];
    worst = std::max({worst, std::abs(across - exact.slip - (mu[1] - exact.slip) * x[1] / height),
                      std::abs(down + mu[0] * x[1] / height)});
  }
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE, MPI_MAX, problem.comm());
  return worst;
}

void expect_exact(const Scene &scene, const Mu &mu, bool frictionless = false) {
  SCOPED_TRACE(describe(scene.parameters, mu));
  Problem problem(PETSC_COMM_WORLD, scene, {});
  const HfSolution s = HighFidelity(problem, {}).solve(mu);
  const Exact exact(mu, frictionless);
  const Index count = problem.support().curve.vertices;
  EXPECT_LE((s.lambda.head(count).array() - exact.pressure).abs().maxCoeff(),
            1e-12 * exact.pressure);
  if (!frictionless) {
    EXPECT_LE((s.lambda.tail(count).array() - exact.stress).abs().maxCoeff(),
              1e-12 * exact.pressure);
  }
  EXPECT_LE(displacement_error(problem, mu, exact, s), 1e-12 * mu[0]);
  EXPECT_LE(s.kkt.largest(), 1e-12);
  EXPECT_NEAR(*s.outputs.normal_force, exact.pressure, 1e-12 * exact.pressure);
  EXPECT_NEAR(*s.outputs.reaction, exact.pressure, 1e-12 * exact.pressure);
  EXPECT_NEAR(*s.outputs.peak_pressure, exact.pressure, 1e-12 * exact.pressure);
  EXPECT_NEAR(*s.outputs.centre_pressure, exact.pressure, 1e-11 * exact.pressure);
  EXPECT_NEAR(*s.outputs.contact_half_width, 0.5, 1e-13);
}

TEST(PatchFriction, AFootThatSticksIsExact) {
  for (const std::string degree : {"1", "2"}) {
    expect_exact(block(degree), {0.05, 0.02, 0.3});
    expect_exact(block(degree), {0.01, 0.0, 0.5});
    expect_exact(block(degree), {0.1, 0.19, 1});
  }
}

TEST(PatchFriction, AFootThatSlipsIsExact) {
  for (const std::string degree : {"1", "2"}) {
    expect_exact(block(degree), {0.05, 0.2, 0.3});
    expect_exact(block(degree), {0.02, 0.1, 0.01});
  }
}

TEST(PatchFriction, WithoutFrictionTheFootSlidesFreely) {
  for (const std::string degree : {"1", "2"}) {
    expect_exact(block(degree, "none"), {0.05, 0.1, 0.3}, true);
    expect_exact(block(degree), {0.05, 0.1, 0});
  }
}

TEST(PatchFriction, UzawaFindsTheSame) {
  for (const Mu &mu : {Mu{0.05, 0.02, 0.3}, Mu{0.05, 0.2, 0.3}}) {
    Problem problem(PETSC_COMM_SELF, block("1"), {});
    HfOptions options;
    options.method = HfMethod::uzawa;
    options.uzawa_tolerance = 1e-11;
    const HfSolution s = HighFidelity(problem, options).solve(mu);
    const Exact exact(mu, false);
    const Index count = problem.support().curve.vertices;
    EXPECT_LE((s.lambda.head(count).array() - exact.pressure).abs().maxCoeff(),
              1e-6 * exact.pressure);
    EXPECT_LE((s.lambda.tail(count).array() - exact.stress).abs().maxCoeff(),
              1e-6 * exact.pressure);
  }
}

} // namespace
} // namespace rbvi
