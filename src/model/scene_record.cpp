#include "rbvi/model/scene_record.hpp"

#include "rbvi/contact/registry.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/element/output_cells.hpp"

namespace rbvi {

namespace {

/// "a_0", "a_1", ...
std::string numbered(const std::string &name, std::size_t i) {
  return name + "_" + std::to_string(i);
}

/// Lists of the parts of a record write them, or read them, each part once.
struct RecordWriter {
  static constexpr bool reads = false;
  Record &record;

  bool has(const std::string &, bool there) const { return there; }
  void number(const std::string &name, double value) const { record.numbers[name] = {value}; }
  void integers(const std::string &name, const std::vector<int> &values) const {
    record.numbers[name] = std::vector<double>(values.begin(), values.end());
  }
  void text(const std::string &name, const std::string &value) const { record.texts[name] = value; }
  void texts(const std::string &name, const std::vector<std::string> &values) const {
    record.texts[name] = joined(values, ",");
  }
  template <class Function> void function(const std::string &name, const Function &value) const {
    record.parts[name] = value.record;
  }
  template <class List, class Visit>
  void items(const std::string &name, const List &list, Visit &&visit) const {
    for (std::size_t i = 0; i < list.size(); ++i)
      visit(RecordWriter{record.parts[numbered(name, i)]}, list[i]);
  }
};

struct RecordReader {
  static constexpr bool reads = true;
  Stored of;

