// The memory of the machines that ranks run on.
#pragma once

#include "rbvi/par/petsc.hpp"

namespace rbvi {

/// The node that has least memory for each of its ranks.
struct NodeMemory {
  int ranks = 1;    ///< ours on it
  double bytes = 0; ///< that are available there
};

/// By MemAvailable of /proc/meminfo; infinite where the system does not tell. Collective.
NodeMemory tightest_node(MPI_Comm comm);

} // namespace rbvi
