// model.h5: its data sets are listed in LAYOUT.md beside this file.
#include "model_fields.hpp"
#include "nitsche_part.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/rom/model/packed.hpp"
#include "rbvi/rom/model/scene_record.hpp"
#include "rbvi/rom/model/scene_text.hpp"
#include "stored_operators.hpp"

#include <algorithm>
#include <array>

namespace rbvi {

namespace {

template <class Value>
void keys_and_values(const std::map<std::string, Value> &map, std::vector<std::string> &keys,
                     std::vector<Value> &values) {
  for (const auto &[key, value] : map) {
    keys.push_back(key);
    values.push_back(value);
  }
}

void write_texts(H5Writer &file, const std::string &group,
                 const std::map<std::string, std::string> &map) {
  std::vector<std::string> keys, values;
  keys_and_values(map, keys, values);
  file.write(group + "/names", keys);
  file.write(group + "/values", values);
}

template <class Value>
std::map<std::string, Value> zip(const std::string &what, const std::vector<std::string> &keys,
                                 const std::vector<Value> &values) {
  if (keys.size() != values.size()) throw bad_input(what + ": names without values");
  std::map<std::string, Value> map;
  for (std::size_t i = 0; i < keys.size(); ++i)
    map[keys[i]] = values[i];
  return map;
}

std::map<std::string, std::string> read_texts(const H5Reader &file, const std::string &group) {
  return zip(group, file.strings(group + "/names"), file.strings(group + "/values"));
}

void write_parameters(H5Writer &file, const ParameterSpace &space) {
  std::vector<std::string> names, units;
  std::vector<double> lower, upper, value, valid_lower, valid_upper;
  for (const Parameter &p : space.all) {
    names.push_back(p.name);
    units.push_back(p.unit);
    lower.push_back(p.lower);
    upper.push_back(p.upper);
    value.push_back(p.value);
    valid_lower.push_back(p.valid.lower);
    valid_upper.push_back(p.valid.upper);
  }
  file.write("parameters/names", names);
  file.write("parameters/units", units);
  file.write("parameters/lower", lower);
  file.write("parameters/upper", upper);
  file.write("parameters/value", value);
  file.write("parameters/valid_lower", valid_lower);
  file.write("parameters/valid_upper", valid_upper);
  file.write("parameters/free", space.free);
}

ParameterSpace read_parameters(const H5Reader &file) {
  const std::vector<std::string> names = file.strings("parameters/names");
  const std::vector<std::string> units = file.strings("parameters/units");
  const std::vector<double> lower = file.doubles("parameters/lower");
  const std::vector<double> upper = file.doubles("parameters/upper");
  const std::vector<double> value = file.doubles("parameters/value");
  const std::vector<double> valid_lower = file.doubles("parameters/valid_lower");
  const std::vector<double> valid_upper = file.doubles("parameters/valid_upper");
  const std::size_t count = names.size();
  if (units.size() != count ||
      std::ranges::any_of(std::array{lower, upper, value, valid_lower, valid_upper},
                          [&](const auto &column) { return column.size() != count; }))
    throw bad_input("the parameters are incomplete");
  ParameterSpace space;
  for (std::size_t i = 0; i < count; ++i)
    space.all.push_back(
        {names[i], units[i], lower[i], upper[i], value[i], {valid_lower[i], valid_upper[i]}});
  space.free = file.ints("parameters/free");
  for (const int i : space.free)
    if (i < 0 || static_cast<std::size_t>(i) >= count)
      throw bad_input("a free parameter does not exist");
  return space;
}

void write_validation(H5Writer &file, const std::string &name, const ValidationErrors &errors) {
  file.write(name,
             std::vector<double>{static_cast<double>(errors.count), errors.u_mean, errors.u_max,
                                 errors.lambda_mean, errors.lambda_max, errors.tangential_mean,
                                 errors.tangential_max, static_cast<double>(errors.unanswered)});
  std::vector<std::string> names;
  Matrix values(static_cast<Index>(errors.outputs.size()), 6);
  for (const OutputError &e : errors.outputs) {
    values.row(static_cast<Index>(names.size())) << e.mean, e.max, e.mean_of_range, e.max_of_range,
        e.mean_of_value, e.max_of_value;
    names.push_back(e.name);
  }
  file.write(name + "_outputs/names", names);
  file.write(name + "_outputs/values", values);
}

ValidationErrors read_validation(const H5Reader &file, const std::string &name) {
  const std::vector<double> values = file.doubles(name);
  if (values.size() != 8) throw bad_input(name + " has not 8 entries");
  ValidationErrors errors{static_cast<int>(values[0]),
                          values[1],
                          values[2],
                          values[3],
                          values[4],
                          values[5],
                          values[6],
                          {},
                          static_cast<int>(values[7])};
  const std::vector<std::string> names = file.strings(name + "_outputs/names");
  const Matrix rows = file.matrix(name + "_outputs/values");
  if (rows.rows() != static_cast<Index>(names.size()) || (rows.size() > 0 && rows.cols() != 6))
    throw bad_input(name + "_outputs: names without six values each");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto row = rows.row(static_cast<Index>(i));
    errors.outputs.push_back({names[i], row[0], row[1], row[2], row[3], row[4], row[5]});
  }
  return errors;
}

constexpr std::array worst_of_check{std::pair{"self_check/residual", &SelfCheck::residual},
                                    std::pair{"self_check/penetration", &SelfCheck::penetration},
                                    std::pair{"self_check/friction", &SelfCheck::friction}};

void write_self_check(H5Writer &file, const SelfCheck &check) {
  file.write("self_check/counts",
             std::vector<int>{check.queries, check.unanswered, check.at_boundary});
  file.write("self_check/scale", check.scale);
  file.write("self_check/unanswered_at", check.unanswered_at);
  file.write("self_check/reason", check.reason);
  for (const auto &[name, worst] : worst_of_check) {
    file.write(name, (check.*worst).value);
    file.write(std::string(name) + "_at", (check.*worst).at);
  }
}

SelfCheck read_self_check(const H5Reader &file) {
  SelfCheck check;
  const std::vector<int> counts = file.ints("self_check/counts");
  if (counts.size() != 3) throw bad_input("self_check/counts has not 3 entries");
  check.queries = counts[0];
  check.unanswered = counts[1];
  check.at_boundary = counts[2];
  check.scale = file.number("self_check/scale");
  check.unanswered_at = Mu(file.doubles("self_check/unanswered_at"));
  check.reason = file.string("self_check/reason");
  for (const auto &[name, worst] : worst_of_check)
    check.*worst = {file.number(name), Mu(file.doubles(std::string(name) + "_at"))};
  return check;
}

void write_history(H5Writer &file, const ReducedModel &model) {
  std::vector<std::string> names, stages;
  std::vector<std::vector<double>> histories;
  std::vector<double> seconds;
  keys_and_values(model.histories, names, histories);
  keys_and_values(model.stage_seconds, stages, seconds);
  file.write("histories/names", names);
  for (std::size_t i = 0; i < names.size(); ++i)
    file.write("histories/values/" + names[i], histories[i]);
  file.write("stages/names", stages);
  file.write("stages/seconds", seconds);
  file.write("training/mu", model.trained_mu);
  file.write("training/failed", model.failed_mu);
  write_validation(file, "validation/enriched", model.validation_enriched);
  write_validation(file, "validation/decorrelated", model.validation_decorrelated);
  file.write("validation/mu", model.validated_mu);
  write_self_check(file, model.self_check);
}

void read_history(const H5Reader &file, ReducedModel &model) {
  for (const std::string &name : file.strings("histories/names"))
    model.histories[name] = file.doubles("histories/values/" + name);
  model.stage_seconds = zip("stages", file.strings("stages/names"), file.doubles("stages/seconds"));
  model.trained_mu = file.matrix("training/mu");
  model.failed_mu = file.matrix("training/failed");
  model.validation_enriched = read_validation(file, "validation/enriched");
  model.validation_decorrelated = read_validation(file, "validation/decorrelated");
  model.validated_mu = file.matrix("validation/mu");
  model.self_check = read_self_check(file);
}

void write_law(H5Writer &file, const std::optional<NodalLaw> &law) {
  file.write("law/normal", law ? law->normal : 0);
  if (!law) return;
  std::vector<double> axes;
  for (const ChebyshevAxis &axis : law->condensed.axes)
    axes.insert(axes.end(), {static_cast<double>(axis.parameter), axis.lower, axis.upper,
                             static_cast<double>(axis.points)});
  file.write("law/axes", axes);
  file.write("law/error", law->condensed.error);
  file.write("law/shape", law->condensed.shape);
  const std::vector<int> blocks = diagonal_blocks(law->condensed.terms);
  file.write("law/blocks", blocks);
  file.write("law/terms", pack_blocks(law->condensed.terms, blocks));
  file.write("law/dofs", law->condensed.dofs);
  const TermsApart &apart = law->apart;
  file.write("law/apart", std::vector<double>{static_cast<double>(apart.normal), apart.normal_error,
                                              apart.tangential_error});
  file.write("law/reduction", static_cast<int>(law->reduction));
  file.write("law/mended", law->mended ? 1 : 0);
  file.write("law/basis/normal", law->basis.normal);
  file.write("law/basis/tangential", law->basis.tangential);
  file.write("law/basis/nodes", law->basis.nodes);
  file.write("law/starts", law->starts);
  file.write("law/starts_mu", law->starts_mu);
  file.write("law/states", law->states);
}

std::optional<NodalLaw> read_law(const H5Reader &file) {
  NodalLaw law;
  law.normal = file.integer("law/normal");
  if (law.normal == 0) return std::nullopt;
  const std::vector<double> axes = file.doubles("law/axes");
  if (axes.size() % 4 != 0) throw bad_input("law/axes are not groups of four");
  for (std::size_t i = 0; i < axes.size(); i += 4)
    law.condensed.axes.push_back(
        {static_cast<int>(axes[i]), axes[i + 1], axes[i + 2], static_cast<int>(axes[i + 3])});
  law.condensed.error = file.number("law/error");
  law.condensed.shape = file.matrix("law/shape");
  law.condensed.terms = unpacked_blocks(file.matrix("law/terms"), file.ints("law/blocks"));
  law.condensed.dofs = file.ints("law/dofs");
  const std::vector<double> apart = file.doubles("law/apart");
  if (apart.size() != 3) throw bad_input("law/apart has not 3 entries");
  law.apart = {static_cast<int>(apart[0]), apart[1], apart[2]};
  law.reduction = static_cast<MultiplierReduction>(file.integer("law/reduction"));
  law.mended = file.integer("law/mended") != 0;
  law.basis.normal = file.matrix("law/basis/normal");
  law.basis.tangential = file.matrix("law/basis/tangential");
  law.basis.nodes = file.ints("law/basis/nodes");
  law.starts = file.matrix("law/starts");
  law.starts_mu = file.matrix("law/starts_mu");
  law.states = file.matrix("law/states");
  return law;
}

void write_contact(H5Writer &file, const ReducedModel &model) {
  write_interfaces(file, model.interfaces);
  file.write("contact/dual_basis", model.dual_basis);
  file.write("contact/dofs", static_cast<int>(model.contact_dofs()));
  file.write("contact/trace", model.contact_trace);
  file.write("contact/trace_dofs", model.trace_dofs);
}

void read_contact(const H5Reader &file, ReducedModel &model) {
  model.dual_basis = file.matrix("contact/dual_basis");
  model.contact_trace = file.matrix("contact/trace");
  model.trace_dofs = file.ints("contact/trace_dofs");
  model.interfaces = read_interfaces(file, file.integer("contact/dofs"));
  if (model.interfaces.empty()) throw bad_input("it has no contact interface");
}

Scene read_scene(const H5Reader &file, const Registry &registry) {
  const Record record = record_in(read_texts(file, "scene/functions"));
  const std::string unnamed = first_unnamed(record);
  Scene scene = unnamed.empty() ? scene_in({record, &registry}) : Scene{};
  scene.name = file.string("scene/name");
  scene.options = read_texts(file, "scene/options");
  scene.parameters = read_parameters(file);
  if (unnamed.empty()) return scene;
  return while_doing("making the scene by its code, for '" + unnamed + "' has no name in files",
                     [&] { return scene_by_code(scene, registry); });
}

ReducedModel read_members(const H5Reader &file, const Registry &registry) {
  ReducedModel model;
  model.scene = read_scene(file, registry);
  model.settings = read_texts(file, "settings");
  model.mesh_fingerprint = file.string("mesh/fingerprint");
  model.modes = file.integer("size/modes");
  model.supremizers = file.integer("size/supremizers");
  model.generators = file.integer("size/generators");
  model.free_modes = file.integer("size/free_modes");
  model.online_enriched = file.integer("size/online_enriched") != 0;
  model.a = read_terms(file, "a");
  model.a_change = {file.vector("a/scales"), file.matrix("a/range"), file.matrix("a/cores")};
  model.b = read_terms(file, "b");
  model.f = read_terms(file, "f");
  model.g = read_terms(file, "g");
  model.imposed_energy = read_terms(file, "imposed_energy");
  model.law = read_law(file);
  read_nitsche(file, model);
  read_contact(file, model);
  read_history(file, model);
  return model;
}

/// Throws bad_input for functions that have other values than in the build that made the model,
/// where it tells them.
void check_functions_of(const ReducedModel &model) {
  const Scene &scene = model.scene;
  check_box(scene);
  const auto text = model.settings.find(whole_scene);
  if (text == model.settings.end()) return;
  const std::string difference =
      scene_difference(text->second, scene_text(scene, contact_of(model, scene)), false);
  if (!difference.empty())
    throw bad_input("the scene of the model is another one in this build: " + difference +
                    ": make the model again by rbvi offline with another -out, or use the build "
                    "that made it");
}

} // namespace

