// rbvi verify: a finished model against high-fidelity solves over the validation set.
#include "verify.hpp"
#include "failures.hpp"
#include "model_case.hpp"
#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/geometry.hpp"
#include "rbvi/io/output_table.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/model/model.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/model/print.hpp"
#include "rbvi/model/solution_vtu.hpp"
#include "rbvi/model/training_samples.hpp"
#include "rbvi/mor/other_answers.hpp"
#include "rbvi/mor/reduce.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/study/effectivity.hpp"
#include "rbvi/study/errors.hpp"
#include "rbvi/study/output_errors.hpp"
#include "rbvi/study/separation_errors.hpp"
#include "rbvi/sweep/grouping.hpp"
#include "rbvi/tool/commands.hpp"
#include "rbvi/tool/tables.hpp"
#include "rbvi/tool/workspace.hpp"
#include "run_directory.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <sstream>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

/// Equal steps of the coordinate of each free parameter.
std::vector<Mu> along_parameters(const Scene &scene, const Mu &middle) {
  constexpr int steps = 32;
  std::vector<Mu> lines;
  for (std::size_t i = 0; i < middle.size(); ++i) {
    const int p = scene.parameters.free[i];
    const Parameter &parameter = scene.parameters.all[p];
    const Coordinate *own = coordinate_of(scene, p);
    const double low = own ? own->of(parameter.lower) : parameter.lower,
                 high = own ? own->of(parameter.upper) : parameter.upper;
    for (int k = 0; k <= steps; ++k) {
      const double x = low + (high - low) * k / steps, value = own ? own->back(x) : x;
      lines.push_back(middle);
      lines.back()[i] = taken(parameter, std::clamp(value, parameter.lower, parameter.upper));
    }
  }
  return lines;
}

/// The middle, and where the normal force of the others is least and largest.
std::vector<Mu> far_apart(const Mu &middle, const std::vector<Mu> &set,
                          const std::vector<Outputs> &outputs) {
  std::vector<Mu> chosen{middle};
  if (set.empty()) return chosen;
  const auto force = [](const Outputs &of) { return of.normal_force.value_or(0); };
  const auto [least, largest] = std::ranges::minmax_element(outputs, {}, force);
  chosen.push_back(set[static_cast<std::size_t>(least - outputs.begin())]);
  chosen.push_back(set[static_cast<std::size_t>(largest - outputs.begin())]);
  return chosen;
}

void write_stresses(OnlineSolver &solver, const std::vector<Mu> &set, const fs::path &path) {
  const Contact &contact = solver.contact();
  const std::vector<Point> points = dual_points(contact);
  std::vector<Mu> mus;
  Table table;
  std::vector<double> interface, pressure, tangential;
  std::array<std::vector<double>, 3> x;
  const auto dim = static_cast<std::size_t>(solver.scene().dim);
  for (const Mu &mu : set) {
    const Matrix stress = by_node(contact, solver.multiplier(solver.solve(mu, true)));
    for (std::size_t i = 0, row = 0; i < contact.interfaces.size(); ++i)
      for (Index node = 0; node < contact.interfaces[i]->dual().nodes(); ++node, ++row) {
        mus.push_back(mu);
        interface.push_back(static_cast<double>(i + 1));
        for (std::size_t c = 0; c < dim; ++c)
          x[c].push_back(points[row][c]);
        const auto at = stress.row(static_cast<Index>(row));
        pressure.push_back(at[0]);
        tangential.push_back(dim == 2 ? at[1] : at.tail(2).norm());
      }
  }
  table.add(solver.scene().parameters, mus);
  table.add("interface", interface);
  for (std::size_t c = 0; c < dim; ++c)
    table.add(std::string(1, "xyz"[c]), x[c]);
  table.add("pressure", pressure);
  table.add("tangential", tangential);
  table.write(path);
}

/// Into the directory `out`: along.csv, reduced outputs along each free parameter through the
/// middle of the box, as many rows for each one after the other; stresses.csv, what the contacts
/// carry at the middle and at those of `set` where the normal force is least and largest; u.vtu
/// with its contact files, the answer at the middle. `outputs`: of the set; `only`: those of
/// along.csv. Where there is no answer there are no rows, or no file. Serial.
void write_pictures(const ReducedModel &model, const std::vector<Mu> &set,
                    const std::vector<Outputs> &outputs, const std::vector<std::string> &only,
                    const fs::path &out) {
  const Mu middle = box_centre(model.scene.parameters);
  const std::vector<Mu> lines = along_parameters(model.scene, middle);
  std::ostringstream table;
  write_csv(table, model.scene.parameters, lines, reduced_outputs(model, lines, only));
  write_atomically(out / "along.csv", table.str());
  for (const char *file : {"stresses.csv", "u.vtu"})
    fs::remove(out / file);
  OnlineSolver solver(model);
  try {
    write_stresses(solver, far_apart(middle, set, outputs), out / "stresses.csv");
    const ReducedAnswer answer = solver.solve(middle);
    write_vtu(out / "u.vtu", model.scene, answer.mu, model, solver.field(answer),
              solver.multiplier(answer));
  } catch (const Error &error) { // an answer that is not there is told where it was asked for
    if (error.status() == Status::bad_input) throw;
  }
}

