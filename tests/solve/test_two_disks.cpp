// Two elastic disks: against values found by another code, by the balance of forces and work, by
// symmetry, and by Hertz's formulas where the contact is small.
#include "rbvi/core/error.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace rbvi::two_disks_test {
namespace {

/// Two disks, of degree 1 unless the options say otherwise.
Scene disks(SceneOptions options = {}) {
  options.emplace("degree", "1");
  return make_scene("two_disks", options);
}

HfSolution solve(MPI_Comm comm, const Mu &mu, const SceneOptions &scene = {},
                 const HfOptions &options = {}) {
  Problem problem(comm, disks(scene), {});
  return HighFidelity(problem, options).solve(mu);
}

// Computed independently on finer meshes and extrapolated in h; uncertainties 3e-4, 2.3e-5, 1.5e-3.
struct Known {
  double radius, force, energy, peak;
};
const Known known[] = {{0.7, 1.33207, 0.103959, 3.0880},
                       {1.0, 1.26721, 0.099347, 2.7084},
                       {1.3, 1.21204, 0.095509, 2.4818}};

/// At the three radii, each level solved once, by each rank for itself.
const std::vector<HfSolution> &on_level(int refine) {
  static std::map<int, std::vector<HfSolution>> solved;
  std::vector<HfSolution> &solutions = solved[refine];
  if (solutions.empty()) {
    Problem problem(PETSC_COMM_SELF, disks(), {"", refine});
    HighFidelity solver(problem, {});
    for (const Known &k : known)
      solutions.push_back(solver.solve({k.radius}));
  }
  return solutions;
}

/// The limit of values on h and h / 2 whose error falls like h^order.
double extrapolated(double coarse, double fine, double order) {
  return fine + (fine - coarse) / (std::pow(2, order) - 1);
}

TEST(TwoDisks, ForceEnergyAndPeakConvergeToTheKnownValues) {
  for (std::size_t i = 0; i < 3; ++i) {
    SCOPED_TRACE(known[i].radius);
    const Outputs &coarse = on_level(0)[i].outputs, &fine = on_level(1)[i].outputs;
    const auto expect_limit = [](double on_0, double on_1, double limit, double first,
                                 double uncertainty) {
      EXPECT_LE(std::abs(on_0 - limit), first * limit);
      EXPECT_GT(std::abs(on_0 - limit), 2.5 * std::abs(on_1 - limit));
      EXPECT_NEAR(extrapolated(on_0, on_1, 1.6), limit, uncertainty);
    };
    expect_limit(*coarse.normal_force, *fine.normal_force, known[i].force, 8e-3, 6e-4);
    expect_limit(*coarse.energy, *fine.energy, known[i].energy, 8e-3, 5e-5);
    expect_limit(*coarse.peak_pressure, *fine.peak_pressure, known[i].peak, 1e-2, 3e-3);
  }
}

/// Degree 2 at about as many dofs: the errors of the default mesh are some hundredth of those
/// above, within the uncertainty of the known values.
TEST(TwoDisks, OfDegreeTwoAreWithinFiveTenThousandths) {
  for (const std::string multiplier : {"p0", "p1"})
    for (const Known &k : known) {
      SCOPED_TRACE(multiplier + ", radius " + std::to_string(k.radius));
      const Outputs out =
          solve(PETSC_COMM_WORLD, {k.radius}, {{"degree", "2"}, {"multiplier", multiplier}})
              .outputs;
      EXPECT_NEAR(*out.normal_force, k.force, 2e-4 * k.force + 3e-4);
      EXPECT_NEAR(*out.energy, k.energy, 2e-4 * k.energy);
      EXPECT_NEAR(*out.peak_pressure, k.peak, 1e-3 * k.peak);
    }
}

TEST(TwoDisks, TheEnergyOfDegreeTwoConvergesWithTheSquareOfTheMeshWidth) {
  std::array<double, 3> energy{};
  for (const int refine : {0, 1, 2}) {
    Problem problem(PETSC_COMM_SELF, disks({{"degree", "2"}, {"arc_edges", "40"}}), {"", refine});
    energy[refine] = *HighFidelity(problem, {}).solve({0.8}).outputs.energy;
  }
  EXPECT_GT((energy[0] - energy[1]) / (energy[1] - energy[2]), 3.4);
}

TEST(TwoDisks, ASmallerDiskIsPressedHarderOnASmallerArea) {
  for (const int refine : {0, 1})
    for (std::size_t i = 1; i < 3; ++i) {
      const Outputs &smaller = on_level(refine)[i - 1].outputs,
                    &larger = on_level(refine)[i].outputs;
      EXPECT_GT(*smaller.peak_pressure, *larger.peak_pressure);
      EXPECT_LT(*smaller.contact_measure, *larger.contact_measure);
    }
}

/// Cylinders on cylinders: p0 = sqrt(F E* / (pi R)), a = sqrt(4 F R / (pi E*)), with
/// 1/R = 1 + 1/radius and E* = E / (2 (1 - nu^2)). Exact as a/R -> 0; what is left at the smallest
/// indentation is the mesh, on which a is 50 edges.
TEST(TwoDisks, ApproachHertzWithTheIndentation) {
  const double e = 15 / (2 * (1 - 0.35 * 0.35));
  for (const double radius : {0.7, 1.3}) {
    const double r = 1 / (1 + 1 / radius);
    for (const auto &[indentation, off] :
         {std::pair{"0.09", 0.055}, std::pair{"0.03", 0.025}, std::pair{"0.01", 0.02}}) {
      SCOPED_TRACE(std::string("indentation ") + indentation + ", radius " +
                   std::to_string(radius));
      const Outputs out = solve(PETSC_COMM_SELF, {radius}, {{"indentation", indentation}}).outputs;
      const double force = *out.normal_force;
      const double peak = std::sqrt(force * e / (std::numbers::pi * r)),
                   half_width = std::sqrt(4 * force * r / (std::numbers::pi * e));
      EXPECT_NEAR(*out.peak_pressure, peak, off * peak);
      EXPECT_NEAR(*out.contact_measure / 2, half_width, off * half_width + 0.0014) << "one edge";
    }
  }
}

TEST(TwoDisks, PressureScalesWithYoungsModulus) {
  const HfSolution soft = solve(PETSC_COMM_SELF, {0.8}),
                   stiff = solve(PETSC_COMM_SELF, {0.8}, {{"young", "210"}});
  EXPECT_EQ(soft.active, stiff.active);
  EXPECT_LE((stiff.lambda - 14 * soft.lambda).norm(), 1e-11 * stiff.lambda.norm());
  EXPECT_LE((stiff.u - soft.u).norm(), 1e-11 * soft.u.norm());
}

/// Vertical force that the elements exert on the nodes of a flat side.
double reaction(const Problem &problem, const FullMu &mu, const HfSolution &s, double side) {
  const Mesh &mesh = problem.mesh();
  const MappedVertices mapped = map_vertices(problem.scene(), mu, mesh);
  const Form form = elasticity("", problem.scene().materials[0].of_cell, problem.scene().degree);
  double sum = 0;
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    Eigen::Matrix<double, 6, 6, Eigen::RowMajor> stiffness;
    Eigen::Vector<double, 6> u;
    form.kernel(mu, cell_of(mesh, k, mapped), stiffness.data());
    for (std::size_t i = 0; i < 3; ++i) {
      const auto v = static_cast<std::size_t>(mesh.cells[k][i]);
      const Point motion = problem.scene().motion(mu, mesh.points[v]);
      for (std::size_t c = 0; c < 2; ++c)
        u[static_cast<Index>(2 * i + c)] =
            motion[c] + s.u[2 * mesh.natural_node[v] + static_cast<Index>(c)];
    }
    const Eigen::Vector<double, 6> forces = stiffness * u;
    for (std::size_t i = 0; i < 3; ++i)
      if (mesh.points[mesh.cells[k][i]][1] == side) sum += forces[static_cast<Index>(2 * i + 1)];
  }
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, mesh.comm);
  return sum;
}

