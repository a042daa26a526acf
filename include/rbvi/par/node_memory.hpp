// The memory of the machines that ranks run on.
#pragma once

#include "rbvi/par/petsc.hpp"

#include <filesystem>

namespace rbvi {

/// The node that has least memory for each of its ranks.
struct NodeMemory {
  int ranks = 1;    ///< ours on it
  double bytes = 0; ///< that are available there
};

/// By MemAvailable of /proc/meminfo and left_by_groups(); infinite where the system does not tell.
/// Collective.
NodeMemory tightest_node(MPI_Comm comm);

/// The bytes that Linux' control groups leave a process, caches that they can drop counted as free;
/// infinite without a bound. `file`: its groups. `root`: where the groups are mounted.
double left_by_groups(const std::filesystem::path &file = "/proc/self/cgroup",
                      const std::filesystem::path &root = "/sys/fs/cgroup");

} // namespace rbvi
