// rbvi solve, list, inspect.
#include "rbvi/core/error.hpp"
#include "rbvi/core/locking.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/warnings.hpp"
#include "rbvi/fem/check_scene.hpp"
#include "rbvi/mesh/contact_curves.hpp"
#include "rbvi/model/print.hpp"
#include "rbvi/model/solution_vtu.hpp"
#include "rbvi/mor/fields.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/cases.hpp"
#include "rbvi/tool/commands.hpp"
#include "rbvi/tool/tables.hpp"
#include "rbvi/tool/workspace.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <sstream>

namespace rbvi {

namespace {

/// Throws bad_input outside the box, saying how it is made wider.
void check_inside(const ParameterSpace &space, const Mu &mu) {
  for (std::size_t i = 0; i < mu.size() && !in_box(space, mu); ++i) {
    const Parameter &p = space.at(static_cast<int>(i));
    if (mu[i] >= p.lower && mu[i] <= p.upper) continue;
    throw bad_input(p.name + " = " + shortest_number(mu[i]) + " is outside [" +
                    shortest_number(p.lower) + ", " + shortest_number(p.upper) + "]: add -" +
                    p.name + " " + shortest_number(std::min(mu[i], p.lower)) + "," +
                    shortest_number(std::max(mu[i], p.upper)) + " for a wider box");
  }
}

} // namespace

std::vector<NamedFile> files_of_solution(const std::string &vtu, const Scene &scene) {
  std::vector<NamedFile> files{{"-vtu", vtu}};
  if (vtu.empty()) return files;
  for (const std::filesystem::path &file : contact_files(vtu, scene))
    files.push_back({"-vtu", file});
  return files;
}

void command_solve(const OfflineOptions &options, const SolveOptions &solve) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  check_eigen_options(options, EigenUse::none);
  if (solve.mu.empty()) throw bad_input("no parameter is given: use -mu 0.18,0.02,-0.01");
  const ParameterSpace &space = options.scene.parameters;
  const Mu mu = parse_mu(space, solve.mu, true);
  check_inside(space, mu);
  std::vector<NamedFile> outputs = files_of_solution(solve.vtu, options.scene);
  outputs.insert(outputs.begin(), {"-csv", solve.csv});
  check_outputs(world, options, options.mesh.file, outputs);
  Problem problem(world, options.scene, options.mesh, options.contact_gather);
  check_scene(problem);
  check_solver_options(problem, options.hf);
  HfOptions hf = options.hf;
  hf.looks_for_others = true;
  HighFidelity solver(problem, hf);
  const HfSolution solution =
      while_doing("solving " + describe(space, mu), [&] { return solver.solve(mu); });
  collectively(world, [&] {
    if (rank_of(world) != 0) return;
    std::printf("%s\n", describe(space, mu).c_str());
    print_outputs(std::cout, solution.outputs);
    warn_of_answer(problem, mu, solution, std::cout);
    warn_of_edges(options.scene, options.mesh.file, std::cout);
    std::printf("stopped: %s\n", solution.reason.c_str());
    if (!solve.csv.empty()) {
      write_sample_table(solve.csv, space, {{mu, {}, {}, solution.outputs}});
      print_written(std::cout, {solve.csv});
    }
  });
  write_solution(problem, solve.vtu, mu, solution);
}

bool warn_of_answer(const Problem &problem, const Mu &mu, const HfSolution &solution,
                    std::ostream &out) {
  const Scene &scene = problem.scene();
  std::ostringstream lines;
  ResolutionTally resolution;
  resolution.add(solution.outputs);
  resolution.print(lines);
  warn_of_other_answers(lines, solution.to_other > 0 ? 1 : 0, 1);
  warn_of_elements(
      scene, locking_ratio(scene, expand(scene.parameters, mu), material_points(problem.contact())),
      lines);
  out << lines.str();
  return !lines.str().empty();
}

void write_solution(Problem &problem, const std::string &vtu, const Mu &mu,
                    const HfSolution &solution) {
  if (vtu.empty()) return;
  const Scene &scene = problem.scene();
  ReducedModel mesh;
  describe_mesh(problem, mesh);
  gather_mesh(problem, mesh);
  collectively(problem.comm(), [&] {
    if (rank_of(problem.comm()) == 0)
      print_written(std::cout, write_vtu(vtu, scene, expand(scene.parameters, mu), mesh, solution.u,
                                         solution.lambda));
  });
}

namespace {

/// The cases that are installed beside the program, "" where there are none.
std::string installed_cases() {
  std::error_code none;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", none),
                              cases = program.parent_path().parent_path() / "share/rbvi/cases";
  return !none && std::filesystem::is_directory(cases, none) ? cases.string() : "";
}

} // namespace

void command_list(const std::string &given, const Registry &registry) {
  std::string folder = given;
  if (folder == "cases" && !std::filesystem::exists(folder) && !installed_cases().empty()) {
    folder = installed_cases();
    std::printf("In %s:\n", folder.c_str());
  }
  std::vector<SceneEntry> scenes = registry, cases = cases_in(folder);
  if (scenes.empty() && cases.empty())
    throw bad_input("there is no case " + folder + "/*/case.yaml: use rbvi list FOLDER");
  scenes.insert(scenes.end(), cases.begin(), cases.end());
  for (const SceneEntry &scene : scenes) {
    std::printf("%-20s %s\n", scene.name.c_str(), scene.summary.c_str());
    for (const auto &[variant, says] : scene.variants)
      std::printf("  -variant %-12s %s\n", variant.c_str(), says.c_str());
  }
}

void command_inspect(const std::string &file, const Registry &registry) {
  const ReducedModel model = read_model(file, registry, false);
  print_model(std::cout, model);
  std::printf("Stage times of the offline run (s)\n");
  for (const auto &[stage, seconds] : model.made.stage_seconds)
    std::printf("  %-22s %8.3f\n", stage.c_str(), seconds);
}

} // namespace rbvi
