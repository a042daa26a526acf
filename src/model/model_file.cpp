// model.h5: its data sets are listed in LAYOUT.md beside this file.
#include "model_fields.hpp"
#include "model_list.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/model/model_image.hpp"

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
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored) && is_image(bytes_of_file(path, 8)))
    return model_in(bytes_of_file(path), path.string(), registry, with_fields);
  const H5Reader file(path, "model", model_schema);
  try {
    ReducedModel model;
    list_model(FieldReader{file}, model, model.fields.key);
    take_scene(model, registry);
    if (with_fields) read_fields(path, model.fields.key, model);
    check_model(model);
    return model;
  } catch (const Error &error) {
    throw bad_input(std::string(error.what()) + ", while reading " + path.string());
  }
}

} // namespace rbvi
