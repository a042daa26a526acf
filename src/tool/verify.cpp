// rbvi verify: a finished model against high-fidelity solves over the validation set.
#include "rbvi/check/errors.hpp"
#include "rbvi/check/stability_report.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/geometry.hpp"
#include "rbvi/mor/cones.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/commands.hpp"
#include "rbvi/tool/tables.hpp"
#include "rbvi/tool/workspace.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

/// Columns under their names.
struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;

  template <class Values> void add(const std::string &name, const Values &values) {
    names.push_back(name);
    columns.emplace_back(values.begin(), values.end());
  }
  void add(const ParameterSpace &space, const std::vector<Mu> &set) {
    for (int i = 0; i < space.size(); ++i) {
      std::vector<double> values;
      for (const Mu &mu : set)
        values.push_back(mu[static_cast<std::size_t>(i)]);
      add(space.at(i).name, values);
    }
  }
  void write(const fs::path &path) const { write_columns(path, names, columns); }
};

/// One column: a member of every row.
template <class Row, class Value>
std::vector<double> column(const std::vector<Row> &rows, Value Row::*member) {
  std::vector<double> values;
  for (const Row &row : rows)
    values.push_back(static_cast<double>(row.*member));
  return values;
}

double smallest(const std::vector<double> &values) {
  return *std::min_element(values.begin(), values.end());
}

void print_errors(const char *name, const ModelErrors &e) {
  std::printf("  %-18s %9.2e %9.2e   %9.2e %9.2e   %9.3f   %9.1e\n", name, e.u.mean(),
              e.u.maxCoeff(), e.lambda.mean(), e.lambda.maxCoeff(), 1e3 * e.seconds,
              e.kkt_residual);
}

/// Those of `wanted` below `last`, then `last`.
std::vector<int> sizes_up_to(int last, const std::vector<int> &wanted) {
  std::vector<int> sizes;
  for (const int size : wanted)
    if (size < last) sizes.push_back(size);
  sizes.push_back(last);
  return sizes;
}

/// Rows (N, R) of errors; needs a b that is only scaled (enriched_pair).
void write_error_map(const fs::path &path, const ReducedModel &model, const Truths &truths,
                     const SparseMatrix &w) {
  std::vector<std::vector<double>> columns(9);
  for (const int n : sizes_up_to(model.modes, {5, 10, 19, 35, 51, 70}))
    for (const int r : sizes_up_to(model.generators, {10, 20, 30, 40, 50})) {
      const SubModel pair = enriched_pair(model, n, r);
      const ModelErrors e = model_errors(pair.model, pair.embedding, truths, w);
      const double row[] = {static_cast<double>(n), static_cast<double>(r), e.u.mean(),
                            e.u.maxCoeff(),         e.u_floor.mean(),       e.lambda.mean(),
                            e.lambda.maxCoeff(),    e.lambda_floor.mean(),  e.seconds};
      for (std::size_t j = 0; j < columns.size(); ++j)
        columns[j].push_back(row[j]);
    }
  write_columns(path,
                {"N", "R", "u_mean", "u_max", "u_floor_mean", "lambda_mean", "lambda_max",
                 "lambda_floor_mean", "seconds"},
                columns);
}

void write_errors(const fs::path &path, const ParameterSpace &space, const Truths &truths,
                  const ModelErrors &enriched, const ModelErrors &plain) {
  Table table;
  table.add(space, truths.mu);
  table.add("u_enriched", enriched.u);
  table.add("lambda_enriched", enriched.lambda);
  table.add("u_decorrelated", plain.u);
  table.add("lambda_decorrelated", plain.lambda);
  table.add("u_floor", enriched.u_floor);
  table.add("lambda_floor", enriched.lambda_floor);
  table.write(path);
}

/// Largest aspect ratio of the mapped mesh at each mu (Niakh 2022, figure 2.3). Collective.
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
  collectively(world, [&] {
    int rank = 0;
    MPI_Comm_rank(world, &rank);
    if (rank != 0) return;
    Table table;
    table.add(problem.scene().parameters, all);
    table.add("training", is_training);
    table.add("max_aspect_ratio", worst);
    table.write(path);
    std::printf("Mesh: aspect ratio at most %.2f over %zu parameters\n",
                *std::max_element(worst.begin(), worst.end()), all.size());
  });
}

