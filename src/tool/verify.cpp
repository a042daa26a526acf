// rbvi verify: a finished model against high-fidelity solves over the validation set.
#include "rbvi/check/errors.hpp"
#include "rbvi/check/output_errors.hpp"
#include "rbvi/check/separation_errors.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/element/geometry.hpp"
#include "rbvi/io/output_table.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/mor/bases/cones.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/rom/model/training_samples.hpp"
#include "rbvi/rom/print.hpp"
#include "rbvi/rom/self_check.hpp"
#include "rbvi/sweep/grouping.hpp"
#include "rbvi/tool/commands.hpp"
#include "rbvi/tool/failures.hpp"
#include "rbvi/tool/model_case.hpp"
#include "rbvi/tool/options/run_directory.hpp"
#include "rbvi/tool/tables.hpp"
#include "rbvi/tool/workspace.hpp"

#include "verify_stability.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <sstream>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

void print_errors(const char *name, const ModelErrors &e) {
  if (e.failed > 0)
    std::printf("  %-18s no answer at %d of %d\n", name, e.failed, static_cast<int>(e.u.size()));
  else
    std::printf("  %-18s %9.2e %9.2e   %9.2e %9.2e   %9.3f   %9.1e\n", name, e.u.mean(),
                e.u.maxCoeff(), e.lambda.mean(), e.lambda.maxCoeff(), 1e3 * e.seconds,
                e.kkt_residual);
  if (e.failed == 0 && e.tangential.size() > 0)
    std::printf("  %-18s %9s %9s   %9.2e %9.2e\n", "  lambda_tau", "", "", e.tangential.mean(),
                e.tangential.maxCoeff());
}

/// The positive ones of `wanted` below `last`, then `last`.
std::vector<int> sizes_up_to(int last, const std::vector<int> &wanted) {
  std::vector<int> sizes;
  for (const int size : wanted)
    if (size > 0 && size < last) sizes.push_back(size);
  sizes.push_back(last);
  return sizes;
}

/// The N of the error map: without multipliers there is no second size.
std::vector<int> mode_counts(const ReducedModel &model) {
  if (model.generators == 0) return {5, 10, 15, 20, 30, 40, 50};
  return {10, 19, 51};
}

/// The R at which the model's dual basis means something on its own.
std::vector<int> generator_counts(const ReducedModel &model) {
  const auto type = model.settings.find("cone_type");
  if (type != model.settings.end() && (type->second == "nodal" || type->second == "nmf"))
    return {model.generators};
  const int cone = model.generators - model.free_modes;
  if (model.law) return {model.generators};
  if (model.free_modes > 0) return sizes_up_to(model.generators, {cone, cone + 4, cone + 8});
  return sizes_up_to(model.generators, {20, 50, 70, 100});
}

/// Errors of the pairs (N, R), decorrelated and, where that is known, as enriched_pair makes
/// them. Collective: the pairs are shared among the ranks.
void write_error_map(const fs::path &path, MPI_Comm world, const ReducedModel &model,
                     const Truths &truths, const SparseMatrix &w) {
  struct Pair {
    int enriched, n, r;
  };
  std::vector<Pair> pairs;
  for (int kind = 0; kind <= (knows_enriched_pairs(model) ? 1 : 0); ++kind)
    for (const int n : sizes_up_to(model.modes, mode_counts(model)))
      for (const int r : generator_counts(model))
        pairs.push_back({kind, n, r});
  const int rank = rank_of(world), ranks = ranks_of(world);
  const auto count = static_cast<int>(pairs.size());
  const bool friction = truths.tangential_norm.size() > 0;
  const bool stresses = friction && !model.has_multipliers();
  Matrix rows = Matrix::Zero(count, stresses ? 15 : friction ? 14 : 13);
  collectively(world, [&] {
    for (int k = rank; k < count; k += ranks) {
      const auto [kind, n, r] = pairs[static_cast<std::size_t>(k)];
      const SubModel pair =
          kind == 1 ? enriched_pair(model, n, r) : SubModel{leading(model, n, r), {}};
      const ModelErrors e = model_errors(pair.model, pair.embedding, truths, w);
      rows.row(k).head(13) << kind, n, r, e.u.mean(), e.u.maxCoeff(), e.u_floor.mean(),
          e.lambda.mean(), e.lambda.maxCoeff(), e.lambda_floor.mean(), e.seconds, e.failed,
          e.u_floor.maxCoeff(), e.lambda_floor.maxCoeff();
      if (friction) rows(k, 13) = e.tangential.maxCoeff();
      if (stresses) rows(k, 14) = e.tangential_floor.maxCoeff();
    }
  });
  over_ranks(world, MPI_SUM, rows);
  collectively(world, [&] {
    if (rank != 0) return;
    std::vector<std::vector<double>> columns;
    for (const auto &column : rows.colwise())
      columns.emplace_back(column.begin(), column.end());
    std::vector<std::string> names{"enriched",        "N",          "R",
                                   "u_mean",          "u_max",      "u_floor_mean",
                                   "lambda_mean",     "lambda_max", "lambda_floor_mean",
                                   "seconds",         "failed",     "u_floor_max",
                                   "lambda_floor_max"};
    if (friction) names.emplace_back("tangential_max");
    if (stresses) names.emplace_back("tangential_floor_max");
    write_columns(path, names, columns);
  });
}