namespace fs = std::filesystem;

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
  if (model.contact.generators == 0) return {5, 10, 15, 20, 30, 40, 50};
  return {10, 19, 51};
}

/// The R at which the model's dual basis means something on its own.
std::vector<int> generator_counts(const ReducedModel &model) {
  const auto type = model.made.settings.find("cone_type");
  if (type != model.made.settings.end() && (type->second == "nodal" || type->second == "nmf"))
    return {model.contact.generators};
  const int cone = model.contact.generators - model.contact.free_modes;
  if (model.contact.law) return {model.contact.generators};
  if (model.contact.free_modes > 0)
    return sizes_up_to(model.contact.generators, {cone, cone + 4, cone + 8});
  return sizes_up_to(model.contact.generators, {20, 50, 70, 100});
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
    for (const int n : sizes_up_to(model.body.modes, mode_counts(model)))
      for (const int r : generator_counts(model))
        pairs.push_back({kind, n, r});
  const int rank = rank_of(world), ranks = ranks_of(world);
  const auto count = static_cast<int>(pairs.size());
  const bool friction = truths.tangential_norm.size() > 0;
  const bool stresses = friction && !model.has_multipliers();
  Matrix rows = Matrix::Zero(count, stresses ? 15 : friction ? 14 : 13);
  collectively(world, [&] {
    for (int k = rank; k < count; k += ranks) {
      const auto [kind, n, r] = pairs[k];
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
  int svd_rank = 0, multipliers = 0;
  if (follows) {
    StateSeparation found = separation_over_states(problem.contact(), problem.scene().parameters,
                                                   training, states, of_states);
    svd_rank = found.svd_rank;
    multipliers = found.multipliers;
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
    for (const auto &[name, terms] : {std::pair{"a", &model.body.a}, {"f", &model.body.f}})
      if (terms->exact > 0)
        line += (line.empty() ? "" : ", ") + std::string(name) + ": " +
                counted(terms->exact, "exact term");
    std::printf("Interpolation over %zu validation mu, largest error: %s\n", validation.size(),
                line.empty() ? "none" : line.c_str());
    if (follows)
      std::printf("B over (mu, step), were it interpolated: %td terms leave %s of %zu training and "
                  "%s of %zu validation states; its rank by SVD at %s: %d; entries of %d "
                  "multipliers of %td\n",
                  std::ssize(separated.back().training) - 1,
                  short_number(separated.back().training.back()).c_str(), training.size(),
                  short_number(separated.back().validation.back()).c_str(), states.size(),
                  short_number(of_states).c_str(), svd_rank, multipliers,
                  problem.contact().dual_size());
  });
}

/// High-fidelity answers at the corners and faces of the box, but for those in `validation`; rank 0
/// says where there is none. Collective.
std::vector<Sample> boundary_samples(MPI_Comm world, const Groups &groups, Problem &problem,
                                     const OfflineOptions &options,
                                     const std::vector<Mu> &validation) {
  const ParameterSpace &space = options.scene.parameters;
  std::vector<Mu> set = corners_and_faces(space);
  std::erase_if(
      set, [&](const Mu &mu) { return std::ranges::find(validation, mu) != validation.end(); });
  if (set.empty()) return {};
  Sweep sweep = run_sweep(world, groups, problem, options.hf, set, {options.out / "samples"});
  if (const auto &failed = sweep.report.failed; rank_of(world) == 0 && !failed.empty())
    std::printf(
        "%zu of %zu corners and centres of faces have no high-fidelity answer, the first at "
        "%s: %s\n",
        failed.size(), set.size(), describe(space, failed.front().first).c_str(),
        failed.front().second.c_str());
  return std::move(sweep.samples);
}

/// Bounds over true errors. Throws failure where a bound is below the error. Collective.
void measure_bounds(Problem &problem, const ReducedModel &model, const std::vector<Sample> &answers,
                    const std::vector<Sample> &further) {
  std::vector<Sample> all = answers;
  all.insert(all.end(), further.begin(), further.end());
  const Effectivities found = effectivities(problem, model, all);
  if (rank_of(problem.comm()) == 0) print_effectivities(std::cout, found);
  if (found.wrong > 0)
    throw failure(
        counted(found.wrong, "bound") +
        " of u or of the energy that high-fidelity answers do not keep: this is a fault of "
        "rbvi, please report the case");
}

/// Without what of another model would stay in it.
void make_own_directory(const fs::path &out) {
  make_directory(out);
  for (const char *of_another_model : {"infsup.csv", "infsup_training.csv", "stability.csv"})
    fs::remove(out / of_another_model);
}

void tell_of_speed(double query, double solve) {
  const std::string slow = slow_query(query, solve);
  if (!slow.empty()) std::cout << "warning: " << slow << '\n';
}

/// Inf-sup constants and bounds, or why there are none. Collective.
void measure_stability(MPI_Comm world, Problem &problem, const ReducedModel &model,
                       const std::vector<ContactPoint> &training,
                       const std::vector<ContactPoint> &validation, const fs::path &out) {
  const std::string none = no_constants(model);
  if (none.empty())
    check_stability(world, problem, model, training, validation, out);
  else if (rank_of(world) == 0)
    std::printf("Inf-sup constants: none, %s\n", none.c_str());
}

} // namespace

void command_verify(const MeasureOptions &given) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  ReducedModel model = model_of_run(world, given);
  const MeasureOptions options = adopt_model(given, model);
  const std::vector<std::string> only = names_in(options.only);
  collectively(world, [&] { check_asked(only, model); });
  check_eigen_options(options, options.stability ? EigenUse::constants : EigenUse::no_constants);
  const std::vector<Mu> validation = validation_set(options, model);
  const std::vector<Mu> training = from_columns(model.made.trained_mu);
  const Groups groups(world, group_ranks(world, options.scene, options.mesh, validation.size(),
                                         options.ranks_per_solve)
                                 .ranks_per_solve);
  Workspace work(world, groups, options);
  check_problem(work.group_problem(), model, options.out);
  const Sweep sweep = run_sweep(world, groups, work.group_problem(), options.hf, validation,
                                {options.out / "samples"});
  check_failures(options.scene.parameters, options.max_failures, sweep.report, validation.size(),
                 "validation");
  const std::vector<Sample> &answers = sweep.samples;
  const std::vector<Sample> further =
      boundary_samples(world, groups, work.group_problem(), options, validation);
  Problem &problem = work.world_problem();
  Truths truths = make_truths(problem, model, answers);
  Truths boundary = make_truths(problem, model, further);
  share_scale(truths, boundary);
  const fs::path out = options.out / "verify";
  collectively(world, [&] {
    if (rank_of(world) != 0) return;
    sweep_up(options.out);
    make_own_directory(out);
    tell_of_speed(check_errors(model, problem.w_product(), truths, boundary, only, out),
                  sweep.report.seconds_per_solve);
    look_for_other_answers(MPI_COMM_SELF, model, problem.scene(),
                           from_columns(model.made.validated_mu));
    print_several_answers(std::cout, model);
    write_model(model, options.out / "model.h5");
    write_sample_table(out / "samples.csv", options.scene.parameters, answers);
    write_pictures(model, truths.mu, truths.outputs, only, out);
  });
  write_error_map(out / "error_map.csv", world, model, truths, problem.w_product());
  write_mesh_quality(out / "mesh_quality.csv", world, problem, training, truths.mu);
  const std::vector<ContactPoint> points =
      follows_state(problem.scene())
          ? contact_points(run_sweep(world, groups, work.group_problem(), options.hf, training,
                                     {options.out / "samples", [] {}, Fields::in_files})
                               .samples)
          : at_rest(training);
  write_separation(out / "eim.csv", problem, model, points, contact_points(answers), truths.mu);
  measure_bounds(problem, model, answers, further);
  if (options.stability)
    measure_stability(world, problem, model, points, contact_points(answers), out);
  if (rank_of(world) == 0) {
    for (const auto *samples : {&answers, &further})
      tell_of_samples(problem.scene(), problem.contact(), *samples, std::cout);
    print_written(std::cout, {out, options.out / "model.h5"});
  }
  warn_of_eigen_options(world, options);
  report_failures(options.scene.parameters, sweep.report, validation.size(), "validation",
                  "measured over the others");
}

} // namespace rbvi
