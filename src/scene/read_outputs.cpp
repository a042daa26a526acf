#include "dimensions.hpp"

#include "rbvi/core/output_units.hpp"
#include "rbvi/core/outputs.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

using Kind = OutputForm::Kind;

using Place = OutputForm::Place;

const std::vector<std::pair<std::string, Kind>> kinds{
    {"integral", Kind::integral}, {"mean", Kind::mean},       {"max", Kind::max},
    {"min", Kind::min},           {"measure", Kind::measure}, {"value", Kind::mean},
    {"reaction", Kind::reaction}, {"spring", Kind::spring},   {"moment", Kind::moment}};

/// Throws bad_input for a name that a table has already.
void check_name(const std::string &name, const Scene &scene) {
  std::vector<std::string> columns;
  for (const Parameter &parameter : scene.parameters.all)
    columns.push_back(parameter.name);
  for (const OutputForm &other : scene.outputs)
    columns.insert(columns.end(), {other.name, other.name + "_error"});
  const auto has = [&](const std::string &column) {
    return is_table_column(column) || std::ranges::find(columns, column) != columns.end();
  };
  if (has(name) || has(name + "_error"))
    throw bad_input("tables have a column '" + name + "' already: give the output another name");
}

std::string contact_names(const Scene &scene) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.contacts.size(); ++i)
    names.push_back(contact_name(scene, i));
  return joined(names);
}

/// Whether there is a field where an output is.
bool is_there(const std::string &name, Place place, const Scene &scene) {
  const bool membrane = scene.components == 1;
  const std::vector<std::string> of_solids{"z", "uz", "nz", "sigma_yz", "sigma_xz"};
  if (scene.dim == 2 && std::ranges::find(of_solids, name) != of_solids.end()) return false;
  const auto is_one_of = [&](std::size_t first, std::size_t last) {
    const auto begin = output_fields().begin();
    const auto at = static_cast<std::size_t>(std::ranges::find(output_fields(), name) - begin);
    return at >= first && at <= last;
  };
  if (is_one_of(field::tangential, field::slip) || is_one_of(field::stick, field::stick))
    return place == Place::contact && !membrane;
  if (is_one_of(field::pressure, field::gap) || is_one_of(field::contact, field::contact))
    return place == Place::contact;
  if (is_one_of(field::nx, field::nz)) return place == Place::boundary;
  if (is_one_of(field::slope_x, field::slope_y)) return membrane && place != Place::contact;
  if (is_one_of(field::sigma_xx, field::strain_energy)) return place != Place::contact && !membrane;
  return is_one_of(field::u, field::u) ? membrane : is_one_of(field::x, field::z) || !membrane;
}

Error is_a_field(const std::string &name) {
  return bad_input("in outputs '" + name +
                   "' is the field of that name: call the parameter otherwise");
}

/// Throws bad_input where a parameter is called like a field, and outputs name fields.
void check_names(const Reader &reader) {
  const auto names_fields = [](const auto &output) {
    const auto &[name, node] = output;
    return std::ranges::any_of(kinds, [&](const auto &kind) {
      return kind.second != Kind::reaction && kind.second != Kind::spring &&
             kind.second != Kind::moment && node.find(kind.first) != nullptr;
    });
  };
  if (std::ranges::none_of(section(reader, "outputs").entries, names_fields)) return;
  for (const std::string &name : output_fields())
    if (std::ranges::find(reader.parameters, name) != reader.parameters.end())
      throw is_a_field(name);
}

