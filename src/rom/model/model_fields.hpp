// The file of a model's fields, beside that of the model.
#pragma once

#include "rbvi/rom/model/model.hpp"

namespace rbvi {

/// Tells the fields of one model from those of another; "" for a model without.
std::string key_of_fields(const ReducedModel &model);

/// Writes the fields that a model holds in memory; leaves the file as it is where it has them.
void write_fields(const ReducedModel &model, const std::filesystem::path &model_path);

/// `key`: of the model; "" is a model without fields. Throws bad_input for a file that is not there
/// or has other fields.
void read_fields(const std::filesystem::path &model_path, const std::string &key,
                 ReducedModel &model);

} // namespace rbvi