TEST(TwoDisks, ForcesAndWorkAreInBalance) {
  Problem problem(PETSC_COMM_WORLD, disks(), {});
  HighFidelity solver(problem, {});
  for (const Known &k : known) {
    const HfSolution s = solver.solve({k.radius});
    const Operators &op = problem.assemble({k.radius});
    const double force = *s.outputs.normal_force / 2; // of the half that is computed
    const Vector contact = op.b.transpose() * s.lambda;
    EXPECT_NEAR(contact.head(561).sum(), -force, 1e-12 * force);
    EXPECT_NEAR(contact.tail(561).sum(), force, 1e-12 * force);
    EXPECT_NEAR(reaction(problem, {k.radius}, s, 1.5), -force, 1e-9 * force);
    EXPECT_NEAR(reaction(problem, {k.radius}, s, -1.5), force, 1e-9 * force);

    const Handle<Vec> u = from_natural(problem.dofs(), s.u), r = make_vector(problem.dofs());
    RBVI_CALL(MatMult(op.a, u.get(), r.get()));
    add_extension(problem.trace(), contact, r.get());
    PetscReal residual = 0;
    RBVI_CALL(VecNorm(r.get(), NORM_2, &residual));
    EXPECT_LE(residual, 1e-11 * contact.norm());
    // a(w, w) = -lambda . B w = -lambda . g: where lambda > 0, the gap is closed.
    EXPECT_NEAR(*s.outputs.energy, -s.lambda.dot(op.g), 1e-11 * *s.outputs.energy);
  }
}

