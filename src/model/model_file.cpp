// model.h5: its data sets are listed in LAYOUT.md beside this file.
#include "model_fields.hpp"
#include "model_list.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/model/scene_record.hpp"
#include "rbvi/model/scene_text.hpp"

namespace rbvi {

namespace {

/// Of a name, options and parameters.
Scene scene_of_record(const Scene &stored, const Record &record, const Registry &registry) {
  const std::string unnamed = first_unnamed(record);
  if (!unnamed.empty())
    return while_doing("making the scene by its code, for '" + unnamed + "' has no name in files",
                       [&] { return scene_by_code(stored, registry); });
  Scene scene = scene_in({record, &registry});
  scene.name = stored.name;
  scene.options = stored.options;
  scene.parameters = stored.parameters;
  return scene;
}

/// Throws bad_input for functions that have other values than in the build that made the model,
/// where it tells them.
void check_functions_of(const ReducedModel &model) {
  const Scene &scene = model.scene;
  check_box(scene);
  const auto text = model.made.settings.find(whole_scene);
  if (text == model.made.settings.end()) return;
  const std::string difference =
      scene_difference(text->second, scene_text(scene, contact_of(model, scene)), Further::allowed);
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
  StoredBeside beside{lines_of(record_of(model.scene)), key_of_fields(model)};
  FieldWriter writer{file};
  list_model(writer, model, beside);
  file.commit(path, "model", model_schema);
}

ReducedModel read_model(const std::filesystem::path &path, const Registry &registry,
                        bool with_fields) {
  const H5Reader file(path, "model", model_schema);
  try {
    ReducedModel model;
    StoredBeside beside;
    FieldReader reader{file};
    list_model(reader, model, beside);
    model.scene = scene_of_record(model.scene, record_in(beside.functions), registry);
    model.fields.key = beside.fields_key;
    if (with_fields) read_fields(path, model.fields.key, model);
    check_model(model);
    check_functions_of(model);
    return model;
  } catch (const Error &error) {
    throw bad_input(std::string(error.what()) + ", while reading " + path.string());
  }
}

} // namespace rbvi
