#include "rbvi/par/groups.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"

namespace rbvi {

Groups::Groups(MPI_Comm world, int ranks_per_group) {
  const int ranks = ranks_of(world), rank = rank_of(world);
  if (ranks_per_group < 1 || ranks % ranks_per_group != 0)
    throw bad_input("-sweep_ranks_per_solve is " + std::to_string(ranks_per_group) +
                    ": use a number that divides the " + std::to_string(ranks) + " ranks");
  count_ = ranks / ranks_per_group;
  mine_ = rank / ranks_per_group;
  leads_ = rank % ranks_per_group == 0;
  MPI_Comm_split(world, mine_, rank, &comm_);
  MPI_Comm_split(world, rank % ranks_per_group, rank, &across_);
}

Groups::~Groups() {
  int finalized = 0;
  MPI_Finalized(&finalized);
  if (finalized != 0) return;
  for (MPI_Comm *comm : {&comm_, &across_})
    if (*comm != MPI_COMM_NULL) MPI_Comm_free(comm);
}

} // namespace rbvi
