// The stages of an offline run as one table: before the run what will be done and what that will
// take, foreseen from sizes; after it what was done and how long it took; in both what is skipped
// and why.
#pragma once

#include "rbvi/mor/reduce.hpp"
#include "rbvi/par/node_memory.hpp"
#include "rbvi/tool/options.hpp"

#include <map>

namespace rbvi {

namespace stage {
inline constexpr StageName mesh("mesh"), snapshots("snapshots"),
    distributed_mesh("distributed mesh"), writing("writing");
} // namespace stage

/// What runs before the reduction. `sweep` null: as planned.
StageTable preparation_stages(const Setup &setup, std::size_t training, const Groups &groups,
                              const SweepReport *sweep = nullptr);

/// What runs after the reduction.
StageTable closing_stages();

/// What a stage will take.
struct Foreseen {
  double first = 0, others = 0; ///< bytes: largest resident set of the first rank, of each other
  double seconds = 0;           ///< 0: hangs on what the stages before it find, or is short
  const char *smaller = "";     ///< what makes it smaller
};
/// By the names of stages.
using Foresight = std::map<std::string, Foreseen>;

/// Stage, seconds, and megabytes where the process had not taken as many before (nothing where none
/// are known), in parentheses those foreseen of a rank, what; the totals of both times, what is not
/// foreseen left out.
void print_stages(const std::vector<StageTable> &tables, const Foresight &foreseen);

/// Of an offline run.
struct RunSizes {
  double dofs = 0;                     ///< free ones
  double contact = 0, multipliers = 0; ///< contact dofs, dual dofs; 0: not known yet
  double solves = 0;                   ///< with factors of A, for a sample (contact_cost)
  double balances = 1;                 ///< solves of a query: more where contact alone holds bodies
  bool eliminated = false;     ///< contact: no operator is condensed, as by Nitsche's method
  int ranks = 1, group = 1;    ///< of the run, of a solve
  double before = 0, held = 0; ///< bytes of a rank: before the mesh, and with it
};

/// Before the mesh is made. Collective on `world`.
RunSizes sizes_by_count(MPI_Comm world, const Groups &groups, const Setup &setup);
/// With the group's problem, which is there, and the options of its solves. Collective on `world`.
RunSizes sizes_of(MPI_Comm world, const Problem &problem, const HfOptions &options,
                  RunSizes counted);

/// By the names of the stages.
Foresight foresee(const OfflineOptions &options, const std::vector<Mu> &training,
                  const RunSizes &sizes);

/// What is free on the tightest node, and what its ranks hold. Collective.
NodeMemory room_for(MPI_Comm world);
/// "The most memory that a stage takes is about 120 MB for the 2 ranks of a node (snapshots), of 15
/// GB".
std::string memory_text(const Foresight &foreseen, const std::vector<StageTable> &stages,
                        const NodeMemory &room);
/// Throws bad_input where a stage that runs takes more than twice of that, so that it cannot fit
/// though what is foreseen is right to a factor of two; names the one that takes most, and what
/// makes it smaller.
void check_memory(const Foresight &foreseen, const std::vector<StageTable> &stages,
                  const NodeMemory &room);

} // namespace rbvi
