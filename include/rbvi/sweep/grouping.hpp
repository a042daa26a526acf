// How many ranks share one solve of a sweep: as few as its samples and the memory allow, because
// solves side by side are faster than ranks side by side in one solve.
#pragma once

#include "rbvi/mesh/mesh.hpp"
#include "rbvi/par/node_memory.hpp"

#include <cstddef>
#include <string>

namespace rbvi {

/// One solve.
struct SolveSize {
  double dofs = 0;
  int dim = 2;
};

/// Estimated peak memory of one solve in bytes, in all, however many ranks share it; rather too
/// much than too little. Dense operators of thousands of multipliers (-hf_contact condensed) are
/// not in it.
double solve_bytes(const SolveSize &size);

/// How many times faster one solve is on so many ranks than on one.
double solve_speedup(const SolveSize &size, int ranks);

struct Grouping {
  int ranks_per_solve = 1;
  std::string text; ///< the groups and the reason, in one line
};

/// Among the divisors s of `ranks` for which there are no more groups than samples, and for which
/// the solves of a node fit into its memory, the one with the least
///
///   ceil(samples / (ranks / s)) / solve_speedup(s),
///
/// of equal ones the smallest. Where nothing fits, all ranks share each solve.
Grouping choose_grouping(int ranks, std::size_t samples, const SolveSize &size,
                         const NodeMemory &node);

/// That choice for a scene on a mesh; `forced`: the ranks for each solve that the user wants, 0
/// where it is free. Collective. Throws bad_input as make_mesh does for a wrong mesh.
Grouping group_ranks(MPI_Comm world, const Scene &scene, const MeshOptions &mesh,
                     std::size_t samples, int forced);

} // namespace rbvi