/// Throws bad_input for a field that is not there, and where a let is called like one.
void check_fields(const Reader &reader, const Scene &scene, const OutputForm &form,
                  const Expression &value) {
  for (const std::string &name : value.free_names()) {
    if (std::ranges::find(output_fields(), name) == output_fields().end()) continue;
    if (!is_there(name, form.place, scene))
      throw bad_input(
          "there is no '" + name + "' " +
          (form.at.empty() ? "there" : "at '" + joined(form.at, "', '") + "'") +
          ": pressure, gap, tangential, slip, contact and stick are over contacts (" +
          contact_names(scene) +
          "), nx and ny over boundaries, stresses and "
          "strain_energy over boundaries, regions and at points of elastic bodies, slope_x and "
          "slope_y likewise of a membrane, which has no tangential, slip and stick; u is that of a "
          "membrane, ux and uy of others; z, uz, nz, sigma_yz and sigma_xz are of solids");
    if (std::ranges::find(reader.lets, name, &Let::name) != reader.lets.end())
      throw is_a_field(name);
  }
}

/// The one key that says what the output is.
std::string kind_of(const CaseNode &node) {
  std::vector<std::string> names, found;
  for (const auto &[key, kind] : kinds) {
    names.push_back(key);
    if (node.find(key) != nullptr) found.push_back(key);
  }
  if (found.size() != 1)
    throw bad_input("an output is one of " + joined(names) + ": it has " +
                    (found.empty() ? "none" : joined(found, " and ")));
  return found.front();
}

/// Contacts, boundaries, regions or a point.
void put_place(const Reader &reader, const CaseNode &node, const Scene &scene, OutputForm &form) {
  const CaseNode *at = node.find("at"), *in = node.find("in"), *point = node.find("point");
  if (at != nullptr && (in != nullptr || point != nullptr))
    throw bad_input("an output has one place: 'at' contacts or boundaries, 'in' regions, or a "
                    "'point', of a region with 'in'");
  if ((point != nullptr) != (node.find("value") != nullptr))
    throw bad_input("a value is that at a point: {value: EXPRESSION, point: [x, y]}");
  if (in != nullptr) {
    form.at = names_in(*in);
    if (std::ranges::find(form.at, std::string("all")) != form.at.end()) form.at.clear();
  }
  if (point != nullptr) {
    form.place = Place::point;
    form.vector = vector_in(reader, *point);
  } else if (in != nullptr) {
    form.place = Place::region;
  } else if (at == nullptr) {
    for (std::size_t i = 0; i < scene.contacts.size(); ++i)
      form.at.push_back(contact_name(scene, i));
  } else {
    form.at = names_in(*at);
    if (!is_over_contacts(reader, node)) form.place = Place::boundary;
  }
}

/// Whether it names coordinates or normals, which the map moves over the cells.
bool names_a_place(const Expression &value) {
  return std::ranges::any_of(value.free_names(), [](const std::string &name) {
    return name == "x" || name == "y" || name == "z" || name == "nx" || name == "ny" ||
           name == "nz";
  });
}

/// A value in the unit of an output, of which one is `size` of the case's.
Expression in_unit(const Expression &value, double size) {
  if (size == 1) return value;
  return parse_expression("(" + value.text() + ") / " + shortest_number(size));
}

void put_values(Reader &reader, const CaseNode &node, const CaseNode &value, double size,
                const Scene &scene, OutputForm &form) {
  const CaseNode *where = node.find("where");
  const Expression one = parse_expression("1"), of = expression_in(reader, value);
  const bool measures = form.kind == Kind::measure;
  if (measures && where != nullptr)
    throw bad_input("a measure is that of its condition: write 'A and B' in place of 'where'");
  for (const CaseNode *given : {&value, where})
    if (given != nullptr) check_fields(reader, scene, form, expression_in(reader, *given));
  form.conditional = measures || where != nullptr;
  const Formula formula = formula_of(reader, {in_unit(measures ? one : of, size),
                                              measures           ? of
                                              : where != nullptr ? expression_in(reader, *where)
                                                                 : one});
  form.values = field_values_of(formula);
  form.moved_by = dependence_of(formula);
  for (const CaseNode *given : {&value, where})
    if (given != nullptr && names_a_place(expanded(expression_in(reader, *given), reader.lets))) {
      const std::vector<int> of_map = dependence_of_map(reader);
      form.moved_by.insert(form.moved_by.end(), of_map.begin(), of_map.end());
    }
}

