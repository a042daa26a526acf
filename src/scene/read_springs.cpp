#include "reader.hpp"

#include "rbvi/core/text.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// Their sum stretches the spring: a mean, less another one.
std::vector<Mean> means_of(const Reader &reader, const CaseNode &node, const Scene &scene) {
  Point direction{};
  direction[static_cast<std::size_t>(scene.dim - 1)] = 1;
  if (const CaseNode *given = node.find("direction")) {
    direction = vector_in(reader, *given);
    if (!(std::abs(norm(direction) - 1) <= 1e-6))
      throw bad_input("the direction is of the length " + short_number(norm(direction)) +
                      ": give one of length 1");
  }
  check_direction(scene, direction, "the force of a spring");
  const CaseNode *at = node.find("at"), *between = node.find("between");
  if ((at == nullptr) == (between == nullptr))
    throw bad_input("a spring is 'at' a boundary, or 'between: [one, other]'");
  const std::vector<std::string> names = names_in(at != nullptr ? *at : *between);
  if (names.size() != (at != nullptr ? 1U : 2U))
    throw bad_input(at != nullptr ? "a spring to the ground is at one boundary: give each its entry"
                                  : "a spring is between two boundaries: [one, other]");
  std::vector<Mean> means{{names.front(), direction, scene.axisymmetric}};
  if (between != nullptr) means.push_back({names.back(), -1.0 * direction, scene.axisymmetric});
  return means;
}

/// The factor of an expression in parameters alone, as far as the domain has it.
Factor force_factor(Reader &reader, const Scene &scene, const std::string &text) {
  const Expression value = share_of_domain(scene, parse_expression(text));
  if (depends_on_point(formula_of(reader, {value})))
    throw bad_input("what a spring has is of the whole of it: it does not depend on the place");
  return factor_of(reader, value);
}

Form form_of(const Spring &spring) {
  Form form;
  form.means = spring.means;
  return form;
}

void read_spring(Reader &reader, const CaseNode &node, Scene &scene) {
  if (scene.components == 1) throw bad_input("a membrane has no springs");
  const Spring spring = spring_in(reader, node, scene);
  if (spring.stiffness) {
    limit(reader, *spring.stiffness, {0, 1e15}, scene);
    scene.a.push_back(
        exact_term(form_of(spring), {force_factor(reader, scene, spring.stiffness->text())}));
  }
  if (spring.preload)
    scene.f.push_back(
        exact_term(form_of(spring), {force_factor(reader, scene, "-(" + *spring.preload + ")")}));
}

} // namespace

Spring spring_in(const Reader &reader, const CaseNode &node, const Scene &scene) {
  Spring spring{means_of(reader, node, scene), {}, {}};
  const CaseNode *stiffness = node.find("stiffness"), *pretension = node.find("pretension"),
                 *settled = node.find("settled");
  if (stiffness == nullptr && pretension == nullptr)
    throw bad_input("a spring has a stiffness, or a pretension, or both");
  if (settled != nullptr && (stiffness == nullptr || pretension == nullptr))
    throw bad_input("settled is where a spring with a stiffness has its pretension: give both");
  if (stiffness != nullptr) spring.stiffness = expression_in(reader, *stiffness);
  if (pretension != nullptr) spring.preload = expression_in(reader, *pretension).text();
  if (settled != nullptr)
    *spring.preload +=
        " - (" + spring.stiffness->text() + ") * (" + expression_in(reader, *settled).text() + ")";
  return spring;
}

void read_springs(Reader &reader, Scene &scene, Defects &defects) {
  for (const auto &[name, node] : section(reader, "springs").entries)
    defects.collect(node, [&, &value = node] { read_spring(reader, value, scene); });
}

} // namespace rbvi
