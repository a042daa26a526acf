// The part of Nitsche's method in a reduced model; of a model without it, nothing is checked, kept
// or written.
#pragma once

#include "rbvi/io/h5.hpp"
#include "rbvi/rom/model/model.hpp"

namespace rbvi {

/// Throws failure as check_model.
void check_nitsche(const ReducedModel &model);

/// What of it the model with the first `size` primal columns keeps, into `part`.
void keep_leading_nitsche(const ReducedModel &model, Index size, ReducedModel &part);

void write_nitsche(H5Writer &file, const ReducedModel &model);
/// Throws bad_input (H5Reader).
void read_nitsche(const H5Reader &file, ReducedModel &model);

} // namespace rbvi
