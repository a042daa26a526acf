// Independent pieces of work, shared among ranks.
#pragma once

#include "rbvi/par/collective.hpp"

#include <cstddef>

namespace rbvi {

/// Collective. Calls visit(p) on this rank for its turns among 0 .. count - 1: rank, rank + ranks,
/// ... A failure is that of every rank. `visit` must not communicate on `comm`.
template <class Visit> void take_turns(MPI_Comm comm, std::size_t count, Visit &&visit) {
  collectively(comm, [&] {
    const int rank = rank_of(comm), ranks = ranks_of(comm);
    for (auto p = static_cast<std::size_t>(rank); p < count; p += static_cast<std::size_t>(ranks))
      visit(p);
  });
}

} // namespace rbvi
