#include "online_batch.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/locking.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/warnings.hpp"
#include "rbvi/io/output_table.hpp"
#include "rbvi/io/system_error.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/model/fmu.hpp"
#include "rbvi/model/gradient.hpp"
#include "rbvi/model/model_image.hpp"
#include "rbvi/model/print.hpp"
#include "rbvi/model/solution_vtu.hpp"
#include "rbvi/model/training_samples.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>
#include <set>
#include <sstream>

namespace rbvi {

namespace {

std::string usage() {
  std::string text = "rbvi-online MODEL            what the model is: parameters, sizes, errors\n"
                     "rbvi-online MODEL [options]  answers\n";
  for (const OnlineOption &option : online_options()) {
    const std::string name =
        "--" + option.name + (option.values.empty() ? "" : " ") + option.values;
    text += "  " + name +
            std::string(std::max<std::size_t>(17, name.size() + 1) - name.size(), ' ') +
            option.help + "\n";
  }
  return text + "Exit status: 0 done, 1 it failed, 2 the input is wrong (nothing is written).\n";
}

const OnlineOption &find_option(const std::string &name) {
  std::vector<std::string> names;
  for (const OnlineOption &option : online_options()) {
    if (option.name == name) return option;
    names.push_back(option.name);
  }
  throw bad_input("unknown option --" + name + "; the nearest one is --" +
                  nearest_name(name, names) + " (--help lists all)");
}

/// A whole number between two.
void check_number(const std::string &text, const std::string &name, int least, int most) {
  const double number = parse_number(text, name);
  if (number != std::floor(number) || number < least || number > most)
    throw bad_input(name + " is " + text + ": use a whole number from " + std::to_string(least) +
                    " to " + std::to_string(most));
}

void check_combination(const OnlineArguments &given) {
  if (given.help || given.version) return;
  if (given.model.empty()) throw bad_input("no model is named; --help shows how");
  const bool one = !given.mu.empty(), many = !given.queries.empty();
  if (one && many) throw bad_input("--mu and --queries exclude each other");
  for (const auto &[name, file] : {std::pair{"--pack", given.pack}, std::pair{"--fmu", given.fmu}})
    if (!file.empty() && (one || many))
      throw bad_input(std::string(name) + " takes no --mu and no --queries");
  if (!given.pack.empty() && !given.fmu.empty())
    throw bad_input("--pack and --fmu exclude each other");
  if (!given.fmu.empty() && !given.fmu.ends_with(".fmu"))
    throw bad_input("--fmu is " + given.fmu + ": the name of a unit ends with .fmu");
  if (given.gradient && !one && !many) throw bad_input("--gradient needs --mu or --queries");
  if (!given.only.empty() && !one && !many) throw bad_input("--only needs --mu or --queries");
  if (given.warm && !many) throw bad_input("--warm needs --queries");
  if (given.json && !one) throw bad_input("--json needs --mu");
  if (!given.contact.empty() && !one && !many) throw bad_input("--contact needs --mu or --queries");
  if (!given.threads.empty()) {
    if (!many) throw bad_input("--threads needs --queries");
    if (given.warm) throw bad_input("--warm goes from answer to answer: leave out --threads");
    check_number(given.threads, "--threads", 1, 1000);
  }
  if (!given.vtu.empty() && !one) throw bad_input("--vtu needs --mu");
  if (!given.out.empty() && !one && !many) throw bad_input("--out needs --mu or --queries");
  if (given.precision.empty()) return;
  if (!many && given.out.empty() && given.contact.empty())
    throw bad_input("--precision needs --queries, --out or --contact");
  check_number(given.precision, "--precision", 1, 17);
}

} // namespace

const std::vector<OnlineOption> &online_options() {
  using Arguments = OnlineArguments;
  static const std::vector<OnlineOption> options{
      {"mu", "VALUES", "one answer: 0.18,0.02,-0.01 or radius=0.18,center_x=0.02", &Arguments::mu},
      {"queries", "SET",
       "one row per mu: a CSV file (a column id is handed on), grid:5,5,5, random:COUNT:SEED, "
       "corners or - "
       "(a CSV table on standard input)",
       &Arguments::queries},
      {"out", "FILE", "the table as CSV (standard output without it, or as -)", &Arguments::out},
      {"only", "NAMES",
       "these outputs alone, normal_force,peak_pressure: those of the case that are not named are "
       "not "
       "computed",
       &Arguments::only},
      {"precision", "DIGITS", "of the numbers in the tables: 1 to 17, 10 without it",
       &Arguments::precision},
      {"contact", "FILE",
       "a table as CSV of what answers are along contacts: row, contact, place, pressure, gap, ...",
       &Arguments::contact},
      {"threads", "N",
       "with --queries: threads that answer, 64 rows for each at a time; rows keep their order and "
       "their digits",
       &Arguments::threads},
      {"json", "", "with --mu: the answer as one JSON object", nullptr, &Arguments::json},
      {"vtu", "FILE",
       "with --mu: the field, and the contact region (of two bodies the curve) in FILE_contact, of "
       "several contacts each in FILE_contact_NAME",
       &Arguments::vtu},
      {"pack", "FILE",
       "the model as one image for librbvi (include/rbvi.h), with its fields where their file is",
       &Arguments::pack},
      {"fmu", "FILE",
       "the model as a unit of co-simulation, FILE.fmu (FMI 2.0), which simulators take",
       &Arguments::fmu},
      {"full", "", "reconstruct the field: adds min_u", nullptr, &Arguments::full},
      {"gradient", "",
       "derivatives of the outputs by the parameters, in the units of both: d_OUTPUT_d_PARAMETER",
       nullptr, &Arguments::gradient},
      {"decorrelated", "",
       "by the modes alone: without supremizers, or displacements under unit loads, beside them",
       nullptr, &Arguments::decorrelated},
      {"extrapolate", "",
       "allow mu outside the box of the model, within the range of validity (an error otherwise)",
       nullptr, &Arguments::extrapolate},
      {"method", "NAME",
       "how a query is solved: " + joined(online_method_names()) +
           " (-online_method of rbvi); without it as the model was made for",
       &Arguments::method},
      {"warm", "",
       "with --queries: each starts from the answer before, for queries along a path; without it "
       "an "
       "answer does not depend on the order of the queries",
       nullptr, &Arguments::warm},
      {"help", "", "this list", nullptr, &Arguments::help},
      {"version", "", "of the program", nullptr, &Arguments::version}};
  return options;
}

Outputs answer(OnlineSolver &solver, const Mu &mu, const OnlineArguments &arguments,
               ReducedAnswer &solution) {
  const auto start = std::chrono::steady_clock::now();
  solution = solver.solve(mu, arguments.extrapolate);
  Outputs outputs = solver.outputs(mu, solution);
  if (arguments.full && solver.scene().components == 1)
    outputs.min_u = solver.field(solution).minCoeff();
  if (arguments.gradient) {
    const std::vector<OutputColumn> columns = columns_of({asked_of(outputs, arguments.asked())});
    add_gradient(gradient_of(solver, mu, solution, columns), columns, solver.scene().parameters,
                 outputs);
  }
  outputs.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return outputs;
}

namespace {

/// What is to be said of one answer, a line for each.
std::string warnings_of(const OnlineSolver &solver, const Mu &mu, const ReducedAnswer &solution,
                        const Outputs &outputs) {
  std::ostringstream out;
  const Scene &scene = solver.scene();
  warn_of_violation(solver.model(), violation(outputs), out);
  warn_of_balance(out, solver.model());
  warn_of_failed_samples(nearest_sample_failed(solver.model(), mu) ? 1 : 0, out);
  const bool unvalidated = in_box(scene.parameters, mu) && beyond_validation(solver.model(), mu);
  warn_of_unvalidated(unvalidated ? 1 : 0, out);
  ResolutionTally resolution;
  resolution.add(outputs);
  resolution.print(out);
  const FullMu all = expand(scene.parameters, mu);
  warn_of_elements(scene, locking_ratio(scene, all, material_points(solver.contact())), out);
  warn_of_other_answers(out, solution.to_other > 0 ? 1 : 0, 1);
  return out.str();
}

void answer_one(const OnlineArguments &arguments, OnlineSolver &solver, std::ostream &out) {
  const Mu mu = parse_mu(solver.scene().parameters, arguments.mu, arguments.extrapolate);
  ReducedAnswer solution;
  const Outputs all = answer(solver, mu, arguments, solution),
                outputs = asked_of(all, arguments.asked());
  std::vector<std::filesystem::path> written;
  if (!arguments.vtu.empty())
    written = write_vtu(arguments.vtu, solver.scene(), expand(solver.scene().parameters, mu),
                        solver.model(), solver.field(solution), solver.multiplier(solution));
  const bool inside = in_box(solver.scene().parameters, mu);
  const ErrorOfOutput errors = inside ? errors_of_outputs(solver.model()) : ErrorOfOutput{};
  if (!arguments.out.empty()) {
    std::ostringstream table;
    OutputTable(table, solver.scene().parameters, outputs, {errors, true, arguments.digits()})
        .add(mu, outputs);
    write_atomically(arguments.out, table.str());
    written.emplace_back(arguments.out);
  }
  if (!arguments.contact.empty()) {
    const TraceTable traces(solver, arguments.digits());
    write_atomically(arguments.contact, traces.header() + traces.rows(solver, solution, 1));
    written.emplace_back(arguments.contact);
  }
  const std::string warnings = warnings_of(solver, mu, solution, all);
  if (arguments.json) {
    out << json_of(solver, mu, solution, outputs, errors, warnings);
    return;
  }
  out << describe(solver.scene().parameters, mu) << '\n';
  print_outputs(out, outputs, errors);
  out << warnings;
  if (inside)
    print_expected_errors(out, solver.model());
  else
    out << std::left << std::setw(22) << "expected error"
        << "unknown outside the box\n";
  if (!written.empty()) print_written(out, written);
}

} // namespace

OnlineArguments parse_online_arguments(const std::vector<std::string> &arguments) {
  OnlineArguments result;
  std::set<std::string> given;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string &argument = arguments[i];
    if (argument.size() < 2 || argument[0] != '-') {
      if (!result.model.empty())
        throw bad_input("'" + argument + "' is left over behind the model " + result.model);
      result.model = argument;
      continue;
    }
    const std::string body = argument.substr(argument[1] == '-' ? 2 : 1);
    const std::size_t equals = body.find('=');
    const OnlineOption &option = find_option(body.substr(0, equals));
    const std::string name = "--" + option.name;
    if (!given.insert(name).second) throw bad_input(name + " is given twice");
    if (option.flag != nullptr) {
      if (equals != std::string::npos) throw bad_input(name + " takes no value");
      result.*option.flag = true;
      continue;
    }
    if (equals == std::string::npos && i + 1 == arguments.size())
      throw bad_input(name + " needs a value");
    result.*option.text = equals == std::string::npos ? arguments[++i] : body.substr(equals + 1);
    if ((result.*option.text).empty()) throw bad_input(name + " needs a value");
  }
  if (std::ranges::count(result.asked(), "min_u") > 0) result.full = true;
  check_combination(result);
  return result;
}