void write_model(const ReducedModel &model, const std::filesystem::path &path) {
  check_model(model);
  write_fields(model, path);
  H5Writer file;
  file.write("scene/name", model.scene.name);
  write_texts(file, "scene/options", model.scene.options);
  write_texts(file, "scene/functions", lines_of(record_of(model.scene)));
  write_parameters(file, model.scene.parameters);
  write_texts(file, "settings", model.settings);
  file.write("mesh/fingerprint", model.mesh_fingerprint);
  file.write("size/modes", model.modes);
  file.write("size/supremizers", model.supremizers);
  file.write("size/generators", model.generators);
  file.write("size/free_modes", model.free_modes);
  file.write("size/online_enriched", model.online_enriched ? 1 : 0);
  write_terms(file, "a", model.a);
  file.write("a/scales", model.a_change.scales);
  file.write("a/range", model.a_change.range);
  file.write("a/cores", model.a_change.cores);
  write_terms(file, "b", model.b);
  write_terms(file, "f", model.f);
  write_terms(file, "g", model.g);
  write_terms(file, "imposed_energy", model.imposed_energy);
  write_law(file, model.law);
  write_nitsche(file, model);
  write_contact(file, model);
  file.write("fields/key", key_of_fields(model));
  write_history(file, model);
  file.commit(path, "model", model_schema);
}

ReducedModel read_model(const std::filesystem::path &path, const Registry &registry,
                        bool with_fields) {
  const H5Reader file(path, "model", model_schema);
  try {
    ReducedModel model = read_members(file, registry);
    model.fields_key = file.string("fields/key");
    if (with_fields) read_fields(path, model.fields_key, model);
    check_model(model);
    check_functions_of(model);
    return model;
  } catch (const Error &error) {
    throw bad_input(std::string(error.what()) + ", while reading " + path.string());
  }
}

} // namespace rbvi
