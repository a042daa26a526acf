// model.fields.h5: its data sets are listed in LAYOUT.md beside this file.
#include "model_fields.hpp"
#include "rbvi/model/fields_file.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/h5.hpp"

namespace rbvi {

namespace {

/// Whether the file holds the fields of this key.
bool holds_fields(const std::filesystem::path &path, const std::string &key) {
  try {
    return H5Reader(path, "fields", model_schema).read<std::string>("key") == key;
  } catch (const Error &) {
    return false;
  }
}

} // namespace

FieldsFile::FieldsFile(const std::filesystem::path &model_path, const std::string &key)
    : path_(fields_file(model_path)), file_(path_) {
  file_.write("key", key);
}

void FieldsFile::write_mesh(const ReducedModel &model) {
  const FieldWriter writer{file_};
  list_mesh(writer, "", model);
}

void FieldsFile::begin_basis(Index dofs, Index functions) {
  file_.create_rows("primal_basis", dofs, functions);
}

void FieldsFile::write_basis(Index first, const Matrix &rows) {
  file_.write_rows("primal_basis", first, rows);
}

void FieldsFile::commit() {
  file_.commit(path_, "fields", model_schema);
}

void write_fields(const ReducedModel &model, const std::filesystem::path &model_path) {
  const std::string key = key_of_fields(model);
  if (model.fields.basis.size() == 0 || holds_fields(fields_file(model_path), key)) return;
  FieldsFile file(model_path, key);
  file.write_mesh(model);
  file.begin_basis(model.fields.basis.rows(), model.fields.basis.cols());
  file.write_basis(0, model.fields.basis);
  file.commit();
}

void read_fields(const std::filesystem::path &model_path, const std::string &key,
                 ReducedModel &model) {
  if (key.empty()) return;
  const std::filesystem::path path = fields_file(model_path);
  if (std::error_code ignored; !std::filesystem::exists(path, ignored))
    throw bad_input(path.string() + " is missing: it has the fields of the model and belongs "
                                    "beside it; put it there, or make the model again");
  const H5Reader file(path, "fields", model_schema);
  if (file.read<std::string>("key") != key)
    throw bad_input(path.string() + " has the fields of another model: put its own beside it, or "
                                    "make the model again");
  const FieldReader reader{file};
  list_fields(reader, "", model);
}

std::filesystem::path fields_file(const std::filesystem::path &model) {
  std::filesystem::path path = model;
  return path.replace_extension(".fields" + model.extension().string());
}

} // namespace rbvi
