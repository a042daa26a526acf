// The groups of the table of options that a reduced model is made by.
#pragma once

#include "table.hpp"

namespace rbvi {

/// Bases, stability, separation, multipliers and Nitsche's method, in this order.
std::vector<Option> reduction_options(OfflineOptions &options);

} // namespace rbvi
