// rbvi verify: a finished model against high-fidelity solves over the validation set.
#include "rbvi/check/errors.hpp"
#include "rbvi/check/stability_report.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/geometry.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/commands.hpp"
#include "rbvi/tool/tables.hpp"
#include "rbvi/tool/workspace.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

void print_errors(const char *name, const ModelErrors &e) {
  std::printf("  %-18s %9.2e %9.2e   %9.2e %9.2e   %9.3f   %9.1e\n", name, e.u.mean(),
              e.u.maxCoeff(), e.lambda.mean(), e.lambda.maxCoeff(), 1e3 * e.seconds,
              e.kkt_residual);
}

/// Rows (N, R) of errors; the enriched pairs where b is scaled only.
void write_error_map(const fs::path &path, const ReducedModel &model, const Truths &truths,
                     const SparseMatrix &w) {
  std::vector<std::vector<double>> columns(8);
  std::vector<int> modes, generators;
  for (const int n : {5, 10, 19, 35, 51, 70})
    if (n < model.modes) modes.push_back(n);
  modes.push_back(model.modes);
  for (const int r : {10, 20, 30, 40, 50})
    if (r < model.generators) generators.push_back(r);
  generators.push_back(model.generators);
  for (const int n : modes)
    for (const int r : generators) {
      const SubModel pair = enriched_pair(model, n, r);
      const ModelErrors e = model_errors(pair.model, pair.embedding, truths, w);
      const double row[] = {static_cast<double>(n),
                            static_cast<double>(r),
                            e.u.mean(),
                            e.u.maxCoeff(),
                            e.lambda.mean(),
                            e.lambda.maxCoeff(),
                            e.lambda_floor.maxCoeff(),
                            e.seconds};
      for (std::size_t j = 0; j < columns.size(); ++j)
        columns[j].push_back(row[j]);
    }
  write_columns(
      path,
      {"N", "R", "u_mean", "u_max", "lambda_mean", "lambda_max", "lambda_floor_max", "seconds"},
      columns);
}

/// Largest aspect ratio of the mapped mesh at each mu (figure 2.3 of the reference).
void write_mesh_quality(const fs::path &path, MPI_Comm world, const Problem &problem,
                        const std::vector<Mu> &training, const std::vector<Mu> &validation) {
  std::vector<Mu> all = training;
  all.insert(all.end(), validation.begin(), validation.end());
  std::vector<double> worst(all.size(), 0);
  MappedCells cells = reference_cells(problem.mesh());
  for (std::size_t p = 0; p < all.size(); ++p) {
    map_cells(problem.scene(), expand(problem.scene().parameters, all[p]), problem.mesh(), cells);
    for (const Cell &cell : cells.cells)
      worst[p] = std::max(worst[p], aspect_ratio(cell.dim, cell.mapped));
  }
  MPI_Allreduce(MPI_IN_PLACE, worst.data(), static_cast<int>(worst.size()), MPI_DOUBLE, MPI_MAX,
                world);
  std::vector<double> is_training(all.size(), 0);
  std::fill_n(is_training.begin(), training.size(), 1.0);
  int rank = 0;
  MPI_Comm_rank(world, &rank);
  if (rank != 0) return;
  write_columns(path, {"training", "max_aspect_ratio"}, {is_training, worst});
  std::printf("Mesh: aspect ratio at most %.2f over %zu parameters\n",
              *std::max_element(worst.begin(), worst.end()), all.size());
}

void write_infsup(const fs::path &path, const std::vector<InfSup> &constants) {
  std::vector<std::vector<double>> columns(4);
  for (const InfSup &c : constants) {
    columns[0].push_back(c.hf);
    columns[1].push_back(c.dec);
    columns[2].push_back(c.on);
    columns[3].push_back(c.off);
  }
  write_columns(path, {"beta_hf", "beta_dec", "beta_on", "beta_off"}, columns);
}

