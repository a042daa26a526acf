// The same code in three dimensions: a block of tetrahedra over an obstacle in its middle.
#include "../cube_mesh.hpp"
#include "../mesh/temporary_file.hpp"
#include "rbvi/contact/obstacle.hpp"
#include "rbvi/element/scalar_forms.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

namespace rbvi::three_dimensions_test {
namespace {

Scene cube_scene() {
  Scene scene = make_scene("membrane_obstacle");
  scene.dim = 3;
  scene.mesh = {"", {"core"}, {"boundary"}};
  scene.map = [](const FullMu &mu, const Point &x) {
    return Point{x[0], x[1], mu[0] / 0.2 * x[2]};
  };
  scene.curves = {};
  scene.contacts = {obstacle({"core", [](const FullMu &, const Point &) { return -0.5; }})};
  scene.a = {mapped_term(laplace(""))};
  scene.f = {mapped_term(constant_load("", -25))};
  return scene;
}

HfSolution solve(MPI_Comm comm, const std::string &file) {
  Problem problem(comm, cube_scene(), {file, 0});
  return HighFidelity(problem, {}).solve({0.2, 0, 0});
}

TEST(ThreeDimensions, TheActiveSetSolvesAndDoesNotDependOnRanks) {
  const TemporaryFile file(cube_mesh(6));
  const HfSolution world = solve(PETSC_COMM_WORLD, file.name());
  const HfSolution alone = solve(PETSC_COMM_SELF, file.name());
  EXPECT_LE(world.kkt.largest(), 1e-12);
  EXPECT_FALSE(world.active.empty());
  EXPECT_LT(world.active.size(), static_cast<std::size_t>(world.lambda.size()) + 1);
  EXPECT_LE((world.u - alone.u).norm(), 1e-10 * alone.u.norm());
  EXPECT_LE((world.lambda - alone.lambda).norm(), 1e-10 * alone.lambda.norm());
  // Without the obstacle the middle would sink to about -25 * 0.0562 = -1.4.
  EXPECT_GT(*world.outputs.min_u, -1.4);
  EXPECT_LT(*world.outputs.min_u, -0.45);
}

} // namespace
} // namespace rbvi::three_dimensions_test
