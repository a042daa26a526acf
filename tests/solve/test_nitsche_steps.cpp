// How Newton's method of Nitsche's formulation gets to its end: accuracy, loops, plain steps,
// starts.
#include "nitsche_disk.hpp"

namespace rbvi::nitsche_steps_test {
namespace {

using namespace nitsche_disk;

/// The tolerance of the residual is that of SNES: tighter ones take more steps.
TEST(NitscheDisk, ItsAccuracyIsThatOfSnes) {
  const Scene scene = small_disk("coulomb");
  const HfSolution usual = solve(scene, with_radius(0.9));
  EXPECT_LE(*usual.outputs.kkt_residual, 1e-12);
  {
    const PetscOption loose("-nitsche_snes_rtol", "1e-3");
    const HfSolution rough = solve(scene, with_radius(0.9));
    EXPECT_LE(*rough.outputs.kkt_residual, 1e-3);
    EXPECT_LT(rough.iterations, usual.iterations);
  }
  const PetscOption huge("-nitsche_snes_atol", "1e300");
  EXPECT_EQ(solve(small_disk("none"), with_radius(0.9)).iterations, 0);
}

/// The loop over frozen bounds and the one where they follow every step.
TEST(NitscheDisk, BoundsThatFollowEveryStepEndInTheSame) {
  NitscheOptions single;
  single.single_loop = true;
  for (const double value : {0.05, 1.0})
    for (const SceneOptions &options :
         {SceneOptions{}, SceneOptions{{"friction_bound", "contact"}}}) {
      const Scene scene = small_disk(options.empty() ? "coulomb" : "tresca", options);
      const HfSolution s = solve(scene, with_radius(1.1, value), single);
      expect_equal(s, solve(scene, with_radius(1.1, value)), 1e-10);
      EXPECT_LE(s.kkt.largest(), 1e-11);
    }
}

/// As published, from u = 0 and without line search; on 40 edges they converge with every law.
TEST(NitscheDisk, PlainStepsEndInTheSame) {
  for (const std::string &law : laws)
    for (const bool single : {false, true}) {
      SCOPED_TRACE(law + (single ? ", single loop" : ""));
      const NitscheOptions plain{.single_loop = single, .plain_steps = true};
      const Scene scene = small_disk(law);
      Problem problem(PETSC_COMM_SELF, scene, {});
      HfOptions options;
      options.nitsche = plain;
      HighFidelity solver(problem, options);
      const Mu mu = suited(with_radius(0.9), scene);
      const HfSolution first = solver.solve(mu);
      expect_equal(first, solve(scene, with_radius(0.9)), 1e-10);
      EXPECT_EQ(solver.solve(mu).iterations, first.iterations) << "no neighbour is a start";
    }
}

/// On finer meshes points in the middle of the arc slip to either side in turn.
TEST(NitscheDisk, PlainStepsThatCycleAreAFailureThatSaysWhatToTry) {
  const PetscOption few("-nitsche_snes_max_it", "30");
  for (const bool single : {false, true})
    try {
      (void)solve(disk("coulomb", {{"arc_edges", "80"}}), with_radius(1),
                  {.single_loop = single, .plain_steps = true});
      ADD_FAILURE();
    } catch (const Error &error) {
      EXPECT_NE(std::string(error.what()).find("30 Newton steps: try -nitsche_steps searched"),
                std::string::npos)
          << error.what();
    }
}

/// What is handed out at the end of a loop is the answer with the bounds of that loop.
TEST(NitscheDisk, EveryLoopIsSolvedToItsEndWhereThatIsAskedFor) {
  Problem problem(PETSC_COMM_SELF, small_disk("coulomb"), {});
  NitscheSolver solver(problem, {});
  const Operators &op = problem.assemble(with_radius(1));
  const NitscheLayer layer = layer_of(problem.contact());
  const auto faces = nitsche_faces(layer, op.mu, layer.cells);
  std::vector<Vector> ends, bounds;
  solver.loop_end = [&](const Vector &u, const Vector &of_loop) {
    ends.push_back(u);
    bounds.push_back(of_loop);
  };
  const NitscheSolution last = solver.solve(op);
  ASSERT_EQ(static_cast<int>(ends.size()), last.outer_iterations);
  EXPECT_EQ(bounds.front().cwiseAbs().maxCoeff(), 0);
  for (std::size_t k = 1; k < ends.size(); ++k)
    EXPECT_LE((bounds[k] - nitsche_bounds(faces, nitsche_pressures(faces, ends[k - 1]))).norm(),
              1e-12 * bounds[k].norm());
  EXPECT_LE((ends.back() - last.layer).norm(), 1e-12 * last.layer.norm());
  EXPECT_GT((ends[1] - ends[0]).norm(), 1e-4 * ends[1].norm());
}

TEST(NitscheDisk, ANeighboursStateIsAGoodStart) {
  for (const std::string &law : laws) {
    SCOPED_TRACE(law);
    Problem problem(PETSC_COMM_WORLD, small_disk(law), {});
    HighFidelity solver(problem, {});
    (void)solver.solve(suited(with_radius(1), problem.scene()));
    const HfSolution warm = solver.solve(suited(with_radius(1.02), problem.scene()));
    solver.forget();
    const HfSolution cold = solver.solve(suited(with_radius(1.02), problem.scene()));
    expect_equal(warm, cold, 1e-10);
    EXPECT_LT(warm.iterations, cold.iterations);
  }
}

/// Start from solutions far away: the same answer as from nothing.
TEST(NitscheDisk, AnswersDoNotDependOnTheStart) {
  const Scene scene = small_disk("coulomb");
  Problem problem(PETSC_COMM_SELF, scene, {});
  HighFidelity solver(problem, {});
  for (const Mu &mu : {with_radius(0.7), with_radius(1.3, 0.5, 0.02), with_radius(0.7, 0.01),
                       with_radius(1.3, 0.05, 0.09)}) {
    SCOPED_TRACE(describe(scene.parameters, mu));
    expect_equal(solver.solve(mu), solve(scene, mu), 1e-10);
  }
}

TEST(NitscheDisk, EveryStepIsWatched) {
  Problem problem(PETSC_COMM_WORLD, small_disk("coulomb"), {});
  NitscheSolver solver(problem, {});
  int seen = 0;
  solver.watch = [&](const Vector &layer, const Vector &bounds) {
    ++seen;
    EXPECT_EQ(layer.size(), problem.trace().size);
    EXPECT_EQ(bounds.size(), 4 * 40);
  };
  EXPECT_EQ(solver.solve(problem.assemble(with_radius(1))).iterations, seen);
}

} // namespace
} // namespace rbvi::nitsche_steps_test
