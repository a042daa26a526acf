// Concatenation of vectors over ranks.
#pragma once

#include "rbvi/par/collective.hpp"

#include <numeric>
#include <vector>

namespace rbvi {

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