/// The multiplier where it is worst (with friction its tangential part), and what it should be.
void write_worst_pressure(const fs::path &path, const ReducedModel &model, const Truths &truths,
                          const ModelErrors &errors) {
  const bool friction = errors.tangential.size() > 0;
  Index worst = 0;
  (friction ? errors.tangential : errors.lambda).maxCoeff(&worst);
  const Mu &mu = truths.mu[static_cast<std::size_t>(worst)];
  OnlineSolver solver(model);
  const std::vector<Point> points = dual_points(solver.contact());
  const Matrix reduced = by_node(solver.contact(), solver.multiplier(solver.solve(mu, true))),
               truth = by_node(solver.contact(), truths.lambda.col(worst));
  Table table;
  table.add(model.parameters, std::vector<Mu>(points.size(), mu));
  std::vector<double> interface;
  for (const auto &one : solver.contact().interfaces)
    interface.resize(interface.size() + static_cast<std::size_t>(one->dual().nodes()),
                     interface.empty() ? 1 : interface.back() + 1);
  table.add("interface", interface);
  for (std::size_t k = 0; k < static_cast<std::size_t>(solver.scene().dim); ++k) {
    std::vector<double> coordinates;
    for (const Point &x : points)
      coordinates.push_back(x[k]);
    table.add(std::string(1, static_cast<char>('x' + k)), coordinates);
  }
  table.add("high_fidelity", truth.col(0));
  table.add("reduced", reduced.col(0));
  if (friction) {
    table.add("high_fidelity_tangential", truth.col(1));
    table.add("reduced_tangential", reduced.col(1));
  }
  table.write(path);
}

/// One row per way to answer.
void write_summary(const fs::path &path,
                   const std::vector<std::pair<std::string, const ModelErrors *>> &rows,
                   const ReducedModel &model) {
  std::ostringstream text;
  text << std::setprecision(10)
       << "model,N,S,R,free_modes,u_mean,u_max,u_floor_mean,u_floor_max,lambda_mean,lambda_max,"
          "lambda_floor_mean,lambda_floor_max,seconds,kkt_residual,failed\n";
  for (const auto &[name, e] : rows)
    text << name << ',' << model.modes << ',' << (name == "decorrelated" ? 0 : model.supremizers)
         << ',' << model.generators << ',' << model.free_modes << ',' << e->u.mean() << ','
         << e->u.maxCoeff() << ',' << e->u_floor.mean() << ',' << e->u_floor.maxCoeff() << ','
         << e->lambda.mean() << ',' << e->lambda.maxCoeff() << ',' << e->lambda_floor.mean() << ','
         << e->lambda_floor.maxCoeff() << ',' << e->seconds << ',' << e->kkt_residual << ','
         << e->failed << '\n';
  write_atomically(path, text.str());
}

void write_errors(const fs::path &path, const ParameterSpace &space, const Truths &truths,
                  const ModelErrors &enriched, const ModelErrors &plain) {
  Table table;
  table.add(space, truths.mu);
  table.add("u_enriched", enriched.u);
  table.add("lambda_enriched", enriched.lambda);
  table.add("u_decorrelated", plain.u);
  table.add("lambda_decorrelated", plain.lambda);
  if (enriched.tangential.size() > 0) {
    table.add("tangential_enriched", enriched.tangential);
    table.add("tangential_decorrelated", plain.tangential);
  }
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
  const Mesh &mesh = problem.mesh();
  for (std::size_t p = 0; p < all.size(); ++p) {
    const Scene &scene = problem.scene();
    const MappedVertices mapped = map_vertices(scene, expand(scene.parameters, all[p]), mesh);
    for (std::size_t k = 0; k < mesh.cells.size(); ++k)
      worst[p] = std::max(worst[p], aspect_ratio(mesh.dim, cell_of(mesh, k, mapped).mapped));
  }
  over_ranks(world, MPI_MAX, worst);
  std::vector<double> is_training(all.size(), 0);
  std::fill_n(is_training.begin(), training.size(), 1.0);
  collectively(world, [&] {
    if (rank_of(world) != 0) return;
    Table table;
    table.add(problem.scene().parameters, all);
    table.add("training", is_training);
    table.add("max_aspect_ratio", worst);
    table.write(path);
    std::printf("Mesh: aspect ratio at most %.2f over %zu parameters\n",
                *std::max_element(worst.begin(), worst.end()), all.size());
  });
}

