// Whether forces balance as outputs of a reduced model print them.
#pragma once

#include "rbvi/model/model.hpp"

namespace rbvi {

class Problem;

/// Asks the model of the first rank at corners, faces and inside of its box, where its scene has
/// reactions: what of all forces on a body (fem/body_balance.hpp) is left at the worst, over the
/// largest, with its parameters, is kept as the history "self_check/balance" where it is more than
/// the residual of a query may be. Collective.
void compare_balance(const Problem &problem, ReducedModel &model);

} // namespace rbvi