/// Equal disks with coinciding meshes: each is the mirror image of the other.
TEST(TwoDisks, EqualDisksDeformAlike) {
  for (const std::string multiplier : {"p0", "p1"}) {
    Problem problem(PETSC_COMM_WORLD, disks({{"multiplier", multiplier}}), {});
    const HfSolution s = HighFidelity(problem, {}).solve({1});
    constexpr Index nodes = 3065; // of the upper disk, then their images in the same order
    double across = 0, down = 0;
    for (Index v = 0; v < nodes; ++v) {
      across = std::max(across, std::abs(s.u[2 * v] - s.u[2 * (nodes + v)]));
      down = std::max(down, std::abs(s.u[2 * v + 1] + s.u[2 * (nodes + v) + 1]));
    }
    EXPECT_LE(across, 1e-10 * s.u.cwiseAbs().maxCoeff());
    EXPECT_LE(down, 1e-10 * s.u.cwiseAbs().maxCoeff());
    EXPECT_GT(s.active.size(), 50U);
  }
}

TEST(TwoDisks, KktHoldsAtRandomRadii) {
  Problem problem(PETSC_COMM_WORLD, disks(), {});
  HighFidelity solver(problem, {});
  for (const Mu &mu : parse_set(problem.scene().parameters, "random:20:3")) {
    const HfSolution s = solver.solve(mu);
    EXPECT_LE(s.kkt.largest(), 1e-10) << mu[0];
    EXPECT_GE(s.lambda.minCoeff(), 0);
    EXPECT_GT(*s.outputs.contact_measure, 0.4);
  }
}

TEST(TwoDisks, TheStartChangesTheCostOnly) {
  Problem problem(PETSC_COMM_WORLD, disks(), {});
  HighFidelity solver(problem, {});
  const HfSolution cold = solver.solve({0.7});
  solver.forget();
  (void)solver.solve({1.3});
  const HfSolution from_afar = solver.solve({0.7}), again = solver.solve({0.7});
  EXPECT_GT(from_afar.iterations, 1);
  EXPECT_EQ(again.iterations, 1);
  for (const HfSolution *s : {&from_afar, &again}) {
    EXPECT_EQ(cold.active, s->active);
    EXPECT_LE((cold.u - s->u).norm(), 1e-11 * cold.u.norm());
    EXPECT_LE((cold.lambda - s->lambda).norm(), 1e-10 * cold.lambda.norm());
  }
}

TEST(TwoDisks, DoNotDependOnTheNumberOfRanks) {
  const HfSolution alone = solve(PETSC_COMM_SELF, {0.77}), world = solve(PETSC_COMM_WORLD, {0.77});
  EXPECT_EQ(alone.active, world.active);
  EXPECT_LE((alone.u - world.u).norm(), 1e-10 * alone.u.norm());
  EXPECT_LE((alone.lambda - world.lambda).norm(), 1e-10 * alone.lambda.norm());
}

TEST(TwoDisks, UzawaConvergesToTheActiveSetSolution) {
  const HfSolution truth = solve(PETSC_COMM_SELF, {0.7});
  HfOptions options;
  options.method = HfMethod::uzawa;
  options.uzawa.accelerated = true;
  options.uzawa.tolerance = 1e-9;
  const HfSolution s = solve(PETSC_COMM_SELF, {0.7}, {}, options);
  EXPECT_GE(s.lambda.minCoeff(), 0);
  EXPECT_LE((s.lambda - truth.lambda).norm(), 1e-5 * truth.lambda.norm());
  EXPECT_LE((s.u - truth.u).norm(), 1e-6 * truth.u.norm());
  EXPECT_NEAR(*s.outputs.energy, *truth.outputs.energy, 1e-7 * *truth.outputs.energy);
}

TEST(TwoDisks, HaveNoBoundsAtNodes) {
  Problem problem(PETSC_COMM_WORLD, disks(), {});
  HfOptions options;
  options.method = HfMethod::vi;
  try {
    HighFidelity solver(problem, options);
    FAIL() << "accepted";
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    EXPECT_NE(std::string(error.what()).find("-hf_method active_set"), std::string::npos);
  }
}

} // namespace
} // namespace rbvi::two_disks_test