/// What the terms leave of each operator, along their number, over the training and the validation
/// set (Niakh 2022, figure 3.6); where contact follows the displacement also what those of b over
/// all states would. Collective.
void write_separation(const fs::path &path, Problem &problem, const ReducedModel &model,
                      const std::vector<ContactPoint> &training,
                      const std::vector<ContactPoint> &states, const std::vector<Mu> &validation) {
  constexpr double of_states = 1e-6;
  std::vector<SeparationErrors> separated = separation_errors(problem, model, validation);
  const bool follows = follows_state(problem.contact());
  int svd_rank = 0;
  if (follows) {
    StateSeparation found = separation_over_states(problem.contact(), problem.scene().parameters,
                                                   training, states, of_states);
    svd_rank = found.svd_rank;
    separated.push_back(std::move(found.errors));
  }
  collectively(problem.comm(), [&] {
    if (rank_of(problem.comm()) != 0) return;
    std::ostringstream text;
    text << std::setprecision(4) << "operator,terms,training_error,validation_error\n";
    std::string line;
    for (const auto &[name, at_training, errors] : separated) {
      for (std::size_t j = 0; j < errors.size(); ++j)
        text << name << ',' << j << ',' << at_training[j] << ',' << errors[j] << '\n';
      if (!follows || name != separated.back().name)
        line += (line.empty() ? "" : ", ") + name + ' ' + short_number(errors.back());
    }
    write_atomically(path, text.str());
    for (const auto &[name, terms] : {std::pair{"a", &model.a}, {"f", &model.f}})
      if (terms->exact > 0)
        line += (line.empty() ? "" : ", ") + std::string(name) + ": " +
                counted(terms->exact, "exact term");
    std::printf("Interpolation over %zu validation mu, largest error: %s\n", validation.size(),
                line.empty() ? "none" : line.c_str());
    if (follows)
      std::printf("B over (mu, step), were it interpolated: %td terms leave %s of %zu training and "
                  "%s of %zu validation states; its rank by SVD at %s: %d\n",
                  std::ssize(separated.back().training) - 1,
                  short_number(separated.back().training.back()).c_str(), training.size(),
                  short_number(separated.back().validation.back()).c_str(), states.size(),
                  short_number(of_states).c_str(), svd_rank);
  });
}

std::string reduction_name(const NodalLaw &law) {
  return multiplier_reduction_names()[static_cast<std::size_t>(law.reduction)];
}

const char *kind_name(OutputKind kind) {
  return kind == OutputKind::quantity  ? "quantity"
         : kind == OutputKind::measure ? "measure"
                                       : "check";
}

/// Every output: its definition's kind, absolute errors, and errors over its range and its value.
void write_output_errors(const fs::path &path, const std::vector<OutputError> &errors) {
  std::ostringstream text;
  text << std::setprecision(4)
       << "output,kind,mean,max,mean_of_range,max_of_range,mean_of_value,max_of_value\n";
  for (const OutputError &e : errors)
    text << e.name << ',' << kind_name(output_column(e.name).kind) << ',' << e.mean << ',' << e.max
         << ',' << e.mean_of_range << ',' << e.max_of_range << ',' << e.mean_of_value << ','
         << e.max_of_value << '\n';
  write_atomically(path, text.str());
}

/// Errors of the outputs that have a target: quantities and measures.
void print_output_errors(const std::vector<OutputError> &errors) {
  std::printf("Errors of the outputs: largest, over the range, over the value\n");
  for (const OutputError &e : errors)
    if (output_column(e.name).kind != OutputKind::check)
      std::printf("  %-20s %9.1e %9.1e %9.1e\n", e.name.c_str(), e.max, e.max_of_range,
                  e.max_of_value);
}

/// The reduced outputs at the validation mu, and their errors.
std::vector<OutputError> check_outputs(const ReducedModel &model, const Truths &truths,
                                       const fs::path &out) {
  const std::vector<Outputs> reduced = reduced_outputs(model, truths.mu);
  std::vector<OutputError> errors = output_errors(reduced, truths.outputs);
  print_output_errors(errors);
  write_output_errors(out / "outputs.csv", errors);
  std::ostringstream table;
  write_csv(table, model.parameters, truths.mu, reduced);
  write_atomically(out / "reduced.csv", table.str());
  return errors;
}

