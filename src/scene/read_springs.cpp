#include "reader.hpp"

#include "rbvi/core/text.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// The displacement that stretches the spring: a mean, less another one.
Form stretch_of(const Reader &reader, const CaseNode &node, const Scene &scene) {
  Point direction{0, 1, 0};
  if (const CaseNode *given = node.find("direction")) {
    const std::vector<double> d = numbers_in(reader, *given, 2);
    direction = {d[0], d[1], 0};
    if (!(std::abs(norm(direction) - 1) <= 1e-6))
      throw bad_input("the direction is of the length " + short_number(norm(direction)) +
                      ": give one of length 1");
  }
  const CaseNode *at = node.find("at"), *between = node.find("between");
  if ((at == nullptr) == (between == nullptr))
    throw bad_input("a spring is 'at' a boundary, or 'between: [one, other]'");
  const std::vector<std::string> names = names_in(at != nullptr ? *at : *between);
  if (names.size() != (at != nullptr ? 1U : 2U))
    throw bad_input(at != nullptr ? "a spring to the ground is at one boundary: give each its entry"
                                  : "a spring is between two boundaries: [one, other]");
  Form stretch;
  stretch.means = {{names.front(), direction, scene.axisymmetric}};
  if (between != nullptr)
    stretch.means.push_back({names.back(), -1.0 * direction, scene.axisymmetric});
  return stretch;
}

/// The factor of an expression in parameters alone.
Factor force_factor(Reader &reader, const std::string &text) {
  const Expression value = parse_expression(text);
  if (depends_on_point(formula_of(reader, {value})))
    throw bad_input("what a spring has is of the whole of it: it does not depend on the place");
  return factor_of(reader, value);
}

void read_spring(Reader &reader, const CaseNode &node, Scene &scene) {
  const Form stretch = stretch_of(reader, node, scene);
  const CaseNode *stiffness = node.find("stiffness"), *pretension = node.find("pretension"),
                 *settled = node.find("settled");
  if (scene.components == 1) throw bad_input("a membrane has no springs");
  if (stiffness == nullptr && pretension == nullptr)
    throw bad_input("a spring has a stiffness, or a pretension, or both");
  if (settled != nullptr && (stiffness == nullptr || pretension == nullptr))
    throw bad_input("settled is where a spring with a stiffness has its pretension: give both");
  std::string force; // on the first boundary along the direction, beside the stiffness
  if (pretension != nullptr) force = "-(" + expression_in(reader, *pretension).text() + ")";
  if (stiffness != nullptr) {
    const Expression value = expression_in(reader, *stiffness);
    limit(reader, value, {0, 1e15}, scene);
    scene.a.push_back(exact_term(stretch, {force_factor(reader, value.text())}));
    if (settled != nullptr)
      force += " + (" + value.text() + ") * (" + expression_in(reader, *settled).text() + ")";
  }
  if (!force.empty()) scene.f.push_back(exact_term(stretch, {force_factor(reader, force)}));
}

} // namespace

void read_springs(Reader &reader, Scene &scene, Defects &defects) {
  for (const auto &[name, node] : section(reader, "springs").entries)
    defects.collect(node, [&, &value = node] { read_spring(reader, value, scene); });
}

} // namespace rbvi
