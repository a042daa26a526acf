// The assembled problem of two bodies: what depends on the parameter, what does not, and what the
// rigid motion stands for.
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/fem/problem.hpp"
#include "rbvi/par/collective.hpp"
#include "tests/catalogue.hpp"

#include "../contact/curves.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

namespace rbvi::two_bodies_assembled_test {
namespace {

constexpr double indentation = 0.09, initial_gap = 0.001; // defaults of two_disks

/// Two disks of degree 1.
Scene discs(SceneOptions options = {}) {
  options.emplace("degree", "1");
  return make_scene("two_disks", options);
}

/// |A - B| / |B| in the Frobenius norm.
double difference(Mat a, Mat b) {
  Handle<Mat> rest;
  PetscReal error = 0, scale = 0;
  RBVI_CALL(MatDuplicate(a, MAT_COPY_VALUES, rest.put()));
  RBVI_CALL(MatAXPY(rest.get(), -1, b, SAME_NONZERO_PATTERN));
  RBVI_CALL(MatNorm(rest.get(), NORM_FROBENIUS, &error));
  RBVI_CALL(MatNorm(b, NORM_FROBENIUS, &scale));
  return error / scale;
}

/// A similarity does not change a plane stiffness: integrated over the mapped cells or not, A is
/// the same, however large the lower disk is.
TEST(TwoBodyProblem, TheStiffnessDoesNotDependOnTheRadius) {
  Scene every_time = discs();
  every_time.a = {mapped_term(elasticity("", every_time.materials[0].of_cell, every_time.degree))};
  Problem problem(PETSC_COMM_WORLD, every_time, {}), once(PETSC_COMM_WORLD, discs(), {});
  Mat reference = once.assemble({1}).a;
  for (const double radius : {0.7, 0.9, 1.0, 1.3})
    EXPECT_LE(difference(problem.assemble({radius}).a, reference), 1e-12) << radius;
}

/// How often the kernel of a and the map are called, on this rank.
struct Calls {
  std::shared_ptr<int> kernel = std::make_shared<int>(0), map = std::make_shared<int>(0);

