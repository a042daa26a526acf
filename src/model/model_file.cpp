// model.h5: its data sets are listed in LAYOUT.md beside this file.
#include "model_fields.hpp"
#include "model_list.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/scene/stored_scene.hpp"

namespace rbvi {

void write_model(const ReducedModel &model, const std::filesystem::path &path) {
  check_model(model);
  write_fields(model, path);
  H5Writer file;
  list_model(FieldWriter{file}, model, key_of_fields(model));
  file.commit(path, "model", model_schema);
}

ReducedModel read_model(const std::filesystem::path &path, const Registry &registry,
                        bool with_fields) {
  const H5Reader file(path, "model", model_schema);
  try {
    ReducedModel model;
    list_model(FieldReader{file}, model, model.fields.key);
    const Scene &stored = model.scene;
    model.scene = in_box_of(stored, scene_in(stored.tree, stored.options, registry));
    if (with_fields) read_fields(path, model.fields.key, model);
    check_model(model);
    return model;
  } catch (const Error &error) {
    throw bad_input(std::string(error.what()) + ", while reading " + path.string());
  }
}

} // namespace rbvi
