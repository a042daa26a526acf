#include "rbvi/rom/model/scene_record.hpp"

#include "rbvi/contact/catalogue/kinds.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

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

Factor factor_in(const Record &record) {
  Factor factor{text(record, "name"), made<Coefficient>(part(record, "value")),
                as_integers(numbers(record, "parameters"))};
  for (const int parameter : factor.parameters)
    if (const std::string own = std::to_string(parameter); record.parts.contains("of_" + own))
      factor.coordinates[parameter] = {made<NumberMap>(part(record, "of_" + own)),
                                       made<NumberMap>(part(record, "back_" + own))};
  return factor;
}

Record record_of(const Term &term) {
  Record record{term.theta ? "exact" : "mapped"};
  if (term.theta) {
    for (std::size_t i = 0; i < term.theta->size(); ++i)
      record.parts[numbered("factor", i)] = record_of((*term.theta)[i]);
    return record;
  }
  record.texts = {{"region", term.form.region}, {"boundary", term.form.boundary}};
  if (term.parameters) record.numbers["parameters"] = as_numbers(*term.parameters);
  record.parts["kernel"] = term.form.kernel.record;
  return record;
}

Term term_in(const Record &record) {
  if (record.name == "exact") {
    std::vector<Factor> factors;
    for (std::size_t i = 0; record.parts.contains(numbered("factor", i)); ++i)
      factors.push_back(factor_in(part(record, numbered("factor", i))));
    return exact_term({}, std::move(factors));
  }
  Form form{text(record, "region"), made<Kernel>(part(record, "kernel")), text(record, "boundary")};
  if (!record.numbers.contains("parameters")) return mapped_term(std::move(form));
  return mapped_term(std::move(form), as_integers(numbers(record, "parameters")));
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
                 {"mirror_images", {scene.mirror_images}}}};
  add_functions(scene, record);
  for (std::size_t i = 0; i < scene.contacts.size(); ++i)
    record.parts[numbered("contact", i)] = scene.contacts[i].record;
  for (std::size_t i = 0; i < scene.a.size(); ++i)
    record.parts[numbered("a", i)] = record_of(scene.a[i]);
  for (std::size_t i = 0; i < scene.f.size(); ++i)
    record.parts[numbered("f", i)] = record_of(scene.f[i]);
  return record;
}

Scene scene_in(const Record &record) {
  Scene scene;
  scene.name = record.name;
  scene.dim = integer(record, "dim");
  scene.components = integer(record, "components");
  scene.degree = integer(record, "degree");
  scene.symmetric = integer(record, "symmetric") != 0;
  scene.mirror_images = number(record, "mirror_images");
  scene.map = made<PointMap>(part(record, "map"));
  if (record.parts.contains("motion")) scene.motion = made<PointMap>(part(record, "motion"));
  if (record.parts.contains("material")) scene.material = made<Material>(part(record, "material"));
  if (record.parts.contains("check")) scene.check_parameters = made<Check>(part(record, "check"));
  for (std::size_t i = 0; record.parts.contains(numbered("contact", i)); ++i)
    scene.contacts.push_back(contact_in(part(record, numbered("contact", i))));
  for (std::size_t i = 0; record.parts.contains(numbered("a", i)); ++i)
    scene.a.push_back(term_in(part(record, numbered("a", i))));
  for (std::size_t i = 0; record.parts.contains(numbered("f", i)); ++i)
    scene.f.push_back(term_in(part(record, numbered("f", i))));
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
