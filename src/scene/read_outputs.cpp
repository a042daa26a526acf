#include "reader.hpp"

#include "rbvi/contact/named_outputs.hpp"
#include "rbvi/core/outputs.hpp"

#include <algorithm>

namespace rbvi {

namespace {

using Kind = OutputForm::Kind;

const std::vector<std::pair<std::string, Kind>> kinds{{"integral", Kind::integral},
                                                      {"mean", Kind::mean},
                                                      {"max", Kind::max},
                                                      {"min", Kind::min},
                                                      {"measure", Kind::measure}};

/// Throws bad_input for a name that a table has already.
void check_name(const std::string &name, const Scene &scene) {
  const auto has = [&](const auto &list, auto member) {
    return std::ranges::find(list, name, member) != list.end();
  };
  if (is_table_column(name) || has(scene.parameters.all, &Parameter::name))
    throw bad_input("tables have a column '" + name + "' already: give the output another name");
}

/// Throws bad_input where a parameter or a let is called like a field.
void check_fields(const Reader &reader, const Expression &value) {
  for (const std::string &name : value.free_names()) {
    if (std::ranges::find(output_fields(), name) == output_fields().end()) continue;
    if (std::ranges::find(reader.parameters, name) != reader.parameters.end() ||
        std::ranges::find(reader.lets, name, &Let::name) != reader.lets.end())
      throw bad_input("in outputs '" + name +
                      "' is the field of that name: call the parameter "
                      "otherwise");
  }
}

OutputForm output_in(Reader &reader, const std::string &name, const CaseNode &node,
                     const Scene &scene) {
  check_name(name, scene);
  OutputForm form{name};
  const CaseNode *value = nullptr;
  for (const auto &[key, kind] : kinds) {
    const CaseNode *found = node.find(key);
    if (found == nullptr) continue;
    if (value != nullptr) throw bad_input("an output is one of integral, mean, max, min, measure");
    value = found;
    form.kind = kind;
  }
  if (value == nullptr)
    throw bad_input("an output is an integral, a mean, a max or a min of an expression, or the "
                    "measure of a condition");
  const CaseNode *where = node.find("where");
  const Expression one = parse_expression("1"), of = expression_in(reader, *value);
  const bool measures = form.kind == Kind::measure;
  if (measures && where != nullptr)
    throw bad_input("a measure is that of its condition: write 'A and B' in place of 'where'");
  for (const CaseNode *given : {value, where})
    if (given != nullptr) check_fields(reader, expression_in(reader, *given));
  form.values = field_values_of(
      formula_of(reader, {measures ? one : of, measures           ? of
                                               : where != nullptr ? expression_in(reader, *where)
                                                                  : one}));
  if (const CaseNode *at = node.find("at"))
    form.at = names_in(*at);
  else
    for (std::size_t i = 0; i < scene.contacts.size(); ++i)
      form.at.push_back(contact_name(scene, i));
  return form;
}

} // namespace

void read_outputs(Reader &reader, Scene &scene, Defects &defects) {
  for (const auto &[name, node] : section(reader, "outputs").entries)
    defects.collect(node, [&, &own = name, &value = node] {
      scene.outputs.push_back(output_in(reader, own, value, scene));
      check_outputs(scene);
    });
}

} // namespace rbvi
