// Queries by published variants: the law on fewer functions with its bound at collocation nodes
// (also by Uzawa's method), and Nitsche's method interpolated over (mu, Newton step).
#pragma once

namespace rbvi {

/// Enters them in the lists of model/law_solver.hpp and model/nitsche_solver.hpp. To be called
/// before the first query.
void add_published_queries();

} // namespace rbvi
