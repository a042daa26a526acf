// The assembled problem: facts of the mapped disc, and independence of the number of ranks.
#include "../core/refuses.hpp"
#include "rbvi/contact/support.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/fem/problem.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rbvi::problem_test {
namespace {

TEST(Problem, TheSimilarityScalesBAndG) {
  Problem problem(PETSC_COMM_WORLD, make_scene("membrane_obstacle"), {});
  Operators reference, other;
  problem.assemble_contact({0.2, 0, 0}, reference);
  problem.assemble_contact({0.23, 0.04, -0.01}, other);
  const double scale = std::pow(0.23 / 0.2, 2);
  EXPECT_LT((other.b - scale * reference.b).norm(), 1e-14 * reference.b.norm());
  EXPECT_LT((other.g - scale * reference.g).norm(), 1e-13 * reference.g.norm());
}

/// V's product is (u, v) + L^2 (grad u, grad v): L is what the scene says, or the size of the body,
/// of two blocks the height 1.5. The field is x, whose gradient is 1 on an area of 1.
TEST(Problem, VHasTheLengthOfTheBody) {
  const auto square_of = [](double length) {
    Scene scene = make_scene("patch");
    EXPECT_EQ(scene.v_length, 0);
    scene.v_length = length;
    const Problem problem(PETSC_COMM_WORLD, scene, {});
    const Mesh &mesh = problem.mesh();
    Vector field = Vector::Zero(2 * std::ssize(mesh.points));
    for (std::size_t node = 0; node < mesh.points.size(); ++node)
      field[2 * node] = mesh.points[node][0];
    double square = field.dot(
        product_with(forms_of(problem.scene().v_product), {}, mesh, problem.dofs(), {}, field));
    MPI_Allreduce(MPI_IN_PLACE, &square, 1, MPI_DOUBLE, MPI_SUM, mesh.comm);
    return square;
  };
  EXPECT_NEAR(square_of(0), 1.0 / 3 + 1.5 * 1.5, 1e-12);
  EXPECT_NEAR(square_of(1), 1.0 / 3 + 1, 1e-12) << "as the scene has it";
  EXPECT_EQ(make_scene("two_disks").v_length, 1);
}

TEST(Problem, TheGradedMapDoesNotScaleB) {
  Problem problem(PETSC_COMM_WORLD, make_scene("membrane_obstacle", {{"disc_map", "graded"}}), {});
  Operators reference, other;
  problem.assemble_contact({0.2, 0, 0}, reference);
  problem.assemble_contact({0.24, 0, 0}, other);
  const double scale = other.b.norm() / reference.b.norm();
  EXPECT_GT((other.b - scale * reference.b).norm(), 1e-2 * other.b.norm());
}

TEST(Problem, WeightsAreTheRowSumsOfTheMass) {
  Problem problem(PETSC_COMM_WORLD, make_scene("membrane_obstacle"), {});
  Operators op;
  problem.assemble_contact({0.18, 0.01, 0.02}, op);
  EXPECT_LT((op.weights + op.b * Vector::Ones(op.b.cols())).norm(), 1e-14);
}

TEST(Problem, OperatorsDoNotDependOnTheNumberOfRanks) {
  Problem world(PETSC_COMM_WORLD, make_scene("membrane_obstacle"), {});
  Problem alone(PETSC_COMM_SELF, make_scene("membrane_obstacle"), {});
  EXPECT_EQ(world.mesh().fingerprint, alone.mesh().fingerprint);
  const Mu mu{0.17, -0.03, 0.05};
  const auto image = [&](Problem &problem) {
    const Operators &op = problem.assemble(mu);
    Vector x(problem.dofs().total);
    for (Index i = 0; i < x.size(); ++i)
      x[i] = std::sin(static_cast<double>(i));
    const Handle<Vec> in = from_natural(problem.dofs(), x), out = make_vector(problem.dofs());
    RBVI_CALL(MatMultAdd(op.a, in.get(), op.f, out.get()));
    return to_natural(problem.dofs(), out.get());
  };
  const Vector one = image(alone), many = image(world);
  EXPECT_LT((one - many).norm(), 1e-13 * one.norm());
  Operators op_alone, op_world;
  alone.assemble_contact(mu, op_alone);
  world.assemble_contact(mu, op_world);
  EXPECT_EQ((op_alone.b - op_world.b).norm(), 0);
  EXPECT_EQ((op_alone.g - op_world.g).norm(), 0);
}

/// On every rank, whoever has the node.
TEST(Problem, AGapThatIsNotFiniteIsRefusedByNameAndPlace) {
  using Limits = std::numeric_limits<double>;
  for (const auto &[normal, none] : {std::pair{false, Limits::quiet_NaN()},
                                     {true, Limits::quiet_NaN()},
                                     {false, Limits::infinity()}}) {
    Scene scene = make_scene("patch", {{"bodies", "one"}});
    scene.contacts = {rigid_support({"contact",
                                     [normal, none](const FullMu &, const Point &x) {
                                       return Point{0, normal && x[0] > 0.5 ? none : -1, 0};
                                     },
                                     [normal, none](const FullMu &, const Point &x) {
                                       return !normal && x[0] > 0.5 ? none : 0;
                                     },
                                     {},
                                     true})};
    Problem problem(PETSC_COMM_WORLD, scene, {});
    const Mu mu(scene.parameters.size(), 0.1);
    EXPECT_TRUE(refuses("the gap or the normal of contact on 'contact' is not finite at the point",
                        [&] { problem.assemble(mu); }));
  }
}

TEST(Problem, WithoutLoadTheVectorStaysZero) {
  Problem problem(PETSC_COMM_WORLD, make_scene("membrane_obstacle", {{"load", "0"}}), {});
  PetscReal norm = -1;
  RBVI_CALL(VecNorm(problem.assemble({0.2, 0, 0}).f, NORM_2, &norm));
  EXPECT_EQ(norm, 0);
}

} // namespace
} // namespace rbvi::problem_test
