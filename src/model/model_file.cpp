// model.h5: its data sets are listed in LAYOUT.md beside this file.
#include "rbvi/core/error.hpp"
#include "rbvi/io/system_error.hpp"
#include "rbvi/model/model_image.hpp"
#include "model_fields.hpp"
#include "model_list.hpp"

#include <fstream>

namespace rbvi {

namespace {

/// The bytes of a file that is an image; empty: it is none, or cannot be read.
std::vector<std::byte> image_in(const std::filesystem::path &path) {
  std::array<std::byte, 8> start{};
  std::ifstream file(path, std::ios::binary);
  // NOLINTBEGIN: streams read characters
  if (!file.read(reinterpret_cast<char *>(start.data()), start.size()) || !is_image(start))
    return {};
  std::vector<std::byte> bytes(std::filesystem::file_size(path));
  file.seekg(0);
  file.read(reinterpret_cast<char *>(bytes.data()), std::ssize(bytes));
  // NOLINTEND
  if (!file) throw bad_input(path.string() + " cannot be read" + system_reason());
  return bytes;
}

} // namespace

void write_model(const ReducedModel &model, const std::filesystem::path &path) {
  check_model(model);
  write_fields(model, path);
  H5Writer file;
  list_model(FieldWriter{file}, model, key_of_fields(model));
  file.commit(path, "model", model_schema);
}

ReducedModel read_model(const std::filesystem::path &path, const Registry &registry,
                        bool with_fields) {
  if (const std::vector<std::byte> image = image_in(path); !image.empty())
    return model_in(image, path.string(), registry, with_fields);
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
