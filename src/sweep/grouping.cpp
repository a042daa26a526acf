#include "rbvi/sweep/grouping.hpp"

#include "rbvi/core/text.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/response_solver.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

// All that a process holds without a mesh. In three dimensions the factor alone (CHOLMOD, cubes of
// tetrahedra with 33e3 to 64e3 dofs) took 120 n^(4/3) bytes for one component, 220 for three.
constexpr double process_bytes = 64e6;
constexpr double space_bytes = 220;

// One solve on two ranks against one: little faster below this size, and above by about so much
// (the membrane refined three times: 2.08 s on one rank, 1.68 s on two, which the bandwidth of the
// memory bounds; two_disks refined twice: 2.1 and 1.4 to 1.7 s, three times: 11.9 and 6.0 s).
constexpr double parallel_from = 1.8e5, speedup_of_two = 1.24;

/// "Solves are by 2 groups of 1 rank: ".
std::string groups_text(int ranks, int ranks_per_solve) {
  return "Solves are by " + counted(ranks / ranks_per_solve, "group") + " of " +
         counted(ranks_per_solve, "rank") + ": ";
}

} // namespace

double solve_bytes(const SolveSize &size) {
  const double n = std::max(2.0, size.dofs);
  return process_bytes +
         (size.dim == 2 ? plane_solve_bytes(n) : space_bytes * std::pow(n, 4.0 / 3));
}

double solve_speedup(const SolveSize &size, int ranks) {
  return size.dofs < parallel_from ? 1 : std::pow(speedup_of_two, std::log2(ranks));
}

Grouping choose_grouping(int ranks, std::size_t samples, const SolveSize &size,
                         const NodeMemory &node) {
  const auto wanted = std::max(1, static_cast<int>(samples));
  const double bytes = solve_bytes(size);
  int best = 0, too_many = 0;
  double least = 0;
  for (int s = 1; s <= ranks; ++s) {
    const int groups = ranks / s;
    if (ranks % s != 0 || groups > wanted) continue;
    if (bytes * node.ranks / s > node.bytes) {
      too_many = too_many == 0 ? groups : too_many;
      continue;
    }
    const double time = (wanted + groups - 1) / groups / solve_speedup(size, s);
    if (best != 0 && time >= least) continue;
    best = s;
    least = time;
  }
  const std::string facts = counted(wanted, "sample") + " of about " +
                            formatted("%.0f", size.dofs) + " dofs and " + bytes_text(bytes) + ", " +
                            bytes_text(node.bytes) + " for the " + counted(node.ranks, "rank") +
                            " of a node";
  if (best == 0) return {ranks, groups_text(ranks, ranks) + facts + ", where not even one may fit"};
  return {best, groups_text(ranks, best) + facts +
                    (too_many == 0 ? ""
                                   : ", where " + counted(too_many, "solve") +
                                         " side by side would not fit")};
}

Grouping group_ranks(MPI_Comm world, const Scene &scene, const MeshOptions &mesh,
                     std::size_t samples, int forced) {
  const int ranks = ranks_of(world);
  if (forced != 0) return {forced, groups_text(ranks, forced) + "as -sweep_ranks_per_solve says"};
  if (ranks == 1) return {1, groups_text(1, 1) + "there is no other"};
  const double nodes = static_cast<double>(count_nodes(world, scene, mesh));
  return choose_grouping(ranks, samples, {nodes * scene.components, scene.dim},
                         tightest_node(world));
}

} // namespace rbvi
