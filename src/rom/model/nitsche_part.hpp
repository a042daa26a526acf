// The part of Nitsche's method in a reduced model; of a model without it, nothing is checked, kept
// or written.
#pragma once

#include "rbvi/io/h5.hpp"
#include "rbvi/rom/model/model.hpp"

namespace rbvi {

/// Throws failure as check_model.
void check_nitsche(const ReducedModel &model);

/// Keeps what belongs to the first `size` of n primal columns.
void keep_leading_nitsche(Index n, Index size, ReducedModel &model);

void write_nitsche(H5Writer &file, const ReducedModel &model);
/// Throws bad_input (H5Reader).
void read_nitsche(const H5Reader &file, ReducedModel &model);

} // namespace rbvi
