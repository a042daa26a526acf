// rbvi check: a case before anything is made of it.
#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/fem/check_scene.hpp"
#include "rbvi/mesh/contact_curves.hpp"
#include "rbvi/mesh/serial.hpp"
#include "rbvi/mesh/surface.hpp"
#include "rbvi/model/print.hpp"
#include "rbvi/mor/reduce.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "rbvi/tool/cases.hpp"
#include "rbvi/tool/commands.hpp"
#include "scene_tests.hpp"
#include "table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <numeric>

namespace rbvi {

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

namespace {

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

/// Solves at the tests of the scene, and prints what is expected, found, and how far it is off.
/// Throws failure if one does not pass. Collective on the world.
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

namespace fs = std::filesystem;

constexpr const char *random_points = "random:20:1";

/// Each of the work's complaints is one more line.
class Complaints {
public:
  template <class Work> void collect(const std::string &at, Work &&work) {
    try {
      std::forward<Work>(work)();
    } catch (const Error &error) {
      text_ += (text_.empty() ? "" : "\n") + (at.empty() ? "" : at + ": ") + error.what();
    }
  }
  void throw_all() const {
    if (!text_.empty()) throw bad_input(text_);
  }

private:
  std::string text_;
};

/// "lambda of poisson_ratio * shear, ..."
std::string factors_of(const Term &term, const ParameterSpace &space) {
  if (!term.theta) {
    std::vector<std::string> names;
    for (const int i : term.parameters.value_or(std::vector<int>{}))
      names.push_back(space.all[static_cast<std::size_t>(i)].name);
    return "interpolated over " + (names.empty() ? std::string("nothing") : joined(names, ", "));
  }
  std::vector<std::string> names;
  for (const Factor &factor : *term.theta)
    if (!factor.parameters.empty()) names.push_back(factor.name);
  return "exact" + (names.empty() ? std::string(", constant") : ", times " + joined(names, " * "));
}

/// Terms of the same factors are one line.
void print_sum(const char *name, const Sum &sum, const ParameterSpace &space) {
  std::vector<std::pair<std::string, long>> lines;
  for (const Term &term : sum) {
    if (term.of_imposed) continue;
    const std::string words = factors_of(term, space);
    const auto same = std::ranges::find(lines, words, &std::pair<std::string, long>::first);
    if (same == lines.end())
      lines.emplace_back(words, 1);
    else
      ++same->second;
  }
  for (const auto &[words, count] : lines)
    std::printf("  %-10s %s%s\n", name, words.c_str(),
                count == 1 ? "" : (" (" + std::to_string(count) + " terms)").c_str());
}

/// What the mesh of a file is, and where nothing is said of its surface.
void print_mesh(const SerialMesh &mesh, const Scene &scene, bool of_file) {
  for (const MeshFact &fact : scene.mesh.facts)
    if (of_file)
      std::printf("  %-20s is %s\n", fact.part.empty() ? "the mesh" : fact.part.c_str(),
                  fact.is.c_str());
  const std::vector<std::string> free = free_parts(mesh, surface_of(mesh, scene));
  if (!free.empty())
    std::printf("  %-20s %s: no condition, no load and no contact there\n", "free",
                joined(free).c_str());
  if (!of_file) return;
  for (const auto &[boundary, away] : off_arcs(mesh, scene))
    std::printf("  %-20s turns smoothly: its straight edges are up to %s off an arc, and so are "
                "gaps; if it is one, name it under curves\n",
                boundary.c_str(), formatted("%.1e", away).c_str());
}

/// Without the round-off of numbers that were computed.
std::string short_text(const ParameterSpace &space, Mu mu) {
  for (double &value : mu)
    value = parse_number(formatted("%.12g", value), "parameter");
  return describe(space, mu);
}

void print_scene(const Problem &problem) {
  const Scene &scene = problem.scene();
  std::printf("%s: %s\n", scene.name.c_str(), scene.summary.c_str());
  for (const Parameter &p : scene.parameters.all) {
    const bool free = find_free(scene.parameters, p.name).has_value();
    std::printf(
        "  %-20s %s%s\n", p.name.c_str(),
        (free ? describe(Range{p.lower, p.upper}) : short_number(p.value) + " (fixed)").c_str(),
        (p.unit.empty() ? "" : " " + p.unit).c_str());
  }
  std::printf("  %-20s %ld dofs, %ld contact nodes\n", "mesh", long(problem.dofs().total),
              long(problem.contact().nodes()));
  if (const auto &free = problem.free_bodies(); !free.empty()) {
    const Index motions = motions_of(free);
    std::printf("  %-20s %s\n", "held by contact",
                describe(free, scene.dim, Matrix::Identity(motions, motions)).c_str());
  }
  print_sum("a", scene.a, scene.parameters);
  print_sum("f", scene.f, scene.parameters);
  std::printf("  %-10s %s\n", "b and g",
              separable_contact(scene) ? "interpolated where they vary" : "evaluated at each mu");
}

/// Where bodies that contact alone holds are not held, and why: there is no answer there.
using Unheld = std::map<Mu, std::string>;

void print_unheld(const ParameterSpace &space, const Unheld &unheld) {
  if (unheld.empty()) return;
  const auto &[mu, why] = *unheld.begin();
  std::printf(
      "warning: no answer at %s: %s%s\n", short_text(space, mu).c_str(), why.c_str(),
      unheld.size() == 1
          ? ""
          : (" (the first of " + std::to_string(unheld.size()) + " such parameters)").c_str());
}

void ask_free_bodies(const Problem &problem, const Operators &op, const Mu &mu, Unheld &unheld) {
  if (problem.free_bodies().empty() || !has_multipliers(problem.scene())) return;
  try {
    if (const Matrix motions = unresisted_motions(problem, op); motions.cols() > 0)
      unheld[mu] = describe(problem.free_bodies(), problem.scene().dim, motions) +
                   ", where no contact and no friction prevents it";
  } catch (const Error &error) { // of every rank
    if (error.status() == Status::bad_input) throw;
    unheld[mu] = error.what();
  }
}

/// Contact, the mapped mesh and the balance of loads at the corners of the box and at random
/// points.
Unheld check_points(Problem &problem) {
  const ParameterSpace &space = problem.scene().parameters;
  std::vector<Mu> points = corners_and_faces(space);
  if (space.size() > 0)
    for (Mu &mu : parse_set(space, random_points))
      points.push_back(std::move(mu));
  Complaints complaints;
  Unheld unheld;
  for (const Mu &mu : points)
    complaints.collect("at " + describe(space, mu), [&] {
      check_query(problem.scene(), mu, false);
      ask_free_bodies(problem, problem.assemble(mu), mu, unheld);
    });
  complaints.throw_all();
  return unheld;
}

/// What an answer has to be there to tell, at the corners and faces of the box: where few solves
/// and dofs make that cheap.
void try_free_bodies(Problem &problem, HighFidelity &solver, Unheld &unheld) {
  constexpr double most = 2e5; // dofs of all solves
  const std::vector<Mu> points = corners_and_faces(problem.scene().parameters);
  if (problem.free_bodies().empty() ||
      static_cast<double>(points.size()) * problem.dofs().total_free > most)
    return;
  for (const Mu &mu : points) {
    try {
      if (!unheld.contains(mu)) solver.solve(mu);
    } catch (const Error &error) { // of every rank
      unheld[mu] = error.what();
    }
  }
}

/// Every variant of the case can be read.
void check_variants(const MeasureOptions &options) {
  const SceneEntry &entry = entry_of(*options.registry, options.scene.name);
  const std::string file =
      (fs::is_directory(options.case_name) ? options.case_name / "case.yaml" : options.case_name)
          .string();
  Complaints complaints;
  for (const auto &[variant, says] : entry.variants)
    complaints.collect("variant " + variant, [&, &name = variant] {
      (void)make_scene(read_case(options.scene_text, file, {name, {}, taken_names()}));
    });
  complaints.throw_all();
}

} // namespace

void command_check(const MeasureOptions &options, const SolveOptions &solve) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  if (solve.run_tests && options.scene.tests.empty())
    throw bad_input("this case has no 'tests:' that -run could prove (cases/CASE_FILE.md)");
  collectively(world, [&] { check_variants(options); });
  std::vector<NamedFile> outputs = files_of_solution(solve.vtu, options.scene);
  for (NamedFile &file : files_of_check(solve.vtu, options.scene))
    outputs.push_back(std::move(file));
  check_outputs(world, options, options.mesh.file, outputs);
  Problem problem(world, options.scene, options.mesh, options.contact_gather);
  check_scene(problem);
  SerialMesh mesh; // on the first rank
  collectively(world, [&] {
    if (rank_of(world) != 0) return;
    mesh = mesh_with_groups(options.scene, options.mesh.file);
    print_scene(problem);
    print_mesh(mesh, options.scene, !options.mesh.file.empty());
  });
  Unheld unheld = check_points(problem);
  collectively(world, [&] {
    for (const std::string &set : {options.train, options.valid})
      if (!set.empty())
        check_set(problem.scene(),
                  parse_set(problem.scene().parameters, set, false, problem.scene().outputs));
  });
  const Mu mu = box_centre(problem.scene().parameters);
  const std::string at = short_text(problem.scene().parameters, mu);
  HfOptions hf = options.hf;
  hf.looks_for_others = true;
  HighFidelity solver(problem, hf);
  bool warned = false;
  const HfSolution solution = while_doing("solving " + at, [&] { return solver.solve(mu); });
  write_solution(problem, solve.vtu, mu, solution);
  collectively(world, [&] {
    if (rank_of(world) != 0) return;
    if (!solve.vtu.empty()) print_written(std::cout, write_check(solve.vtu, problem, mesh));
    std::printf("at the middle of the box, %s:\n", at.c_str());
    print_outputs(std::cout, solution.outputs);
    warned = warn_of_answer(problem, mu, solution, std::cout);
    if (solution.outputs.contact_nodes && *solution.outputs.contact_nodes == 0) {
      warned = true;
      std::cout << "warning: nothing touches there\n";
    }
  });
  try_free_bodies(problem, solver, unheld);
  if (rank_of(world) == 0) {
    print_unheld(problem.scene().parameters, unheld);
    const std::string shared = overdetermined(problem.contact());
    if (!shared.empty()) std::cout << "warning: " << shared << '\n';
    std::cout << (warned || !shared.empty() || !unheld.empty()
                      ? "no error was found; what was warned of stands\n"
                      : "no defect was found\n");
  }
  if (solve.run_tests) run_tests(options);
}

} // namespace rbvi