namespace {

/// No file that is read is written.
void check_files(const OnlineArguments &arguments, const Scene &scene) {
  const std::vector<NamedFile> inputs{{"the file of queries", arguments.queries},
                                      {"the model", arguments.model}};
  if (arguments.out != "-") check_overwriting({"--out", arguments.out}, inputs);
  check_overwriting({"--contact", arguments.contact}, inputs);
  check_overwriting({"--contact", arguments.contact}, {{"--out", arguments.out}});
  if (arguments.vtu.empty()) return;
  std::vector<std::filesystem::path> files = contact_files(arguments.vtu, scene);
  files.emplace_back(arguments.vtu);
  for (const std::filesystem::path &vtu : files) {
    check_overwriting({"--vtu", vtu}, inputs);
    check_overwriting({"--vtu", vtu}, {{"--out", arguments.out}, {"--contact", arguments.contact}});
  }
}

/// Does what the arguments say. Everything is computed before a file is written.
void run(const OnlineArguments &arguments, const Registry &registry, std::ostream &out) {
  if (arguments.help) {
    out << usage();
    return;
  }
  if (arguments.version) {
    out << "rbvi-online " RBVI_VERSION "\n";
    return;
  }
  const bool packs = !arguments.pack.empty();
  const bool fields = arguments.full || !arguments.vtu.empty() ||
                      (packs && std::filesystem::exists(fields_file(arguments.model)));
  ReducedModel model = read_model(arguments.model, registry, fields);
  if (arguments.decorrelated) model = leading(model, model.body.modes, model.contact.generators);
  if (packs) {
    check_overwriting({"--pack", arguments.pack}, {{"the model", arguments.model}});
    write_atomically(arguments.pack, image_of(model));
    print_written(out, {arguments.pack});
    return;
  }
  if (!arguments.fmu.empty()) {
    write_atomically(arguments.fmu, fmu_of(model, library_of_units()));
    print_written(out, {arguments.fmu});
    return;
  }
  if (arguments.mu.empty() && arguments.queries.empty()) {
    print_model(out, model);
    return;
  }
  check_asked(arguments.asked(), model);
  QueryOptions how{.warm = arguments.warm, .only = arguments.asked()};
  if (!arguments.method.empty()) how.method = online_method(arguments.method);
  OnlineSolver solver(model, how);
  check_files(arguments, solver.scene());
  if (!arguments.mu.empty()) return answer_one(arguments, solver, out);
  std::vector<std::unique_ptr<OnlineSolver>> others;
  std::vector<OnlineSolver *> solvers{&solver};
  while (solvers.size() < arguments.thread_count())
    solvers.push_back(others.emplace_back(std::make_unique<OnlineSolver>(model, how)).get());
  answer_many(arguments, solvers, out);
}

} // namespace

int rbvi_online_main(int argc, char **argv, const Registry &registry) {
  const auto refused = [](const std::exception &error, Status status) {
    std::cerr << "rbvi-online: " << in_plain_words(error.what()) << '\n';
    return static_cast<int>(status);
  };
  try {
    run(parse_online_arguments({argv + 1, argv + argc}), registry, std::cout);
    if (!std::cout.flush()) throw cannot_write("to standard output");
    return static_cast<int>(Status::done);
  } catch (const Error &error) {
    return refused(error, error.status());
  } catch (const std::exception &error) {
    return refused(error, Status::failed);
  }
}

} // namespace rbvi
