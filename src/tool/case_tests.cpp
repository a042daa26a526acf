// The tests of a case: outputs of full solves that are known.
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/commands.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace rbvi {

namespace {

/// The scene with all parameters free, so that one problem serves all tests.
Scene with_all_free(Scene scene) {
  ParameterSpace &space = scene.parameters;
  space.free.resize(space.all.size());
  std::iota(space.free.begin(), space.free.end(), 0);
  return scene;
}

Mu place_of(const SceneTest &test, const ParameterSpace &space) {
  Mu mu;
  for (const Parameter &parameter : space.all) {
    const auto given = test.at.find(parameter.name);
    mu.push_back(given == test.at.end() ? parameter.value : given->second);
  }
  return mu;
}

/// Prints one comparison; returns whether it passes.
bool compare(const SceneTest &test, const std::string &output, double expected,
             const Outputs &outputs) {
  const std::optional<double> found = output_column(output).of(outputs);
  const double size = expected == 0 ? 1 : std::abs(expected);
  const double off = found ? std::abs(*found - expected) / size : INFINITY;
  const bool passed = off <= test.tolerance;
  std::printf("  %-20s %-20s %14s expected %14s, off by %.1e of %.1e: %s\n", test.name.c_str(),
              output.c_str(), found ? formatted("%.10g", *found).c_str() : "not there",
              formatted("%.10g", expected).c_str(), off, test.tolerance,
              passed ? "passed" : "FAILED");
  return passed;
}

} // namespace

void run_tests(const Setup &setup) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  Problem problem(world, with_all_free(setup.scene), setup.mesh, setup.contact_gather);
  HighFidelity solver(problem, setup.hf);
  std::vector<std::string> failed;
  if (rank_of(world) == 0) std::printf("tests:\n");
  for (const SceneTest &test : setup.scene.tests) {
    const Mu mu = place_of(test, problem.scene().parameters);
    const HfSolution solution =
        while_doing("solving at the test '" + test.name + "'", [&] { return solver.solve(mu); });
    bool passed = true;
    for (const auto &[output, expected] : test.expected)
      if (rank_of(world) == 0) passed = compare(test, output, expected, solution.outputs) && passed;
    if (!passed) failed.push_back("'" + test.name + "'");
  }
  collectively(world, [&] {
    if (!failed.empty())
      throw failure(std::to_string(failed.size()) + " of " +
                    counted(std::ssize(setup.scene.tests), "test") +
                    " of the case failed: " + joined(failed));
  });
}

} // namespace rbvi
