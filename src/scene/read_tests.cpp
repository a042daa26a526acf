#include "reader.hpp"

#include "rbvi/core/outputs.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// Throws bad_input where there is none.
const CaseNode &declaration_of(const Reader &reader, const std::string &parameter) {
  const CaseNode &all = section(reader, "parameters");
  std::vector<std::string> names;
  for (const auto &[name, node] : all.entries)
    names.push_back(name);
  const CaseNode *found = all.find(parameter);
  if (found == nullptr)
    throw bad_input("there is no parameter '" + parameter + "': the nearest is '" +
                    nearest_name(parameter, names) + "'");
  return *found;
}

/// A parameter that only other choices use has no value here.
void read_place(const Reader &reader, const std::string &name, const CaseNode &node,
                const Scene &scene, SceneTest &test) {
  const CaseNode &declared = declaration_of(reader, name);
  if (is_constant(declared))
    throw bad_input(name + " is a constant: a test is at parameters that have a range");
  const double value = number_in(reader, node, unit_of(declared));
  const auto used = std::ranges::find(scene.parameters.all, name, &Parameter::name);
  if (used == scene.parameters.all.end()) return;
  check_range(used->valid, value, name);
  if (declared.find("limits") == nullptr) check_range({used->lower, used->upper}, value, name);
  test.at[name] = value;
}

/// Of an output of the scene's own; else "".
std::string unit_of_output(const std::string &name, const Scene &scene) {
  const auto found = std::ranges::find(scene.outputs, name, &OutputForm::name);
  return found == scene.outputs.end() ? "" : found->unit;
}

/// Throws bad_input where there is none.
void check_output(const std::string &name, const Scene &scene) {
  std::vector<std::string> names;
  for (const OutputColumn &column : output_columns())
    names.push_back(column.name);
  for (const OutputForm &output : scene.outputs)
    names.push_back(output.name);
  if (std::ranges::find(names, name) == names.end())
    throw bad_input("there is no output '" + name + "': the nearest is '" +
                    nearest_name(name, names) + "'");
}

SceneTest test_in(const Reader &reader, const std::string &name, const CaseNode &node,
                  const Scene &scene, Defects &defects) {
  SceneTest test{name};
  if (const CaseNode *at = node.find("at"))
    for (const auto &[parameter, value] : at->entries)
      defects.collect(value, [&, &own = parameter, &number = value] {
        read_place(reader, own, number, scene, test);
      });
  const CaseNode &expect = entry(node, "expect");
  if (expect.entries.empty()) throw bad_input("a test expects an output: {normal_force: 1.5}");
  for (const auto &[output, value] : expect.entries)
    defects.collect(value, [&, &own = output, &number = value] {
      check_output(own, scene);
      test.expected[own] = number_in(reader, number, unit_of_output(own, scene));
    });
  test.tolerance = number_in(reader, entry(node, "tolerance"));
  if (!(test.tolerance > 0)) throw bad_input("the tolerance of a test is positive");
  return test;
}

} // namespace

void read_tests(const Reader &reader, Scene &scene, Defects &defects) {
  for (const auto &[name, node] : section(reader, "tests").entries)
    defects.collect(node, [&, &own = name, &value = node] {
      scene.tests.push_back(test_in(reader, own, value, scene, defects));
    });
}

} // namespace rbvi
