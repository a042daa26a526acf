// Hertz contact with a rigid disk by Nitsche's method: against values found independently and
// against the mixed formulation, by symmetry, by the balance of work, and where the parameters go
// to their ends.
#include "nitsche_disk.hpp"

#include "rbvi/scene/case.hpp"

namespace rbvi::nitsche_test {
namespace {

using namespace nitsche_disk;

// Found independently.
struct Known {
  double radius, energy, force, centre;
};
const std::vector<Known> known_without_friction{{0.7, 0.0465717, 1.20705, 4.0388},
                                                {1.0, 0.0408828, 1.03483, 3.3696},
                                                {1.3, 0.0374069, 0.93457, 3.0012}};
const std::vector<Known> known_with_tresca{{0.7, 0.0466105, 1.20317, 4.065},
                                           {1.0, 0.0409622, 1.03069, 3.400},
                                           {1.3, 0.0375414, 0.93020, 3.034}};
const std::vector<Known> known_with_coulomb{{0.7, 0.0467368, 1.20068, 4.164},
                                            {1.0, 0.0410045, 1.03176, 3.494},
                                            {1.3, 0.0375063, 0.93301, 3.122}};

/// Solutions on the default mesh, which are symmetric and solved to round-off.
std::vector<HfSolution> expect_known(const std::string &law, const std::vector<Known> &all) {
  Problem problem(PETSC_COMM_SELF, disk(law), {});
  HighFidelity solver(problem, {});
  std::vector<HfSolution> solutions;
  for (const Known &k : all) {
    SCOPED_TRACE(law + ", radius " + std::to_string(k.radius));
    const HfSolution s = solver.solve(suited(with_radius(k.radius), problem.scene()));
    EXPECT_NEAR(*s.outputs.energy, k.energy, 1e-4 * k.energy);
    EXPECT_NEAR(*s.outputs.normal_force, k.force, 1e-4 * k.force);
    EXPECT_NEAR(*s.outputs.centre_pressure, k.centre, 1e-3 * k.centre);
    EXPECT_LE(s.kkt.largest(), 1e-11);
    expect_symmetric(s, 317, 1e-9);
    solutions.push_back(s);
  }
  return solutions;
}

TEST(NitscheDisk, AgreesWithTheKnownValuesWithoutFriction) {
  const auto solutions = expect_known("none", known_without_friction);
  const double half_width[] = {0.205, 0.2063, 0.207};
  for (std::size_t k = 0; k < solutions.size(); ++k) {
    const Outputs &o = solutions[k].outputs;
    EXPECT_NEAR(*o.contact_half_width, half_width[k], 5e-3 * half_width[k]);
    EXPECT_NEAR(*o.peak_pressure, *o.centre_pressure, 1e-3 * *o.peak_pressure);
  }
}

/// The tangential stress jumps in the middle of the arc, where the pressure is singular.
TEST(NitscheDisk, AgreesWithTheKnownValuesOfTresca) {
  const auto solutions = expect_known("tresca", known_with_tresca);
  for (std::size_t k = 0; k < solutions.size(); ++k) {
    const double arc = std::numbers::pi / 4 * known_with_tresca[k].radius;
    EXPECT_NEAR(*solutions[k].outputs.tangential_force, 0.1 * arc, 1e-4)
        << "the bound on all of it";
  }
}

/// The zone of stick ends three edges from the middle, where the pressure has a kink.
TEST(NitscheDisk, AgreesWithTheKnownValuesOfCoulomb) {
  const auto solutions = expect_known("coulomb", known_with_coulomb);
  const double half_width[] = {0.204, 0.205, 0.2058}, tangential[] = {0.11605, 0.09983, 0.09033};
  for (std::size_t k = 0; k < solutions.size(); ++k) {
    const Outputs &o = solutions[k].outputs;
    EXPECT_NEAR(*o.contact_half_width, half_width[k], 5e-3 * half_width[k]);
    EXPECT_NEAR(*o.tangential_force, tangential[k], 5e-4 * tangential[k]);
  }
}

/// The law holds better on finer meshes, and with the gap of the exact arc.
TEST(NitscheDisk, TheErrorOfTheContactLawIsOfFirstOrderInTheEdges) {
  const auto error = [](const std::string &edges, const std::string &gap_from) {
    const Scene scene = disk("none", {{"arc_edges", edges}, {"gap_from", gap_from}});
    return *solve(scene, with_radius(1)).outputs.law_error_normal;
  };
  const double coarse = error("158", "edges"), fine = error("316", "edges");
  EXPECT_NEAR(coarse, 0.0133, 1e-4);
  EXPECT_NEAR(fine, 0.0070, 1e-4);
  EXPECT_GT(coarse / fine, 1.5);
  EXPECT_LT(coarse / fine, 2.5);
  EXPECT_LT(error("158", "arc"), 0.5 * coarse);
}

/// Niakh (2022), table 4.1, h = 2.5 mm.
TEST(NitscheDisk, ThePublishedErrorsOfTheContactLawComeOut) {
  const Scene scene = disk("none", {{"gap_from", "edges"}});
  for (const auto &[radius, printed] : {std::pair{0.7, 0.0052}, {1.0, 0.0072}, {1.3, 0.011}}) {
    const HfSolution s = solve(scene, with_radius(radius), {.plain_steps = true});
    EXPECT_NEAR(*s.outputs.law_error_normal, printed, 0.05 * printed) << radius;
  }
}

/// What the answer minimises without friction: the energy with the terms of consistency and of
/// contact.
double functional(Problem &problem, NitscheSolver &solver, const Mu &mu) {
  const Operators &op = problem.assemble(mu);
  const NitscheSolution s = solver.solve(op);
  const NitscheLayer layer = layer_of(problem.contact());
  const auto faces = nitsche_faces(layer, op.mu, layer.cells);
  const auto blocks = nitsche_consistency(faces);
  double consistency = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    Eigen::Matrix<double, 12, 1> u;
    for (std::size_t i = 0; i < 12; ++i)
      u[static_cast<Index>(i)] = s.layer[faces[f].dofs[i]];
    consistency += u.dot(blocks[f] * u) / 2;
  }
  return s.energy + consistency + nitsche_energy(faces, s.layer, {});
}

/// Exactly that of the functional, and that of the energy but for the error of discretisation.
TEST(NitscheDisk, TheReactionIsTheDerivativeOfTheEnergyWithoutFriction) {
  Problem problem(PETSC_COMM_WORLD, small_disk("none"), {});
  NitscheSolver nitsche(problem, {});
  HighFidelity solver(problem, {});
  const double d = 0.07, step = 1e-5;
  const auto derivative = [&](const auto &of) {
    return (of(d + step) - of(d - step)) / (2 * step);
  };
  const double reaction =
      *solver.solve(suited(with_radius(0.8, 0, d), problem.scene())).outputs.reaction;
  EXPECT_NEAR(derivative([&](double x) {
                return functional(problem, nitsche,
                                  suited(with_radius(0.8, 0, x), problem.scene()));
              }),
              reaction, 1e-7 * reaction);
  EXPECT_NEAR(
      derivative([&](double x) {
        return *solver.solve(suited(with_radius(0.8, 0, x), problem.scene())).outputs.energy;
      }),
      reaction, 1e-3 * reaction);
}

TEST(NitscheDisk, OtherSolversFindTheSame) {
  for (const std::string &law : laws) {
    const Scene scene = small_disk(law);
    const HfSolution usual = solve(scene, with_radius(0.9)); // on each rank by itself
    for (const char *type : {"newtonls", "vinewtonrsls", "newtontr"}) {
      SCOPED_TRACE(law + ", " + type);
      const PetscOption option("-nitsche_snes_type", type);
      expect_equal(solve(PETSC_COMM_WORLD, scene, with_radius(0.9)), usual, 1e-10);
    }
  }
}
std::vector<double> values_of(const Outputs &o) {
  std::vector<double> values;
  for (const auto &value :
       {o.energy, o.normal_force, o.tangential_force, o.reaction, o.contact_measure,
        o.contact_half_width, o.stick_half_width, o.peak_pressure, o.centre_pressure,
        o.max_penetration, o.friction_violation, o.law_error_normal, o.law_error_tangential,
        o.law_error_tau_over_n, o.kkt_residual})
    if (value) values.push_back(*value);
  return values;
}

/// Tresca's bound on the whole arc would act without contact too.
TEST(NitscheDisk, WithoutContactAllIsZero) {
  for (const std::string &law : laws) {
    SCOPED_TRACE(law);
    const Scene scene = small_disk(law, {{"friction_bound", "contact"}});
    const HfSolution s = solve(PETSC_COMM_WORLD, scene, with_radius(1, 0.1, 0.0005));
    EXPECT_EQ(s.u.norm(), 0);
    EXPECT_EQ(s.lambda.norm(), 0);
    for (const double value : values_of(s.outputs))
      EXPECT_EQ(value, 0);
  }
}

/// All terms of the residual vanish, and its relative size says nothing.
TEST(NitscheDisk, ABodyInContactIsLifted) {
  for (const std::string &law : laws) {
    SCOPED_TRACE(law);
    Problem problem(PETSC_COMM_SELF, small_disk(law, {{"friction_bound", "contact"}}), {});
    HighFidelity solver(problem, {});
    const double before = solver.solve(suited(with_radius(1), problem.scene())).u.norm();
    const HfSolution lifted = solver.solve(suited(with_radius(1, 0.1, 0.0005), problem.scene()));
    EXPECT_LE(lifted.u.norm(), 1e-15 * before);
    EXPECT_EQ(*lifted.outputs.normal_force, 0);
    EXPECT_EQ(*lifted.outputs.contact_measure, 0);
  }
}

TEST(NitscheDisk, TheWholeArcMayTouch) {
  for (const std::string &law : laws) {
    SCOPED_TRACE(law);
    const HfSolution s = solve(PETSC_COMM_WORLD, small_disk(law), with_radius(1, 0.1, 0.4));
    EXPECT_NEAR(*s.outputs.contact_half_width, std::numbers::pi / 8, 1e-4);
    EXPECT_GT(s.lambda.head(41).minCoeff(), 0);
    EXPECT_LE(s.kkt.largest(), 1e-11);
  }
}

/// The loop over bounds ends on the change of u, which leaves some residual.
TEST(NitscheDisk, WithACoefficientOfOneTheEdgesOfContactAloneSlip) {
  const HfSolution s = solve(small_disk("coulomb"), with_radius(1, 1));
  EXPECT_GT(*s.outputs.stick_half_width, 0.75 * *s.outputs.contact_half_width);
  EXPECT_LT(*s.outputs.stick_half_width, *s.outputs.contact_half_width);
  EXPECT_LE(s.kkt.largest(), 1e-10);
}

/// The stress is lambda tr(eps), lambda being 5000 times the shear modulus: so is the round-off.
TEST(NitscheDisk, AnAlmostIncompressibleBodyIsSolved) {
  const Mu mu{1, 0.09, 0.1, 1, 0.4999};
  for (const std::string &law : laws) {
    SCOPED_TRACE(law);
    const HfSolution s = solve(small_disk(law), mu);
    const HfSolution mixed = solve(small_disk(law, {{"formulation", "mixed"}}), mu);
    EXPECT_NEAR(*s.outputs.energy, *mixed.outputs.energy, 1e-3 * *mixed.outputs.energy);
    EXPECT_LE(s.kkt.largest(), 1e-9);
    expect_symmetric(s, 41, 1e-6);
  }
}

/// But for the error of discretisation: with friction, even without bound, the method also has the
/// consistency of the tangential stress.
TEST(NitscheDisk, NoFrictionIsWhatAllLawsEndIn) {
  const HfSolution none = solve(small_disk("none"), with_radius(1));
  const HfSolution tresca = solve(small_disk("tresca"), with_radius(1, 0));
  const HfSolution coulomb = solve(small_disk("coulomb"), with_radius(1, 0));
  expect_equal(tresca, coulomb, 1e-12);
  EXPECT_EQ(*tresca.outputs.tangential_force, 0);
  EXPECT_NEAR(*tresca.outputs.energy, *none.outputs.energy, 1e-6 * *none.outputs.energy);
  EXPECT_LE((tresca.u - none.u).norm(), 1e-4 * none.u.norm());
  EXPECT_LE((tresca.lambda.head(41) - none.lambda).norm(), 1e-3 * none.lambda.norm());
}

std::string with_gamma0(double times_the_default) {
  return std::to_string(11.54 * times_the_default);
}

/// The message says what to do, whichever package factorises.
TEST(NitscheDisk, ATooSmallGammaIsAFailure) {
  for (const std::string &law : laws)
    for (const MPI_Comm comm : {PETSC_COMM_WORLD, PETSC_COMM_SELF}) {
      const Scene scene = small_disk(law, {{"nitsche_gamma0", with_gamma0(0.01)}});
      try {
        (void)solve(comm, scene, with_radius(1));
        ADD_FAILURE() << law << " is solved";
      } catch (const Error &error) {
        EXPECT_EQ(error.status(), Status::failed);
        EXPECT_NE(std::string(error.what()).find("-nitsche_gamma0"), std::string::npos)
            << error.what();
      }
    }
}

TEST(NitscheDisk, ALargeGammaHardlyChangesTheAnswer) {
  for (const std::string &law : laws) {
    const auto with = [&](double gamma) {
      const Scene scene = small_disk(law, {{"nitsche_gamma0", with_gamma0(gamma)}});
      return solve(scene, with_radius(1));
    };
    const Outputs usual = with(1).outputs;
    const HfSolution s = with(100);
    EXPECT_NEAR(*s.outputs.energy, *usual.energy, 1e-3 * *usual.energy) << law;
    EXPECT_NEAR(*s.outputs.normal_force, *usual.normal_force, 1e-3 * *usual.normal_force) << law;
    EXPECT_LE(s.kkt.largest(), 1e-11) << law;
  }
}

TEST(NitscheDisk, BadInputIsRefused) {
  for (const std::string law : {"tresca", "coulomb"})
    EXPECT_THROW(solve(small_disk(law), with_radius(1, -0.1)), Error) << law;
  EXPECT_THROW(make_scene("rigid_disk", {{"nitsche_gamma0", "0"}}), Error);
  EXPECT_THROW(make_scene("patch", {{"bodies", "two"}, {"formulation", "nitsche"}}), Error);
}

/// Both converge, so that they meet.
TEST(NitscheDisk, MeetsTheMixedFormulationOnFinerMeshes) {
  for (const std::string &law : laws) {
    SCOPED_TRACE(law);
    const auto difference = [&](const std::string &edges) {
      const auto energy = [&](const std::string &formulation) {
        const Scene scene = disk(law, {{"arc_edges", edges}, {"formulation", formulation}});
        return *solve(scene, with_radius(1)).outputs.energy;
      };
      const double mixed = energy("mixed");
      return std::abs(energy("nitsche") - mixed) / mixed;
    };
    const double coarse = difference("40"), fine = difference("80");
    EXPECT_LT(coarse, 2e-4);
    EXPECT_LT(fine, 0.25 * coarse);
  }
}

TEST(NitscheDisk, OneSolveIsTheSameOnAnyNumberOfRanks) {
  for (const std::string &law : laws) {
    SCOPED_TRACE(law);
    const Scene scene = small_disk(law);
    const Mu mu = with_radius(0.8);
    expect_equal(solve(PETSC_COMM_WORLD, scene, mu), solve(PETSC_COMM_SELF, scene, mu), 1e-10);
  }
}

/// A threshold that acts in contact alone, where a point touches without it and lifts off with it.
TEST(Nitsche, ThresholdsInContactAloneSettle) {
  const std::string plate = "position: 0.9725}}, formulation: nitsche, "
                            "friction: {tresca: threshold, bound: contact}}\n";
  const std::string text =
      "rbvi: 1\nphysics: plane_strain\nmesh: {built_in: annulus, edges: 24, degree: 1}\n"
      "parameters:\n  hub_x: {range: [-0.02, 0.03], default: 0.01}\n"
      "  hub_y: {range: [-0.03, 0.02], default: 0.01}\n"
      "  threshold: {range: [0.02, 0.6], default: 0.3}\n"
      "materials: {rubber: {at: all, E: 24 * (1 + 0.35*y), nu: 0.3}}\n"
      "imposed: {hub: {at: hub, ux: hub_x, uy: hub_y}}\ncontact:\n"
      "  lower: {at: bottom, against: {plane: {normal: [0, -1], " +
      plate + "  upper: {at: top, against: {plane: {normal: [0, 1], " + plate;
  Problem problem(PETSC_COMM_SELF, make_scene(read_case(text, "ring.yaml"), {}), {});
  for (const Mu &mu : {Mu{-0.0027430839109787593, 0.01710277694356814, 0.4409627117382862},
                       Mu{-0.013637658334679741, -0.011913321388200426, 0.07314211143458546}}) {
    const HfSolution s = HighFidelity(problem, {}).solve(mu);
    EXPECT_LE(s.outputs.kkt_residual.value(), 1e-9);
    EXPECT_GT(s.outputs.tangential_force.value(), 0);
  }
}

} // namespace
} // namespace rbvi::nitsche_test
