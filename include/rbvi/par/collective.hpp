// This rank and the others. A failure on one rank becomes the same failure on every rank, so that
// nobody waits for a rank that has left.
#pragma once

#include <petscsys.h>

#include <cstddef>
#include <functional>
#include <numeric>
#include <type_traits>
#include <vector>

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

/// Collective. Calls visit(p) on this rank for its turns among 0 .. count - 1: rank, rank + ranks,
/// ... A failure is that of every rank. `visit` must not communicate on `comm`.
template <class Visit> void take_turns(MPI_Comm comm, std::size_t count, Visit &&visit) {
  collectively(comm, [&] {
    const int rank = rank_of(comm), ranks = ranks_of(comm);
    for (auto p = static_cast<std::size_t>(rank); p < count; p += static_cast<std::size_t>(ranks))
      visit(p);
  });
}

/// Collective. The entries of rank 0, then of rank 1, ..., on every rank; `type` is T's.
template <class T>
std::vector<T> gather_all(MPI_Comm comm, const std::vector<T> &mine, MPI_Datatype type) {
  std::vector<int> counts(ranks_of(comm)), offsets(counts.size(), 0);
  const int count = static_cast<int>(mine.size());
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  std::partial_sum(counts.begin(), counts.end() - 1, offsets.begin() + 1);
  std::vector<T> all(offsets.back() + counts.back());
  MPI_Allgatherv(mine.data(), count, type, all.data(), counts.data(), offsets.data(), type, comm);
  return all;
}

} // namespace rbvi
