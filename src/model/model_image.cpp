#include "rbvi/model/model_image.hpp"

#include "model_fields.hpp"
#include "model_list.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/io/checksum.hpp"
#include "rbvi/scene/stored_scene.hpp"

namespace rbvi {

namespace {

const std::string fields_group = "fields/";

} // namespace

std::string key_of_fields(const ReducedModel &model) {
  if (model.fields.basis.size() == 0) return model.fields.key;
  const auto hash = [](const auto *data, auto size) {
    return std::to_string(fnv1a(data, static_cast<std::size_t>(size) * sizeof(*data)));
  };
  return hash(model.fields.basis.data(), model.fields.basis.size()) + "-" +
         hash(model.fields.points.data(), model.fields.points.size()) + "-" +
         hash(model.fields.cells.data(), std::ssize(model.fields.cells));
}

void take_scene(ReducedModel &model, const Registry &registry) {
  const Scene &stored = model.scene;
  model.scene = in_box_of(stored, scene_in(stored.tree, stored.options, registry));
}

std::string image_of(const ReducedModel &model) {
  check_model(model);
  ImageWriter image;
  const WriterTo<ImageWriter> writer{image};
  const bool fields = model.fields.basis.size() > 0;
  list_model(writer, model, fields ? key_of_fields(model) : "");
  if (fields) list_fields(writer, fields_group, model);
  return image.image(model_schema);
}

ReducedModel model_in(Bytes image, const std::string &what, const Registry &registry,
                      bool with_fields) {
  const ImageReader file(image, what, model_schema);
  try {
    ReducedModel model;
    const ReaderOf<ImageReader> reader{file};
    list_model(reader, model, model.fields.key);
    take_scene(model, registry);
    if (with_fields && !model.fields.key.empty()) list_fields(reader, fields_group, model);
    check_model(model);
    return model;
  } catch (const Error &error) {
    throw bad_input(std::string(error.what()) + ", while reading " + what);
  }
}

} // namespace rbvi
