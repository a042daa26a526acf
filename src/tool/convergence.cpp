// rbvi bench -convergence: outputs on refined meshes, their orders, and the limit that they tell.
#include "rbvi/tool/convergence.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/fem/check_scene.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/model/print.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/commands.hpp"
#include "scene_tests.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>

namespace rbvi {

Convergence convergence_of(const std::vector<double> &values, const std::vector<int> &refinements) {
  constexpr double round_off = 1e-10;
  double largest = 0;
  for (const double value : values)
    largest = std::max(largest, std::abs(value));
  Convergence result;
  for (std::size_t k = 2; k < values.size(); ++k) {
    const double before = values[k - 1] - values[k - 2], now = values[k] - values[k - 1];
    const int halvings = refinements[k] - refinements[k - 1];
    const bool tells = before * now > 0 &&
                       std::min(std::abs(before), std::abs(now)) > round_off * largest &&
                       halvings == refinements[k - 1] - refinements[k - 2];
    result.orders.push_back(tells ? std::optional(std::log2(before / now) / halvings)
                                  : std::nullopt);
    if (k + 1 == values.size() && tells && before / now > 1)
      result.richardson = values[k] + now / (before / now - 1);
  }
  return result;
}

namespace {

using Row = std::vector<std::string>;

std::string cell(const char *format, const std::optional<double> &value) {
  return value && std::isfinite(*value) ? formatted(format, *value) : "";
}

Row header_of(const std::vector<int> &refinements) {
  Row row{"test", "output"};
  for (const int refine : refinements)
    row.push_back("refine_" + std::to_string(refine));
  for (std::size_t k = 2; k < refinements.size(); ++k)
    row.push_back("order_" + std::to_string(refinements[k]));
  row.insert(row.end(), {"richardson", "expected", "off_by"});
  return row;
}

Row row_of(const SceneTest &test, const OutputColumn &column, const std::vector<double> &values,
           const std::vector<int> &refinements) {
  const Convergence found = convergence_of(values, refinements);
  Row row{test.name, column.name};
  for (const double value : values)
    row.push_back(cell("%.9g", value));
  for (const std::optional<double> &order : found.orders)
    row.push_back(cell("%.2f", order));
  std::optional<double> expected, off;
  if (const auto known = test.expected.find(column.name); known != test.expected.end()) {
    expected = known->second;
    off = std::abs(found.richardson.value_or(values.back()) - *expected) /
          (*expected == 0 ? 1 : std::abs(*expected));
  }
  row.insert(row.end(),
             {cell("%.9g", found.richardson), cell("%.9g", expected), cell("%.1e", off)});
  return row;
}

/// Outputs at the tests, on one mesh. Collective.
std::vector<Outputs> outputs_on(const MeasureOptions &options, int refine,
                                const std::vector<SceneTest> &tests) {
  MeshOptions mesh = options.mesh;
  mesh.refine = refine;
  Problem problem(PETSC_COMM_WORLD, with_all_free(options.scene), mesh, options.contact_gather);
  check_scene(problem);
  HighFidelity solver(problem, options.hf);
  std::vector<Outputs> outputs;
  for (const SceneTest &test : tests)
    outputs.push_back(while_doing("solving at '" + test.name + "'", [&] {
      return solver.solve(place_of(test, problem.scene().parameters)).outputs;
    }));
  return outputs;
}

} // namespace

void command_convergence(const MeasureOptions &options) {
  std::vector<SceneTest> tests = options.scene.tests;
  if (tests.empty()) tests.push_back({"defaults"});
  std::vector<std::vector<Outputs>> meshes;
  for (const int refine : options.convergence)
    meshes.push_back(outputs_on(options, refine, tests));
  std::vector<Row> rows{header_of(options.convergence)};
  for (std::size_t t = 0; t < tests.size(); ++t)
    for (const OutputColumn &column : columns_of({meshes.back()[t]})) {
      std::vector<double> values;
      for (const std::vector<Outputs> &mesh : meshes)
        values.push_back(column.of(mesh[t]).value_or(std::nan("")));
      if (column.kind != OutputKind::check)
        rows.push_back(row_of(tests[t], column, values, options.convergence));
    }
  collectively(PETSC_COMM_WORLD, [&] {
    if (rank_of(PETSC_COMM_WORLD) != 0) return;
    std::string csv;
    for (const Row &row : rows) {
      csv += table_line(row, "", ",", "");
      for (std::size_t k = 0; k < row.size(); ++k)
        std::printf(k < 2 ? "%-20s " : "%14s ", row[k].c_str());
      std::printf("\n");
    }
    if (options.out.empty()) return;
    make_directory(options.out / "bench");
    write_atomically(options.out / "bench" / "convergence.csv", csv);
    print_written(std::cout, {options.out / "bench" / "convergence.csv"});
  });
}

} // namespace rbvi
