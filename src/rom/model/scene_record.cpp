#include "rbvi/rom/model/scene_record.hpp"

#include "rbvi/contact/catalogue/registry.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/imposed.hpp"

namespace rbvi {

namespace {

/// "a_0", "a_1", ...
std::string numbered(const std::string &name, std::size_t i) {
  return name + "_" + std::to_string(i);
}

std::vector<double> as_numbers(const std::vector<int> &integers) {
  return {integers.begin(), integers.end()};
}

std::vector<int> as_integers(const std::vector<double> &numbers) {
  std::vector<int> integers;
  for (const double value : numbers)
    integers.push_back(static_cast<int>(value));
  return integers;
}

/// The parts "name_0", "name_1", ... of a list.
template <class List, class RecordOf>
void add_list(const std::string &name, const List &list, Record &record, RecordOf &&record_of) {
  for (std::size_t i = 0; i < list.size(); ++i)
    record.parts[numbered(name, i)] = record_of(list[i]);
}

template <class List, class MadeOf>
void read_list(const std::string &name, const Stored &of, List &list, MadeOf &&made_of) {
  for (std::size_t i = 0; of.record.parts.contains(numbered(name, i)); ++i)
    list.push_back(made_of(part(of, numbered(name, i))));
}

Record record_of(const Factor &factor) {
  Record record{"factor",
                1,
                {{"parameters", as_numbers(factor.parameters)}},
                {{"name", factor.name}},
                {{"value", factor.value.record}}};
  for (const auto &[parameter, coordinate] : factor.coordinates) {
    record.parts["of_" + std::to_string(parameter)] = coordinate.of.record;
    record.parts["back_" + std::to_string(parameter)] = coordinate.back.record;
  }
  return record;
}

Factor factor_in(const Stored &of) {
  Factor factor{text(of, "name"), made<Coefficient>(part(of, "value")),
                as_integers(numbers(of, "parameters"))};
  for (const int parameter : factor.parameters)
    if (const std::string own = std::to_string(parameter); of.record.parts.contains("of_" + own))
      factor.coordinates[parameter] = {made<NumberMap>(part(of, "of_" + own)),
                                       made<NumberMap>(part(of, "back_" + own))};
  return factor;
}

/// theta of a record, the product of its factors.
void add_factors(const std::vector<Factor> &factors, Record &record) {
  add_list("factor", factors, record, [](const Factor &f) { return record_of(f); });
}

std::vector<Factor> factors_in(const Stored &of) {
  std::vector<Factor> factors;
  read_list("factor", of, factors, factor_in);
  return factors;
}

std::optional<std::vector<int>> parameters_in(const Record &record) {
  if (!record.numbers.contains("parameters")) return std::nullopt;
  return as_integers(numbers(record, "parameters"));
}

/// `with_kernel`: of an exact term, too.
Record record_of(const Term &term, bool with_kernel) {
  Record record{term.theta ? "exact" : "mapped"};
  if (term.theta) add_factors(*term.theta, record);
  if (term.theta && !with_kernel) return record;
  record.texts = {{"region", term.form.region}, {"boundary", term.form.boundary}};
  if (term.parameters) record.numbers["parameters"] = as_numbers(*term.parameters);
  record.parts["kernel"] = term.form.kernel.record;
  return record;
}

Term term_in(const Stored &of) {
  Form form;
  if (of.record.parts.contains("kernel"))
    form = {text(of, "region"), made<Kernel>(part(of, "kernel")), text(of, "boundary")};
  if (of.record.name == "exact") return exact_term(std::move(form), factors_in(of));
  return mapped_term(std::move(form), parameters_in(of));
}

Record record_of(const ImposedTerm &value) {
  Record record{value.theta ? "exact" : "mapped"};
  if (value.theta) add_factors(*value.theta, record);
  if (value.parameters) record.numbers["parameters"] = as_numbers(*value.parameters);
  record.parts["value"] = value.value.record;
  return record;
}

ImposedTerm imposed_in(const Stored &of) {
  ImposedTerm value{made<PointMap>(part(of, "value"))};
  if (of.record.name == "exact")
    value.theta = factors_in(of);
  else
    value.parameters = parameters_in(of);
  return value;
}

Record record_of(const FixedBoundary &boundary) {
  Record record{
      "fixed", 1, {{"components", as_numbers(boundary.components)}}, {{"name", boundary.name}}};
  add_list("value", boundary.values, record, [](const ImposedTerm &v) { return record_of(v); });
  return record;
}

FixedBoundary fixed_in(const Stored &of) {
  FixedBoundary boundary{text(of, "name"), as_integers(numbers(of, "components"))};
  read_list("value", of, boundary.values, imposed_in);
  return boundary;
}

/// Every function that is there as a part of its own.
void add_functions(const Scene &scene, Record &record) {
  record.parts["map"] = scene.map.record;
  if (scene.motion) record.parts["motion"] = scene.motion.record;
  if (scene.material) record.parts["material"] = scene.material.record;
  if (scene.check_parameters) record.parts["check"] = scene.check_parameters.record;
}

std::string line(const std::vector<double> &numbers) {
  std::vector<std::string> words;
  for (const double value : numbers)
    words.push_back(shortest_number(value));
  return joined(words, " ");
}

void add_lines(const Record &record, const std::string &path,
               std::map<std::string, std::string> &lines) {
  lines[path] = record.name + " " + std::to_string(record.version);
  for (const auto &[name, values] : record.numbers)
    lines[path + ":" + name] = line(values);
  for (const auto &[name, value] : record.texts)
    lines[path + "=" + name] = value;
  for (const auto &[name, one] : record.parts)
    add_lines(one, path.empty() ? name : path + "." + name, lines);
}

} // namespace

Record record_of(const Scene &scene) {
  Record record{scene.name.empty() ? "scene" : scene.name,
                1,
                {{"dim", {double(scene.dim)}},
                 {"components", {double(scene.components)}},
                 {"degree", {double(scene.degree)}},
                 {"symmetric", {double(scene.symmetric)}},
                 {"skewed_by", {double(scene.skewed_by)}},
                 {"mirror_images", {scene.mirror_images}}}};
  add_functions(scene, record);
  add_list("contact", scene.contacts, record, [](const ContactRecipe &c) { return c.record; });
  // Loads of imposed values are made again from these values and the kernels of a.
  const bool imposes = imposes_values(scene);
  const auto of_term = [&](const Term &term) { return record_of(term, imposes); };
  add_list("a", scene.a, record, of_term);
  Sum own = scene.f;
  std::erase_if(own, [](const Term &term) { return term.of_imposed; });
  add_list("f", own, record, of_term);
  if (imposes)
    add_list("fixed", scene.fixed, record, [](const FixedBoundary &b) { return record_of(b); });
  return record;
}

Scene scene_in(const Stored &of) {
  Scene scene;
  scene.name = of.record.name;
  scene.dim = integer(of, "dim");
  scene.components = integer(of, "components");
  scene.degree = integer(of, "degree");
  scene.symmetric = integer(of, "symmetric") != 0;
  scene.skewed_by = integer(of, "skewed_by");
  scene.mirror_images = number(of, "mirror_images");
  scene.map = made<PointMap>(part(of, "map"));
  if (of.record.parts.contains("motion")) scene.motion = made<PointMap>(part(of, "motion"));
  if (of.record.parts.contains("material")) scene.material = made<Material>(part(of, "material"));
  if (of.record.parts.contains("check")) scene.check_parameters = made<Check>(part(of, "check"));
  read_list("contact", of, scene.contacts, contact_in);
  read_list("a", of, scene.a, term_in);
  read_list("f", of, scene.f, term_in);
  read_list("fixed", of, scene.fixed, fixed_in);
  return scene;
}

std::map<std::string, std::string> lines_of(const Record &record) {
  std::map<std::string, std::string> lines;
  add_lines(record, "", lines);
  return lines;
}

Record record_in(const std::map<std::string, std::string> &lines) {
  Record record;
  for (const auto &[path, value] : lines) {
    const std::size_t end = std::min(path.find_first_of(":="), path.size());
    Record *part = &record;
    for (const std::string &name : split(path.substr(0, end), '.'))
      part = &part->parts[name];
    if (end == path.size()) {
      const std::size_t space = value.rfind(' ');
      if (space == std::string::npos) throw bad_input("'" + path + "' has no version");
      part->name = value.substr(0, space);
      part->version = static_cast<int>(parse_number(value.substr(space + 1), "version of " + path));
    } else if (path[end] == '=') {
      part->texts[path.substr(end + 1)] = value;
    } else {
      std::vector<double> &numbers = part->numbers[path.substr(end + 1)];
      for (const std::string &word : split(value, ' '))
        numbers.push_back(parse_number(word, path));
    }
  }
  return record;
}

} // namespace rbvi
