// A failure on one rank becomes the same failure on every rank, so that nobody waits for a rank
// that has left.
#pragma once

#include <petscsys.h>

#include <functional>

namespace rbvi {

/// Collective on `comm`. Runs `work` on every rank; if it throws anywhere, every rank throws an
/// Error with the status and the message of the lowest rank that failed. `work` itself must not
/// communicate on `comm`: a rank that fails would leave the others waiting inside it.
void collectively(MPI_Comm comm, const std::function<void()> &work);

} // namespace rbvi