  Scene counted(Scene scene) const {
    auto &own = scene.a.front().form.kernel;
    own = [count = kernel, inner = own](const FullMu &mu, const Cell &cell, double *values) {
      ++*count;
      inner(mu, cell, values);
    };
    scene.map = [count = map, inner = scene.map](const FullMu &mu, const Point &x) {
      ++*count;
      return inner(mu, x);
    };
    return scene;
  }
};

TEST(TwoBodyProblem, TheStiffnessIsAssembledOnce) {
  const Calls calls;
  Problem problem(PETSC_COMM_WORLD, calls.counted(discs()), {});
  // Before there is a mesh (check_functions): with another value of each parameter.
  const int checked = 1 + static_cast<int>(discs().parameters.all.size());
  const int calls_once = checked + static_cast<int>(problem.mesh().cells.size());
  Mat first = problem.assemble({0.7}).a;
  EXPECT_EQ(*calls.kernel, calls_once);
  *calls.map = 0;
  for (const double radius : {1.3, 0.8, 0.7}) {
    EXPECT_EQ(problem.assemble({radius}).a, first);
    EXPECT_EQ(*calls.kernel, calls_once);
  }
  EXPECT_EQ(*calls.map, 3 * 2 * 561) << "of the contact nodes alone";
}

TEST(TwoBodyProblem, TheStiffnessIsAssembledWhereItsParametersChange) {
  const Calls calls;
  Scene scene = calls.counted(discs());
  scene.a = {mapped_term(scene.a.front().form, std::vector<int>{0})};
  EXPECT_FALSE(constant_stiffness(scene));
  Problem problem(PETSC_COMM_WORLD, scene, {});
  const int cells = static_cast<int>(problem.mesh().cells.size());
  int expected = 0;
  for (const auto &[radius, again] :
       {std::pair{0.7, true}, std::pair{0.7, false}, std::pair{0.8, true}, std::pair{0.7, true}}) {
    problem.assemble({radius});
    expected += again ? cells : 0;
    EXPECT_EQ(*calls.kernel, expected);
  }
}

TEST(TwoBodyProblem, AStiffnessOfFixedParametersIsConstant) {
  Scene scene = discs();
  EXPECT_TRUE(constant_stiffness(scene));
  scene.a = {mapped_term(scene.a.front().form)};
  EXPECT_FALSE(constant_stiffness(scene));
  scene.a = {mapped_term(scene.a.front().form, std::vector<int>{0})};
  EXPECT_FALSE(constant_stiffness(scene));
  scene.parameters.free.clear();
  EXPECT_TRUE(constant_stiffness(scene));
  Scene membrane = make_scene("membrane_obstacle");
  EXPECT_FALSE(constant_stiffness(membrane));
  membrane.parameters = free_only(membrane.parameters, "frame_height,frame_tilt");
  EXPECT_TRUE(constant_stiffness(membrane)) << "the frame does not move the domain";
}

Operators contact_at(Problem &problem, double radius) {
  Operators op;
  problem.assemble_contact({radius}, op);
  return op;
}

class Discretisations : public testing::TestWithParam<std::array<const char *, 2>> {
protected:
  SceneOptions options() const {
    return {{"multiplier", GetParam()[0]}, {"integration", GetParam()[1]}};
  }
};
INSTANTIATE_TEST_SUITE_P(All, Discretisations,
                         testing::Values(std::array{"p0", "intersection"},
                                         std::array{"p0", "direct"},
                                         std::array{"p1", "intersection"},
                                         std::array{"p1", "direct"}));

TEST_P(Discretisations, ActionIsReaction) {
  Problem problem(PETSC_COMM_WORLD, discs(options()), {});
  EXPECT_EQ(problem.dual_size(), std::string(GetParam()[0]) == "p1" ? 561 : 280);
  for (const double radius : {0.7, 1.0, 1.3}) {
    const Operators op = contact_at(problem, radius);
    const Vector ones = Vector::Ones(op.b.cols());
    EXPECT_LE((op.b * ones).cwiseAbs().maxCoeff(), 1e-16);
    EXPECT_LE((op.nodal_b * ones).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_LE((op.b.leftCols(561) * ones.head(561) + op.weights).cwiseAbs().maxCoeff(), 1e-16);
  }
}

/// Above the larger lower disk the whole slave arc has a partner, above the smaller one the part up
/// to x = radius sin(45 degrees).
TEST_P(Discretisations, WeightsMeasureTheArcThatHasAPartner) {
  Problem problem(PETSC_COMM_WORLD, discs(options()), {});
  const double edge = std::numbers::pi / 4 / 560;
  for (const double radius : {0.7, 0.9, 1.0, 1.3}) {
    const double angle = std::asin(std::min(1.0, radius) * std::sqrt(0.5));
    const Operators op = contact_at(problem, radius);
    const bool direct = std::string(GetParam()[1]) == "direct";
    EXPECT_NEAR(op.weights.sum(), angle, direct ? edge : 1e-6) << radius;
    EXPECT_NEAR(static_cast<double>(op.nodal_b.rows() - 1), std::floor(angle / edge + 1e-9), 0.5);
  }
}

/// Undeformed, the disks are circles that face each other over the initial gap; the polygon of the
/// lower one lies inside its circle by h^2 / 8.
TEST(TwoBodyProblem, WithoutMotionTheGapIsThatOfTwoCircles) {
  Scene scene = discs();
  scene.motion = nullptr;
  Problem problem(PETSC_COMM_WORLD, scene, {});
  for (const double radius : {0.7, 1.0, 1.3}) {
    const Operators op = contact_at(problem, radius);
    for (Index i = 0; i < op.nodal_gap.size(); ++i) {
      const double x = problem.contact().interfaces.front()->mesh().points[i][0];
      const double circles =
          initial_gap + 1 - std::sqrt(1 - x * x) + radius - std::sqrt(radius * radius - x * x);
      EXPECT_NEAR(op.nodal_gap[i], circles, 1e-6);
      EXPECT_GE(op.nodal_gap[i], circles - 1e-14);
    }
  }
}

/// The bodies approach each other by twice the indentation: every gap is less by as much.
TEST_P(Discretisations, TheGapTakesTheMotionIn) {
  Scene at_rest = discs(options());
  at_rest.motion = nullptr;
  Problem moving(PETSC_COMM_WORLD, discs(options()), {}), resting(PETSC_COMM_WORLD, at_rest, {});
  for (const double radius : {0.7, 1.3}) {
    const Operators m = contact_at(moving, radius), r = contact_at(resting, radius);
    EXPECT_EQ((m.b - r.b).norm(), 0);
    EXPECT_EQ(m.weights, r.weights);
    EXPECT_LE((m.g - (r.g - 2 * indentation * r.weights)).cwiseAbs().maxCoeff(), 1e-16);
    EXPECT_LE((m.nodal_gap.array() - (r.nodal_gap.array() - 2 * indentation)).abs().maxCoeff(),
              1e-15);
  }
}

/// u = motion + w: a rigid motion strains no cell, and it is what the fixed boundaries prescribe.
TEST(TwoBodyProblem, MotionsAreRigidAndPrescribeTheBoundaryValues) {
  for (const auto &[name, mu] : {std::pair{"two_disks", 0.7}, std::pair{"patch", 0.08}}) {
    Problem problem(PETSC_COMM_WORLD, make_scene(name, {{"degree", "1"}}), {});
    const Scene &scene = problem.scene();
    const Mesh &mesh = problem.mesh();
    const FullMu all = expand(scene.parameters, {mu});
    const MappedVertices mapped = map_vertices(scene, all, mesh);
    std::vector<double> largest{0};
    for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
      const Cell cell = cell_of(mesh, k, mapped);
      Eigen::Matrix<double, 6, 6, Eigen::RowMajor> stiffness;
      scene.a.front().form.kernel(all, cell, stiffness.data());
      Vector motion(6);
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t c = 0; c < 2; ++c)
          motion[static_cast<Index>(2 * i + c)] = scene.motion(all, cell.reference[i])[c];
      EXPECT_LE((stiffness * motion).norm(), 1e-14 * stiffness.norm() * (motion.norm() + 1e-3));
      largest.front() = std::max(largest.front(), motion.norm());
    }
    over_ranks(PETSC_COMM_WORLD, MPI_MAX, largest);
    EXPECT_GT(largest.front(), 0.1);
    for (std::size_t v = 0; v < problem.mesh().points.size(); ++v) {
      const Point motion = scene.motion(all, problem.mesh().points[v]);
      const bool disks = scene.name == "two_disks";
      const auto lies_on = [&](const char *boundary) {
        return problem.mesh().boundary.at(boundary)[v];
      };
      const Point down{0, disks ? -indentation : -mu, 0}, up{0, disks ? indentation : 0, 0};
      EXPECT_TRUE(!lies_on("top") || motion == down);
      EXPECT_TRUE(!lies_on("bottom") || motion == up);
      EXPECT_TRUE(!lies_on(disks ? "axis" : "sides") || motion[0] == 0);
    }
  }
}

/// nodal_gap - nodal_b w is the vertical distance of the deformed slave node to the deformed master
/// polygon below it, motion included; abscissae stay as they are.
TEST(TwoBodyProblem, TheNodalConstraintMeasuresTheDeformedState) {
  Problem problem(PETSC_COMM_WORLD, discs(), {});
  const InterfaceMesh &curves = problem.contact().interfaces.front()->mesh();
  for (const double radius : {0.7, 1.3}) {
    const Operators op = contact_at(problem, radius);
    const FullMu all = expand(problem.scene().parameters, {radius});
    Vector w(op.nodal_b.cols());
    std::vector<Point> deformed;
    for (Index i = 0; i < w.size(); ++i) {
      const Point &x = curves.points[i];
      w[i] = 0.05 * std::sin(7.0 * static_cast<double>(i));
      deformed.push_back(problem.scene().map(all, x));
      deformed.back()[1] += problem.scene().motion(all, x)[1] + w[i];
    }
    const std::vector<Point> master(deformed.begin() + curves.parts[0], deformed.end());
    const Vector gap = op.nodal_gap - op.nodal_b * w;
    ASSERT_GT(gap.size(), 300);
    for (Index i = 0; i < gap.size(); ++i) {
      const Point &slave = deformed[i];
      EXPECT_NEAR(gap[i], slave[1] - height_at(master, slave[0]), 1e-12);
    }
  }
}

TEST(TwoBodyProblem, OperatorsDoNotDependOnTheNumberOfRanks) {
  Problem world(PETSC_COMM_WORLD, discs(), {}), alone(PETSC_COMM_SELF, discs(), {});
  const auto image = [](Problem &problem) {
    Vector x(problem.dofs().total);
    for (Index i = 0; i < x.size(); ++i)
      x[i] = std::sin(static_cast<double>(i));
    const Handle<Vec> in = from_natural(problem.dofs(), x), out = make_vector(problem.dofs());
    RBVI_CALL(MatMult(problem.assemble({0.83}).a, in.get(), out.get()));
    return to_natural(problem.dofs(), out.get());
  };
  const Vector one = image(alone), many = image(world);
  EXPECT_LE((one - many).norm(), 1e-13 * one.norm());
  const Operators a = contact_at(alone, 0.83), w = contact_at(world, 0.83);
  EXPECT_EQ((a.b - w.b).norm(), 0);
  EXPECT_EQ(a.g, w.g);
  EXPECT_EQ(a.weights, w.weights);
  EXPECT_EQ((a.nodal_b - w.nodal_b).norm(), 0);
  EXPECT_EQ(a.nodal_gap, w.nodal_gap);
  EXPECT_EQ((alone.w_product() - world.w_product()).norm(), 0);
}

} // namespace
} // namespace rbvi::two_bodies_assembled_test
