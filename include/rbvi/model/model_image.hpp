// A model as one image (io/image.hpp): what answers where HDF5 is not.
#pragma once

#include "rbvi/io/image.hpp"
#include "rbvi/model/model.hpp"

namespace rbvi {

/// With the fields that the model holds in memory. Throws failure (check_model).
std::string image_of(const ReducedModel &model);

/// `what`: the name of the image in errors. Throws as read_model, and bad_input (ImageReader).
ReducedModel model_in(Bytes image, const std::string &what, const Registry &registry,
                      bool with_fields = true);

} // namespace rbvi