void put_reaction(const Reader &reader, const CaseNode &node, const Scene &scene,
                  OutputForm &form) {
  if (node.find("at") == nullptr || node.find("in") != nullptr || node.find("where") != nullptr)
    throw bad_input("a reaction is that of boundaries, whole: {reaction: [0, 1], at: BOUNDARY}");
  form.vector = vector_in(reader, entry(node, "reaction"));
  if (!(std::abs(norm(form.vector) - 1) <= 1e-6))
    throw bad_input("the direction of a reaction has the length 1");
  check_direction(scene, form.vector, "a reaction");
  form.place = Place::boundary;
  form.at = names_in(entry(node, "at"));
}

void put_spring(Reader &reader, const CaseNode &node, double size, const Scene &scene,
                OutputForm &form) {
  for (const char *other : {"at", "in", "point", "where"})
    if (node.find(other) != nullptr)
      throw bad_input("the force of a spring is that of the whole spring: {spring: NAME}");
  const std::string name = entry(node, "spring").value;
  const CaseNode &springs = section(reader, "springs");
  if (springs.find(name) == nullptr) throw bad_input("there is no spring '" + name + "'");
  const Spring spring = spring_in(reader, *springs.find(name), scene);
  form.place = Place::boundary;
  form.means = spring.means;
  const auto coefficient = [&](const std::string &text) {
    return coefficient_of(formula_of(reader, {in_unit(parse_expression(text), size)}));
  };
  if (spring.stiffness) form.stiffness = coefficient(spring.stiffness->text());
  if (spring.preload) form.preload = coefficient(*spring.preload);
}

/// Throws bad_input where contact has no moment of points, or where that of the image cancels it.
void check_moment(const Scene &scene, const OutputForm &form,
                  const std::vector<Expression> &about) {
  if (form.place != Place::contact || form.conditional)
    throw bad_input("a moment is that of contacts, whole: {moment: z, about: [0, 0], at: CONTACT}");
  if (scene.axisymmetric || scene.components == 1)
    throw bad_input("contact of an axisymmetric body or of a membrane has no moment: that of a "
                    "turned body cancels around its axis");
  for (std::size_t i = 0; i < scene.contacts.size(); ++i)
    if ((scene.contacts[i].follows_state || !has_multipliers(scene)) &&
        std::ranges::find(form.at, contact_name(scene, i)) != form.at.end())
      throw bad_input("a moment is that of contact by multipliers with small kinematics: integrate "
                      "pressure and its arm");
  for (const auto &[component, position] : scene.mirrors)
    if (const auto c = static_cast<std::size_t>(component);
        form.vector[c] == 0 && about[c].constant() == position)
      throw bad_input("a moment about a point of the plane of symmetry cancels that of the mirror "
                      "image, but for that about the normal of the plane: of the whole body there "
                      "is none");
}

/// {moment: z, about: [x, y], at: CONTACT, of: friction}
void put_moment(Reader &reader, const CaseNode &node, const Scene &scene, OutputForm &form) {
  const std::vector<std::string> axes =
      scene.dim == 3 ? std::vector<std::string>{"x", "y", "z"} : std::vector<std::string>{"z"};
  const std::string axis = choice_or(node, "moment", "z", axes);
  form.vector[static_cast<std::size_t>(axis.front() - 'x')] = 1;
  form.of_friction = choice_or(node, "of", "contact", {"contact", "friction"}) == "friction";
  const std::vector<Expression> about = components_in(reader, entry(node, "about"));
  if (std::ssize(about) != scene.dim)
    throw bad_input(scene.dim == 3 ? "a moment is about [x, y, z]" : "a moment is about [x, y]");
  for (const Expression &x : about)
    form.about.push_back(coefficient_of(formula_of(reader, {x})));
  put_place(reader, node, scene, form);
  form.conditional = node.find("where") != nullptr;
  check_moment(scene, form, about);
}

