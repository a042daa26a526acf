// The patch test under a rigid half-plane that is tilted: a block turned by any angle carries a
// constant pressure, and a constant shear where it rubs, exactly.
#include "rbvi/contact/support.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::tilted_patch_test {
namespace {

constexpr double height = 0.5, young = 15, poisson = 0.35;

enum Position { angle, squeeze, slip, shear, friction };
constexpr double pushed = -0.02; // the position of the plane

/// Pressure per strain where nothing moves sideways, and shear modulus.
double modulus() {
  return young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson));
}
double shear_modulus() {
  return young / (2 * (1 + poisson));
}

/// Strain `squeeze` along the normal of the plane, which has pushed the foot, shear along it, slip
/// of the foot: linear in the height of the reference point over the foot.
Point exact(const FullMu &mu, const Point &x) {
  const Point n{std::sin(mu[angle]), -std::cos(mu[angle]), 0}, tau{-n[1], n[0], 0};
  const double down = pushed + mu[squeeze] * x[1], along = mu[slip] + mu[shear] * x[1];
  return {down * n[0] + along * tau[0], down * n[1] + along * tau[1], 0};
}

/// The block [0, 1] x [0, 1/2] turned by an angle about a corner, on a plane that is turned as
/// well; the exact displacement is imposed on all other sides.
Scene turned_block(int degree, FrictionLaw law, const std::function<Coefficient> &limit = {}) {
  Scene scene = make_scene("patch", {{"bodies", "one"}, {"friction", "none"}});
  scene.degree = degree;
  scene.parameters = all_free({{"angle", "", -3, 3, 0},
                               {"squeeze", "", 0, 0.2, 0.05},
                               {"slip", "", -1, 1, 0},
                               {"shear", "", -1, 1, 0},
                               {"friction", "", 0, 1, 0.3}});
  scene.check_parameters = {};
  scene.map = [](const FullMu &mu, const Point &x) {
    const double c = std::cos(mu[angle]), s = std::sin(mu[angle]);
    return Point{c * x[0] - s * x[1], s * x[0] + c * x[1], 0};
  };
  scene.motion = nullptr;
  scene.f.clear();
  scene.a = {mapped_term(elasticity("", lame(young, poisson), degree))};
  scene.v_product = {exact_term(h1_product(1, 2, degree))};
  scene.fixed = {{"sides", {}, {{exact}}}, {"top", {}, {{exact}}}};
  RigidSurface plane{"contact", plane_surface({0, -1, 0}, {}, constant(pushed), parameter(angle))};
  if (law != FrictionLaw::none) plane.friction = {law, parameter(friction), false, limit};
  scene.contacts = {rigid_surface(plane)};
  return scene;
}

/// Largest difference of the displacement from the exact one. Collective.
double largest_error(const Problem &problem, const Mu &mu, const HfSolution &solution) {
  const Mesh &mesh = problem.mesh();
  double worst = 0;
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    for (int c = 0; c < 2; ++c) {
      const Point expected = exact(expand(problem.scene().parameters, mu), mesh.points[v]);
      worst = larger(worst, std::abs(solution.u[mesh.natural_node[v] * 2 + c] - expected[c]));
    }
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE, MPI_MAX, problem.comm());
  return worst;
}

/// The pressure is constant and, with friction, so is the tangential stress.
void expect_exact(const Scene &scene, const Mu &mu) {
  for (const int refine : {0, 1}) {
    Problem problem(PETSC_COMM_WORLD, scene, {"", refine});
    const HfSolution solution = HighFidelity(problem, {}).solve(mu);
    const double pressure = modulus() * mu[squeeze], stress = shear_modulus() * mu[shear];
    const Index nodes = problem.contact().nodes();
    EXPECT_LE((solution.lambda.head(nodes).array() - pressure).abs().maxCoeff(), 1e-11 * pressure);
    if (has_friction(scene)) {
      EXPECT_LE((solution.lambda.tail(nodes).array() - stress).abs().maxCoeff(), 1e-11 * pressure);
    }
    EXPECT_LE(largest_error(problem, mu, solution), 1e-13);
    EXPECT_NEAR(*solution.outputs.normal_force, pressure, 1e-11 * pressure);
    EXPECT_LE(*solution.outputs.max_penetration, 1e-13);
  }
}

TEST(TiltedPatch, UniformPressureIsExact) {
  for (const int degree : {1, 2})
    for (const double turned : {0.0, 0.4, -1.1, 2.5}) {
      SCOPED_TRACE("degree " + std::to_string(degree) + ", angle " + std::to_string(turned));
      // Without friction the foot slides freely and carries no shear.
      expect_exact(turned_block(degree, FrictionLaw::none), {turned, 0.05, 0.02, 0, 0.3});
    }
}

TEST(TiltedPatch, SoIsAShearThatSticks) {
  const double most = 0.3 * modulus() * 0.05 / shear_modulus();
  for (const int degree : {1, 2})
    for (const double part : {-0.8, 0.5}) {
      SCOPED_TRACE("degree " + std::to_string(degree) + ", part " + std::to_string(part));
      expect_exact(turned_block(degree, FrictionLaw::coulomb), {0.4, 0.05, 0, part * most, 0.3});
    }
}

/// Coulomb's and Tresca's bound hold with equality against the slip, and so does a limit.
TEST(TiltedPatch, SoIsAShearThatSlides) {
  const double pressure = modulus() * 0.05;
  for (const int degree : {1, 2})
    for (const double sign : {-1.0, 1.0}) {
      SCOPED_TRACE("degree " + std::to_string(degree) + ", towards " + std::to_string(sign));
      expect_exact(turned_block(degree, FrictionLaw::coulomb),
                   {0.4, 0.05, sign * 0.03, sign * 0.3 * pressure / shear_modulus(), 0.3});
      expect_exact(turned_block(degree, FrictionLaw::tresca),
                   {0.4, 0.05, sign * 0.03, sign * 0.3 / shear_modulus(), 0.3});
      expect_exact(turned_block(degree, FrictionLaw::coulomb, constant(0.2 * pressure)),
                   {0.4, 0.05, sign * 0.03, sign * 0.2 * pressure / shear_modulus(), 0.3});
    }
}

} // namespace
} // namespace rbvi::tilted_patch_test