  bool has(const std::string &name, bool) const {
    return of.record.parts.contains(name) || of.record.numbers.contains(name) ||
           of.record.texts.contains(name);
  }
  void number(const std::string &name, double &value) const { value = rbvi::number(of, name); }
  template <class Integer> void number(const std::string &name, Integer &value) const {
    value = static_cast<Integer>(integer(of, name));
  }
  void integers(const std::string &name, std::vector<int> &values) const {
    for (const double value : numbers(of, name))
      values.push_back(static_cast<int>(value));
  }
  void text(const std::string &name, std::string &value) const { value = rbvi::text(of, name); }
  void texts(const std::string &name, std::vector<std::string> &values) const {
    values = split(rbvi::text(of, name), ',');
  }
  template <class Signature> void function(const std::string &name, Named<Signature> &value) const {
    value = made<Signature>(part(of, name));
  }
  template <class List, class Visit>
  void items(const std::string &name, List &list, Visit &&visit) const {
    for (std::size_t i = 0; of.record.parts.contains(numbered(name, i)); ++i)
      visit(RecordReader{part(of, numbered(name, i))}, list.emplace_back());
  }
};

template <class Store> void name_record(const Store &store, const std::string &name) {
  if constexpr (!Store::reads) store.record.name = name;
}

template <class Store, class Of> void list_factor(const Store &store, Of &factor) {
  name_record(store, "factor");
  store.integers("parameters", factor.parameters);
  store.text("name", factor.name);
  store.function("value", factor.value);
}

/// theta of a term, the product of its factors; without it what else its values depend on.
template <class Store, class Of> void list_theta(const Store &store, Of &term) {
  name_record(store, term.theta ? "exact" : "mapped");
  if constexpr (Store::reads)
    if (store.of.record.name == "exact") term.theta.emplace();
  if (term.theta)
    store.items("factor", *term.theta,
                [](const Store &part, auto &factor) { list_factor(part, factor); });
  if (term.theta || !store.has("parameters", term.parameters.has_value())) return;
  if constexpr (Store::reads) term.parameters.emplace();
  store.integers("parameters", *term.parameters);
}

/// `with_kernel`: of an exact term, too.
template <class Store, class Of> void list_term(const Store &store, Of &term, bool with_kernel) {
  list_theta(store, term);
  if (!store.has("kernel", term.form.kernel && (!term.theta || with_kernel))) return;
  store.text("region", term.form.region);
  store.text("boundary", term.form.boundary);
  store.function("kernel", term.form.kernel);
}

template <class Store, class Of> void list_fixed(const Store &store, Of &boundary) {
  name_record(store, "fixed");
  store.integers("components", boundary.components);
  store.text("name", boundary.name);
  store.items("value", boundary.values, [](const Store &part, auto &value) {
    list_theta(part, value);
    part.function("value", value.value);
  });
}

template <class Store, class Of> void list_coordinates(const Store &store, Of &scene) {
  std::vector<int> known;
  for (const auto &[parameter, coordinate] : scene.coordinates)
    known.push_back(parameter);
  store.integers("coordinates", known);
  for (const int parameter : known) {
    if constexpr (Store::reads) scene.coordinates.try_emplace(parameter);
    auto &coordinate = scene.coordinates.at(parameter);
    store.function("of_" + std::to_string(parameter), coordinate.of);
    store.function("back_" + std::to_string(parameter), coordinate.back);
  }
}

template <class Store> void list_point(const Store &store, const std::string &name, auto &point) {
  for (std::size_t c = 0; c < 2; ++c)
    store.number(numbered(name, c), point[c]);
}

template <class Store, class Of> void list_units(const Store &store, Of &units) {
  if constexpr (Store::reads) {
    std::vector<int> powers;
    store.integers("units", powers);
    if (powers.size() != 4) throw bad_input("'units' is not four powers of ten");
    std::copy_n(powers.begin(), 4, units.emplace().begin());
  } else {
    store.integers("units", {units->begin(), units->end()});
  }
}

/// What an output has beside its name, its kind and where it is.
template <class Store, class Of> void list_output(const Store &store, Of &output) {
  int place = static_cast<int>(output.place);
  if (store.has("place", has_cells(output))) {
    store.number("place", place);
    list_point(store, "vector", output.vector);
  }
  if constexpr (Store::reads) output.place = static_cast<OutputForm::Place>(place);
  if (store.has("conditional", output.conditional)) store.number("conditional", output.conditional);
  const auto function_if = [&](const std::string &name, auto &function) {
    if (store.has(name, static_cast<bool>(function))) store.function(name, function);
  };
  function_if("values", output.values);
  function_if("stiffness", output.stiffness);
  function_if("preload", output.preload);
  store.items("mean", output.means, [](const Store &part, auto &mean) {
    name_record(part, "mean");
    part.text("boundary", mean.boundary);
    part.number("axisymmetric", mean.axisymmetric);
    list_point(part, "direction", mean.direction);
  });
}

template <class Store, class Of> void list_scene(const Store &store, Of &scene) {
  const auto function_if = [&](const std::string &name, auto &function) {
    if (store.has(name, static_cast<bool>(function))) store.function(name, function);
  };
  if (store.has("units", scene.units.has_value())) list_units(store, scene.units);
  store.number("dim", scene.dim);
  store.number("components", scene.components);
  store.number("degree", scene.degree);
  if (store.has("axisymmetric", scene.axisymmetric))
    store.number("axisymmetric", scene.axisymmetric);
  store.number("symmetric", scene.symmetric);
  store.number("skewed_by", scene.skewed_by);
  if (store.has("small", scene.small)) store.number("small", scene.small);
  store.items("mirror", scene.mirrors, [](const Store &part, auto &plane) {
    name_record(part, "mirror");
    part.number("component", plane.component);
    part.number("position", plane.position);
  });
  store.function("map", scene.map);
  function_if("motion", scene.motion);
  list_coordinates(store, scene);
  store.items("material", scene.materials, [](const Store &part, auto &material) {
    name_record(part, "material");
    part.texts("regions", material.regions);
    part.function("of_cell", material.of_cell);
    if (part.has("free_strain", static_cast<bool>(material.free_strain)))
      part.function("free_strain", material.free_strain);
  });
  function_if("check", scene.check_parameters);
  store.items("contact", scene.contacts, [](const Store &part, auto &recipe) {
    if constexpr (Store::reads)
      recipe = contact_in(part.of);
    else
      part.record = recipe.record;
    if (part.has("name", !recipe.name.empty())) part.text("name", recipe.name);
  });
  store.items("output", scene.outputs, [](const Store &part, auto &output) {
    name_record(part, "output");
    part.text("name", output.name);
    int kind = static_cast<int>(output.kind);
    part.number("kind", kind);
    if constexpr (Store::reads) output.kind = static_cast<OutputForm::Kind>(kind);
    part.texts("at", output.at);
    list_output(part, output);
  });
  // Loads of imposed values are made again from these values and the kernels of a; reactions and
  // the work of loads on a motion need the kernels, too.
  const bool imposes = imposes_values(scene);
  const bool work = scene.motion && !scene.f.empty();
  const bool kernels =
      imposes || work || std::ranges::any_of(scene.outputs, [](const OutputForm &output) {
        return output.kind == OutputForm::Kind::reaction;
      });
  const auto term = [&](const Store &part, auto &of) { list_term(part, of, kernels); };
  store.items("a", scene.a, term);
  store.items("f", scene.f, term);
  if (imposes || Store::reads)
    store.items("fixed", scene.fixed, [](const Store &part, auto &of) { list_fixed(part, of); });
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
  Scene own = scene;
  std::erase_if(own.f, [](const Term &term) { return term.of_imposed; });
  Record record{scene.name.empty() ? "scene" : scene.name};
  list_scene(RecordWriter{record}, own);
  return record;
}

Scene scene_in(const Stored &of) {
  Scene scene;
  scene.name = of.record.name;
  list_scene(RecordReader{of}, scene);
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