/// Over what a membrane is, the region of an obstacle as any other.
bool is_over_cells(const OutputForm &form, const Scene &scene) {
  return form.place == Place::region || (form.place == Place::contact && scene.components == 1);
}

/// Nothing where it is not known. Of plane problems what is integrated is that of a unit of
/// thickness.
std::optional<Dimension> dimension_of_output(const Reader &reader, const CaseNode &node,
                                             const Scene &scene, const OutputForm &form) {
  if (!reader.units) return {};
  if (form.kind == Kind::reaction || form.kind == Kind::spring) return size_of(scene, Size::force);
  if (form.kind == Kind::moment) {
    Dimension moment = size_of(scene, Size::force);
    ++moment[0];
    return moment;
  }
  const bool whole = form.kind == Kind::integral || form.kind == Kind::measure;
  std::optional<Dimension> dimension = Dimension{};
  if (form.kind != Kind::measure) dimension = Dimensions(reader).of(entry(node, kind_of(node)));
  if (dimension && whole)
    (*dimension)[0] += scene.dim - (is_over_cells(form, scene) ? 0 : 1) + scene.axisymmetric;
  return dimension;
}

OutputForm output_in(Reader &reader, const std::string &name, const CaseNode &node,
                     const Scene &scene) {
  check_name(name, scene);
  const std::string kind = kind_of(node);
  if (kind != "moment" && (node.find("about") != nullptr || node.find("of") != nullptr))
    throw bad_input("'about' and 'of' are those of a moment: {moment: z, about: [0, 0]}");
  OutputForm form{name};
  form.kind = std::ranges::find(kinds, kind, &std::pair<std::string, Kind>::first)->second;
  const CaseNode *unit = node.find("unit");
  const double size = unit == nullptr ? 1 : size_of(reader, unit->value);
  if (form.kind == Kind::reaction) {
    put_reaction(reader, node, scene, form);
  } else if (form.kind == Kind::spring) {
    put_spring(reader, node, size, scene, form);
  } else if (form.kind == Kind::moment) {
    put_moment(reader, node, scene, form);
  } else {
    put_place(reader, node, scene, form);
    put_values(reader, node, entry(node, kind), size, scene, form);
  }
  if (form.kind == Kind::reaction || form.kind == Kind::moment)
    form.vector = (1 / size) * form.vector;
  if (const CaseNode *says = node.find("says")) form.says = says->value;
  const std::optional<Dimension> dimension = dimension_of_output(reader, node, scene, form);
  if (unit != nullptr) {
    form.unit = unit->value;
    if (dimension) check_dimension({size, dimension_of(form.unit), true}, *dimension, form.unit);
  } else if (dimension) {
    form.unit = unit_in(*reader.units, *dimension);
  }
  return form;
}

} // namespace

bool is_over_contacts(const Reader &reader, const CaseNode &output) {
  if (output.find("reaction") != nullptr) return false;
  const CaseNode *at = output.find("at");
  if (at == nullptr || at->is_table()) return true;
  const std::vector<std::string> names = names_in(*at);
  const auto is_contact = [&](const std::string &name) {
    return section(reader, "contact").find(name) != nullptr;
  };
  return std::ranges::all_of(names, is_contact);
}

void read_outputs(Reader &reader, Scene &scene, Defects &defects) {
  const CaseNode &outputs = section(reader, "outputs");
  bool named = false;
  defects.collect(outputs, [&] {
    check_names(reader);
    named = true;
  });
  if (!named) return;
  for (const auto &[name, node] : outputs.entries)
    defects.collect(node, [&, &own = name, &value = node] {
      scene.outputs.push_back(output_in(reader, own, value, scene));
    });
}

} // namespace rbvi
