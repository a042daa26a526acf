// This rank and the others. A failure on one rank becomes the same failure on every rank, so that
// nobody waits for a rank that has left.
#pragma once

#include <petscsys.h>

#include <functional>
#include <type_traits>

namespace rbvi {

int rank_of(MPI_Comm comm);
int ranks_of(MPI_Comm comm);

/// Collective. Replaces each of the values by its sum, largest or smallest over the ranks.
template <class Values> void over_ranks(MPI_Comm comm, MPI_Op op, Values &values) {
  using Value = std::remove_reference_t<decltype(*values.data())>;
  static_assert(std::is_same_v<Value, double> || std::is_same_v<Value, PetscInt>);
  const MPI_Datatype type = std::is_same_v<Value, double> ? MPI_DOUBLE : MPIU_INT;
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), type, op, comm);
}

/// Collective on `comm`. Runs `work` on every rank; if it throws anywhere, every rank throws an
/// Error with the status and the message of the lowest rank that failed. `work` itself must not
/// communicate on `comm`: a rank that fails would leave the others waiting inside it.
void collectively(MPI_Comm comm, const std::function<void()> &work);

} // namespace rbvi