/// Both greedy cones over the training multipliers, step by step.
void write_cones(const fs::path &path, const std::vector<Sample> &training, const SparseMatrix &w,
                 ConeOptions options) {
  Matrix multipliers(w.rows(), static_cast<Index>(training.size()));
  for (std::size_t p = 0; p < training.size(); ++p)
    multipliers.col(static_cast<Index>(p)) = training[p].lambda;
  std::vector<std::vector<double>> columns(5);
  for (const ConeType type : {ConeType::cpg, ConeType::mcpg}) {
    options.type = type;
    const ConeHistory history = build_cone(multipliers, w, options).history;
    for (std::size_t r = 1; r < history.error.size(); ++r) {
      const double row[] = {type == ConeType::mcpg ? 1.0 : 0.0, static_cast<double>(r),
                            history.error[r], history.e_orth[r - 1], history.gram_condition[r - 1]};
      for (std::size_t j = 0; j < columns.size(); ++j)
        columns[j].push_back(row[j]);
    }
    std::printf("Cone %s: %zu generators, error %.2e (%s)\n",
                type == ConeType::mcpg ? "mcpg" : "cpg", history.error.size() - 1,
                history.error.back(), history.reason.c_str());
  }
  write_columns(path, {"mcpg", "R", "error", "e_orth", "gram_condition"}, columns);
}

void report_constants(const fs::path &path, const ParameterSpace &space, const std::vector<Mu> &set,
                      const std::vector<InfSup> &constants) {
  Table table;
  table.add(space, set);
  table.add("beta_hf", column(constants, &InfSup::hf));
  table.add("beta_dec", column(constants, &InfSup::dec));
  table.add("beta_on", column(constants, &InfSup::on));
  table.add("beta_off", column(constants, &InfSup::off));
  table.write(path);
  std::printf("Inf-sup constants over the span, smallest over %zu validation mu\n"
              "  beta_HF %.3e, beta_on %.3e, beta_off %.3e, beta_dec %.1e\n",
              constants.size(), smallest(column(constants, &InfSup::hf)),
              smallest(column(constants, &InfSup::on)), smallest(column(constants, &InfSup::off)),
              smallest(column(constants, &InfSup::dec)));
}

void write_stability(const fs::path &path, const std::vector<StabilityRow> &rows) {
  Table table;
  table.add("S", column(rows, &StabilityRow::supremizers));
  table.add("sigma_max", column(rows, &StabilityRow::sigma));
  table.add("bound_min", column(rows, &StabilityRow::bound));
  table.add("ratio_min", column(rows, &StabilityRow::ratio));
  table.write(path);
}

/// 0 to `last` in about `count` equal steps, both ends included.
std::vector<int> spread(int last, int count) {
  std::set<int> values{0};
  for (int k = 1; k <= count; ++k)
    values.insert(static_cast<int>(static_cast<long>(k) * last / count));
  return {values.begin(), values.end()};
}

std::vector<Mu> subset(const std::vector<Mu> &set, int count) {
  std::vector<Mu> result;
  for (const int p : spread(static_cast<int>(set.size()) - 1, count - 1))
    result.push_back(set[static_cast<std::size_t>(p)]);
  return result;
}

/// What the model promises about stability, checked at every training and validation mu.
void check_stability(MPI_Comm world, Problem &problem, const ReducedModel &model,
                     const std::vector<Mu> &training, const std::vector<Mu> &validation,
                     const fs::path &out) {
  const bool scaled = model.b.size() == 1;
  const StabilityCheck check = make_stability_check(problem, model);
  const std::vector<InfSup> constants = infsup_over(world, problem, check, validation, scaled);
  std::vector<Mu> all = training;
  all.insert(all.end(), validation.begin(), validation.end());
  const BoundCheck bound = check_bound(world, problem, check, all);
  // Where b is only scaled every mu has the same ratios.
  const std::vector<Mu> different = scaled ? std::vector<Mu>{all.front()} : all;
  const std::vector<StabilityRow> rows =
      stability_along(world, problem, check, subset(different, 8),
                      spread(model.supremizers, scaled ? model.supremizers : 20));
  const int fewest = fewest_supremizers(world, problem, check, different, 0.9);
  collectively(world, [&] {
    int rank = 0;
    MPI_Comm_rank(world, &rank);
    if (rank != 0) return;
    report_constants(out / "infsup.csv", problem.scene().parameters, validation, constants);
    write_stability(out / "stability.csv", rows);
    std::printf("  beta_off over its bound sqrt(1 - sigma^2) beta_on: at least %.6f, %d exceptions "
                "among %zu training and validation mu\n",
                bound.smallest, bound.exceptions, all.size());
    if (fewest >= 0)
      std::printf("  fewest supremizers with beta_off >= 0.9 beta_on at all of them: %d of %d\n",
                  fewest, model.supremizers);
    else
      std::printf("  all %d supremizers leave beta_off < 0.9 beta_on somewhere: lower "
                  "-pga_tolerance\n",
                  model.supremizers);
  });
}

