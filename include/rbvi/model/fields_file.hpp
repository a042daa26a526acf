// model.fields.h5 while it is made: the basis comes by rows, so that nobody has to hold all of it.
#pragma once

#include "rbvi/io/h5.hpp"
#include "rbvi/model/model.hpp"

namespace rbvi {

class FieldsFile {
public:
  /// `key`: of the model beside it. Throws failure, like all others.
  FieldsFile(const std::filesystem::path &model_path, const std::string &key);
  /// That of a model.
  void write_mesh(const ReducedModel &model);
  void begin_basis(Index dofs, Index functions);
  void write_basis(Index first, const Matrix &rows);
  void commit();

private:
  std::filesystem::path path_;
  H5Writer file_;
};

} // namespace rbvi