/// What the model promises about stability, checked at every training and validation mu.
void check_stability(MPI_Comm world, Problem &problem, const ReducedModel &model,
                     const std::vector<Mu> &training, const std::vector<Mu> &validation,
                     const fs::path &out) {
  int rank = 0;
  MPI_Comm_rank(world, &rank);
  const bool scaled = model.b.size() == 1;
  const StabilityCheck check = make_stability_check(problem, model);
  const std::vector<InfSup> constants = infsup_over(world, problem, check, validation, scaled);
  double slack = 2;
  for (const Mu &mu : training) {
    const Matrix t = supremizers_at(problem, check.space, check.dual, {mu}).front();
    slack = std::min(slack, infsup_constant(check.coordinates, t) /
                                std::max(stability_bound(check.coordinates, t).sharp, 1e-300));
    if (scaled) break; // every mu has the same ratio
  }
  std::vector<Mu> all = training;
  all.insert(all.end(), validation.begin(), validation.end());
  if (scaled) all.resize(1);
  const int fewest = fewest_supremizers(world, problem, check, all, 0.9);
  if (rank != 0) return;
  write_infsup(out / "infsup.csv", constants);
  const auto smallest = [&](double InfSup::*which) {
    double value = constants.front().*which;
    for (const InfSup &c : constants)
      value = std::min(value, c.*which);
    return value;
  };
  std::printf("Inf-sup constants over the span, smallest over %zu validation mu\n"
              "  beta_HF %.3e, beta_on %.3e, beta_off %.3e, beta_dec %.1e\n",
              constants.size(), smallest(&InfSup::hf), smallest(&InfSup::on),
              smallest(&InfSup::off), smallest(&InfSup::dec));
  std::printf("  beta_off over its bound sqrt(1 - sigma^2) beta_on, smallest over training: %.6f\n",
              slack);
  std::printf("  fewest supremizers with beta_off >= 0.9 beta_on at every mu: %d of %d\n", fewest,
              model.supremizers);
}

} // namespace

void command_verify(const ToolOptions &options) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  int rank = 0;
  MPI_Comm_rank(world, &rank);
  if (options.out.empty()) throw bad_input("no run directory is named: use -out run/NAME");
  ReducedModel model;
  collectively(world, [&] { model = read_model(options.out / "model.h5"); });
  if (model.scene_options != options.scene.options || model.scene_name != options.scene.name)
    throw bad_input("the model in " + options.out.string() +
                    " was made with other options of its scene");
  const std::vector<Mu> validation = parse_set(options.scene.parameters, options.valid);
  const std::vector<Mu> training = parse_set(options.scene.parameters, options.train);
  const Groups groups(world, options.ranks_per_solve);
  StageTimes times;
  Workspace work(world, groups, options, times);
  if (work.group_problem().mesh().fingerprint != model.mesh_fingerprint)
    throw bad_input("the model in " + options.out.string() + " was made on another mesh");
  const Sweep sweep = run_sweep(world, groups, work.group_problem(), options.hf, validation,
                                options.out / "samples");
  Problem &problem = work.world_problem(times);
  const Truths truths = make_truths(problem, model, sweep.samples);
  const fs::path out = options.out / "verify";
  collectively(world, [&] {
    if (rank != 0) return;
    fs::create_directories(out);
    const SparseMatrix &w = problem.w_product();
    const ReducedModel decorrelated = leading(model, model.modes, model.generators);
    const ModelErrors enriched = model_errors(model, {}, truths, w);
    const ModelErrors plain = model_errors(decorrelated, {}, truths, w);
    std::printf("Relative errors over %zu validation mu      u mean     max       lambda mean  max "
                "    ms/query"
                "   KKT\n",
                truths.mu.size());
    print_errors("offline-enriched", enriched);
    print_errors("decorrelated", plain);
    std::printf("  %-18s %9.2e %9.2e   %9.2e %9.2e\n", "bases alone", enriched.u_floor.mean(),
                enriched.u_floor.maxCoeff(), enriched.lambda_floor.mean(),
                enriched.lambda_floor.maxCoeff());
    write_columns(out / "errors.csv",
                  {"u_enriched", "lambda_enriched", "u_decorrelated", "lambda_decorrelated",
                   "u_floor", "lambda_floor"},
                  [&] {
                    std::vector<std::vector<double>> columns;
                    for (const Vector *v : {&enriched.u, &enriched.lambda, &plain.u, &plain.lambda,
                                            &enriched.u_floor, &enriched.lambda_floor})
                      columns.emplace_back(v->begin(), v->end());
                    return columns;
                  }());
    write_sample_table(out / "samples.csv", options.scene.parameters, sweep.samples);
    if (model.b.size() == 1) write_error_map(out / "error_map.csv", model, truths, w);
    model.validation_enriched = summary(enriched);
    model.validation_decorrelated = summary(plain);
    write_model(model, options.out / "model.h5");
  });
  write_mesh_quality(out / "mesh_quality.csv", world, problem, training, validation);
  check_stability(world, problem, model, training, validation, out);
  if (rank == 0) std::printf("Tables: %s\n", out.c_str());
}

} // namespace rbvi