/// Errors of the model with and without supremizers and of its leading parts, into tables, and the
/// summaries into the model file.
void check_errors(ReducedModel &model, const Problem &problem, const Truths &truths,
                  const ToolOptions &options, const fs::path &out) {
  const SparseMatrix &w = problem.w_product();
  const ModelErrors enriched = model_errors(model, {}, truths, w);
  const ModelErrors plain =
      model_errors(leading(model, model.modes, model.generators), {}, truths, w);
  std::printf("Relative errors over %zu validation mu\n"
              "  %-18s %9s %9s   %9s %9s   %9s   %9s\n",
              truths.mu.size(), "", "u mean", "max", "lambda m.", "max", "ms/query", "KKT");
  print_errors("offline-enriched", enriched);
  print_errors("decorrelated", plain);
  std::printf("  %-18s %9.2e %9.2e   %9.2e %9.2e\n", "bases alone", enriched.u_floor.mean(),
              enriched.u_floor.maxCoeff(), enriched.lambda_floor.mean(),
              enriched.lambda_floor.maxCoeff());
  write_errors(out / "errors.csv", options.scene.parameters, truths, enriched, plain);
  if (model.b.size() == 1) write_error_map(out / "error_map.csv", model, truths, w);
  model.validation_enriched = summary(enriched);
  model.validation_decorrelated = summary(plain);
  write_model(model, options.out / "model.h5");
}

ReducedModel model_of(const ToolOptions &options, MPI_Comm world) {
  if (options.out.empty()) throw bad_input("no run directory is named: use -out run/NAME");
  ReducedModel model;
  collectively(world, [&] { model = read_model(options.out / "model.h5"); });
  if (model.scene_options != options.scene.options || model.scene_name != options.scene.name ||
      model.parameters.free != options.scene.parameters.free)
    throw bad_input("the model in " + options.out.string() +
                    " was made with other options of its scene or other free parameters");
  return model;
}

} // namespace

void command_verify(const ToolOptions &options) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  ReducedModel model = model_of(options, world);
  const std::vector<Mu> validation = parse_set(options.scene.parameters, options.valid);
  const std::vector<Mu> training = parse_set(options.scene.parameters, options.train);
  const Groups groups(world, options.ranks_per_solve);
  StageTimes times;
  Workspace work(world, groups, options, times);
  if (work.group_problem().mesh().fingerprint != model.mesh_fingerprint)
    throw bad_input("the model in " + options.out.string() + " was made on another mesh");
  const auto samples = [&](const std::vector<Mu> &set) {
    const Sweep sweep =
        run_sweep(world, groups, work.group_problem(), options.hf, set, options.out / "samples");
    if (!sweep.report.failed.empty())
      throw failure("no high-fidelity answer at " +
                    describe(options.scene.parameters, sweep.report.failed.front().first) + ": " +
                    sweep.report.failed.front().second);
    return sweep.samples;
  };
  const std::vector<Sample> snapshots = samples(training), answers = samples(validation);
  Problem &problem = work.world_problem(times);
  const Truths truths = make_truths(problem, model, answers);
  const fs::path out = options.out / "verify";
  collectively(world, [&] {
    int rank = 0;
    MPI_Comm_rank(world, &rank);
    if (rank != 0) return;
    fs::create_directories(out);
    check_errors(model, problem, truths, options, out);
    write_sample_table(out / "samples.csv", options.scene.parameters, answers);
    write_cones(out / "cones.csv", snapshots, problem.w_product(), options.reduce.cone);
  });
  write_mesh_quality(out / "mesh_quality.csv", world, problem, training, validation);
  check_stability(world, problem, model, training, validation, out);
  int rank = 0;
  MPI_Comm_rank(world, &rank);
  if (rank == 0) std::printf("Tables: %s\n", out.c_str());
}

} // namespace rbvi