/// Errors of the model, of its modes alone and of its leading parts, into tables, and the
/// summaries into the model file.
void check_errors(ReducedModel &model, const Problem &problem, const Truths &truths,
                  const ToolOptions &options, const fs::path &out) {
  const SparseMatrix &w = problem.w_product();
  const ModelErrors whole = model_errors(model, {}, truths, w);
  const ModelErrors plain =
      model.supremizers == 0
          ? whole
          : model_errors(leading(model, model.modes, model.generators), {}, truths, w);
  const std::string name = !model.has_multipliers() ? nitsche_name(model)
                           : model.law              ? reduction_name(*model.law)
                           : model.supremizers == 0 ? "decorrelated"
                           : model.online_enriched  ? "online-enriched"
                                                    : "offline-enriched";
  std::vector<std::pair<std::string, const ModelErrors *>> rows{{name, &whole}};
  if (model.supremizers > 0) rows.emplace_back("decorrelated", &plain);
  std::printf("Relative errors over %zu validation mu\n"
              "  %-18s %9s %9s   %9s %9s   %9s   %9s\n",
              truths.mu.size(), "", "u mean", "max", "lambda m.", "max", "ms/query", "KKT");
  for (const auto &[label, errors] : rows)
    print_errors(label.c_str(), *errors);
  std::printf("  %-18s %9.2e %9.2e   %9.2e %9.2e\n", "bases alone", whole.u_floor.mean(),
              whole.u_floor.maxCoeff(), whole.lambda_floor.mean(), whole.lambda_floor.maxCoeff());
  if (whole.tangential_floor.size() > 0)
    std::printf("  %-18s %9s %9s   %9.2e %9.2e\n", "  lambda_tau", "", "",
                whole.tangential_floor.mean(), whole.tangential_floor.maxCoeff());
  write_errors(out / "errors.csv", options.scene.parameters, truths, whole, plain);
  write_summary(out / "summary.csv", rows, model);
  if (whole.failed == 0) write_worst_pressure(out / "worst_pressure.csv", model, truths, whole);
  model.validation_enriched = model.supremizers > 0 ? summary(whole) : ValidationErrors{};
  model.validation_decorrelated = summary(plain);
  (model.supremizers > 0 ? model.validation_enriched : model.validation_decorrelated).outputs =
      check_outputs(model, truths, out);
  look_for_other_answers(model, problem.scene(), truths.mu);
  print_several_answers(std::cout, model);
  write_model(model, options.out / "model.h5");
}

} // namespace

void command_verify(const ToolOptions &given) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  ReducedModel model = model_of_run(world, given.out);
  const ToolOptions options = adopt_model(given, model);
  check_eigen_options(options, EigenUse::constants);
  const std::vector<Mu> validation = parse_set(options.scene.parameters, options.valid);
  check_set(options.scene, validation);
  const std::vector<Mu> training = from_columns(model.trained_mu);
  const Grouping grouping =
      group_ranks(world, options.scene, options.mesh, validation.size(), options.ranks_per_solve);
  const Groups groups(world, grouping.ranks_per_solve);
  Workspace work(world, groups, options);
  check_problem(work.group_problem(), model, options);
  const Sweep sweep = run_sweep(world, groups, work.group_problem(), options.hf, validation,
                                options.out / "samples");
  check_failures(options, sweep.report, validation.size(), "validation");
  const std::vector<Sample> &answers = sweep.samples;
  Problem &problem = work.world_problem();
  const Truths truths = make_truths(problem, model, answers);
  const fs::path out = options.out / "verify";
  collectively(world, [&] {
    if (rank_of(world) != 0) return;
    sweep_up(options.out);
    make_directory(out);
    for (const char *of_another_model : {"infsup.csv", "infsup_training.csv", "stability.csv"})
      fs::remove(out / of_another_model);
    check_errors(model, problem, truths, options, out);
    write_sample_table(out / "samples.csv", options.scene.parameters, answers);
  });
  write_error_map(out / "error_map.csv", world, model, truths, problem.w_product());
  write_mesh_quality(out / "mesh_quality.csv", world, problem, training, truths.mu);
  const std::vector<ContactPoint> points =
      follows_state(problem.scene())
          ? contact_points(run_sweep(
                               world, groups, work.group_problem(), options.hf, training,
                               options.out / "samples", [] {}, Fields::in_files)
                               .samples)
          : at_rest(training);
  write_separation(out / "eim.csv", problem, model, points, contact_points(answers), truths.mu);
  const int rank = rank_of(world);
  const std::string none = no_constants(model);
  if (options.stability && none.empty())
    check_stability(world, problem, model, points, contact_points(answers), out);
  else if (options.stability && rank == 0)
    std::printf("Inf-sup constants: none, %s\n", none.c_str());
  if (rank == 0) {
    tell_of_samples(problem.scene(), problem.contact(), answers, std::cout);
    print_written(std::cout, {out, options.out / "model.h5"});
  }
  report_failures(options, sweep.report, validation.size(), "validation",
                  "measured over the others");
}

} // namespace rbvi
