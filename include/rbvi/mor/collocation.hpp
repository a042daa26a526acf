// Options and report of the greedy selection of collocation nodes (mor/published/gcns.hpp).
#pragma once

#include <string>
#include <vector>

namespace rbvi {

/// Which nodes hold the bound.
enum class CollocationNodes {
  best,        ///< those of the least error, beyond all its rises
  before_rise, ///< those of the step before the first rise of the error: the stop of Algorithm 3
  all          ///< every one (3.43)
};

/// "best", "before_rise", "all".
const std::vector<std::string> &collocation_nodes_names();

struct GcnsOptions {
  CollocationNodes nodes = CollocationNodes::best;
  double tolerance = 0; ///< stop when e_GCNS is at or below; 0: no such stop
  int max_nodes = 0;    ///< stop where more would be needed; 0: no bound
};

struct Gcns {
  std::vector<int> nodes;        ///< of the least error, in the order of selection
  std::vector<int> count;        ///< of nodes at each step q, from 0
  std::vector<double> error;     ///< e_GCNS(q) of these nodes, (3.56)
  std::vector<double> violation; ///< e_GCNS^{n tau}(q) (3.63), a pressure
  std::vector<int> selected;     ///< training index mu_q of each step
  std::string reason;
};

} // namespace rbvi
