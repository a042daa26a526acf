// Communicators of a sweep: the ranks split into groups, each of which solves its own samples.
#pragma once

#include <mpi.h>

namespace rbvi {

/// Owns the communicators of this rank's group, and of those in its place in every group.
class Groups {
public:
  /// Collective on `world`. Consecutive ranks form groups of `ranks_per_group`. Throws bad_input
  /// unless that number is positive and divides the number of ranks.
  Groups(MPI_Comm world, int ranks_per_group);
  ~Groups();
  Groups(const Groups &) = delete;
  Groups &operator=(const Groups &) = delete;

  MPI_Comm comm() const { return comm_; }
  MPI_Comm across() const { return across_; } ///< one rank of each group, in the order of groups
  int count() const { return count_; }
  int mine() const { return mine_; }
  bool leads() const { return leads_; } ///< first rank of its group

private:
  MPI_Comm comm_ = MPI_COMM_NULL, across_ = MPI_COMM_NULL;
  int count_ = 1, mine_ = 0;
  bool leads_ = true;
};

} // namespace rbvi
