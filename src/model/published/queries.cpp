#include "rbvi/model/published/queries.hpp"

#include "queries.hpp"

namespace rbvi {

void add_published_queries() {
  law_solvers()[MultiplierReduction::collocated] = collocated_solver;
  interpolated_curves()[CurveRule::interpolated] = interpolated_curve;
}

} // namespace rbvi
