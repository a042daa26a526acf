// The largest and smallest values of a model come from few cells, and are those of all.
#include "named_outputs.hpp"

#include "rbvi/mor/output_candidates.hpp"

namespace rbvi::output_candidates_test {

using named_outputs_test::pressed;
using named_outputs_test::values_of;
using testing_reduced::Reduced;

const std::string extremes = "  worst: {max: von_mises, in: all}\n"
                             "  lowest: {min: uy, in: all, where: x > 0.3}\n"
                             "  side: {max: sigma_xy, at: sides}\n",
                  hold = "imposed: {top: {at: top, ux: d, uy: -d}}\n";

TEST(OutputCandidates, AreFewAndHoldTheExtremes) {
  Reduced made(pressed(hold, extremes, "plane_strain"), "grid:3,3");
  made.reduce(testing_reduced::everything());
  const OutputCells &kept = made.model.outputs.cells, &all = made.problem.output_cells();
  EXPECT_LT(kept.parts.size(), all.parts.size() / 2);
  EXPECT_LT(kept.nodes.size(), all.nodes.size());
  const auto unseen = testing_reduced::solve_all(
      made.problem, parse_set(made.problem.scene().parameters, "random:6:3"));
  if (rank_of(PETSC_COMM_WORLD) != 0) return;
  OnlineSolver online(made.model);
  for (const Sample &sample : unseen) {
    std::map<std::string, double> full = values_of(sample.outputs),
                                  reduced =
                                      values_of(online.outputs(sample.mu, online.solve(sample.mu)));
    for (const char *name : {"worst", "lowest", "side"})
      EXPECT_NEAR(reduced[name], full[name], 1e-6 * std::abs(full[name])) << name;
  }
}

/// What a mean needs stays, and so does all where nothing is extreme.
TEST(OutputCandidates, LeaveOtherOutputsTheirCells) {
  Problem both(PETSC_COMM_WORLD,
               pressed(hold, extremes + "  mean: {mean: von_mises, in: all}\n", "plane_strain"),
               {});
  const Problem mean(PETSC_COMM_WORLD,
                     pressed(hold, "  mean: {mean: von_mises, in: all}\n", "plane_strain"), {});
  const auto count = [](const OutputCells &cells, int output) {
    return std::ranges::count(cells.parts, output, &OutputCells::Part::output);
  };
  const auto few =
      testing_reduced::solve_all(both, parse_set(both.scene().parameters, "random:1:3"));
  const OutputCells kept =
      candidate_cells(PETSC_COMM_WORLD, both.scene(), both.output_cells(), few);
  const int last = static_cast<int>(both.scene().outputs.size()) - 1;
  EXPECT_EQ(count(kept, last), count(both.output_cells(), last));
  EXPECT_LT(kept.parts.size(), both.output_cells().parts.size());
  EXPECT_EQ(candidate_cells(PETSC_COMM_WORLD, mean.scene(), mean.output_cells(), {}).parts.size(),
            mean.output_cells().parts.size());
}

/// Parameters move a window, or a weight, past cells that no sample has it at.
TEST(OutputCandidates, KeepAllThatAParameterMovesOver) {
  const Problem problem(PETSC_COMM_WORLD,
                        pressed(hold,
                                "  window: {max: von_mises, in: all, where: 'x < d'}\n"
                                "  weighted: {min: sigma_yy*(1 + d*x), in: all}\n",
                                "plane_strain"),
                        {});
  EXPECT_EQ(
      candidate_cells(PETSC_COMM_WORLD, problem.scene(), problem.output_cells(), {}).parts.size(),
      problem.output_cells().parts.size());
}

/// So does the map, past what names a place and nothing else.
TEST(OutputCandidates, KeepAllThatTheMapMovesOver) {
  const auto kept_of = [](const std::string &output) {
    Problem problem(PETSC_COMM_WORLD,
                    pressed(hold, output, "plane_strain", "map: [x, (1 + d)*y]\n"), {});
    const auto samples =
        testing_reduced::solve_all(problem, parse_set(problem.scene().parameters, "random:2:3"));
    const OutputCells all = problem.output_cells();
    return std::ssize(candidate_cells(PETSC_COMM_WORLD, problem.scene(), all, samples).parts) ==
           std::ssize(all.parts);
  };
  EXPECT_TRUE(kept_of("  weighted: {max: von_mises*exp(-9*y), in: all}\n"));
  EXPECT_TRUE(kept_of("  window: {max: von_mises, in: all, where: y < 0.1}\n"));
  EXPECT_FALSE(kept_of("  plain: {max: von_mises, in: all}\n"));
}

/// Its condition holds at no sample, and may elsewhere.
TEST(OutputCandidates, KeepAllWhereNoSampleHasAValue) {
  Problem problem(
      PETSC_COMM_WORLD,
      pressed(hold, "  worst: {max: von_mises, in: all, where: uy > 10}\n", "plane_strain"), {});
  const auto samples =
      testing_reduced::solve_all(problem, parse_set(problem.scene().parameters, "random:2:3"));
  EXPECT_EQ(candidate_cells(PETSC_COMM_WORLD, problem.scene(), problem.output_cells(), samples)
                .parts.size(),
            problem.output_cells().parts.size());
}

} // namespace rbvi::output_candidates_test
