// How the cost of a reduced model grows with the mesh: the offline pipeline, run on several meshes
// and with several numbers of ranks per solve, and what each of its stages took.
#pragma once

#include "rbvi/par/stage_cost.hpp"

#include <string>
#include <utility>
#include <vector>

namespace rbvi {

/// One run of the pipeline.
struct GrowthRun {
  std::string scene;
  int refine = 0, ranks = 1, ranks_per_solve = 1;
  int nodes = 0, dofs = 0;
  int multipliers = 0;
  int samples = 0, failed = 0;
  int modes = 0;             ///< N + S
  double contact_nodes = 0;  ///< most of a sample
  double sample_seconds = 0; ///< of one solve, median
  double iterations = 0;     ///< of one solve, median
  double resident = 0;       ///< bytes of a rank before the run, largest
  double model_bytes = 0, fields_bytes = 0;
  std::vector<std::pair<std::string, RankCosts>> stages; ///< those that ran, in order
};

/// All stages together.
RankCosts total_cost(const GrowthRun &run);

/// A row for each run and stage, and for all of its stages together; cases/growth.py makes a page
/// of it.
std::string growth_csv(const std::vector<GrowthRun> &runs);

} // namespace rbvi
