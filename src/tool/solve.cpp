// rbvi solve, list, inspect.
#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/rom/print.hpp"
#include "rbvi/rom/vtu.hpp"
#include "rbvi/tool/commands.hpp"
#include "rbvi/tool/tables.hpp"
#include "rbvi/tool/workspace.hpp"

#include <cstdio>
#include <iostream>

namespace rbvi {

namespace {

/// The undistributed mesh of a problem, mapped by h(mu), as a reduced model stores it.
void write_solution(const Problem &problem, const ReducedModel &mesh, const HfSolution &solution,
                    const Mu &mu, const std::filesystem::path &path) {
  const Scene &scene = problem.scene();
  const Mu all = expand(scene.parameters, mu);
  const auto mapped = [&](const Matrix &points) {
    Matrix result(points.rows(), points.cols());
    for (Index i = 0; i < points.rows(); ++i) {
      Point x{};
      for (Index c = 0; c < points.cols(); ++c)
        x[static_cast<std::size_t>(c)] = points(i, c);
      const Point y = scene.map(all, x);
      for (Index c = 0; c < points.cols(); ++c)
        result(i, c) = y[static_cast<std::size_t>(c)];
    }
    return result;
  };
  const Matrix points = mapped(mesh.mesh_points), contact = mapped(mesh.contact_points);
  Vector gap(contact.rows());
  for (Index r = 0; r < gap.size(); ++r) {
    const Point y{contact(r, 0), contact(r, 1), contact.cols() > 2 ? contact(r, 2) : 0};
    gap[r] = solution.u[mesh.contact_nodes[static_cast<std::size_t>(r)]] - scene.obstacle(all, y);
  }
  write_vtu(path, points, mesh.mesh_cells, scene.dim + 1, {{"u", solution.u}});
  write_vtu(contact_file(path), contact, mesh.contact_cells, scene.dim + 1,
            {{"pressure", solution.lambda}, {"gap", gap}});
}

} // namespace

void command_solve(const ToolOptions &options) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  if (options.mu.empty()) throw bad_input("no parameter is given: use -mu 0.18,0.02,-0.01");
  const ParameterSpace &space = options.scene.parameters;
  const Mu mu = parse_mu(space, options.mu);
  Problem problem(world, options.scene, options.mesh);
  check_solver_options(problem, options.hf);
  HighFidelity solver(problem, options.hf);
  const HfSolution solution =
      while_doing("solving " + describe(space, mu), [&] { return solver.solve(mu); });
  ReducedModel mesh;
  if (!options.vtu.empty()) describe_mesh(problem, mesh);
  collectively(world, [&] {
    int rank = 0;
    MPI_Comm_rank(world, &rank);
    if (rank != 0) return;
    std::printf("%s\n", describe(space, mu).c_str());
    print_outputs(std::cout, solution.outputs);
    std::printf("stopped: %s\n", solution.reason.c_str());
    if (!options.csv.empty())
      write_sample_table(options.csv, space, {{mu, {}, {}, solution.outputs}});
    if (!options.vtu.empty()) write_solution(problem, mesh, solution, mu, options.vtu);
  });
}

void command_list() {
  for (const SceneEntry &scene : scene_catalogue())
    std::printf("%-20s %s\n", scene.name.c_str(), scene.summary.c_str());
}

void command_inspect(const std::string &file) {
  const ReducedModel model = read_model(file, false);
  print_model(std::cout, model);
  std::printf("Stage times of the offline run (s)\n");
  for (const auto &[stage, seconds] : model.stage_seconds)
    std::printf("  %-22s %8.3f\n", stage.c_str(), seconds);
}

} // namespace rbvi
