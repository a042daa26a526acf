// What a reduced model is, for people.
#pragma once

#include "rbvi/rom/model.hpp"

#include <ostream>

namespace rbvi {

/// Scene and options, parameters with units and bounds, sizes, settings, expected errors.
void print_model(std::ostream &out, const ReducedModel &model);

/// One line: the errors measured over the validation set, or that none were.
void print_expected_errors(std::ostream &out, const ReducedModel &model);

} // namespace rbvi
