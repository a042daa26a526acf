// The problems that a command works on: one per group of ranks for the solves, one on all ranks for
// the reduction. They are one and the same where a group is the world.
#pragma once

#include "rbvi/par/groups.hpp"
#include "rbvi/tool/options.hpp"

#include <memory>

namespace rbvi {

class Workspace {
public:
  /// Collective on `world`. Makes the group's problem and checks its scene, and the options of its
  /// solvers.
  Workspace(MPI_Comm world, const Groups &groups, const Setup &setup);
  Problem &group_problem() const { return *group_; } ///< not after end_of_solves
  /// Lets go of the group's problem, where it is not the world's: its solves are over.
  void end_of_solves() {
    if (!shared_) group_.reset();
  }
  /// Made at the first call. Collective on the world.
  Problem &world_problem();

private:
  MPI_Comm world_;
  const Setup &setup_;
  bool shared_;
  std::unique_ptr<Problem> group_, all_;
};

} // namespace rbvi
